// What drawings of cells share: where um are on a canvas, rings, the scale bar.

import { plain, roundLength } from "./numbers.js";

/** @import { Shapes } from "./data.js" */

/**
 * Lower left and upper right corner, um.
 *
 * @typedef {[[number, number], [number, number]]} Box
 */

/**
 * Colours of what is drawn beside the cell.
 *
 * @typedef {object} Ink
 * @property {string} line
 * @property {string} muted
 * @property {string} paper What lies around a line on a picture, so that it shows on light and on dark.
 */

/**
 * @typedef {object} Place
 * @property {CanvasRenderingContext2D} pen
 * @property {number} scale px in um.
 * @property {{ x: number, y: number }} origin px.
 */

/** Distance of the drawing from the edge of its canvas, px. */
const MARGIN = 14;

/** A canvas of a size in px of the page, on which um have their place. */
export class Sheet {
  /** Height that the scale bar takes, px. */
  static FOOT = 30;
  width = 0;
  height = 0;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Box} box What is to be seen, um.
   */
  constructor(canvas, box) {
    this.canvas = canvas;
    this.box = box;
  }

  /** Height for a width, px, so that the box fills it. */
  static heightFor(/** @type {Box} */ [[left, low], [right, high]], /** @type {number} */ width) {
    const scale = (width - 2 * MARGIN) / (right - left);
    return scale * (high - low) + 2 * MARGIN + Sheet.FOOT;
  }

  /** Width for a height, px, so that the box fills it. */
  static widthFor(/** @type {Box} */ [[left, low], [right, high]], /** @type {number} */ height) {
    const scale = (height - 2 * MARGIN - Sheet.FOOT) / (high - low);
    return scale * (right - left) + 2 * MARGIN;
  }

  /** Pixels in a um where the box fits into a canvas. */
  static scaleIn(
    /** @type {Box} */ [[left, low], [right, high]],
    /** @type {number} */ width,
    /** @type {number} */ height,
  ) {
    return Math.min((width - 2 * MARGIN) / (right - left), (height - 2 * MARGIN - Sheet.FOOT) / (high - low));
  }

  /**
   * Gives the canvas its size, px of the page.
   *
   * @param {number} width
   * @param {number} height
   * @param {number} density Pixels of the canvas in one of the page.
   */
  resize(width, height, density) {
    [this.width, this.height] = [width, height];
    this.canvas.width = Math.round(width * density);
    this.canvas.height = Math.round(height * density);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
  }

  /** The empty canvas; null where it has no size yet. @returns {Place | null} */
  clear() {
    const pen = this.canvas.getContext("2d");
    if (pen === null || this.width === 0) return null;
    const density = this.canvas.width / this.width;
    const [[left, low], [right, high]] = this.box;
    const scale = Sheet.scaleIn(this.box, this.width, this.height);
    const origin = {
      x: (this.width - scale * (right + left)) / 2,
      y: (this.height - Sheet.FOOT + scale * (high + low)) / 2,
    };
    pen.setTransform(density, 0, 0, density, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    return { pen, scale, origin };
  }

  /**
   * @param {Place} place
   * @param {Ink} ink
   * @param {boolean} cased On a picture.
   */
  drawScaleBar({ pen, scale }, ink, cased = false) {
    const length = roundLength(Math.max(this.width / 5, 48) / scale);
    const y = this.height - 11;
    const text = `${plain(length)}\u00a0\u00b5m`;
    pen.font = "13px system-ui, sans-serif";
    pen.textBaseline = "middle";
    const textAt = MARGIN + length * scale + 8;
    if (cased) {
      pen.fillStyle = ink.paper;
      pen.beginPath();
      pen.roundRect(MARGIN - 7, y - 11, textAt + pen.measureText(text).width + 14 - MARGIN, 21, 4);
      pen.fill();
    }
    pen.fillStyle = ink.line;
    pen.fillRect(MARGIN, y - 2, length * scale, 3);
    pen.fillText(text, textAt, y);
  }
}

/**
 * The path of the outline.
 *
 * @param {Place} place
 * @param {Shapes} shapes
 * @param {Float32Array} points
 * @param {[number, number]} middle What of the cell lies at the origin, um.
 */
export function traceRings({ pen, scale, origin }, shapes, points, middle = [0, 0]) {
  pen.beginPath();
  for (const [first, end] of shapes.rings) {
    for (let point = first; point < end; point++) {
      const x = origin.x + scale * (points[2 * point] - middle[0]);
      const y = origin.y - scale * (points[2 * point + 1] - middle[1]);
      if (point === first) pen.moveTo(x, y);
      else pen.lineTo(x, y);
    }
    pen.closePath();
  }
}
