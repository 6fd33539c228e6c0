// A made-up film of a tissue's light.

export const [COLUMNS, ROWS] = [24, 12];

/** A wave to the right, 2 ms a pixel, twice: 250 frames a second, 8 bits. */
export function lightFilm() {
  const frame = new TextEncoder().encode("FRAME\n");
  const parts = [new TextEncoder().encode(`YUV4MPEG2 W${COLUMNS} H${ROWS} F250:1 Ip A1:1 Cmono\n`)];
  for (let number = 0; number < 250; number += 1) {
    const pixels = new Uint8Array(COLUMNS * ROWS);
    for (let at = 0; at < pixels.length; at += 1) {
      const since = 4 * number - 60 - 2 * (at % COLUMNS);
      const height = [0, 500].map((start) => action(since - start)).reduce((sum, one) => sum + one);
      // Rounding to whole numbers, and a pattern instead of noise.
      pixels[at] = 60 + 150 * height + 2 * Math.sin(7 * at + 11 * number);
    }
    parts.push(frame, pixels);
  }
  return Buffer.concat(parts);
}

/** An action potential of some 200 ms, from 0 to 1. @param {number} since ms */
function action(since) {
  const rise = 1 / (1 + Math.exp(-since / 3));
  return rise / (1 + Math.exp((since - 200) / 15));
}
