
// The stage: panes that show one part of several pictures.

class Viewer {
  constructor(stage, readout) {
    this.stage = stage;
    this.readout = readout;
    this.mode = "side";
    this.view = { zoom: 1, x: 0, y: 0 };
    this.isFitted = true;
    this.split = 0.5;
    this.blinkShows = "actual";
    this.exposure = 0;
    this.panes = [];
    new ResizeObserver(() => { this.setHeight(); this.draw(); }).observe(stage);
    stage.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    stage.addEventListener("pointerdown", (e) => this.grab(e));
    stage.addEventListener("pointermove", (e) => this.move(e));
    stage.addEventListener("pointerup", () => { this.drag = null; });
    stage.addEventListener("pointerleave", () => { readout.textContent = ""; });
    stage.addEventListener("dblclick", () => this.fit());
    setInterval(() => this.tick(), 600);
  }

  // layer: { width, height, actual, expected }, decoded; errors: names to functions that paint.
  show(layer, errors) {
    this.layer = layer;
    this.errors = errors;
    this.cache = new Map();
    this.setHeight();
    if (this.isFitted) this.fit(); else this.draw();
  }

  // As high as the panes need, within the window.
  setHeight() {
    if (!this.layer || !this.panes.length) return;
    const wanted = this.stage.clientWidth / this.panes.length * this.layer.height / this.layer.width;
    const height = `${Math.round(Math.min(Math.max(wanted, 200), 0.62 * innerHeight))}px`;
    if (this.stage.style.height !== height) this.stage.style.height = height;
  }

  setMode(mode) {
    this.mode = mode;
    this.isPaused = mode === "blink" && matchMedia("(prefers-reduced-motion: reduce)").matches;
    const panes = { side: ["actual", "expected", "error"], slider: ["slider"], blink: ["blink"], error: ["error"] };
    this.stage.replaceChildren();
    this.panes = panes[mode].map((what) => {
      const figure = document.createElement("figure");
      const canvas = document.createElement("canvas");
      const captions = what === "slider" ? ["actual", "expected"] : [what];
      figure.append(canvas, ...captions.map((text) => {
        const caption = document.createElement("figcaption");
        caption.textContent = text;
        return caption;
      }));
      this.stage.append(figure);
      return { what, canvas, caption: figure.querySelector("figcaption") };
    });
    this.setHeight();
    if (this.isFitted) this.fit(); else this.draw();
  }

  picture(what) {
    if (what === "error") {
      return this.cached(`${this.errorName} ${this.exposure}`, () => this.errors[this.errorName]?.(this.exposure));
    }
    const picture = this.layer[what];
    return picture && this.cached(`${what} ${this.exposure}`, () => develop(picture, this.exposure));
  }

  cached(key, make) {
    if (this.cache.size > 40) this.cache.clear();
    if (!this.cache.has(key)) this.cache.set(key, make());
    return this.cache.get(key);
  }

  fit() {
    this.isFitted = true;
    const box = this.panes[0]?.canvas.getBoundingClientRect();
    if (box?.width && this.layer) {
      this.view.zoom = Math.min(box.width / this.layer.width, box.height / this.layer.height);
      this.view.x = this.layer.width / 2;
      this.view.y = this.layer.height / 2;
    }
    this.draw();
  }

  zoomTo(zoom, x = this.view.x, y = this.view.y) {
    this.isFitted = false;
    this.view = { zoom: Math.min(Math.max(zoom, 0.05), 128), x, y };
    this.draw();
  }

  draw() {
    if (!this.layer) return;
    if (this.isFitted) {
      const box = this.panes[0]?.canvas.getBoundingClientRect();
      if (box?.width) this.view.zoom = Math.min(box.width / this.layer.width, box.height / this.layer.height);
    }
    for (const pane of this.panes) this.drawPane(pane);
  }

  drawPane({ what, canvas, caption }) {
    const ratio = devicePixelRatio || 1;
    const box = canvas.getBoundingClientRect();
    canvas.width = Math.round(box.width * ratio);
    canvas.height = Math.round(box.height * ratio);
    const context = canvas.getContext("2d");
    const paint = (name) => {
      const picture = this.picture(name);
      if (!picture) return;
      const { zoom, x, y } = this.view;
      const scale = zoom * ratio;
      // A map of a smaller picture covers the same pixels.
      const factor = name === "error" ? this.layer.width / picture.width : this.layer[name].factor;
      context.imageSmoothingEnabled = scale * factor < 1;
      context.setTransform(scale * factor, 0, 0, scale * factor, canvas.width / 2 - x * scale, canvas.height / 2 - y * scale);
      context.drawImage(picture, 0, 0);
      context.resetTransform();
    };
    if (what === "slider") {
      const middle = Math.round(this.split * canvas.width);
      const part = (name, from, to) => {
        context.save();
        context.beginPath();
        context.rect(from, 0, to - from, canvas.height);
        context.clip();
        paint(name);
        context.restore();
      };
      part("actual", 0, middle);
      part("expected", middle, canvas.width);
      context.fillStyle = "#fff";
      context.fillRect(middle - ratio, 0, 2 * ratio, canvas.height);
      context.fillStyle = "#0008";
      context.fillRect(middle + ratio, 0, ratio, canvas.height);
    } else if (what === "blink") {
      caption.textContent = this.blinkShows;
      paint(this.blinkShows);
    } else {
      if (what === "error") caption.textContent = this.errorName ?? "no error map";
      paint(what);
    }
  }

  tick() {
    if (this.mode === "blink" && !this.isPaused && !document.hidden) this.flip();
  }

  flip() {
    this.blinkShows = this.blinkShows === "actual" ? "expected" : "actual";
    this.draw();
  }

  // Position in the picture under the pointer.
  locate(event) {
    const canvas = event.target.closest?.("canvas") ?? this.panes[0].canvas;
    const box = canvas.getBoundingClientRect();
    const { zoom, x, y } = this.view;
    return {
      x: (event.clientX - box.left - box.width / 2) / zoom + x,
      y: (event.clientY - box.top - box.height / 2) / zoom + y,
      share: (event.clientX - box.left) / box.width,
    };
  }

  wheel(event) {
    event.preventDefault();
    const at = this.locate(event);
    const zoom = Math.min(Math.max(this.view.zoom * Math.exp(-event.deltaY / 300), 0.05), 128);
    const keep = this.view.zoom / zoom;
    this.zoomTo(zoom, at.x + (this.view.x - at.x) * keep, at.y + (this.view.y - at.y) * keep);
  }

  grab(event) {
    this.stage.setPointerCapture?.(event.pointerId);
    const at = this.locate(event);
    const isOnSplit = this.mode === "slider" && !event.shiftKey;
    this.drag = { isOnSplit, x: event.clientX, y: event.clientY };
    if (isOnSplit) this.moveSplit(event);
    this.tell(at);
  }

  moveSplit(event) {
    const box = this.panes[0].canvas.getBoundingClientRect();
    this.split = Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
    this.draw();
  }

  move(event) {
    if (this.drag?.isOnSplit) {
      this.moveSplit(event);
    } else if (this.drag) {
      const { zoom, x, y } = this.view;
      this.zoomTo(zoom, x - (event.clientX - this.drag.x) / zoom, y - (event.clientY - this.drag.y) / zoom);
      this.drag.x = event.clientX;
      this.drag.y = event.clientY;
    }
    this.tell(this.locate(event));
  }

  // The values under the pointer.
  tell({ x, y }) {
    const layer = this.layer;
    if (!layer || x < 0 || y < 0 || x >= layer.width || y >= layer.height) {
      this.readout.textContent = "";
      return;
    }
    const values = (picture) => {
      if (!picture) return "none";
      const index = Math.floor(y / picture.factor) * picture.width + Math.floor(x / picture.factor);
      const text = picture.channels.map((name, c) => {
        const value = valueAt(picture, c, index);
        return picture.isHalf ? `${name} ${value.toPrecision(4)}` : `${name} ${picture.planes[c][index]}`;
      });
      return text.join("  ");
    };
    const unit = layer.actual && !layer.actual.isHalf ? " (8-bit sRGB)" : "";
    this.readout.textContent = `(${Math.floor(x)}, ${Math.floor(y)})   actual ${values(layer.actual)}   `
      + `expected ${values(layer.expected)}${unit}`;
  }
}
