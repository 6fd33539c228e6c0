// The set-up in the address of the page, behind `#`: a link to it.

/** @import { Value } from "./requests.js" */

/**
 * What differs from the defaults.
 *
 * @typedef {object} Kept
 * @property {Record<string, Value>} settings
 * @property {Record<string, number>} parameters Of the cell model.
 * @property {string | null} doses The file of doses, if one of them is given.
 * @property {string} dose Its label, or nothing.
 */

/** What stands before the set-up, so that another form of it can have another name. */
const FORM = "#set-up-1=";

/** The part of the address behind the file. @param {Kept} kept */
export function linkOf(kept) {
  const bytes = new TextEncoder().encode(JSON.stringify(kept));
  const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return FORM + btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/**
 * The set-up that an address holds, or null if it holds none.
 *
 * @param {string} behind The part behind the file.
 * @returns {Kept | null}
 * @throws {Error} If it cannot be read.
 */
export function keptIn(behind) {
  if (!behind.startsWith("#set-up-")) return null;
  if (!behind.startsWith(FORM)) throw new Error("it was made by a newer version of this page");
  const text = behind.slice(FORM.length).replaceAll("-", "+").replaceAll("_", "/");
  try {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const { settings, parameters, doses, dose } = JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes));
    const isTable = (/** @type {unknown} */ it) => typeof it === "object" && it !== null && !Array.isArray(it);
    const isText = (/** @type {unknown} */ it) => typeof it === "string";
    if (isTable(settings) && isTable(parameters) && (doses === null || isText(doses)) && isText(dose)) {
      return { settings, parameters, doses, dose };
    }
  } catch {
    // What it is not, the next line says.
  }
  throw new Error("a part of it is missing or changed");
}
