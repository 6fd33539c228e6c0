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
 * Beats a cell and gives the path of its page.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
export async function beat(name, ...args) {
  const output = join(folder, name);
  await promisify(execFile)(program, ["run", "--quiet", "--outputs", "report", "--output", output, ...args]);
  return join(output, "report.html");
}

/**
 * Compares runs and gives the path of their page.
 *
 * @param {string} name Of the folder of results.
 * @param {string[]} args
 */
export async function compare(name, ...args) {
  const output = join(folder, name);
  await promisify(execFile)(program, ["compare", "--quiet", "--output", output, ...args]);
  return join(output, "report.html");
}

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
