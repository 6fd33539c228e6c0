// A picture with the outlines of its cells: one is chosen, its points are moved, a brush adds and takes away, a scale bar is measured.

import { draw, find, make } from "./elements.js";
import { inWordsOfPage } from "./measured.js";

/** @import { ShownCell, ShownCells } from "./requests.js" */

/** @typedef {[number, number][][]} Rings In columns and rows of the picture. */

/** Points that a person can move one by one: others are left out while moving. */
const MOST_POINTS = 60;
/** Radius of a point on the screen, px. */
const RADIUS = 6;

/**
 * Fires `choose` with the number of a cell, `edited` once the outline has other points, `painted` with a PNG of the cell's mask after
 * a stroke of the brush, and `measured` with the length of a line over a scale bar, pixels.
 */
export class OutlineView extends EventTarget {
  #section = find("shown-cells", HTMLElement);
  #words = find("shown-cells-words", HTMLElement);
  #place = find("shown-cells-place", HTMLElement);
  #undo = find("undo", HTMLButtonElement);
  #brush = find("brush", HTMLInputElement);
  #svg = draw("svg", {});
  /** @type {ShownCells | null} */
  #picture = null;
  /** The outline of the cell that is taken, and those before it. @type {Rings} */
  #rings = [];
  /** @type {Rings[]} */
  #before = [];
  /** What is said of the picture besides. */
  #remark = "";

  constructor() {
    super();
    find("tools", HTMLFieldSetElement).addEventListener("change", () => this.#draw());
    this.#undo.addEventListener("click", () => {
      const rings = this.#before.pop();
      if (rings !== undefined) this.#set(rings);
    });
  }

  get #tool() {
    const chosen = document.querySelector('input[name="tool"]:checked');
    return chosen instanceof HTMLInputElement ? chosen.value : "choose";
  }

  /** The outline as GeoJSON, in columns and rows of the picture. */
  get geojson() {
    const coordinates = this.#rings.map((ring) => [...ring, ring[0]]);
    return JSON.stringify({ type: "Feature", properties: { unit: "pixel", name: "edited" }, geometry: { type: "Polygon", coordinates } });
  }

  /** How many pixels of the picture are one of its mask, and how large they are, um. */
  get scale() {
    return { every: this.#picture?.every ?? 1, pixelSize: this.#picture?.pixel_size_um ?? 1 };
  }

  /** Says something of the picture besides, until it is hidden. @param {string} words */
  set remark(words) {
    this.#remark = words;
    this.#draw();
  }

  /** Shows a picture. @param {ShownCells} picture */
  show(picture) {
    this.#picture = picture;
    [this.#rings, this.#before] = [this.#taken?.rings ?? [], []];
    this.#undo.disabled = true;
    const { size, every, grey } = picture;
    const [width, height] = size.map((side) => Math.ceil(side / every));
    const canvas = make("canvas", { width: String(width), height: String(height) });
    const pixels = new ImageData(width, height);
    const values = atob(grey);
    for (let at = 0; at < width * height; at++) {
      const value = values.charCodeAt(at);
      pixels.data.set([value, value, value, 255], 4 * at);
    }
    canvas.getContext("2d")?.putImageData(pixels, 0, 0);
    this.#svg = draw("svg", { viewBox: `0 0 ${width * every} ${height * every}`, role: "group", "aria-label": "Cells of the picture" });
    this.#svg.addEventListener("pointerdown", (event) => this.#paint(/** @type {PointerEvent} */ (event)));
    this.#place.replaceChildren(canvas, this.#svg);
    this.#place.style.maxWidth = `calc(55vh * ${width / height})`;
    this.#section.hidden = false;
    this.#draw();
  }

  hide() {
    [this.#picture, this.#remark] = [null, ""];
    this.#section.hidden = true;
  }

  get #taken() {
    return this.#picture?.cells.find(({ number }) => number === this.#picture?.taken);
  }

  /** Takes an outline that a brush has made. @param {Rings} rings */
  take(rings) {
    this.#before.push(this.#rings);
    this.#set(rings);
  }

  /** @param {Rings} rings */
  #set(rings) {
    this.#rings = rings;
    this.#undo.disabled = this.#before.length === 0;
    this.#draw();
    this.dispatchEvent(new Event("edited"));
  }

  #draw() {
    if (this.#picture === null) return;
    const { cells, taken, refused } = this.#picture;
    const isChoice = this.#tool === "choose";
    const paths = cells.map((cell) => {
      const isTaken = cell.number === taken;
      const path = draw("path", { d: pathOf(isTaken ? this.#rings : cell.rings), "fill-rule": "evenodd", class: isTaken ? "taken" : "" });
      path.append(draw("title", {}, aboutOf(cell)));
      if (isChoice) {
        path.setAttribute("tabindex", "0");
        path.setAttribute("role", "button");
        path.setAttribute("aria-pressed", String(isTaken));
        path.setAttribute("aria-label", aboutOf(cell));
        const choose = () => this.dispatchEvent(new CustomEvent("choose", { detail: cell.number }));
        path.addEventListener("click", choose);
        path.addEventListener("keydown", (event) => /** @type {KeyboardEvent} */ (event).key === "Enter" && choose());
      }
      return path;
    });
    this.#svg.replaceChildren(...paths, ...(this.#tool === "points" ? this.#points() : []));
    const one = this.#taken;
    const found = cells.length === 1 ? "One cell was found." : `${cells.length} cells were found; a click takes another.`;
    const doubts = one === undefined ? "" : one.reasons.map((reason) => ` ${reason}.`).join("");
    const isEdited = one !== undefined && this.#rings !== one.rings;
    const words = isEdited ? "The outline is your own now: no confidence is stated for it." : (refused === null ? null : inWordsOfPage(refused)) ?? (one === undefined ? found : `${found} ${aboutOf(one)}.${doubts}`);
    this.#words.textContent = `${words} ${this.#remark}`.trim();
  }

  /** Handles of the outer ring. */
  #points() {
    const scale = (this.#picture?.size[0] ?? 1) / Math.max(1, this.#svg.getBoundingClientRect().width);
    const [outer = [], ...holes] = this.#rings;
    const every = Math.ceil(outer.length / MOST_POINTS);
    const points = outer.filter((_, at) => at % every === 0);
    return points.map(([x, y], at) => {
      const circle = draw("circle", { cx: x, cy: y, r: RADIUS * scale, tabindex: 0, role: "button", "aria-label": `point ${at + 1}; arrow keys move it, Delete removes it` });
      /** @param {[number, number] | null} to */
      const move = (to) => {
        const moved = /** @type {[number, number][]} */ (points.flatMap((point, other) => (other !== at ? [point] : to === null ? [] : [to])));
        if (moved.length >= 3) this.take([moved, ...holes]);
      };
      circle.addEventListener("pointerdown", (event) => {
        event.stopPropagation();
        const { pointerId } = /** @type {PointerEvent} */ (event);
        circle.setPointerCapture(pointerId);
        /** @type {[number, number]} */
        let to = [x, y];
        circle.addEventListener("pointermove", (moved) => {
          to = this.#at(/** @type {PointerEvent} */ (moved));
          circle.setAttribute("cx", String(to[0]));
          circle.setAttribute("cy", String(to[1]));
        });
        circle.addEventListener("pointerup", () => move(to), { once: true });
      });
      circle.addEventListener("keydown", (event) => {
        const { key } = /** @type {KeyboardEvent} */ (event);
        const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key];
        if (step === undefined && key !== "Delete") return;
        event.preventDefault();
        move(step === undefined ? null : [x + step[0] * scale * 2, y + step[1] * scale * 2]);
        const next = this.#svg.querySelectorAll("circle")[at];
        if (next instanceof SVGElement) next.focus();
      });
      return circle;
    });
  }

  /** Column and row of a place on the screen. @param {PointerEvent} event @returns {[number, number]} */
  #at({ clientX, clientY }) {
    const { left, top, width } = this.#svg.getBoundingClientRect();
    const scale = (this.#picture?.size[0] ?? 1) / width;
    return [(clientX - left) * scale, (clientY - top) * scale];
  }

  /** A stroke of the brush. @param {PointerEvent} begin */
  #paint(begin) {
    const tool = this.#tool;
    if (tool !== "add" && tool !== "take" && tool !== "bar") return;
    const svg = this.#svg;
    const perPixel = (this.#picture?.size[0] ?? 1) / svg.getBoundingClientRect().width;
    const width = perPixel * (tool === "bar" ? 2 : Number(this.#brush.value));
    let stroke = [this.#at(begin)];
    const line = draw("polyline", { "stroke-width": width });
    svg.append(line);
    const go = (/** @type {Event} */ event) => {
      const to = this.#at(/** @type {PointerEvent} */ (event));
      stroke = tool === "bar" ? [stroke[0], to] : [...stroke, to];
      line.setAttribute("points", stroke.join(" "));
    };
    svg.setPointerCapture(begin.pointerId);
    svg.addEventListener("pointermove", go);
    const end = () => {
      svg.removeEventListener("pointermove", go);
      line.remove();
      const [[x, y], [toX, toY]] = [stroke[0], stroke[stroke.length - 1]];
      if (tool === "bar") this.dispatchEvent(new CustomEvent("measured", { detail: Math.hypot(toX - x, toY - y) }));
      else this.#mask(stroke, width, tool === "add");
    };
    svg.addEventListener("pointerup", end, { once: true });
  }

  /** The cell after a stroke, as a picture. @param {[number, number][]} stroke @param {number} width @param {boolean} adds */
  #mask(stroke, width, adds) {
    if (this.#picture === null) return;
    const { size, every } = this.#picture;
    const [columns, rows] = size.map((side) => Math.ceil(side / every));
    const canvas = make("canvas", { width: String(columns), height: String(rows) });
    const context = canvas.getContext("2d");
    if (context === null) return;
    context.fillStyle = "black";
    context.fillRect(0, 0, columns, rows);
    context.scale(1 / every, 1 / every);
    context.fillStyle = "white";
    context.fill(new Path2D(pathOf(this.#rings)), "evenodd");
    context.strokeStyle = adds ? "white" : "black";
    [context.lineWidth, context.lineCap, context.lineJoin] = [width, "round", "round"];
    const path = stroke.length === 1 ? [stroke[0], stroke[0]] : stroke;
    context.stroke(new Path2D(`M${path.join("L")}`));
    canvas.toBlob((blob) => this.dispatchEvent(new CustomEvent("painted", { detail: blob })), "image/png");
  }
}

/** @param {Rings} rings */
function pathOf(rings) {
  return rings.map((ring) => `M${ring.join("L")}Z`).join("");
}

/** @param {ShownCell} cell */
function aboutOf({ name, area_um2: area, confidence }) {
  return `Cell ${name}: ${Math.round(area)} \u00b5m\u00b2, confidence ${confidence.toFixed(2)}`;
}
