// The head of the page: title, what was run, what to look at.

import { find, make, withCode } from "./elements.js";

/** @import { Payload } from "./payload.js" */

/** The part of the window's height that warnings take at most; the others are folded. */
const WARNED = 0.13;

/**
 * @param {Payload} payload
 * @param {number} height Of the window, px.
 */
export function writeHeader({ title, warnings: ofAll, runs, fit }, height) {
  const one = runs.length === 1;
  document.title = title;
  const kind = fit === null ? "A beat by Myospring" : "A fit by Myospring, and the beat of the fitted cell";
  find("kind", HTMLElement).textContent = one ? kind : "Beats compared by Myospring";
  find("title", HTMLElement).textContent = title;
  // Of several runs the legend has the names.
  const facts = one ? runs[0].facts : [];
  find("facts", HTMLElement).append(...facts.map((fact) => make("li", {}, fact)));
  if (fit !== null) {
    const verdict = find("verdict", HTMLElement);
    verdict.textContent = fit.headline;
    verdict.classList.add(fit.verdict);
    verdict.hidden = false;
  }
  const ofRuns = runs.flatMap((run) => run.warnings.map((text) => (one ? text : `${run.label}: ${text}`)));
  warn([...ofAll, ...ofRuns], height);
}

/**
 * The first warnings are seen at once, as many as leave room for the beat; the others unfold.
 *
 * @param {string[]} warnings
 * @param {number} height Of the window, px.
 */
function warn(warnings, height) {
  find("warnings", HTMLElement).hidden = warnings.length === 0;
  const list = find("warning-list", HTMLElement);
  list.append(...warnings.map((text) => make("li", {}, ...withCode(text))));
  const items = [...list.children];
  const top = list.getBoundingClientRect().top;
  const first = items.findIndex((item, index) => index > 0 && item.getBoundingClientRect().bottom - top > WARNED * height);
  if (first < 0) return;
  const others = items.slice(first);
  find("more-warnings", HTMLElement).hidden = false;
  find("more-warnings-title", HTMLElement).textContent = `${others.length} more`;
  find("more-warning-list", HTMLElement).append(...others);
}
