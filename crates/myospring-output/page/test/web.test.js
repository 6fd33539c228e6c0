// The page that simulates, in Chromium: opens from disk without a network, answers its sliders, compares, reads and saves.

import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { violationsOn } from "./axe.js";
import { folder, myospring } from "./program.js";

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

test("the file of a published cell model beats the cell, with its constants as sliders", async () => {
  const source = join(import.meta.dirname, "../../../myospring/tests/study/aliev_panfilov.mmt");
  const file = join(folder, "aliev.mmt");
  // With a name by which its calcium is found.
  await writeFile(file, (await readFile(source, "utf8")).replaceAll("level", "Cai"));
  await opened({}, async (page) => {
    const before = await runsOf(page);
    await page.locator("#file").setInputFiles(file);
    await ran(page, before + 1);
    const chosen = page.getByRole("combobox", { name: "cell model", exact: true });
    assert.equal(await chosen.inputValue(), "aliev.mmt");
    await page.getByText(/^Its \d+ parameters$/).click();
    const field = page.getByRole("spinbutton", { name: /^membrane_k/ });
    await field.fill("8.5");
    await field.press("Enter");
    await ran(page, before + 2);
    assert.equal(await page.locator("#failure").isVisible(), false);
    const broken = join(folder, "broken.mmt");
    await writeFile(broken, "[[model]]\n");
    await page.locator("#file").setInputFiles(broken);
    await page.locator("#failure").waitFor();
    assert.match((await page.locator("#failure").textContent()) ?? "", /broken\.mmt/);
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

/** Waits until an experiment has ended, and says how. @param {Page} page */
async function ended(page) {
  await page.waitForFunction(() => /: done in|^$/.test(document.getElementById("state")?.textContent ?? ""), null, { timeout: 120_000 });
  return (await page.locator("#failure").isVisible()) ? page.locator("#failure").textContent() : null;
}

/** A file of the results that are listed. @param {Page} page @param {string} name */
async function result(page, name) {
  const waiting = page.waitForEvent("download");
  await page.locator("#results").getByRole("button", { name, exact: true }).click();
  return readFile(await (await waiting).path(), "utf8");
}

/**
 * Numbers are alike, everything else is equal.
 *
 * @param {any} one
 * @param {any} other
 * @param {number} tolerance Relative.
 * @param {string} [place]
 */
function alike(one, other, tolerance, place = "") {
  if (typeof one === "number" && typeof other === "number") {
    assert.ok(Math.abs(one - other) <= tolerance * Math.max(Math.abs(one), Math.abs(other)), `${place}: ${one}, ${other}`);
  } else if (typeof one === "object" && one !== null) {
    assert.deepEqual(Object.keys(one), Object.keys(other), place);
    for (const key of Object.keys(one)) alike(one[key], other[key], tolerance, `${place}.${key}`);
  } else assert.equal(one, other, place);
}

/** A contraction of 10 %, 100 frames a second, with a wave instead of noise. */
function contraction() {
  const rows = ["time (ms),length (um)"];
  for (let time = 0; time < 2000; time += 10) {
    const since = (time % 1000) - 100;
    const part = since > 0 ? (since / 90) ** 2 * Math.exp(2 * (1 - since / 90)) : 0;
    rows.push(`${time},${(110 - 11 * part + 0.05 * Math.sin(1.3 * time)).toFixed(4)}`);
  }
  return rows.join("\n");
}

test("a curve is analysed and fitted as the program does it, and the cell beats with the fitted numbers", async () => {
  const curve = join(folder, "contraction.csv");
  await writeFile(curve, contraction());
  await myospring("analyse", "contraction.csv", "--output", "analysed", "--force");
  await myospring("fit", "--to", "contraction.csv", "--output", "fitted", "--force");
  const read = async (/** @type {string} */ name) => JSON.parse(await readFile(join(folder, name), "utf8"));
  await opened({}, async (page) => {
    await page.locator("#file").setInputFiles(curve);
    assert.equal(await ended(page), null);
    const analysed = JSON.parse(await result(page, "summary.json"));
    alike(analysed.curves, (await read("analysed/summary.json")).curves, 1e-9);
    await shot(page, "curve");
    await page.getByRole("button", { name: "Fit the cell" }).click();
    assert.equal(await ended(page), null);
    const fit = JSON.parse(await result(page, "fit.json"));
    const expected = await read("fitted/fit.json");
    assert.equal(fit.model, expected.model);
    // Both descend to the same minimum, on arithmetic that differs in its last digits.
    for (const [at, { value }] of fit.estimates.entries()) alike(value, expected.estimates[at].value, 1e-5);
    await shot(page, "fit");
    const before = await runsOf(page);
    await page.getByRole("button", { name: "Beat with the fitted numbers" }).click();
    await ran(page, before + 1);
    assert.match((await page.locator("h1").textContent()) ?? "", /fitted to contraction\.csv/);
    const waiting = page.waitForEvent("download");
    await page.getByRole("button", { name: "Run file", exact: true }).click();
    await writeFile(join(folder, "fitted.toml"), await readFile(await (await waiting).path()));
    if (fit.model !== "given_tension") {
      await myospring("run", "fitted.toml", "--output", "beaten", "--force");
      const { beats } = await read("beaten/summary.json");
      const shown = await tile(page, "peak shortening");
      const peaks = beats.map((/** @type {object} */ beat) => Object.values(beat).flat().find(({ name }) => name === "peak_shortening").value);
      const value = peaks.reduce((/** @type {number} */ sum, /** @type {number} */ peak) => sum + peak, 0) / peaks.length;
      assert.ok(Math.abs(Number.parseFloat(shown ?? "") - value) < 0.006, `${shown}, ${value}`);
    }
  });
});

test("what a curve does not say is asked for in the words of the page", async () => {
  const curve = join(folder, "bare.csv");
  await writeFile(curve, contraction().split("\n").map((row) => row.split(",")[1]).join("\n"));
  await opened({}, async (page) => {
    await page.locator("#file").setInputFiles(curve);
    assert.match((await ended(page)) ?? "", /\u201cframes a second\u201d/);
    const field = page.getByLabel("Frames a second");
    await field.fill("100");
    await field.press("Tab");
    await page.locator("#results").getByRole("button").first().waitFor();
    assert.match((await page.locator("body").textContent()) ?? "", /2 beats; peak shortening/);
    const before = await runsOf(page);
    await page.getByRole("button", { name: "Back to the cell" }).click();
    await ran(page, before + 1);
    assert.equal(await tile(page, "peak shortening"), "12.01 %");
  });
});

test("a film is followed, and says how far it is", async () => {
  const [width, height, frames] = [200, 80, 12];
  const film = [Buffer.from(`YUV4MPEG2 W${width} H${height} F20:1 Cmono\n`)];
  for (let frame = 0; frame < frames; frame++) {
    const stretch = 1 - 0.08 * Math.sin((Math.PI * frame) / (frames - 1)) ** 2;
    const grey = Buffer.alloc(width * height);
    for (let at = 0; at < grey.length; at++) {
      const [x, y] = [((at % width) - width / 2) / stretch, Math.floor(at / width) - height / 2];
      const isCell = Math.hypot(x / 75, y / 20) < 1;
      const spots = Math.sin(0.9 * x + 0.2 * y) + 0.6 * Math.sin(0.31 * x - 0.7 * y) + 0.5 * Math.sin(0.17 * x + 0.43 * y);
      grey[at] = isCell ? 150 + 30 * spots : 20;
    }
    film.push(Buffer.from("FRAME\n"), grey);
  }
  await writeFile(join(folder, "film.y4m"), Buffer.concat(film));
  await opened({}, async (page) => {
    await page.locator("#file").setInputFiles(join(folder, "film.y4m"));
    assert.match((await ended(page)) ?? "", /\u201csize of a pixel\u201d/);
    /** @type {string[]} */
    const said = [];
    await page.exposeFunction("heard", (/** @type {string} */ text) => said.push(text));
    await page.evaluate(() => {
      const state = document.getElementById("state");
      if (state !== null) new MutationObserver(() => /** @type {any} */ (window).heard(state.textContent)).observe(state, { childList: true });
    });
    const size = page.locator("#measured").getByLabel("Size of a pixel, \u00b5m");
    await size.fill("0.6");
    await size.press("Tab");
    await page.locator("#results").getByRole("button", { name: "track.csv" }).waitFor({ timeout: 120_000 });
    assert.ok(said.some((text) => /frames, \d+ of/.test(text)), said.join("; "));
    const rows = (await result(page, "track.csv")).trim().split("\n");
    assert.equal(rows.length, frames + 1);
    await shot(page, "film");
  });
});

test("all files of a run are saved, and its report is opened again", async () => {
  await opened({}, async (page) => {
    await page.getByRole("button", { name: "All files" }).click();
    await page.locator("#results").getByRole("button", { name: /\.gif$/ }).first().waitFor({ timeout: 120_000 });
    assert.ok((await page.locator("#results").getByRole("button", { name: /\.svg$/ }).count()) > 0);
    await writeFile(join(folder, "kept.html"), await result(page, "report.html"));
    await slide(page, "peak tension", "PageDown");
    const before = await runsOf(page);
    await page.locator("#file").setInputFiles(join(folder, "kept.html"));
    await ran(page, before + 1);
    assert.equal(await tile(page, "peak shortening"), "12.01 %");
  });
});

test("of a picture another cell is taken, its outline is edited, and what comes out is read by the program", async () => {
  await opened({}, async (page) => {
    const words = page.locator("#shown-cells-words");
    const [first] = [await runsOf(page), await page.getByLabel("Or try a made-up picture").selectOption("two cells")];
    await ran(page, first + 1);
    assert.match((await words.textContent()) ?? "", /^2 cells were found.*confidence/);
    const numbers = () => page.locator("main").textContent();
    const before = await numbers();
    await shot(page, "cells");
    const other = page.locator("#shown-cells-place path:not(.taken)");
    await other.focus();
    await other.press("Enter");
    await ran(page, first + 2);
    const ofOther = await numbers();
    assert.notEqual(ofOther, before);

    const place = await page.locator("#shown-cells-place path.taken").boundingBox();
    if (place === null) throw new Error("no cell is taken");
    await page.getByLabel("add with a brush").check();
    const [x, y] = [place.x + place.width - 4, place.y + place.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 40, y, { steps: 4 });
    await page.mouse.up();
    await ran(page, first + 3);
    assert.match((await words.textContent()) ?? "", /your own/);
    assert.notEqual(await numbers(), ofOther);
    await page.getByRole("button", { name: "Undo" }).click();
    await ran(page, first + 4);

    await page.getByLabel("move points").check();
    const point = page.locator("#shown-cells-place circle").first();
    await point.focus();
    await point.press("ArrowUp");
    await ran(page, first + 5);
    await shot(page, "points");
    for (const name of ["Outline (.roi)", "Outline (GeoJSON)"]) {
      const waiting = page.waitForEvent("download");
      await page.getByRole("button", { name, exact: true }).click();
      const download = await waiting;
      const file = join(folder, download.suggestedFilename());
      await writeFile(file, await readFile(await download.path()));
      const units = file.endsWith(".roi") ? ["--pixel-size", "0.25 um"] : [];
      await myospring("mesh", file, ...units, "--output", `${file}.vtu`, "--force");
    }
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
