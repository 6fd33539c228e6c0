// Made-up pictures to try: striated cells, drawn as they are asked for.

/** Size of a pixel of each, um. */
export const PIXEL_UM = 0.25;

/**
 * A cell: where its middle is, half of its length and width, um, and its angle.
 *
 * @typedef {{ at: [number, number], half: [number, number], angle: number }} Drawn
 */

/** @type {Record<string, { cells: Drawn[], spots: number }>} */
export const SAMPLES = {
  "one cell": { cells: [{ at: [75, 40], half: [55, 12], angle: 0.2 }], spots: 0 },
  "two cells": { cells: [{ at: [75, 22], half: [55, 10], angle: 0.05 }, { at: [70, 58], half: [45, 13], angle: -0.1 }], spots: 0 },
  "a cell among debris": { cells: [{ at: [75, 40], half: [50, 13], angle: -0.25 }], spots: 25 },
};

/** Period of the sarcomeres, um. */
const SARCOMERE = 1.9;
const [WIDTH, HEIGHT] = [600, 320];

/** A picture as PNG. @param {string} name @returns {Promise<Uint8Array>} */
export async function drawn(name) {
  const { cells, spots } = SAMPLES[name];
  let seed = 11;
  const uniform = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const debris = Array.from({ length: spots }, () => ({ x: 150 * uniform(), y: 80 * uniform(), size: 0.5 + uniform() }));
  const canvas = new OffscreenCanvas(WIDTH, HEIGHT);
  const context = canvas.getContext("2d");
  if (context === null) throw new Error("this browser draws no pictures");
  const pixels = new ImageData(WIDTH, HEIGHT);
  for (let at = 0; at < WIDTH * HEIGHT; at++) {
    const [x, y] = [(at % WIDTH) * PIXEL_UM, Math.floor(at / WIDTH) * PIXEL_UM];
    const light = cells.reduce((most, cell) => Math.max(most, cellAt(cell, x, y)), 0);
    const spot = debris.reduce((sum, { x: a, y: b, size }) => sum + 60 * Math.exp(-((x - a) ** 2 + (y - b) ** 2) / (2 * size ** 2)), 0);
    const grey = 18 + light + spot + 10 * (uniform() + uniform() - 1);
    pixels.data.set([grey, grey, grey, 255], 4 * at);
  }
  context.putImageData(pixels, 0, 0);
  return new Uint8Array(await (await canvas.convertToBlob({ type: "image/png" })).arrayBuffer());
}

/** Light of a cell at a place: a rounded rod with stripes across. @param {Drawn} cell @param {number} x @param {number} y */
function cellAt({ at, half, angle }, x, y) {
  const [dx, dy] = [x - at[0], y - at[1]];
  const [along, across] = [dx * Math.cos(angle) + dy * Math.sin(angle), dy * Math.cos(angle) - dx * Math.sin(angle)];
  // Between an ellipse and a rectangle.
  const inside = 1 - ((along / half[0]) ** 4 + (across / half[1]) ** 4) ** 0.25;
  const edge = 1 / (1 + Math.exp(-inside * half[1] * 2));
  return edge * (95 + 55 * Math.cos((2 * Math.PI * along) / SARCOMERE));
}
