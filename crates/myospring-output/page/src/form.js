// The form of the set-up, made from the program's own tables of settings and parameters.

import { find, make } from "./elements.js";
import { unitText } from "./numbers.js";
import { term } from "./tables.js";

/** @import { About, Model, SettingSchema, Setup, Value } from "./requests.js" */
/** @import { Kept } from "./link.js" */

/**
 * A setting that the form shows, and the part of its bounds that a slider covers: the table's own bounds are far wider. The
 * field beside the slider takes any value within those.
 *
 * @typedef {object} Shown
 * @property {string} key
 * @property {string} name
 * @property {[number, number, number]} [slider] From, to, and the step.
 * @property {number} [start] Where the slider is as long as the setting has no value.
 * @property {(form: Form) => boolean} [when] Whether the setting has an effect.
 */

/** Settings of a shape that the form shows. */
const SHOWN_SHAPE = ["shape.built_in", "shape.profile"];

const support = (/** @type {string[]} */ ...words) => (/** @type {Form} */ form) =>
  words.includes(String(form.value("mechanics.support")));

/** Where the shape comes from, unless it is from a file. @type {Shown} */
const SHAPE = { key: "shape.built_in", name: "shape", when: (form) => form.isBuiltIn };

const hasProfile = (/** @type {Form} */ form) => !form.isStack && form.value("shape.profile") !== "flat";

const isThick = (/** @type {Form} */ form) => form.isStack || hasProfile(form);

const isTissue = (/** @type {Form} */ form) => form.isBuiltIn && String(form.value("shape.built_in")).startsWith("tissue");

/** A coarse mesh, so that a slider does not wait. */
const TISSUE = { "shape.spacing": "200 um" };

/** @type {[string, Shown[]][]} */
const GROUPS = [
  [
    "Form",
    [
      { key: "shape.profile", name: "section", when: (form) => !form.isStack },
      { key: "material.thickness", name: "greatest thickness", slider: [2, 30, 0.5], when: hasProfile },
      { key: "mechanics.helix_angle", name: "turn of the fibres", slider: [-90, 90, 1], start: 0, when: isThick },
    ],
  ],
  [
    "Tissue",
    [
      { key: "tissue.conduction_velocity", name: "conduction velocity", slider: [100, 1000, 10], start: 200, when: isTissue },
      { key: "tissue.velocity_ratio", name: "along over across the fibres", slider: [1, 5, 0.1], when: isTissue },
      { key: "tissue.stimulated", name: "stimulated", when: isTissue },
      { key: "tissue.stretch_conductance", name: "channels that stretch opens", slider: [0, 1, 0.01], when: isTissue },
    ],
  ],
  [
    "Strength and stiffness",
    [
      { key: "cell.peak_tension", name: "peak tension", slider: [0, 100, 1], when: (form) => form.model?.is_scaled ?? true },
      { key: "material.young_modulus", name: "Young's modulus", slider: [50, 1000, 1] },
      { key: "mechanics.fibre", name: "angle of the fibres", slider: [-90, 90, 1], start: 0 },
    ],
  ],
  [
    "Support",
    [
      { key: "mechanics.support", name: "support" },
      { key: "mechanics.end_stretch", name: "stretch of the ends", slider: [0.8, 1.3, 0.01], when: support("clamped-ends", "afterloaded-ends") },
      { key: "mechanics.afterload", name: "afterload", slider: [100, 10000, 100], start: 2000, when: support("afterloaded-ends") },
      { key: "mechanics.end_stiffness", name: "stiffness of the springs", slider: [10, 2000, 10], start: 100, when: support("spring-held-ends") },
      { key: "mechanics.post_length", name: "length of the posts", slider: [50, 10000, 50], start: 3000, when: support("posts") },
      { key: "mechanics.post_width", name: "width of the posts", slider: [5, 2000, 5], start: 500, when: support("posts") },
      { key: "mechanics.post_modulus", name: "modulus of the posts", slider: [100, 5000, 50], start: 1600, when: support("posts") },
      { key: "mechanics.bed_stiffness", name: "stiffness of the bed", slider: [0.05, 5, 0.05], start: 0.5, when: support("elastic-bed") },
      { key: "mechanics.gel_modulus", name: "modulus of the gel", slider: [0.5, 100, 0.5], start: 10, when: support("gel") },
      { key: "mechanics.gel_thickness", name: "thickness of the gel", slider: [2, 200, 1], start: 100, when: support("gel") },
      { key: "mechanics.adhesion", name: "where it adheres", when: support("gel") },
    ],
  ],
  [
    "Pacing",
    [
      { key: "stimulus.beats", name: "stimuli", slider: [0, 10, 1] },
      { key: "stimulus.cycle_length", name: "cycle length", slider: [250, 2000, 10], when: (form) => Number(form.value("stimulus.beats")) > 1 },
    ],
  ],
];

/** How far below and above its value the slider of a parameter goes, as factors. */
const FACTORS = [0.25, 2];
/** Steps of such a slider. */
const SLIDER_STEPS = 100;

/** Fires `change` when the set-up has changed. */
export class Form extends EventTarget {
  #about;
  #place = find("form", HTMLFormElement);
  #parameters = make("div", {});
  #parametersTitle = make("summary", {});
  /** What differs from the defaults, by key. @type {Map<string, Value>} */
  #changed = new Map();
  /** Parameters that differ from the model's, by name. @type {Map<string, number>} */
  #numbers = new Map();
  /** Rows that are there only at times. @type {[HTMLElement, (form: Form) => boolean][]} */
  #rows = [];
  /** Groups of rows. @type {HTMLElement[]} */
  #groups = [];
  /** Of a shape from a file, which the form does not show. @type {Record<string, Value>} */
  #shape = {};
  /** What a run file has set, by key, and what it is called. @type {Map<string, Value>} */
  #given = new Map();
  #title = "";
  #doses = make("textarea", { rows: "9", spellcheck: "false", "aria-label": "Doses" });
  #dose = make("select", { id: "dose", "aria-label": "Dose" });

  /** @param {About} about */
  constructor(about) {
    super();
    this.#about = about;
    this.#doses.addEventListener("change", () => this.dispatchEvent(new Event("doses")));
    this.#dose.addEventListener("change", () => this.tell());
    this.#build();
    this.#place.addEventListener("submit", (event) => event.preventDefault());
    this.#place.addEventListener("reset", (event) => {
      event.preventDefault();
      this.clear();
    });
  }

  /** The chosen cell model. */
  get model() {
    return this.#about.models.find(({ name }) => name === this.value("cell.model"));
  }

  /** Whether the shape is one of the page's own, not from a file. */
  get isBuiltIn() {
    return Object.keys(this.#shape).length === 0;
  }

  /** The stack in depth that is the shape, and shows its form. */
  get stack() {
    return this.#shape["shape.stack"];
  }

  get isStack() {
    return this.stack !== undefined;
  }

  /** What differs from the defaults, without the shape of a file. @returns {Kept} */
  get kept() {
    const settings = Object.fromEntries(this.#changed);
    const parameters = Object.fromEntries(this.#numbers);
    return { settings, parameters, doses: this.#dose.value === "" ? null : this.#doses.value, dose: this.#dose.value };
  }

  /** Takes what another page has kept; its doses are offered before. @param {Kept} kept */
  take({ settings, parameters, doses, dose }) {
    this.#changed = new Map(Object.entries(settings));
    this.#numbers = new Map(Object.entries(parameters));
    this.#doses.value = doses ?? this.#about.doses;
    this.#build();
    this.#dose.value = dose;
    this.tell();
  }

  /** @returns {Setup} */
  get setup() {
    const usual = { "numerics.integrator": "quasi-static", ...(isTissue(this) ? TISSUE : {}) };
    const settings = { ...usual, ...this.#shape, ...Object.fromEntries(this.#changed) };
    const numbers = Object.fromEntries(this.#numbers);
    /** @type {Record<string, Value>} */
    const all = this.#numbers.size > 0 ? { ...settings, "cell.parameters": numbers } : settings;
    const given = this.#dose.value;
    return { settings: all, dose: given === "" ? null : [this.#doses.value, given], label: this.#label(given) };
  }

  /** What is changed, in words. @param {string} dose */
  #label(dose) {
    const isOwn = (/** @type {[string, Value]} */ [key, value]) => this.#given.get(key) !== value;
    const words = [...this.#changed].filter(isOwn).map(([key, value]) => (typeof value === "string" && !/\d/.test(value) ? value.replaceAll("_", " ") : `${nameOf(key)} ${value}`));
    words.push(...[...this.#numbers].filter(isOwn).map(([name, value]) => `${name} ${value}`));
    if (dose !== "") words.push(dose);
    const cell = this.#shape["shape.picture"] ?? this.#shape["shape.outline"] ?? this.#shape["shape.stack"];
    if (this.#title !== "") words.unshift(this.#title);
    else if (cell !== undefined) words.unshift(String(cell));
    return words.length > 0 ? words.join(", ") : "adult ventricular myocyte";
  }

  /** The value that a setting has, or its default. @param {string} key */
  value(key) {
    return this.#changed.get(key) ?? this.#schema(key)?.default;
  }

  /** Takes the shape of the cell from a file. @param {Record<string, Value>} shape Settings of a shape; none for the built-in one. */
  takeShape(shape) {
    this.#shape = shape;
    if (!this.isBuiltIn) this.#changed.delete(SHAPE.key);
    // The slices show form and fibres, so what is stated of them is dropped; as is what only other shapes have.
    const shownBySlices = this.isStack ? ["shape.profile", "material.thickness", "mechanics.helix_angle"] : [];
    const ofForm = GROUPS.flatMap(([title, rows]) => (title === "Form" ? rows : []));
    const ofOthers = ofForm.filter(({ when }) => when !== undefined && !when(this)).map(({ key }) => key);
    const dropped = [...shownBySlices, ...ofOthers].filter((key) => this.#changed.delete(key));
    if (dropped.length > 0) this.#build();
    this.tell();
  }

  /** Offers a cell model, instead of one of the same name. @param {Model} model */
  offerModel(model) {
    this.#about.models = [...this.#about.models.filter(({ name }) => name !== model.name), model];
    this.#build();
  }

  /** Takes the cell model of this name. @param {string} name */
  takeModel(name) {
    this.#set("cell.model", name);
    this.#afterModel();
    this.#build();
    this.tell();
  }

  /** Takes all settings of a run file. @param {Record<string, Value>} settings @param {string} title What the cell is called. */
  takeSettings(settings, title) {
    const { "cell.parameters": parameters, ...others } = settings;
    const isOfShape = (/** @type {[string, Value]} */ [key]) => key.startsWith("shape.") && !SHOWN_SHAPE.includes(key);
    this.#shape = Object.fromEntries(Object.entries(others).filter(isOfShape));
    this.#changed = new Map(Object.entries(others).filter((entry) => !isOfShape(entry)));
    this.#numbers = new Map(Object.entries(/** @type {Record<string, number>} */ (parameters ?? {})));
    this.#given = new Map([...this.#changed, ...this.#numbers]);
    this.#title = title;
    this.#dose.value = "";
    this.#build();
    this.tell();
  }

  /**
   * The settings of a cell whose numbers are to be found.
   *
   * @param {string} model The name of a cell model, `chosen` for the one of this form, `all` for each that may serve.
   * @returns {Record<string, Value>}
   */
  fitted(model) {
    const { settings } = this.setup;
    const isOther = (/** @type {string} */ key) => key.startsWith("cell.") || key.startsWith("stimulus.");
    if (model === "chosen") return { ...settings, "cell.model": String(this.value("cell.model")) };
    const others = Object.fromEntries(Object.entries(settings).filter(([key]) => !isOther(key)));
    return model === "all" ? others : { ...others, "cell.model": model };
  }

  /** Everything as published again, on the same shape. */
  clear() {
    this.#changed.clear();
    this.#numbers.clear();
    this.#given.clear();
    this.#title = "";
    this.#build();
    this.tell();
  }

  /** Offers the doses of a file of doses. @param {string[]} labels */
  offerDoses(labels) {
    const before = this.#dose.value;
    const option = (/** @type {string} */ label) => make("option", { value: label }, label);
    this.#dose.replaceChildren(make("option", { value: "" }, "none"), ...labels.slice(1).map(option));
    this.#dose.value = labels.includes(before) ? before : "";
  }

  get doses() {
    return this.#doses.value;
  }

  /** Tells what is set up now. */
  tell() {
    this.#showRows();
    this.dispatchEvent(new Event("change"));
  }

  /** Shows the rows that have an effect, and the groups that have such rows. */
  #showRows() {
    for (const [row, when] of this.#rows) row.hidden = !when(this);
    for (const group of this.#groups) group.hidden = [...group.children].every((row) => row.tagName === "LEGEND" || (row instanceof HTMLElement && row.hidden));
  }

  #build() {
    this.#rows = [];
    this.#groups = GROUPS.map(([title, rows]) => fieldset(title, ...rows.map((row) => this.#row(row))));
    const parameters = make("details", {}, this.#parametersTitle, this.#parameters);
    this.#doses.value ||= this.#about.doses;
    const drug = make("details", {}, make("summary", {}, "Drug"), this.#doses, make("label", { class: "choice" }, "Dose ", this.#dose));
    if (this.#dose.childElementCount === 0) this.offerDoses([]);
    const reset = make("button", { type: "reset" }, "All as published");
    this.#place.replaceChildren(fieldset("Cell", this.#row(SHAPE), this.#modelRow(), parameters, drug), ...this.#groups, reset);
    this.#showParameters();
    this.#showRows();
  }

  #modelRow() {
    const { models } = this.#about;
    const select = make("select", { "aria-label": "cell model" }, ...models.map(({ name }) => make("option", { value: name }, name)));
    select.value = String(this.value("cell.model"));
    select.addEventListener("change", () => {
      this.#set("cell.model", select.value);
      this.#afterModel();
      this.#showParameters();
      this.tell();
    });
    return select;
  }

  /** Another model has other parameters, and its own tension. */
  #afterModel() {
    this.#numbers.clear();
    if (!this.model?.is_scaled) this.#changed.delete("cell.peak_tension");
  }

  #showParameters() {
    const rows = this.model?.parameters ?? [];
    this.#parametersTitle.textContent = `Its ${rows.length} parameters`;
    this.#parameters.replaceChildren(
      ...rows.map(({ name, value, unit, minimum, maximum, meaning, source }) => {
        const ends = FACTORS.map((factor) => factor * value).sort((a, b) => a - b);
        const [low, high] = value === 0 ? [minimum, Math.min(maximum, 1)] : [Math.max(ends[0], minimum), Math.min(ends[1], maximum)];
        const about = `${meaning}; ${minimum} to ${maximum} ${unitText(unit)}. Source: ${source}`;
        const now = this.#numbers.get(name) ?? value;
        return slider({ name, about, unit, value: now, range: [low, high, (high - low) / SLIDER_STEPS], set: (given) => {
          if (given === value) this.#numbers.delete(name);
          else this.#numbers.set(name, given);
          this.tell();
        } });
      }),
    );
  }

  /** @param {Shown} shown */
  #row({ key, name, slider: range, start, when }) {
    const schema = this.#schema(key);
    const unit = schema?.["x-unit"] ?? "";
    const bounds = schema?.["x-bounds"] ?? (schema?.maximum === undefined ? "" : `${schema.minimum} to ${schema.maximum}`);
    const about = `${(schema?.description ?? "").replaceAll("`", "")}${bounds === "" ? "" : ` Bounds: ${unitText(bounds)}.`} In a run file: ${key}`;
    const value = this.value(key);
    const row =
      range === undefined
        ? this.#choice(key, name, about, schema?.oneOf ?? schema?.anyOf?.[0]?.oneOf ?? schema?.enum?.map((word) => ({ const: word, description: "" })) ?? [])
        : slider({ name, about, unit, value: this.#changed.has(key) ? parseFloat(String(value)) : (start ?? parseFloat(String(value))), unset: /\d/.test(String(value)) || when !== undefined ? "" : String(value), range, set: (given) => {
            this.#set(key, unit === "" ? given : `${given} ${unit}`);
            this.tell();
          } });
    if (when !== undefined) this.#rows.push([row, when]);
    // A load without a value is no set-up.
    if (start && when !== undefined) this.#starts.set(key, `${start} ${unit}`);
    return row;
  }

  /** Values that settings need once they have an effect. @type {Map<string, string>} */
  #starts = new Map();

  /**
   * @param {string} key
   * @param {string} name
   * @param {string} about
   * @param {{ const: string, description: string }[]} words
   */
  #choice(key, name, about, words) {
    const options = words.map(({ const: word }) => make("option", { value: word }, word.replaceAll(/[-_]/g, " ")));
    const select = make("select", { "aria-label": name }, ...options);
    const hint = make("p", { class: "hint" });
    const explain = () => (hint.textContent = words.find(({ const: word }) => word === select.value)?.description.replaceAll("`", "") ?? "");
    select.value = String(this.value(key));
    explain();
    select.addEventListener("change", () => {
      this.#set(key, select.value);
      // What belongs to another choice has no place in the set-up.
      for (const { key: other, when } of GROUPS.flatMap(([, rows]) => rows)) {
        if (when !== undefined && !when(this)) this.#changed.delete(other);
        const needed = this.#starts.get(other);
        if (when?.(this) && needed !== undefined && !this.#changed.has(other)) this.#changed.set(other, needed);
      }
      explain();
      this.tell();
    });
    return make("div", { class: "row" }, make("div", { class: "name" }, term(name, about)), select, hint);
  }

  /** @param {string} key @param {Value} value */
  #set(key, value) {
    if (value === this.#schema(key)?.default) this.#changed.delete(key);
    else this.#changed.set(key, value);
  }

  /** @param {string} key @returns {SettingSchema | undefined} */
  #schema(key) {
    const [table, name] = key.split(".");
    return this.#about.settings.properties[table]?.properties?.[name];
  }
}

/** @param {string} key */
function nameOf(key) {
  const shown = GROUPS.flatMap(([, rows]) => rows).find((row) => row.key === key);
  return shown?.name ?? key.split(".")[1].replaceAll("_", " ");
}

/** @param {string} title @param {(HTMLElement)[]} rows */
function fieldset(title, ...rows) {
  return make("fieldset", {}, make("legend", {}, title), ...rows);
}

/**
 * A number: a slider, and a field that also takes what lies beyond it.
 *
 * @param {{ name: string, about: string, unit: string, value: number, unset?: string, range: [number, number, number], set: (value: number) => void }} what Of `unset`
 *   is said what it is as long as it is no number.
 */
function slider({ name, about, unit, value, unset = "", range: [low, high, step], set }) {
  const shown = String(Number(value.toPrecision(6)));
  const field = make("input", { type: "number", value: unset === "" ? shown : "", placeholder: unset, step: "any" });
  field.setAttribute("aria-label", unit === "" ? name : `${name}, ${unit}`);
  const bar = make("input", { type: "range", min: String(low), max: String(high), step: String(step), value: shown, "aria-label": name });
  bar.setAttribute("aria-valuetext", unset === "" ? `${shown} ${unit}`.trim() : unset);
  bar.addEventListener("input", () => {
    const given = Number(Number(bar.value).toPrecision(6));
    field.value = String(given);
    bar.setAttribute("aria-valuetext", `${given} ${unit}`.trim());
    set(given);
  });
  field.addEventListener("change", () => {
    if (field.value === "" || !Number.isFinite(field.valueAsNumber)) return;
    bar.value = field.value;
    set(field.valueAsNumber);
  });
  const number = make("span", { class: "quantity" }, field, make("span", { class: "unit" }, unitText(unit)));
  return make("div", { class: "row" }, make("div", { class: "name" }, term(name, about), number), bar);
}
