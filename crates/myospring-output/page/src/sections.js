// The sections of a page: each part by its kind.

import { OwnChart } from "./charts.js";
import { find, forgetNames, make, ownName, say, withCode } from "./elements.js";
import { profileDrawing } from "./profiles.js";
import { scrolling, tableOf, tilesOf } from "./tables.js";

/** @import { Figure, Folded, Part, Payload, Text, Thumbnail } from "./payload.js" */

/** Kinds of parts that need no heading to be seen. */
const QUIET = ["tiles", "beat"];

/**
 * Writes all sections, instead of those that are there; gives the charts that have an axis of their own.
 *
 * @param {Payload} payload
 * @returns {OwnChart[]}
 */
export function writeSections({ sections, times_ms: lists }) {
  document.querySelectorAll("#main > section:not(#warnings)").forEach((section) => section.remove());
  forgetNames();
  /** @type {OwnChart[]} */
  const charts = [];
  const show = (/** @type {Part} */ part) => partOf(part, lists, charts);
  for (const { id, title, hint, parts } of sections) {
    const quiet = parts.length > 0 && parts.every(({ kind }) => QUIET.includes(kind));
    const heading = make("h2", { id: `${id}-title`, class: quiet ? "unseen" : "" }, title);
    const body = make("div", { class: "parts" }, ...parts.filter((part) => !isEmpty(part)).flatMap(show));
    if (body.childElementCount === 0) continue;
    const section = make("section", { id, "aria-labelledby": `${id}-title` }, heading);
    const help = body.querySelector(".term") === null || quiet ? [] : [POINT];
    if (hint !== "" || help.length > 0) {
      const point = help.map((text) => make("span", { class: "on-screen" }, text));
      section.append(make("p", { class: "hint" }, ...point, ...withCode(hint)));
    }
    section.append(body);
    find("main", HTMLElement).append(section);
  }
  charts.forEach((chart) => chart.show());
  return charts;
}

/** @param {Part} part */
function isEmpty(part) {
  switch (part.kind) {
    case "tiles":
      return part.tiles.length === 0;
    case "profiles":
      return part.profiles.length === 0;
    case "gallery":
      return part.thumbnails.length === 0;
    case "words":
      return part.words.length === 0;
    default:
      return false;
  }
}

const POINT = "Point at a name, or move to it with Tab, to see its definition. ";

/**
 * @param {Part} part
 * @param {number[][]} lists Of times.
 * @param {OwnChart[]} charts Those that are made are added.
 * @returns {(HTMLElement | DocumentFragment)[]}
 */
function partOf(part, lists, charts) {
  switch (part.kind) {
    case "beat":
      return [document.importNode(find("stage-template", HTMLTemplateElement).content, true)];
    case "charts": {
      const own = part.charts.map((data) => new OwnChart(data, lists));
      charts.push(...own);
      return [make("div", { class: "own-charts" }, ...own.map(({ element }) => element))];
    }
    case "profiles":
      return [make("div", { class: "profiles" }, ...part.profiles.map(profileDrawing))];
    case "tiles":
      return [tilesOf(part.tiles)];
    case "table":
      return [tableOf(part)];
    case "gallery":
      return [make("ul", { class: "gallery" }, ...part.thumbnails.map(thumbnail))];
    case "figure":
      return [figure(part)];
    case "words":
      return [sentences(part.words)];
    case "text":
      return [snippet(part)];
    case "folded":
      return [folded(part, lists, charts)];
  }
}

/** @param {string[]} words */
function sentences(words) {
  if (words.length === 1) return make("p", {}, ...withCode(words[0]));
  return make("ul", {}, ...words.map((text) => make("li", {}, ...withCode(text))));
}

/** @param {Thumbnail} thumbnail */
function thumbnail({ name, words, mark, image }) {
  const verdict = mark === undefined ? [] : [make("span", { class: `mark ${mark.good ? "in" : "out"}` }, mark.words)];
  return make(
    "li",
    {},
    make("img", { src: image, alt: "", loading: "lazy" }),
    make("span", { class: "name" }, name),
    make("span", { class: "seen", title: words }, words),
    ...verdict,
  );
}

/** @param {Figure} figure */
function figure({ words, light, dark }) {
  const image = make(
    "picture",
    {},
    make("source", { srcset: dark, media: "screen and (prefers-color-scheme: dark)" }),
    make("img", { src: light, alt: words, class: "drawn" }),
  );
  return scrolling(image, `Figure: ${words}`);
}

/**
 * @param {Folded} part
 * @param {number[][]} lists
 * @param {OwnChart[]} charts
 */
function folded({ title, on_paper: onPaper, parts }, lists, charts) {
  const content = parts.flatMap((part) => partOf(part, lists, charts));
  const details = make("details", { class: onPaper ? "folded" : "folded on-screen" }, make("summary", {}, title), ...content);
  details.addEventListener("toggle", () => charts.forEach((chart) => chart.show()));
  return details;
}

/**
 * Text to copy or to keep as a file.
 *
 * @param {Text} part
 */
function snippet({ what, file, text }) {
  const block = make("pre", { tabindex: "0", role: "region", "aria-label": ownName(what) }, text);
  const copy = make("button", { type: "button" }, `Copy ${what}`);
  copy.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text);
      say(`The ${what} is copied.`);
      copy.textContent = "Copied";
      setTimeout(() => (copy.textContent = `Copy ${what}`), 1500);
    } catch {
      getSelection()?.selectAllChildren(block);
      say(`Copying is not allowed here; the ${what} is selected.`);
    }
  });
  const save = make("button", { type: "button" }, `Save ${file}`);
  save.addEventListener("click", () => {
    const address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
    make("a", { href: address, download: file }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  });
  return make("div", {}, block, make("div", { class: "actions" }, copy, save));
}
