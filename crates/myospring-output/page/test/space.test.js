// A thick cell on a page: it turns, it can be used by all, and pages of flat cells know nothing of it.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { Camera, VIEWPOINTS } from "../src/camera.js";
import { blankSolid, recordedSolid } from "../src/data.js";
import { violationsOn } from "./axe.js";
import { BLOCK, sizeAt, withBlock } from "./block.js";
import { leavesOut } from "./looks.js";
import { beat, beatIn, compare, folder, payloadOf } from "./program.js";

/** @import { Browser, BrowserContextOptions, Page } from "playwright-core" */

/** @type {Browser} */
let browser;
/** @type {string} A flat cell. */
let flat;
/** @type {string} The same as a thick one. */
let thick;
/** @type {string} Two thick ones. */
let two;

before(async () => {
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox"] });
  const quick = ["--integrator", "quasi-static", "--spacing", "4 um"];
  flat = await beat("flat", ...quick);
  thick = await withBlock(flat, join(folder, "thick.html"));
  two = await withBlock(await compare("both", ...quick, "--scale", "peak_tension=0.5"), join(folder, "two.html"));
});
after(() => browser?.close());

/**
 * Opens a page and does something with it; whatever it complains about is an error.
 *
 * @param {string} path
 * @param {BrowserContextOptions} options
 * @param {(page: Page) => Promise<void>} work
 */
async function opened(path, options, work) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 900 }, reducedMotion: "reduce", ...options });
  /** @type {string[]} */
  const complaints = [];
  try {
    const page = await context.newPage();
    page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
    page.on("pageerror", (error) => complaints.push(`error: ${error.stack}`));
    await page.goto(pathToFileURL(path).href);
    await page.waitForSelector("#field option", { state: "attached" });
    await work(page);
    assert.deepEqual(complaints, []);
  } finally {
    await context.close();
  }
}

/** What the first thick cell looks like. @param {Page} page */
const seen = (page) => page.evaluate(() => /** @type {HTMLCanvasElement} */ (document.querySelector("canvas.turns")).toDataURL());
/** @param {Page} page */
const label = async (page) => (await page.getAttribute("canvas.turns", "aria-label")) ?? "";

test("a camera sees along axes at right angles, whatever it was told", () => {
  const camera = new Camera("space");
  for (let turn = 0; turn < 50; turn++) {
    camera.turn(0.7 * turn, 0.3 * Math.sin(turn), 1 + Math.sin(turn) / 3);
    const axes = camera.axes();
    axes.forEach((a, i) =>
      axes.forEach((b, j) => {
        const dot = a.reduce((sum, part, axis) => sum + part * b[axis], 0);
        assert.ok(Math.abs(dot - Number(i === j)) < 1e-12);
      }),
    );
    assert.ok(Math.abs(camera.tilted) <= Math.PI / 2 && camera.zoom > 0.1 && camera.zoom < 10);
  }
  for (const viewpoint in VIEWPOINTS) {
    camera.stand(viewpoint);
    assert.ok(camera.standsAt(viewpoint));
  }
});

test("frames lie on straight lines between those that are kept", async () => {
  const data = beatIn(await payloadOf(thick)).cells[0].thick;
  assert.ok(data !== null);
  const solid = recordedSolid(data);
  const shape = blankSolid(solid);
  for (const time of [...BLOCK.times, 250]) {
    solid.at(time, "fibre-strain", shape);
    const [before, behind] = [sizeAt(100 * Math.floor(time / 100)), sizeAt(100 * Math.ceil(time / 100))];
    for (const axis of [0, 1, 2]) {
      const places = shape.points.filter((_, index) => index % 3 === axis);
      const extent = Math.max(...places) - Math.min(...places);
      const expected = (before[axis] + behind[axis]) / 2;
      assert.ok(Math.abs(extent - expected) < 2e-3 && Math.abs(shape.size[axis] - expected) < 1e-9, `${time} ms, ${axis}: ${extent}`);
    }
  }
  assert.ok(Math.abs(shape.values[0] + 100 * (1 - (sizeAt(200)[0] + sizeAt(300)[0]) / 2 / 48)) < 0.05);
});

test("a section lies in its plane, between the lower and the upper side, and moves with the cell", async () => {
  const data = beatIn(await payloadOf(thick)).cells[0].thick;
  assert.ok(data !== null);
  const solid = recordedSolid(data);
  const shape = blankSolid(solid);
  solid.at(200, "fibre-strain", shape);
  const size = sizeAt(200);
  solid.sections.forEach(({ corners, depth }, section) => {
    const [within, normal] = section === 0 ? [0, 1] : [1, 0];
    /** @type {(axis: number) => number[]} */
    const places = (axis) => [...corners].map((point) => shape.points[3 * point + axis]);
    // The middle at rest moves with the block, which is stretched about its corner.
    places(normal).forEach((at) => assert.ok(Math.abs(at - size[normal] / 2) < 1e-3, `${section}: ${at}`));
    for (const axis of [within, 2]) {
      assert.ok(Math.abs(Math.max(...places(axis)) - Math.min(...places(axis)) - size[axis]) < 2e-3);
    }
    assert.ok([...corners].every((point) => shape.values[point] === shape.values[0]));
    assert.ok(Math.max(...depth) > 0 && Math.min(...depth) < 0);
  });
});

test("a cell that is cut shows the face of its section, and stays cut when it is turned", async () => {
  await opened(thick, {}, async (page) => {
    const whole = await seen(page);
    /** How much of the canvas is inked. */
    const inked = () =>
      page.evaluate(() => {
        const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector("canvas.turns"));
        const pen = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(canvas.width, canvas.height).getContext("2d"));
        pen.drawImage(canvas, 0, 0);
        return pen.getImageData(0, 0, canvas.width, canvas.height).data.filter((value, index) => index % 4 === 3 && value === 255).length;
      });
    for (const [cut, uncut] of [["along", "side"], ["across", "end"]]) {
      await page.selectOption("#view", uncut);
      const side = await inked();
      await page.selectOption("#view", cut);
      const face = await seen(page);
      // A block's section is as large as its side.
      assert.ok(Math.abs((await inked()) / side - 1) < 0.05);
      await page.locator("canvas.turns").press("ArrowLeft");
      assert.equal(await page.inputValue("#view"), cut);
      assert.notEqual(await seen(page), face);
      await page.click("#reset-view");
      assert.equal(await seen(page), face);
    }
    await page.locator("canvas.turns").press("Home");
    assert.equal(await page.inputValue("#view"), "space");
    assert.equal(await seen(page), whole);
  });
});

test("the page of a flat cell offers no view in space", async () => {
  await opened(flat, {}, async (page) => {
    assert.equal(await page.locator("canvas.turns").count(), 0);
    assert.ok(!(await page.isVisible("#view-choice")) && !(await page.isVisible("#turn-help")));
  });
});

test("a thick cell is seen in space, in step with the time, and its size is said", async () => {
  await opened(thick, {}, async (page) => {
    assert.ok(await page.isVisible("canvas.turns"));
    assert.match(await label(page), /48\.00.µm long, 16\.00.µm wide, 8\.00.µm thick/);
    const resting = await seen(page);
    await page.fill("#time", "200");
    assert.notEqual(await seen(page), resting);
    const [length, width, thickness] = sizeAt(200).map((size) => size.toFixed(2).replace(/(?<=\d{2}\.\d)0$/, "0"));
    assert.match(await label(page), new RegExp(`200 ms, ${length}.µm long, ${width}.µm wide, ${thickness}.µm thick`));
    assert.equal(Number(await page.getAttribute("#cells", "data-least")), -12);
    const before = await seen(page);
    await page.selectOption("#field", "volume-ratio");
    assert.match((await page.textContent("#meaning")) ?? "", /^Volume/);
    await page.selectOption("#view", "above");
    assert.ok(!(await page.isVisible("canvas.turns")) && (await page.isVisible("#cells canvas:not(.turns)")));
    assert.ok((await page.locator("#field option").count()) > 2);
    await page.selectOption("#view", "space");
    await page.selectOption("#field", "fibre-strain");
    assert.equal(await seen(page), before);
  });
});

test("it turns by mouse, wheel and keyboard, and back; the time stands still meanwhile", async () => {
  await opened(thick, {}, async (page) => {
    const first = await seen(page);
    const box = await page.locator("canvas.turns").boundingBox();
    assert.ok(box !== null);
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    // The wheel scrolls the page until the cell was clicked.
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, -100);
    assert.equal(await seen(page), first);
    await page.mouse.down();
    await page.mouse.move(x + 60, y + 20, { steps: 4 });
    await page.mouse.up();
    const dragged = await seen(page);
    assert.notEqual(dragged, first);
    await page.mouse.wheel(0, -100);
    await page.waitForTimeout(50);
    assert.notEqual(await seen(page), dragged);
    await page.click("#reset-view");
    assert.equal(await seen(page), first);
    await page.focus("canvas.turns");
    const all = new Set([first]);
    for (const key of ["ArrowLeft", "ArrowUp", "+", "ArrowRight", "ArrowDown", "-"]) {
      await page.keyboard.press(key);
      all.add(await seen(page));
    }
    assert.ok(all.size >= 6, `${all.size}`);
    await page.keyboard.press("Home");
    assert.equal(await seen(page), first);
    assert.equal(await page.inputValue("#time"), "0");
    await page.selectOption("#view", "side");
    const side = await seen(page);
    assert.ok(!all.has(side));
    await page.locator("canvas.turns").press("ArrowLeft");
    assert.equal(await page.inputValue("#view"), "space");
  });
});

test("it stays whole in its canvas from every side", async () => {
  await opened(thick, {}, async (page) => {
    await page.focus("canvas.turns");
    for (let turn = 0; turn < 12; turn++) {
      for (let press = 0; press < 1 + (turn % 3); press++) await page.keyboard.press(turn % 2 === 0 ? "ArrowLeft" : "ArrowDown");
      const rim = await page.evaluate(() => {
        const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector("canvas.turns"));
        const { width, height } = canvas;
        const pen = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true }));
        pen.drawImage(canvas, 0, 0);
        const inked = (/** @type {ImageData} */ { data }) => data.some((value, index) => index % 4 === 3 && value > 0);
        return [[0, 0, width, 2], [0, 0, 2, height], [width - 2, 0, 2, height]].map(([x, y, w, h]) => inked(pen.getImageData(x, y, w, h)));
      });
      assert.deepEqual(rim, [false, false, false], `turn ${turn}`);
    }
  });
});

for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
  for (const width of [1400, 390]) {
    if (leavesOut(colorScheme, width)) continue;
    test(`nobody is shut out of thick cells: ${colorScheme}, ${width} px wide`, async () => {
      for (const path of [thick, two]) {
        await opened(path, { colorScheme, viewport: { width, height: 800 } }, async (page) => {
          assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
          assert.deepEqual(await violationsOn(page), []);
        });
      }
    });
  }
}

test("thick cells that are compared turn together", async () => {
  await opened(two, {}, async (page) => {
    assert.equal(await page.locator("canvas.turns").count(), 2);
    const both = () => page.$$eval("canvas.turns", (all) => all.map((canvas) => /** @type {HTMLCanvasElement} */ (canvas).toDataURL()));
    const before = await both();
    await page.locator("canvas.turns").first().press("ArrowLeft");
    const after = await both();
    assert.ok(after.every((picture, index) => picture !== before[index]));
  });
});

test("paper shows a thick cell as the screen does, and as many pictures as of a flat one", async () => {
  for (const path of [thick, two]) {
    await opened(path, {}, async (page) => {
      const stills = () => page.locator("#stills figure").count();
      const inSpace = await stills();
      await page.selectOption("#view", "above");
      await page.pdf();
      assert.equal(await stills(), inSpace);
    });
  }
});

test("two fingers enlarge it", async () => {
  await opened(thick, { hasTouch: true }, async (page) => {
    const first = await seen(page);
    await page.evaluate(() => {
      const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector("canvas.turns"));
      // Made-up pointers cannot be captured.
      canvas.setPointerCapture = () => {};
      const send = (/** @type {string} */ type, /** @type {number} */ pointerId, /** @type {number} */ clientX) =>
        canvas.dispatchEvent(new PointerEvent(type, { pointerId, clientX, clientY: 200, pointerType: "touch", bubbles: true }));
      send("pointerdown", 1, 300);
      send("pointerdown", 2, 400);
      send("pointermove", 2, 450);
      send("pointermove", 1, 250);
      send("pointerup", 1, 250);
      send("pointerup", 2, 450);
    });
    assert.notEqual(await seen(page), first);
    await page.click("#reset-view");
    assert.equal(await seen(page), first);
  });
});
