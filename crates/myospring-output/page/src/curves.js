// Curves over time, drawn by uPlot, with a cursor that is the time of the player.

import uPlot from "uplot";
import { colour, lineOf } from "./colours.js";
import { lastBefore } from "./data.js";
import { quantity, unitText } from "./numbers.js";

/** @import { ChartData } from "./payload.js" */

/**
 * One curve of a chart.
 *
 * @typedef {object} Line
 * @property {string} label
 * @property {string} stroke Name of a colour of the style sheet.
 * @property {number[]} dash
 * @property {boolean} dotted
 * @property {number[]} t_ms
 * @property {(number | null)[]} values
 */

/** Recordings longer than this have their times in s where they have an axis of their own, ms. */
const LONG = 3000;
/** Radius of a dot, px, and the room for words above and below it, of the height. */
const DOT = 2.5;
const ROOM_FOR_WORDS = 0.12;

/**
 * The value of a curve at a time, on a straight line between its samples.
 *
 * @param {{ t_ms: number[], values: (number | null)[] }} curve
 * @param {number} time ms.
 */
export function valueAt({ t_ms: times, values }, time) {
  const last = lastBefore(times, time);
  const next = Math.min(last + 1, times.length - 1);
  const [from, to] = [values[last], values[next]];
  if (from === null || to === null || from === undefined || to === undefined) return null;
  const gap = times[next] - times[last];
  return gap > 0 ? from + Math.min(Math.max((time - times[last]) / gap, 0), 1) * (to - from) : from;
}

/**
 * The highest point of a curve.
 *
 * @param {{ t_ms: number[], values: (number | null)[] }} curve
 */
export function peakOf({ t_ms: times, values }) {
  let best = { time: times[0] ?? 0, value: values[0] ?? null };
  values.forEach((value, index) => {
    if (value !== null && (best.value === null || value > best.value)) {
      best = { time: times[index], value };
    }
  });
  return best;
}

/**
 * Numbers beside an axis, short enough for its room.
 *
 * @param {number[]} ticks Equally far apart.
 */
export function tickTexts(ticks) {
  const most = Math.max(...ticks.map(Math.abs));
  const power = most >= 1e5 || (most > 0 && most < 1e-3) ? Math.floor(Math.log10(most)) : 0;
  return ticks.map((tick) => {
    const mantissa = String(Number((tick / 10 ** power).toPrecision(6))).replace("-", "\u2212");
    return power === 0 || tick === 0 ? mantissa : `${mantissa}e${power}`.replace("-", "\u2212");
  });
}

/** A chart in an element of its own. */
export class Chart {
  /** Least height of a plot, px, and what the numbers of its time axis take. */
  static LEAST = 76;
  static AXIS = 26;

  #plot;
  #labelled = true;
  #cursor = document.createElement("div");

  /**
   * @param {HTMLElement} place
   * @param {ChartData} data
   * @param {number[][]} lists Of times.
   * @param {[number, number] | null} span First and last time, ms; without it the chart has its own time axis, on which a
   *   reader enlarges a part.
   */
  constructor(place, data, lists, span) {
    this.data = data;
    /** @type {Line[]} */
    this.series = data.series.map(({ label, tone, dotted, times, values }) => {
      const run = /^\d+$/.test(tone) ? lineOf(Number(tone)) : { colour: `--${tone}`, dash: [] };
      return { label, stroke: run.colour, dash: run.dash, dotted, t_ms: lists[times], values };
    });
    const columns = this.series.map(({ t_ms, values }) => /** @type {uPlot.AlignedData} */ ([t_ms, values]));
    const joined = columns.length === 1 ? columns[0] : uPlot.join(columns);
    const times = /** @type {number[]} */ (joined[0]);
    /** How many ms a unit of the time axis has. */
    this.perUnit = span === null && times[times.length - 1] - times[0] > LONG ? 1000 : 1;
    const text = "12px system-ui, sans-serif";
    const axis = {
      stroke: () => colour("--muted"),
      font: text,
      labelFont: text,
      grid: { stroke: () => colour("--grid"), width: 1 },
      ticks: { stroke: () => colour("--grid"), width: 1, size: 4 },
    };
    this.#plot = new uPlot(
      {
        width: Math.max(place.clientWidth, 50),
        height: Chart.LEAST,
        padding: [8, 18, 0, 0],
        legend: { show: false },
        cursor: span === null ? { y: false, points: { show: false }, drag: { x: true, y: false } } : { show: false },
        scales: {
          x: { time: false, range: (_, low, high) => span ?? [low, high] },
          y: { range: (_, low, high) => this.#range(low, high) },
        },
        axes: [
          {
            ...axis,
            size: () => (this.#labelled ? Chart.AXIS : 8),
            values: (_, ticks) => (this.#labelled ? tickTexts(ticks.map((tick) => tick / this.perUnit)) : ticks.map(() => "")),
          },
          { ...axis, size: 52, space: 26, values: (_, ticks) => tickTexts(ticks) },
        ],
        series: [
          {},
          ...this.series.map(({ label, stroke, dash, dotted }) => ({
            label,
            stroke: () => colour(stroke),
            dash,
            width: dotted ? 0 : stroke === "--raw" ? 1 : 2,
            spanGaps: false,
            points: dotted ? { show: true, size: 3.5, width: 0, fill: () => colour(stroke) } : { show: false },
          })),
        ],
        hooks: {
          drawClear: [(/** @type {uPlot} */ plot) => this.#underlay(plot)],
          draw: [(/** @type {uPlot} */ plot) => this.#dots(plot)],
        },
      },
      joined,
      place,
    );
    if (span === null) return;
    this.#cursor.className = "time-cursor";
    this.#plot.over.append(this.#cursor);
  }

  /**
   * @param {number} low
   * @param {number} high
   * @returns {[number, number]}
   */
  #range(low, high) {
    const { band, dots } = this.data;
    const top = Math.max(high, band === null ? high : band[1]);
    const bottom = Math.min(low, band === null ? low : band[0]);
    const gap = top - bottom || Math.abs(top) || 1;
    const words = dots.some((dot) => dot.words !== "") ? ROOM_FOR_WORDS : 0;
    return [bottom - (0.04 + words) * gap, top + (0.08 + words) * gap];
  }

  /**
   * What lies under the curves: the band, parts of the time, the stimuli.
   *
   * @param {uPlot} plot
   */
  #underlay(plot) {
    const { ctx: pen, bbox } = plot;
    const { band, spans, stimuli_ms: stimuli, missed_ms: missed } = this.data;
    pen.save();
    if (band !== null) {
      const [bottom, top] = band.map((end) => plot.valToPos(end, "y", true));
      pen.fillStyle = colour("--band");
      pen.fillRect(bbox.left, top, bbox.width, bottom - top);
    }
    pen.fillStyle = colour("--span");
    for (const { from_ms: from, to_ms: to } of spans) {
      const ends = [from, to].map((time) => plot.valToPos(time, "x", true));
      const [left, right] = ends.map((end) => Math.min(Math.max(end, bbox.left), bbox.left + bbox.width));
      // As wide as can be seen, if it is in the part that is shown.
      if (right > bbox.left && left < bbox.left + bbox.width) {
        pen.fillRect(left, bbox.top, Math.max(right - left, 2 * devicePixelRatio), bbox.height);
      }
    }
    pen.strokeStyle = colour("--muted");
    pen.lineWidth = devicePixelRatio;
    for (const time of stimuli) this.#stimulus(plot, time, colour("--muted"), [4, 4]);
    for (const time of missed) this.#stimulus(plot, time, colour("--paper"), [1, 5]);
    pen.restore();
  }

  /**
   * Places on the curve, with their words above or below them.
   *
   * @param {uPlot} plot
   */
  #dots(plot) {
    const { ctx: pen, bbox } = plot;
    const pixel = devicePixelRatio;
    pen.save();
    pen.font = `${11 * pixel}px system-ui, sans-serif`;
    pen.lineJoin = "round";
    for (const { t_ms: time, value, words, side, counts } of this.data.dots) {
      const [x, y] = [plot.valToPos(time, "x", true), plot.valToPos(value, "y", true)];
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      pen.fillStyle = colour(counts ? "--ink" : "--muted");
      pen.beginPath();
      pen.arc(x, y, DOT * pixel, 0, 2 * Math.PI);
      pen.fill();
      pen.textAlign = side === "left" ? "right" : side === "right" ? "left" : "center";
      const [right, down] = side === "out" ? [0, y < bbox.top + bbox.height / 2 ? -6 : 14] : [side === "left" ? -7 : 7, 4];
      // On a noisy curve words need paper around them.
      pen.strokeStyle = colour("--paper");
      pen.lineWidth = 3 * pixel;
      pen.strokeText(words, x + right * pixel, y + down * pixel);
      pen.fillText(words, x + right * pixel, y + down * pixel);
    }
    pen.restore();
  }

  /**
   * A line through the plot and a small triangle above it.
   *
   * @param {uPlot} plot
   * @param {number} time ms.
   * @param {string} filling Of the triangle.
   * @param {number[]} dash Of the line, px.
   */
  #stimulus(plot, time, filling, dash) {
    const { ctx: pen, bbox } = plot;
    const pixel = devicePixelRatio;
    const x = plot.valToPos(time, "x", true);
    if (x < bbox.left || x > bbox.left + bbox.width) return;
    pen.setLineDash(dash.map((length) => length * pixel));
    pen.beginPath();
    pen.moveTo(x, bbox.top);
    pen.lineTo(x, bbox.top + bbox.height);
    pen.stroke();
    pen.setLineDash([]);
    pen.beginPath();
    pen.moveTo(x, bbox.top);
    pen.lineTo(x - 4 * pixel, bbox.top - 7 * pixel);
    pen.lineTo(x + 4 * pixel, bbox.top - 7 * pixel);
    pen.closePath();
    pen.fillStyle = filling;
    pen.fill();
    pen.stroke();
  }

  /** The element over which a pointer moves. */
  get over() {
    return this.#plot.over;
  }

  /** @param {number} x Of a pointer, px of the page. */
  timeAt(x) {
    return this.#plot.posToVal(x - this.#plot.over.getBoundingClientRect().left, "x");
  }

  /** @param {number} time ms. */
  setTime(time) {
    const left = this.#plot.valToPos(time, "x");
    this.#cursor.style.transform = `translateX(${left}px)`;
  }

  /**
   * @param {number} width px.
   * @param {number} height Without the numbers of the time axis, px.
   * @param {boolean} labelled Whether the time axis has numbers.
   */
  resize(width, height, labelled) {
    const all = Math.round(height) + (labelled ? Chart.AXIS : 0);
    if (width !== this.#plot.width || all !== this.#plot.height || labelled !== this.#labelled) {
      this.#labelled = labelled;
      this.#plot.setSize({ width, height: all });
    }
  }

  /** Draws it anew, in the colours of now. */
  redraw() {
    this.#plot.redraw(false, true);
  }

  /** Ends what it listens to. */
  destroy() {
    this.#plot.destroy();
  }

  /** What it shows, in a sentence. */
  get description() {
    const peaks = this.series.map((series) => {
      const { time, value } = peakOf(series);
      const of = this.series.length > 1 ? `${series.label}: ` : "";
      return `${of}peak ${quantity(value, this.data.unit)} at ${quantity(time, "ms")}`;
    });
    return `${this.data.name} over time. ${peaks.join("; ")}`;
  }

  /** Its heading: name and unit. */
  get heading() {
    return this.data.unit === "" ? this.data.name : `${this.data.name} (${unitText(this.data.unit)})`;
  }
}
