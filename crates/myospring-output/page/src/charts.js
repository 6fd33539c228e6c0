// The charts of a page and their legend.

import { lineOf } from "./colours.js";
import { Chart, chartsOf, chartsOfFit, valueAt } from "./curves.js";
import { find, make } from "./elements.js";
import { quantity } from "./numbers.js";

/** @import { ChartData } from "./curves.js" */
/** @import { Payload } from "./payload.js" */
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
/** Up to this number of further curves of the cell model, all are shown from the start; of more only the first. */
const SIGNALS = 3;

/**
 * The charts that lead, and those that are folded.
 *
 * @param {Payload} payload
 * @param {Player} player
 * @param {(name: string) => string} colour
 */
export function makeCharts({ runs, fit }, player, colour) {
  const ofRuns = chartsOf(
    runs.map((run, index) => ({ ...run.curves, ...run, ...lineOf(index) })),
    (key, isSignal) => (isSignal ? "--signal" : `--${key}`),
  );
  const ofFit = fit === null ? [] : chartsOfFit(fit.curves, runs[0]);
  const signals = ofRuns.filter(({ isSignal }) => isSignal);
  const folded = signals.length > SIGNALS ? signals.slice(1) : [];
  const leading = [...ofFit, ...ofRuns.filter((data) => !folded.includes(data))];
  if (leading.some(({ missed_ms: missed }) => missed.length > 0)) {
    const inAll = runs.length > 1 ? " in every run" : "";
    leading[0].note = [leading[0].note, `\u25bc stimulus, \u25bd not captured${inAll}`].filter((part) => part !== "").join("; ");
  }
  const palette = {
    ink: () => colour("--muted"),
    grid: () => colour("--grid"),
    band: () => colour("--band"),
    paper: () => colour("--paper"),
    curve: colour,
  };
  const show = (/** @type {ChartData} */ data) => {
    const now = make("span", { class: "now", "aria-hidden": "true" });
    const title = make("h3", {}, "", now);
    if (data.note !== "") title.append(make("span", { class: "in-band" }, data.note));
    const figure = make("div", { class: "plot", role: "img" });
    const axis = make("p", { class: "axis" }, "Time (ms)");
    const element = make("div", { class: "chart" }, title, figure, axis);
    const chart = new Chart(figure, data, [player.start, player.end], palette);
    title.prepend(chart.heading);
    figure.setAttribute("aria-label", chart.description);
    followPointer(chart, player);
    return { chart, element, axis, now };
  };
  return { charts: leading.map(show), others: folded.map(show) };
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
    const text = chart.data.series.map((series) => quantity(valueAt(series, time), chart.data.unit));
    now.textContent = text.length > TOLD ? "" : text.join(" / ");
    return `${chart.data.name} ${text.join(", ")}`;
  });
}

/** @param {Payload} payload */
export function writeLegend({ runs }) {
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
