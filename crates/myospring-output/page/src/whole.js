// All of a page, from its data.

import { showBeat } from "./beat.js";
import { writeHead } from "./header.js";
import { writeSections } from "./sections.js";

/** @import { ShownBeat } from "./beat.js" */
/** @import { OwnChart } from "./charts.js" */
/** @import { Payload } from "./payload.js" */

/**
 * What a page shows.
 *
 * @typedef {object} ShownPage
 * @property {OwnChart[]} charts Those that have an axis of their own.
 * @property {ShownBeat | null} beat
 */

/**
 * Shows a page instead of the one before: what moved goes on where it was.
 *
 * @param {Payload} payload
 * @param {ShownPage | null} before
 * @returns {ShownPage}
 */
export function showPage(payload, before) {
  const motion = before?.beat?.end() ?? null;
  writeHead(payload);
  const charts = writeSections(payload);
  const beat = payload.sections.flatMap(({ parts }) => parts).find((part) => part.kind === "beat");
  return { charts, beat: beat === undefined ? null : showBeat(beat, payload.times_ms, motion) };
}
