// Wires the page: data, player, cells, curves, tables.

import { boxAround, CellView } from "./cell-view.js";
import { lineOf, ramp } from "./colours.js";
import { Chart, chartsOf, peakOf, valueAt } from "./curves.js";
import { readPayload, recordedShapes } from "./data.js";
import { Sheet } from "./drawing.js";
import { find, make } from "./elements.js";
import { number, plain, quantity, unitText } from "./numbers.js";
import { OverlayView } from "./overlay-view.js";
import { Player } from "./player.js";
import { differenceTable, keyNumbers, metricTables, parameterTables } from "./tables.js";

/** @import { Photograph } from "./cell-view.js" */
/** @import { Box, Ink } from "./drawing.js" */
/** @import { Field, Payload, Picture } from "./payload.js" */

const PLAY = "M3 1.5v13l11-6.5z";
const PAUSE = "M3 2h3.5v12H3zM9.5 2H13v12H9.5z";
/** Steps of the arrow keys, ms. */
const STEP = 5;
/** Room around the cell, of its longer side. */
const ROOM = 0.02;
/** Least width of a cell among several, px, and the part of the window's height that they should take together. */
const LEAST_WIDTH = 240;
const SEEN = 0.75;
const GAP = 8;
/** Of at most so many runs the values of now stand beside the name of a chart. */
const TOLD = 4;
/** Ink on paper that is printed. */
const PRINTED = { line: "#1a1d21", muted: "#555d68", paper: "#ffffff" };

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
const boxes = boxesOfOneSize();
const fields = commonFields();
let field = fields.find(({ key }) => key === payload.colour) ?? fields[0];

const fieldSelect = find("field", HTMLSelectElement);
const opacity = find("opacity", HTMLInputElement);
const pictureBox = find("picture", HTMLInputElement);
const time = find("time", HTMLInputElement);
const cellsPlace = find("cells", HTMLElement);

const overlay = alone ? null : addOverlay();
const views = runs.map((run, index) => {
  const canvas = make("canvas", { role: "img" });
  const caption = make("figcaption", alone ? { class: "unseen" } : {}, run.label);
  cellsPlace.append(make("figure", {}, canvas, caption));
  return new CellView(canvas, cells[index], boxes[index], null);
});
/** @type {{ view: CellView, time: number }[]} For paper. */
const stills = [];
const charts = makeCharts();

runs.forEach((run, index) => {
  if (run.picture !== null) loadPicture(run.picture, views[index]);
});
setUpControls();
addStills();
layOut();
drawStills();
new ResizeObserver(layOut).observe(cellsPlace);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  drawCells();
  charts.forEach(({ chart }) => chart.redraw());
});
setUpPrinting();
if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();

/** The box around each cell, with some room: all as large as the largest, so that all have one scale. */
function boxesOfOneSize() {
  const around = cells.map((cell) => boxAround(cell));
  const size = [0, 1].map((axis) => Math.max(...around.map(([low, high]) => high[axis] - low[axis])));
  const room = ROOM * Math.max(...size);
  return around.map(([low, high]) => boxAbout(middleOf([low, high]), size[0] + 2 * room, size[1] + 2 * room));
}

/** @param {Box} box @returns {[number, number]} */
function middleOf([low, high]) {
  return [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
}

/** @param {[number, number]} middle @param {number} width @param {number} height @returns {Box} */
function boxAbout([x, y], width, height) {
  return [
    [x - width / 2, y - height / 2],
    [x + width / 2, y + height / 2],
  ];
}

/** A canvas on which all outlines lie over each other. @param {HTMLCanvasElement} canvas */
function overlayOn(canvas) {
  const [[left, low], [right, high]] = boxes[0];
  const all = cells.map((shapes, index) => {
    const { colour: name, dash } = lineOf(index);
    return { shapes, middle: middleOf(boxes[index]), colour: () => colour(name), dash };
  });
  return new OverlayView(canvas, all, boxAbout([0, 0], right - left, high - low));
}

function addOverlay() {
  const canvas = make("canvas", { role: "img" });
  cellsPlace.append(make("figure", { class: "overlay" }, canvas, make("figcaption", {}, "all over each other")));
  return overlayOn(canvas);
}

/** Colours of lines on the screen. @returns {Ink} */
function ink() {
  return { line: colour("--ink"), muted: colour("--muted"), paper: colour("--paper") };
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
function writeHeader({ title, warnings: ofAll }) {
  document.title = title;
  find("kind", HTMLElement).textContent = alone ? "A beat by Myospring" : "Beats compared by Myospring";
  find("title", HTMLElement).textContent = title;
  const facts = alone ? runs[0].facts : runs.map((run) => run.label);
  find("facts", HTMLElement).append(...facts.map((fact) => make("li", {}, fact)));
  const warnings = runs.flatMap((run) =>
    run.warnings.map((text) => (alone ? text : `${run.label}: ${text}`)),
  );
  const all = [...ofAll, ...warnings];
  find("warning-list", HTMLElement).append(...all.map((text) => make("li", {}, text)));
  find("warnings", HTMLElement).hidden = all.length === 0;
}

/** @param {Payload} page */
function writeText({ version, differences }) {
  find("key", HTMLElement).append(keyNumbers(runs));
  find("changes", HTMLElement).hidden = alone;
  const differ = find("differences", HTMLElement);
  differ.hidden = alone;
  differ.append(
    differences.length > 0
      ? differenceTable(differences, runs)
      : make("p", {}, "The runs have the same settings."),
  );
  find("metrics", HTMLElement).append(...metricTables(runs));
  runs.forEach((run, index) => {
    const parameters = parameterTables(run.parameters);
    const repeat = [
      make("p", {}, "Save this as ", make("code", {}, "run.toml"), ", then: ", make("code", {}, "myospring run run.toml")),
      snippet(run.run_file, "run file", "run.toml"),
    ];
    find("parameters", HTMLElement).append(...(alone ? parameters : [folded(run.label, index, parameters)]));
    find("repeat", HTMLElement).append(...(alone ? repeat : [folded(run.label, index, repeat)]));
  });
  const citations = new Set(runs.map((run) => run.citations));
  find("cite", HTMLElement).append(...[...citations].map((text) => snippet(text, "BibTeX", "myospring.bib")));
  find("version", HTMLElement).textContent = `Made by Myospring ${version}.`;
}

/**
 * What is told of each of several runs; on paper of the first only, since the table above says in what the others
 * differ.
 *
 * @param {string} label
 * @param {number} index
 * @param {HTMLElement[]} content
 */
function folded(label, index, content) {
  const kind = index === 0 ? "each-run" : "each-run on-screen";
  return make("details", { class: kind }, make("summary", {}, label), ...content);
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
  try {
    await image.decode();
  } catch {
    say("The picture cannot be shown.");
    return;
  }
  /** @type {Photograph} */
  const photograph = { image, box: picture.corners_um };
  view.photograph = photograph;
  find("picture-choice", HTMLElement).hidden = false;
  drawCells();
  drawStills();
}

function makeCharts() {
  const place = find("charts", HTMLElement);
  const data = chartsOf(
    runs.map((run, index) => ({
      ...run.curves,
      label: run.label,
      stimuli_ms: run.stimuli_ms,
      ...lineOf(index),
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
  runs.forEach((run, index) => legend.append(make("li", {}, swatch(index), run.label)));
  legend.hidden = false;
}

/**
 * The line of a run, as the charts draw it.
 *
 * @param {number} index
 */
function swatch(index) {
  const { colour: name, dash } = lineOf(index);
  const kind = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(kind, "svg");
  for (const [key, value] of Object.entries({ viewBox: "0 0 36 8", class: "swatch", "aria-hidden": "true" })) {
    svg.setAttribute(key, value);
  }
  const line = document.createElementNS(kind, "path");
  line.setAttribute("d", "M0 4h36");
  line.setAttribute("stroke-width", "2.5");
  line.setAttribute("stroke-dasharray", dash.join(" "));
  line.style.stroke = `var(${name})`;
  svg.append(line);
  return svg;
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
    place.textContent = runs.length > TOLD ? "" : text.join(" / ");
    return `${chart.data.name} ${text.join(", ")}`;
  });
  time.setAttribute("aria-valuetext", `${now.toFixed(0)} ms: ${values.join("; ")}`);
  if (!player.playing) describeCells();
  drawCells();
}

/** What a screen reader says of the cells; not while they move. */
function describeCells() {
  overlay?.canvas.setAttribute(
    "aria-label",
    `Outlines of all runs over each other, ${player.playing ? "beating" : `at ${player.time.toFixed(0)} ms`}`,
  );
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
  const lines = ink();
  overlay?.draw(runs.map(() => player.time), lines);
  views.forEach((view) => {
    const photograph = view.photograph !== null && pictureBox.checked;
    view.draw(player.time, field, { ink: lines, photograph, opacity: photograph ? Number(opacity.value) : 1 });
  });
  const [least, most] = views[0].extremes();
  cellsPlace.dataset.least = String(least);
  cellsPlace.dataset.most = String(most);
}

/** As few columns of cells as let all of them be seen at once, if any number does. @param {number} width px. */
function columnsIn(width) {
  const most = Math.max(Math.min(views.length, Math.floor((width + GAP) / (LEAST_WIDTH + GAP))), 1);
  const fits = (/** @type {number} */ columns) => {
    const height = Sheet.heightFor(boxes[0], (width - GAP * (columns - 1)) / columns);
    return Math.ceil(views.length / columns) * height <= SEEN * innerHeight;
  };
  return Array.from({ length: most }, (_, index) => index + 1).find(fits) ?? most;
}

/** Fits everything to the width of the page. */
function layOut() {
  const width = cellsPlace.clientWidth;
  const columns = columnsIn(width);
  cellsPlace.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  const each = (width - GAP * (columns - 1)) / columns;
  const most = 0.62 * innerHeight;
  const height = Math.min(Math.max(Sheet.heightFor(boxes[0], each), 100), most);
  views.forEach((view) => view.resize(each, height, devicePixelRatio));
  const wide = Math.min(width, 640);
  overlay?.resize(wide, Math.min(Sheet.heightFor(boxes[0], wide), most), devicePixelRatio);
  charts.forEach(({ chart, figure }) => chart.resize(figure.clientWidth));
  showTime();
}

/** The canvases that paper has instead of the animation: cells at rest and at their peak. */
function addStills() {
  const place = find("stills", HTMLElement);
  /** @type {(caption: string) => HTMLCanvasElement} */
  const add = (caption) => {
    const canvas = make("canvas");
    place.append(make("figure", {}, canvas, make("figcaption", {}, caption)));
    return canvas;
  };
  const size = (/** @type {Sheet} */ sheet) => {
    sheet.resize(340, Math.min(Sheet.heightFor(sheet.box, 340), 400), 3);
    sheet.canvas.removeAttribute("style");
  };
  const peaks = runs.map((run) => {
    const shortening = run.curves.list.find((curve) => curve.key === "shortening");
    return peakOf({ t_ms: run.curves.t_ms, values: shortening?.values ?? [] }).time;
  });
  if (!alone) {
    for (const [caption, times] of /** @type {[string, number[]][]} */ ([
      ["all at rest", runs.map(() => player.start)],
      ["each at its peak", peaks],
    ])) {
      const view = overlayOn(add(caption));
      size(view);
      view.draw(times, PRINTED);
    }
  }
  runs.forEach((run, index) => {
    const of = alone ? "" : `${run.label}, `;
    for (const [name, time] of /** @type {[string, number][]} */ ([
      ["at rest", player.start],
      ["at its peak", peaks[index]],
    ])) {
      const canvas = add(`${of}${name}, ${time.toFixed(0)} ms`);
      const view = new CellView(canvas, cells[index], boxes[index], null);
      size(view);
      stills.push({ view, time });
    }
  });
}

/** Draws the cells for paper; at rest, where no colour says anything, on its picture. */
function drawStills() {
  stills.forEach(({ view, time }, index) => {
    view.photograph = views[index >> 1].photograph;
    const photograph = view.photograph !== null && index % 2 === 0;
    view.draw(time, field, { ink: PRINTED, photograph, opacity: photograph ? 0 : 1 });
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
    drawStills();
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
