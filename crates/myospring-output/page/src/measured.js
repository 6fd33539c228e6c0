// A measured curve, a film or displacements of a gel: analysed, followed, fitted.

import { find, make } from "./elements.js";

/** @import { Displaced, Reading, Request, Value } from "./requests.js" */

/** @typedef {"curve" | "film" | "beads" | "arrays" | "posts" | "light" | "stack"} What A table of curves, a film of a cell, of beads in a gel, of a tissue on posts or of its light, displacements of a gel, or the slices of a cell in depth. */

/** Films, displacements, and tables of curves; a text may also be an outline. */
export const FILMS = /\.(avi|y4m)$/i;
export const ARRAYS = /\.npy$/i;
export const TABLES = /\.(csv|txt|tsv|atf|asc|tab|xlsx|xlsm)$/i;

/** What the program calls a field of this page. @type {Record<string, string>} */
const FIELDS = {
  "--frame-rate": "frames a second",
  "--pixel-size": "size of a pixel",
  "--z-step": "distance of two slices",
  "--first-slice": "the first slice is",
  "--columns": "columns",
  "--kind": "kind of the curve",
  "--unit": "unit of the values",
  "--time-unit": "unit of the times",
  "--stimulus-period": "time between stimuli",
  "--peak-shortening": "largest shortening",
  "--allow-cut": "the frame may cut the cell",
  "--from": "from",
  "--until": "until",
  "--gel-modulus": "modulus of the gel",
  "--gel-poisson": "Poisson's ratio of the gel",
  "--gel-thickness": "thickness of the gel",
  "--subset": "side of a square",
  "--reference": "picture of the relaxed gel",
  "--cell": "where the cell is",
  "--traction": "its force on a gel",
  "--post-places": "column, row and diameter of each post",
  "--post-stiffness": "stiffness of a post",
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

/** What the page says while it reads. @type {Record<What, string>} */
const DOING = {
  curve: "Finding the beats",
  film: "Following the film",
  beads: "Following the beads",
  arrays: "Finding the tractions",
  posts: "Following the posts",
  light: "Mapping the waves",
  stack: "Reading the slices",
};

/** What a film may show. @type {[What, string][]} */
const SHOWN = [
  ["film", "a cell"],
  ["beads", "beads in a gel"],
  ["posts", "two posts"],
  ["light", "a tissue\u2019s light"],
  ["stack", "slices of a cell in depth"],
];

/** Which slice of a stack comes first. @type {[string, string][]} */
const FIRST = [
  ["bottom", "the lowest"],
  ["top", "the highest"],
];

/** Fields that are not for all files, and for which. @type {Record<string, What[]>} */
const FOR = {
  shows: ["film", "beads", "posts", "light", "stack"],
  frame_rate_per_s: ["curve", "film", "beads", "arrays", "posts", "light"],
  z_step_um: ["stack"],
  first_slice: ["stack"],
  columns: ["curve"],
  kind: ["curve"],
  unit: ["curve"],
  time_unit: ["curve"],
  from_ms: ["curve", "film"],
  until_ms: ["curve", "film"],
  stimulus_period_ms: ["curve", "light"],
  peak_shortening_pct: ["curve"],
  allow_cut: ["film", "stack"],
  traction: ["curve", "film"],
  gel_modulus_kpa: ["curve", "film", "beads", "arrays"],
  gel_poisson: ["beads", "arrays"],
  gel_thickness_um: ["beads", "arrays"],
  unit_um: ["arrays"],
  subset_um: ["beads", "arrays"],
  reference: ["beads"],
  cell: ["beads", "arrays"],
  post_stiffness_un_per_um: ["posts"],
  post_places: ["posts"],
};

/** What a cell may be fitted to. @type {What[]} */
const FITTED = ["curve", "film"];
/** What has the size of a pixel as a setting of a cell. @type {What[]} */
const OF_SETTINGS = ["film", "posts", "stack"];

/**
 * Two arrays of displacements, that to the right first: the one whose name says `u`, or the earlier one.
 *
 * @param {string[]} names
 */
export function rightFirst(names) {
  const says = (/** @type {string} */ letter, /** @type {string} */ name) => new RegExp(`(^|[^a-z])${letter}([^a-z]|$)`, "i").test(name.replace(ARRAYS, ""));
  const [first, second] = names;
  return says("v", first) && !says("v", second) ? [second, first] : says("u", second) && !says("u", first) ? [second, first] : names;
}

/**
 * The part of the form that is about a curve, a film or displacements. Fires `read` when they are to be read again, and `given` with a
 * further file and the key of its field.
 */
export class Measured extends EventTarget {
  #place = find("measured", HTMLElement);
  #title = find("measured-title", HTMLElement);
  #fields = find("measured-fields", HTMLElement);
  /** @type {Map<string, HTMLInputElement | HTMLSelectElement>} */
  #inputs = new Map();
  /** Further files, as the engine holds them, by the keys of their fields. @type {Map<string, string>} */
  #given = new Map();
  /** The file, or the two arrays; none at first. @type {string[]} */
  #names = [];
  /** @type {What} */
  #what = "curve";

  constructor() {
    super();
    const kind = make("select", {}, ...KINDS.map(([value, words]) => make("option", { value }, words)));
    const shows = make("select", {}, ...SHOWN.map(([value, words]) => make("option", { value }, words)));
    this.#add("shows", "It shows", shows);
    this.#add("frame_rate_per_s", "Frames a second", numberField());
    this.#add("pixel_size_um", "Size of a pixel, \u00b5m", numberField());
    this.#add("z_step_um", "Distance of two slices, \u00b5m", numberField("in the file"));
    this.#add("first_slice", "The first slice is", make("select", {}, ...FIRST.map(([value, words]) => make("option", { value }, words))));
    this.#add("columns", "Columns", make("input", { type: "text", placeholder: "all", spellcheck: "false" }));
    this.#add("kind", "Kind of the curve", kind);
    this.#add("unit", "Unit of the values", make("input", { type: "text", size: "6", spellcheck: "false" }));
    this.#add("time_unit", "Unit of the times", make("input", { type: "text", size: "6", spellcheck: "false" }));
    this.#add("from_ms", "From, ms", numberField());
    this.#add("until_ms", "Until, ms", numberField());
    this.#add("stimulus_period_ms", "Time between stimuli, ms", numberField());
    this.#add("peak_shortening_pct", "Largest shortening, %", numberField());
    this.#add("allow_cut", "The frame may cut the cell", make("input", { type: "checkbox" }));
    this.#add("traction", "Its force on a gel: a table, or a film of beads", make("input", { type: "file" }));
    this.#add("gel_modulus_kpa", "Modulus of the gel, kPa", numberField());
    this.#add("gel_poisson", "Poisson's ratio of the gel", numberField("0.49"));
    this.#add("gel_thickness_um", "Thickness of the gel, \u00b5m", numberField("a half-space"));
    this.#add("unit_um", "A displacement of 1 is, \u00b5m", numberField("a pixel"));
    this.#add("subset_um", "Side of a square, \u00b5m", numberField());
    this.#add("reference", "Picture of the relaxed gel", make("input", { type: "file" }));
    this.#add("post_stiffness_un_per_um", "Stiffness of a post, \u00b5N/\u00b5m", numberField());
    this.#add("post_places", "Column, row and diameter of each post, pixels", make("input", { type: "text", placeholder: "found", spellcheck: "false" }));
    this.#add("cell", "Where the cell is: a film or picture of it, a mask or an outline", make("input", { type: "file" }));
  }

  /** @param {string} key @param {string} words @param {HTMLInputElement | HTMLSelectElement} input */
  #add(key, words, input) {
    this.#inputs.set(key, input);
    input.addEventListener("change", () => {
      const file = input instanceof HTMLInputElement ? input.files?.[0] : undefined;
      if (file !== undefined) return void this.dispatchEvent(new CustomEvent("given", { detail: { key, file } }));
      this.#given.delete(key);
      if (key === "shows") this.#become(/** @type {What} */ (input.value));
      this.dispatchEvent(new Event("read"));
    });
    this.#fields.append(make("label", { class: input.type === "file" ? "field file" : "field" }, words, input));
  }

  /**
   * Takes a file, or two arrays, and asks nothing about it yet.
   *
   * @param {string[]} names
   * @param {What} what
   * @param {Record<string, string>} known Values of fields.
   */
  take(names, what, known = {}) {
    this.#names = names;
    this.#given.clear();
    for (const [key, input] of this.#inputs) {
      if (input instanceof HTMLInputElement && input.type === "checkbox") input.checked = false;
      else input.value = known[key] ?? (input instanceof HTMLSelectElement ? (input.options[0]?.value ?? "") : "");
    }
    this.#title.textContent = this.name;
    this.#become(what);
    this.#place.hidden = false;
  }

  /** Shows the fields for what the file is. @param {What} what */
  #become(what) {
    this.#what = what;
    const shows = this.#inputs.get("shows");
    if (shows !== undefined) shows.value = what;
    for (const [key, { parentElement: label }] of this.#inputs) {
      if (label !== null) label.hidden = !(FOR[key]?.includes(what) ?? true);
    }
    for (const element of document.querySelectorAll("[data-of-fit]")) {
      if (element instanceof HTMLElement) element.hidden = !FITTED.includes(what);
    }
  }

  /** Takes a further file, as the engine holds it. @param {string} key @param {string} name */
  give(key, name) {
    this.#given.set(key, name);
    this.dispatchEvent(new Event("read"));
  }

  /** The file, or the two arrays. */
  get name() {
    return this.#names.join(", ");
  }

  /** What the page says while it reads. */
  get doing() {
    return DOING[this.#what];
  }

  /** Opens the fields, for what the file does not say. */
  open() {
    this.#place.querySelector("details")?.setAttribute("open", "");
  }

  leave() {
    this.#names = [];
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
      name: this.name,
      columns,
      kind: this.#text("kind"),
      unit: this.#text("unit"),
      time_unit: this.#text("time_unit"),
      frame_rate_per_s: this.#number("frame_rate_per_s"),
      // Of a film it is a setting of its cell.
      pixel_size_um: OF_SETTINGS.includes(this.#what) ? null : this.#number("pixel_size_um"),
      from_ms: this.#number("from_ms"),
      until_ms: this.#number("until_ms"),
      stimulus_period_ms: this.#number("stimulus_period_ms"),
    };
  }

  /** Settings that the file itself needs. @returns {Record<string, Value>} */
  get #own() {
    if (!OF_SETTINGS.includes(this.#what)) return {};
    const [size, cut] = [this.#number("pixel_size_um"), this.#inputs.get("allow_cut")];
    /** @type {Record<string, Value>} */
    const own = size === null ? {} : { "shape.pixel_size": `${size} um` };
    return cut instanceof HTMLInputElement && cut.checked ? { ...own, "segmentation.allow_cut": true } : own;
  }

  /** The cell that the file itself is, if it is a stack. @returns {Record<string, Value> | null} */
  get shape() {
    if (this.#what !== "stack" || this.#names.length === 0) return null;
    const step = this.#number("z_step_um");
    return {
      "shape.stack": this.name,
      "shape.first_slice": this.#text("first_slice") ?? FIRST[0][0],
      ...(step === null ? {} : { "shape.z_step": `${step} um` }),
      ...this.#own,
    };
  }

  /** Displacements and the gel. @returns {Displaced} */
  get #displaced() {
    return {
      files: this.#names,
      gel_modulus_kpa: this.#number("gel_modulus_kpa"),
      gel_poisson: this.#number("gel_poisson"),
      gel_thickness_um: this.#number("gel_thickness_um"),
      pixel_size_um: this.#number("pixel_size_um"),
      unit_um: this.#number("unit_um"),
      subset_um: this.#number("subset_um"),
      frame_rate_per_s: this.#number("frame_rate_per_s"),
      reference: this.#given.get("reference") ?? null,
      cell: this.#given.get("cell") ?? null,
    };
  }

  /** The question what the file shows. @returns {Request} */
  get question() {
    const { name, frame_rate_per_s, pixel_size_um, stimulus_period_ms } = this.reading;
    const film = { name, frame_rate_per_s, settings: this.#own };
    if (this.#what === "film") return { ask: "track", ...film };
    if (this.#what === "posts") {
      return { ask: "posts", ...film, post_places: this.#text("post_places"), post_stiffness_un_per_um: this.#number("post_stiffness_un_per_um") };
    }
    if (this.#what === "light") return { ask: "map-waves", name, frame_rate_per_s, pixel_size_um, stimulus_period_ms };
    return this.#what === "curve" ? { ask: "analyse", ...this.reading } : { ask: "traction", ...this.#displaced };
  }

  /** The question which cell would do the same. @param {Record<string, Value>} settings @returns {Request} */
  fitting(settings) {
    const [traction, gel_modulus_kpa] = [this.#given.get("traction") ?? null, this.#number("gel_modulus_kpa")];
    const own = { peak_shortening_pct: this.#number("peak_shortening_pct"), traction, gel_modulus_kpa };
    return { ask: "fit", ...this.reading, ...own, settings: { ...settings, ...this.#own } };
  }
}

/** @param {string} usual What an empty field stands for. */
function numberField(usual = "") {
  return make("input", { type: "number", step: "any", min: "0", placeholder: usual });
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
