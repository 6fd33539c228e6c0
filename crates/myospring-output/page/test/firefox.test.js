// The page that simulates, in Firefox, over its own protocol (Marionette): Playwright's Firefox is not the one that people have.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { setTimeout as pause } from "node:timers/promises";
import { pathToFileURL } from "node:url";

/** @import { Socket } from "node:net" */

const PORT = 2828;
/** How often and how long it is asked whether something is there, ms. */
const [OFTEN, LONG] = [200, 60_000];

const profile = await mkdtemp(join(tmpdir(), "myospring-firefox-"));
await writeFile(join(profile, "user.js"), `user_pref("marionette.port", ${PORT});\n`);
const firefox = spawn(process.env.FIREFOX ?? "firefox", ["--headless", "--marionette", "--no-remote", "--profile", profile], { stdio: "ignore" });
after(async () => {
  firefox.kill();
  await new Promise((resolve) => (firefox.exitCode === null ? firefox.once("exit", resolve) : resolve(null)));
  await rm(profile, { recursive: true, force: true, maxRetries: 5 });
});

/** Waits until something is there. @template T @param {() => Promise<T | null>} look @returns {Promise<T>} */
async function there(look) {
  for (const end = Date.now() + LONG; Date.now() < end; await pause(OFTEN)) {
    const found = await look();
    if (found !== null) return found;
  }
  throw new Error("Firefox does not get there");
}

/** A connection to Firefox, once it listens. @returns {Promise<Socket>} */
const connected = () =>
  there(
    () =>
      new Promise((resolve) => {
        const socket = connect(PORT, "127.0.0.1", () => resolve(socket));
        socket.once("error", () => resolve(null));
      }),
  );

/** Sends commands; each answer is a length, a colon and JSON. @param {Socket} socket */
function commands(socket) {
  let number = 0;
  let rest = Buffer.alloc(0);
  /** @type {Map<number, { resolve: (value: any) => void, reject: (error: Error) => void }>} */
  const waiting = new Map();
  socket.on("data", (data) => {
    rest = Buffer.concat([rest, data]);
    for (let colon = rest.indexOf(":"); colon > 0; colon = rest.indexOf(":")) {
      const end = colon + 1 + Number(rest.subarray(0, colon));
      if (rest.length < end) return;
      const answer = JSON.parse(rest.subarray(colon + 1, end).toString());
      rest = rest.subarray(end);
      // The first one only says who it is.
      if (!Array.isArray(answer)) continue;
      const [, of, error, value] = answer;
      if (error === null) waiting.get(of)?.resolve(value);
      else waiting.get(of)?.reject(new Error(error.message));
      waiting.delete(of);
    }
  });
  /** @param {string} name @param {object} parameters @returns {Promise<any>} */
  return (name, parameters) =>
    new Promise((resolve, reject) => {
      number += 1;
      waiting.set(number, { resolve, reject });
      const text = Buffer.from(JSON.stringify([0, number, name, parameters]));
      socket.write(Buffer.concat([Buffer.from(`${text.length}:`), text]));
    });
}

test("the page beats and answers a slider in Firefox", async () => {
  const socket = await connected();
  const ask = commands(socket);
  await ask("WebDriver:NewSession", {});
  await ask("WebDriver:Navigate", { url: pathToFileURL(process.env.PAGE ?? "").href });
  const run = async (/** @type {string} */ script) => (await ask("WebDriver:ExecuteScript", { script, args: [] })).value;
  const tiles = (/** @type {number} */ runs) =>
    there(async () => ((await run("return Number(document.body.dataset.runs ?? 0)")) >= runs ? run("return document.querySelector('.tiles').textContent") : null));
  assert.match(await tiles(1), /12\.01.%/);
  await run("const bar = document.querySelector('input[type=range][aria-label=\"peak tension\"]'); bar.value = 25; bar.dispatchEvent(new Event('input'))");
  assert.match(await tiles(2), /peak tension25\.0.\u00a0kPa/);
  assert.equal(await run("return document.getElementById('failure').hidden"), true);
  socket.destroy();
});
