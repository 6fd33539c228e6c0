// Files that are dropped on the page, in Chromium: curves, films, pictures, displacements and beads.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";
import { violationsOn } from "./axe.js";
import { arrays, beadFilm, outline } from "./gel.js";
import { COLUMNS, lightFilm, ROWS } from "./light.js";
import { ended, opened, ran, result, runsOf, shot, slide, tile } from "./opened.js";
import { folder, myospring } from "./program.js";

/** @import { Page } from "playwright-core" */

const EXAMPLES = join(import.meta.dirname, "../../../../examples");

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

/** A film of a cell that beats once. */
const [WIDTH, HEIGHT, FRAMES] = [200, 80, 12];

/** Grey values of a frame. @param {number} frame */
function beating(frame) {
  const stretch = 1 - 0.08 * Math.sin((Math.PI * frame) / (FRAMES - 1)) ** 2;
  return Array.from({ length: WIDTH * HEIGHT }, (_, at) => {
    const [x, y] = [((at % WIDTH) - WIDTH / 2) / stretch, Math.floor(at / WIDTH) - HEIGHT / 2];
    const spots = Math.sin(0.9 * x + 0.2 * y) + 0.6 * Math.sin(0.31 * x - 0.7 * y) + 0.5 * Math.sin(0.17 * x + 0.43 * y);
    return Math.round(Math.hypot(x / 75, y / 20) < 1 ? 150 + 30 * spots : 20);
  });
}

/** Frames as WebM (VP8, a key frame each, 20 a second), by the browser's own encoder. @param {Page} page @param {number[][]} frames */
async function webm(page, frames) {
  const bytes = await page.evaluate(async ({ width, height, frames }) => {
    /** @type {Uint8Array[]} */
    const coded = [];
    const encoder = new VideoEncoder({
      output: (chunk) => {
        const data = new Uint8Array(chunk.byteLength);
        chunk.copyTo(data);
        coded.push(data);
      },
      error: (error) => {
        throw error;
      },
    });
    encoder.configure({ codec: "vp8", width, height, bitrate: 4e6, framerate: 20 });
    for (const [at, grey] of frames.entries()) {
      const data = Uint8Array.from(grey.flatMap((value) => [value, value, value, 255]));
      const frame = new VideoFrame(data, { format: "RGBX", codedWidth: width, codedHeight: height, timestamp: 50_000 * at });
      encoder.encode(frame, { keyFrame: true });
      frame.close();
    }
    await encoder.flush();
    const hex = (/** @type {string} */ id) => (id.match(/../g) ?? []).map((pair) => Number.parseInt(pair, 16));
    const whole = (/** @type {number} */ value, bytes = 4) => Array.from({ length: bytes }, (_, at) => Math.floor(value / 256 ** (bytes - 1 - at)) % 256);
    const text = (/** @type {string} */ value) => Array.from(value, (letter) => letter.charCodeAt(0));
    const element = (/** @type {string} */ id, /** @type {number[]} */ ...data) => [...hex(id), 1, ...whole(data.length, 7), ...data];
    const duration = [...new Uint8Array(new Float64Array([50 * frames.length]).buffer)].reverse();
    const head = element("1a45dfa3", ...element("4286", 1), ...element("42f7", 1), ...element("42f2", 4), ...element("42f3", 8), ...element("4282", ...text("webm")), ...element("4287", 4), ...element("4285", 2));
    const info = element("1549a966", ...element("2ad7b1", ...whole(1_000_000)), ...element("4489", ...duration));
    const size = element("e0", ...element("b0", ...whole(width, 2)), ...element("ba", ...whole(height, 2)));
    const track = element("1654ae6b", ...element("ae", ...element("d7", 1), ...element("73c5", 1), ...element("83", 1), ...element("86", ...text("V_VP8")), ...size));
    const body = [...info, ...track];
    /** @type {number[]} */
    const cues = [];
    for (const [at, data] of coded.entries()) {
      cues.push(...element("bb", ...element("b3", ...whole(50 * at)), ...element("b7", ...element("f7", 1), ...element("f1", ...whole(body.length)))));
      body.push(...element("1f43b675", ...element("e7", ...whole(50 * at)), ...element("a3", 0x81, 0, 0, 0x80, ...data)));
    }
    return [...head, ...element("18538067", ...body, ...element("1c53bb6b", ...cues))];
  }, { width: WIDTH, height: HEIGHT, frames });
  return Buffer.from(bytes);
}

test("a film is followed, and says how far it is", async () => {
  const film = [Buffer.from(`YUV4MPEG2 W${WIDTH} H${HEIGHT} F20:1 Cmono\n`)];
  for (let frame = 0; frame < FRAMES; frame++) film.push(Buffer.from("FRAME\n"), Buffer.from(beating(frame)));
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
    assert.equal(rows.length, FRAMES + 1);
    await shot(page, "film");
  });
});

/** Fills a field of the file that is read, in. @param {Page} page @param {string} name @param {string} value */
async function fillIn(page, name, value) {
  const field = page.locator("#measured").getByLabel(name);
  await field.fill(value);
  await field.press("Tab");
}

test("two arrays of displacements are dropped and give the force of the cell, in a region, too", async () => {
  const [u, v] = arrays(40, 60);
  await writeFile(join(folder, "region.geojson"), outline([15, 10], [9, 6]));
  await opened({}, async (page) => {
    const dropped = await page.evaluateHandle((files) => {
      const transfer = new DataTransfer();
      for (const [name, base64] of files) transfer.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
      return transfer;
    }, [["gel_v.npy", v.toString("base64")], ["gel_u.npy", u.toString("base64")]]);
    await page.dispatchEvent("body", "drop", { dataTransfer: dropped });
    assert.match((await ended(page)) ?? "", /\u201csize of a pixel\u201d/);
    assert.equal(await page.locator("#measured-title").textContent(), "gel_u.npy, gel_v.npy");
    await fillIn(page, "Size of a pixel, \u00b5m", "0.5");
    await page.locator("#failure", { hasText: "\u201cmodulus of the gel\u201d" }).waitFor();
    const first = await runsOf(page);
    await fillIn(page, "Modulus of the gel, kPa", "5");
    await ran(page, first + 1);
    assert.equal(await ended(page), null);
    const force = async () => JSON.parse(await result(page, "summary.json")).largest_force.axial_force_nN;
    const whole = await force();
    assert.ok(whole > 5, `${whole}`);
    assert.ok(Math.abs(Number.parseFloat((await tile(page, "axial force")) ?? "") - whole) < 0.06);
    assert.equal(await page.locator("#map img").isVisible(), true);
    assert.match((await page.locator("#warnings").textContent()) ?? "", /false tractions/);
    assert.equal(await page.getByRole("button", { name: "Fit the cell" }).isVisible(), false);
    await page.locator("#measured").getByLabel("Where the cell is").setInputFiles(join(folder, "region.geojson"));
    await ran(page, first + 2);
    assert.equal(await ended(page), null);
    assert.notEqual(await force(), whole);
    assert.match((await page.locator("body").textContent()) ?? "", /in a region/);
    assert.deepEqual(await violationsOn(page), []);
    await shot(page, "traction");
  });
});

test("a film of beads in a gel gives the force of the cell, relative to rest or to a picture of the relaxed gel", async () => {
  await writeFile(join(folder, "gel.y4m"), beadFilm([0, 0, 1, 3, 1, 0]));
  await writeFile(join(folder, "relaxed.y4m"), beadFilm([0]));
  await opened({}, async (page) => {
    await page.locator("#file").setInputFiles(join(folder, "gel.y4m"));
    assert.notEqual(await ended(page), null);
    await page.locator("#measured").getByLabel("It shows").selectOption("beads in a gel");
    await fillIn(page, "Size of a pixel, \u00b5m", "0.3");
    const first = await runsOf(page);
    await fillIn(page, "Modulus of the gel, kPa", "5");
    await ran(page, first + 1);
    assert.equal(await ended(page), null);
    assert.match((await page.locator("#found").textContent()) ?? "", /frame \d of the film, at rest/);
    await page.locator("#measured").getByLabel("Picture of the relaxed gel").setInputFiles(join(folder, "relaxed.y4m"));
    await ran(page, first + 2);
    assert.match((await page.locator("#found").textContent()) ?? "", /relaxed\.y4m/);
    assert.equal((await result(page, "traction.csv")).trim().split("\n").length, 7);
    assert.ok(Number.parseFloat((await tile(page, "axial force")) ?? "") > 10);
    await shot(page, "beads");
  });
});

test("a film of a tissue on two posts gives its force, found or where they are said to be", async () => {
  await opened({}, async (page) => {
    await page.locator("#file").setInputFiles(join(EXAMPLES, "tutorial/strip.tif"));
    await ended(page);
    const first = await runsOf(page);
    await page.locator("#measured").getByLabel("It shows").selectOption("two posts");
    await ran(page, first + 1);
    assert.equal(await ended(page), null);
    assert.equal(await page.locator("#posts img").isVisible(), true);
    assert.equal(await page.getByRole("button", { name: "Fit the cell" }).isVisible(), false);
    await fillIn(page, "Stiffness of a post, \u00b5N/\u00b5m", "1.09");
    await ran(page, first + 2);
    assert.equal(await ended(page), null);
    const found = JSON.parse(await result(page, "posts.json"));
    assert.ok(Math.abs(found.largest_approach_um - 657.9) < 0.5, `${found.largest_approach_um}`);
    const { middle_px: one } = found.posts[0];
    const { middle_px: other } = found.posts[1];
    await fillIn(page, "Column, row and diameter of each post, pixels", `${one.join(",")},25 ${other.join(",")},25`);
    await ran(page, first + 3);
    assert.equal(await ended(page), null);
    await fillIn(page, "Column, row and diameter of each post, pixels", "here and there");
    await page.locator("#failure", { hasText: "\u201ccolumn, row and diameter of each post\u201d" }).waitFor();
    await shot(page, "posts");
  });
});

/** A block of 60 x 16 um in 8 of 12 slices, as ImageJ writes a stack. */
function blockInDepth() {
  const [columns, rows, slices] = [140, 52, 12];
  const words = Buffer.from(`ImageJ=1.54f\nimages=${slices}\nslices=${slices}\nunit=micron\nspacing=1\n\0`);
  const pixels = Buffer.alloc(columns * rows * slices);
  pixels.forEach((_, at) => {
    const [column, row, slice] = [at % columns, Math.floor(at / columns) % rows, Math.floor(at / columns / rows)];
    pixels[at] = column >= 10 && column < 130 && row >= 10 && row < 42 && slice >= 2 && slice < 10 ? 255 : 0;
  });
  const directory = 2 + 9 * 12 + 4;
  const [first, text] = [8 + slices * directory, 8 + slices * directory + pixels.length];
  const bytes = Buffer.alloc(8 + slices * directory);
  bytes.write("II*\0", 0, "latin1");
  bytes.writeUInt32LE(8, 4);
  for (let slice = 0; slice < slices; slice++) {
    const at = 8 + slice * directory;
    /** Tag, type, count, value. */
    const entries = [
      [256, 4, 1, columns],
      [257, 4, 1, rows],
      [258, 3, 1, 8],
      [259, 3, 1, 1],
      [262, 3, 1, 1],
      [270, 2, words.length, text],
      [273, 4, 1, first + slice * columns * rows],
      [278, 4, 1, rows],
      [279, 4, 1, columns * rows],
    ];
    bytes.writeUInt16LE(entries.length, at);
    entries.forEach(([tag, type, count, value], index) => {
      const entry = at + 2 + 12 * index;
      bytes.writeUInt16LE(tag, entry);
      bytes.writeUInt16LE(type, entry + 2);
      bytes.writeUInt32LE(count, entry + 4);
      bytes.writeUInt32LE(value, entry + 8);
    });
    bytes.writeUInt32LE(slice + 1 < slices ? at + directory : 0, at + directory - 4);
  }
  return Buffer.concat([bytes, pixels, words]);
}

test("slices in depth are a thick cell, and what the file does not say may be stated", async () => {
  await writeFile(join(folder, "depth.tif"), blockInDepth());
  await opened({}, async (page) => {
    const begun = await runsOf(page);
    await page.locator("#form").getByLabel("section").selectOption("dome");
    await ran(page, begun + 1);
    await page.locator("#file").setInputFiles(join(folder, "depth.tif"));
    await page.locator("#failure", { hasText: "\u201csize of a pixel\u201d" }).waitFor();
    const first = await runsOf(page);
    await fillIn(page, "Size of a pixel, \u00b5m", "0.5");
    await ran(page, first + 1);
    assert.equal(await page.isVisible("#failure"), false);
    const thickness = async () => Number(/([\d.]+).µm thick/.exec((await page.getAttribute("canvas.turns", "aria-label")) ?? "")?.[1]);
    // To a cube.
    assert.ok(Math.abs((await thickness()) - 8) < 0.8);
    await fillIn(page, "Distance of two slices, \u00b5m", "1.5");
    await ran(page, first + 2);
    assert.ok(Math.abs((await thickness()) - 12) < 0.8);
    assert.deepEqual(await violationsOn(page), []);
    // A turn is of thick cells alone: the flat one that follows beats without it.
    await slide(page, "turn of the fibres", "PageUp");
    await ran(page, first + 3);
    const builtIn = page.getByRole("button", { name: "Built-in cell" });
    await builtIn.click();
    await ran(page, first + 4);
    assert.equal(await page.isVisible("#failure"), false);
    assert.equal(await page.isVisible("#measured"), false);
    assert.equal(await builtIn.isVisible(), false);
    // Slices that are not one cell in depth after all are no cell of the form any more.
    await page.locator("#file").setInputFiles(join(folder, "depth.tif"));
    await fillIn(page, "Size of a pixel, \u00b5m", "0.5");
    await ran(page, first + 5);
    assert.equal(await builtIn.isVisible(), true);
    await page.locator("#measured").getByLabel("It shows").selectOption("a cell");
    await builtIn.waitFor({ state: "hidden" });
  });
});

test("a film of a tissue's light gives a map of its wave and how fast it goes", async () => {
  await writeFile(join(folder, "light.y4m"), lightFilm());
  await opened({}, async (page) => {
    await page.locator("#file").setInputFiles(join(folder, "light.y4m"));
    await ended(page);
    await page.locator("#measured").getByLabel("It shows").selectOption("a tissue\u2019s light");
    await page.locator("#failure", { hasText: "\u201csize of a pixel\u201d" }).waitFor();
    const first = await runsOf(page);
    await fillIn(page, "Size of a pixel, \u00b5m", "100");
    await ran(page, first + 1);
    assert.equal(await ended(page), null);
    const velocity = Number.parseFloat((await tile(page, "conduction velocity")) ?? "");
    assert.ok(Math.abs(velocity - 5) < 0.25, `${velocity} cm/s`);
    assert.equal(await page.locator("#activation img").isVisible(), true);
    assert.equal((await result(page, "activation.csv")).trim().split("\n").length, 1 + COLUMNS * ROWS);
    assert.deepEqual(await violationsOn(page), []);
    await shot(page, "light");
  });
});

test("a picture of beads asks for the gel, and for a picture of the relaxed gel", async () => {
  await opened({}, async (page) => {
    const first = await runsOf(page);
    await page.getByLabel("Or try a made-up picture").selectOption("one cell");
    await ran(page, first + 1);
    await page.getByRole("button", { name: "It shows beads in a gel" }).click();
    assert.match((await ended(page)) ?? "", /\u201cmodulus of the gel\u201d/);
    assert.equal(await page.locator("#measured").getByLabel("Size of a pixel, \u00b5m").inputValue(), "0.25");
    assert.equal(await page.locator("#shown-cells").isVisible(), false);
    await fillIn(page, "Modulus of the gel, kPa", "5");
    await page.locator("#failure", { hasText: "is one picture" }).waitFor();
    assert.match((await page.locator("#failure").textContent()) ?? "", /\u201cpicture of the relaxed gel\u201d/);
  });
});

test("a compressed film is decoded by the browser, frame by frame, and one that it cannot decode is explained", async () => {
  await opened({}, async (page) => {
    const frames = Array.from({ length: FRAMES }, (_, frame) => beating(frame));
    await writeFile(join(folder, "film.webm"), await webm(page, frames));
    await page.locator("#file").setInputFiles(join(folder, "film.webm"));
    await page.locator("#measured").waitFor();
    const size = page.locator("#measured").getByLabel("Size of a pixel, \u00b5m");
    await size.fill("0.6");
    await size.press("Tab");
    await page.locator("#results").getByRole("button", { name: "track.csv" }).waitFor({ timeout: 120_000 });
    const [head, ...rows] = (await result(page, "track.csv")).trim().split("\n").map((row) => row.split(","));
    assert.equal(rows.length, FRAMES);
    const column = (/** @type {string} */ name) => rows.map((row) => Number(row[head.indexOf(name)]));
    const [times, lengths] = [column("t_ms"), column("stretch_1")];
    times.forEach((time, at) => assert.ok(Math.abs(time - 50 * at) < 0.5, `${times}`));
    assert.ok(Math.abs(Math.min(...lengths) - 0.92) < 0.01, `${lengths}`);
    await writeFile(join(folder, "broken.mp4"), "no film");
    await page.locator("#file").setInputFiles(join(folder, "broken.mp4"));
    await page.waitForFunction(() => /cannot decode broken\.mp4.*ffmpeg/.test(document.getElementById("failure")?.textContent ?? ""));
  });
});

test("of a JPEG it is said that its edges are less sure", async () => {
  await opened({}, async (page) => {
    const jpeg = await page.evaluate(async ({ width, height, grey }) => {
      const canvas = new OffscreenCanvas(width, height);
      canvas.getContext("2d")?.putImageData(new ImageData(Uint8ClampedArray.from(grey.flatMap((value) => [value, value, value, 255])), width, height), 0, 0);
      return [...new Uint8Array(await (await canvas.convertToBlob({ type: "image/jpeg", quality: 0.95 })).arrayBuffer())];
    }, { width: WIDTH, height: HEIGHT, grey: beating(0) });
    await writeFile(join(folder, "cell.jpg"), Buffer.from(jpeg));
    await page.locator("#file").setInputFiles(join(folder, "cell.jpg"));
    await page.waitForFunction(() => document.getElementById("failure")?.hidden === false);
    const before = await runsOf(page);
    await page.locator("#pixel-size").fill("0.6");
    await page.locator("#pixel-size").press("Tab");
    await ran(page, before + 1);
    assert.match((await page.locator("#shown-cells-words").textContent()) ?? "", /One cell was found.*JPEG.*less sure/);
  });
});

test("a picture without a pixel size is shown, and a line over its scale bar gives it", async () => {
  await opened({}, async (page) => {
    const bar = await page.evaluate(async () => {
      const canvas = new OffscreenCanvas(400, 200);
      const context = canvas.getContext("2d");
      if (context === null) return [];
      context.fillStyle = "#202020";
      context.fillRect(0, 0, 400, 200);
      context.fillStyle = "#c0c0c0";
      context.ellipse(200, 80, 150, 40, 0.1, 0, 7);
      context.fill();
      context.fillStyle = "#ffffff";
      context.fillRect(280, 180, 100, 6);
      return [...new Uint8Array(await (await canvas.convertToBlob({ type: "image/png" })).arrayBuffer())];
    });
    await writeFile(join(folder, "bar.png"), Buffer.from(bar));
    await page.locator("#file").setInputFiles(join(folder, "bar.png"));
    await page.locator("#shown-cells-place svg").waitFor();
    assert.match((await page.locator("#shown-cells-words").textContent()) ?? "", /size of a pixel/);
    await page.getByLabel("measure a scale bar").check();
    const place = await page.locator("#shown-cells-place svg").boundingBox();
    if (place === null) throw new Error("no picture is shown");
    const at = (/** @type {number} */ x) => /** @type {[number, number]} */ ([place.x + (x * place.width) / 400, place.y + (183 * place.width) / 400]);
    await page.mouse.move(...at(280));
    await page.mouse.down();
    await page.mouse.move(...at(380), { steps: 3 });
    await page.mouse.up();
    const before = await runsOf(page);
    await page.locator("#bar-length").fill("30");
    await page.locator("#bar-length").press("Enter");
    await ran(page, before + 1);
    assert.ok(Math.abs(Number(await page.locator("#pixel-size").inputValue()) - 0.3) < 0.01);
    assert.match((await page.locator("#shown-cells-words").textContent()) ?? "", /One cell was found/);
  });
});
