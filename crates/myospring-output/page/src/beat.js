// The beating cells with their curves: one time for all of them.

import { boxAround, CellView } from "./cell-view.js";
import { chartsIn, showValues, writeLegend } from "./charts.js";
import { colour, lineOf, ramp } from "./colours.js";
import { setUpControls } from "./controls.js";
import { Camera, letTurn } from "./camera.js";
import { recordedShapes, recordedSolid } from "./data.js";
import { find, isFramed, make, say, windowHeight, withCode } from "./elements.js";
import { layOut } from "./layout.js";
import { number, plain, quantity, unitText } from "./numbers.js";
import { OverlayView } from "./overlay-view.js";
import { addStills, drawStills, printCharts } from "./paper.js";
import { Player } from "./player.js";
import { SpaceView } from "./space-view.js";

/** @import { Shapes } from "./data.js" */
/** @import { Box, Ink } from "./drawing.js" */
/** @import { Beat, Cell, Field, Picture, Thick } from "./payload.js" */

/** Room around the cell, of its longer side. */
const ROOM = 0.02;

/**
 * What printing needs of a beat, and its end, which tells how it moved.
 *
 * @typedef {object} ShownBeat
 * @property {() => void} toPaper
 * @property {() => void} toScreen
 * @property {() => Motion} end
 */

/**
 * How a beat moves.
 *
 * @typedef {object} Motion
 * @property {number} time ms.
 * @property {boolean} playing
 * @property {number} speed
 * @property {boolean} loop
 * @property {string} colour What the cells are coloured by.
 * @property {string} seen From where: one of the options of `#view`.
 * @property {Camera} camera
 */

/**
 * Fills the stage of a page.
 *
 * @param {Beat} beat
 * @param {number[][]} lists Of times.
 * @param {Motion | null} motion Of the beat that was shown before.
 * @returns {ShownBeat}
 */
export function showBeat(beat, lists, motion) {
  const ending = new AbortController();
  const { signal } = ending;
  const alone = beat.cells.length === 1;
  const cells = beat.cells.map(recordedShapes);
  const player = new Player([
    Math.min(...cells.map((cell) => cell.span[0])),
    Math.max(...cells.map((cell) => cell.span[1])),
  ]);
  if (motion !== null) {
    player.time = Math.min(motion.time, player.end);
    [player.speed, player.loop] = [motion.speed, motion.loop];
  }
  const boxes = boxesOfOneSize(cells);
  const thick = beat.cells.flatMap((cell) => cell.thick ?? []);
  const isThick = thick.length === beat.cells.length;
  const seen = find("view", HTMLSelectElement);
  if (motion !== null) seen.value = motion.seen;
  const camera = motion?.camera ?? new Camera("space");
  const inSpace = () => isThick && seen.value !== "above";
  let fields = commonFields(inSpace() ? thick : beat.cells);
  let field = fields.find(({ key }) => key === (motion?.colour ?? beat.colour)) ?? fields[0];

  const opacity = find("opacity", HTMLInputElement);
  const pictureBox = find("picture", HTMLInputElement);
  const cellsPlace = find("cells", HTMLElement);
  const stage = find("stage", HTMLElement);
  const more = find("more-curves", HTMLDetailsElement);

  const overlay = alone ? null : overlayOn(addFigure("all overlaid"));
  const flatOn = (/** @type {HTMLCanvasElement} */ canvas, /** @type {number} */ index) => new CellView(canvas, cells[index], boxes[index], null);
  const solids = isThick ? thick.map(recordedSolid) : [];
  const solidOn = (/** @type {HTMLCanvasElement} */ canvas, /** @type {number} */ index) => new SpaceView(canvas, solids[index], camera, solids);
  const flat = beat.cells.map(({ label }, index) => flatOn(addFigure(label, alone ? "unseen" : ""), index));
  const solid = solids.map((_, index) => solidOn(addSpace(flat[index].canvas), index));
  let views = inSpace() ? solid : flat;
  const flatStills = addStills(beat.cells, flatOn, player.start, alone ? null : overlayOn);
  const solidStills = isThick ? addStills(beat.cells, solidOn, player.start, null) : [];
  const charts = chartsIn(beat.charts, lists, player);
  const others = chartsIn(beat.folded, lists, player);

  if (!alone) {
    writeLegend(beat.cells);
    stage.classList.add("compared");
    // The curves come first: they show the difference.
    stage.prepend(find("curves", HTMLElement), find("controls", HTMLElement));
  }
  beat.cells.forEach(({ picture }, index) => {
    if (picture !== null) loadPicture(picture, flat[index]);
  });
  setUpControls(player, signal);
  setUpColours();
  setUpSpace();
  more.hidden = others.length === 0;
  find("more-curves-title", HTMLElement).textContent = beat.folded_title;
  more.addEventListener("toggle", showTime);
  find("about", HTMLElement).append(...withCode(beat.words));
  find("about", HTMLElement).hidden = beat.words === "";
  player.addEventListener("state", describeCells);
  player.addEventListener("time", showTime);
  fitToWindow();
  drawForPaper();
  let laidOut = stage.clientWidth;
  const resized = new ResizeObserver(() => {
    if (stage.clientWidth === laidOut) return;
    laidOut = stage.clientWidth;
    fitToWindow();
  });
  resized.observe(stage);
  if (!isFramed) addEventListener("resize", fitToWindow, { signal });
  const redraw = () => {
    drawCells();
    redrawCharts();
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw, { signal });
  if (motion?.playing ?? !matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();

  return {
    end() {
      const { time, playing, speed, loop } = player;
      player.pause();
      ending.abort();
      resized.disconnect();
      [...charts, ...others].forEach(({ chart }) => chart.destroy());
      return { time, playing, speed, loop, colour: field.key, seen: seen.value, camera };
    },
    toPaper() {
      drawForPaper();
      printCharts(charts);
      redrawCharts();
    },
    toScreen() {
      fitToWindow();
      redrawCharts();
    },
  };

  function redrawCharts() {
    [...charts, ...others].forEach(({ chart }) => chart.redraw());
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
    find("picture-choice", HTMLElement).hidden = inSpace();
    // The bar is higher now.
    fitToWindow();
    drawForPaper();
  }

  /** What the cell is coloured by. */
  function setUpColours() {
    const select = find("field", HTMLSelectElement);
    select.addEventListener("change", () => {
      field = fields.find((each) => each.key === select.value) ?? field;
      showScale();
      drawCells();
    });
    for (const input of [opacity, pictureBox]) input.addEventListener("input", drawCells);
  }

  function offerColours() {
    const select = find("field", HTMLSelectElement);
    select.replaceChildren(...fields.map((each) => make("option", { value: each.key }, each.name)));
    select.value = field.key;
    showScale();
    sayHowDrawn();
  }

  /** A canvas that turns, beside that of the cell seen from above. @param {HTMLCanvasElement} above */
  function addSpace(above) {
    const about = { role: "application", "aria-roledescription": "cell that turns", "aria-describedby": "turn-help", tabindex: "0" };
    const canvas = make("canvas", { ...about, class: "turns" });
    above.after(canvas);
    letTurn(canvas, camera);
    return canvas;
  }

  /** What thick cells have in addition: the choice from where they are seen. */
  function setUpSpace() {
    find("view-choice", HTMLElement).hidden = !isThick;
    const choose = () => {
      views = inSpace() ? solid : flat;
      fields = commonFields(inSpace() ? thick : beat.cells);
      field = fields.find(({ key }) => key === field.key) ?? fields[0];
      for (const { canvas } of flat) canvas.hidden = inSpace();
      for (const { canvas } of solid) canvas.hidden = !inSpace();
      find("turn-help", HTMLElement).hidden = find("reset-view", HTMLElement).hidden = !inSpace();
      find("picture-choice", HTMLElement).hidden = inSpace() || flat.every(({ photograph }) => photograph === null);
      offerColours();
    };
    choose();
    seen.addEventListener("change", () => {
      if (inSpace()) camera.stand(seen.value);
      choose();
      fitToWindow();
    });
    find("reset-view", HTMLButtonElement).addEventListener("click", () => {
      // A cell that is cut stays so.
      if (camera.section === null) seen.value = "space";
      camera.stand(seen.value);
    });
    const turned = () => {
      if (inSpace() && camera.section === null && !camera.standsAt(seen.value)) seen.value = "space";
      drawCells();
      if (!player.playing) describeCells();
    };
    camera.addEventListener("turn", turned, { signal });
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
    if (more.open) showValues(others, now);
    slider.setAttribute("aria-valuetext", `${now.toFixed(0)} ms: ${values.join("; ")}`);
    drawCells();
    if (!player.playing) describeCells();
  }

  /** What a screen reader says of the cells; not while they move. */
  function describeCells() {
    overlay?.canvas.setAttribute(
      "aria-label",
      `Outlines of all cells overlaid, ${player.playing ? "beating" : `at ${player.time.toFixed(0)} ms`}`,
    );
    views.forEach((view, index) => {
      const of = alone ? "The cell" : beat.cells[index].label;
      const [least, most] = view.extremes();
      const size = view instanceof SpaceView ? `${view.size}, ` : "";
      const now = player.playing
        ? "beating"
        : `at ${player.time.toFixed(0)} ms, ${size}${field.name} ${number(least)} to ${quantity(most, field.unit)}`;
      view.canvas.setAttribute("aria-label", `${of}, ${now}`);
    });
  }

  function drawCells() {
    const lines = ink();
    overlay?.draw(cells.map(() => player.time), lines);
    views.forEach((view) => {
      const photograph = view.photograph !== null && pictureBox.checked;
      view.draw(player.time, field, { ink: lines, photograph, opacity: photograph ? Number(opacity.value) : 1 });
    });
    const [least, most] = views[0].extremes();
    cellsPlace.dataset.least = String(least);
    cellsPlace.dataset.most = String(most);
  }

  function drawForPaper() {
    const shown = inSpace() ? solidStills : flatStills;
    [...flatStills, ...solidStills].forEach(({ figure }) => figure.remove());
    find("stills", HTMLElement).append(...shown.map(({ figure }) => figure));
    drawStills(shown, views, field, player.start);
  }

  function sayHowDrawn() {
    const { spacing_um: spacing, accuracy_um: accuracy } = (inSpace() ? thick : beat.cells)[0];
    find("rest-line", HTMLElement).textContent = `${inSpace() ? "Grey" : "Dotted"}: the cell at rest.`;
    find("drawn", HTMLElement).textContent =
      `Drawn on ${inSpace() ? "a smoothed surface with patches" : "squares"} of ${number(spacing)} ${unitText("um")}; positions are accurate to ` +
      `${number(accuracy)} ${unitText("um")}. Curves and numbers do not depend on this.`;
  }
}

/**
 * The box around each cell, with some room: all as large as the largest, so that all have one scale.
 *
 * @param {Shapes[]} cells
 */
function boxesOfOneSize(cells) {
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

/** Colours of lines on the screen. @returns {Ink} */
function ink() {
  return { line: colour("--ink"), muted: colour("--muted"), paper: colour("--paper") };
}

/**
 * The fields that every cell has, on one scale.
 *
 * @param {(Cell | Thick)[]} cells
 * @returns {Field[]}
 */
function commonFields(cells) {
  return cells[0].fields.flatMap((first) => {
    const all = cells.map((cell) => cell.fields.find((other) => other.key === first.key));
    const low = Math.min(...all.map((each) => each?.low ?? NaN));
    const high = Math.max(...all.map((each) => each?.high ?? NaN));
    return Number.isFinite(low + high) ? [{ ...first, low, high }] : [];
  });
}
