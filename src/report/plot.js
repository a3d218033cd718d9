// Plots: plain SVG, made of scales, ticks, lines and labels that do not cover each other.

const SVG = "http://www.w3.org/2000/svg";
function svg(tag, attributes = {}, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

// As few characters as tell four significant digits at most; src/report/summary.cpp does the same.
function shown(x) {
  if (x === null || x === undefined || Number.isNaN(x)) return "–";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  const size = Math.abs(x);
  if (size !== 0 && size < 1e-3) return x.toExponential(2).replace("-", "−");
  return x.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 4).replace("-", "−");
}
const shortNumber = x => Math.abs(x) >= 1e5 || (x !== 0 && Math.abs(x) < 1e-3) ? x.toExponential().replace("-", "−")
                                                                                : String(+x.toPrecision(4)).replace("-", "−");

/** From values to pixels: linear, logarithmic where that tells more, or one step a word. */
class Scale {
  constructor(values, from, to, { words = null, ticks = null, mayBeLog = true } = {}) {
    this.words = words;
    this.given = words || ticks;
    this.from = from, this.to = to;
    if (words) return;
    const least = Math.min(...values), most = Math.max(...values);
    this.log = mayBeLog && least > 0 && most / least > 8;
    const f = x => this.log ? Math.log10(x) : x;
    const margin = 0.06 * (f(most) - f(least)) || (this.log ? 0.3 : 0.5 * Math.abs(most) || 1);
    this.least = f(least) - margin;
    this.most = f(most) + margin;
    if (!this.log && least >= 0) this.least = Math.max(0, this.least);
  }
  at(value) {
    const share = this.words ? (this.words.indexOf(value) + 0.5) / this.words.length
                             : ((this.log ? Math.log10(value) : value) - this.least) / (this.most - this.least);
    return this.from + share * (this.to - this.from);
  }
  ticks() {
    if (this.given) return this.given;
    return this.log ? this.logTicks() : this.linearTicks();
  }
  logTicks() {
    const decades = this.most - this.least, steps = decades > 3 ? [1] : decades > 1.2 ? [1, 3] : [1, 2, 5];
    const ticks = [];
    for (let e = Math.floor(this.least); e <= this.most; ++e)
      for (const step of steps) if (Math.log10(step) + e >= this.least && Math.log10(step) + e <= this.most) ticks.push(step * 10 ** e);
    return ticks;
  }
  linearTicks() {
    const raw = (this.most - this.least) / 5, decade = 10 ** Math.floor(Math.log10(raw));
    const step = decade * [1, 2, 5, 10].find(s => s * decade >= raw);
    const ticks = [];
    for (let i = Math.ceil(this.least / step); i * step <= this.most; ++i) ticks.push(i * step);
    return ticks;
  }
}

const overlap = (a, b) => Math.max(0, Math.min(a.right, b.right) - Math.max(a.left, b.left)) *
                          Math.max(0, Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));

// The places of a label, the nearest to its point first.
function labelPlaces(p) {
  const width = 6.3 * p.label.length, places = [];
  const add = (left, middle) => places.push({ left, right: left + width, top: middle - 7, bottom: middle + 7 });
  add(p.x + 8, p.y), add(p.x - 8 - width, p.y), add(p.x - width / 2, p.y - 13), add(p.x - width / 2, p.y + 13);
  for (let dy = 11; dy <= 77; dy += 11)
    for (const y of [p.y - dy, p.y + dy]) add(p.x + 8 + dy / 4, y), add(p.x - 8 - dy / 4 - width, y);
  return places;
}

// Puts each label where it covers least of the others and of the points; a later round knows where the others went.
function placeLabels(points, area) {
  const dots = points.map(p => ({ left: p.x - 5, right: p.x + 5, top: p.y - 5, bottom: p.y + 5 }));
  const outside = b => Math.max(0, area.left - b.left) + Math.max(0, b.right - area.right) +
                       Math.max(0, area.top - b.top) + Math.max(0, b.bottom - area.bottom);
  const placed = [];
  for (let round = 0; round < 4; ++round)
    points.forEach((p, i) => {
      const taken = [...dots, ...placed.filter((_, k) => k !== i)];
      const cost = (b, rank) => taken.reduce((sum, t) => sum + overlap(b, t), 0) + 40 * outside(b) + 3 * rank;
      const costs = labelPlaces(p).map((b, rank) => ({ b, cost: cost(b, rank) }));
      placed[i] = costs.reduce((best, other) => other.cost < best.cost ? other : best).b;
    });
  return points.map((p, i) => ({ ...p, left: placed[i].left, right: placed[i].right, middle: (placed[i].top + placed[i].bottom) / 2 }));
}

// Labels at the ends of lines, from top to bottom without touching.
function spreadLabels(points, area, gap = 13) {
  const sorted = [...points].sort((a, b) => a.y - b.y).map(p => ({ ...p, left: area.right + 8, middle: p.y }));
  for (let i = 1; i < sorted.length; ++i) sorted[i].middle = Math.max(sorted[i].middle, sorted[i - 1].middle + gap);
  let limit = area.bottom;
  for (let i = sorted.length - 1; i >= 0; --i, limit -= gap) sorted[i].middle = Math.min(sorted[i].middle, limit);
  return sorted;
}

/**
 * title, x: {label, words?}, y: {label}, lines: [{label, color, points: [{x, y, label?, about}], faint: [{x, y, about}]}].
 * A point with a label is named beside it; without any, the lines are named at their ends.
 */
function plot({ title, x, y, lines }, width = 460, height = 300) {
  const usable = p => Number.isFinite(p.y) && (x.words || Number.isFinite(p.x));
  for (const line of lines) line.points = line.points.filter(usable), line.faint = (line.faint || []).filter(usable);
  const all = lines.flatMap(line => [...line.points, ...line.faint]);
  const named = lines.some(line => line.points.some(p => p.label));
  const longest = Math.max(0, ...lines.map(line => line.label.length));
  const area = { left: 56, top: 34, right: width - (named ? 14 : 16 + 6.3 * longest), bottom: height - 42 };
  const figure = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title, class: "plot" });
  figure.append(svg("text", { x: 0, y: 14, class: "plot-title" }, title));
  if (all.length === 0) {
    figure.append(svg("text", { x: width / 2, y: height / 2, class: "plot-empty" }, "no numbers"));
    return figure;
  }
  const xs = new Scale(all.map(p => p.x), area.left, area.right, x);
  const ys = new Scale(all.map(p => p.y), area.bottom, area.top, y);
  drawAxes(figure, area, xs, ys, x, y);
  for (const line of lines) drawLine(figure, line, xs, ys);
  drawLabels(figure, lines, named, area, xs, ys);
  return figure;
}

function drawAxes(figure, area, xs, ys, x, y) {
  for (const tick of ys.ticks())
    figure.append(svg("line", { x1: area.left, x2: area.right, y1: ys.at(tick), y2: ys.at(tick), class: "plot-grid" }),
                  svg("text", { x: area.left - 8, y: ys.at(tick) + 4, class: "plot-tick end" }, shortNumber(tick)));
  const ticks = xs.ticks().map(tick => ({ x: xs.at(tick), text: x.words ? String(tick) : shortNumber(tick) }));
  const room = ticks.slice(1).every((t, i) => t.x - ticks[i].x > 3.2 * (t.text.length + ticks[i].text.length));
  ticks.forEach((tick, i) => {
    const below = room ? 0 : 11 * (i % 2);  // every other one a line lower
    figure.append(svg("line", { x1: tick.x, x2: tick.x, y1: area.bottom, y2: area.bottom + 4 + below, class: "plot-axis" }),
                  svg("text", { x: tick.x, y: area.bottom + 16 + below, class: "plot-tick middle" }, tick.text));
  });
  figure.append(svg("line", { x1: area.left, x2: area.right, y1: area.bottom, y2: area.bottom, class: "plot-axis" }),
                svg("text", { x: (area.left + area.right) / 2, y: area.bottom + (room ? 35 : 40), class: "plot-label middle" },
                    x.label + (xs.log ? " (log)" : "")),
                svg("text", { x: area.left, y: area.top - 6, class: "plot-label" }, y.label + (ys.log ? " (log)" : "")));
}

const about = text => svg("title", {}, text);

function drawLine(figure, line, xs, ys) {
  const group = svg("g", { style: `--color: ${line.color}`, class: "plot-line" });
  for (const p of line.faint) group.append(svg("circle", { cx: xs.at(p.x), cy: ys.at(p.y), r: 2, class: "plot-faint" }, about(p.about)));
  if (line.points.length > 1)
    group.append(svg("polyline", { points: line.points.map(p => `${xs.at(p.x).toFixed(1)},${ys.at(p.y).toFixed(1)}`).join(" ") }));
  for (const p of line.points) group.append(svg("circle", { cx: xs.at(p.x), cy: ys.at(p.y), r: 4, class: "plot-point" }, about(p.about)));
  figure.append(group);
}

function drawLabels(figure, lines, named, area, xs, ys) {
  const at = (line, p, label) => ({ x: xs.at(p.x), y: ys.at(p.y), label, color: line.color });
  const labels = named ? placeLabels(lines.flatMap(line => line.points.map(p => at(line, p, p.label))), area)
                       : spreadLabels(lines.filter(line => line.points.length).map(line => at(line, line.points.at(-1), line.label)), area);
  for (const l of labels) {
    const style = `--color: ${l.color}`, end = l.left > l.x ? l.left - 2 : l.right < l.x ? l.right + 2 : l.x;
    if (Math.abs(l.middle - l.y) > (named ? 14 : 6))
      figure.append(svg("line", { x1: l.x, y1: l.y, x2: end, y2: l.middle, class: "plot-leader", style }));
    figure.append(svg("text", { x: l.left, y: l.middle + 4, class: "plot-name", style }, l.label));
  }
}
