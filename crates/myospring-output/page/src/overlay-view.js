// Draws the outlines of several cells over each other, each about its own middle at rest.

import { blankShape } from "./data.js";
import { Sheet, traceRings } from "./drawing.js";

/** @import { Shape, Shapes } from "./data.js" */
/** @import { Box, Ink } from "./drawing.js" */

/**
 * An outline among others.
 *
 * @typedef {object} Outlined
 * @property {Shapes} shapes
 * @property {[number, number]} middle At rest, um.
 * @property {() => string} colour
 * @property {number[]} dash
 */

/** A canvas with the outlines of several cells on it. */
export class OverlayView extends Sheet {
  /** @type {{ outlined: Outlined, shape: Shape }[]} */
  #all;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Outlined[]} all
   * @param {Box} box What is to be seen, um from the middle.
   */
  constructor(canvas, all, box) {
    super(canvas, box);
    this.#all = all.map((outlined) => ({ outlined, shape: blankShape(outlined.shapes) }));
  }

  /**
   * Draws each outline at its time.
   *
   * @param {number[]} times ms.
   * @param {Ink} ink
   */
  draw(times, ink) {
    const place = this.clear();
    if (place === null) return;
    const { pen } = place;
    pen.lineWidth = 2;
    this.#all.forEach(({ outlined, shape }, index) => {
      const { shapes, middle, colour, dash } = outlined;
      shapes.at(times[index], shape);
      traceRings(place, shapes, shape.points, middle);
      pen.strokeStyle = colour();
      pen.setLineDash(dash);
      pen.stroke();
    });
    pen.setLineDash([]);
    this.drawScaleBar(place, ink);
  }
}
