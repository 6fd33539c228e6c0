// Runs the program, so that tests look at what it really writes.

import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { promisify } from "node:util";

/** @import { Payload } from "../src/payload.js" */

const program = process.env.MYOSPRING ?? "";
if (program === "") throw new Error("MYOSPRING must name the program `myospring`");

/** A folder that is gone when the tests are over. */
export const folder = await mkdtemp(join(tmpdir(), "myospring-page-"));
after(() => rm(folder, { recursive: true, force: true }));

/**
 * Runs a command that leaves a page, and gives the path of that.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
async function pageOf(name, ...args) {
  const output = join(folder, name);
  await promisify(execFile)(program, [...args, "--quiet", "--output", output]);
  return join(output, "report.html");
}

/**
 * Beats a cell.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
export const beat = (name, ...args) => pageOf(name, "run", "--outputs", "report", ...args);

/**
 * Compares runs.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
export const compare = (name, ...args) => pageOf(name, "compare", ...args);

/**
 * Fits a cell.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
export const fit = (name, ...args) => pageOf(name, "fit", ...args);

/**
 * Reads the beats of measured curves.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
export const analyse = (name, ...args) => pageOf(name, "analyse", ...args);

/**
 * Beats the cells of the pictures in a folder.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
export const batch = (name, ...args) => pageOf(name, "batch", ...args);

/**
 * The data in a page.
 *
 * @param {string} path
 * @returns {Promise<Payload>}
 */
export async function payloadOf(path) {
  const page = await readFile(path, "utf8");
  const data = page.match(/<script type="application\/json" id="data">(.*?)<\/script>/s);
  if (data === null) throw new Error(`${path} has no data`);
  return JSON.parse(data[1]);
}

/**
 * The beat of a page.
 *
 * @param {Payload} payload
 */
export function beatIn({ sections }) {
  const beat = sections.flatMap(({ parts }) => parts).find((part) => part.kind === "beat");
  if (beat === undefined) throw new Error("the page has no beat");
  return beat;
}

/**
 * The numbers of the only run of a page, by their names: value, unit, definition.
 *
 * @param {Payload} payload
 */
export function numbersIn({ sections }) {
  const tables = sections.filter(({ id }) => id === "metrics").flatMap(({ parts }) => parts);
  const rows = tables.flatMap((part) => (part.kind === "table" ? part.rows : []));
  return new Map(rows.map(({ cells: [name, value, unit] }) => [name.text, [value.number, unit.text, name.definition]]));
}

/** Runs a command in the folder. @param {string[]} args */
export const myospring = (...args) => promisify(execFile)(program, args, { cwd: folder });
