// A measured curve or a film: analysed, followed, fitted.

import { find, make } from "./elements.js";

/** @import { Reading, Request, Value } from "./requests.js" */

/** Films, and tables of curves; a text may also be an outline. */
export const FILMS = /\.(avi|y4m)$/i;
export const TABLES = /\.(csv|txt|tsv|atf|asc|tab|xlsx|xlsm)$/i;

/** What the program calls a field of this page. @type {Record<string, string>} */
const FIELDS = {
  "--frame-rate": "frames a second",
  "--pixel-size": "size of a pixel",
  "--columns": "columns",
  "--kind": "kind of the curve",
  "--unit": "unit of the values",
  "--time-unit": "unit of the times",
  "--stimulus-period": "time between stimuli",
  "--peak-shortening": "largest shortening",
  "--allow-cut": "the frame may cut the cell",
  "--from": "from",
  "--until": "until",
};

/** A message of the program, in the words of this page. @param {string} text */
export function inWordsOfPage(text) {
  return text.replaceAll(/--[a-z-]+/g, (option) => (FIELDS[option] === undefined ? option : `\u201c${FIELDS[option]}\u201d`));
}

/** What the kinds of curves are called. @type {[string, string][]} */
const KINDS = [
  ["", "as its name says"],
  ["length", "length"],
  ["sarcomere-length", "sarcomere length"],
  ["normalised-length", "length over length at rest"],
  ["shortening", "shortening"],
  ["contraction", "contraction, arbitrary units"],
  ["force", "force"],
  ["tension", "tension"],
  ["moment", "contractile moment"],
  ["calcium", "calcium"],
  ["calcium-ratio", "calcium ratio"],
  ["fluorescence", "fluorescence"],
  ["potential", "potential"],
];

/** The part of the form that is about a curve or a film. Fires `read` when it is to be read again. */
export class Measured extends EventTarget {
  #place = find("measured", HTMLElement);
  #title = find("measured-title", HTMLElement);
  #fields = find("measured-fields", HTMLElement);
  /** @type {Map<string, HTMLInputElement | HTMLSelectElement>} */
  #inputs = new Map();
  /** The file, or null. @type {string | null} */
  name = null;
  isFilm = false;

  constructor() {
    super();
    const kind = make("select", {}, ...KINDS.map(([value, words]) => make("option", { value }, words)));
    this.#add("frame_rate_per_s", "Frames a second", numberField());
    this.#add("pixel_size_um", "Size of a pixel, \u00b5m", numberField());
    this.#add("columns", "Columns", make("input", { type: "text", placeholder: "all", spellcheck: "false" }));
    this.#add("kind", "Kind of the curve", kind);
    this.#add("unit", "Unit of the values", make("input", { type: "text", size: "6", spellcheck: "false" }));
    this.#add("time_unit", "Unit of the times", make("input", { type: "text", size: "6", spellcheck: "false" }));
    this.#add("from_ms", "From, ms", numberField());
    this.#add("until_ms", "Until, ms", numberField());
    this.#add("stimulus_period_ms", "Time between stimuli, ms", numberField());
    this.#add("peak_shortening_pct", "Largest shortening, %", numberField());
    this.#add("allow_cut", "The frame may cut the cell", make("input", { type: "checkbox" }));
  }

  /** @param {string} key @param {string} words @param {HTMLInputElement | HTMLSelectElement} input */
  #add(key, words, input) {
    this.#inputs.set(key, input);
    input.addEventListener("change", () => this.dispatchEvent(new Event("read")));
    this.#fields.append(make("label", { class: "field" }, words, input));
  }

  /** Takes a file, and asks nothing about it yet. @param {string} name @param {boolean} isFilm */
  take(name, isFilm) {
    [this.name, this.isFilm] = [name, isFilm];
    for (const input of this.#inputs.values()) {
      if (input instanceof HTMLInputElement && input.type === "checkbox") input.checked = false;
      else input.value = "";
    }
    this.#title.textContent = name;
    for (const key of ["columns", "kind", "unit", "time_unit", "stimulus_period_ms", "peak_shortening_pct"]) this.#show(key, !isFilm);
    this.#show("allow_cut", isFilm);
    this.#place.hidden = false;
  }

  /** @param {string} key @param {boolean} isShown */
  #show(key, isShown) {
    const label = this.#inputs.get(key)?.parentElement;
    if (label !== null && label !== undefined) label.hidden = !isShown;
  }

  /** Opens the fields, for what the file does not say. */
  open() {
    this.#place.querySelector("details")?.setAttribute("open", "");
  }

  leave() {
    this.name = null;
    this.#place.hidden = true;
  }

  /** @param {string} key */
  #number(key) {
    const text = this.#text(key);
    return text === null ? null : Number(text);
  }

  /** @param {string} key */
  #text(key) {
    const text = this.#inputs.get(key)?.value.trim() ?? "";
    return text === "" ? null : text;
  }

  /** How the table is read. @returns {Reading} */
  get reading() {
    const columns = this.#text("columns")?.split(",").map((name) => name.trim()) ?? [];
    return {
      name: this.name ?? "",
      columns,
      kind: this.#text("kind"),
      unit: this.#text("unit"),
      time_unit: this.#text("time_unit"),
      frame_rate_per_s: this.#number("frame_rate_per_s"),
      // Of a film it is a setting of its cell.
      pixel_size_um: this.isFilm ? null : this.#number("pixel_size_um"),
      from_ms: this.#number("from_ms"),
      until_ms: this.#number("until_ms"),
      stimulus_period_ms: this.#number("stimulus_period_ms"),
    };
  }

  /** Settings that the file itself needs. @returns {Record<string, Value>} */
  get #own() {
    if (!this.isFilm) return {};
    const [size, cut] = [this.#number("pixel_size_um"), this.#inputs.get("allow_cut")];
    /** @type {Record<string, Value>} */
    const own = size === null ? {} : { "shape.pixel_size": `${size} um` };
    return cut instanceof HTMLInputElement && cut.checked ? { ...own, "segmentation.allow_cut": true } : own;
  }

  /** The question what the file shows. @returns {Request} */
  get question() {
    const { name, frame_rate_per_s } = this.reading;
    return this.isFilm ? { ask: "track", name, frame_rate_per_s, settings: this.#own } : { ask: "analyse", ...this.reading };
  }

  /** The question which cell would do the same. @param {Record<string, Value>} settings @returns {Request} */
  fitting(settings) {
    return { ask: "fit", ...this.reading, peak_shortening_pct: this.#number("peak_shortening_pct"), settings: { ...settings, ...this.#own } };
  }
}

function numberField() {
  return make("input", { type: "number", step: "any", min: "0" });
}

/**
 * A made-up recording: the curve of a run at 100 frames a second, with noise.
 *
 * @param {string} traces A run's `traces.csv`.
 */
export function madeUp(traces) {
  const [head, ...rows] = traces.trim().split("\n").map((line) => line.split(","));
  const [time, length] = ["t_ms", "length_um"].map((name) => head.indexOf(name));
  let seed = 7;
  const uniform = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  const noise = () => 0.15 * (uniform() + uniform() + uniform() + uniform() - 2) * Math.sqrt(3);
  const every = 10;
  let next = 0;
  const kept = rows.filter((row) => {
    if (Number(row[time]) < next) return false;
    next += every;
    return true;
  });
  return ["time (ms),length (um)", ...kept.map((row) => `${row[time]},${(Number(row[length]) + noise()).toFixed(3)}`)].join("\n");
}
