// The page that simulates, in Chromium: opens from disk without a network, answers its sliders, compares, reads and saves.

import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { violationsOn } from "./axe.js";
import { folder } from "./program.js";

/** @import { Browser, BrowserContextOptions, Page } from "playwright-core" */

const PAGE = pathToFileURL(process.env.PAGE ?? "").href;
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
 * @param {BrowserContextOptions} options
 * @param {(page: Page) => Promise<void>} work
 */
async function opened(options, work) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, offline: true, ...options });
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
async function ran(page, runs) {
  await page.waitForFunction((least) => Number(document.body.dataset.runs ?? 0) >= least, runs, { timeout: 60_000 });
}

/** Results shown so far. @param {Page} page */
const runsOf = (page) => page.evaluate(() => Number(document.body.dataset.runs));

/** A key number. @param {Page} page @param {string} name */
async function tile(page, name) {
  return (await page.locator(".tiles > div", { hasText: name }).locator(".value").textContent())?.replace("\u00a0", " ");
}

/** @param {Page} page @param {string} name */
async function shot(page, name) {
  if (SHOTS !== undefined) await page.screenshot({ path: join(SHOTS, `${name}.png`) });
}

/** Moves a slider by keys, as anyone can. @param {Page} page @param {string} name @param {string} key */
async function slide(page, name, key) {
  const before = await runsOf(page);
  await page.getByRole("slider", { name, exact: true }).press(key);
  await ran(page, before + 1);
}

test("it opens from disk, beats the built-in cell and says its numbers, without a network", async () => {
  await opened({}, async (page) => {
    assert.equal(await tile(page, "peak shortening"), "12.01 %");
    assert.equal(await page.locator("#failure").isVisible(), false);
    await shot(page, "desktop");
    const time = () => page.locator("#clock").textContent();
    const first = await time();
    await page.waitForFunction((before) => document.getElementById("clock")?.textContent !== before, first);
  });
});

test("each slider changes the beat, which goes on where it was", async () => {
  await opened({}, async (page) => {
    await page.locator("#play").click();
    const stood = await page.locator("#clock").textContent();
    await slide(page, "peak tension", "PageDown");
    assert.notEqual(await tile(page, "peak shortening"), "12.01 %");
    assert.equal(await page.locator("#clock").textContent(), stood);
    for (const name of ["Young's modulus", "angle of the fibres", "stimuli"]) {
      const was = await page.locator("main").textContent();
      await slide(page, name, "ArrowRight");
      assert.notEqual(await page.locator("main").textContent(), was, name);
    }
    const before = await runsOf(page);
    await page.getByRole("button", { name: "All as published" }).click();
    await ran(page, before + 1);
    assert.equal(await tile(page, "peak shortening"), "12.01 %");
  });
});

test("every model and every support beats", async () => {
  await opened({}, async (page) => {
    for (const name of ["support", "cell model"]) {
      const select = page.getByRole("combobox", { name, exact: true });
      for (const value of await select.locator("option").evaluateAll((all) => all.map((one) => /** @type {HTMLOptionElement} */ (one).value))) {
        if (value === (await select.inputValue())) continue;
        const before = await runsOf(page);
        await select.selectOption(value);
        await ran(page, before + 1);
        assert.equal(await page.locator("#failure").isVisible(), false, value);
      }
      await select.selectOption({ index: 0 });
    }
  });
});

test("a run is pinned, and the next one compared with it", async () => {
  await opened({}, async (page) => {
    await page.getByRole("button", { name: "Pin this run" }).click();
    await ran(page, 2);
    await slide(page, "peak tension", "PageDown");
    assert.equal(await page.locator("#legend li").count(), 2);
    assert.match((await page.locator("#differences").textContent()) ?? "", /peak_tension/);
    await shot(page, "compared");
    await page.getByRole("button", { name: "Unpin" }).click();
    await page.waitForFunction(() => document.getElementById("differences") === null);
  });
});

test("a value out of bounds and a file that cannot be read are explained, and the page goes on", async () => {
  await opened({}, async (page) => {
    const field = page.getByRole("spinbutton", { name: /^Young's modulus/ });
    await field.fill("0");
    await field.press("Enter");
    await page.locator("#failure").waitFor();
    assert.match((await page.locator("#failure").textContent()) ?? "", /young_modulus.*0\.1 kPa/);
    const text = join(folder, "cell.docx");
    await writeFile(text, "no picture");
    await page.locator("#file").setInputFiles(text);
    assert.match((await page.locator("#failure").textContent()) ?? "", /cell\.docx/);
    const before = await runsOf(page);
    await field.fill("300");
    await field.press("Enter");
    await ran(page, before + 1);
    assert.equal(await page.locator("#failure").isVisible(), false);
  });
});

test("a long run can be stopped", async () => {
  await opened({}, async (page) => {
    const field = page.getByRole("spinbutton", { name: /^stimuli/ });
    await field.fill("90");
    await field.press("Enter");
    const stop = page.getByRole("button", { name: "Stop" });
    await stop.waitFor();
    await stop.click();
    await page.waitForFunction(() => document.getElementById("state")?.textContent === "Stopped.");
    const before = await runsOf(page);
    await field.fill("1");
    await field.press("Enter");
    await ran(page, before + 1);
    assert.equal(await tile(page, "peak shortening"), "12.01 %");
  });
});

test("what it saves is whole", async () => {
  await opened({}, async (page) => {
    for (const [button, name, begins] of [
      ["Report", "report.html", "<!doctype html>"],
      ["Run file", "run.toml", "# Written by myospring"],
      ["Curves (CSV)", "traces.csv", "t_ms,"],
      ["Figure (PNG)", "overview.png", "\ufffdPNG"],
    ]) {
      const waiting = page.waitForEvent("download");
      await page.getByRole("button", { name: button, exact: true }).click();
      const download = await waiting;
      assert.equal(download.suggestedFilename(), name);
      assert.ok((await readFile(await download.path(), "utf8")).startsWith(begins), name);
    }
  });
});

test("a link holds the set-up, and one that cannot be read is explained", async () => {
  let link = "";
  let numbers = "";
  await opened({}, async (page) => {
    await slide(page, "peak tension", "PageDown");
    const before = await runsOf(page);
    await page.getByRole("combobox", { name: "shape", exact: true }).selectOption("hipsc_derived");
    await ran(page, before + 1);
    numbers = (await page.locator(".tiles").textContent()) ?? "";
    await page.getByRole("button", { name: "Link", exact: true }).click();
    await page.waitForFunction(() => /holds the set-up/.test(document.getElementById("state")?.textContent ?? ""));
    link = page.url();
  });
  await opened({}, async (page) => {
    const before = await runsOf(page);
    await page.evaluate((behind) => location.assign(behind), new URL(link).hash);
    await ran(page, before + 1);
    assert.equal(await page.locator(".tiles").textContent(), numbers);
    assert.equal(await page.getByRole("combobox", { name: "shape", exact: true }).inputValue(), "hipsc_derived");
    for (const [behind, why] of [["#set-up-1=e30", "missing or changed"], [new URL(link).hash.slice(0, -9), "missing or changed"], ["#set-up-2=e30", "newer version"]]) {
      await page.evaluate((to) => location.assign(to), behind);
      await page.waitForFunction((words) => document.getElementById("failure")?.textContent?.includes(words), why);
    }
    assert.equal(await page.locator(".tiles").textContent(), numbers);
  });
});

test("nothing is too wide for a phone, in light and dark, and axe finds nothing", async () => {
  for (const [name, options] of /** @type {[string, BrowserContextOptions][]} */ ([
    ["wide", {}],
    ["dark", { colorScheme: "dark" }],
    ["phone", { viewport: { width: 390, height: 844 } }],
  ])) {
    await opened({ ...options, reducedMotion: "reduce" }, async (page) => {
      const [inner, all] = await page.evaluate(() => [innerWidth, document.documentElement.scrollWidth]);
      assert.ok(all <= inner, `${name}: ${all} px of ${inner}`);
      await shot(page, name);
      if (name === "phone") {
        await page.locator("#setup > summary").click();
        await shot(page, "phone-open");
      }
      assert.deepEqual(await violationsOn(page), [], name);
    });
  }
});
