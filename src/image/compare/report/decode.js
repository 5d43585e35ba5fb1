"use strict";

// Pixels as they are stored (see pixels.rs), and as they are shown.

const report = JSON.parse(document.getElementById("data").textContent);

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// One array per channel: sRGB codes, or the bits of 16-bit floats.
async function decode(picture) {
  const bytes = await inflate(picture.data);
  const pixels = picture.width * picture.height;
  const isHalf = picture.format === "f16";
  const planes = picture.channels.map((_, c) => {
    const plane = isHalf ? new Uint16Array(pixels) : new Uint8Array(pixels);
    const at = c * pixels * (isHalf ? 2 : 1);
    for (let i = 0; i < pixels; i++) {
      const left = i % picture.width === 0 ? 0 : plane[i - 1];
      plane[i] = (isHalf ? (bytes[at + i] << 8) | bytes[at + pixels + i] : bytes[at + i]) + left;
    }
    return plane;
  });
  return { ...picture, data: undefined, isHalf, planes };
}

function linearFromSrgb(v) {
  return v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4);
}

function srgbFromLinear(v) {
  return v <= 0.0031308 ? v * 12.92 : 1.055 * Math.pow(v, 1 / 2.4) - 0.055;
}

// The number behind every 16-bit float.
const HALVES = (() => {
  const table = new Float32Array(65536);
  for (let h = 0; h < 65536; h++) {
    const sign = h & 0x8000 ? -1 : 1;
    const exponent = (h >> 10) & 31;
    const fraction = h & 1023;
    table[h] = exponent === 31 ? (fraction ? NaN : sign * Infinity)
      : exponent === 0 ? sign * fraction * 2 ** -24
      : sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
  }
  return table;
})();

const CODES = Float32Array.from({ length: 256 }, (_, code) => linearFromSrgb(code / 255));

function valueTable(picture) {
  return picture.isHalf ? HALVES : CODES;
}

// Linear value of a channel.
function valueAt(picture, channel, index) {
  return valueTable(picture)[picture.planes[channel][index]];
}

const MARK = [255, 0, 255];

// A canvas of a picture's own size; not-finite values are magenta.
function develop(picture, exposure) {
  const scale = 2 ** exposure;
  const shown = Float32Array.from(valueTable(picture), (v) =>
    Number.isFinite(v) ? 255 * srgbFromLinear(Math.min(Math.max(v * scale, 0), 1)) : -1);
  const planes = picture.planes;
  return paint(picture, (i) => {
    const pixel = [0, 1, 2].map((c) => shown[(planes[c] ?? (planes.length === 1 ? planes[0] : null))?.[i] ?? 0]);
    return pixel.some((v) => v < 0) ? MARK : pixel;
  });
}

function paint({ width, height }, colour) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  for (let i = 0; i < width * height; i++) {
    const [r, g, b] = colour(i);
    image.data.set([Math.round(r), Math.round(g), Math.round(b), 255], 4 * i);
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

// White where two pictures agree, red where the first is brighter, blue where darker.
function signedDifference(a, b, exposure) {
  const scale = 2 ** exposure;
  const channels = a.planes.length;
  return paint(a, (i) => {
    let sum = 0;
    for (let c = 0; c < channels; c++) sum += valueAt(a, c, i) - valueAt(b, c, i);
    return diverging((sum / channels) * scale * 4);
  });
}

// -1 blue, 0 white, 1 red.
function diverging(t) {
  if (!Number.isFinite(t)) return MARK;
  const s = Math.min(Math.abs(t), 1);
  const end = t > 0 ? [178, 24, 43] : [33, 102, 172];
  return end.map((c) => 247 + (c - 247) * s);
}

function errorColours(map) {
  return paint(map, (i) => report.magma[map.planes[0][i]]);
}

// z of every tile, 8 or more in full colour.
function tileColours(verdict, plane, width, height) {
  return paint({ width, height }, (i) => {
    const column = Math.floor((i % width) / verdict.tile);
    const row = Math.floor(Math.floor(i / width) / verdict.tile);
    return diverging(plane.tiles[row * verdict.tile_columns + column] / 8);
  });
}
