// Curves over time, drawn by uPlot, with a cursor that is the time of the player.

import uPlot from "uplot";
import { lastBefore } from "./data.js";
import { quantity, unitText } from "./numbers.js";

/** @import { Band, Curve, FittedCurve } from "./payload.js" */

/**
 * One curve of a chart.
 *
 * @typedef {object} Series
 * @property {string} label
 * @property {string} colour Name of a colour of the style sheet.
 * @property {number[]} dash
 * @property {boolean} [dots] Points without a line: what was measured.
 * @property {number[]} t_ms
 * @property {(number | null)[]} values
 */

/**
 * One chart: a quantity of one run or of several.
 *
 * @typedef {object} ChartData
 * @property {string} name
 * @property {string} unit
 * @property {Band | null} band
 * @property {string} note What is to be known of what is drawn; empty where nothing is.
 * @property {Series[]} series
 * @property {number[]} stimuli_ms Those that each run captured, or may have.
 * @property {number[]} missed_ms Those that a run did not.
 * @property {boolean} isSignal Whether it is one of the cell model's own, beside potential, tension and shortening.
 */

/**
 * @typedef {object} Palette
 * @property {() => string} ink Of the axes' text.
 * @property {() => string} grid
 * @property {() => string} band
 * @property {() => string} paper
 * @property {(name: string) => string} curve The colour that a name stands for.
 */

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
   * @param {[number, number]} span First and last time, ms.
   * @param {Palette} palette
   */
  constructor(place, data, span, palette) {
    this.data = data;
    const columns = data.series.map(
      ({ t_ms, values }) => /** @type {uPlot.AlignedData} */ ([t_ms, values]),
    );
    const joined = columns.length === 1 ? columns[0] : uPlot.join(columns);
    const text = "12px system-ui, sans-serif";
    const axis = {
      stroke: palette.ink,
      font: text,
      labelFont: text,
      grid: { stroke: palette.grid, width: 1 },
      ticks: { stroke: palette.grid, width: 1, size: 4 },
    };
    this.#plot = new uPlot(
      {
        width: Math.max(place.clientWidth, 50),
        height: Chart.LEAST,
        padding: [8, 18, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: {
          x: { time: false, range: () => span },
          y: { range: (_, low, high) => Chart.rangeOf(low, high, data.band) },
        },
        axes: [
          {
            ...axis,
            size: () => (this.#labelled ? Chart.AXIS : 8),
            values: (_, ticks) => (this.#labelled ? tickTexts(ticks) : ticks.map(() => "")),
          },
          { ...axis, size: 52, space: 26, values: (_, ticks) => tickTexts(ticks) },
        ],
        series: [
          {},
          ...data.series.map(({ label, colour, dash, dots }) => ({
            label,
            stroke: () => palette.curve(colour),
            dash,
            width: dots ? 0 : 2,
            spanGaps: false,
            points: dots
              ? { show: true, size: 3.5, width: 0, fill: () => palette.curve(colour) }
              : { show: false },
          })),
        ],
        hooks: { drawClear: [(/** @type {uPlot} */ plot) => this.#underlay(plot, palette)] },
      },
      joined,
      place,
    );
    this.#cursor.className = "time-cursor";
    this.#plot.over.append(this.#cursor);
  }

  /**
   * @param {number} low
   * @param {number} high
   * @param {Band | null} band
   * @returns {[number, number]}
   */
  static rangeOf(low, high, band) {
    const top = Math.max(high, band === null ? high : band.high);
    const bottom = Math.min(low, band === null ? low : band.low);
    const gap = top - bottom || Math.abs(top) || 1;
    return [bottom - 0.04 * gap, top + 0.08 * gap];
  }

  /**
   * What lies under the curves: the band that is seen in experiments, the stimuli.
   *
   * @param {uPlot} plot
   * @param {Palette} palette
   */
  #underlay(plot, palette) {
    const { ctx: pen, bbox } = plot;
    pen.save();
    if (this.data.band !== null) {
      const top = plot.valToPos(this.data.band.high, "y", true);
      const bottom = plot.valToPos(this.data.band.low, "y", true);
      pen.fillStyle = palette.band();
      pen.fillRect(bbox.left, top, bbox.width, bottom - top);
    }
    pen.strokeStyle = palette.ink();
    pen.lineWidth = devicePixelRatio;
    for (const stimulus of this.data.stimuli_ms) this.#stimulus(plot, stimulus, palette.ink(), [4, 4]);
    for (const stimulus of this.data.missed_ms) this.#stimulus(plot, stimulus, palette.paper(), [1, 5]);
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

  /** What it shows, in a sentence. */
  get description() {
    const peaks = this.data.series.map((series) => {
      const { time, value } = peakOf(series);
      const of = this.data.series.length > 1 ? `${series.label}: ` : "";
      return `${of}peak ${quantity(value, this.data.unit)} at ${quantity(time, "ms")}`;
    });
    return `${this.data.name} over time. ${peaks.join("; ")}`;
  }

  /** Its heading: name and unit. */
  get heading() {
    return this.data.unit === "" ? this.data.name : `${this.data.name} (${unitText(this.data.unit)})`;
  }
}

/**
 * What was measured and what was fitted to it, and below it the residual: two charts for each curve.
 *
 * @param {FittedCurve[]} curves
 * @param {{ stimuli_ms: number[], missed_ms: number[] }} run Of the fitted cell.
 * @returns {ChartData[]}
 */
export function chartsOfFit(curves, { stimuli_ms, missed_ms }) {
  return curves.flatMap(({ label, unit, t_ms, measured, left_out: leftOut, fitted, residual, noise }) => {
    const dots = { dash: [], dots: true, t_ms };
    const bad = leftOut.some((value) => value !== null);
    const shown = unit === "" ? label : label.replace(/ \([^)]*\)$/, "");
    return [
      {
        name: shown,
        unit,
        band: null,
        note: `dots: measured, line: fitted${bad ? ", orange dots: left out" : ""}`,
        series: [
          { ...dots, label: "measured", colour: "--measured", values: measured },
          ...(bad ? [{ ...dots, label: "left out", colour: "--tension", values: leftOut }] : []),
          { label: "fitted", colour: "--shortening", dash: [], t_ms, values: fitted },
        ],
        isSignal: false,
        stimuli_ms,
        missed_ms,
      },
      {
        name: curves.length > 1 ? `${shown}, residual` : "Residual",
        unit,
        band: { low: -noise, high: noise, scope: "" },
        note: "measured \u2212 fitted, grey: noise",
        series: [{ ...dots, label: "residual", colour: "--measured", values: residual }],
        isSignal: false,
        stimuli_ms,
        missed_ms,
      },
    ];
  });
}

/** @param {string} key Of a curve. */
const isSignal = (key) => !["potential", "tension", "shortening"].includes(key);

/**
 * The curves of several runs, one chart for each quantity that the first run has.
 *
 * @param {{
 *   label: string, colour: string, dash: number[], t_ms: number[], list: Curve[],
 *   stimuli_ms: number[], missed_ms: number[],
 * }[]} runs
 * @param {(key: string, isSignal: boolean) => string} colourOf Of a quantity, where there is one run.
 * @returns {ChartData[]}
 */
export function chartsOf(runs, colourOf) {
  const stimuli = [...new Set(runs.flatMap((run) => run.stimuli_ms))];
  const missed = [...new Set(runs.flatMap((run) => run.missed_ms))];
  return runs[0].list.map(({ key, name, unit, band }) => ({
    name,
    unit,
    band,
    note: band === null ? "" : `grey: measured peaks, ${band.low} to ${band.high} ${unit}`,
    isSignal: isSignal(key),
    stimuli_ms: stimuli.filter((time) => !missed.includes(time)),
    missed_ms: missed,
    series: runs.flatMap(({ label, colour, dash, t_ms, list }) => {
      const curve = list.find((other) => other.key === key && other.unit === unit);
      if (curve === undefined) return [];
      const own = runs.length === 1 ? colourOf(key, isSignal(key)) : colour;
      return [{ label, colour: own, dash, t_ms, values: curve.values }];
    }),
  }));
}
