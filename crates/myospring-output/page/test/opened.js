// The page that simulates, opened in Chromium from disk, without a network.

import assert from "node:assert/strict";
import { mkdir, readFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

/** @import { Browser, BrowserContextOptions, Page } from "playwright-core" */

export const PAGE = pathToFileURL(process.env.PAGE ?? "").href;
const SHOTS = process.env.SHOTS;

/** @type {Browser} */
let browser;
before(async () => {
  // Containers have no user namespaces for its sandbox; the page is our own.
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox"] });
  if (SHOTS !== undefined) await mkdir(SHOTS, { recursive: true });
});
after(() => browser?.close());

/**
 * Opens the page, waits for its first beat and does something; whatever it complains about or asks the network for is an error.
 *
 * The cell stands still unless a test asks for motion: without a graphics card, drawing it takes half of the time of the tests.
 *
 * @param {BrowserContextOptions} options
 * @param {(page: Page) => Promise<void>} work
 */
export async function opened(options, work) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, offline: true, reducedMotion: "reduce", ...options });
  /** @type {string[]} */
  const complaints = [];
  try {
    const page = await context.newPage();
    page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
    page.on("pageerror", (error) => complaints.push(`error: ${error.stack}`));
    page.on("request", (request) => {
      if (!/^(file|data|blob):/.test(request.url())) complaints.push(`asks for ${request.url()}`);
    });
    await page.goto(PAGE);
    await ran(page, 1);
    await work(page);
    assert.deepEqual(complaints, []);
  } finally {
    await context.close();
  }
}

/** Waits until a number of results was shown. @param {Page} page @param {number} runs */
export async function ran(page, runs) {
  await page.waitForFunction((least) => Number(document.body.dataset.runs ?? 0) >= least, runs, { timeout: 240_000 });
}

/** Results shown so far. @param {Page} page */
export const runsOf = (page) => page.evaluate(() => Number(document.body.dataset.runs));

/** A key number. @param {Page} page @param {string} name */
export async function tile(page, name) {
  return (await page.locator(".tiles > div", { hasText: name }).locator(".value").textContent())?.replace("\u00a0", " ");
}

/** @param {Page} page @param {string} name */
export async function shot(page, name) {
  if (SHOTS !== undefined) await page.screenshot({ path: join(SHOTS, `${name}.png`) });
}

/** Moves a slider by keys, as anyone can. @param {Page} page @param {string} name @param {string} key */
export async function slide(page, name, key) {
  const before = await runsOf(page);
  await page.getByRole("slider", { name, exact: true }).press(key);
  await ran(page, before + 1);
}

/** Waits until an experiment has ended, and says how. @param {Page} page */
export async function ended(page) {
  await page.waitForFunction(() => /: done in|^$/.test(document.getElementById("state")?.textContent ?? ""), null, { timeout: 120_000 });
  return (await page.locator("#failure").isVisible()) ? page.locator("#failure").textContent() : null;
}

/** A file of the results that are listed. @param {Page} page @param {string} name */
export async function result(page, name) {
  const waiting = page.waitForEvent("download");
  await page.locator("#results").getByRole("button", { name, exact: true }).click();
  return readFile(await (await waiting).path(), "utf8");
}
