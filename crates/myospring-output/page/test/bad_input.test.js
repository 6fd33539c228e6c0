// Damaged and extreme input, as a table: what the page holds, what it asks, and what the message names. The program's table is
// `tests/program/damaged.rs`, that of Python `tests/test_damaged.py`.

import assert from "node:assert/strict";
import { test } from "node:test";
import { engine, run } from "./engine.js";
import { arrays, beadFilm, outline } from "./gel.js";

/** @import { Request } from "../src/requests.js" */

const CURVE = ["t_ms,length_um", ...Array.from({ length: 100 }, (_, at) => `${20 * at},${100 - 8 * Math.exp(-(((20 * at - 500) / 80) ** 2))}`)].join("\n");
const FILM = beadFilm([0, 1, 0]);
const ARRAY = arrays(20, 30)[0];
const OUTLINE = `${outline([15, 10], [9, 6])}`;

/** A file with another piece in place of one. @param {string} text @param {string} usual @param {string} other */
const changed = (text, usual, other) => {
  assert.ok(text.includes(usual), usual);
  return text.replace(usual, other);
};
/** A film with another head. @param {string} usual @param {string} other */
const film = (usual, other) => Buffer.from(changed(FILM.toString("latin1"), usual, other), "latin1");

/** @type {any} */
const READING = { frame_rate_per_s: null, pixel_size_um: null, columns: [], kind: null, unit: null, time_unit: null, from_ms: null, until_ms: null, stimulus_period_ms: null };
/** @param {any} more */
const analyse = (more = {}) => ({ ask: "analyse", name: "file.csv", ...READING, ...more });
/** @param {any} more */
const fit = (more = {}) => ({ ask: "fit", name: "file.csv", settings: {}, traction: null, gel_modulus_kpa: null, peak_shortening_pct: null, ...READING, ...more });
const SCALE = { "shape.pixel_size": "0.5 um" };
const picture = run({ "shape.picture": "file.png", ...SCALE });
/** @param {any} more */
const track = (more = {}) => ({ ask: "track", name: "file.y4m", frame_rate_per_s: null, settings: SCALE, ...more });
/** @param {any} more */
const traction = (more = {}) => ({ ask: "traction", files: ["file.npy", "file.npy"], gel_modulus_kpa: 5, gel_poisson: null, gel_thickness_um: null, pixel_size_um: 0.5, unit_um: null, subset_um: null, frame_rate_per_s: null, reference: null, cell: null, ...more });

/** What the file is called. */
const NAMES = ["csv", "geojson", "mp4", "npy", "png", "toml", "y4m"].map((ending) => `file.${ending}`);

/** What the file is, what is asked, and what the message names. @type {[string | Buffer, any, RegExp[]][]} */
const ROWS = [
  // Settings.
  ["", run({ "cell.peak_tension": "1e300 kPa" }), [/peak_tension/, /1e300/, /500 kPa/]],
  ["", run({ "material.young_modulus": "-1 kPa" }), [/young_modulus/, /-1/]],
  ["", run({ "material.thickness": "8" }), [/thickness/, /um/]],
  ["", run({ "material.thicknes": "8 um" }), [/no setting `material\.thicknes`/]],
  ["", run({ "stimulus.beats": 1e17 }), [/beats/]],
  ["", run({ "shape.spacing": "1e-9 um" }), [/spacing/]],
  ["", run({ "cell.parameters": { tau_si: 1e300 } }), [/tau_si/, /1e300/]],
  ["", run({ "cell.parameters": { tau_six: 1 } }), [/tau_six/]],
  ["", run({ "cell.model": "tor" }), [/tor/]],
  // Pictures.
  ["", picture, [/`file\./, /0 bytes/]],
  ["no picture", picture, [/`file\./]],
  [Buffer.from("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "latin1"), picture, [/`file\./, /complete/]],
  ["", run({ "shape.picture": "gone.png", ...SCALE }), [/gone\.png/]],
  [OUTLINE, { ask: "cells", settings: { "shape.picture": "file.png", "shape.pixel_size": "1e-300 um" } }, [/pixel.size/, /1e-300 um/]],
  // Films.
  [FILM.subarray(0, 5), track(), [/`file\./]],
  [FILM.subarray(0, 300), track(), [/`file\./, /at least 3/]],
  [film("F10:1", "F10:0"), track(), [/how many frames a second/]],
  [film("W200", "W0"), track(), [/states no size/]],
  [film("W200", "W999999999"), track(), [/999999999 x 160 pixels/]],
  [film("FRAME", "FRUMP"), track(), [/frame 0 does not begin with `FRAME`/]],
  ["", track({ name: "file.mp4" }), [/`file\.mp4`/, /TIFF or uncompressed AVI/]],
  [FILM, track({ frame_rate_per_s: 1e300 }), [/frame/, /1000000/]],
  // Tables.
  ["", analyse(), [/`file\./]],
  ["t_ms,length_um\n", analyse(), [/`file\./]],
  [Buffer.alloc(4000), analyse(), [/`file\./]],
  [changed(CURVE, "\n300,", "\nlate,"), analyse(), [/line 17/, /late/]],
  [changed(CURVE, "\n300,", "\n1e300,"), analyse(), [/line 17/, /1e300 ms/]],
  [changed(CURVE, "\n300,", "\n20,"), analyse(), [/line 17/, /20 ms does not come after 280 ms/]],
  [CURVE, analyse({ columns: ["force"] }), [/force/]],
  [CURVE, analyse({ from_ms: 1e300 }), [/1e300/]],
  [CURVE, analyse({ stimulus_period_ms: 1e300 }), [/stimulus.period/]],
  [CURVE, fit({ traction: "gone.csv", gel_modulus_kpa: 5 }), [/gone\.csv/]],
  [CURVE, fit({ free: ["tau_zz"] }), [/tau_zz/]],
  [CURVE, fit({ settings: { "mechanics.support": "clamped-ends" } }), [/ends of this cell are held/]],
  // Gels.
  [ARRAY.subarray(0, 40), traction(), [/`file\./]],
  [ARRAY.subarray(0, 400), traction(), [/`file\./]],
  [ARRAY, traction({ gel_modulus_kpa: 0 }), [/above 0 kPa/]],
  [ARRAY, traction({ gel_poisson: 0.7 }), [/0\.7/]],
  [ARRAY, traction({ pixel_size_um: -1 }), [/-1/]],
  [ARRAY, traction({ files: ["file.npy"] }), [/`file\.npy` is one array/, /give two/]],
  // Outlines, run files, doses, models.
  [changed(OUTLINE, "[[", "[[["), { ask: "open", name: "file.geojson" }, [/file\./]],
  ["[shape\n", { ask: "settings", name: "file.toml" }, [/line 1/]],
  [`a = ${"[".repeat(100_000)}`, { ask: "settings", name: "file.toml" }, [/more than 64 brackets/]],
  ["", { ask: "doses", text: "[[dose]\n" }, [/line 1/]],
  ["[[model]]\n", { ask: "model", name: "file.toml" }, [/file\./]],
];

test("bad input is refused with what is wrong in it, and the next run goes on", async () => {
  const { ask } = await engine();
  for (const [content, request, names] of ROWS) {
    for (const name of NAMES) ask({ ask: "hold", name }, new Uint8Array(Buffer.from(content)));
    const { error } = ask(/** @type {Request} */ (request));
    const asked = JSON.stringify(request).slice(0, 200);
    assert.ok(error, `${asked} is taken`);
    const said = `${error.message}\n${error.advice ?? ""}`;
    for (const name of names) assert.match(said, name, asked);
  }
  assert.ok(ask(run({ "shape.spacing": "5 um" })).page);
});
