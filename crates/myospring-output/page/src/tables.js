// Tables and key numbers.

import { make, ownName, withCode } from "./elements.js";
import { number, shortened, unitText } from "./numbers.js";

/** @import { Entry, Mark, Table, Tile } from "./payload.js" */

/** Rows from which on a table can be filtered. */
const MANY = 8;
/** Letters of a text that a sortable table may cut. */
const LONG_TEXT = 30;
/** Columns from which on a table is wide. */
const CROWDED = 6;

/**
 * What an entry says.
 *
 * @param {Entry} entry
 * @returns {(string | Node)[]}
 */
function entryNodes({ text, number: value, spread, unit = "", definition, note, mark, against }) {
  const verdict = mark === undefined ? [] : [verdictOf(mark)];
  if (text !== undefined) {
    const words = unitText(`${shortened(text)} ${unit}`.trim());
    const name = definition === undefined ? withCode(words) : [term(words, definition)];
    return text === "" ? verdict : [...verdict, ...(mark === undefined ? [] : [" "]), ...name];
  }
  const plusMinus = spread === undefined ? "" : ` \u00b1 ${number(spread)}`;
  const below = [];
  if (note !== undefined) below.push(make("div", { class: "why" }, note));
  if (against !== undefined) below.push(make("div", { class: "change" }, difference(value, against[0])));
  // A count has no decimals.
  const digits = Number.isInteger(value) && spread === undefined ? String(value).replace("-", "\u2212") : number(value);
  const words = `${digits}${plusMinus}\u00a0${unitText(unit)}`.trim();
  return [words, ...verdict.flatMap((it) => [" ", it]), ...below];
}

/** @param {Mark} mark */
const verdictOf = ({ good, words }) => make("span", { class: `mark ${good ? "in" : "out"}` }, words);

/** @param {Tile[]} tiles */
export function tilesOf(tiles) {
  const several = tiles.some(({ values }) => values.length > 1);
  const each = tiles.map(({ name, definition, values, lines }) =>
    make(
      "div",
      {},
      make("dt", {}, definition === undefined ? name : term(name, definition)),
      ...values.map(([label, entry]) =>
        label === ""
          ? make("dd", { class: "value" }, ...entryNodes(entry))
          : make("dd", { class: "of-run" }, make("span", {}, label), make("span", {}, ...entryNodes(entry))),
      ),
      ...lines.map((line) => make("dd", { class: "seen" }, ...entryNodes(line))),
    ),
  );
  return make("dl", { class: several ? "tiles several" : "tiles" }, ...each);
}

/** @param {Table} part */
export function tableOf({ caption, look, columns, rows }) {
  const head = columns.map(({ name, definition, class: kind = "" }) => {
    const words = unitText(name);
    return make("th", { scope: "col", class: kind }, definition === undefined ? words : term(words, definition));
  });
  const body = rows.map(({ cells, marked }) => {
    const [first, ...others] = cells.map(entryNodes);
    return make(
      "tr",
      marked ? { class: "marked" } : {},
      make("th", { scope: "row" }, ...first),
      ...others.map((nodes, index) => {
        const text = cells[index + 1].text ?? "";
        const cell = make("td", { class: columns[index + 1].class ?? "" }, ...nodes);
        if (look === "sortable" && text.length > LONG_TEXT) cell.title = text;
        return cell;
      }),
    );
  });
  const kinds = look === "wide" && columns.length > CROWDED ? "many" : look;
  const table = make(
    "table",
    { class: kinds },
    make("caption", { class: look === "numbers" || look === "wide" ? "" : "unseen" }, caption),
    make("thead", {}, make("tr", {}, ...head)),
    make("tbody", {}, ...body),
  );
  if (look === "numbers" || look === "parameters") return table;
  if (look === "sortable") return sortable(table, { caption, columns, rows });
  return scrolling(table, `Table: ${caption}`);
}

const HOW = "A click on a heading sorts.";

/**
 * A table whose rows a reader sorts and filters.
 *
 * @param {HTMLTableElement} table
 * @param {Pick<Table, "caption" | "columns" | "rows">} data
 */
function sortable(table, { caption, rows }) {
  const body = table.tBodies[0];
  const items = [...body.rows].map((row, index) => ({ row, cells: rows[index].cells }));
  const heads = [...table.querySelectorAll("thead th")];
  heads.forEach((head, column) => {
    // A name with a definition is a button already.
    const button = head.querySelector("button") ?? make("button", { type: "button" }, ...head.childNodes);
    if (!head.contains(button)) head.append(button);
    button.classList.add("sort");
    button.addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const sorted = [...items].sort((a, b) => compared(a.cells[column], b.cells[column], up ? 1 : -1));
      body.append(...sorted.map(({ row }) => row));
    });
  });
  const wide = scrolling(table, `Table: ${caption}`);
  if (rows.length < MANY) return wide;
  const search = make("input", { type: "search" });
  const count = make("span", { class: "seen", role: "status" }, HOW);
  search.addEventListener("input", () => {
    const wanted = search.value.toLowerCase();
    for (const { row } of items) row.hidden = !(row.textContent ?? "").toLowerCase().includes(wanted);
    const left = items.filter(({ row }) => !row.hidden).length;
    count.textContent = wanted === "" ? HOW : `${left} of ${items.length} rows`;
  });
  const bar = make("div", { class: "bar on-screen" }, make("label", { class: "choice" }, "Filter rows ", search), count);
  return make("div", {}, bar, wide);
}

/**
 * The order of two entries: numbers before text, what is missing last.
 *
 * @param {Entry} a
 * @param {Entry} b
 * @param {number} sign
 */
function compared(a, b, sign) {
  const rank = (/** @type {Entry} */ { number: value, text }) => (value !== undefined ? 0 : (text ?? "") !== "" ? 1 : 2);
  if (rank(a) !== rank(b)) return rank(a) - rank(b);
  if (a.number !== undefined && b.number !== undefined) return sign * (a.number - b.number);
  return sign * (a.text ?? "").localeCompare(b.text ?? "", "en", { numeric: true });
}

/**
 * What is wider than a phone scrolls by itself, by keyboard too.
 *
 * @param {HTMLElement} content
 * @param {string} name
 */
export function scrolling(content, name) {
  return make("div", { class: "wide", role: "region", "aria-label": ownName(name), tabindex: "0" }, content);
}

/** How many names with definitions there are. */
let terms = 0;

/**
 * A name with its definition, which is shown on hover, on focus and by a tap; Escape puts it away.
 *
 * @param {string} text
 * @param {string} definition
 */
export function term(text, definition) {
  const id = `definition-${terms++}`;
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
 * @param {number | undefined} value
 * @param {number | null} first
 */
function difference(value, first) {
  if (value === undefined || first === null) return number(null);
  const change = value - first;
  const sign = change > 0 ? "+" : "";
  if (Math.abs(change) < LEAST_CHANGE) return "0";
  // A change in per cent of a rounding error has no meaning.
  if (Math.abs(first) < 1e-3) return `${sign}${number(change)}`;
  return `${sign}${number(change)} (${sign}${number((100 * change) / Math.abs(first))} %)`;
}
