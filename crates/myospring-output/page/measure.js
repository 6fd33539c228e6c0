// How fast the engine of the page answers: `ENGINE=.../myospring_web.wasm node measure.js`; processor time, which does not depend on
// what else the machine does.

import { engine, run } from "./test/engine.js";

const { ask } = await engine();

/** @param {string} what @param {number} times @param {(time: number) => import("./src/requests.js").Request} request */
function measure(what, times, request) {
  const spent = Array.from({ length: times }, (_, time) => {
    const before = process.cpuUsage();
    const { error } = ask(request(time));
    if (error !== undefined) throw new Error(error.message);
    const { user, system } = process.cpuUsage(before);
    return (user + system) / 1e3;
  }).sort((a, b) => a - b);
  process.stdout.write(`${what}: ${spent[times >> 1].toFixed(0)} ms\n`);
}

measure("first beat", 1, () => run({}));
measure("peak tension", 9, (time) => run({ "cell.peak_tension": `${30 + time} kPa` }));
measure("Young's modulus", 9, (time) => run({ "material.young_modulus": `${300 + time} kPa` }));
measure("the page of a run alone", 9, () => ({ ask: "unpin" }));
