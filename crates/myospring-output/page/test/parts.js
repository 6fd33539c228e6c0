// Parts of the page in Chromium, with an engine that is made up: it ends when it is told to.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { chromium } from "playwright-core";

/** @import { Page } from "playwright-core" */

const SOURCE = new URL("../src/", import.meta.url);

/** Holds files, runs if it has the file that a run names, and panics at a run called `panic`. A pinned run has its file as it was. */
const MADE_UP = `
const held = new Map();
let ran = "";
let pinned = [];
addEventListener("message", ({ data: { module, number, request, bytes } }) => {
  if (module !== undefined) return;
  const asked = JSON.parse(request);
  const say = (answer) => postMessage({ number, said: JSON.stringify(answer), panic: null });
  const lacks = (name) => say({ error: { message: "there is no " + name, advice: null } });
  if (asked.ask === "hold") held.set(asked.name, new TextDecoder().decode(bytes));
  if (asked.ask === "keep") held.set("tension.csv", "fitted");
  if (asked.ask === "pin") pinned.push(ran);
  if (asked.ask === "unpin") pinned = [];
  if (asked.ask === "about") return;
  if (asked.ask === "fit") return say({ results: { page: null, files: [{ name: "tension.csv", bytes: 3 }] } });
  if (asked.ask === "result") return say({ file: { name: asked.name, base64: btoa("fitted") } });
  if (asked.ask === "run" && asked.label === "panic") return postMessage({ number, said: "panicked at a test", panic: "unreachable" });
  if (asked.ask === "run" && asked.label === "memory") return postMessage({ number, said: "{}", panic: "unreachable" });
  const needed = asked.settings?.["cell.tension"];
  if (needed !== undefined && !held.has(needed)) return lacks(needed);
  if (asked.ask === "run") ran = held.get(needed) ?? "nothing";
  say({ kind: asked.ask === "run" ? [ran, ...pinned].join(", ") : "done" });
});`;

/** @param {(page: Page) => Promise<void>} work */
async function withParts(work) {
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox"] });
  try {
    const page = await browser.newPage();
    await page.route("http://parts.invalid/**", async (route) => {
      const name = new URL(route.request().url()).pathname.slice(1);
      if (name === "") {
        const body = `<!doctype html><form id="form"></form><script type="text/plain" id="worker">${MADE_UP}</script>`;
        return route.fulfill({ contentType: "text/html", body });
      }
      await route.fulfill({ contentType: "text/javascript", body: await readFile(new URL(name, SOURCE), "utf8") });
    });
    await page.goto("http://parts.invalid/");
    await page.evaluate(async () => {
      const address = "/engine.js";
      const { Engine, Stopped } = await import(address);
      const engine = new Engine(new WebAssembly.Module(new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0])));
      const run = (/** @type {string} */ label, settings = {}) => ({ ask: "run", settings, dose: null, label });
      const said = (/** @type {Promise<any>} */ asked) =>
        asked.then(({ error, kind }) => error?.message ?? kind ?? "done", (error) => (error instanceof Stopped ? "stopped" : String(error)));
      Object.assign(globalThis, { engine, run, said });
    });
    await work(page);
  } finally {
    await browser.close();
  }
}

test("a new engine knows what a fit has kept, and the files as they were when a run was pinned", async () => {
  await withParts(async (page) => {
    const answers = await page.evaluate(async () => {
      const { engine, run, said } = /** @type {any} */ (globalThis);
      const needs = () => said(engine.ask(run("fitted", { "cell.tension": "tension.csv" })));
      await engine.ask({ ask: "fit" });
      const answers = [await needs()];
      await engine.ask({ ask: "keep" });
      const waiting = said(engine.ask({ ask: "about" }));
      engine.stop();
      answers.push(await waiting, await needs());
      await engine.ask({ ask: "pin" });
      await engine.ask({ ask: "hold", name: "tension.csv" }, new TextEncoder().encode("other"));
      engine.stop();
      answers.push(await needs());
      return answers;
    });
    assert.deepEqual(answers, ["there is no tension.csv", "stopped", "fitted", "other, fitted"]);
  });
});

test("an engine that panics becomes a message, what waited is asked again, and the page goes on", async () => {
  await withParts(async (page) => {
    const answers = await page.evaluate(async () => {
      const { engine, run, said } = /** @type {any} */ (globalThis);
      const bytes = new TextEncoder().encode("held");
      await engine.ask({ ask: "hold", name: "cell.png" }, bytes);
      const asked = [run("panic"), { ask: "hold", name: "other.csv" }, run("next", { "cell.tension": "other.csv" }), { ask: "pin" }];
      const all = await Promise.all(asked.map((/** @type {any} */ request) => said(engine.ask(request, bytes))));
      const later = await said(engine.ask(run("later", { "cell.tension": "cell.png" })));
      return [...all, later, await said(engine.ask(run("memory"))), await said(engine.ask(run("last", { "cell.tension": "other.csv" })))];
    });
    const message = "panicked at a test";
    assert.deepEqual(answers, [message, "done", "held", message, "held", "The engine has ended: unreachable", "held"]);
  });
});

test("a change of the doses is told once, however often the form was made anew", async () => {
  await withParts(async (page) => {
    const told = await page.evaluate(async () => {
      const address = "/form.js";
      const { Form } = await import(address);
      const form = new Form({ version: "", settings: { properties: {} }, models: [], doses: "dose" });
      let times = 0;
      form.clear();
      form.clear();
      form.addEventListener("doses", () => times++);
      document.querySelector("textarea")?.dispatchEvent(new Event("change"));
      return times;
    });
    assert.equal(told, 1);
  });
});
