// Draws a cell on a canvas: its colour, its smooth outline, where it rested, a scale bar.

import { ramp, STEPS, stepOf } from "./colours.js";
import { blankShape } from "./data.js";
import { Sheet, traceRings } from "./drawing.js";
import { fillField } from "./fields.js";

/** @import { Box, Ink, Place } from "./drawing.js" */
/** @import { Field } from "./payload.js" */
/** @import { Shapes } from "./data.js" */

/**
 * A picture that lies under the cell.
 *
 * @typedef {object} Photograph
 * @property {CanvasImageSource} image
 * @property {Box} box
 */

/**
 * @typedef {object} Look
 * @property {Ink} ink
 * @property {number} opacity Of the cell, 0 to 1.
 * @property {boolean} photograph Whether the picture is shown, where there is one.
 */

/** Side of a patch of one colour, px, and the most patches that are drawn. */
const PATCH = 5;
const MOST_PATCHES = 12000;

/** Distance between arrows, their longest, and what is too short to be drawn, px. */
const ARROWS = 16;
const LONGEST_ARROW = 32;
const SHORTEST_ARROW = 2.5;

/** A canvas with a cell on it. */
export class CellView extends Sheet {
  #shape;
  #values;
  #atCorners;
  #counts;
  /** @type {{ field: Field, colours: string[] } | null} */
  #scale = null;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Shapes} shapes
   * @param {Box} box What is to be seen, um.
   * @param {Photograph | null} photograph
   */
  constructor(canvas, shapes, box, photograph) {
    super(canvas, box);
    this.shapes = shapes;
    this.photograph = photograph;
    this.#shape = blankShape(shapes);
    this.#values = new Float32Array(shapes.corners.length / 4);
    this.#atCorners = new Float32Array(shapes.rest.length / 2);
    this.#counts = new Uint8Array(shapes.rest.length / 2);
  }

  /**
   * Draws the cell at a time.
   *
   * @param {number} time ms.
   * @param {Field} field What it is coloured by.
   * @param {Look} look
   */
  draw(time, field, look) {
    const place = this.clear();
    if (place === null) return;
    const { pen } = place;
    const { shapes } = this;
    shapes.at(time, this.#shape);
    fillField(field.key, shapes, this.#shape, this.#values);
    const photograph = this.photograph !== null && look.photograph;
    if (photograph) this.#drawPhotograph(place);
    pen.save();
    pen.globalAlpha = look.opacity;
    this.#drawSquares(place, field);
    pen.restore();
    /** @type {(colour: string, width: number) => void} */
    const line = (colour, width) => {
      // On a picture no colour of a line is sure to show.
      if (photograph) {
        pen.lineWidth = width + 2;
        pen.strokeStyle = look.ink.paper;
        pen.stroke();
      }
      pen.lineWidth = width;
      pen.strokeStyle = colour;
      pen.stroke();
    };
    traceRings(place, shapes, shapes.rest);
    pen.setLineDash([3, 4]);
    line(look.ink.muted, 1);
    pen.setLineDash([]);
    traceRings(place, shapes, this.#shape.points);
    line(look.ink.line, 1.5);
    if (field.key === "traction") this.#drawArrows(place, field, look.ink);
    this.drawScaleBar(place, look.ink, photograph);
  }

  /**
   * Arrows of the tractions, one for each square of the sheet: the mean of those in it.
   *
   * @param {Place} place
   * @param {Field} field
   * @param {Ink} ink
   */
  #drawArrows({ pen, scale, origin }, field, ink) {
    const { points, traction } = this.#shape;
    if (traction === null) return;
    const { corners, within } = this.shapes;
    /** Sums of places and tractions, and how many, by square of the sheet. @type {Map<string, number[]>} */
    const sums = new Map();
    for (let square = 0; square < within; square++) {
      let [x, y] = [0, 0];
      for (const corner of corners.subarray(4 * square, 4 * square + 4)) {
        x += (origin.x + scale * points[2 * corner]) / 4;
        y += (origin.y - scale * points[2 * corner + 1]) / 4;
      }
      const key = `${Math.round(x / ARROWS)} ${Math.round(y / ARROWS)}`;
      const sum = sums.get(key) ?? [0, 0, 0, 0, 0];
      [x, y, traction[2 * square], -traction[2 * square + 1], 1].forEach((value, at) => (sum[at] += value));
      sums.set(key, sum);
    }
    pen.beginPath();
    for (const [x, y, right, down, count] of sums.values()) {
      const size = Math.hypot(right, down) / count;
      const length = Math.min(size / field.high, 1) * LONGEST_ARROW;
      if (!(length > SHORTEST_ARROW)) continue;
      const [u, v] = [(right / count / size) * length, (down / count / size) * length];
      const start = [x / count, y / count];
      const end = [start[0] + u, start[1] + v];
      const head = Math.min(0.4 * length, 5) / length;
      pen.moveTo(start[0], start[1]);
      pen.lineTo(end[0], end[1]);
      pen.moveTo(end[0] - head * (u - 0.6 * v), end[1] - head * (v + 0.6 * u));
      pen.lineTo(end[0], end[1]);
      pen.lineTo(end[0] - head * (u + 0.6 * v), end[1] - head * (v - 0.6 * u));
    }
    pen.lineWidth = 1.2;
    pen.strokeStyle = ink.line;
    pen.stroke();
  }

  /** Least and greatest value of what was drawn last, over the squares of the mesh. */
  extremes() {
    const values = this.#values.subarray(0, this.shapes.within);
    return values.reduce(
      ([least, most], value) => [Math.min(least, value), Math.max(most, value)],
      [Infinity, -Infinity],
    );
  }

  /** @param {Place} place */
  #drawPhotograph({ pen, scale, origin }) {
    if (this.photograph === null) return;
    const { image, box } = this.photograph;
    const [[left, low], [right, high]] = box;
    const size = [scale * (right - left), scale * (high - low)];
    pen.drawImage(image, origin.x + scale * left, origin.y - scale * high, size[0], size[1]);
  }

  /** The value at each corner of the squares: the mean over the squares around it. */
  #cornerValues() {
    const { corners } = this.shapes;
    this.#atCorners.fill(0);
    this.#counts.fill(0);
    corners.forEach((corner, index) => {
      this.#atCorners[corner] += this.#values[index >> 2];
      this.#counts[corner]++;
    });
    this.#atCorners.forEach((sum, corner) => {
      if (this.#counts[corner] > 0) this.#atCorners[corner] = sum / this.#counts[corner];
    });
    return this.#atCorners;
  }

  /**
   * Small patches of one colour, all of a colour at once, cut off at the outline.
   *
   * @param {Place} place
   * @param {Field} field
   */
  #drawSquares(place, field) {
    const { pen, scale, origin } = place;
    if (this.#scale?.field !== field) this.#scale = { field, colours: ramp(field.colours) };
    const { corners, rest } = this.shapes;
    const { points } = this.#shape;
    const values = this.#cornerValues();
    const squares = this.#values.length;
    const side = scale * Math.abs(rest[2 * corners[1]] - rest[2 * corners[0]]);
    const most = Math.max(Math.floor(Math.sqrt(MOST_PATCHES / squares)), 1);
    const parts = Math.min(Math.max(Math.ceil(side / PATCH), 1), most);
    /** @type {number[][]} */
    const bins = Array.from({ length: STEPS }, () => []);
    for (let square = 0; square < squares; square++) {
      const [a, b, c, d] = corners.subarray(4 * square, 4 * square + 4);
      for (let patch = 0; patch < parts * parts; patch++) {
        const x = ((patch % parts) + 0.5) / parts;
        const y = (Math.floor(patch / parts) + 0.5) / parts;
        const low = values[a] + x * (values[b] - values[a]);
        const value = low + y * (values[d] + x * (values[c] - values[d]) - low);
        bins[stepOf(value, field.low, field.high)].push(square, patch);
      }
    }
    /** @type {(square: number, x: number, y: number) => [number, number]} Where a place of a square is, px. */
    const placeIn = (square, x, y) => {
      const [a, b, c, d] = [0, 1, 2, 3].map((corner) => 2 * corners[4 * square + corner]);
      const weights = [(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y];
      const along = (/** @type {number} */ axis) =>
        weights[0] * points[a + axis] +
        weights[1] * points[b + axis] +
        weights[2] * points[c + axis] +
        weights[3] * points[d + axis];
      return [origin.x + scale * along(0), origin.y - scale * along(1)];
    };
    traceRings(place, this.shapes, points);
    pen.clip("evenodd");
    // Without a line of their colour the page shows between neighbours.
    pen.lineWidth = 1;
    bins.forEach((patches, step) => {
      if (patches.length === 0 || this.#scale === null) return;
      pen.beginPath();
      for (let at = 0; at < patches.length; at += 2) {
        const [square, patch] = [patches[at], patches[at + 1]];
        const [x, y] = [(patch % parts) / parts, Math.floor(patch / parts) / parts];
        const [right, top] = [x + 1 / parts, y + 1 / parts];
        pen.moveTo(...placeIn(square, x, y));
        pen.lineTo(...placeIn(square, right, y));
        pen.lineTo(...placeIn(square, right, top));
        pen.lineTo(...placeIn(square, x, top));
        pen.closePath();
      }
      pen.fillStyle = this.#scale.colours[step];
      pen.strokeStyle = this.#scale.colours[step];
      pen.fill();
      if (pen.globalAlpha === 1) pen.stroke();
    });
  }
}

/** Least number of times at which to look for the largest extent of a cell, and how far apart they are at most, ms. */
const MOMENTS = 40;
const BETWEEN = 20;

/**
 * The box around a cell in all its shapes, um.
 *
 * @param {Shapes} shapes
 * @returns {Box}
 */
export function boxAround(shapes) {
  const shape = blankShape(shapes);
  /** @type {Box} */
  const box = [
    [Infinity, Infinity],
    [-Infinity, -Infinity],
  ];
  const [start, end] = shapes.span;
  const moments = Math.max(MOMENTS, Math.ceil((end - start) / BETWEEN));
  const enclose = (/** @type {Float32Array} */ points) => {
    for (const [first, last] of shapes.rings) {
      for (let at = 2 * first; at < 2 * last; at++) {
        box[0][at % 2] = Math.min(box[0][at % 2], points[at]);
        box[1][at % 2] = Math.max(box[1][at % 2], points[at]);
      }
    }
  };
  enclose(shapes.rest);
  for (let moment = 0; moment <= moments; moment++) {
    shapes.at(start + (moment / moments) * (end - start), shape);
    enclose(shape.points);
  }
  return box;
}
