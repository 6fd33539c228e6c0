// The page in Chromium: loads, plays, scrubs, prints, can be read by all.

import assert from "node:assert/strict";
import { mkdir, readFile, stat, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { violationsOn } from "./axe.js";
import { leavesOut } from "./looks.js";
import "./parts.js";
import { analyse, batch, beat, beatIn, compare, fit, folder, payloadOf } from "./program.js";

/** @import { Browser, BrowserContextOptions, Page } from "playwright-core" */

const NASTY = "</script><script>alert(1)</script>\"'&\u2028";

/** @type {Browser} */
let browser;
/** @type {string} Page of the default run. */
let report;
/** @type {string} Of two runs beside it, and of the fit of its length. */
let comparison;
/** @type {string} */
let fitted;
/** @type {string} Of a curve that the model does not follow. */
let unfitted;
/** @type {string} Of two measured curves. */
let analysed;

before(async () => {
  // Containers and continuous integration have no user namespaces for its sandbox; the page is our own.
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox"] });
  report = await beat("default");
  const quick = ["--integrator", "quasi-static", "--spacing", "4 um"];
  const curve = join(folder, "measured.csv");
  await writeFile(curve, await measured(join(report, "../traces.csv")));
  const other = join(folder, "plateau.csv");
  await writeFile(other, plateau());
  const train = join(folder, "train.csv");
  await writeFile(train, beats());
  [comparison, fitted, unfitted, analysed] = await Promise.all([
    compare("two", ...quick, "--scale", "peak_tension=0.5"),
    fit("fitted", "--to", curve, "--spacing", "4 um"),
    fit("unfitted", "--to", other, "--spacing", "4 um", "--model", "coelho_2021"),
    analyse("analysed", train),
  ]);
});
after(() => browser?.close());

/**
 * Opens a page and does something with it; whatever it complains about or asks the network for is an error.
 *
 * @param {string} path
 * @param {BrowserContextOptions} options
 * @param {(page: Page) => Promise<void>} work
 */
async function opened(path, options, work) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 900 }, ...options });
  /** @type {string[]} */
  const complaints = [];
  try {
    const page = await context.newPage();
    page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
    page.on("pageerror", (error) => complaints.push(`error: ${error.stack}`));
    page.on("dialog", (dialog) => {
      complaints.push(`dialog: ${dialog.message()}`);
      void dialog.dismiss();
    });
    page.on("request", (request) => {
      const url = request.url();
      if (url !== pathToFileURL(path).href && !url.startsWith("data:")) complaints.push(`asks for ${url}`);
    });
    await page.goto(pathToFileURL(path).href);
    await page.waitForFunction(() => document.querySelectorAll(".chart canvas, .gallery img").length >= 2);
    await work(page);
    assert.deepEqual(complaints, []);
  } finally {
    await context.close();
  }
}

/**
 * The length of a run as a camera with noise of 0.1 um has it, every 4 ms.
 *
 * @param {string} traces
 */
async function measured(traces) {
  const [head, ...rows] = (await readFile(traces, "utf8")).trim().split("\n");
  const columns = ["t_ms", "length_um"].map((name) => head.split(",").indexOf(name));
  const frames = rows.filter((_, index) => index % 8 === 0);
  const noise = (/** @type {number} */ at) => 0.1 * Math.sin(7 * at * at + at);
  const lines = frames.map((row, index) => {
    const [time, length] = columns.map((column) => Number(row.split(",")[column]));
    return `${time},${(length + noise(index)).toFixed(4)}`;
  });
  return `time_ms,length_um\n${lines.join("\n")}\n`;
}

/** A cell that becomes shorter, stays so for a while and lets go, as no setting of the default model does. */
function plateau() {
  const shortening = (/** @type {number} */ time) =>
    12 * Math.min(Math.max((time - 50) / 60, 0), Math.max(Math.min((420 - time) / 120, 1), 0), 1);
  const times = Array.from({ length: 150 }, (_, index) => 4 * index);
  const lines = times.map((time) => `${time},${(140 - shortening(time) + 0.05 * Math.sin(7 * time * time)).toFixed(4)}`);
  return `time_ms,length_um\n${lines.join("\n")}\n`;
}

/** Length and calcium over ten beats, the fifth of which is disturbed: somebody touched the table. */
function beats() {
  const pulse = (/** @type {number} */ time) => Math.max(0, Math.sin((Math.PI * ((time + 800) % 1000)) / 300) * Number((time + 800) % 1000 < 300));
  const touched = (/** @type {number} */ time) => 6 * Number(time > 4700 && time < 5100);
  const lines = Array.from({ length: 1250 }, (_, index) => {
    const time = 8 * index;
    const noise = 0.02 * Math.sin(7 * time * time);
    return `${time},${(120 - 10 * pulse(time) + touched(time) + noise).toFixed(4)},${(0.1 + pulse(time) + noise / 10).toFixed(5)}`;
  });
  return `time_ms,length_um,calcium_uM\n${lines.join("\n")}\n`;
}

/** @param {Page} page */
const openAll = (page) =>
  page.evaluate(() => document.querySelectorAll("details").forEach((details) => (details.open = true)));

/** @param {Page} page */
async function printedPages(page) {
  const paper = await page.pdf({ format: "A4" });
  return paper.toString("latin1").match(/\/Type\s*\/Page\b/g)?.length ?? 0;
}

/** @param {Page} page */
const pixels = (page) =>
  page.evaluate(() => /** @type {HTMLCanvasElement} */ (document.querySelector("#cells canvas")).toDataURL());
/** @param {Page} page */
const time = (page) => page.inputValue("#time").then(Number);
/** @param {Page} page */
const cursor = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll(".time-cursor")].map((line) => line.getBoundingClientRect().left),
  );

/** @type {BrowserContextOptions} */
const STILL = { reducedMotion: "reduce" };

test("the page of the default run is one file of less than 3 MB", async () => {
  assert.ok((await stat(report)).size < 3e6);
  const text = await readFile(report, "utf8");
  assert.ok(!/(?:src|href)="(?!data:)/.test(text.replace(/<script[\s\S]*?<\/script>/g, "")));
});

test("it plays by itself, pauses and goes on", async () => {
  await opened(report, {}, async (page) => {
    const first = await pixels(page);
    await page.waitForFunction(() => Number(/** @type {HTMLInputElement} */ (document.querySelector("#time")).value) > 120);
    assert.notEqual(await pixels(page), first);
    await page.click("#play");
    const stopped = await time(page);
    await page.waitForTimeout(200);
    assert.equal(await time(page), stopped);
    assert.equal(await page.getAttribute("#play", "aria-label"), "Play");
    await page.selectOption("#speed", "1");
    await page.click("#play");
    await page.waitForFunction((from) => Number(/** @type {HTMLInputElement} */ (document.querySelector("#time")).value) !== from, stopped);
  });
});

test("those who want less motion see it stand until they ask", async () => {
  await opened(report, STILL, async (page) => {
    await page.waitForTimeout(200);
    assert.equal(await time(page), 0);
    assert.equal(await page.getAttribute("#play", "aria-label"), "Play");
  });
});

test("time, cell and curves go together, from whichever side", async () => {
  await opened(report, STILL, async (page) => {
    const [resting, start] = [await pixels(page), await cursor(page)];
    await page.fill("#time", "171.5");
    const scrubbed = await cursor(page);
    assert.ok(scrubbed.every((at, chart) => at > start[chart]));
    assert.equal(new Set(scrubbed.map(Math.round)).size, 1, "all charts show one time");
    assert.notEqual(await pixels(page), resting);
    // Strain at the peak of the default run: 12 % shorter.
    const least = Number(await page.getAttribute("#cells", "data-least"));
    assert.ok(Math.abs(least + 12) < 0.3, `${least}`);
    assert.match((await page.getAttribute("#time", "aria-valuetext")) ?? "", /172 ms: .*50\.00\skPa.*12\.01\s%/);
    // Over the second chart, at half of its width: the cell follows.
    const chart = page.locator(".u-over").nth(1);
    await chart.scrollIntoViewIfNeeded();
    const box = await chart.boundingBox();
    assert.ok(box !== null);
    await page.mouse.move(box.x + box.width / 2, box.y + 20);
    assert.ok(Math.abs((await time(page)) - 300) < 2);
  });
});

test("every way to colour the cell draws another picture", async () => {
  // With fibres askew no two of them are even.
  const askew = await beat("askew", "--integrator", "quasi-static", "--fibre", "20 deg");
  await opened(askew, STILL, async (page) => {
    await page.fill("#time", "140");
    const seen = new Set();
    const fields = await page.locator("#field option").evaluateAll((options) => options.map((option) => option.getAttribute("value")));
    for (const field of fields) {
      await page.selectOption("#field", field);
      seen.add(await pixels(page));
    }
    assert.equal(fields.length, 5);
    assert.equal(seen.size, 5);
  });
});

test("it can be used by keyboard alone", async () => {
  await opened(report, STILL, async (page) => {
    await page.keyboard.press("ArrowRight");
    assert.equal(await time(page), 5);
    await page.keyboard.press("End");
    assert.equal(await time(page), 600);
    await page.keyboard.press("Home");
    assert.equal(await time(page), 0);
    await page.keyboard.press(" ");
    assert.equal(await page.getAttribute("#play", "aria-label"), "Pause");
    await page.keyboard.press(" ");
    assert.equal(await page.getAttribute("#play", "aria-label"), "Play");
    // Tab reaches a name of the table; its definition is shown, and Escape puts it away.
    const term = page.getByRole("button", { name: "peak shortening", exact: true });
    for (let presses = 0; presses < 40 && !(await term.evaluate((it) => it === document.activeElement)); presses++) {
      await page.keyboard.press("Tab");
    }
    const definition = page.locator(`#${await term.getAttribute("aria-describedby")}`);
    assert.ok(await definition.isVisible());
    assert.match((await definition.textContent()) ?? "", /resting length/);
    await page.keyboard.press("Escape");
    assert.ok(!(await definition.isVisible()));
  });
});

const PAGES = /** @type {const} */ (["run", "comparison", "fit", "fit that does not fit", "analysis"]);
/** @param {typeof PAGES[number]} kind */
const pathOf = (kind) => ({ run: report, comparison, fit: fitted, "fit that does not fit": unfitted, analysis: analysed })[kind];

for (const kind of PAGES) {
  for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
    for (const width of [1400, 390]) {
      if (leavesOut(colorScheme, width)) continue;
      test(`nobody is shut out of the page of a ${kind}: ${colorScheme}, ${width} px wide`, async () => {
        await opened(pathOf(kind), { ...STILL, colorScheme, viewport: { width, height: 800 } }, async (page) => {
          await openAll(page);
          assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
          const [paper, ink] = await page.evaluate(() => {
            const style = getComputedStyle(document.body);
            const light = (/** @type {string} */ colour) =>
              (colour.match(/\d+/g) ?? []).slice(0, 3).reduce((sum, channel) => sum + Number(channel) / 765, 0);
            return [light(style.backgroundColor), light(style.color)];
          });
          assert.ok(colorScheme === "dark" ? paper < 0.2 && ink > 0.7 : paper > 0.9 && ink < 0.3, `${paper} ${ink}`);
          assert.deepEqual(await violationsOn(page), []);
        });
      });
    }
  }

  test(`the page of a ${kind} prints on at most four A4 pages`, async () => {
    await opened(pathOf(kind), STILL, async (page) => {
      const pages = await printedPages(page);
      assert.ok(pages >= 1 && pages <= 4, `${pages} pages`);
    });
  });
}

/** Outlines of 60 um and more, um. */
const SHAPES = {
  round: Array.from({ length: 48 }, (_, step) => [0, 1].map((axis) => 30 * Math.cos((step * Math.PI) / 24 - (axis * Math.PI) / 2))),
  square: [[0, 0], [60, 0], [60, 60], [0, 60]],
  upright: [[0, 0], [20, 0], [20, 120], [0, 120]],
};

/** @param {string} path Cell and curves are seen whole, without scrolling. */
async function seenAtOnce(path) {
  await opened(path, { ...STILL, viewport: { width: 1400, height: 900 } }, async (page) => {
    const parts = await page.$$eval("#cells canvas, #controls, #charts .chart", (all) =>
      all.map((part) => part.getBoundingClientRect()).map(({ top, bottom, height }) => [top, bottom, height]),
    );
    assert.ok(parts.length >= 5);
    assert.ok(parts.every(([top, bottom, height]) => top >= 0 && bottom <= 900 && height > 30), JSON.stringify(parts));
    const cell = await page.locator("#cells canvas").boundingBox();
    assert.ok(cell !== null && cell.height >= 110, "a cell that can be seen");
  });
}

test("a long cell, a fit and their curves are seen on one screen", async () => {
  await seenAtOnce(report);
  await seenAtOnce(fitted);
  await seenAtOnce(unfitted);
});

test("what is to be looked at is read without scrolling in a box, and unfolds where it is long", async () => {
  for (const width of [1400, 390]) {
    await opened(unfitted, { ...STILL, viewport: { width, height: 900 } }, async (page) => {
      const within = await page.$$eval("#warnings, #warnings *", (all) =>
        all.filter((it) => it.scrollHeight > it.clientHeight + 1 && getComputedStyle(it).overflowY !== "visible").length,
      );
      assert.equal(within, 0);
      assert.ok(await page.locator("#warning-list li").first().isVisible());
      const box = await page.locator("#warnings").boundingBox();
      assert.ok(box !== null && box.height < 900 / 3, `${box?.height}`);
      await openAll(page);
      assert.match((await page.textContent("#warnings")) ?? "", /do not use these numbers/);
      assert.ok(await page.getByText("do not use these numbers").isVisible());
    });
  }
});

test("stimuli that raised no action potential are marked apart, and the page says how", async () => {
  const path = await beat("missed", "--integrator", "quasi-static", "--spacing", "4 um", "--beats", "4", "--cycle-length", "300 ms");
  const [first] = beatIn(await payloadOf(path)).charts;
  assert.deepEqual([first.stimuli_ms, first.missed_ms], [[50, 650], [350, 950]]);
  await opened(path, STILL, async (page) => {
    const [first, ...others] = await page.$$eval(".chart h3", (all) => all.map((title) => title.textContent ?? ""));
    assert.match(first, /\u25bc stimulus, \u25bd not captured/);
    assert.ok(others.every((title) => !title.includes("\u25bd")));
    // The middle of each triangle: filled for one that was captured, the colour of the page for the other.
    const filled = await page.evaluate((times) => {
      const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector(".chart canvas"));
      const over = /** @type {HTMLElement} */ (document.querySelector(".chart .u-over")).getBoundingClientRect();
      const box = canvas.getBoundingClientRect();
      const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
      const span = Number(/** @type {HTMLInputElement} */ (document.querySelector("#time")).max);
      const row = pen.getImageData(0, Math.round(over.top - box.top) - 5, canvas.width, 1).data;
      return times.map((time) => {
        const x = Math.round(over.left - box.left + (time / span) * over.width) - 1;
        const [red, , , alpha] = row.slice(4 * x, 4 * x + 4);
        return alpha > 0 && red < 200;
      });
    }, [50, 350, 650, 950]);
    assert.deepEqual(filled, [true, false, true, false]);
  });
});

test("of a cell model with many curves the first leads, and the others unfold", async () => {
  const path = await beat("currents", "--model", "tor_ord_land", "--integrator", "quasi-static", "--spacing", "6 um");
  await seenAtOnce(path);
  await opened(path, STILL, async (page) => {
    const shown = await page.$$eval("#charts .chart h3", (all) => all.map((title) => title.textContent ?? ""));
    assert.equal(shown.length, 4, shown.join());
    assert.match(shown[3], /^Ca_i/);
    assert.ok(!(await page.locator("#more-charts .chart").first().isVisible()));
    assert.match((await page.textContent("#more-curves-title")) ?? "", /^\d+ more curves of the cell model$/);
    await page.click("#more-curves-title");
    assert.ok(await page.locator("#more-charts .chart").last().isVisible());
    const pages = await printedPages(page);
    assert.ok(pages <= 4, `${pages} pages`);
  });
});

for (const [name, points] of Object.entries(SHAPES)) {
  test(`a cell and its curves are seen on one screen: ${name}`, async () => {
    const outline = join(folder, `${name}.csv`);
    await writeFile(outline, ["x_um,y_um", ...points.map((point) => point.join(","))].join("\n"));
    await seenAtOnce(await beat(name, outline, "--integrator", "quasi-static", "--spacing", "4 um"));
  });
}

test("what a run is told to look at leaves cell and curves one screen", async () => {
  const path = await beat("strained", "--integrator", "quasi-static", "--spacing", "4 um", "--peak-tension", "150 kPa");
  await opened(path, STILL, async (page) => assert.ok(await page.isVisible("#warnings")));
  await seenAtOnce(path);
});

test("a number is said to be in or out of what is measured, and the model's part in it, calmly", async () => {
  await opened(report, STILL, async (page) => {
    const tile = (/** @type {string} */ name) => page.locator(".tiles > div", { hasText: name }).textContent();
    assert.match((await tile("peak shortening")) ?? "", /12\.01.*in 7 to 12/);
    assert.match((await tile("maximum shortening rate")) ?? "", /2\.00.*out, above 0\.5 to 1\.2/);
    const row = page.locator("#metrics tr", { hasText: "shortening rate over peak" });
    assert.match((await row.textContent()) ?? "", /out, above/);
    assert.ok(!(await page.isVisible("#warnings")));
    assert.match((await page.textContent("#about")) ?? "", /^The paper's tension curve .* --model land_2017 does not\.$/);
  });
});

test("the page of a fit has its numbers, its curves and the beating cell", async () => {
  await opened(fitted, STILL, async (page) => {
    assert.match((await page.textContent("h1")) ?? "", /^Fit of /);
    const charts = await page.$$eval(".chart h3", (all) => all.map((title) => title.textContent));
    assert.match(charts[0] ?? "", /^Length \(\u00b5m\).*dots: measured, line: fitted/);
    assert.match(charts[1] ?? "", /measured \u2212 fitted/);
    assert.equal(await page.locator(".profile").count(), await page.locator(".tiles > div").count());
    const term = page.locator(".tiles .term").first();
    await term.focus();
    assert.ok(await page.locator(`#${await term.getAttribute("aria-describedby")}`).isVisible());
    const resting = await pixels(page);
    await page.fill("#time", "170");
    assert.notEqual(await pixels(page), resting);
    // The fitted cell shortens as the measured one.
    const row = page.locator("#metrics tr", { hasText: "peak shortening" }).first();
    assert.match((await row.textContent()) ?? "", /1[12]\.\d/);
  });
});

test("measured curves are drawn with what was read of them, enlarged, sorted and filtered", async () => {
  await opened(analysed, STILL, async (page) => {
    assert.match((await page.textContent("#answer")) ?? "", /^\d+ of 20 beats count in 2 of 2 curves\.$/);
    const titles = await page.$$eval("#curves h3", (all) => all.map((title) => title.textContent ?? ""));
    assert.equal(titles.length, 4, "of each curve the recording and one beat");
    assert.match(titles[0], /^length.*\(\u00b5m\).*dots: onset and peak.*shaded: artefacts, left out/);
    assert.match(titles[1], /^Beat \d+ .*where its metrics were read/);
    assert.match((await page.textContent("#curves .axis")) ?? "", /Time \(s\)/);
    // A drag over a part of a curve enlarges it, a double click shows all.
    const plot = page.locator("#curves .chart").first();
    const seen = () => plot.locator("canvas").evaluate((canvas) => /** @type {HTMLCanvasElement} */ (canvas).toDataURL());
    const whole = await seen();
    // The mouse reaches only what is on the screen.
    await plot.scrollIntoViewIfNeeded();
    const box = await plot.locator(".u-over").boundingBox();
    assert.ok(box !== null);
    await page.mouse.move(box.x + 0.3 * box.width, box.y + 20);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.4 * box.width, box.y + 20, { steps: 3 });
    await page.mouse.up();
    await page.waitForTimeout(100);
    assert.notEqual(await seen(), whole);
    await plot.locator(".u-over").dblclick({ position: { x: 30, y: 20 } });
    await page.waitForTimeout(100);
    assert.equal(await seen(), whole);
    // The beats of the first curve, the disturbed ones marked; sorted by their number, and filtered.
    await page.locator("#beats summary").first().click();
    const table = page.locator("#beats table").first();
    const rows = () => table.locator("tbody tr:visible th").allTextContents();
    assert.ok((await table.locator("tr.marked").count()) >= 1);
    assert.deepEqual((await rows()).slice(0, 2), ["1", "2"]);
    await table.locator("button.sort").first().click();
    await table.locator("button.sort").first().click();
    assert.deepEqual([(await rows())[0], await table.locator("th").first().getAttribute("aria-sort")], ["10", "descending"]);
    await page.locator("#beats input").first().fill("artefact");
    assert.ok((await rows()).length < 5);
  });
});

test("a comparison leads with curves; what was set comes last", async () => {
  await opened(comparison, STILL, async (page) => {
    const order = await page.evaluate(() =>
      ["charts", "cells", "key", "metrics", "differences", "parameters", "repeat"].map(
        (id) => document.getElementById(id)?.getBoundingClientRect().top ?? NaN,
      ),
    );
    assert.ok(order.every((top, index) => index === 0 || top > order[index - 1]), order.join());
  });
});

test("what a page was given stays text", async () => {
  const name = join(folder, "<script>.toml");
  await writeFile(name, `title = ${JSON.stringify(NASTY)}\n[numerics]\nintegrator = "quasi-static"\n`);
  await opened(await beat("<b>nasty", name), STILL, async (page) => {
    assert.match(await page.title(), /^<\/script><script>alert\(1\)/);
    assert.equal(await page.textContent("h1"), NASTY);
    assert.equal(await page.locator("h1 script").count(), 0);
    assert.match((await page.textContent("#facts")) ?? "", /<script>/);
  });
});

/**
 * A picture of 360 x 160 pixels with striped ellipses, PNG.
 *
 * @param {[number, number][]} middles
 */
async function drawn(middles) {
  const blank = await browser.newPage();
  const data = await blank.evaluate((all) => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [360, 160];
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    pen.fillStyle = "#101010";
    pen.fillRect(0, 0, 360, 160);
    for (const [x, y] of all) {
      pen.save();
      pen.beginPath();
      pen.ellipse(x, y, 130, 30, 0, 0, 7);
      pen.clip();
      for (let stripe = 0; stripe < 360; stripe += 2) {
        pen.fillStyle = stripe % 4 === 0 ? "#e0e0e0" : "#909090";
        pen.fillRect(stripe, 0, 2, 160);
      }
      pen.restore();
    }
    return canvas.toDataURL("image/png").split(",")[1];
  }, middles);
  await blank.close();
  return Buffer.from(data, "base64");
}

test("a batch shows every cell, small, with its outline, and lists its numbers; nobody is shut out", async () => {
  const dish = join(folder, "dish");
  await mkdir(dish);
  // The second cell of the second picture is cut by the frame.
  await writeFile(join(dish, "a.png"), await drawn([[180, 80]]));
  await writeFile(join(dish, "b.png"), await drawn([[180, 45], [180, 140]]));
  const path = await batch("cells", dish, "--pixel-size", "0.5 um", "--integrator", "quasi-static", "--spacing", "4 um");
  for (const [colorScheme, width] of /** @type {const} */ ([["light", 1400], ["dark", 390]])) {
    await opened(path, { ...STILL, colorScheme, viewport: { width, height: 800 } }, async (page) => {
      assert.match((await page.textContent("#answer")) ?? "", /^2 cells of 2 pictures beat, 1 left out/);
      const small = await page.$$eval(".gallery img", async (all) => {
        const pictures = /** @type {HTMLImageElement[]} */ (all);
        // They may not be read yet.
        await Promise.all(pictures.map((it) => it.decode()));
        return pictures.map((it) => it.naturalWidth);
      });
      assert.ok(small.length === 3 && small.every((size) => size > 50 && size <= 161), small.join());
      assert.equal(await page.locator(".gallery .mark.out").count(), 1);
      assert.equal(await page.locator("tbody tr").count(), 3);
      assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
      assert.deepEqual(await violationsOn(page), []);
    });
  }
});

test("a cell from a picture beats on its picture", async () => {
  const picture = join(folder, "cell.png");
  await writeFile(picture, await drawn([[180, 80]]));
  const path = await beat("picture", picture, "--pixel-size", "0.5 um", "--integrator", "quasi-static");
  await opened(path, STILL, async (page) => {
    await page.waitForSelector("#picture-choice:not([hidden])");
    const together = await pixels(page);
    await page.fill("#opacity", "0");
    const bare = await pixels(page);
    await page.uncheck("#picture");
    const alone = await pixels(page);
    assert.equal(new Set([together, bare, alone]).size, 3);
  });
});

test("many runs are told apart, and a page says in what they differ and by how much", async () => {
  const factors = [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9].flatMap((factor) => ["--scale", `peak_tension=${factor}`]);
  const path = await compare("compared", "--integrator", "quasi-static", "--spacing", "4 um", ...factors);
  for (const width of [1200, 390]) {
    await opened(path, { ...STILL, viewport: { width, height: 900 } }, async (page) => {
      assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
      assert.equal(await page.textContent("h1"), "control and 7 others");
      const lines = await page.$$eval("#legend path", (paths) =>
        paths.map((path) => path.style.stroke + path.getAttribute("stroke-dasharray")),
      );
      assert.equal(new Set(lines).size, 8, lines.join());
      assert.match((await page.textContent("#differences")) ?? "", /cell\.peak_tension50 kPa15 kPa20 kPa/);
      const row = page.locator("#metrics tr", { hasText: "peak shortening" }).first();
      assert.match((await row.textContent()) ?? "", /12\.01.*\u2212\d\.\d\d \(\u2212\d\d\.\d\d %\)/);
      assert.deepEqual(await violationsOn(page), []);
      const pages = await printedPages(page);
      assert.ok(pages <= 4, `${pages} pages`);
      // On paper no column is cut off.
      await page.emulateMedia({ media: "print" });
      await page.setViewportSize({ width: 700, height: 900 });
      const cut = await page.$$eval(".wide", (tables) => tables.filter((it) => it.scrollWidth > it.clientWidth + 1).length);
      assert.equal(cut, 0);
    });
  }
});

test("a run is copied and cited from the page", async () => {
  await opened(report, { ...STILL, permissions: ["clipboard-read", "clipboard-write"] }, async (page) => {
    await page.click("text=Copy run file");
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    assert.equal(copied, await readFile(join(report, "../run.toml"), "utf8"));
    assert.match((await page.textContent("#cite pre")) ?? "", /@software\{myospring/);
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("text=Save run.toml")]);
    assert.equal(download.suggestedFilename(), "run.toml");
  });
});

test("it prints the cell at rest and at its peak, with all tables", async () => {
  await opened(report, STILL, async (page) => {
    await page.emulateMedia({ media: "print" });
    assert.ok(await page.isVisible("#stills canvas"));
    assert.ok(!(await page.isVisible("#play")));
    assert.ok(await page.locator(".definition").first().isVisible());
  });
});
