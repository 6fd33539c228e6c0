// Draws a thick cell in space on a canvas: its surface, coloured and shaded, where it rested, its size and a scale bar.

import { ramp } from "./colours.js";
import { blankSolid, fillSections } from "./data.js";
import { Sheet } from "./drawing.js";
import { number } from "./numbers.js";
import { Pixels, SIZE } from "./pixels.js";

/** @import { Camera } from "./camera.js" */
/** @import { Look, Photograph } from "./cell-view.js" */
/** @import { Solid } from "./data.js" */
/** @import { Box, Ink } from "./drawing.js" */
/** @import { Field } from "./payload.js" */

/** Where light comes from: right, up, towards the viewer; a unit vector. And the light of what it does not reach. */
const LIGHT = [-0.36, 0.6, 0.714];
const SHADE = 0.5;
/** Room around the cell, which widens as it shortens, of its size at rest. */
const ROUND = 1.08;
/** Length of the arms that say what lies where, px. */
const ARM = 26;
/** Width from which on it is said what the numbers of the size are, px. */
const NAMED = 520;
/** Pixels of a picture at most, so that it stays quick. */
const MOST_PIXELS = 1.2e6;
/** The cell at rest: its colour, and how much of it is seen. */
const GREY = ["#808890", "#808890"];
const GHOST = 0.25;

/** A canvas with a thick cell on it. */
export class SpaceView extends Sheet {
  /** @type {Photograph | null} */
  photograph = null;
  #solid;
  #all;
  #camera;
  #shape;
  #pixels = new Pixels();
  #ghost = new Pixels();
  /** What the cell at rest was drawn for last. */
  #ghostOf = "";
  /** Points at rest, those of the sections as well. */
  #resting;
  /** The shape now and at rest, as `Pixels` has points. */
  #now;
  #rest;
  #normals;
  /** Pixels of the picture in one of the page. */
  #density = 1;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {Solid} solid
   * @param {Camera} camera
   * @param {Solid[]} all Cells that are drawn to one scale.
   */
  constructor(canvas, solid, camera, all) {
    super(canvas, boxSeen(all, camera));
    this.#solid = solid;
    this.#all = all;
    this.#camera = camera;
    this.#shape = blankSolid(solid);
    this.#resting = blankSolid(solid).points;
    this.#resting.set(solid.rest);
    fillSections(solid, this.#resting);
    const points = this.#resting.length / 3;
    this.#now = new Float32Array(SIZE * points);
    this.#rest = new Float32Array(SIZE * points);
    this.#normals = new Float32Array(3 * points);
    // The cell at rest has one colour.
    for (let point = 0; point < points; point++) this.#rest[SIZE * point + 4] = 1;
  }

  /** Length, width and thickness of what was drawn last, in words. */
  get size() {
    const [length, width, thickness] = this.#shape.size.map(number);
    return `${length}\u00a0\u00b5m long, ${width}\u00a0\u00b5m wide, ${thickness}\u00a0\u00b5m thick`;
  }

  /** The section that is shown, if one is. */
  get #section() {
    const { section } = this.#camera;
    return section === null ? null : this.#solid.sections[section];
  }

  /** Least and greatest value of what was drawn last: of the face of a section, else of the surface. */
  extremes() {
    const { values } = this.#shape;
    const face = this.#section?.corners;
    // A plane through a hole cuts nothing.
    const points = face !== undefined && face.length > 0 ? face : this.#solid.corners;
    return [Math.min, Math.max].map((of) => points.reduce((end, point) => of(end, values[point]), values[points[0]]));
  }

  /**
   * Draws the cell at a time.
   *
   * @param {number} time ms.
   * @param {Field} field What it is coloured by.
   * @param {Look} look
   */
  draw(time, field, { ink }) {
    this.#solid.at(time, field.key, this.#shape);
    const place = this.clear();
    if (place === null) return;
    const { pen } = place;
    // Whole from every side, but never larger than at first.
    const fits = Sheet.scaleIn(boxSeen(this.#all, this.#camera), this.width, this.height);
    place.scale = this.#camera.zoom * Math.min(place.scale, fits);
    const finest = Math.sqrt(MOST_PIXELS / (this.width * this.height));
    this.#density = Math.min(Math.max(this.canvas.width / this.width, 2), finest);
    const { turned, tilted, section } = this.#camera;
    const ghostOf = [turned, tilted, section, place.scale, this.width, this.height].join();
    if (this.#ghostOf !== ghostOf) {
      this.#ghostOf = ghostOf;
      this.#project(this.#resting, place.scale, this.#rest);
      this.#fill(this.#ghost, this.#rest, GREY, null);
    }
    this.#project(this.#shape.points, place.scale, this.#now);
    this.#shade(field);
    this.#fill(this.#pixels, this.#now, field.colours, ink.line);
    pen.globalAlpha = GHOST;
    pen.drawImage(this.#ghost.canvas, 0, 0, this.width, this.height);
    pen.globalAlpha = 1;
    pen.drawImage(this.#pixels.canvas, 0, 0, this.width, this.height);
    this.#drawAxes(pen, ink);
    this.drawScaleBar(place, ink);
  }

  /** @param {Pixels} pixels @param {Float32Array} seen @param {string[]} colours @param {string | null} line */
  #fill(pixels, seen, colours, line) {
    pixels.clear(Math.round(this.width * this.#density), Math.round(this.height * this.#density));
    pixels.paint(colours, ramp);
    const section = this.#section;
    const surface = this.#solid.rest.length / 3;
    for (let point = 0, at = 5; at < seen.length; point++, at += SIZE) {
      seen[at] = section !== null && point < surface ? section.depth[point] : 0;
    }
    pixels.patches(seen, this.#solid.corners, section !== null);
    if (section !== null) pixels.patches(seen, section.corners, false);
    if (line !== null) pixels.outline(line);
    pixels.show();
  }

  /**
   * Where points are seen: x, y, how near.
   *
   * @param {Float32Array} points
   * @param {number} scale px in um.
   * @param {Float32Array} into
   */
  #project(points, scale, into) {
    const [x, y, z] = this.#solid.middle;
    const [right, up, near] = axesOf(this.#camera, this.#solid.longAxis);
    const size = scale * this.#density;
    const [left, top] = [this.width / 2, (this.height - Sheet.FOOT) / 2].map((middle) => middle * this.#density);
    for (let from = 0, to = 0; from < points.length; from += 3, to += SIZE) {
      const [a, b, c] = [points[from] - x, points[from + 1] - y, points[from + 2] - z];
      into[to] = left + size * (right[0] * a + right[1] * b + right[2] * c);
      into[to + 1] = top - size * (up[0] * a + up[1] * b + up[2] * c);
      into[to + 2] = near[0] * a + near[1] * b + near[2] * c;
    }
  }

  /** The part of the scale at each point, and the light on it, by the mean direction of the patches around it. @param {Field} field */
  #shade({ low, high }) {
    const normals = this.#normals.fill(0);
    const { points, values } = this.#shape;
    const { corners, rest } = this.#solid;
    const surface = rest.length / 3;
    for (let first = 0; first < corners.length; first += 4) {
      const [a, b, c, d] = [3 * corners[first], 3 * corners[first + 1], 3 * corners[first + 2], 3 * corners[first + 3]];
      // The cross product of the diagonals.
      for (let axis = 0; axis < 3; axis++) {
        const [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
        const part =
          (points[c + next] - points[a + next]) * (points[d + last] - points[b + last]) -
          (points[c + last] - points[a + last]) * (points[d + next] - points[b + next]);
        for (const corner of [a, b, c, d]) normals[corner + axis] += part;
      }
    }
    const axes = axesOf(this.#camera, this.#solid.longAxis);
    const [x, y, z] = [0, 1, 2].map((axis) => axes.reduce((sum, own, index) => sum + LIGHT[index] * own[axis], 0));
    for (let point = 0; point < values.length; point++) {
      const [u, v, w] = [normals[3 * point], normals[3 * point + 1], normals[3 * point + 2]];
      const lit = (u * x + v * y + w * z) / (Math.hypot(u, v, w) || 1);
      this.#now[SIZE * point + 3] = (values[point] - low) / (high - low);
      this.#now[SIZE * point + 4] = point < surface ? SHADE + (1 - SHADE) * Math.max(lit, 0) : 1;
    }
  }

  /** What lies where, and the size in short. @param {CanvasRenderingContext2D} pen @param {Ink} ink */
  #drawAxes(pen, { line, muted }) {
    const [right, up] = this.#camera.axes();
    const [x, y] = [this.width - ARM - 44, ARM + 20];
    pen.font = "12px system-ui, sans-serif";
    pen.textBaseline = "middle";
    pen.textAlign = "center";
    [pen.strokeStyle, pen.fillStyle] = [muted, muted];
    pen.beginPath();
    ["length", "width", "up"].forEach((name, axis) => {
      // One that points at the viewer has no direction.
      const size = Math.hypot(right[axis], up[axis]);
      if (size < 0.3) return;
      pen.moveTo(x, y);
      pen.lineTo(x + ARM * right[axis], y - ARM * up[axis]);
      pen.fillText(name, x + (ARM + 20 / size) * right[axis], y - (ARM + 9 / size) * up[axis]);
    });
    pen.stroke();
    pen.font = "13px system-ui, sans-serif";
    pen.textAlign = "right";
    pen.fillStyle = line;
    const size = this.#shape.size.map((value) => value.toFixed(1)).join(" \u00d7 ");
    const named = this.width > NAMED ? "length \u00d7 width \u00d7 thickness: " : "";
    pen.fillText(`${named}${size}\u00a0\u00b5m`, this.width - 14, this.height - 11);
    pen.textAlign = "start";
  }
}

/** The axes of a camera as sums of x, y and z. @param {Camera} camera @param {number} longAxis Its angle. */
function axesOf(camera, longAxis) {
  const [cos, sin] = [Math.cos(longAxis), Math.sin(longAxis)];
  return camera.axes().map(([along, across, up]) => [along * cos - across * sin, along * sin + across * cos, up]);
}

/**
 * The box in which each of some cells is seen, um, about its middle at rest.
 *
 * @param {Solid[]} all
 * @param {Camera} camera
 * @returns {Box}
 */
function boxSeen(all, camera) {
  let [x, y] = [0, 0];
  for (const { rest, middle, longAxis } of all) {
    const [right, up] = axesOf(camera, longAxis);
    for (let at = 0; at < rest.length; at += 3) {
      const [a, b, c] = [rest[at] - middle[0], rest[at + 1] - middle[1], rest[at + 2] - middle[2]];
      x = Math.max(x, ROUND * Math.abs(right[0] * a + right[1] * b + right[2] * c));
      y = Math.max(y, ROUND * Math.abs(up[0] * a + up[1] * b + up[2] * c));
    }
  }
  return [
    [-x, -y],
    [x, y],
  ];
}
