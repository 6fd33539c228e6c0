// Patches with depth, pixel by pixel: what is nearer hides what is behind it.

import { STEPS } from "./colours.js";

/** Steps from dark to light. */
const LIGHTS = 32;
/** Numbers of a point. */
export const SIZE = 6;
/** Width of lines, px. */
const LINE = 2;
/** By how much a pixel between two triangles may seem to lie outside of both. */
const ROUNDING = 1e-6;

/** A picture that patches are drawn into. */
export class Pixels {
  canvas = document.createElement("canvas");
  #width = 0;
  #height = 0;
  /** The pixels between which something was drawn. */
  #first = 0;
  #last = 0;
  #nearness = new Float32Array(0);
  #colours = new Uint32Array(0);
  /** Of each step of a scale, dark to light. */
  #table = new Uint32Array(STEPS * LIGHTS);
  /** @type {string[] | null} */
  #painted = null;

  /** Empties it and gives it a size, px of its own. @param {number} width @param {number} height */
  clear(width, height) {
    if (width !== this.#width || height !== this.#height) {
      [this.#width, this.#height] = [this.canvas.width, this.canvas.height] = [width, height];
      this.#nearness = new Float32Array(width * height);
      this.#colours = new Uint32Array(width * height);
    }
    [this.#first, this.#last] = [this.#nearness.length, 0];
    this.#nearness.fill(-Infinity);
    this.#colours.fill(0);
  }

  /** Gives it its colours. @param {string[]} stops @param {(stops: string[]) => string[]} ramp */
  paint(stops, ramp) {
    if (this.#painted === stops) return;
    this.#painted = stops;
    ramp(stops).forEach((colour, step) => {
      const channels = (colour.match(/\d+/g) ?? []).map(Number);
      for (let light = 0; light < LIGHTS; light++) {
        const [red, green, blue] = channels.map((channel) => Math.round((channel * light) / (LIGHTS - 1)));
        this.#table[step * LIGHTS + light] = (255 << 24) | (blue << 16) | (green << 8) | red;
      }
    });
  }

  /**
   * Draws patches. Backs are drawn only if the surface is cut open, and without shading.
   *
   * @param {Float32Array} points Of each in turn: x, y in px, how near, part of the scale 0 to 1, light 0 to 1, depth: what is below 0
   *   is not drawn.
   * @param {Uint32Array} corners Four of each patch, counter-clockwise as seen from outside.
   * @param {boolean} isOpen
   */
  patches(points, corners, isOpen) {
    for (let first = 0; first < corners.length; first += 4) {
      this.#triangle(points, SIZE * corners[first], SIZE * corners[first + 1], SIZE * corners[first + 2], isOpen);
      this.#triangle(points, SIZE * corners[first], SIZE * corners[first + 2], SIZE * corners[first + 3], isOpen);
    }
  }

  /** @param {Float32Array} p @param {number} a @param {number} b @param {number} c @param {boolean} isOpen */
  #triangle(p, a, b, c, isOpen) {
    const [ax, ay, bx, by, cx, cy] = [p[a], p[a + 1], p[b], p[b + 1], p[c], p[c + 1]];
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    // y runs downward.
    if (!(area < 0 || (isOpen && area > 0)) || Math.max(p[a + 5], p[b + 5], p[c + 5]) < 0) return;
    const [left, top] = [Math.max(Math.ceil(Math.min(ax, bx, cx)), 0), Math.max(Math.ceil(Math.min(ay, by, cy)), 0)];
    const right = Math.min(Math.floor(Math.max(ax, bx, cx)), this.#width - 1);
    const bottom = Math.min(Math.floor(Math.max(ay, by, cy)), this.#height - 1);
    this.#first = Math.min(this.#first, top * this.#width);
    this.#last = Math.max(this.#last, (bottom + 1) * this.#width);
    // Shares of b and c grow evenly along a row; what each point has is a's plus these shares of the differences.
    const [perB, perC] = [(cy - ay) / area, (ay - by) / area];
    const [near, nearB, nearC] = [p[a + 2], p[b + 2] - p[a + 2], p[c + 2] - p[a + 2]];
    const [part, partB, partC] = [p[a + 3], p[b + 3] - p[a + 3], p[c + 3] - p[a + 3]].map((each) => each * STEPS);
    const lights = area < 0 ? [p[a + 4], p[b + 4] - p[a + 4], p[c + 4] - p[a + 4]] : [1, 0, 0];
    const [light, lightB, lightC] = lights.map((each) => each * (LIGHTS - 1));
    const [depth, depthB, depthC] = [p[a + 5], p[b + 5] - p[a + 5], p[c + 5] - p[a + 5]];
    const [width, nearness, colours, table] = [this.#width, this.#nearness, this.#colours, this.#table];
    for (let y = top; y <= bottom; y++) {
      let b = (left - ax) * perB - ((y - ay) * (cx - ax)) / area;
      let c = (left - ax) * perC + ((y - ay) * (bx - ax)) / area;
      for (let at = y * width + left; at <= y * width + right; at++, b += perB, c += perC) {
        if (b < -ROUNDING || c < -ROUNDING || b + c > 1 + ROUNDING) continue;
        const now = near + b * nearB + c * nearC;
        if (now <= nearness[at] || depth + b * depthB + c * depthC < 0) continue;
        nearness[at] = now;
        const step = Math.min(Math.max(Math.floor(part + b * partB + c * partC), 0), STEPS - 1);
        colours[at] = table[step * LIGHTS + Math.round(light + b * lightB + c * lightC)];
      }
    }
  }

  /** Draws a line along the rim of what was drawn. @param {string} colour `#rrggbb`. */
  outline(colour) {
    const [red, green, blue] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
    const ink = (255 << 24) | (blue << 16) | (green << 8) | red;
    const [nearness, colours, row] = [this.#nearness, this.#colours, LINE * this.#width];
    for (let at = Math.max(this.#first, row); at < Math.min(this.#last, nearness.length - row); at++) {
      // Of four that lie around what was drawn none is endlessly far.
      if (colours[at] !== 0 && Math.min(nearness[at - LINE], nearness[at + LINE], nearness[at - row], nearness[at + row]) === -Infinity) {
        colours[at] = ink;
      }
    }
  }

  /** Shows what was drawn on its canvas. */
  show() {
    const bytes = new Uint8ClampedArray(this.#colours.buffer);
    this.canvas.getContext("2d")?.putImageData(new ImageData(bytes, this.#width, this.#height), 0, 0);
  }
}
