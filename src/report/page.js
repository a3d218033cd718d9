// The page: what is chosen stands in `state`, and each part of the page is drawn from it anew.

/** An element with attributes, listeners (on…) and children; text is always text, never markup. */
function h(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.flat(Infinity).filter(child => child !== null && child !== undefined));
  return node;
}

const report = JSON.parse(document.getElementById("data").textContent);
const methodOf = new Map(report.methods.map(m => [m.name, m]));
const COLORS = [...new Set(report.methods.map(m => m.series))];
const colorOf = name => `var(--series-${COLORS.indexOf(methodOf.get(name).series) % 8})`;
const hasHair = report.cases.every(c => c.hairPixels > 0);
const MODES = { picture: "Picture", error: "FLIP", difference: "|Δ|", signed: "±Δ" };
const hasErrors = report.cases.some(c => c.images.some(image => image.errorThumb));
const modes = Object.keys(MODES).filter(mode => mode !== "error" || hasErrors);

const state = {
  filters: new Map(report.axes.map(axis => [axis, new Set()])),  // an empty set lets all pass
  region: hasHair ? "hair" : "whole",
  metric: 0,
  sort: {},                                                       // by table: {column, down}
  grid: { method: null, mode: "picture" },
};

// ---- Numbers ------------------------------------------------------------------------------------------------------------

const number = x => x === null || x === undefined ? null : Number(x);
const measured = (image, metric) => number((image[state.region].length ? image[state.region] : image.whole)[metric]);

function mean(values) {
  const known = values.filter(x => x !== null);
  return known.length ? known.reduce((sum, x) => sum + x, 0) / known.length : null;
}

const axisValues = axis => {
  const values = [...new Set(report.cases.map(c => c.axes[axis]).filter(v => v !== undefined))];
  return values.every(v => typeof v === "number") ? values.sort((a, b) => a - b) : values;
};
const isNumeric = axis => axisValues(axis).every(v => typeof v === "number");
const passes = c => report.axes.every(axis => state.filters.get(axis).size === 0 || state.filters.get(axis).has(c.axes[axis]));
const chosenCases = () => report.cases.filter(passes);

/** The images of `method` in `cases` that are measured (a reference is not). */
const imagesOf = (cases, method) => cases.flatMap(c => c.images.filter(image => image.method === method && c.reference !== method)
                                                              .map(image => ({ c, image })));
const metricName = m => `${m.label} ${m.higher ? "↑" : "↓"}`;
const regionName = () => state.region === "hair" ? "hair pixels" : "whole image";

// ---- Parts that occur on both pages ---------------------------------------------------------------------------------------

function choices(label, options, isOn, choose, attributes = {}) {
  return h("div", { class: "choices", role: "group", "aria-label": label, ...attributes },
    h("span", { class: "choices-label" }, label),
    options.map(([value, text]) => h("button", { type: "button", "aria-pressed": String(isOn(value)), "data-value": value,
                                                 onclick: () => choose(value) }, text)));
}

const regionChoice = redraw => hasHair
  ? choices("Measured on", [["hair", "Hair pixels"], ["whole", "Whole image"]], v => v === state.region, v => { state.region = v; redraw(); })
  : null;

const methodName = name => h("span", { class: "method" }, h("i", { style: `--color: ${colorOf(name)}` }), methodOf.get(name).label);

/**
 * columns: [{label, title?, value: row => number or text, cell?: row => node, better?: "higher" | "lower"}]; the best of a
 * column with `better` is marked, with those that look the same, unless all of them do. A click on a head sorts by it.
 */
function sortableTable(id, columns, rows, { onRow, rowAttributes = () => ({}) } = {}, redraw) {
  const sort = state.sort[id] || { column: -1, down: false };
  const ranked = [...rows];
  if (sort.column >= 0) {
    const value = columns[sort.column].value, sign = sort.down ? -1 : 1;
    const known = v => v !== null && v !== undefined && v !== "";
    ranked.sort((a, b) => {
      const x = value(a), y = value(b);
      if (!known(x) || !known(y)) return known(y) - known(x);
      return sign * (typeof x === "string" ? x.localeCompare(y) : x - y);
    });
  }
  const best = columns.map(c => {
    const values = c.better ? rows.map(c.value).filter(v => typeof v === "number" && !Number.isNaN(v)) : [];
    return new Set(values.map(shown)).size > 1 ? shown(c.better === "higher" ? Math.max(...values) : Math.min(...values)) : null;
  });
  const head = columns.map((c, i) => h("th", { scope: "col", "aria-sort": sort.column !== i ? "none" : sort.down ? "descending" : "ascending" },
    h("button", { type: "button", title: c.title || null,
                  onclick: () => { state.sort[id] = { column: i, down: sort.column === i ? !sort.down : c.better === "higher" }; redraw(); } },
      c.label)));
  const body = ranked.map(row => h("tr", { ...rowAttributes(row), onclick: onRow ? () => onRow(row) : () => {} },
    columns.map((c, i) => {
      const value = c.value(row), isText = typeof value === "string";
      return h("td", { class: [isText ? "text" : "number", !isText && shown(value) === best[i] ? "best" : ""].join(" ").trim() },
               c.cell ? c.cell(row) : isText ? value : shown(value));
    })));
  return h("div", { class: "table-frame" }, h("table", { id }, h("thead", {}, h("tr", {}, head)), h("tbody", {}, body)));
}

// Those that at least one picture has.
const knownMetrics = report.metrics.map((_, i) => i).filter(i => report.cases.some(c => c.images.some(image => number(image.whole[i]) !== null)));
const metricColumns = valueOf => knownMetrics.map(i => ({
  label: metricName(report.metrics[i]), title: report.metrics[i].about, value: row => valueOf(row, i),
  better: report.metrics[i].higher ? "higher" : "lower" }));

// ---- The overview -----------------------------------------------------------------------------------------------------------

function masthead() {
  const count = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
  return h("header", { class: "masthead" },
    h("div", { class: "masthead-line" },
      h("p", { class: "colophon" }, `${count(report.cases.length, "case")} · ${count(report.methods.length, "method")} · Pelage ${report.version}`),
      themeButton()),
    h("h1", {}, report.title),
    report.about ? h("p", { class: "about" }, report.about) : null,
    report.machine ? h("p", { class: "machine" }, report.machine) : null);
}

function filterBar(redraw) {
  const axes = report.axes.filter(axis => axisValues(axis).length > 1);
  return h("nav", { class: "bar", "aria-label": "Filters" },
    axes.map(axis => {
      const filter = state.filters.get(axis);
      const toggle = value => {
        if (value === "") filter.clear();
        else filter.has(value) ? filter.delete(value) : filter.add(value);
        if (filter.size === axisValues(axis).length) filter.clear();
        redraw();
      };
      return choices(axis, [["", "all"], ...axisValues(axis).map(v => [v, String(v)])],
                     v => v === "" ? filter.size === 0 : filter.has(v), toggle, { "data-axis": axis });
    }),
    regionChoice(redraw));
}

function summaryTable(cases, redraw) {
  const rows = report.methods.map(m => ({ name: m.name, found: imagesOf(cases, m.name) })).filter(row => row.found.length > 0);
  const over = (row, value) => mean(row.found.map(value));
  const columns = [
    { label: "Method", value: row => methodOf.get(row.name).label, cell: row => methodName(row.name) },
    ...metricColumns((row, i) => over(row, ({ image }) => measured(image, i))),
    { label: "Seconds", title: "Mean time of a picture", value: row => over(row, ({ image }) => image.seconds || null) },
    { label: "Cases", value: row => row.found.length, cell: row => String(row.found.length) }];
  return h("section", { id: "summary" },
    h("h2", {}, "Summary"),
    h("p", { class: "note" }, `Means over ${cases.length} of ${report.cases.length} cases, on ${regionName()}. The best of each column is marked; a click on a head sorts.`),
    sortableTable("summary-table", columns, rows, { rowAttributes: row => ({ title: methodOf.get(row.name).about || null }) }, redraw));
}

const caseLabel = c => c.title;

/** Mean over cases of each method as a point (x from the image), the methods of a series joined. */
function methodPlot(cases, title, label, xOf, { faint = true } = {}) {
  const metric = report.metrics[state.metric];
  const series = [...new Set(report.methods.map(m => m.series))].map(name => {
    const points = [], cloud = [];
    for (const m of report.methods.filter(m => m.series === name)) {
      const found = imagesOf(cases, m.name).filter(({ image }) => xOf(image));
      if (found.length === 0) continue;
      const x = mean(found.map(({ image }) => xOf(image))), y = mean(found.map(({ image }) => measured(image, state.metric)));
      if (y === null) continue;
      points.push({ x, y, label: m.label, about: `${m.label}: ${shown(x)} ${label}, ${metric.label} ${shown(y)}` });
      if (faint && found.length > 1)
        for (const { c, image } of found)
          cloud.push({ x: xOf(image), y: measured(image, state.metric), about: `${caseLabel(c)}, ${m.label}: ${metric.label} ${shown(measured(image, state.metric))}` });
    }
    const first = report.methods.find(m => m.series === name);
    return { label: name, color: colorOf(first.name), points: points.sort((a, b) => a.x - b.x), faint: cloud.filter(p => p.y !== null) };
  });
  return plot({ title, x: { label }, y: { label: metricName(metric), mayBeLog: !metric.higher }, lines: series.filter(s => s.points.length) });
}

/** Mean of each method over the values of an axis. */
function axisPlot(cases, axis) {
  const metric = report.metrics[state.metric];
  const values = axisValues(axis).filter(v => cases.some(c => c.axes[axis] === v));
  const lines = report.methods.map(m => ({
    label: m.label, color: colorOf(m.name), faint: [],
    points: values.map(v => ({ x: v, y: mean(imagesOf(cases.filter(c => c.axes[axis] === v), m.name).map(({ image }) => measured(image, state.metric))) }))
                  .filter(p => p.y !== null).map(p => ({ ...p, about: `${m.label}, ${axis} ${p.x}: ${metric.label} ${shown(p.y)}` })) }));
  return plot({ title: `Over ${axis}`, x: { label: axis, words: isNumeric(axis) ? null : values, ticks: values.length <= 8 ? values : null },
                y: { label: metricName(metric), mayBeLog: !metric.higher }, lines: lines.filter(line => line.points.length) });
}

function metricChoice(redraw) {
  return choices("Metric", knownMetrics.map(i => [i, report.metrics[i].label]), v => v === state.metric, v => { state.metric = v; redraw(); }, { "data-choice": "metric" });
}

const varies = values => new Set(values.filter(Boolean)).size > 1;

function plots(cases, redraw) {
  const images = cases.flatMap(c => c.images.filter(image => image.method !== c.reference));
  const figures = [];
  if (varies(images.map(i => i.seconds))) figures.push(methodPlot(cases, "Over time", "seconds", i => i.seconds));
  if (varies(images.map(i => i.samples))) figures.push(methodPlot(cases, "Over samples", "samples per pixel", i => i.samples));
  for (const axis of report.axes) if (varies(cases.map(c => String(c.axes[axis] ?? "")))) figures.push(axisPlot(cases, axis));
  return h("section", { id: "plots" }, h("h2", {}, "Plots"),
    h("p", { class: "note" }, `Large dots are means over the chosen cases, small dots the cases; on ${regionName()}.`),
    metricChoice(redraw), h("div", { class: "figures" }, figures));
}

// The cases as a matrix where they have axes: the first down, the others across.
function caseGrid(cases, redraw) {
  const grid = state.grid;
  const methods = report.methods.filter(m => cases.some(c => c.images.some(image => image.method === m.name)));
  if (!methods.some(m => m.name === grid.method)) {
    const measuredMethod = methods.find(m => imagesOf(cases, m.name).length > 0);
    grid.method = (cases[0] && cases[0].reference) || (measuredMethod && measuredMethod.name);
  }
  const select = h("select", { "aria-label": "Method shown", onchange: event => { grid.method = event.target.value; redraw(); } },
    methods.map(m => h("option", { value: m.name, selected: m.name === grid.method }, m.label)));
  const controls = h("div", { class: "bar-inline" }, h("label", {}, h("span", { class: "choices-label" }, "Show"), select),
    hasErrors ? choices("as", [["picture", "Picture"], ["error", "FLIP"]], v => v === grid.mode, v => { grid.mode = v; redraw(); }) : null);
  const axes = report.axes.filter(axis => varies(cases.map(c => String(c.axes[axis] ?? ""))));
  const body = axes.length >= 2 ? caseMatrix(cases, axes) : h("div", { class: "case-flow" }, cases.map(c => caseCard(c, c.title)));
  return h("section", { id: "cases" }, h("h2", {}, "Cases"),
    h("p", { class: "note" }, "A picture opens its case. Bars show the metric of the plots, the longest being the worst of those shown."), controls, body);
}

function caseMatrix(cases, axes) {
  const [down, ...across] = axes;
  const key = c => across.map(axis => c.axes[axis]);
  const columns = [...new Map(cases.map(c => [JSON.stringify(key(c)), key(c)])).values()];
  const order = across.map(axisValues);
  columns.sort((a, b) => a.reduce((sum, v, i) => sum || order[i].indexOf(v) - order[i].indexOf(b[i]), 0));
  const rows = axisValues(down).filter(v => cases.some(c => c.axes[down] === v));
  const cell = (row, column) => cases.filter(c => c.axes[down] === row && JSON.stringify(key(c)) === JSON.stringify(column));
  const corner = (axis, isLast) => h("th", { class: "corner" },
    h("div", {}, h("span", {}, isLast ? `${down} ↓` : ""), h("span", {}, `${axis} →`)));
  const heads = across.map((axis, level) => h("tr", {}, corner(axis, level === across.length - 1),
    runs(columns.map(c => c.slice(0, level + 1))).map(([words, span]) => h("th", { colspan: span, class: "across" }, String(words.at(-1) ?? "")))));
  const body = rows.map(row => h("tr", {}, h("th", { scope: "row" }, String(row)),
    columns.map(column => h("td", {}, cell(row, column).map(c => caseCard(c, ""))))));
  return h("div", { class: "matrix-frame" }, h("table", { class: "matrix" }, h("thead", {}, heads), h("tbody", {}, body)));
}

// [words, how many in a row have them]
function runs(list) {
  const result = [];
  for (const words of list) {
    const last = result.at(-1);
    if (last && JSON.stringify(last[0]) === JSON.stringify(words)) ++last[1];
    else result.push([words, 1]);
  }
  return result;
}

function caseCard(c, caption) {
  const { method, mode } = state.grid, metric = report.metrics[state.metric];
  const image = c.images.find(i => i.method === method);
  if (!image) return h("span", { class: "card-empty" }, "–");
  const value = method === c.reference ? null : measured(image, state.metric);
  const all = chosenCases().flatMap(other => imagesOf([other], method)).map(({ image: i }) => measured(i, state.metric)).filter(Number.isFinite);
  const worst = Math.max(...all), least = metric.higher ? Math.min(...all) : 0;
  const share = value === null || !Number.isFinite(value) ? 0 : metric.higher ? (worst - value) / (worst - least || 1) : value / (worst || 1);
  return h("a", { class: "card", href: caseLink(c), title: `${c.title}${value === null ? "" : `\n${metric.label} ${shown(value)}`}` },
    h("img", { src: mode === "error" && image.errorThumb ? image.errorThumb : image.thumb, loading: "lazy", alt: c.title }),
    caption ? h("span", { class: "card-title" }, caption) : null,
    value === null ? null : h("span", { class: "card-value" }, h("i", { style: `width: ${(100 * share).toFixed(1)}%` }), shown(value)));
}

function overview() {
  const redraw = () => { const y = scrollY; show(overview()); scrollTo(0, y); };
  const cases = chosenCases();
  const nothing = h("p", { class: "message" }, "No case has all that is chosen.");
  return h("main", { class: "overview" }, masthead(), filterBar(redraw),
    cases.length === 0 ? nothing : [summaryTable(cases, redraw), caseGrid(cases, redraw), plots(cases, redraw)]);
}

// ---- Themes, keys, places -----------------------------------------------------------------------------------------------------

const isDark = () => (document.documentElement.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
function toggleTheme() {
  const theme = isDark() ? "light" : "dark";
  document.documentElement.dataset.theme = theme;
  try { localStorage.setItem("pelage-theme", theme); } catch { /* a browser may forbid storage to files */ }
}
function rememberedTheme() {
  try { return localStorage.getItem("pelage-theme"); } catch { return null; }
}
const themeButton = () => h("button", { type: "button", class: "plain", id: "theme", onclick: toggleTheme, title: "Light or dark (t)" }, "◐ theme");

const caseLink = (c, left, right) => {
  const parts = [`case=${report.cases.indexOf(c)}`];
  if (left) parts.push(`left=${encodeURIComponent(left)}`, `right=${encodeURIComponent(right)}`);
  return "#" + parts.join("&");
};

let closePage = () => {};
function show(page, close = () => {}) {
  closePage();
  closePage = close;
  document.getElementById("app").replaceChildren(page);
}

let shownPlace = null;
function route() {
  const place = new URLSearchParams(location.hash.slice(1));
  const c = report.cases[Number(place.get("case") ?? NaN)];
  const name = c ? `case ${place.get("case")}` : "overview";
  if (name === shownPlace && c) return;
  shownPlace = name;
  document.title = c ? `${c.title} – ${report.title}` : report.title;
  if (c) openCase(c, place.get("left"), place.get("right"));
  else show(overview());
  scrollTo(0, 0);
}

document.addEventListener("keydown", event => {
  if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return;
  if (event.key === "t") toggleTheme();
  else if (event.key === "?") showHelp();
});

const KEYS = [["wheel, + −", "zoom all pictures"], ["drag, arrows", "move all pictures"], ["double click, 0", "show the whole picture"],
  ["[ ]", "move the line between left and right"], ["1 … 9", "choose the right method; with Shift the left one"], ["x", "swap left and right"],
  ["e", "next kind of picture on the right and below"], ["click", "hold a pixel in the inspector; again lets it go"],
  ["n, p", "next and previous case"], ["Esc", "all cases"], ["t", "light or dark"], ["?", "this list"]];
function showHelp() {
  const dialog = document.getElementById("help");
  dialog.replaceChildren(h("h2", {}, "Keys"), h("dl", {}, KEYS.map(([key, what]) => [h("dt", {}, key), h("dd", {}, what)])),
    h("button", { type: "button", class: "plain", onclick: () => dialog.close() }, "Close"));
  dialog.showModal();
}

function start() {
  const theme = rememberedTheme();
  if (theme) document.documentElement.dataset.theme = theme;
  const failed = message => document.body.prepend(h("p", { class: "message" }, `This page has failed: ${message}`));
  addEventListener("error", event => failed(event.message));
  addEventListener("unhandledrejection", event => failed(event.reason));
  addEventListener("hashchange", route);
  route();
}
