"use strict";
// Pictures in memory: how they come out of the files beside the page, and how they become colors.

const pelage = {};

// ---- Unpacking; the way there is src/report/pack.cpp. ----------------------------------------------------------------

const HALF_TO_FLOAT = (() => {
  const table = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const exponent = (bits >> 10) & 31, mantissa = bits & 1023;
    const size = exponent === 0 ? mantissa * 2 ** -24
               : exponent === 31 ? (mantissa ? NaN : Infinity)
               : (1 + mantissa / 1024) * 2 ** (exponent - 15);
    table[bits] = bits & 0x8000 ? -size : size;
  }
  return table;
})();

async function inflated(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function unpackHalves(base64) {
  const bytes = await inflated(base64), count = bytes.length / 2;
  const values = new Uint16Array(count);
  let value = 0;
  for (let i = 0; i < count; ++i) values[i] = value = (value + (bytes[i] << 8 | bytes[i + count])) & 0xffff;
  return values;
}

async function unpackBytes(base64) {
  const bytes = await inflated(base64);
  let value = 0;
  for (let i = 0; i < bytes.length; ++i) bytes[i] = value = (value + bytes[i]) & 0xff;
  return bytes;
}

// ---- From radiance to a display: src/kernel/composite/tonemap.h again, for an exposure that the reader may change. ----

const SRGB_STEPS = 65535;
const SRGB_ENCODED = (() => {
  const table = new Uint8ClampedArray(SRGB_STEPS + 1);
  for (let i = 0; i <= SRGB_STEPS; ++i) {
    const x = i / SRGB_STEPS;
    table[i] = 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
  }
  return table;
})();
const srgbEncoded = x => SRGB_ENCODED[x <= 0 ? 0 : x >= 1 ? SRGB_STEPS : Math.round(x * SRGB_STEPS)];

const acesCurve = x => (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081);
const limited = x => Math.min(Math.max(x, 0), 1e6);

// Writes the display color of one linear color as four bytes.
function encodeColor(red, green, blue, curve, out, at) {
  if (curve === "aces") {
    red = limited(red), green = limited(green), blue = limited(blue);
    const r = acesCurve(0.59719 * red + 0.35458 * green + 0.04823 * blue);
    const g = acesCurve(0.07600 * red + 0.90834 * green + 0.01566 * blue);
    const b = acesCurve(0.02840 * red + 0.13383 * green + 0.83777 * blue);
    red = 1.60475 * r - 0.53108 * g - 0.07367 * b;
    green = 1.10813 * g - 0.10208 * r - 0.00605 * b;
    blue = 1.07602 * b - 0.00327 * r - 0.07276 * g;
  }
  out[at] = srgbEncoded(red), out[at + 1] = srgbEncoded(green), out[at + 2] = srgbEncoded(blue), out[at + 3] = 255;
}

// ---- Error colors -------------------------------------------------------------------------------------------------------

const hexColor = text => [1, 3, 5].map(i => parseInt(text.slice(i, i + 2), 16));

// Blue, white, red for −1, 0, 1.
function signedColor(x) {
  const t = Math.min(Math.abs(x), 1), fade = part => Math.round(244 + (part - 244) * t ** 0.7);
  return x < 0 ? [fade(33), fade(102), fade(172)] : [fade(178), fade(24), fade(43)];
}

/** The pictures of one case, unpacked, and everything that is drawn from them. */
class CasePixels {
  static async load(info, packed, errorColors) {
    const pictures = await Promise.all(packed.map(async p => ({
      halves: await unpackHalves(p.pixels), error: p.error ? await unpackBytes(p.error) : null })));
    return new CasePixels(info, pictures, errorColors);
  }

  constructor(info, pictures, errorColors) {
    this.width = info.width;
    this.height = info.height;
    this.curve = info.toneMap;
    this.pictures = pictures;
    this.reference = info.images.findIndex(image => image.method === info.reference);
    this.errorColors = errorColors.map(hexColor);
    this.exposure = 0;
    this.canvases = new Map();
    this.differenceScale = this.findDifferenceScale();
  }

  /** Linear R, G, B of picture `index` at (x, y). */
  color(index, x, y) {
    const pixel = y * this.width + x, count = this.width * this.height, halves = this.pictures[index].halves;
    return [0, 1, 2].map(c => HALF_TO_FLOAT[halves[c * count + pixel]]);
  }

  /** The library's error at (x, y), 0…1, or null. */
  error(index, x, y) {
    const error = this.pictures[index].error;
    return error ? error[y * this.width + x] / 255 : null;
  }

  /** Mean over R, G and B of picture `index` minus reference, at `pixel`. */
  difference(index, pixel) {
    const a = this.pictures[index].halves, b = this.pictures[this.reference].halves, count = this.width * this.height;
    let sum = 0;
    for (let i = pixel; i < 3 * count; i += count) sum += HALF_TO_FLOAT[a[i]] - HALF_TO_FLOAT[b[i]];
    return sum / 3;
  }

  // One scale for all methods of the case, so that their maps can be compared: the 99th percentile.
  findDifferenceScale() {
    const sizes = [];
    for (let index = 0; index < this.pictures.length; ++index)
      if (index !== this.reference)
        for (let pixel = 0; pixel < this.width * this.height; pixel += 3) {
          const size = Math.abs(this.difference(index, pixel));
          if (size > 0) sizes.push(size);
        }
    return Float32Array.from(sizes).sort()[Math.floor(0.99 * sizes.length)] || 1;
  }

  setExposure(stops) {
    this.exposure = stops;
    for (const key of [...this.canvases.keys()]) if (key.startsWith("picture")) this.canvases.delete(key);
  }

  /** A canvas of the size of the picture; `mode` is picture, error, difference or signed. */
  canvas(index, mode) {
    const key = `${mode} ${index}`;
    if (!this.canvases.has(key)) this.canvases.set(key, this.painted(index, mode));
    return this.canvases.get(key);
  }

  painted(index, mode) {
    const canvas = document.createElement("canvas");
    canvas.width = this.width, canvas.height = this.height;
    const context = canvas.getContext("2d"), image = context.createImageData(this.width, this.height);
    if (mode === "picture") this.paintPicture(index, image.data);
    else this.paintError(index, mode, image.data);
    context.putImageData(image, 0, 0);
    return canvas;
  }

  paintPicture(index, out) {
    const halves = this.pictures[index].halves, count = this.width * this.height, gain = 2 ** this.exposure;
    for (let i = 0; i < count; ++i)
      encodeColor(gain * HALF_TO_FLOAT[halves[i]], gain * HALF_TO_FLOAT[halves[i + count]],
                  gain * HALF_TO_FLOAT[halves[i + 2 * count]], this.curve, out, 4 * i);
  }

  paintError(index, mode, out) {
    const error = this.pictures[index].error, last = this.errorColors.length - 1;
    for (let i = 0; i < this.width * this.height; ++i) {
      const difference = mode === "error" ? 0 : this.difference(index, i) / this.differenceScale;
      const share = mode === "error" ? (error ? error[i] / 255 : 0) : Math.min(Math.abs(difference), 1);
      out.set(mode === "signed" ? signedColor(difference) : this.errorColors[Math.round(share * last)], 4 * i);
      out[4 * i + 3] = 255;
    }
  }
}
