// The page that simulates, in Chromium: opens from disk without a network, answers its sliders, compares and saves.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";
import { violationsOn } from "./axe.js";
import { opened, ran, result, runsOf, shot, slide, tile } from "./opened.js";
import { folder, myospring } from "./program.js";

/** @import { BrowserContextOptions, Page } from "playwright-core" */

test("it opens from disk, beats the built-in cell and says its numbers, without a network", async () => {
  await opened({ reducedMotion: "no-preference" }, async (page) => {
    assert.equal(await tile(page, "peak shortening"), "12.01 %");
    assert.equal(await page.locator("#failure").isVisible(), false);
    await shot(page, "desktop");
    const time = () => page.locator("#clock").textContent();
    const first = await time();
    await page.waitForFunction((before) => document.getElementById("clock")?.textContent !== before, first);
  });
});

test("each slider changes the beat, which goes on where it was", async () => {
  await opened({ reducedMotion: "no-preference" }, async (page) => {
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

test("a strip of tissue has a velocity, and its wave is told", async () => {
  await opened({}, async (page) => {
    assert.equal(await page.getByRole("group", { name: "Tissue" }).isVisible(), false);
    const before = await runsOf(page);
    await page.getByRole("combobox", { name: "shape", exact: true }).selectOption("tissue_strip");
    await ran(page, before + 1);
    assert.equal(await page.getByRole("group", { name: "Tissue" }).isVisible(), true);
    assert.match((await page.locator("main").textContent()) ?? "", /conduction velocity/);
    await shot(page, "tissue");
  });
});

/** Takes a run file with a coarse mesh: the engine that is built for tests is slow. @param {Page} page */
async function coarse(page) {
  const file = join(folder, "coarse.toml");
  await writeFile(file, '[shape]\nspacing = "4 um"\n[numerics]\nintegrator = "quasi-static"\n');
  const before = await runsOf(page);
  await page.locator("#file").setInputFiles(file);
  await ran(page, before + 1);
}

test("every model and every support beats", async () => {
  // The library's own tests beat every model.
  const all = process.env.MYOSPRING_ALL_CASES !== undefined;
  await opened({}, async (page) => {
    await coarse(page);
    for (const name of ["support", "cell model"]) {
      const select = page.getByRole("combobox", { name, exact: true });
      let number = 0;
      for (const value of await select.locator("option").evaluateAll((all) => all.map((one) => /** @type {HTMLOptionElement} */ (one).value))) {
        if (value === (await select.inputValue())) continue;
        if (name === "cell model" && number++ % 3 !== 0 && !all) continue;
        const before = await runsOf(page);
        await select.selectOption(value);
        await ran(page, before + 1);
        assert.equal(await page.locator("#failure").isVisible(), false, value);
      }
      await select.selectOption({ index: 0 });
    }
  });
});

test("a cell with a section of its own beats in space, and becomes flat again", async () => {
  await opened({}, async (page) => {
    const choose = async (/** @type {string} */ name) => {
      const before = await runsOf(page);
      await page.getByRole("combobox", { name: "section", exact: true }).selectOption(name);
      await ran(page, before + 1);
    };
    await coarse(page);
    const flat = await tile(page, "peak shortening");
    assert.equal(await page.getByRole("slider", { name: "turn of the fibres" }).isVisible(), false);
    await choose("dome");
    assert.ok(await page.isVisible("canvas.turns"));
    const straight = await tile(page, "peak shortening");
    assert.match(straight ?? "", /^1[12]\.\d\d %$/);
    await shot(page, "dome");
    await slide(page, "turn of the fibres", "PageUp");
    assert.notEqual(await tile(page, "peak shortening"), straight);
    await choose("flat");
    assert.equal(await page.locator("canvas.turns").count(), 0);
    assert.equal(await tile(page, "peak shortening"), flat);
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
    await coarse(page);
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

test("six questions set the cell up, step by step", async () => {
  await opened({}, async (page) => {
    await coarse(page);
    await page.getByRole("button", { name: "Six questions" }).click();
    await shot(page, "tour");
    assert.deepEqual(await violationsOn(page), []);
    for (let step = 1; step <= 6; step++) {
      assert.match((await page.locator("#tour-title").textContent()) ?? "", new RegExp(`^${step} of 6: .*\\?$`));
      assert.match((await page.locator("#tour-question").textContent()) ?? "", /\?/);
      const tries = page.locator("#tour-tries button");
      assert.ok((await tries.count()) > 1);
      for (const one of await tries.all()) {
        const before = await runsOf(page);
        await one.click();
        await ran(page, before + 1);
        assert.equal(await page.locator("#failure").isVisible(), false, (await one.textContent()) ?? "");
      }
      await page.locator("#tour-next").click();
    }
    assert.equal(await page.locator("#tour").isVisible(), false);
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
    await ran(page, before + 2);
    assert.equal(await tile(page, "peak shortening"), "12.01 %");
    assert.equal(await page.getByRole("slider", { name: "peak tension", exact: true }).inputValue(), "50");
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
