// Numbers and parameters as tables; of several runs with a column each and their differences.

import { make } from "./elements.js";
import { number, quantity, unitText, words } from "./numbers.js";

/** @import { Band, Metric, ParameterGroup, Run } from "./payload.js" */

/** Metrics that a person looks at first. */
const KEY = [
  "peak_shortening",
  "time_to_peak_from_stimulus",
  "relaxation_time_90",
  "maximum_shortening_rate",
  "peak_tension",
  "action_potential_duration_90",
];

/**
 * @param {Run} run
 * @param {string} name
 * @returns {Metric | undefined}
 */
function metric(run, name) {
  return run.metrics.flatMap((group) => group.rows).find((row) => row.name === name);
}

/**
 * @param {number | null | undefined} value
 * @returns {value is number}
 */
const isNumber = (value) => typeof value === "number";

/** @param {Band} band */
const range = (band) => `${band.low} to ${band.high}`.replaceAll("-", "\u2212");

/**
 * The key numbers.
 *
 * @param {Run[]} runs
 * @returns {HTMLElement[]}
 */
export function tiles(runs) {
  return KEY.flatMap((name) => {
    const first = metric(runs[0], name);
    if (first === undefined || runs.every((run) => !isNumber(metric(run, name)?.value))) return [];
    const values = runs.map((run) => {
      const text = quantity(metric(run, name)?.value, first.unit);
      if (runs.length === 1) return make("dd", { class: "value" }, text);
      return make("dd", { class: "of-run" }, make("span", {}, run.label), make("span", {}, text));
    });
    const seen =
      first.band === null
        ? []
        : [make("dd", { class: "seen" }, `band ${range(first.band)}\u00a0${unitText(first.unit)}`)];
    return [make("div", {}, make("dt", {}, words(name)), ...values, ...seen)];
  });
}

/**
 * A name with its definition, which is shown on hover, on focus and by a tap; Escape puts it away.
 *
 * @param {string} text
 * @param {string} definition
 * @param {string} id
 */
function term(text, definition, id) {
  const place = make(
    "div",
    { class: "term-place" },
    make("button", { type: "button", class: "term", "aria-describedby": id }, text),
    make("div", { class: "definition", role: "tooltip", id }, definition),
  );
  place.addEventListener("keydown", (event) => {
    if (event.key === "Escape") place.classList.add("put-away");
  });
  for (const kind of ["mouseenter", "focusin"]) {
    place.addEventListener(kind, () => place.classList.remove("put-away"));
  }
  return place;
}

/**
 * A difference in the unit of the values, and in per cent of the first.
 *
 * @param {number | null | undefined} value
 * @param {number | null | undefined} first
 */
function difference(value, first) {
  if (!isNumber(value) || !isNumber(first)) return number(null);
  const change = value - first;
  const sign = change > 0 ? "+" : "";
  if (Math.abs(change) <= 1e-9 * Math.abs(first)) return "0";
  if (first === 0) return `${sign}${number(change)}`;
  return `${sign}${number(change)} (${sign}${number((100 * change) / Math.abs(first))} %)`;
}

/**
 * All metrics, group by group.
 *
 * @param {Run[]} runs
 * @returns {HTMLElement[]}
 */
export function metricTables(runs) {
  const [first, ...others] = runs;
  const spread = runs.some((run) =>
    run.metrics.some((group) => group.rows.some((row) => row.spread !== null)),
  );
  const value = (/** @type {Metric | undefined} */ row) =>
    isNumber(row?.spread)
      ? `${number(row?.value)} \u00b1 ${number(row?.spread)}`
      : number(row?.value);
  return first.metrics.map((group, place) => {
    const head = (/** @type {string} */ text, kind = "") => make("th", { scope: "col", class: kind }, text);
    const header = make(
      "tr",
      {},
      head("quantity"),
      ...runs.map((run) =>
        head(others.length > 0 ? run.label : spread ? "mean \u00b1 sd of beats" : "value", "number"),
      ),
      head("unit", "unit"),
      ...others.map((run) => head(`${run.label} \u2212 ${first.label}`, "number")),
      head("band seen in experiments"),
    );
    const rows = group.rows.map((row, index) => {
      const of = (/** @type {Run} */ run) => metric(run, row.name);
      const name = term(words(row.name), row.definition, `definition-${place}-${index}`);
      return make(
        "tr",
        {},
        make("th", { scope: "row" }, name),
        ...runs.map((run) => make("td", { class: "number" }, value(of(run)))),
        make("td", {}, unitText(row.unit)),
        ...others.map((run) =>
          make("td", { class: "number" }, difference(of(run)?.value, row.value)),
        ),
        make("td", {}, row.band === null ? "" : range(row.band)),
      );
    });
    const table = make(
      "table",
      { class: others.length > 0 ? "" : "numbers" },
      make("caption", {}, group.name),
      make("thead", {}, header),
      make("tbody", {}, ...rows),
    );
    return others.length > 0 ? scrolling(table, group.name) : table;
  });
}

/**
 * A table that is wider than a phone scrolls by itself, by keyboard too.
 *
 * @param {HTMLTableElement} table
 * @param {string} name
 */
function scrolling(table, name) {
  return make("div", { class: "wide", role: "region", "aria-label": name, tabindex: "0" }, table);
}

/**
 * @param {ParameterGroup[]} groups
 * @returns {HTMLElement[]}
 */
export function parameterTables(groups) {
  return groups.map((group) => {
    const head = (/** @type {string} */ text, kind = "") => make("th", { scope: "col", class: kind }, text);
    const rows = group.rows.map((row) =>
      make(
        "tr",
        {},
        make("th", { scope: "row" }, row.name),
        make("td", { class: "number" }, `${row.value} ${unitText(row.unit)}`.trim()),
        make("td", { class: "meaning" }, row.meaning),
        make("td", { class: "source" }, row.source),
      ),
    );
    const table = make(
      "table",
      { class: "parameters" },
      make("caption", { class: "unseen" }, group.name),
      make(
        "thead",
        {},
        make("tr", {}, head("name"), head("value", "number"), head("meaning"), head("source")),
      ),
      make("tbody", {}, ...rows),
    );
    return make(
      "details",
      {},
      make("summary", {}, `${group.name} (${group.rows.length})`),
      table,
    );
  });
}
