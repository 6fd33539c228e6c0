// A page with a block as thick cell, made up: it shortens, and widens so that its volume stays.

import { readFile, writeFile } from "node:fs/promises";
import { payloadOf } from "./program.js";

/** @import { Cell, Thick } from "../src/payload.js" */

/** Cubes along, across and upward, their side, um, the largest shortening, and times, ms. */
export const BLOCK = { cubes: [24, 8, 4], spacing: 2, shortening: 0.12, times: [0, 100, 200, 300, 400] };

/** @param {ArrayBufferView} numbers */
const packed = ({ buffer }) => Buffer.from(/** @type {ArrayBuffer} */ (buffer)).toString("base64");

/** Shortening at a time, a part. @param {number} time ms. */
const shorter = (time) => BLOCK.shortening * Math.sin((Math.PI * time) / 400);

/** Length, width and thickness at a time, um. @param {number} time ms. */
export function sizeAt(time) {
  const along = 1 - shorter(time);
  return BLOCK.cubes.map((count, axis) => count * BLOCK.spacing * (axis === 0 ? along : 1 / Math.sqrt(along)));
}

/** The faces of a block, and its points. */
function surface() {
  const { cubes } = BLOCK;
  /** @type {Map<string, number>} */
  const numbers = new Map();
  /** @type {number[]} */
  const corners = [];
  for (const axis of [0, 1, 2]) {
    const [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
    for (const side of [0, 1]) {
      for (let i = 0; i < cubes[next]; i++) {
        for (let j = 0; j < cubes[last]; j++) {
          const face = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([a, b]) => {
            const place = [0, 0, 0];
            [place[axis], place[next], place[last]] = [side * cubes[axis], i + a, j + b];
            const key = place.join();
            if (!numbers.has(key)) numbers.set(key, numbers.size);
            return numbers.get(key) ?? 0;
          });
          corners.push(...(side === 1 ? face : face.reverse()));
        }
      }
    }
  }
  const points = [...numbers.keys()].flatMap((key) => key.split(",").map((place) => BLOCK.spacing * Number(place)));
  return { corners, points };
}

/** Sections through the middle of a block, whose points lie there, and how many points they have. @param {number[]} points */
function cuts(points) {
  const [length, width, height] = BLOCK.cubes.map((cubes) => cubes * BLOCK.spacing);
  /** @param {number[]} place */
  const number = (place) => points.findIndex((_, index) => index % 3 === 0 && place.every((at, axis) => points[index + axis] === at)) / 3;
  /** @param {number[][]} stations */
  const part = (stations) => {
    const ends = stations.flatMap(([x, y]) => [0, height].flatMap((z) => [number([x, y, z]), 0, 0, 0]));
    const weights = ends.map((_, index) => Number(index % 4 === 0));
    return { layers: 3, ends: packed(new Uint32Array(ends)), weights: packed(new Float32Array(weights)) };
  };
  const along = Array.from({ length: BLOCK.cubes[0] + 1 }, (_, at) => [at * BLOCK.spacing, width / 2]);
  const across = Array.from({ length: BLOCK.cubes[1] + 1 }, (_, at) => [length / 2, width - at * BLOCK.spacing]);
  return { sections: /** @type {[any[], any[]]} */ ([[part(along)], [part(across)]]), count: 3 * (along.length + across.length) };
}

/** Data as the program writes them. @param {Cell} above The same cell seen from above. @returns {Thick} */
export function blockOf({ fields }) {
  const { corners, points } = surface();
  const { times } = BLOCK;
  const step = 1e-3;
  const moved = times.flatMap((time) => {
    const stretches = sizeAt(time).map((size, axis) => size / (BLOCK.cubes[axis] * BLOCK.spacing));
    return points.map((at, index) => Math.round((at * (stretches[index % 3] - 1)) / step));
  });
  const { sections, count } = cuts(points);
  const drawn = Array.from({ length: points.length / 3 + count });
  const values = times.flatMap((time) => drawn.map(() => Math.round(255 * (1 - shorter(time) / BLOCK.shortening))));
  const [strain] = fields.filter(({ key }) => key === "fibre-strain");
  const field = { ...strain, low: -100 * BLOCK.shortening, high: 0, values: packed(new Uint8Array(values)) };
  const ratio = { ...field, key: /** @type {const} */ ("volume-ratio"), name: "Volume over volume at rest", unit: "", low: 0.99, high: 1 };
  return {
    rest_um: packed(new Float32Array(points)),
    corners: packed(new Uint32Array(corners)),
    long_axis: 0,
    sections,
    frames: { t_ms: times, displacement: packed(new Int16Array(moved)), step_um: step, size_um: times.map((time) => /** @type {[number, number, number]} */ (sizeAt(time))) },
    spacing_um: BLOCK.spacing,
    accuracy_um: step,
    fields: [field, ratio],
  };
}

/**
 * A copy of a page in which every cell is a thick block as well.
 *
 * @param {string} path
 * @param {string} copy
 */
export async function withBlock(path, copy) {
  const payload = await payloadOf(path);
  for (const part of payload.sections.flatMap(({ parts }) => parts)) {
    if (part.kind === "beat") for (const cell of part.cells) cell.thick = blockOf(cell);
  }
  const data = JSON.stringify(payload).replaceAll("<", "\\u003c").replaceAll("&", "\\u0026");
  const page = await readFile(path, "utf8");
  await writeFile(copy, page.replace(/(<script type="application\/json" id="data">).*?(?=<\/script>)/s, (_, tag) => tag + data));
  return copy;
}
