// What paper has instead of what moves.

import { Sheet } from "./drawing.js";
import { find, make } from "./elements.js";
import { fitCharts, heightOfCharts } from "./layout.js";

/** @import { ShownBeat } from "./beat.js" */
/** @import { OwnChart, ShownChart } from "./charts.js" */
/** @import { CellView } from "./cell-view.js" */
/** @import { SpaceView } from "./space-view.js" */
/** @import { OverlayView } from "./overlay-view.js" */
/** @import { Cell, Field } from "./payload.js" */

/** Ink on paper that is printed. */
const PRINTED = { line: "#1a1d21", muted: "#555d68", paper: "#ffffff" };
/** Height of a plot on paper, width of all and of one of two beside each other, px. */
const PAPER = { width: 660, plot: 76, half: 318 };

/**
 * A cell at one time.
 *
 * @typedef {object} Still
 * @property {CellView | SpaceView} view
 * @property {HTMLElement} figure
 * @property {number} time ms.
 * @property {number} cell Which.
 */

/**
 * The canvases that paper has instead of the animation: cells at rest and at their peak.
 *
 * @param {Cell[]} cells
 * @param {(canvas: HTMLCanvasElement, cell: number) => CellView | SpaceView} viewOn
 * @param {number} start First time, ms.
 * @param {((canvas: HTMLCanvasElement) => OverlayView) | null} overlayOn Of several runs.
 */
export function addStills(cells, viewOn, start, overlayOn) {
  const place = find("stills", HTMLElement);
  /** @type {(caption: string) => { canvas: HTMLCanvasElement, figure: HTMLElement }} */
  const add = (caption) => {
    const canvas = make("canvas");
    return { canvas, figure: make("figure", {}, canvas, make("figcaption", {}, caption)) };
  };
  const size = (/** @type {Sheet} */ sheet) => {
    sheet.resize(340, Math.min(Sheet.heightFor(sheet.box, 340), 400), 3);
    sheet.canvas.removeAttribute("style");
  };
  if (overlayOn !== null) {
    for (const [caption, times] of /** @type {[string, number[]][]} */ ([
      ["all at rest", cells.map(() => start)],
      ["each at its peak", cells.map((cell) => cell.peak_ms)],
    ])) {
      const { canvas, figure } = add(caption);
      const view = overlayOn(canvas);
      place.append(figure);
      size(view);
      view.draw(times, PRINTED);
    }
  }
  return cells.flatMap((cell, index) =>
    /** @type {[string, number][]} */ ([
      ["at rest", start],
      ["at its peak", cell.peak_ms],
    ]).map(([name, time]) => {
      const of = cells.length === 1 ? "" : `${cell.label}, `;
      const { canvas, figure } = add(`${of}${name}, ${time.toFixed(0)} ms`);
      const view = viewOn(canvas, index);
      size(view);
      return { view, figure, time, cell: index };
    }),
  );
}

/**
 * Draws the cells for paper; at rest, where no colour says anything, on its picture.
 *
 * @param {Still[]} stills
 * @param {(CellView | SpaceView)[]} views On the screen.
 * @param {Field} field
 * @param {number} start First time, ms.
 */
export function drawStills(stills, views, field, start) {
  for (const { view, time, cell } of stills) {
    view.photograph = views[cell].photograph;
    const photograph = view.photograph !== null && time === start;
    view.draw(time, field, { ink: PRINTED, photograph, opacity: photograph ? 0 : 1 });
  }
}

/**
 * Fits the charts of a beat to the paper.
 *
 * @param {ShownChart[]} charts
 */
export function printCharts(charts) {
  const columns = charts.length > 3 ? 2 : 1;
  fitCharts(find("charts", HTMLElement), charts, PAPER.width, columns, heightOfCharts(charts, columns, PAPER.plot));
}

/**
 * For printing, charts fit the paper, and what is folded is unfolded, but for curves of which there are many.
 *
 * @param {() => { charts: OwnChart[], beat: ShownBeat | null }} shown What the page shows then.
 */
export function setUpPrinting(shown) {
  /** @type {HTMLDetailsElement[]} */
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details")].filter(({ open, id }) => !open && id !== "more-curves");
    for (const details of opened) details.open = true;
    const { charts, beat } = shown();
    beat?.toPaper();
    for (const chart of charts) {
      chart.show(PAPER.half);
      chart.redraw();
    }
  });
  addEventListener("afterprint", () => {
    for (const details of opened) details.open = false;
    const { charts, beat } = shown();
    beat?.toScreen();
    for (const chart of charts) {
      chart.show();
      chart.redraw();
    }
  });
}
