// Numbers for people.

const MINUS = "\u2212";

/**
 * Four significant digits at most, with a real minus sign; a dash where there is no number.
 *
 * @param {number | null | undefined} value
 */
export function number(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "\u2013";
  const size = Math.abs(value);
  // What is left of rounding.
  if (size < 1e-9) return "0";
  if (size >= 1e6 || size < 1e-3) {
    return value.toExponential(2).replaceAll("-", MINUS);
  }
  const decimals = size >= 1000 ? 0 : size >= 100 ? 1 : size >= 1 ? 2 : 3;
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? "0" : text.replace("-", MINUS);
}

/**
 * A number in a unit.
 *
 * @param {number | null | undefined} value
 * @param {string} unit
 */
export function quantity(value, unit) {
  return unit === "" ? number(value) : `${number(value)}\u00a0${unitText(unit)}`;
}

/**
 * A number without the zeros that say how exact it is.
 *
 * @param {number} value
 */
export function plain(value) {
  const text = number(value);
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/**
 * A text whose numbers have at most six significant digits.
 *
 * @param {string} text
 */
export function shortened(text) {
  return text.replace(/(?<![\w./])\d+\.\d{5,}(e[+-]?\d+)?(?![\w./-])/g, (digits) => String(Number(Number(digits).toPrecision(6))));
}

/**
 * A unit as it is printed.
 *
 * @param {string} unit
 */
export function unitText(unit) {
  return unit
    .replace(/\bu([mFM])/g, "\u00b5$1")
    .replace("^2", "\u00b2")
    .replace("^3", "\u00b3")
    .replace("L0", "L\u2080");
}

/**
 * The greatest of 1, 2 and 5 times a power of ten that is not above `most`.
 *
 * @param {number} most Above 0.
 */
export function roundLength(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return ([5, 2].find((factor) => factor * power <= most) ?? 1) * power;
}
