// Wires the page: data, player, cells, curves, tables.

import { boxAround, CellView } from "./cell-view.js";
import { ramp } from "./colours.js";
import { Chart, chartsOf, peakOf, valueAt } from "./curves.js";
import { readPayload, recordedShapes } from "./data.js";
import { find, make } from "./elements.js";
import { number, plain, quantity, unitText } from "./numbers.js";
import { Player } from "./player.js";
import { metricTables, parameterTables, tiles } from "./tables.js";

/** @import { Box, Photograph } from "./cell-view.js" */
/** @import { Field, Payload, Picture } from "./payload.js" */

const PLAY = "M3 1.5v13l11-6.5z";
const PAUSE = "M3 2h3.5v12H3zM9.5 2H13v12H9.5z";
/** Steps of the arrow keys, ms. */
const STEP = 5;
/** Room around the cell, of its longer side. */
const ROOM = 0.02;
/** Lines of compared runs, told apart without colours too. */
const DASHES = [[], [7, 4], [2, 3], [10, 3, 2, 3], [14, 5], [5, 2]];

const payload = readPayload(document);
const { runs } = payload;
const alone = runs.length === 1;
const style = getComputedStyle(document.documentElement);
/** @param {string} name Of a custom property of the style sheet. */
const colour = (name) => style.getPropertyValue(name).trim();

writeHeader(payload);
writeText(payload);

const cells = runs.map((run) => recordedShapes(run.cell));
const player = new Player([
  Math.min(...cells.map((cell) => cell.span[0])),
  Math.max(...cells.map((cell) => cell.span[1])),
]);
const box = commonBox();
const fields = commonFields();
let field = fields.find(({ key }) => key === payload.colour) ?? fields[0];

const fieldSelect = find("field", HTMLSelectElement);
const opacity = find("opacity", HTMLInputElement);
const pictureBox = find("picture", HTMLInputElement);
const time = find("time", HTMLInputElement);
const cellsPlace = find("cells", HTMLElement);

const views = runs.map((run, index) => {
  const canvas = make("canvas", { role: "img" });
  const caption = make("figcaption", alone ? { class: "unseen" } : {}, run.label);
  cellsPlace.append(make("figure", {}, canvas, caption));
  return new CellView(canvas, cells[index], box, null);
});
const charts = makeCharts();

runs.forEach((run, index) => {
  if (run.picture !== null) loadPicture(run.picture, views[index]);
});
setUpControls();
layOut();
drawStills();
new ResizeObserver(layOut).observe(cellsPlace);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  drawCells();
  charts.forEach(({ chart }) => chart.redraw());
});
setUpPrinting();
if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();

/** The box around all cells, with some room, um. @returns {Box} */
function commonBox() {
  const boxes = cells.map((cell) => boxAround(cell));
  const low = [0, 1].map((axis) => Math.min(...boxes.map((each) => each[0][axis])));
  const high = [0, 1].map((axis) => Math.max(...boxes.map((each) => each[1][axis])));
  const room = ROOM * Math.max(high[0] - low[0], high[1] - low[1]);
  return [
    [low[0] - room, low[1] - room],
    [high[0] + room, high[1] + room],
  ];
}

/** The fields that every run has, on one scale. @returns {Field[]} */
function commonFields() {
  return runs[0].cell.fields.flatMap((first) => {
    const all = runs.map((run) => run.cell.fields.find((other) => other.key === first.key));
    const low = Math.min(...all.map((each) => each?.low ?? NaN));
    const high = Math.max(...all.map((each) => each?.high ?? NaN));
    return Number.isFinite(low + high) ? [{ ...first, low, high }] : [];
  });
}

/** @param {Payload} page */
function writeHeader({ title }) {
  document.title = title;
  find("kind", HTMLElement).textContent = alone ? "A beat by Myospring" : "Beats compared by Myospring";
  find("title", HTMLElement).textContent = title;
  const facts = alone ? runs[0].facts : runs.map((run) => run.label);
  find("facts", HTMLElement).append(...facts.map((fact) => make("li", {}, fact)));
  const warnings = runs.flatMap((run) =>
    run.warnings.map((warning) => (alone ? warning : `${run.label}: ${warning}`)),
  );
  find("warning-list", HTMLElement).append(...warnings.map((text) => make("li", {}, text)));
  find("warnings", HTMLElement).hidden = warnings.length === 0;
}

/** @param {Payload} page */
function writeText({ version }) {
  find("tiles", HTMLElement).append(...tiles(runs));
  find("tiles", HTMLElement).classList.toggle("several", !alone);
  find("metrics", HTMLElement).append(...metricTables(runs));
  for (const run of runs) {
    if (!alone) {
      find("parameters", HTMLElement).append(make("h3", {}, run.label));
      find("repeat", HTMLElement).append(make("h3", {}, run.label));
    }
    find("parameters", HTMLElement).append(...parameterTables(run.parameters));
    find("repeat", HTMLElement).append(
      make("p", {}, "Save this as ", make("code", {}, "run.toml"), ", then: ", make("code", {}, "myospring run run.toml")),
      snippet(run.run_file, "run file", "run.toml"),
    );
  }
  const citations = new Set(runs.map((run) => run.citations));
  find("cite", HTMLElement).append(...[...citations].map((text) => snippet(text, "BibTeX", "myospring.bib")));
  find("version", HTMLElement).textContent = `Made by Myospring ${version}.`;
}

/**
 * Text to copy or to keep as a file.
 *
 * @param {string} text
 * @param {string} what
 * @param {string} file
 */
function snippet(text, what, file) {
  const block = make("pre", { tabindex: "0", role: "region", "aria-label": what }, text);
  const copy = make("button", { type: "button" }, `Copy ${what}`);
  copy.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text);
      say(`The ${what} is copied.`);
      copy.textContent = "Copied";
      setTimeout(() => (copy.textContent = `Copy ${what}`), 1500);
    } catch {
      getSelection()?.selectAllChildren(block);
      say(`Copying is not allowed here; the ${what} is selected.`);
    }
  });
  const save = make("button", { type: "button" }, `Save ${file}`);
  save.addEventListener("click", () => {
    const address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
    make("a", { href: address, download: file }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  });
  return make("div", {}, block, make("div", { class: "actions" }, copy, save));
}

/** @param {string} text Is spoken by a screen reader. */
function say(text) {
  find("said", HTMLElement).textContent = text;
}

/**
 * @param {Picture} picture
 * @param {CellView} view
 */
async function loadPicture(picture, view) {
  const image = new Image();
  image.src = picture.href;
  await image.decode();
  /** @type {Photograph} */
  const photograph = { image, box: picture.corners_um };
  view.photograph = photograph;
  find("picture-choice", HTMLElement).hidden = false;
  drawCells();
}

function makeCharts() {
  const place = find("charts", HTMLElement);
  const data = chartsOf(
    runs.map((run, index) => ({
      ...run.curves,
      label: run.label,
      stimuli_ms: run.stimuli_ms,
      colour: `--run-${(index % DASHES.length) + 1}`,
      dash: DASHES[index % DASHES.length],
    })),
    (key) => (["potential", "tension", "shortening"].includes(key) ? `--${key}` : "--signal"),
  );
  const palette = {
    ink: () => colour("--muted"),
    grid: () => colour("--grid"),
    band: () => colour("--band"),
    curve: colour,
  };
  if (!alone) writeLegend();
  return data.map((each, index) => {
    const now = make("span", { class: "now", "aria-hidden": "true" });
    const title = make("h3", {}, "", now);
    if (each.band !== null) {
      const { low, high } = each.band;
      const text = `grey: ${low} to ${high} ${each.unit}, peaks seen in unloaded adult ventricular myocytes`;
      title.append(make("span", { class: "in-band" }, text));
    }
    const figure = make("div", { class: "plot", role: "img" });
    place.append(make("div", { class: "chart" }, title, figure));
    const chart = new Chart(figure, each, [player.start, player.end], palette, index === data.length - 1);
    title.prepend(chart.heading);
    figure.setAttribute("aria-label", chart.description);
    followPointer(chart);
    return { chart, figure, now };
  });
}

function writeLegend() {
  const legend = find("legend", HTMLElement);
  runs.forEach((run, index) => {
    const swatch = make("span", { class: "swatch", "aria-hidden": "true" });
    swatch.style.borderColor = `var(--run-${(index % DASHES.length) + 1})`;
    swatch.style.borderTopStyle = index === 0 ? "solid" : index % 2 === 1 ? "dashed" : "dotted";
    legend.append(make("li", {}, swatch, run.label));
  });
  legend.hidden = false;
}

/**
 * A pointer over a chart takes the time with it; a click stops there.
 *
 * @param {Chart} chart
 */
function followPointer(chart) {
  const { over } = chart;
  over.addEventListener("pointermove", (event) => {
    player.hold(true);
    player.seek(chart.timeAt(event.clientX));
  });
  over.addEventListener("pointerdown", (event) => {
    player.pause();
    player.seek(chart.timeAt(event.clientX));
  });
  for (const kind of ["pointerleave", "pointercancel"]) {
    over.addEventListener(kind, () => player.hold(false));
  }
}

function setUpControls() {
  fieldSelect.append(
    ...fields.map((each) => make("option", { value: each.key }, `${each.name}`)),
  );
  fieldSelect.value = field.key;
  fieldSelect.addEventListener("change", () => {
    field = fields.find((each) => each.key === fieldSelect.value) ?? field;
    showScale();
    drawCells();
  });
  showScale();
  for (const input of [opacity, pictureBox]) input.addEventListener("input", drawCells);

  time.min = String(player.start);
  time.max = String(player.end);
  time.step = "0.5";
  time.addEventListener("input", () => {
    player.pause();
    player.seek(Number(time.value));
  });
  const play = find("play", HTMLButtonElement);
  play.addEventListener("click", () => player.toggle());
  const speed = find("speed", HTMLSelectElement);
  speed.addEventListener("change", () => (player.speed = Number(speed.value)));
  const loop = find("loop", HTMLInputElement);
  loop.addEventListener("change", () => (player.loop = loop.checked));

  const icon = document.getElementById("play-icon");
  const showState = () => {
    play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    icon?.setAttribute("d", player.playing ? PAUSE : PLAY);
    describeCells();
  };
  player.addEventListener("state", showState);
  player.addEventListener("time", showTime);
  showState();

  document.addEventListener("keydown", (event) => {
    const { target } = event;
    const taken = target instanceof Element && target.closest("input, select, button, summary, pre, .wide");
    if (taken !== null && taken !== false) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    /** @type {Record<string, () => void>} */
    const keys = {
      " ": () => player.toggle(),
      ArrowLeft: () => step(-STEP),
      ArrowRight: () => step(STEP),
      Home: () => step(-Infinity),
      End: () => step(Infinity),
    };
    if (event.key in keys) {
      event.preventDefault();
      keys[event.key]();
    }
  });
}

/** @param {number} by ms. */
function step(by) {
  player.pause();
  player.seek(player.time + by);
}

function showScale() {
  find("scale-low", HTMLElement).textContent = plain(field.low);
  find("scale-high", HTMLElement).textContent = `${plain(field.high)} ${unitText(field.unit)}`.trim();
  find("meaning", HTMLElement).textContent = `${field.name}: ${field.definition}.`;
  const stops = ramp(field.colours).join(", ");
  find("gradient", HTMLElement).style.background = `linear-gradient(to right, ${stops})`;
}

/** Shows the time that it is everywhere. */
function showTime() {
  const now = player.time;
  time.value = String(now);
  find("clock", HTMLOutputElement).textContent = `${now.toFixed(0)} ms`;
  const values = charts.map(({ chart, now: place }) => {
    chart.setTime(now);
    const text = chart.data.series.map((series) => quantity(valueAt(series, now), chart.data.unit));
    place.textContent = text.join(" / ");
    return `${chart.data.name} ${text.join(", ")}`;
  });
  time.setAttribute("aria-valuetext", `${now.toFixed(0)} ms: ${values.join("; ")}`);
  if (!player.playing) describeCells();
  drawCells();
}

/** What a screen reader says of the cells; not while they move. */
function describeCells() {
  views.forEach((view, index) => {
    const of = alone ? "The cell" : runs[index].label;
    const [least, most] = view.extremes();
    const seen = player.playing
      ? "beating"
      : `at ${player.time.toFixed(0)} ms, ${field.name} ${number(least)} to ${quantity(most, field.unit)}`;
    view.canvas.setAttribute("aria-label", `${of}, ${seen}`);
  });
}

function drawCells() {
  const ink = { line: colour("--ink"), muted: colour("--muted") };
  views.forEach((view) => {
    const photograph = view.photograph !== null && pictureBox.checked;
    view.draw(player.time, field, { ink, photograph, opacity: photograph ? Number(opacity.value) : 1 });
  });
  const [least, most] = views[0].extremes();
  cellsPlace.dataset.least = String(least);
  cellsPlace.dataset.most = String(most);
}

/** Fits everything to the width of the page. */
function layOut() {
  const width = cellsPlace.clientWidth;
  const wanted = CellView.heightFor(box, width);
  // Several cells lie above each other where they are long, side by side where they are not.
  const columns = alone || wanted < 0.5 * width ? 1 : Math.min(views.length, Math.floor(width / 240) || 1);
  cellsPlace.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  const each = (width - 8 * (columns - 1)) / columns;
  const height = Math.min(Math.max(CellView.heightFor(box, each), 120), 0.62 * innerHeight);
  views.forEach((view) => view.resize(each, height, devicePixelRatio));
  charts.forEach(({ chart, figure }) => chart.resize(figure.clientWidth));
  showTime();
}

/** The cells at rest and at their peak, for paper. */
function drawStills() {
  const place = find("stills", HTMLElement);
  runs.forEach((run, index) => {
    const shortening = run.curves.list.find((curve) => curve.key === "shortening");
    const curve = { t_ms: run.curves.t_ms, values: shortening?.values ?? [] };
    const moments = [
      { name: "at rest", time: player.start },
      { name: "at its peak", time: peakOf(curve).time },
    ];
    for (const { name, time: moment } of moments) {
      const canvas = make("canvas");
      const of = alone ? "" : `${run.label}, `;
      place.append(make("figure", {}, canvas, make("figcaption", {}, `${of}${name}, ${moment.toFixed(0)} ms`)));
      const view = new CellView(canvas, cells[index], box, null);
      view.resize(340, Math.min(CellView.heightFor(box, 340), 400), 3);
      canvas.removeAttribute("style");
      const ink = { line: "#1a1d21", muted: "#555d68" };
      view.draw(moment, field, { ink, photograph: false, opacity: 1 });
    }
  });
  const { spacing_um: spacing, accuracy_um: accuracy } = runs[0].cell;
  find("drawn", HTMLElement).textContent =
    `Drawn on squares of ${number(spacing)} ${unitText("um")}; positions are right to ` +
    `${number(accuracy)} ${unitText("um")}. Curves and numbers are those of the run itself.`;
}

/** Charts fit the paper, and what is folded is opened. */
function setUpPrinting() {
  /** @type {HTMLDetailsElement[]} */
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details")].filter((details) => !details.open);
    for (const details of opened) details.open = true;
    charts.forEach(({ chart }) => {
      chart.resize(660, 0.75);
      chart.redraw();
    });
  });
  addEventListener("afterprint", () => {
    for (const details of opened) details.open = false;
    layOut();
    charts.forEach(({ chart }) => chart.redraw());
  });
}
