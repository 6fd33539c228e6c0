// Numbers and parameters as tables; of several runs with a column each and their differences.

import { make } from "./elements.js";
import { number, quantity, shortened, unitText, words } from "./numbers.js";

/** @import { Band, Difference, FittedNumber, Metric, ParameterGroup, Run } from "./payload.js" */

/** Metrics that a person looks at first. */
const KEY = [
  "peak_shortening",
  "peak_lengthening",
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

/** What is said of where a value lies against measured ones. */
const PLACES = { below: "out, below", in: "in", above: "out, above" };

/**
 * Whether a value lies where measured ones do.
 *
 * @param {Metric} row
 */
function mark({ place }) {
  const kind = place === null ? "" : place === "in" ? "in" : "out";
  return make("span", { class: `mark ${kind}` }, place === null ? "" : PLACES[place]);
}

/** @param {Metric | undefined} row */
const marks = (row) => (row === undefined || row.place === null ? [] : [" ", mark(row)]);

/**
 * The key metrics that the runs have; how much longer cells become, where none becomes shorter.
 *
 * @param {Run[]} runs
 */
function keyMetrics(runs) {
  const has = (/** @type {string} */ name) => runs.some((run) => isNumber(metric(run, name)?.value));
  return KEY.flatMap((name) => {
    const first = metric(runs[0], name);
    const usual = name !== "peak_lengthening" || !has("peak_shortening");
    return first !== undefined && has(name) && usual ? [first] : [];
  });
}

/**
 * The numbers of a fit.
 *
 * @param {FittedNumber[]} estimates
 */
export function fittedNumbers(estimates) {
  const each = estimates.map(({ name, meaning, value, interval, verdict }, index) => {
    const sure = verdict === "determined";
    const seen = [make("span", { class: `mark ${sure ? "in" : "out"}` }, verdict)];
    const within = interval === "" ? [] : [make("dd", { class: "seen" }, `95 %: ${unitText(interval)}`)];
    return make(
      "div",
      {},
      make("dt", {}, term(name, meaning, `fitted-${index}`)),
      make("dd", { class: "value" }, unitText(value)),
      ...within,
      make("dd", { class: "seen" }, ...seen),
    );
  });
  return make("dl", { class: "tiles" }, ...each);
}

/** As many runs have a tile for each metric; more are a table. */
const TILED = 3;

/**
 * The key numbers.
 *
 * @param {Run[]} runs
 * @returns {HTMLElement}
 */
export function keyNumbers(runs) {
  return runs.length > TILED ? keyTable(runs) : tiles(runs);
}

/** @param {Run[]} runs */
function tiles(runs) {
  const each = keyMetrics(runs).map((first) => {
    const values = runs.map((run) => {
      const text = quantity(metric(run, first.name)?.value, first.unit);
      if (runs.length === 1) return make("dd", { class: "value" }, text);
      const value = make("span", {}, text, ...marks(metric(run, first.name)));
      return make("dd", { class: "of-run" }, make("span", {}, run.label), value);
    });
    const seen =
      first.band === null
        ? []
        : [
            make(
              "dd",
              { class: "seen" },
              ...(runs.length === 1 ? [mark(first), " "] : []),
              runs.length === 1
                ? range(first.band)
                : `measured ${range(first.band)}\u00a0${unitText(first.unit)}`,
            ),
          ];
    return make("div", {}, make("dt", {}, words(first.name)), ...values, ...seen);
  });
  return make("dl", { class: runs.length > 1 ? "tiles several" : "tiles" }, ...each);
}

/** A row for each of many runs. @param {Run[]} runs */
function keyTable(runs) {
  const metrics = keyMetrics(runs);
  const head = metrics.map(({ name, unit }) => {
    const text = unit === "" ? words(name) : `${words(name)} (${unitText(unit)})`;
    return make("th", { scope: "col", class: "number" }, text);
  });
  const rows = runs.map((run) =>
    make(
      "tr",
      {},
      make("th", { scope: "row" }, run.label),
      ...metrics.map(({ name }) => make("td", { class: "number" }, number(metric(run, name)?.value))),
    ),
  );
  const table = make(
    "table",
    {},
    make("caption", { class: "unseen" }, "Key numbers"),
    make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "run"), ...head)),
    make("tbody", {}, ...rows),
  );
  return scrolling(table, "Key numbers of each run");
}

/**
 * Settings in which runs differ.
 *
 * @param {Difference[]} differences
 * @param {Run[]} runs
 */
export function differenceTable(differences, runs) {
  const head = runs.map((run) => make("th", { scope: "col" }, run.label));
  const rows = differences.map(({ name, values }) =>
    make(
      "tr",
      {},
      make("th", { scope: "row" }, name),
      ...values.map((value) => make("td", {}, shortened(value))),
    ),
  );
  const table = make(
    "table",
    {},
    make("caption", { class: "unseen" }, "Settings that differ"),
    make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "setting"), ...head)),
    make("tbody", {}, ...rows),
  );
  return scrolling(table, "Table of the settings that differ");
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

/** What is smaller is rounding, in the units that metrics have. */
const LEAST_CHANGE = 5e-4;

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
  if (Math.abs(change) < LEAST_CHANGE) return "0";
  // Per cent of what is only left of rounding say nothing.
  if (Math.abs(first) < 1e-3) return `${sign}${number(change)}`;
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
    const several = others.length > 0;
    const title = spread ? "mean \u00b1 sd of beats" : "value";
    const unit = head("unit", "unit");
    const values = runs.map((run) => head(several ? run.label : title, "number"));
    const banded = group.rows.some((row) => row.band !== null);
    const measured = banded ? [head("measured", "band")] : [];
    const header = make(
      "tr",
      {},
      head("quantity"),
      ...(several ? [unit, ...values] : [...values, unit]),
      ...measured,
    );
    const rows = group.rows.map((row, index) => {
      const of = (/** @type {Run} */ run) => metric(run, row.name);
      const name = term(words(row.name), row.definition, `definition-${place}-${index}`);
      const unit = make("td", { class: "unit" }, unitText(row.unit));
      const values = runs.map((run, column) => {
        const change =
          column === 0
            ? []
            : [make("div", { class: "change" }, difference(of(run)?.value, row.value))];
        const own = several ? marks(of(run)) : [];
        const why = of(run)?.missing ?? null;
        const reason = why === null ? [] : [make("div", { class: "why" }, why)];
        return make("td", { class: "number" }, value(of(run)), ...own, ...reason, ...change);
      });
      const seen = row.band === null ? [] : [...(several ? [] : [mark(row), " "]), range(row.band)];
      return make(
        "tr",
        {},
        make("th", { scope: "row" }, name),
        ...(several ? [unit, ...values] : [...values, unit]),
        ...(banded ? [make("td", { class: "band" }, ...seen)] : []),
      );
    });
    const table = make(
      "table",
      { class: runs.length > TILED ? "compared many" : several ? "compared" : "numbers" },
      make("caption", {}, group.name),
      make("thead", {}, header),
      make("tbody", {}, ...rows),
    );
    return several ? scrolling(table, group.name) : table;
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
        row.changed ? { class: "changed" } : {},
        make("th", { scope: "row" }, row.name),
        make("td", { class: "number" }, `${shortened(row.value)} ${unitText(row.unit)}`.trim()),
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
    const changed = group.rows.filter((row) => row.changed).length;
    const count = changed > 0 ? `${group.rows.length}, ${changed} of this run` : String(group.rows.length);
    return make(
      "details",
      { class: changed > 0 ? "group" : "group on-screen" },
      make("summary", {}, `${group.name} (${count})`),
      table,
    );
  });
}
