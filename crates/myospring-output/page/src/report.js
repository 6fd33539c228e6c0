// Wires the page: data, player, cells, curves, tables.

import { boxAround, CellView } from "./cell-view.js";
import { makeCharts, showValues, writeLegend } from "./charts.js";
import { lineOf, ramp } from "./colours.js";
import { setUpControls } from "./controls.js";
import { readPayload, recordedShapes } from "./data.js";
import { find, make, say } from "./elements.js";
import { writeHeader } from "./header.js";
import { layOut } from "./layout.js";
import { number, plain, quantity, unitText } from "./numbers.js";
import { OverlayView } from "./overlay-view.js";
import { addStills, drawStills, setUpPrinting } from "./paper.js";
import { Player } from "./player.js";
import { writeSections } from "./sections.js";

/** @import { Box, Ink } from "./drawing.js" */
/** @import { Field, Picture } from "./payload.js" */

/** Room around the cell, of its longer side. */
const ROOM = 0.02;

const payload = readPayload(document);
const { runs } = payload;
// A notebook makes the frame of a page as high as the page, which must not grow with it.
const framed = parent !== window;
const heightAtFirst = innerHeight;
const windowHeight = () => (framed ? heightAtFirst : innerHeight);
const alone = runs.length === 1;
const style = getComputedStyle(document.documentElement);
/** @param {string} name Of a custom property of the style sheet. */
const colour = (name) => style.getPropertyValue(name).trim();

writeHeader(payload, windowHeight());
writeSections(payload);

const cells = runs.map((run) => recordedShapes(run.cell));
const player = new Player([
  Math.min(...cells.map((cell) => cell.span[0])),
  Math.max(...cells.map((cell) => cell.span[1])),
]);
const boxes = boxesOfOneSize();
const fields = commonFields();
let field = fields.find(({ key }) => key === payload.colour) ?? fields[0];

const opacity = find("opacity", HTMLInputElement);
const pictureBox = find("picture", HTMLInputElement);
const cellsPlace = find("cells", HTMLElement);

const overlay = alone ? null : overlayOn(addFigure("all over each other"));
const views = runs.map(
  (run, index) => new CellView(addFigure(run.label, alone ? "unseen" : ""), cells[index], boxes[index], null),
);
const stills = addStills(runs, cells, boxes, player.start, alone ? null : overlayOn);
const stage = find("stage", HTMLElement);
const { charts, others } = makeCharts(payload, player, colour);
const moreCurves = find("more-curves", HTMLDetailsElement);

if (!alone) {
  writeLegend(payload);
  leadWithCurves();
}
runs.forEach((run, index) => {
  if (run.picture !== null) loadPicture(run.picture, views[index]);
});
setUpControls(player);
setUpColours();
foldOtherCurves();
player.addEventListener("state", describeCells);
player.addEventListener("time", showTime);
fitToWindow();
drawForPaper();
sayHowDrawn();
let laidOut = stage.clientWidth;
new ResizeObserver(() => {
  if (stage.clientWidth === laidOut) return;
  laidOut = stage.clientWidth;
  fitToWindow();
}).observe(stage);
if (!framed) addEventListener("resize", fitToWindow);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  drawCells();
  [...charts, ...others].forEach(({ chart }) => chart.redraw());
});
setUpPrinting(charts, drawForPaper, fitToWindow);
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

/** A canvas with a caption among the cells. @param {string} caption @param {string} kind */
function addFigure(caption, kind = "") {
  const canvas = make("canvas", { role: "img" });
  cellsPlace.append(make("figure", {}, canvas, make("figcaption", { class: kind }, caption)));
  return canvas;
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

/** @param {Picture} picture @param {CellView} view */
async function loadPicture(picture, view) {
  const image = new Image();
  image.src = picture.href;
  try {
    await image.decode();
  } catch {
    say("The picture cannot be shown.");
    return;
  }
  view.photograph = { image, box: picture.corners_um };
  find("picture-choice", HTMLElement).hidden = false;
  // The bar is higher now.
  fitToWindow();
  drawForPaper();
}

/** Of several runs the curves come first: they show the difference. */
function leadWithCurves() {
  stage.classList.add("compared");
  stage.prepend(find("curves", HTMLElement), find("controls", HTMLElement));
  find("key", HTMLElement).before(find("beat", HTMLElement));
}

/** Curves of which there are too many for one screen are drawn when somebody asks for them. */
function foldOtherCurves() {
  moreCurves.hidden = others.length === 0;
  find("more-curves-title", HTMLElement).textContent = `${others.length} more curves of the cell model`;
  moreCurves.addEventListener("toggle", showTime);
}

/** What the cell is coloured by. */
function setUpColours() {
  const select = find("field", HTMLSelectElement);
  select.append(...fields.map((each) => make("option", { value: each.key }, each.name)));
  select.value = field.key;
  select.addEventListener("change", () => {
    field = fields.find((each) => each.key === select.value) ?? field;
    showScale();
    drawCells();
  });
  showScale();
  for (const input of [opacity, pictureBox]) input.addEventListener("input", drawCells);
}

function showScale() {
  find("scale-low", HTMLElement).textContent = plain(field.low);
  find("scale-high", HTMLElement).textContent = `${plain(field.high)} ${unitText(field.unit)}`.trim();
  find("meaning", HTMLElement).textContent = `${field.name}: ${field.definition}.`;
  const stops = ramp(field.colours).join(", ");
  find("gradient", HTMLElement).style.background = `linear-gradient(to right, ${stops})`;
}

function fitToWindow() {
  layOut({ stage, views, overlay, charts, others }, windowHeight());
  showTime();
}

/** Shows the time that it is everywhere. */
function showTime() {
  const now = player.time;
  const slider = find("time", HTMLInputElement);
  slider.value = String(now);
  find("clock", HTMLOutputElement).textContent = `${now.toFixed(0)} ms`;
  const values = showValues(charts, now);
  if (moreCurves.open) showValues(others, now);
  slider.setAttribute("aria-valuetext", `${now.toFixed(0)} ms: ${values.join("; ")}`);
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

function drawForPaper() {
  drawStills(stills, views, field, player.start);
}

function sayHowDrawn() {
  const { spacing_um: spacing, accuracy_um: accuracy } = runs[0].cell;
  find("drawn", HTMLElement).textContent =
    `Drawn on squares of ${number(spacing)} ${unitText("um")}; positions are right to ` +
    `${number(accuracy)} ${unitText("um")}. Curves and numbers are those of the run itself.`;
}
