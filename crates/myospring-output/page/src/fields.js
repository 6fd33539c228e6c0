// What the cell is coloured by, square by square: the same definitions as the program's.

/** @import { FieldKey } from "./payload.js" */
/** @import { Shape, Shapes } from "./data.js" */

// Both ways to halve a square; each triangle counts the same, as in the mesh.
const HALVES = [
  [0, 1, 2],
  [0, 2, 3],
  [0, 1, 3],
  [1, 2, 3],
];

/**
 * Mean over the four triangles of a square of what their deformation gradient F gives.
 *
 * @param {Shapes} shapes
 * @param {Float32Array} points
 * @param {number} square
 * @param {(xx: number, xy: number, yx: number, yy: number) => number} measure Of F's entries.
 */
function meanOver({ rest, corners }, points, square, measure) {
  let sum = 0;
  for (const triangle of HALVES) {
    const [a, b, c] = triangle.map((corner) => 2 * corners[4 * square + corner]);
    const [x1, y1] = [rest[b] - rest[a], rest[b + 1] - rest[a + 1]];
    const [x2, y2] = [rest[c] - rest[a], rest[c + 1] - rest[a + 1]];
    const [u1, v1] = [points[b] - points[a], points[b + 1] - points[a + 1]];
    const [u2, v2] = [points[c] - points[a], points[c + 1] - points[a + 1]];
    const area = x1 * y2 - x2 * y1;
    sum += measure(
      (u1 * y2 - u2 * y1) / area,
      (u2 * x1 - u1 * x2) / area,
      (v1 * y2 - v2 * y1) / area,
      (v2 * x1 - v1 * x2) / area,
    );
  }
  return sum / HALVES.length;
}

/**
 * Values of a field in every square.
 *
 * @param {FieldKey} key
 * @param {Shapes} shapes
 * @param {Shape} shape
 * @param {Float32Array} values Is filled in.
 */
export function fillField(key, shapes, shape, values) {
  const { rest, corners, fibre } = shapes;
  const { points } = shape;
  for (let square = 0; square < values.length; square++) {
    const [along, up] = [Math.cos(fibre[square]), Math.sin(fibre[square])];
    switch (key) {
      case "fibre-strain":
        values[square] =
          100 *
          (meanOver(shapes, points, square, (xx, xy, yx, yy) =>
            Math.hypot(xx * along + xy * up, yx * along + yy * up),
          ) -
            1);
        break;
      case "cross-strain":
        values[square] =
          100 *
          (meanOver(shapes, points, square, (xx, xy, yx, yy) =>
            Math.hypot(xy * along - xx * up, yy * along - yx * up),
          ) -
            1);
        break;
      case "area-ratio":
        values[square] = meanOver(shapes, points, square, (xx, xy, yx, yy) => xx * yy - xy * yx);
        break;
      case "active-stress":
        values[square] = shape.stress === null ? shape.tension : shape.stress[square];
        break;
      case "traction":
        values[square] =
          shape.traction === null ? 0 : Math.hypot(shape.traction[2 * square], shape.traction[2 * square + 1]);
        break;
      case "potential":
        values[square] = shape.potential === null ? 0 : shape.potential[square];
        break;
      case "displacement": {
        let sum = 0;
        for (let corner = 4 * square; corner < 4 * square + 4; corner++) {
          const at = 2 * corners[corner];
          sum += Math.hypot(points[at] - rest[at], points[at + 1] - rest[at + 1]);
        }
        values[square] = sum / 4;
      }
    }
  }
}
