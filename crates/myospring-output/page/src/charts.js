// Charts in the page: those that share the time of the player, those with a time axis of their own, and the legend.

import { lineOf } from "./colours.js";
import { Chart, valueAt } from "./curves.js";
import { draw, find, make } from "./elements.js";
import { quantity } from "./numbers.js";

/** @import { Cell, ChartData } from "./payload.js" */
/** @import { Player } from "./player.js" */

/**
 * A chart in the page.
 *
 * @typedef {object} ShownChart
 * @property {Chart} chart
 * @property {HTMLElement} element
 * @property {HTMLElement} axis The words below its time axis.
 * @property {HTMLElement} now The values of now.
 */

/** Largest number of runs for which a chart shows the current values beside its name. */
const TOLD = 4;

/**
 * The place of a chart: its name, its values, how to read it, its plot, its axis.
 *
 * @param {string} note
 */
function placeFor(note) {
  const now = make("span", { class: "now", "aria-hidden": "true" });
  const title = make("h3", {}, "", now);
  if (note !== "") title.append(make("span", { class: "in-band", title: note }, note));
  const figure = make("div", { class: "plot", role: "img" });
  const axis = make("p", { class: "axis" }, "Time (ms)");
  return { now, title, figure, axis, element: make("div", { class: "chart" }, title, figure, axis) };
}

/**
 * Charts that share the time of a player.
 *
 * @param {ChartData[]} charts
 * @param {number[][]} lists Of times.
 * @param {Player} player
 * @returns {ShownChart[]}
 */
export function chartsIn(charts, lists, player) {
  return charts.map((data) => {
    const { now, title, figure, axis, element } = placeFor(data.note);
    const chart = new Chart(figure, data, lists, [player.start, player.end]);
    title.prepend(chart.heading);
    figure.setAttribute("aria-label", chart.description);
    followPointer(chart, player);
    return { chart, element, axis, now };
  });
}

/** Height of a plot with a time axis of its own, px. */
const OWN_HEIGHT = 150;

/** A chart with a time axis of its own. It is drawn when it is first seen. */
export class OwnChart {
  /** @type {ChartData} */
  #data;
  /** @type {number[][]} */
  #lists;
  /** @type {ReturnType<typeof placeFor>} */
  #place;
  /** @type {Chart | null} */
  #chart = null;

  /**
   * @param {ChartData} data
   * @param {number[][]} lists Of times.
   */
  constructor(data, lists) {
    this.#data = data;
    this.#lists = lists;
    this.#place = placeFor(data.note);
    this.element = this.#place.element;
    new ResizeObserver(() => this.show()).observe(this.element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#chart?.redraw());
  }

  /** Fits it to its place, or to a width, px. */
  show(width = this.element.clientWidth) {
    if (width === 0) return;
    this.#chart ??= this.#draw();
    this.#chart.resize(width, OWN_HEIGHT, true);
  }

  /** Draws it in the colours of now. */
  redraw() {
    this.#chart?.redraw();
  }

  #draw() {
    const { now, title, figure, axis } = this.#place;
    const chart = new Chart(figure, this.#data, this.#lists, null);
    if (chart.perUnit > 1) axis.textContent = "Time (s)";
    title.prepend(chart.heading);
    figure.setAttribute("aria-label", chart.description);
    const runs = this.#data.series.filter(({ tone }) => /^\d+$/.test(tone));
    const entries = runs.map(({ label, tone }) => make("li", {}, swatch(Number(tone)), label));
    if (runs.length > 1) this.element.append(make("ul", { class: "legend" }, ...entries));
    chart.over.addEventListener("pointermove", (event) => {
      const time = chart.timeAt(event.clientX);
      const values = chart.series.map((series) => quantity(valueAt(series, time), chart.data.unit));
      now.textContent = `${quantity(time / chart.perUnit, chart.perUnit > 1 ? "s" : "ms")}: ${values.slice(-1).join("")}`;
    });
    chart.over.addEventListener("pointerleave", () => (now.textContent = ""));
    return chart;
  }
}

/**
 * Moves charts to a time.
 *
 * @param {ShownChart[]} charts
 * @param {number} time ms.
 * @returns {string[]} Their values in words.
 */
export function showValues(charts, time) {
  return charts.map(({ chart, now }) => {
    chart.setTime(time);
    const text = chart.series.map((series) => quantity(valueAt(series, time), chart.data.unit));
    now.textContent = text.length > TOLD ? "" : text.join(" / ");
    return `${chart.data.name} ${text.join(", ")}`;
  });
}

/** @param {Cell[]} cells */
export function writeLegend(cells) {
  const legend = find("legend", HTMLElement);
  cells.forEach(({ label }, index) => legend.append(make("li", {}, swatch(index), label)));
  legend.hidden = false;
}

/**
 * The line of a run, as the charts draw it.
 *
 * @param {number} index
 */
function swatch(index) {
  const { colour, dash } = lineOf(index);
  const line = { d: "M0 4h36", "stroke-width": 2.5, "stroke-dasharray": dash.join(" ") };
  const path = draw("path", line);
  path.style.stroke = `var(${colour})`;
  return draw("svg", { viewBox: "0 0 36 8", class: "swatch", "aria-hidden": "true" }, path);
}

/**
 * A pointer over a chart takes the time with it; a click stops there.
 *
 * @param {Chart} chart
 * @param {Player} player
 */
function followPointer(chart, player) {
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
