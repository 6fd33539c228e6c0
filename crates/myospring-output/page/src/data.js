// From the text in the page to numbers.

/** @import { Cell, FieldKey, Packed, Payload, SectionPart, Thick } from "./payload.js" */

/**
 * The data that stand in a page.
 *
 * @param {Document} page
 * @returns {Payload}
 */
export function readPayload(page) {
  return JSON.parse(page.getElementById("data")?.textContent ?? "null");
}

/**
 * @param {Packed} text
 * @returns {ArrayBuffer}
 */
function bytes(text) {
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return out.buffer;
}

/**
 * What is needed of a cell to draw it at any time. A simulation that runs in the page gives the same.
 *
 * @typedef {object} Shapes
 * @property {Float32Array} rest Points at rest, um, x and y in turn.
 * @property {Uint32Array} corners Four of each square, counter-clockwise.
 * @property {number} within How many squares are of the mesh.
 * @property {Float32Array} fibre Direction in each square, radians.
 * @property {[number, number][]} rings First point and the one after the last of each ring of the outline.
 * @property {[number, number]} span First and last time, ms.
 * @property {(time: number, shape: Shape) => void} at Fills in the shape at a time, ms.
 */

/**
 * A cell at one time.
 *
 * @typedef {object} Shape
 * @property {Float32Array} points Positions, um, x and y in turn.
 * @property {number} tension Active tension, kPa.
 * @property {Float32Array | null} stress Active stress of each square, kPa, where it differs.
 * @property {Float32Array | null} traction Traction of each square on the gel, Pa, x and y in turn, where there is one.
 * @property {Float32Array | null} potential Membrane potential of each square, mV, where it differs.
 */

/**
 * A shape to be filled in.
 *
 * @param {Shapes} shapes
 * @returns {Shape}
 */
export function blankShape(shapes) {
  return { points: new Float32Array(shapes.rest.length), tension: 0, stress: null, traction: null, potential: null };
}

/**
 * The index of the last time that is not after `time`, or 0.
 *
 * @param {ArrayLike<number>} times In order.
 * @param {number} time
 */
export function lastBefore(times, time) {
  let low = 0;
  let high = times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return low;
}

/**
 * The frames around a time: the last that is not after it, the next one, and how far between them it is.
 *
 * @param {number[]} times
 * @param {number} time
 */
function around(times, time) {
  const last = lastBefore(times, time);
  const next = Math.min(last + 1, times.length - 1);
  const gap = times[next] - times[last];
  return { last, next, part: gap > 0 ? Math.min(Math.max((time - times[last]) / gap, 0), 1) : 0 };
}

/**
 * The shapes of a recorded cell; between its frames they lie on straight lines.
 *
 * @param {Cell} cell
 * @returns {Shapes}
 */
export function recordedShapes(cell) {
  const rest = new Float32Array(bytes(cell.rest_um));
  const corners = new Uint32Array(bytes(cell.corners));
  const fibre = new Float32Array(bytes(cell.fibre));
  const { t_ms: times, step_um: step, ta_kpa: tensions, stress_step_kpa: stressStep } = cell.frames;
  const moved = new Int16Array(bytes(cell.frames.displacement));
  const stress = cell.frames.stress === null ? null : new Uint16Array(bytes(cell.frames.stress));
  const traction = cell.frames.traction === null ? null : new Int16Array(bytes(cell.frames.traction));
  const potential = cell.frames.potential === null ? null : new Int16Array(bytes(cell.frames.potential));
  const squares = corners.length / 4;
  const count = rest.length;

  /** @type {[number, number][]} */
  const rings = [];
  let first = count / 2 - cell.rings.reduce((sum, length) => sum + length, 0);
  for (const length of cell.rings) {
    rings.push([first, first + length]);
    first += length;
  }

  return {
    rest,
    corners,
    within: cell.within,
    fibre,
    rings,
    span: [times[0] ?? 0, times[times.length - 1] ?? 0],
    at(time, shape) {
      const { last, next, part } = around(times, time);
      const [a, b] = [last * count, next * count];
      for (let i = 0; i < count; i++) {
        shape.points[i] = rest[i] + step * (moved[a + i] + part * (moved[b + i] - moved[a + i]));
      }
      shape.tension = tensions[last] + part * (tensions[next] - tensions[last]);
      /** @type {(values: Uint16Array | Int16Array, step: number, into: Float32Array) => Float32Array} */
      const between = (values, step, into) => {
        const length = into.length;
        for (let i = 0; i < length; i++) {
          const [from, to] = [values[last * length + i], values[next * length + i]];
          into[i] = step * (from + part * (to - from));
        }
        return into;
      };
      if (stress !== null) shape.stress = between(stress, stressStep, shape.stress ?? new Float32Array(squares));
      if (traction !== null) {
        shape.traction = between(traction, cell.frames.traction_step_pa, shape.traction ?? new Float32Array(2 * squares));
      }
      if (potential !== null) {
        shape.potential = between(potential, cell.frames.potential_step_mv, shape.potential ?? new Float32Array(squares));
      }
    },
  };
}

/**
 * What is needed of a thick cell to draw it in space at any time.
 *
 * @typedef {object} Solid
 * @property {Float32Array} rest Points of its surface at rest, um, x, y and z in turn.
 * @property {Uint32Array} corners Four of each patch, counter-clockwise seen from outside.
 * @property {number} longAxis Seen from above, radians counter-clockwise from x.
 * @property {number[]} middle Of the cell at rest, um, x, y and z.
 * @property {number} spacing Side of a patch, um.
 * @property {[Section, Section]} sections Along its long axis and across it.
 * @property {(time: number, key: FieldKey, shape: SolidShape) => void} at Fills in the shape at a time, ms.
 */

/**
 * A cut through a thick cell: the half on the one side of an upright plane is left.
 *
 * @typedef {object} Section
 * @property {Float32Array} depth How far each point of the surface lies behind the plane at rest, um; those before it are taken away.
 * @property {Uint32Array} corners Four of each patch of the face that shows, by numbers that follow those of the surface's points.
 * @property {{ first: number, layers: number, ends: Uint32Array, weights: Float32Array }[]} parts
 */

/**
 * A thick cell at one time.
 *
 * @typedef {object} SolidShape
 * @property {Float32Array} points Positions, um, x, y and z in turn: those of the surface, then those of its sections.
 * @property {Float32Array} values Of a field at each point.
 * @property {number[]} size Length, width and thickness, um.
 */

/** A shape to be filled in. @param {Solid} solid @returns {SolidShape} */
export function blankSolid({ rest, sections }) {
  const parts = sections.flatMap((section) => section.parts);
  const points = parts.reduce((end, { first, layers, ends }) => Math.max(end, first + (layers * ends.length) / 8), rest.length / 3);
  return { points: new Float32Array(3 * points), values: new Float32Array(points), size: [0, 0, 0] };
}

/** Fills in the points of sections from those of the surface. @param {Solid} solid @param {Float32Array} points */
export function fillSections({ sections }, points) {
  for (const { first, layers, ends, weights } of sections.flatMap(({ parts }) => parts)) {
    /** @type {(end: number, axis: number) => number} */
    const place = (end, axis) => {
      let sum = 0;
      for (let at = 4 * end; at < 4 * end + 4; at++) sum += weights[at] * points[3 * ends[at] + axis];
      return sum;
    };
    for (let station = 0; 8 * station < ends.length; station++) {
      for (let axis = 0; axis < 3; axis++) {
        const [low, high] = [place(2 * station, axis), place(2 * station + 1, axis)];
        for (let layer = 0; layer < layers; layer++) {
          points[3 * (first + station * layers + layer) + axis] = low + (layer / (layers - 1)) * (high - low);
        }
      }
    }
  }
}

/**
 * The two cuts of a thick cell.
 *
 * @param {Thick} thick
 * @param {Float32Array} rest
 * @param {number[]} middle
 * @returns {[Section, Section]}
 */
function cutsOf({ sections, long_axis: longAxis }, rest, middle) {
  let next = rest.length / 3;
  const [cos, sin] = [Math.cos(longAxis), Math.sin(longAxis)];
  const of = (/** @type {SectionPart[]} */ grids, /** @type {number[]} */ normal) => {
    /** @type {number[]} */
    const corners = [];
    const parts = grids.map(({ layers, ends, weights }) => {
      const part = { first: next, layers, ends: new Uint32Array(bytes(ends)), weights: new Float32Array(bytes(weights)) };
      const stations = part.ends.length / 8;
      for (let station = 0; station + 1 < stations; station++) {
        for (let layer = 0; layer + 1 < layers; layer++) {
          const at = next + station * layers + layer;
          corners.push(at, at + layers, at + layers + 1, at + 1);
        }
      }
      next += stations * layers;
      return part;
    });
    const depth = new Float32Array(rest.length / 3);
    depth.forEach((_, point) => {
      depth[point] = normal[0] * (rest[3 * point] - middle[0]) + normal[1] * (rest[3 * point + 1] - middle[1]);
    });
    return { depth, corners: new Uint32Array(corners), parts };
  };
  return [of(sections[0], [-sin, cos]), of(sections[1], [cos, sin])];
}

/**
 * The shapes of a recorded thick cell; between its frames they lie on straight lines.
 *
 * @param {Thick} thick
 * @returns {Solid}
 */
export function recordedSolid(thick) {
  const { t_ms: times, step_um: step, size_um: sizes } = thick.frames;
  const rest = new Float32Array(bytes(thick.rest_um));
  const moved = new Int16Array(bytes(thick.frames.displacement));
  const fields = new Map(thick.fields.map((field) => [field.key, { ...field, steps: new Uint8Array(bytes(field.values)) }]));
  const ends = [0, 1, 2].map((axis) => {
    const along = rest.filter((_, index) => index % 3 === axis);
    return [along.reduce((a, b) => Math.min(a, b), Infinity), along.reduce((a, b) => Math.max(a, b), -Infinity)];
  });
  const middle = ends.map(([low, high]) => (low + high) / 2);
  return {
    rest,
    corners: new Uint32Array(bytes(thick.corners)),
    longAxis: thick.long_axis,
    middle,
    spacing: thick.spacing_um,
    sections: cutsOf(thick, rest, middle),
    at(time, key, shape) {
      const { last, next, part } = around(times, time);
      /** @type {(values: ArrayLike<number>, count: number, index: number) => number} */
      const between = (values, count, index) => {
        const from = values[last * count + index];
        return from + part * (values[next * count + index] - from);
      };
      rest.forEach((at, index) => (shape.points[index] = at + step * between(moved, rest.length, index)));
      fillSections(this, shape.points);
      shape.size = sizes[last].map((from, axis) => from + part * (sizes[next][axis] - from));
      const field = fields.get(key);
      if (field === undefined) return;
      const unit = (field.high - field.low) / 255;
      const { values } = shape;
      for (let point = 0; point < values.length; point++) {
        values[point] = field.low + unit * between(field.steps, values.length, point);
      }
    },
  };
}
