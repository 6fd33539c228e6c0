// The page: a form, an engine, and what a report shows.

import { find, make } from "./elements.js";
import { Engine, Stopped } from "./engine.js";
import { Form } from "./form.js";
import { keptIn, linkOf } from "./link.js";
import { setUpPrinting } from "./paper.js";
import { showPage } from "./whole.js";

/** @import { Answer, Failure, Request, Setup } from "./requests.js" */
/** @import { ShownPage } from "./whole.js" */

/** A run that has taken longer is given up for the next one, ms. */
const PATIENCE = 1000;
/** A run that takes longer can be stopped by hand, ms. */
const NOTICED = 300;
/** The largest file that is read, bytes. */
const LARGEST = 500e6;

const [PICTURES, OUTLINES] = [/\.(png|tiff?|jpe?g)$/i, /\.(geojson|json|csv|roi|zip|txt)$/i];

/** @type {ShownPage | null} */
let shown = null;
/** The set-up that is to be run next. @type {Setup | null} */
let wanted = null;
/** When the present run began, or null. @type {number | null} */
let begun = null;

const state = find("state", HTMLElement);
const stop = find("stop", HTMLButtonElement);
const pin = find("pin", HTMLButtonElement);
const unpin = find("unpin", HTMLButtonElement);

setUpPrinting(() => shown ?? { charts: [], beat: null });
start().catch((error) => fail({ message: `The engine does not start: ${error.message ?? error}`, advice: "This page needs a browser of 2023 or later." }));

async function start() {
  const engine = await Engine.inPage();
  const { about } = await engine.ask({ ask: "about" });
  if (about === undefined) throw new Error("it does not answer");
  const form = new Form(about);
  const setup = find("setup", HTMLDetailsElement);
  const isWide = matchMedia("(min-width: 60rem)");
  setup.open = isWide.matches;
  isWide.addEventListener("change", () => (setup.open = isWide.matches));
  // On a phone the set-up covers the lower half, so that the cell goes to the upper one.
  setup.addEventListener("toggle", () => {
    if (setup.open && !isWide.matches) document.getElementById("stage")?.scrollIntoView();
  });
  form.addEventListener("change", () => want(engine, form.setup));
  form.addEventListener("doses", async () => {
    const answer = await engine.ask({ ask: "doses", text: form.doses });
    if (!failed(answer)) form.offerDoses(answer.doses ?? []);
  });
  form.offerDoses((await engine.ask({ ask: "doses", text: form.doses })).doses ?? []);
  stop.addEventListener("click", () => {
    wanted = null;
    engine.stop();
  });
  pin.addEventListener("click", async () => {
    await show(engine, { ask: "pin" });
    unpin.hidden = false;
    state.textContent = "Pinned: change something to compare with it.";
  });
  unpin.addEventListener("click", async () => {
    await show(engine, { ask: "unpin" });
    unpin.hidden = true;
  });
  for (const button of document.querySelectorAll("[data-save]")) {
    const what = /** @type {"report"} */ (button.getAttribute("data-save"));
    button.addEventListener("click", () => save(engine, what));
  }
  setUpFiles(engine, form);
  find("link", HTMLButtonElement).addEventListener("click", () => link(form));
  if (!(await taken(engine, form))) want(engine, form.setup);
  addEventListener("hashchange", () => taken(engine, form));
}

/** Whether the set-up in the address was taken, which then runs. @param {Engine} engine @param {Form} form */
async function taken(engine, form) {
  try {
    const kept = keptIn(location.hash);
    // The page wrote it itself.
    if (kept === null || location.hash === linkOf(form.kept)) return false;
    if (kept.doses !== null) form.offerDoses((await engine.ask({ ask: "doses", text: kept.doses })).doses ?? []);
    form.take(kept);
    return true;
  } catch (error) {
    fail({ message: `The link in the address of this page cannot be read: ${/** @type {Error} */ (error).message}.`, advice: "Ask for the link again, or for the run file." });
    return false;
  }
}

/** Puts the set-up into the address, and the address where it can be pasted from. @param {Form} form */
async function link(form) {
  location.replace(linkOf(form.kept));
  const isCopied = await navigator.clipboard.writeText(location.href).then(() => true, () => false);
  const where = isCopied ? "The link is copied." : "The link is the address of this page.";
  state.textContent = form.isBuiltIn ? `${where} It holds the set-up.` : `${where} It holds the set-up, not the cell's file.`;
}

/** Runs a set-up; if others come meanwhile, only the last of them is run. @param {Engine} engine @param {Setup} setup */
async function want(engine, setup) {
  wanted = setup;
  if (begun !== null) {
    if (performance.now() - begun > PATIENCE) engine.stop();
    return;
  }
  while (wanted !== null) {
    const next = wanted;
    wanted = null;
    begun = performance.now();
    const noticed = setTimeout(() => {
      stop.hidden = false;
      state.textContent = "Simulating.";
    }, NOTICED);
    const took = await show(engine, { ask: "run", ...next });
    clearTimeout(noticed);
    [stop.hidden, begun] = [true, null];
    if (took !== null) state.textContent = `Simulated in ${took < 1000 ? `${took.toFixed(0)} ms` : `${(took / 1000).toFixed(1)} s`}.`;
  }
}

/**
 * Shows the page that the engine answers; gives how long that took, ms, or null if there is none.
 *
 * @param {Engine} engine
 * @param {Request} request
 */
async function show(engine, request) {
  const asked = performance.now();
  try {
    const answer = await engine.ask(request);
    const took = performance.now() - asked;
    if (failed(answer) || answer.page === undefined) return null;
    const { scrollY } = window;
    shown = showPage(answer.page, shown);
    scrollTo({ top: scrollY, behavior: "instant" });
    document.body.dataset.runs = String(Number(document.body.dataset.runs ?? 0) + 1);
    return took;
  } catch (error) {
    if (!(error instanceof Stopped)) throw error;
    state.textContent = "Stopped.";
    return null;
  }
}

/** Whether there is an error, which is then shown. @param {Answer} answer */
function failed({ error }) {
  find("failure", HTMLElement).hidden = true;
  if (error === undefined) return false;
  fail(error);
  return true;
}

/** @param {Failure} failure */
function fail({ message, advice }) {
  const place = find("failure", HTMLElement);
  place.textContent = advice === null ? message : `${message} (${advice})`;
  place.hidden = false;
  state.textContent = "";
}

/** @param {Engine} engine @param {"report" | "traces" | "run" | "picture"} what */
async function save(engine, what) {
  const answer = await engine.ask({ ask: "save", what });
  if (failed(answer) || answer.file === undefined) return;
  const bytes = Uint8Array.from(atob(answer.file.base64), (letter) => letter.charCodeAt(0));
  const address = URL.createObjectURL(new Blob([bytes]));
  make("a", { href: address, download: answer.file.name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

/** @param {Engine} engine @param {Form} form */
function setUpFiles(engine, form) {
  const input = find("file", HTMLInputElement);
  const builtIn = find("built-in", HTMLButtonElement);
  const [pixelPlace, pixelSize] = [find("pixel-place", HTMLElement), find("pixel-size", HTMLInputElement)];
  /** The picture that is the cell. */
  let picture = "";
  const take = async (/** @type {File | undefined} */ file) => {
    if (file === undefined) return;
    if (file.size > LARGEST) {
      fail({ message: `${file.name} has ${(file.size / 1e6).toFixed(0)} MB; this page reads files of at most ${LARGEST / 1e6} MB.`, advice: "The program reads larger ones." });
      return;
    }
    const isRun = /\.toml$/i.test(file.name);
    const key = PICTURES.test(file.name) ? "shape.picture" : OUTLINES.test(file.name) ? "shape.outline" : null;
    if (!isRun && key === null) {
      fail({ message: `${file.name} is of a kind that this page does not read.`, advice: "Give a picture (.png, .tif), an outline (.geojson, .roi, .csv) or a run file (.toml)." });
      return;
    }
    const held = await engine.ask({ ask: "hold", name: file.name }, new Uint8Array(await file.arrayBuffer()));
    if (failed(held)) return;
    picture = key === "shape.picture" ? file.name : "";
    pixelSize.value = "";
    pixelPlace.hidden = picture === "";
    builtIn.hidden = false;
    form.takeShape(isRun ? file.name : null, key === null ? {} : { [key]: file.name });
  };
  input.addEventListener("change", () => take(input.files?.[0]));
  pixelSize.addEventListener("change", () => {
    /** @type {Record<string, string>} */
    const size = pixelSize.value === "" ? {} : { "shape.pixel_size": `${pixelSize.value} um` };
    form.takeShape(null, { "shape.picture": picture, ...size });
  });
  builtIn.addEventListener("click", () => {
    builtIn.hidden = pixelPlace.hidden = true;
    input.value = "";
    form.takeShape(null, {});
  });
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    void take(event.dataTransfer?.files[0]);
  });
}
