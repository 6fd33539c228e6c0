// A gel that a cell draws together, as displacements and as pictures of the beads in it.

/** Columns and rows of the pictures, and beads in them. */
export const SIZE = [200, 160];
const BEADS = 1100;
/** Standard deviation of a bead's light, and half of its width in the picture, pixels. */
const [BLUR, REACH] = [1.2, 4];

/**
 * Displacement of a place toward the middle of a window, to the right and downward, pixels: largest, 0.6 times `most`, at a distance of `width`.
 *
 * @param {[number, number]} at From the middle.
 * @param {number} width
 * @param {number} most
 * @returns {[number, number]}
 */
function pulled([x, y], width, most) {
  const part = (most / width) * Math.exp(-(x * x + y * y) / (2 * width * width));
  return [-x * part, -0.5 * y * part];
}

/**
 * An array of NumPy: 64-bit floats in C order.
 *
 * @param {number[]} shape
 * @param {number[]} values
 */
function npy(shape, values) {
  const text = `{'descr': '<f8', 'fortran_order': False, 'shape': (${shape.join(", ")},), }`;
  const head = `${text.padEnd(Math.ceil((text.length + 11) / 64) * 64 - 11)}\n`;
  const bytes = Buffer.alloc(10 + head.length + 8 * values.length);
  bytes.write("\x93NUMPY\x01\x00", "latin1");
  bytes.writeUInt16LE(head.length, 8);
  bytes.write(head, 10, "latin1");
  for (const [at, value] of values.entries()) bytes.writeDoubleLE(value, 10 + head.length + 8 * at);
  return bytes;
}

/** Displacements to the right and downward as NumPy arrays, pixels. @param {number} rows @param {number} columns */
export function arrays(rows, columns) {
  const places = Array.from({ length: rows * columns }, (_, at) => pulled([(at % columns) - columns / 2, Math.floor(at / columns) - rows / 2], 6, 1.2));
  return [0, 1].map((axis) => npy([rows, columns], places.map((moved) => moved[axis])));
}

/** A film of beads: a frame for each displacement, 10 a second, as YUV4MPEG2. @param {number[]} most */
export function beadFilm(most) {
  const [width, height] = SIZE;
  const film = [Buffer.from(`YUV4MPEG2 W${width} H${height} F10:1 Cmono\n`)];
  for (const moved of most) film.push(Buffer.from("FRAME\n"), Buffer.from(beadPicture(moved)));
  return Buffer.concat(film);
}

/** Grey values of beads. @param {number} most The displacement. */
function beadPicture(most) {
  const [width, height] = SIZE;
  const light = new Float64Array(width * height);
  let seed = 5;
  const uniform = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  for (let bead = 0; bead < BEADS; bead++) {
    const [x, y] = [width * uniform(), height * uniform()];
    const [right, down] = pulled([x - width / 2, y - height / 2], 22, most);
    const [atX, atY] = [x + right, y + down];
    for (let row = Math.max(0, Math.ceil(atY - REACH)); row <= Math.min(height - 1, atY + REACH); row++) {
      for (let column = Math.max(0, Math.ceil(atX - REACH)); column <= Math.min(width - 1, atX + REACH); column++) {
        light[row * width + column] += 150 * Math.exp(-((column - atX) ** 2 + (row - atY) ** 2) / (2 * BLUR * BLUR));
      }
    }
  }
  return Uint8Array.from(light, (value) => Math.min(255, Math.round(15 + value)));
}

/** An outline around the middle of a window, um from its lower left corner. @param {[number, number]} middle @param {[number, number]} half */
export function outline([x, y], [across, up]) {
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(([right, above]) => [x + right * across, y + above * up]);
  return JSON.stringify({ type: "Feature", properties: {}, geometry: { type: "Polygon", coordinates: [corners] } });
}
