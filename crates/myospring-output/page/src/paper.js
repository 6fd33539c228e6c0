// What paper has instead of the animation.

import { CellView } from "./cell-view.js";
import { peakOf } from "./curves.js";
import { Sheet } from "./drawing.js";
import { find, make } from "./elements.js";
import { fitCharts, heightOfCharts } from "./layout.js";

/** @import { ShownChart } from "./charts.js" */
/** @import { Shapes } from "./data.js" */
/** @import { Box } from "./drawing.js" */
/** @import { OverlayView } from "./overlay-view.js" */
/** @import { Field, Run } from "./payload.js" */

/** Ink on paper that is printed. */
const PRINTED = { line: "#1a1d21", muted: "#555d68", paper: "#ffffff" };
/** Height of a plot on paper and width of all, px. */
const PAPER = { width: 660, plot: 76 };

/**
 * A cell at one time.
 *
 * @typedef {object} Still
 * @property {CellView} view
 * @property {number} time ms.
 * @property {number} run
 */

/**
 * The canvases that paper has instead of the animation: cells at rest and at their peak.
 *
 * @param {Run[]} runs
 * @param {Shapes[]} cells
 * @param {Box[]} boxes
 * @param {number} start First time, ms.
 * @param {((canvas: HTMLCanvasElement) => OverlayView) | null} overlayOn Of several runs.
 */
export function addStills(runs, cells, boxes, start, overlayOn) {
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
  if (overlayOn !== null) {
    for (const [caption, times] of /** @type {[string, number[]][]} */ ([
      ["all at rest", runs.map(() => start)],
      ["each at its peak", peaks],
    ])) {
      const view = overlayOn(add(caption));
      size(view);
      view.draw(times, PRINTED);
    }
  }
  return runs.flatMap((run, index) =>
    /** @type {[string, number][]} */ ([
      ["at rest", start],
      ["at its peak", peaks[index]],
    ]).map(([name, time]) => {
      const of = runs.length === 1 ? "" : `${run.label}, `;
      const view = new CellView(add(`${of}${name}, ${time.toFixed(0)} ms`), cells[index], boxes[index], null);
      size(view);
      return { view, time, run: index };
    }),
  );
}

/**
 * Draws the cells for paper; at rest, where no colour says anything, on its picture.
 *
 * @param {Still[]} stills
 * @param {CellView[]} views On the screen.
 * @param {Field} field
 * @param {number} start First time, ms.
 */
export function drawStills(stills, views, field, start) {
  for (const { view, time, run } of stills) {
    view.photograph = views[run].photograph;
    const photograph = view.photograph !== null && time === start;
    view.draw(time, field, { ink: PRINTED, photograph, opacity: photograph ? 0 : 1 });
  }
}

/**
 * Charts fit the paper, and what is folded is unfolded, but for curves of which there are many.
 *
 * @param {ShownChart[]} charts
 * @param {() => void} before
 * @param {() => void} after
 */
export function setUpPrinting(charts, before, after) {
  /** @type {HTMLDetailsElement[]} */
  let opened = [];
  addEventListener("beforeprint", () => {
    before();
    opened = [...document.querySelectorAll("details")].filter(({ open, id }) => !open && id !== "more-curves");
    for (const details of opened) details.open = true;
    const columns = charts.length > 3 ? 2 : 1;
    fitCharts(find("charts", HTMLElement), charts, PAPER.width, columns, heightOfCharts(charts, columns, PAPER.plot));
    charts.forEach(({ chart }) => chart.redraw());
  });
  addEventListener("afterprint", () => {
    for (const details of opened) details.open = false;
    after();
    charts.forEach(({ chart }) => chart.redraw());
  });
}
