// Pictures to move about in: many canvases that all look at the same place.

/** The place: zoom 1 shows the whole picture, (x, y) is the picture's point in the middle of every canvas, 0…1. */
class View {
  constructor() {
    this.listeners = new Set();
    this.reset();
  }
  reset() { this.set(1, 0.5, 0.5); }
  set(zoom, x, y) {
    this.zoom = Math.min(Math.max(zoom, 1), 256);
    const half = 0.5 / this.zoom, kept = v => Math.min(Math.max(v, half), 1 - half);
    this.x = kept(x), this.y = kept(y);
    this.changed();
  }
  changed() { for (const listener of this.listeners) listener(); }
  /** Changes the zoom; what is at the share (u, v) of a canvas, counted from its middle, stays there. */
  zoomBy(factor, u = 0, v = 0) {
    const zoom = Math.min(Math.max(this.zoom * factor, 1), 256);
    this.set(zoom, this.x + u / this.zoom - u / zoom, this.y + v / this.zoom - v / zoom);
  }
  /** Moves by shares of a canvas. */
  moveBy(u, v) { this.set(this.zoom, this.x + u / this.zoom, this.y + v / this.zoom); }
}

/** One canvas on a view. `layers()` gives [{canvas, from, to}]: what is drawn between two shares of the width. */
class Pane {
  constructor(view, width, height, layers, { onHover, onClick } = {}) {
    Object.assign(this, { view, width, height, layers, onHover, onClick, marked: null });
    this.canvas = h("canvas", { class: "pane" });
    this.canvas.style.aspectRatio = `${width} / ${height}`;
    this.drawn = () => this.request();
    view.listeners.add(this.drawn);
    this.observer = new ResizeObserver(this.drawn);
    this.observer.observe(this.canvas);
    this.listen();
  }
  close() {
    this.view.listeners.delete(this.drawn);
    this.observer.disconnect();
  }

  // Many changes, one drawing a frame.
  request() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.draw(); });
  }

  draw() {
    const ratio = devicePixelRatio || 1, box = this.canvas.getBoundingClientRect();
    const w = Math.round(box.width * ratio), height = Math.round(box.height * ratio);
    if (w === 0 || height === 0) return;
    if (this.canvas.width !== w || this.canvas.height !== height) this.canvas.width = w, this.canvas.height = height;
    const context = this.canvas.getContext("2d"), scale = w / this.width * this.view.zoom;
    context.imageSmoothingEnabled = scale < 2;
    context.imageSmoothingQuality = "high";
    const left = w / 2 - this.view.x * this.width * scale, top = height / 2 - this.view.y * this.height * scale;
    for (const layer of this.layers()) {
      context.save();
      context.beginPath();
      context.rect(Math.round(layer.from * w), 0, Math.round(layer.to * w) - Math.round(layer.from * w), height);
      context.clip();
      context.drawImage(layer.canvas, left, top, this.width * scale, this.height * scale);
      context.restore();
    }
    if (this.marked) this.drawMark(context, left, top, scale, ratio);
    Object.assign(this.canvas.dataset, { zoom: this.view.zoom, x: this.view.x, y: this.view.y });
  }

  drawMark(context, left, top, scale, ratio) {
    const size = Math.max(scale, 7 * ratio), middle = v => (v + 0.5) * scale - size / 2;
    for (const [color, width] of [["#000", 3], ["#fff", 1.2]]) {
      context.strokeStyle = color, context.lineWidth = width * ratio;
      context.strokeRect(left + middle(this.marked.x), top + middle(this.marked.y), size, size);
    }
  }

  /** Where an event is: shares of the canvas from its middle, and the picture's pixel. */
  place(event) {
    const box = this.canvas.getBoundingClientRect();
    const u = (event.clientX - box.left) / box.width - 0.5, v = (event.clientY - box.top) / box.height - 0.5;
    const pixel = (share, count) => Math.min(Math.max(Math.floor(share * count), 0), count - 1);
    return { u, v, x: pixel(this.view.x + u / this.view.zoom, this.width), y: pixel(this.view.y + v / this.view.zoom, this.height) };
  }

  listen() {
    const canvas = this.canvas;
    let grip = null;
    canvas.addEventListener("wheel", event => {
      event.preventDefault();
      const { u, v } = this.place(event);
      this.view.zoomBy(2 ** (-event.deltaY / (event.deltaMode === 0 ? 240 : 6)), u, v);
    }, { passive: false });
    canvas.addEventListener("pointerdown", event => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      grip = { ...this.place(event), moved: 0 };
    });
    canvas.addEventListener("pointermove", event => {
      const here = this.place(event);
      if (grip) {
        this.view.moveBy(grip.u - here.u, grip.v - here.v);
        grip = { ...here, moved: grip.moved + Math.abs(event.movementX) + Math.abs(event.movementY) };
      }
      if (this.onHover) this.onHover(here);
    });
    canvas.addEventListener("pointerup", event => {
      if (grip && grip.moved < 4 && this.onClick) this.onClick(this.place(event));
      grip = null;
    });
    canvas.addEventListener("pointercancel", () => { grip = null; });
    canvas.addEventListener("dblclick", () => this.view.reset());
  }
}

/** Two pictures in one pane, and the line between them to drag. `side(0)` and `side(1)` give the canvases. */
class Slider {
  constructor(view, width, height, side, listeners) {
    this.split = 0.5;
    this.pane = new Pane(view, width, height, () => [
      { canvas: side(0), from: 0, to: this.split }, { canvas: side(1), from: this.split, to: 1 }], listeners);
    this.handle = h("div", { class: "slider-handle", role: "slider", tabindex: 0, "aria-label": "Line between left and right",
                             "aria-valuemin": 0, "aria-valuemax": 100 }, h("span", { class: "slider-grip" }, "◂▸"));
    this.element = h("div", { class: "slider" }, this.pane.canvas, this.handle);
    this.handle.addEventListener("pointerdown", event => {
      event.preventDefault();
      this.handle.setPointerCapture(event.pointerId);
      this.handle.focus({ preventScroll: true });
    });
    this.handle.addEventListener("pointermove", event => {
      if (!this.handle.hasPointerCapture(event.pointerId)) return;
      const box = this.pane.canvas.getBoundingClientRect();
      this.set((event.clientX - box.left) / box.width);
    });
    this.handle.addEventListener("keydown", event => {
      const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      this.set(this.split + step);
    });
    this.set(0.5);
  }
  set(split) {
    this.split = Math.min(Math.max(split, 0), 1);
    this.handle.style.left = `${100 * this.split}%`;
    this.handle.setAttribute("aria-valuenow", Math.round(100 * this.split));
    this.pane.request();
  }
}
