// Colours: those of the style sheet, of compared runs, and scales of them.

/** @param {string} name Of a custom property of the style sheet. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Colours of compared runs in the style sheet, and dashes, px: as many, so that each pair of them comes once. */
const RUNS = 6;
const DASHES = [[], [7, 4], [2, 3], [10, 3, 2, 3], [14, 5], [5, 2]];

/**
 * The line of a compared run; those of up to 36 differ, the first six without their colours, too.
 *
 * @param {number} index
 */
export function lineOf(index) {
  return {
    colour: `--run-${(index % RUNS) + 1}`,
    dash: DASHES[(index + Math.floor(index / RUNS)) % RUNS],
  };
}

/** Colours that can be told apart on a scale. */
export const STEPS = 64;

/**
 * `STEPS` colours of a scale between its stops.
 *
 * @param {string[]} stops `#rrggbb`, equally far apart.
 * @returns {string[]}
 */
export function ramp(stops) {
  const parsed = stops.map((stop) => [1, 3, 5].map((at) => parseInt(stop.slice(at, at + 2), 16)));
  return Array.from({ length: STEPS }, (_, step) => {
    const place = (step / (STEPS - 1)) * (parsed.length - 1);
    const below = Math.min(Math.floor(place), parsed.length - 2);
    const mixed = parsed[below].map((channel, index) =>
      Math.round(channel + (place - below) * (parsed[below + 1][index] - channel)),
    );
    return `rgb(${mixed.join(" ")})`;
  });
}

/**
 * Which of `STEPS` colours a value has; those beyond the ends have the colour of the end.
 *
 * @param {number} value
 * @param {number} low
 * @param {number} high
 */
export function stepOf(value, low, high) {
  const part = high > low ? (value - low) / (high - low) : 0.5;
  return Math.min(Math.max(Math.floor(part * STEPS), 0), STEPS - 1);
}
