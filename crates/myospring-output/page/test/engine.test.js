// The engine of the page: its numbers are those of the program.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readdir, readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";
import { promisify } from "node:util";
import { engine, run } from "./engine.js";
import { arrays, beadFilm, outline } from "./gel.js";
import { folder, myospring, numbersIn, payloadOf } from "./program.js";

/** @import { Answer, Request } from "../src/requests.js" */

/** The example run files of the project. */
const EXAMPLES = join(import.meta.dirname, "../../../../examples");

/** Spacings of their meshes: where each triangle has a cell of its own, the engine that is built for tests takes minutes on finer ones. */
const COARSE = { cell: "6 um", tissue: "500 um" };

/** They take the engine of the tests long; `cargo xtask test --full` takes them, too. */
const LONG = ["calcium_wave.toml", "tissue_scar.toml", "tissue_sheet.toml", "tissue_spiral.toml"];

/** What rounding explains: exp and tanh differ in the last digits. Of the value, or in its unit where that is below 1. */
const TOLERANCE = 1e-9;

/** In a region tractions are found by conjugate gradients, which end at 1e-8 of the residual: the rest, which weak smoothing magnifies, depends on rounding. */
const IN_REGION = 1e-6;

/** @param {Answer} answer */
function pageOf(answer) {
  assert.equal(answer.error, undefined, answer.error?.message);
  if (answer.page === undefined) throw new Error("no page");
  return answer.page;
}

/** @param {Answer} answer */
function textOf(answer) {
  return Buffer.from(answer.file?.base64 ?? "", "base64").toString();
}

/** @type {[string, Record<string, any>][]} */
const SETUPS = [
  ["default", {}],
  ["weak", { "cell.peak_tension": "30 kPa", "material.young_modulus": "250 kPa" }],
  ["turned", { "mechanics.fibre": "20 deg" }],
  ["land", { "cell.model": "land_2017" }],
  ["clamped", { "mechanics.support": "clamped-ends" }],
  ["bed", { "mechanics.support": "elastic-bed", "mechanics.bed_stiffness": "0.5 kPa/um" }],
  ["train", { "stimulus.beats": 2, "stimulus.cycle_length": "600 ms" }],
  ["parameters", { "cell.parameters": { tau_si: 1.5 } }],
];

/**
 * Compares the numbers of a run with those of the program, which runs the file that the page saves.
 *
 * @param {(request: Request, bytes?: Uint8Array) => Answer} ask
 * @param {string} name
 * @param {Record<string, any>} settings
 */
async function compared(ask, name, settings) {
  const own = numbersIn(pageOf(ask(run(settings))));
  const file = join(folder, `${name}.toml`);
  await writeFile(file, textOf(ask({ ask: "save", what: "run" })));
  const output = join(folder, name);
  const args = ["run", file, "--quiet", "--outputs", "report", "--output", output];
  await promisify(execFile)(process.env.MYOSPRING ?? "", args);
  const theirs = numbersIn(await payloadOf(join(output, "report.html")));
  assert.deepEqual([...own.keys()], [...theirs.keys()]);
  assert.ok(own.size > 10, name);
  for (const [quantity, [value]] of own) {
    const [expected] = theirs.get(quantity) ?? [];
    if (typeof value !== "number" || typeof expected !== "number") {
      assert.deepEqual(value, expected, `${name}: ${quantity}`);
      continue;
    }
    const off = Math.abs(value - expected) / Math.max(Math.abs(expected), 1);
    assert.ok(off <= TOLERANCE, `${name}: ${quantity} is ${value}, of the program ${expected}`);
  }
  // The curves have as many digits as the program writes.
  const [curves, written] = [textOf(ask({ ask: "save", what: "traces" })), await readFile(join(output, "traces.csv"), "utf8")];
  assert.equal(curves.split("\n").length, written.split("\n").length);
}

test("the program gives the same numbers from the run file that the page saves", async () => {
  const { ask } = await engine();
  for (const [name, settings] of SETUPS) await compared(ask, name, settings);
});

test("each example run file gives the same numbers in the page and in the program, on a coarse mesh", async () => {
  const { ask } = await engine();
  const names = await readdir(EXAMPLES);
  for (const name of names.filter((name) => /\.(png|csv)$/.test(name))) {
    const bytes = await readFile(join(EXAMPLES, name));
    await writeFile(join(folder, name), bytes);
    ask({ ask: "hold", name }, bytes);
  }
  const all = process.env.MYOSPRING_ALL_CASES !== undefined;
  const files = names.filter((name) => name.endsWith(".toml") && (all || !LONG.includes(name))).sort();
  assert.ok(files.length > 8);
  for (const [number, name] of files.entries()) {
    if (number % 3 !== 0 && !all) continue;
    ask({ ask: "hold", name }, await readFile(join(EXAMPLES, name)));
    const { settings, error } = ask({ ask: "settings", name });
    assert.equal(error, undefined, `${name}: ${error?.message}`);
    const spacing = Object.keys(settings ?? {}).some((key) => key.startsWith("tissue.")) ? COARSE.tissue : COARSE.cell;
    await compared(ask, name.replace(".toml", "_again"), { ...settings, "shape.spacing": spacing });
  }
});

test("a cell of the last run's mesh and one that was computed anew have the same bits", async () => {
  const [{ ask }, fresh] = await Promise.all([engine(), engine()]);
  for (const tension of [50, 20, 60]) ask(run({ "cell.peak_tension": `${tension} kPa` }));
  const settings = { "cell.peak_tension": "40 kPa" };
  assert.deepEqual(pageOf(ask(run(settings))), pageOf(fresh.ask(run(settings))));
});

test("what is pinned stays beside what comes", async () => {
  const { ask } = await engine();
  ask(run({}));
  ask({ ask: "pin" });
  const page = pageOf(ask({ .../** @type {any} */ (run({ "cell.peak_tension": "30 kPa" })), label: "weak" }));
  const beat = page.sections.flatMap(({ parts }) => parts).find((part) => part.kind === "beat");
  assert.deepEqual(beat?.cells.map(({ label }) => label), ["a run", "weak"]);
  const differences = JSON.stringify(page.sections.find(({ id }) => id === "differences"));
  assert.match(differences, /peak_tension/);
  assert.equal(pageOf(ask({ ask: "unpin" })).kind, "A beat by Myospring");
});

test("doses are those of the program's files of doses", async () => {
  const { ask } = await engine();
  const doses = ask({ ask: "about" }).about?.doses ?? "";
  assert.deepEqual(ask({ ask: "doses", text: doses }).doses, ["control", "blocker 0.3 uM", "blocker 1 uM", "blocker 10 uM"]);
  const given = { .../** @type {any} */ (run({})), dose: [doses, "blocker 1 uM"] };
  const peak = numbersIn(pageOf(ask(given))).get("peak tension")?.[0];
  // At its ic50 the blocker takes half of 80 % of 50 kPa. The peak is that of a default beat to 1e-4.
  assert.ok(Math.abs(Number(peak) - 30) < 0.01, `${peak}`);
});

test("a setting outside its bounds, an unknown key and a file that is no picture are explained, and the next run goes on", async () => {
  const { ask } = await engine();
  const said = (/** @type {Answer} */ answer) => `${answer.error?.message}`;
  assert.match(said(ask(run({ "material.thickness": "0 um" }))), /thickness.*above 0 um, at most 5000 um/);
  assert.match(said(ask(run({ "material.thicknes": "8 um" }))), /no setting `material.thicknes`/);
  ask({ ask: "hold", name: "cell.png" }, new TextEncoder().encode("no picture"));
  assert.match(said(ask(run({ "shape.picture": "cell.png", "shape.pixel_size": "0.3 um" }))), /cell\.png/);
  assert.match(said(ask(run({ "shape.picture": "other.png", "shape.pixel_size": "0.3 um" }))), /other\.png/);
  pageOf(ask(run({})));
});

/** What a request about a gel does not say. */
const UNSAID = { gel_poisson: null, gel_thickness_um: null, unit_um: null, subset_um: null, frame_rate_per_s: null, reference: null, cell: null };

/** @param {any} one @param {any} other @param {string} name @param {number} tolerance */
function sameForces(one, other, name, tolerance) {
  assert.deepEqual(Object.keys(one), Object.keys(other));
  for (const [key, value] of Object.entries(one)) {
    if (typeof value !== "number") assert.deepEqual(value, other[key], `${name}: ${key}`);
    else assert.ok(Math.abs(value - other[key]) <= tolerance * Math.max(Math.abs(other[key]), 1), `${name}: ${key} is ${value}, of the program ${other[key]}`);
  }
}

test("tractions of displacements, and of beads, are those of the program", async () => {
  const { ask } = await engine();
  const [u, v] = arrays(40, 60);
  const files = { "u.npy": u, "v.npy": v, "cell.geojson": outline([15, 10], [9, 6]), "beads.y4m": beadFilm([0, 0, 1, 3, 1, 0]), "relaxed.y4m": beadFilm([0]), "around.geojson": outline([30, 24], [18, 15]) };
  for (const [name, content] of Object.entries(files)) {
    await writeFile(join(folder, name), content);
    ask({ ask: "hold", name }, new Uint8Array(Buffer.from(content)));
  }
  const gel = { ...UNSAID, gel_modulus_kpa: 5 };
  const thick = ["--gel-modulus", "5 kPa", "--force"];
  const told = { ...gel, gel_poisson: 0.45, gel_thickness_um: 40, cell: "cell.geojson" };
  const layer = ["--gel-poisson", "0.45", "--gel-thickness", "40 um", "--cell", "cell.geojson"];
  const around = { ...gel, cell: "around.geojson" };
  const besides = ["--cell", "around.geojson"];
  for (const [name, request, args, least] of /** @type {[string, any, string[], number][]} */ ([
    ["arrays", { ...gel, files: ["u.npy", "v.npy"], pixel_size_um: 0.5 }, ["u.npy", "v.npy", "--pixel-size", "0.5 um"], 5],
    ["layer", { ...told, files: ["u.npy", "v.npy"], pixel_size_um: 0.5 }, ["u.npy", "v.npy", "--pixel-size", "0.5 um", ...layer], 5],
    ["film", { ...around, files: ["beads.y4m"], pixel_size_um: 0.3 }, ["beads.y4m", "--pixel-size", "0.3 um", ...besides], 10],
    ["relaxed", { ...around, files: ["beads.y4m"], pixel_size_um: 0.3, reference: "relaxed.y4m" }, ["beads.y4m", "--pixel-size", "0.3 um", "--reference", "relaxed.y4m", ...besides], 10],
  ])) {
    const { results, error } = ask({ ask: "traction", ...request });
    assert.equal(error, undefined, `${name}: ${error?.message}`);
    const names = results?.files.map((file) => file.name) ?? [];
    for (const file of ["traction.csv", "tractions.npz", "summary.json", "figures/traction.png"]) assert.ok(names.includes(file), `${name}: ${file}`);
    await myospring("traction", ...args, ...thick, "--output", `traction_${name}`);
    const own = JSON.parse(textOf(ask({ ask: "result", name: "summary.json" })));
    const theirs = JSON.parse(await readFile(join(folder, `traction_${name}`, "summary.json"), "utf8"));
    assert.ok(own.largest_force.axial_force_nN > least, `${name}: ${own.largest_force.axial_force_nN}`);
    sameForces(own.largest_force, theirs.largest_force, name, own.confined_to_a_region ? IN_REGION : TOLERANCE);
    assert.deepEqual(own.warnings, theirs.warnings, name);
    assert.equal(results?.page?.sections[0].id, "key");
  }
  const said = (/** @type {any} */ request) => JSON.stringify(ask({ ask: "traction", ...UNSAID, gel_modulus_kpa: null, pixel_size_um: null, ...request }).error);
  assert.match(said({ files: ["u.npy", "v.npy"] }), /--pixel-size/);
  assert.match(said({ files: ["u.npy", "v.npy"], pixel_size_um: 0.5 }), /--gel-modulus/);
  assert.match(said({ files: ["u.npy", "v.npy"], pixel_size_um: 0.5, gel_modulus_kpa: 0 }), /must be above 0 kPa/);
  assert.match(said({ files: [] }), /two arrays/);
});

test("a fit takes a table of the force on a gel, with the modulus of that gel", async () => {
  const { ask } = await engine();
  const table = (/** @type {string} */ head) => new TextEncoder().encode([head, ...Array.from({ length: 60 }, (_, at) => `${10 * at},${100 - 10 * Math.sin((Math.PI * at) / 59) ** 2}`)].join("\n"));
  ask({ ask: "hold", name: "cell.csv" }, table("t_ms,length_um"));
  ask({ ask: "hold", name: "traction/force.csv" }, table("t_ms,axial_force_nN"));
  ask({ ask: "hold", name: "traction/length.csv" }, table("t_ms,length_um"));
  /** @type {any} */
  const fit = { ask: "fit", name: "cell.csv", columns: [], kind: null, unit: null, time_unit: null, frame_rate_per_s: null, pixel_size_um: null, from_ms: null, until_ms: null, stimulus_period_ms: null, peak_shortening_pct: null, settings: {} };
  const said = (/** @type {string} */ traction, /** @type {number | null} */ gel_modulus_kpa) => `${ask({ ...fit, traction, gel_modulus_kpa }).error?.message}`;
  assert.match(said("traction/length.csv", 5), /needs a force in nN.*length_um/);
  assert.match(said("traction/force.csv", null), /needs the gel on which the force was measured/);
  assert.match(said("traction/force.csv", 1e9), /a gel of 1000000000 kPa/);
  assert.match(said("traction/none.csv", 5), /traction\/none\.csv/);
});

test("memory stays flat over many runs", async () => {
  const { ask, size } = await engine();
  const all = process.env.MYOSPRING_ALL_CASES !== undefined;
  const coarse = { "shape.spacing": "5 um" };
  const many = (/** @type {number} */ from, /** @type {number} */ to) => {
    for (let tension = from; tension < to; tension++) pageOf(ask(run({ ...coarse, "cell.peak_tension": `${20 + (tension % 40)} kPa` })));
  };
  // The allocator settles in some 200 runs. Once more, seen after 4400 of 30 000 runs, it takes six pages of 64 kB.
  many(0, 200);
  const before = size();
  many(200, 200 + (all ? 10_000 : 200));
  const most = all ? 6 : 0;
  assert.ok(size() - before <= most * 65536, `${before} became ${size()} bytes`);
});
