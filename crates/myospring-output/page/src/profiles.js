// How sure a fitted number is: the rise of chi squared around its most likely value.

import { draw } from "./elements.js";
import { plain } from "./numbers.js";

/** @import { Profile } from "./payload.js" */

/** Size of a drawing, px, and of the room around its plot: left, top, right, bottom. */
const DRAWN = [240, 150];
const AROUND = [30, 8, 10, 36];
/** A profile is drawn up to this rise, over that at the ends of its interval. */
const HIGHEST = 2.08;

/**
 * A drawing of a profile.
 *
 * @param {Profile} profile
 */
export function profileDrawing({ label, value, interval, points, at_ends: atEnds }) {
  const most = HIGHEST * atEnds;
  const seen = upTo(points, most);
  const xs = [...seen.map(([x]) => x), value];
  const [low, high] = [Math.min(...xs), Math.max(...xs)];
  const room = 0.04 * (high - low) || 1;
  const [left, top, right, bottom] = AROUND;
  const [width, height] = [DRAWN[0] - left - right, DRAWN[1] - top - bottom];
  const x = (/** @type {number} */ at) => left + (width * (at - low + room)) / (high - low + 2 * room);
  const y = (/** @type {number} */ rise) => top + height * (1 - rise / most);
  const path = seen.map(([at, rise], index) => `${index === 0 ? "M" : "L"}${x(at).toFixed(1)} ${y(rise).toFixed(1)}`);
  const foot = top + height;
  // As many decimals as distinguish the ends.
  const decimals = Math.min(Math.max(1 - Math.floor(Math.log10(high - low || 1)), 0), 12);
  const short = (/** @type {number} */ end) => end.toFixed(decimals).replace("-", "\u2212");
  const text = (/** @type {number} */ at, /** @type {number} */ down, /** @type {string} */ words, anchor = "middle") =>
    draw("text", { x: at, y: down, "text-anchor": anchor }, words);
  const ends = interval.flatMap((end) => (end === null ? [] : [end]));
  const of = ends.length === 2 ? `, 95 % interval ${plain(ends[0])} to ${plain(ends[1])}` : "";
  return draw(
    "svg",
    {
      viewBox: `0 0 ${DRAWN.join(" ")}`,
      class: "profile",
      role: "img",
      "aria-label": `Rise of chi squared around ${label} = ${plain(value)}${of}`,
    },
    draw("path", { class: "frame", d: `M${left} ${top}V${foot}H${left + width}` }),
    draw("path", { class: "threshold", d: `M${left} ${y(atEnds)}H${left + width}` }),
    ...ends.map((end) => draw("path", { class: "end", d: `M${x(end)} ${y(atEnds)}V${foot}` })),
    draw("path", { class: "rise", d: path.join("") }),
    draw("circle", { class: "best", cx: x(value), cy: foot, r: 3.5 }),
    text(left - 5, foot + 4, "0", "end"),
    text(left - 5, y(atEnds) + 4, plain(Number(atEnds.toPrecision(2))), "end"),
    text(x(low), foot + 15, short(low), "start"),
    text(x(high), foot + 15, short(high), "end"),
    text(left + width / 2, DRAWN[1] - 5, label),
  );
}

/**
 * Points up to a rise, with those where the profile crosses it.
 *
 * @param {[number, number][]} points
 * @param {number} most
 */
function upTo(points, most) {
  return points.flatMap(([x, y], index) => {
    /** @type {[number, number][]} */
    const kept = y <= most ? [[x, y]] : [];
    const next = points[index + 1];
    if (next !== undefined && y <= most !== next[1] <= most) {
      kept.push([x + ((most - y) / (next[1] - y)) * (next[0] - x), most]);
    }
    return kept;
  });
}
