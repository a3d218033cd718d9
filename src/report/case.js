// The page of one case: two pictures under a line to drag, all pictures below, numbers of the pixel under the pointer.

const loading = new Map();
pelage.receive = (index, packed) => loading.get(index)(packed);

/** The packed pixels of a case. A script beside the page brings them: files may load scripts, but not read files. */
function loadPacked(c) {
  const index = report.cases.indexOf(c);
  return new Promise((resolve, reject) => {
    loading.set(index, resolve);
    document.head.append(h("script", { src: c.data, onload: event => event.target.remove(),
                                       onerror: () => reject(new Error(`${c.data} is missing beside this page`)) }));
  });
}

let opening = 0;
async function openCase(c, left, right) {
  const turn = ++opening;
  show(h("main", {}, caseHead(c), h("p", { class: "message" }, "Unpacking the pictures …")));
  const pixels = await CasePixels.load(c, await loadPacked(c), report.errorColors);
  if (turn !== opening || shownPlace !== `case ${report.cases.indexOf(c)}`) return;
  const page = new CasePage(c, pixels, left, right);
  show(page.element, () => page.close());
}

function neighbor(c, step) {
  const cases = chosenCases().includes(c) ? chosenCases() : report.cases;
  return cases[(cases.indexOf(c) + step + cases.length) % cases.length];
}

function caseHead(c) {
  const place = report.axes.filter(axis => c.axes[axis] !== undefined).map(axis => `${axis} ${c.axes[axis]}`).join(" · ");
  return h("header", { class: "case-head" },
    h("div", { class: "masthead-line" },
      h("nav", { class: "crumbs" }, h("a", { href: "#" }, "← All cases"), h("a", { href: caseLink(neighbor(c, -1)) }, "previous"),
        h("a", { href: caseLink(neighbor(c, 1)) }, "next")),
      h("span", {}, h("button", { type: "button", class: "plain", onclick: showHelp, title: "Keys (?)" }, "keys"), themeButton())),
    h("h1", {}, c.title),
    c.about ? h("p", { class: "about" }, c.about) : null,
    h("p", { class: "machine" }, [place, `${c.width} × ${c.height} pixels`,
      c.hairPixels ? `${c.hairPixels} of hair` : null, `reference: ${methodOf.get(c.reference).label}`].filter(Boolean).join(" · ")));
}

class CasePage {
  constructor(c, pixels, left, right) {
    this.c = c;
    this.pixels = pixels;
    this.view = new View();
    this.modes = ["picture", "picture"];
    const index = name => c.images.findIndex(image => image.method === name);
    const others = c.images.map((_, i) => i).filter(i => i !== pixels.reference);
    this.sides = [index(left) >= 0 ? index(left) : others[0], index(right) >= 0 ? index(right) : pixels.reference];
    this.held = null;
    this.listeners = { onHover: place => this.inspect(place), onClick: place => this.hold(place) };
    this.build();
    this.onKey = event => this.key(event);
    document.addEventListener("keydown", this.onKey);
  }

  close() {
    document.removeEventListener("keydown", this.onKey);
    for (const pane of this.panes) pane.close();
  }

  // ---- Drawing ----

  build() {
    const { c, pixels } = this;
    this.slider = new Slider(this.view, c.width, c.height, side => pixels.canvas(this.sides[side], this.modes[side]), this.listeners);
    this.tags = [0, 1].map(side => h("span", { class: `tag ${side ? "right" : "left"}` }));
    this.slider.element.append(...this.tags);
    this.slider.element.style.setProperty("--aspect", c.width / c.height);
    this.strip = c.images.map((image, i) => {
      const pane = new Pane(this.view, c.width, c.height, () => [{ canvas: pixels.canvas(i, this.modes[1]), from: 0, to: 1 }], this.listeners);
      return { pane, element: h("figure", { class: "strip-pane", "data-method": image.method }, pane.canvas,
        h("figcaption", {}, methodName(image.method), h("span", { class: "strip-value" }))) };
    });
    this.panes = [this.slider.pane, ...this.strip.map(s => s.pane)];
    this.controls = h("div", { class: "controls" });
    this.inspector = h("div", { class: "inspector", "aria-live": "off" });
    this.numbers = h("div");
    this.element = h("main", { class: "case" }, caseHead(c),
      h("div", { class: "stage" }, h("div", { class: "stage-main" }, this.slider.element, this.legend = h("div", { class: "legend" })),
        h("aside", {}, this.controls, this.inspector)),
      h("section", { id: "strip" }, h("div", { class: "strip" }, this.strip.map(s => s.element))), this.numbers, this.reproduction());
    this.update();
    this.inspect({ x: Math.floor(c.width / 2), y: Math.floor(c.height / 2) });
  }

  update() {
    this.controls.replaceChildren(...this.controlNodes());
    this.tags.forEach((tag, side) => tag.replaceChildren(this.sideName(side)));
    this.numbers.replaceChildren(this.tableSection(), this.plotSection());
    this.legend.replaceChildren(...this.legendNodes());
    for (const { element } of this.strip) {
      const image = this.c.images.find(i => i.method === element.dataset.method);
      element.querySelector(".strip-value").textContent = image.method === this.c.reference ? "reference"
        : `${report.metrics[state.metric].label} ${shown(measured(image, state.metric))}`;
    }
    for (const pane of this.panes) pane.request();
    history.replaceState(null, "", caseLink(this.c, ...this.sides.map(i => this.c.images[i].method)));
  }

  sideName(side) {
    const name = methodOf.get(this.c.images[this.sides[side]].method).label;
    return this.modes[side] === "picture" ? name : `${name}, ${MODES[this.modes[side]]}`;
  }

  controlNodes() {
    const side = (k, label) => h("div", { class: "side-choice" },
      h("label", {}, h("span", { class: "choices-label" }, label),
        h("select", { id: k ? "right" : "left", onchange: event => { this.sides[k] = Number(event.target.value); this.update(); } },
          this.c.images.map((image, i) => h("option", { value: i, selected: i === this.sides[k] }, methodOf.get(image.method).label)))),
      choices("", modes.map(mode => [mode, MODES[mode]]), mode => mode === this.modes[k],
              mode => { this.modes[k] = mode; this.update(); }, { "data-side": k ? "right" : "left" }));
    const exposure = h("input", { type: "range", id: "exposure", min: -6, max: 6, step: 0.25, value: this.pixels.exposure,
      oninput: event => { this.setExposure(Number(event.target.value)); } });
    this.exposureText = h("output", {}, this.exposureName());
    return [side(0, "Left"), side(1, "Right"), h("label", { class: "exposure" }, h("span", { class: "choices-label" }, "Exposure"), exposure, this.exposureText)];
  }

  exposureName() { return `${this.pixels.exposure > 0 ? "+" : ""}${shortNumber(this.pixels.exposure)} stops`; }
  setExposure(stops) {
    this.pixels.setExposure(stops);
    this.exposureText.textContent = this.exposureName();
    for (const pane of this.panes) pane.request();
  }

  legendNodes() {
    const used = [...new Set(this.modes)].filter(mode => mode !== "picture");
    return used.map(mode => {
      const most = mode === "error" ? 1 : this.pixels.differenceScale, least = mode === "signed" ? -most : 0;
      const colors = Array.from({ length: 13 }, (_, i) => {
        const share = i / 12, index = Math.round(share * (report.errorColors.length - 1));
        return mode === "signed" ? `rgb(${signedColor(2 * share - 1).join()})` : report.errorColors[index];
      });
      return h("span", { class: "ramp" }, MODES[mode], h("span", {}, shown(least)),
        h("i", { style: `background: linear-gradient(to right, ${colors.join()})` }), h("span", {}, shown(most)));
    });
  }

  // ---- Inspector ----

  hold(place) {
    this.held = this.held ? null : place;
    this.inspect(place);
  }

  inspect(place) {
    const { x, y } = this.held || place;
    for (const pane of this.panes) {
      pane.marked = { x, y };
      pane.request();
    }
    const rows = this.c.images.map((image, i) => {
      const color = this.pixels.color(i, x, y), bytes = [0, 0, 0, 0];
      encodeColor(...color.map(v => v * 2 ** this.pixels.exposure), this.pixels.curve, bytes, 0);
      const error = i === this.pixels.reference ? null : this.pixels.error(i, x, y);
      return h("tr", { "data-method": image.method },
        h("td", {}, h("i", { class: "swatch", style: `background: rgb(${[...bytes].slice(0, 3).map(Math.round).join()})` }), methodOf.get(image.method).label),
        color.map(v => h("td", { class: "number" }, shown(v))), hasErrors ? h("td", { class: "number" }, error === null ? "" : shown(error)) : null);
    });
    this.inspector.replaceChildren(
      h("p", { class: "inspector-place" }, `Pixel ${x}, ${y}`, this.held ? h("span", { class: "held" }, "held") : null),
      h("table", {}, h("thead", {}, h("tr", {}, ["linear", "R", "G", "B", ...(hasErrors ? ["FLIP"] : [])].map(t => h("th", { scope: "col" }, t)))),
        h("tbody", {}, rows)));
  }

  // ---- Numbers ----

  tableSection() {
    const { c } = this, redraw = () => this.update();
    const columns = [
      { label: "Method", value: image => methodOf.get(image.method).label, cell: image => methodName(image.method) },
      ...metricColumns((image, i) => image.method === c.reference ? null : measured(image, i)),
      { label: "Samples", value: image => image.samples || null, cell: image => image.samples ? String(image.samples) : "–" },
      { label: "Seconds", value: image => image.seconds || null }];
    return h("section", { id: "numbers" }, h("h2", {}, "Numbers"),
      h("p", { class: "note" }, `Against ${methodOf.get(c.reference).label}, on ${regionName()}. A row puts its method on the right.`), regionChoice(redraw),
      sortableTable("case-table", columns, c.images, {
        onRow: image => { this.sides[1] = c.images.indexOf(image); this.update(); },
        rowAttributes: image => ({ class: image.method === c.reference ? "reference" : null, "data-method": image.method }) }, redraw));
  }

  plotSection() {
    const images = this.c.images.filter(image => image.method !== this.c.reference), figures = [];
    if (varies(images.map(i => i.seconds))) figures.push(methodPlot([this.c], "Over time", "seconds", i => i.seconds));
    if (varies(images.map(i => i.samples))) figures.push(methodPlot([this.c], "Over samples", "samples per pixel", i => i.samples));
    return figures.length ? h("section", { id: "plots" }, h("h2", {}, "Plots"), metricChoice(() => this.update()), h("div", { class: "figures" }, figures)) : h("span");
  }

  reproduction() {
    const { c } = this;
    const commands = c.images.filter(image => image.command).map(image => h("div", { class: "command" },
      h("div", { class: "command-head" }, methodName(image.method),
        h("button", { type: "button", class: "plain", onclick: event => {
          navigator.clipboard.writeText(image.command).then(() => { event.target.textContent = "copied"; }, () => { event.target.textContent = "select the text to copy it"; });
        } }, "copy")),
      h("pre", {}, image.command)));
    const settings = c.settings.map(([key, value]) => [h("dt", {}, key), h("dd", {}, value)]);
    const files = c.images.map(image => [h("dt", {}, methodOf.get(image.method).label), h("dd", {}, image.file)]);
    return h("section", { id: "reproduce" }, h("h2", {}, "How to make it again"),
      settings.length ? h("dl", { class: "settings" }, settings) : null, commands,
      h("details", {}, h("summary", {}, "Files"), h("dl", { class: "settings" }, files)));
  }

  // ---- Keys ----

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return;
    if (document.getElementById("help").open) return;
    const digit = /^Digit([1-9])$/.exec(event.code);
    const actions = {
      "+": () => this.view.zoomBy(1.5), "=": () => this.view.zoomBy(1.5), "-": () => this.view.zoomBy(1 / 1.5), "0": () => this.view.reset(),
      ArrowLeft: () => this.view.moveBy(-0.1, 0), ArrowRight: () => this.view.moveBy(0.1, 0),
      ArrowUp: () => this.view.moveBy(0, -0.1), ArrowDown: () => this.view.moveBy(0, 0.1),
      "[": () => this.slider.set(this.slider.split - 0.05), "]": () => this.slider.set(this.slider.split + 0.05),
      e: () => { this.modes[1] = modes[(modes.indexOf(this.modes[1]) + 1) % modes.length]; this.update(); },
      x: () => { this.sides.reverse(); this.modes.reverse(); this.update(); },
      n: () => { location.hash = caseLink(neighbor(this.c, 1)); }, p: () => { location.hash = caseLink(neighbor(this.c, -1)); },
      Escape: () => { location.hash = ""; } };
    if (digit && Number(digit[1]) <= this.c.images.length) {
      this.sides[event.shiftKey ? 0 : 1] = Number(digit[1]) - 1;
      this.update();
    } else if (actions[event.key]) actions[event.key]();
    else return;
    event.preventDefault();
  }
}

start();
