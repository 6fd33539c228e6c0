// Whether all can use a page.

import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";

/** @import { Page } from "playwright-core" */

const AXE = createRequire(import.meta.url).resolve("axe-core/axe.min.js");

/** @param {Page} page What axe complains of. */
export async function violationsOn(page) {
  // The page's own policy forbids any other script; this way goes round it.
  await page.evaluate(await readFile(AXE, "utf8"));
  /** @type {import("axe-core").AxeResults} */
  const { violations } = await page.evaluate("axe.run()");
  return violations.map(({ id, nodes }) => [id, nodes.map(({ html }) => html)]);
}
