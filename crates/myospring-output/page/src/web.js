// The page: a form, an engine, and what a report shows.

import { find, make } from "./elements.js";
import { bytesOf, Engine, Stopped } from "./engine.js";
import { Files } from "./files.js";
import { Form } from "./form.js";
import { keptIn, linkOf } from "./link.js";
import { inWordsOfPage, madeUp, Measured } from "./measured.js";
import { setUpPrinting } from "./paper.js";
import { Tour } from "./tour.js";
import { showPage } from "./whole.js";

/** @import { Answer, Failure, Request, Results, Setup } from "./requests.js" */
/** @import { ShownPage } from "./whole.js" */

/** A run that has taken longer is given up for the next one, ms. */
const PATIENCE = 1000;
/** A run that takes longer can be stopped by hand, ms. */
const NOTICED = 300;
/** @type {ShownPage | null} */
let shown = null;
/** The set-up that is to be run next. @type {Setup | null} */
let wanted = null;
/** Number of the last work of `work`; what comes of an earlier one is not said. */
let works = 0;
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
  const measured = new Measured();
  /** A change of the cell goes back to it. */
  const leave = () => {
    offer([]);
    find("take-over", HTMLButtonElement).hidden = true;
    pin.hidden = false;
  };
  const setup = find("setup", HTMLDetailsElement);
  const isWide = matchMedia("(min-width: 60rem)");
  setup.open = isWide.matches;
  isWide.addEventListener("change", () => (setup.open = isWide.matches));
  // On a phone the set-up covers the lower half, so that the cell goes to the upper one.
  setup.addEventListener("toggle", () => {
    if (setup.open && !isWide.matches) document.getElementById("stage")?.scrollIntoView();
  });
  form.addEventListener("change", () => {
    leave();
    void want(engine, form.setup);
  });
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
    button.addEventListener("click", () => save(engine, { ask: "save", what }));
  }
  setUpMeasured(engine, form, measured);
  new Files(engine, form, measured, { failed, fail, show: (request) => show(engine, request), save: (request) => save(engine, request) });
  new Tour(form);
  find("save-all", HTMLButtonElement).addEventListener("click", () => work(engine, { ask: "save-all" }, "Saving"));
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
  place.textContent = inWordsOfPage(advice === null ? message : `${message} (${advice})`);
  place.hidden = false;
  state.textContent = "";
}

/**
 * Lets the engine work that long that it tells how far it is; gives its results, which are then offered, or null.
 *
 * @param {Engine} engine
 * @param {Request} request
 * @param {string} doing
 * @returns {Promise<Results | null>}
 */
async function work(engine, request, doing) {
  const [asked, own] = [performance.now(), ++works];
  state.textContent = `${doing}.`;
  stop.hidden = false;
  engine.onprogress = (what, done, of) => {
    state.textContent = of > 1 ? `${doing}: ${what}, ${done} of ${of}.` : `${doing}: ${what}.`;
  };
  try {
    const answer = await engine.ask(request);
    if (failed(answer) || answer.results === undefined) return null;
    const { page, files } = answer.results;
    if (page !== null) {
      shown = showPage(page, shown);
      document.body.dataset.runs = String(Number(document.body.dataset.runs ?? 0) + 1);
    }
    offer(files, engine);
    if (own === works) state.textContent = `${doing}: done in ${((performance.now() - asked) / 1000).toFixed(1)} s.`;
    return answer.results;
  } catch (error) {
    if (!(error instanceof Stopped)) throw error;
    if (own === works) state.textContent = "Stopped.";
    return null;
  } finally {
    if (own === works) {
      stop.hidden = true;
      engine.onprogress = () => {};
    }
  }
}

/** Offers files of results. @param {Results["files"]} files @param {Engine} [engine] */
function offer(files, engine) {
  const place = find("results", HTMLElement);
  place.hidden = files.length === 0;
  place.replaceChildren(
    ...files.map(({ name, bytes }) => {
      const button = make("button", { type: "button" }, name);
      button.addEventListener("click", () => engine !== undefined && save(engine, { ask: "result", name }));
      const size = bytes < 1e6 ? `${Math.ceil(bytes / 1000)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
      return make("li", {}, button, make("span", { class: "unit" }, size));
    }),
  );
}

/** What is done with a curve or a film. @param {Engine} engine @param {Form} form @param {Measured} measured */
function setUpMeasured(engine, form, measured) {
  const takeOver = find("take-over", HTMLButtonElement);
  const model = find("fit-model", HTMLSelectElement);
  let reading = 0;
  const read = async () => {
    // What was asked before has another answer now.
    if (reading > 0) engine.stop();
    if (measured.shape !== null) {
      measured.open();
      return form.takeShape(measured.shape);
    }
    // The same file shows something else now.
    if (form.stack === measured.name) form.takeShape({});
    takeOver.hidden = true;
    pin.hidden = true;
    reading += 1;
    const found = await work(engine, measured.question, measured.doing).finally(() => (reading -= 1));
    if (found === null) measured.open();
  };
  measured.addEventListener("read", read);
  find("fit", HTMLButtonElement).addEventListener("click", async () => {
    const found = await work(engine, measured.fitting(form.fitted(model.value)), "Fitting");
    takeOver.hidden = !(found?.files.some(({ name }) => name === "run.toml") ?? false);
  });
  takeOver.addEventListener("click", async () => {
    if (failed(await engine.ask({ ask: "keep" }))) return;
    const answer = await engine.ask({ ask: "settings", name: "run.toml" });
    if (!failed(answer) && answer.settings !== undefined) form.takeSettings(answer.settings, `fitted to ${measured.name}`);
  });
  find("leave", HTMLButtonElement).addEventListener("click", () => {
    measured.leave();
    form.tell();
  });
  find("sample-curve", HTMLButtonElement).addEventListener("click", async () => {
    const answer = await engine.ask({ ask: "save", what: "traces" });
    if (failed(answer) || answer.file === undefined) return;
    const text = new TextEncoder().encode(madeUp(atob(answer.file.base64)));
    if (failed(await engine.ask({ ask: "hold", name: "made_up.csv" }, text))) return;
    measured.take(["made_up.csv"], "curve");
    await read();
  });
}

/** @param {Engine} engine @param {Request} request */
async function save(engine, request) {
  const answer = await engine.ask(request);
  if (failed(answer) || answer.file === undefined) return;
  const address = URL.createObjectURL(new Blob([bytesOf(answer.file.base64)]));
  make("a", { href: address, download: answer.file.name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
