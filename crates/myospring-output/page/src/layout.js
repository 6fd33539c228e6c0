// Fits the page to its window: a cell and its curves are seen together, beside each other or one above the other.

import { Chart } from "./curves.js";
import { Sheet } from "./drawing.js";
import { find, make } from "./elements.js";

/** @import { ShownChart } from "./charts.js" */
/** @import { OverlayView } from "./overlay-view.js" */

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
/** Least height of a cell, px, and the part of the window's height that it takes where one has to scroll. */
const LEAST_CELL = 110;
const SCROLLED = 0.4;
/** The part of the window's height that cell and curves take where much lies above them. */
const LEAST_STAGE = 0.65;
/** Greatest part of the window's height that one of several cells takes. */
const MOST_OF_SEVERAL = 0.62;

/**
 * What is laid out.
 *
 * @typedef {object} Parts
 * @property {HTMLElement} stage
 * @property {Sheet[]} views
 * @property {OverlayView | null} overlay Of several runs.
 * @property {ShownChart[]} charts Those that lead.
 * @property {ShownChart[]} others Those that are folded.
 */

/**
 * Fits all parts to the window.
 *
 * @param {Parts} parts
 * @param {number} height Of the window, px.
 */
export function layOut(parts, height) {
  if (parts.overlay === null) layOutOne(parts, height);
  else layOutSeveral(parts, height);
  const width = parts.stage.clientWidth;
  const place = find("more-charts", HTMLElement);
  fitCharts(place, parts.others, width, columnsOfCharts(parts.others, width, 0), 0);
}

/**
 * The arrangement of a cell and its curves in which the cell is largest.
 *
 * @param {Parts} parts
 * @param {number} windowHeight px.
 */
function layOutOne({ stage, views: [view], charts }, windowHeight) {
  const { box } = view;
  const width = stage.clientWidth;
  const place = find("charts", HTMLElement);
  const high = (/** @type {string} */ id) => find(id, HTMLElement).offsetHeight;
  const top = stage.getBoundingClientRect().top + scrollY;
  const about = find("about", HTMLElement);
  const below = about.hidden ? 0 : about.offsetHeight + GAP;
  // Between its parts, and below the last.
  const gaps = 3 * GAP;
  const whole = Math.max(windowHeight - top - below, LEAST_STAGE * windowHeight) - high("controls") - gaps;

  const left = Math.max(Math.min(Sheet.widthFor(box, whole - high("bar")), (width - GUTTER) / 2), LEAST_PART * width);
  const right = width - GUTTER - left;
  const columns = columnsOfCharts(charts, right, whole);
  const across = columnsOfCharts(charts, width, whole - LEAST_CELL - high("bar"));
  const most = Sheet.heightFor(box, width);
  const spare = whole - high("bar") - heightOfCharts(charts, across, Chart.LEAST);
  const above = Math.min(most, spare < LEAST_CELL && width < SIDE_BY_SIDE ? SCROLLED * windowHeight : Math.max(spare, LEAST_CELL));
  const larger = Sheet.scaleIn(box, left, whole - high("bar")) > Sheet.scaleIn(box, width, above);
  const fits = heightOfCharts(charts, columns, Chart.LEAST) <= whole;
  const beside = width >= SIDE_BY_SIDE && fits && larger;
  stage.classList.toggle("beside", beside);
  stage.style.gridTemplateColumns = beside ? `${left}px ${right}px` : "";
  // Only now: in less width the bar takes more lines.
  const room = whole - high("bar");
  if (beside) {
    view.resize(left, Math.min(room, Sheet.heightFor(box, left)), devicePixelRatio);
    fitCharts(place, charts, right, columns, whole);
  } else {
    view.resize(width, above, devicePixelRatio);
    fitCharts(place, charts, width, across, room - above);
  }
}

/**
 * @param {Parts} parts
 * @param {number} windowHeight px.
 */
function layOutSeveral({ stage, views, overlay, charts }, windowHeight) {
  const { box } = views[0];
  const width = stage.clientWidth;
  const all = overlay === null ? views : [overlay, ...views];
  const columns = columnsIn(all, width, windowHeight);
  find("cells", HTMLElement).style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  const each = (width - GAP * (columns - 1)) / columns;
  const height = Math.min(Math.max(Sheet.heightFor(box, each), 100), MOST_OF_SEVERAL * windowHeight);
  all.forEach((view) => view.resize(each, height, devicePixelRatio));
  const room = LEAST_STAGE * windowHeight - find("legend", HTMLElement).offsetHeight;
  fitCharts(find("charts", HTMLElement), charts, width, columnsOfCharts(charts, width, room), room);
}

/**
 * As few columns of cells as let all of them be seen at once, if any number does.
 *
 * @param {Sheet[]} sheets
 * @param {number} width px.
 * @param {number} windowHeight px.
 */
function columnsIn(sheets, width, windowHeight) {
  const most = Math.max(Math.min(sheets.length, Math.floor((width + GAP) / (LEAST_WIDTH + GAP))), 1);
  const fits = (/** @type {number} */ columns) => {
    const height = Sheet.heightFor(sheets[0].box, (width - GAP * (columns - 1)) / columns);
    return Math.ceil(sheets.length / columns) * height <= SEEN * windowHeight;
  };
  return Array.from({ length: most }, (_, index) => index + 1).find(fits) ?? most;
}

/**
 * Height of charts in this number of columns, px.
 *
 * @param {ShownChart[]} charts
 * @param {number} columns
 * @param {number} plot Height of each plot, px.
 */
export function heightOfCharts(charts, columns, plot) {
  return Math.ceil(charts.length / columns) * (plot + CHART_HEAD) + Chart.AXIS + CHART_FOOT;
}

/**
 * As few columns of charts as are seen at once, if any number is.
 *
 * @param {ShownChart[]} charts
 * @param {number} width px.
 * @param {number} room px.
 */
function columnsOfCharts(charts, width, room) {
  const most = Math.max(Math.floor((width + GUTTER) / (LEAST_CHART + GUTTER)), 1);
  const all = Array.from({ length: Math.max(Math.min(most, charts.length), 1) }, (_, index) => index + 1);
  return all.find((columns) => heightOfCharts(charts, columns, Chart.LEAST) <= room) ?? all.length;
}

/**
 * Lays charts out in columns, which end at one height.
 *
 * @param {HTMLElement} place
 * @param {ShownChart[]} charts
 * @param {number} width px.
 * @param {number} columns
 * @param {number} room px.
 */
export function fitCharts(place, charts, width, columns, room) {
  const spare = room - heightOfCharts(charts, columns, 0);
  const rows = Math.ceil(charts.length / columns);
  const plot = Math.min(Math.max(spare / rows, Chart.LEAST), MOST_PLOT);
  // They follow each other downwards, fewest in the first columns, whose plots are higher.
  const short = columns - (charts.length % columns || columns);
  const lengths = Array.from({ length: columns }, (_, column) => rows - (column < short ? 1 : 0));
  const starts = lengths.map((_, column) => lengths.slice(0, column).reduce((sum, length) => sum + length, 0));
  const parts = lengths.map((length, column) => charts.slice(starts[column], starts[column] + length));
  if (place.childElementCount !== columns || place.querySelector(".column") === null) {
    place.replaceChildren(
      ...parts.map((part) => make("div", { class: "column" }, ...part.map(({ element }) => element))),
    );
  }
  place.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  const each = (width - GUTTER * (columns - 1)) / columns;
  for (const part of parts) {
    const higher = (rows * (plot + CHART_HEAD)) / part.length - CHART_HEAD;
    part.forEach(({ chart, axis }, index) => {
      const last = index === part.length - 1;
      axis.hidden = !last;
      chart.resize(each, higher, last);
    });
  }
}
