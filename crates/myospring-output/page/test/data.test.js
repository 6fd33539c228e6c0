// What the page makes of its data, without a browser.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";
import { ramp, STEPS, stepOf } from "../src/colours.js";
import { blankShape, lastBefore, recordedShapes } from "../src/data.js";
import { fillField } from "../src/fields.js";
import { number, plain, roundLength, shortened, unitText } from "../src/numbers.js";
import { beat, beatIn, numbersIn, payloadOf } from "./program.js";

test("the library for curves is the one that npm has", async () => {
  for (const file of ["dist/uPlot.iife.min.js", "dist/uPlot.min.css", "LICENSE"]) {
    const published = await readFile(new URL(`../node_modules/uplot/${file}`, import.meta.url), "utf8");
    const carried = await readFile(new URL(`../vendor/${file.replace("dist/", "")}`, import.meta.url), "utf8");
    assert.equal(carried, published, `vendor/${file}: copy it from node_modules/uplot`);
  }
});

test("fields that the page computes are those of the program", async () => {
  // Content by place, so that the stress differs, and fibres askew.
  const path = await beat("askew", "--integrator", "quasi-static", "--fibre", "20 deg");
  const payload = await payloadOf(path);
  const [cell] = beatIn(payload).cells;
  const shapes = recordedShapes(cell);
  const shape = blankShape(shapes);
  const values = new Float32Array(shapes.corners.length / 4);
  for (const field of cell.fields) {
    const found = [Infinity, -Infinity];
    for (const time of cell.frames.t_ms) {
      shapes.at(time, shape);
      fillField(field.key, shapes, shape, values);
      for (const value of values.subarray(0, shapes.within)) {
        found[0] = Math.min(found[0], value);
        found[1] = Math.max(found[1], value);
      }
    }
    // Both corners of a square may be off by half a step of 16 bits and by what 32 bits leave of 150 um.
    const off = (cell.frames.step_um + 2e-5) / cell.spacing_um;
    const size = { "%": 100, "": 1, kPa: 1e-3, um: cell.spacing_um }[field.unit] ?? NaN;
    for (const end of [0, 1]) {
      const gap = Math.abs(found[end] - field.extremes[end]);
      assert.ok(gap <= 2 * off * size + 1e-5 * Math.abs(field.extremes[end]), `${field.key}: ${found} not ${field.extremes}`);
    }
  }
  const shortening = beatIn(payload).charts.find(({ name }) => name === "Shortening");
  assert.equal(shortening?.series[0].values.length, 1201);
  assert.equal(payload.times_ms.length, 1);
});

test("the shortening that is seen is the shortening that is measured", async () => {
  const path = await beat("length", "--integrator", "quasi-static");
  const payload = await payloadOf(path);
  const shapes = recordedShapes(beatIn(payload).cells[0]);
  const shape = blankShape(shapes);
  const length = (/** @type {Float32Array} */ points) => {
    const x = points.filter((_, index) => index % 2 === 0).subarray(shapes.rings[0][0], shapes.rings[0][1]);
    return x.reduce((most, value) => Math.max(most, value), -Infinity) - x.reduce((least, value) => Math.min(least, value), Infinity);
  };
  const numbers = numbersIn(payload);
  const value = (/** @type {string} */ name) => Number(numbers.get(name)?.[0] ?? NaN);
  shapes.at(value("time of peak"), shape);
  const seen = 100 * (1 - length(shape.points) / length(shapes.rest));
  // Outline against lattice, between frames on straight lines: 0.1 % of the length.
  assert.ok(Math.abs(seen - value("peak shortening")) < 0.1, `${seen}`);
});

test("a page says the numbers of summary.json", async () => {
  const path = await beat("numbers", "--integrator", "quasi-static");
  const summary = JSON.parse(await readFile(join(path, "../summary.json"), "utf8"));
  const numbers = [...numbersIn(await payloadOf(path)).values()];
  const [measured] = summary.beats;
  // The file has seven digits of them.
  const written = (/** @type {unknown} */ value) => (typeof value === "number" ? Number(value.toPrecision(7)) : null);
  for (const metric of [...measured.contraction, ...measured.tension, ...measured.action_potential]) {
    const found = numbers.find(([, unit, definition]) => unit === metric.unit && definition === metric.definition);
    assert.deepEqual([written(found?.[0]), found?.[1]], [metric.value, metric.unit]);
  }
});

test("times are found between others", () => {
  assert.deepEqual([-1, 0, 4.9, 5, 99].map((time) => lastBefore([0, 5, 10], time)), [0, 0, 0, 1, 2]);
});

test("a scale begins and ends with its own colours", () => {
  const colours = ramp(["#000000", "#ff0000", "#ffffff"]);
  assert.deepEqual([colours.length, colours[0], colours[STEPS - 1]], [STEPS, "rgb(0 0 0)", "rgb(255 255 255)"]);
  assert.deepEqual([-1, 0, 0.5, 1, 9].map((value) => stepOf(value, 0, 1)), [0, 0, STEPS / 2, STEPS - 1, STEPS - 1]);
});

test("numbers are written for people", () => {
  assert.deepEqual([12.0079, -0.0001, 0, null, 67300, 2.7e-7].map(number), ["12.01", "\u22121.00e\u22124", "0", "\u2013", "67300", "2.70e\u22127"]);
  assert.deepEqual([plain(-12), plain(8.38), plain(100)], ["\u221212", "8.38", "100"]);
  assert.deepEqual([0.9, 1, 3, 7, 24].map(roundLength), [0.5, 1, 2, 5, 20]);
  assert.deepEqual(["um", "L0/s", "um^2", "kPa"].map(unitText), ["\u00b5m", "L\u2080/s", "\u00b5m\u00b2", "kPa"]);
});

test("settings are shown with digits that people read", () => {
  assert.equal(shortened("92.45038608302155 kPa"), "92.4504 kPa");
  assert.equal(shortened("{ c_0 = 0.007930791973277703, a = 2 }"), "{ c_0 = 0.00793079, a = 2 }");
  assert.equal(shortened("data/2024.123456.tif"), "data/2024.123456.tif");
  assert.equal(shortened("2024.123456.tif"), "2024.123456.tif");
  assert.equal(shortened("long axis"), "long axis");
});
