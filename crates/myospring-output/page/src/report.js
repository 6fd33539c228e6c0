// Wires the page: data, player, cells, curves, tables.

import { boxAround, CellView } from "./cell-view.js";
import { lineOf, ramp } from "./colours.js";
import { Chart, chartsOf, chartsOfFit, peakOf, valueAt } from "./curves.js";
import { readPayload, recordedShapes } from "./data.js";
import { Sheet } from "./drawing.js";
import { find, make, withCode } from "./elements.js";
import { number, plain, quantity, unitText } from "./numbers.js";
import { OverlayView } from "./overlay-view.js";
import { Player } from "./player.js";
import { profileDrawing } from "./profiles.js";
import { differenceTable, fittedNumbers, keyNumbers, metricTables, parameterTables } from "./tables.js";

/** @import { Photograph } from "./cell-view.js" */
/** @import { Box, Ink } from "./drawing.js" */
/** @import { Field, Fit, Payload, Picture } from "./payload.js" */

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
/** Least width of a page on which a cell and its curves may be side by side, and of a column of charts, px. */
const SIDE_BY_SIDE = 820;
const LEAST_CHART = 300;
/** Least part of the width that a cell has beside its curves. */
const LEAST_PART = 0.36;
/** Between the columns of the stage, px. */
const GUTTER = 24;
/** Height that the name of a chart takes, and the words below its time axis, px. */
const CHART_HEAD = 26;
const CHART_FOOT = 20;
/** Greatest height of a plot, px. */
const MOST_PLOT = 150;
/** Least height of a cell, px. */
const LEAST_CELL = 110;
/** The part of the window's height that cell and curves take where much lies above them. */
const LEAST_STAGE = 0.65;
/** Of at most so many runs the values of now stand beside the name of a chart. */
const TOLD = 4;
/** Ink on paper that is printed. */
const PRINTED = { line: "#1a1d21", muted: "#555d68", paper: "#ffffff" };

const payload = readPayload(document);
const { runs, fit } = payload;
// A notebook makes the frame of a page as high as the page, which must not grow with it.
const framed = parent !== window;
const heightAtFirst = innerHeight;
const windowHeight = () => (framed ? heightAtFirst : innerHeight);
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
const stage = find("stage", HTMLElement);
const charts = makeCharts();
if (!alone) leadWithCurves();

runs.forEach((run, index) => {
  if (run.picture !== null) loadPicture(run.picture, views[index]);
});
setUpControls();
addStills();
layOut();
drawStills();
let laidOut = stage.clientWidth;
new ResizeObserver(() => {
  if (stage.clientWidth === laidOut) return;
  laidOut = stage.clientWidth;
  layOut();
}).observe(stage);
if (!framed) addEventListener("resize", layOut);
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
  const one = fit === null ? "A beat by Myospring" : "A fit by Myospring, and the beat of the fitted cell";
  find("kind", HTMLElement).textContent = alone ? one : "Beats compared by Myospring";
  find("title", HTMLElement).textContent = title;
  // Of several runs the legend has the names.
  const facts = alone ? runs[0].facts : [];
  find("facts", HTMLElement).append(...facts.map((fact) => make("li", {}, fact)));
  const warnings = runs.flatMap((run) =>
    run.warnings.map((text) => (alone ? text : `${run.label}: ${text}`)),
  );
  const all = [...ofAll, ...warnings];
  find("warning-list", HTMLElement).append(...all.map((text) => make("li", {}, ...withCode(text))));
  find("warnings", HTMLElement).hidden = all.length === 0;
}

/** @param {Payload} page */
function writeText({ version, differences }) {
  find("key", HTMLElement).append(fit === null ? keyNumbers(runs) : fittedNumbers(fit.estimates));
  if (fit !== null) writeFit(fit);
  const about = new Set(runs.flatMap((run) => run.about_model ?? []));
  find("about", HTMLElement).append(...withCode([...about].join(" ")));
  find("about", HTMLElement).hidden = about.size === 0;
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
      make(
        "p",
        {},
        make("span", { class: "on-screen" }, "Save this as ", make("code", {}, "run.toml"), ", then: "),
        make("span", { class: "on-paper" }, "The file run.toml beside this page: "),
        make("code", {}, "myospring run run.toml"),
      ),
      snippet(run.run_file, "run file", "run.toml", alone ? "" : ` of ${run.label}`),
    ];
    find("parameters", HTMLElement).append(...(alone ? parameters : [folded(run.label, index, parameters)]));
    find("repeat", HTMLElement).append(...(alone ? repeat : [folded(run.label, index, repeat)]));
  });
  const citations = new Set(runs.map((run) => run.citations));
  find("cite", HTMLElement).append(...[...citations].map((text) => snippet(text, "BibTeX", "myospring.bib")));
  find("version", HTMLElement).textContent = `Made by Myospring ${version}.`;
}

/** @param {Fit} fit */
function writeFit({ verdict, headline, profiles, notes, figures }) {
  const line = find("verdict", HTMLElement);
  line.textContent = headline;
  line.classList.add(verdict);
  line.hidden = false;
  const place = find("fit", HTMLElement);
  place.hidden = false;
  find("profiles", HTMLElement).append(...profiles.map(profileDrawing));
  find("profiles", HTMLElement).hidden = profiles.length === 0;
  find("profiles-hint", HTMLElement).hidden = profiles.length === 0;
  find("fit-notes", HTMLElement).append(...notes.map((text) => make("li", {}, text)));
  find("figures", HTMLElement).append(
    ...figures.flatMap(({ title, light, dark, words, notes }) => [
      make("h2", {}, title),
      make(
        "div",
        { class: "wide", role: "region", "aria-label": title, tabindex: "0" },
        make(
          "picture",
          {},
          make("source", { srcset: dark, media: "screen and (prefers-color-scheme: dark)" }),
          make("img", { src: light, alt: words, class: "drawn" }),
        ),
      ),
      make("p", {}, words),
      make("ul", {}, ...notes.map((text) => make("li", {}, text))),
    ]),
  );
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
 * @param {string} of Whose it is, where there are several.
 */
function snippet(text, what, file, of = "") {
  const block = make("pre", { tabindex: "0", role: "region", "aria-label": `${what}${of}` }, text);
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
  const ofRuns = chartsOf(
    runs.map((run, index) => ({
      ...run.curves,
      label: run.label,
      stimuli_ms: run.stimuli_ms,
      ...lineOf(index),
    })),
    (key) => (["potential", "tension", "shortening"].includes(key) ? `--${key}` : "--signal"),
  );
  const data = [...(fit === null ? [] : chartsOfFit(fit.curves, runs[0].stimuli_ms)), ...ofRuns];
  const palette = {
    ink: () => colour("--muted"),
    grid: () => colour("--grid"),
    band: () => colour("--band"),
    curve: colour,
  };
  if (!alone) writeLegend();
  return data.map((each) => {
    const now = make("span", { class: "now", "aria-hidden": "true" });
    const title = make("h3", {}, "", now);
    if (each.note !== "") title.append(make("span", { class: "in-band" }, each.note));
    const figure = make("div", { class: "plot", role: "img" });
    const axis = make("p", { class: "axis" }, "Time (ms)");
    const element = make("div", { class: "chart" }, title, figure, axis);
    place.append(element);
    const chart = new Chart(figure, each, [player.start, player.end], palette);
    title.prepend(chart.heading);
    figure.setAttribute("aria-label", chart.description);
    followPointer(chart);
    return { chart, element, axis, now };
  });
}

/** Of several runs the curves come first: they show the difference. */
function leadWithCurves() {
  stage.classList.add("compared");
  stage.prepend(find("curves", HTMLElement), find("controls", HTMLElement));
  find("key", HTMLElement).before(find("beat", HTMLElement));
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
    return Math.ceil(views.length / columns) * height <= SEEN * windowHeight();
  };
  return Array.from({ length: most }, (_, index) => index + 1).find(fits) ?? most;
}

/** Fits everything to the window: cell and curves are seen together, beside each other or one above the other. */
function layOut() {
  const width = stage.clientWidth;
  if (alone) layOutOne(width);
  else layOutSeveral(width);
  showTime();
}

/**
 * The arrangement of a cell and its curves in which the cell is largest.
 *
 * @param {number} width Of the stage, px.
 */
function layOutOne(width) {
  const top = stage.getBoundingClientRect().top + scrollY;
  const high = (/** @type {string} */ id) => find(id, HTMLElement).offsetHeight;
  // Between its parts, and below the last.
  const gaps = 3 * GAP;
  const about = find("about", HTMLElement);
  const below = about.hidden ? 0 : about.offsetHeight + GAP;
  const whole = Math.max(windowHeight() - top - below, LEAST_STAGE * windowHeight()) - high("controls") - gaps;
  const room = whole - high("bar");
  const most = Sheet.heightFor(boxes[0], width);
  const across = columnsOfCharts(width, whole - LEAST_CELL - high("bar"));
  const above = Math.min(most, Math.max(room - heightOfCharts(across, Chart.LEAST), LEAST_CELL));
  const half = (width - GUTTER) / 2;
  const left = Math.max(Math.min(Sheet.widthFor(boxes[0], room), half), LEAST_PART * width);
  const right = width - GUTTER - left;
  const scales = [Sheet.scaleIn(boxes[0], width, above), Sheet.scaleIn(boxes[0], left, room)];
  const fits = heightOfCharts(columnsOfCharts(right, whole), Chart.LEAST) <= whole;
  const beside = width >= SIDE_BY_SIDE && fits && scales[1] > scales[0];
  stage.classList.toggle("beside", beside);
  if (beside) {
    stage.style.gridTemplateColumns = `${left}px ${right}px`;
    // In less width the bar may take two lines.
    const height = Math.min(whole - high("bar"), Sheet.heightFor(boxes[0], left));
    views[0].resize(left, height, devicePixelRatio);
    fitCharts(right, columnsOfCharts(right, whole), whole);
  } else {
    stage.style.gridTemplateColumns = "";
    views[0].resize(width, above, devicePixelRatio);
    fitCharts(width, across, room - above);
  }
  cellsPlace.style.gridTemplateColumns = "";
}

/** @param {number} width Of the stage, px. */
function layOutSeveral(width) {
  const columns = columnsIn(width);
  cellsPlace.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  const each = (width - GAP * (columns - 1)) / columns;
  const most = 0.62 * windowHeight();
  const height = Math.min(Math.max(Sheet.heightFor(boxes[0], each), 100), most);
  views.forEach((view) => view.resize(each, height, devicePixelRatio));
  const wide = Math.min(width, 640);
  overlay?.resize(wide, Math.min(Sheet.heightFor(boxes[0], wide), most), devicePixelRatio);
  const room = LEAST_STAGE * windowHeight() - find("legend", HTMLElement).offsetHeight;
  fitCharts(width, columnsOfCharts(width, room), room);
}

/**
 * Height of the charts in this number of columns, px.
 *
 * @param {number} columns
 * @param {number} plot Height of each plot, px.
 */
function heightOfCharts(columns, plot) {
  return Math.ceil(charts.length / columns) * (plot + CHART_HEAD) + Chart.AXIS + CHART_FOOT;
}

/**
 * As few columns of charts as are seen at once, if any number is.
 *
 * @param {number} width px.
 * @param {number} room px.
 */
function columnsOfCharts(width, room) {
  const most = Math.max(Math.floor((width + GUTTER) / (LEAST_CHART + GUTTER)), 1);
  const all = Array.from({ length: most }, (_, index) => index + 1);
  return all.find((columns) => heightOfCharts(columns, Chart.LEAST) <= room) ?? most;
}

/**
 * @param {number} width px.
 * @param {number} columns
 * @param {number} room px.
 */
function fitCharts(width, columns, room) {
  const rows = Math.ceil(charts.length / columns);
  const spare = room - heightOfCharts(columns, 0);
  const plot = Math.min(Math.max(spare / rows, Chart.LEAST), MOST_PLOT);
  const place = find("charts", HTMLElement);
  // They follow each other downwards, fewest in the first column.
  const first = charts.length - rows * (columns - 1);
  if (place.childElementCount !== columns || place.querySelector(".column") === null) {
    const all = Array.from({ length: columns }, () => make("div", { class: "column" }));
    charts.forEach(({ element }, index) => {
      all[index < first ? 0 : 1 + Math.floor((index - first) / rows)].append(element);
    });
    place.replaceChildren(...all);
  }
  place.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  const each = (width - GUTTER * (columns - 1)) / columns;
  charts.forEach(({ chart, element, axis }) => {
    const last = element.nextElementSibling === null;
    axis.hidden = !last;
    chart.resize(each, plot, last);
  });
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

/** Height of a plot on paper and width of all, px. */
const PAPER = { width: 660, plot: 84 };

/** Charts fit the paper, and parameters that were changed are unfolded. */
function setUpPrinting() {
  /** @type {HTMLDetailsElement[]} */
  let opened = [];
  addEventListener("beforeprint", () => {
    drawStills();
    opened = [...document.querySelectorAll("details")].filter((details) => !details.open);
    for (const details of opened) details.open = true;
    const columns = charts.length > 3 ? 2 : 1;
    fitCharts(PAPER.width, columns, heightOfCharts(columns, PAPER.plot));
    charts.forEach(({ chart }) => chart.redraw());
  });
  addEventListener("afterprint", () => {
    for (const details of opened) details.open = false;
    layOut();
    charts.forEach(({ chart }) => chart.redraw());
  });
}
