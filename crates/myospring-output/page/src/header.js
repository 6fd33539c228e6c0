// The head of the page: title, what was done, the answer, what to look at.

import { find, make, windowHeight, withCode } from "./elements.js";

/** @import { Payload } from "./payload.js" */

/** The part of the window's height that warnings take at most; the others are folded. */
const WARNED = 0.13;

/** @param {Payload} payload */
export function writeHead({ kind, title, version, facts, answer, warnings }) {
  document.title = title;
  find("kind", HTMLElement).textContent = kind;
  find("title", HTMLElement).textContent = title;
  find("facts", HTMLElement).replaceChildren(...facts.map((fact) => make("li", {}, fact)));
  find("version", HTMLElement).textContent = `Made by Myospring ${version}.`;
  const line = find("answer", HTMLElement);
  line.replaceChildren(...withCode(answer?.words ?? ""));
  line.className = `answer ${answer?.quality ?? ""}`;
  line.hidden = answer === null;
  warn(warnings);
}

/**
 * The first warnings are seen at once, as many as leave room for what follows; the others unfold.
 *
 * @param {string[]} warnings
 */
function warn(warnings) {
  find("warnings", HTMLElement).hidden = warnings.length === 0;
  const list = find("warning-list", HTMLElement);
  list.replaceChildren(...warnings.map((text) => make("li", {}, ...withCode(text))));
  const items = [...list.children];
  const top = list.getBoundingClientRect().top;
  const most = WARNED * windowHeight();
  const first = items.findIndex((item, index) => index > 0 && item.getBoundingClientRect().bottom - top > most);
  const others = first < 0 ? [] : items.slice(first);
  find("more-warnings", HTMLElement).hidden = others.length === 0;
  find("more-warnings-title", HTMLElement).textContent = `${others.length} more`;
  find("more-warning-list", HTMLElement).replaceChildren(...others);
}
