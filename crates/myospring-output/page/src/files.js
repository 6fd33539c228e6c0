// Files that are dropped on the page or chosen: each goes where it belongs.

import { find, make } from "./elements.js";
import { ARRAYS, FILMS, rightFirst, TABLES } from "./measured.js";
import { OutlineView } from "./outline.js";
import { drawn, SAMPLES, PIXEL_UM } from "./samples.js";
import { asPng, greyFilm, JPEGS, VIDEOS } from "./video.js";

/** @import { Engine } from "./engine.js" */
/** @import { Form } from "./form.js" */
/** @import { Measured } from "./measured.js" */
/** @import { Answer, Failure, Request, Value } from "./requests.js" */

/** The largest file that is read, bytes. */
const LARGEST = 500e6;

const PICTURES = /\.(png|tiff?)$/i;
const MODELS = /\.(mmt|cellml)$/i;
const OUTLINES = /\.(geojson|json|roi|zip)$/i;

/** What is said of a JPEG. */
const OF_JPEG = "It is a JPEG, whose compression smears edges and makes blocks of eight pixels: the outline and the fibres are less sure than those of a PNG or TIFF.";

/** The run file in the data of a report, as JSON, and what names a file. */
const RUN_FILE = /"file":"run\.toml","text":("(?:[^"\\]|\\.)*")/;
const FILE = /\.(png|tiff?|csv|txt|tsv|xlsx|geojson|json|roi|zip|mmt|cellml)$/i;

/** @typedef {"picture" | "outline" | "film" | "stack" | "curves" | "arrays" | "run" | "model" | "report"} Kind */

/**
 * What the page does besides.
 *
 * @typedef {object} Doing
 * @property {(answer: Answer) => boolean} failed Whether there is an error, which is then shown.
 * @property {(failure: Failure) => void} fail
 * @property {(request: Request) => Promise<number | null>} show
 * @property {(request: Request) => Promise<void>} save
 */

/** The place where files are chosen, and the page on which they are dropped. */
export class Files {
  #engine;
  #form;
  #measured;
  #doing;
  #input = find("file", HTMLInputElement);
  #builtIn = find("built-in", HTMLButtonElement);
  #pixelPlace = find("pixel-place", HTMLElement);
  #pixelSize = find("pixel-size", HTMLInputElement);
  #outlines = new OutlineView();
  #bar = find("bar-length", HTMLInputElement);
  /** Length of a line over a scale bar, pixels. */
  #barPixels = 0;
  /** Settings of the picture that is the cell. @type {Record<string, Value>} */
  #picture = {};
  /** Arrays of displacements: one that waits for the other, or both. @type {string[]} */
  #arrays = [];

  /** @param {Engine} engine @param {Form} form @param {Measured} measured @param {Doing} doing */
  constructor(engine, form, measured, doing) {
    this.#engine = engine;
    this.#form = form;
    this.#measured = measured;
    this.#doing = doing;
    this.#input.addEventListener("change", () => this.#takeOf(this.#input.files));
    // The same file may be chosen again.
    this.#input.addEventListener("click", () => (this.#input.value = ""));
    this.#pixelSize.addEventListener("change", () => this.#change({ "shape.pixel_size": `${this.#pixelSize.value} um` }));
    const cut = find("allow-cut", HTMLInputElement);
    cut.addEventListener("change", () => this.#change({ "segmentation.allow_cut": cut.checked }));
    this.#builtIn.addEventListener("click", () => {
      this.#input.value = "";
      this.#leave();
      form.takeShape({});
    });
    // Like a picture, a stack replaces the built-in cell; the form has taken it by now.
    measured.addEventListener("read", () => (this.#builtIn.hidden = form.isBuiltIn && Object.keys(this.#picture).length === 0));
    this.#outlines.addEventListener("choose", (event) => this.#change({ "segmentation.cell": /** @type {CustomEvent} */ (event).detail }));
    this.#outlines.addEventListener("edited", () => this.#edit());
    this.#outlines.addEventListener("painted", (event) => this.#trace(/** @type {CustomEvent} */ (event).detail));
    this.#outlines.addEventListener("measured", (event) => this.#measure(/** @type {CustomEvent} */ (event).detail));
    this.#bar.addEventListener("change", () => this.#scale());
    find("beads", HTMLButtonElement).addEventListener("click", () => this.#as("beads", String(this.#picture["shape.picture"]), { pixel_size_um: this.#pixelSize.value }));
    measured.addEventListener("given", (event) => this.#give(/** @type {CustomEvent} */ (event).detail));
    for (const button of document.querySelectorAll("[data-outline]")) {
      button.addEventListener("click", () => doing.save({ ask: "outline", settings: this.#picture, name: button.getAttribute("data-outline") ?? "" }));
    }
    const sample = find("sample-picture", HTMLSelectElement);
    sample.append(...Object.keys(SAMPLES).map((name) => make("option", { value: name }, name)));
    sample.addEventListener("change", () => this.#try(sample.value));
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      void this.#takeOf(event.dataTransfer?.files ?? null);
    });
  }

  /** Takes two arrays, or the first of other files. @param {FileList | null} files */
  async #takeOf(files) {
    const all = [...(files ?? [])];
    const isOfArrays = all.every(({ name }) => ARRAYS.test(name));
    for (const file of isOfArrays ? all : all.slice(0, 1)) await this.#take(file);
  }

  /** @param {File} file */
  async #take(file) {
    const { name } = file;
    if (!/\.(toml|html?)$/i.test(name) && ![PICTURES, JPEGS, OUTLINES, FILMS, VIDEOS, TABLES, ARRAYS, MODELS].some((kind) => kind.test(name))) {
      const advice = "Give a picture (.png, .tif), an outline (.geojson, .roi), a curve (.csv, .xlsx), a film (.avi, .tif, .y4m, .mp4, .webm), displacements of a gel (.npy), a cell model (.mmt, .cellml), a run file (.toml) or a report (.html).";
      return this.#doing.fail({ message: `${name} is of a kind that this page does not read.`, advice });
    }
    const read = await this.#read(file);
    if (read === null) return;
    const held = await this.#engine.ask({ ask: "hold", name: read.name }, read.bytes);
    if (this.#doing.failed(held)) return;
    const kind = await this.#kind(read.name);
    if (kind === null) return;
    if (kind === "report") await this.#report(read.name, new TextDecoder().decode(read.bytes));
    else await this.#use(read.name, kind);
    if (JPEGS.test(name)) this.#outlines.remark = OF_JPEG;
  }

  /** Holds a further file of a curve or a film. @param {{ key: string, file: File }} given */
  async #give({ key, file }) {
    const read = await this.#read(file);
    if (read === null) return;
    // It may have the name of the film.
    const name = `${key}/${read.name}`;
    const held = await this.#engine.ask({ ask: "hold", name }, read.bytes);
    if (!this.#doing.failed(held)) this.#measured.give(key, name);
  }

  /** Takes an array of displacements, of which two are needed. @param {string} name */
  #pair(name) {
    const others = this.#arrays.filter((other) => other !== name);
    this.#arrays = others.length < 2 ? [...others, name] : [name];
    if (this.#arrays.length < 2) {
      find("state", HTMLElement).textContent = `${name} is one component of displacements: give the other one, too.`;
      return;
    }
    this.#measured.take(rightFirst(this.#arrays), "arrays");
    this.#measured.dispatchEvent(new Event("read"));
  }

  /**
   * Takes a film of beads or a stack of slices.
   *
   * @param {"beads" | "stack"} what
   * @param {string} name
   * @param {Record<string, string>} [known]
   */
  #as(what, name, known) {
    this.#leave();
    this.#measured.take([name], what, known);
    this.#measured.dispatchEvent(new Event("read"));
  }

  /** A file as the engine reads it; what only the browser decodes becomes another file. @param {File} file */
  async #read(file) {
    if (file.size > LARGEST) {
      const message = `${file.name} has ${(file.size / 1e6).toFixed(0)} MB; this page reads files of at most ${LARGEST / 1e6} MB.`;
      this.#doing.fail({ message, advice: "The program reads larger ones." });
      return null;
    }
    const stem = file.name.replace(/\.[^.]*$/, "");
    const state = find("state", HTMLElement);
    try {
      if (VIDEOS.test(file.name)) {
        const bytes = await greyFilm(file, (done, of) => (state.textContent = `Decoding ${file.name}: ${done.toFixed(1)} of ${of.toFixed(1)} s.`));
        return { name: `${stem}.y4m`, bytes };
      }
      if (JPEGS.test(file.name)) return { name: `${stem}.png`, bytes: await asPng(file) };
      return { name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) };
    } catch (error) {
      const message = `${/** @type {Error} */ (error).message}.`;
      this.#doing.fail({ message, advice: `Convert it: ffmpeg -i ${file.name} -pix_fmt gray ${stem}${VIDEOS.test(file.name) ? ".y4m" : ".png"}` });
      return null;
    }
  }

  /** Takes a made-up picture. @param {string} name */
  async #try(name) {
    if (name === "") return;
    const file = `${name.replaceAll(" ", "_")}.png`;
    const held = await this.#engine.ask({ ask: "hold", name: file }, await drawn(name));
    if (this.#doing.failed(held)) return;
    this.#leave();
    this.#pixelPlace.hidden = this.#builtIn.hidden = false;
    this.#pixelSize.value = String(PIXEL_UM);
    this.#picture = { "shape.picture": file, "shape.pixel_size": `${PIXEL_UM} um` };
    await this.#look();
  }

  /** What a file is; of some the name does not say it. @param {string} name @returns {Promise<Kind | null>} */
  async #kind(name) {
    if (/\.toml$/i.test(name)) return "run";
    if (/\.html?$/i.test(name)) return "report";
    if (MODELS.test(name)) return "model";
    if (FILMS.test(name)) return "film";
    if (ARRAYS.test(name)) return "arrays";
    if (OUTLINES.test(name)) return "outline";
    if (/\.png$/i.test(name)) return "picture";
    const answer = await this.#engine.ask({ ask: "kind", name });
    if (this.#doing.failed(answer) || answer.kind === undefined) return null;
    return PICTURES.test(name) && !["film", "stack"].includes(answer.kind) ? "picture" : answer.kind;
  }

  /** Shows a report, and sets its run up, if that needs no other file. @param {string} name @param {string} text */
  async #report(name, text) {
    if ((await this.#doing.show({ ask: "open", name })) === null) return;
    const run = RUN_FILE.exec(text)?.[1];
    if (run === undefined) return;
    const file = `${name}.toml`;
    await this.#engine.ask({ ask: "hold", name: file }, new TextEncoder().encode(JSON.parse(run)));
    const { settings } = await this.#engine.ask({ ask: "settings", name: file });
    const isFile = (/** @type {Value} */ value) => typeof value === "string" && FILE.test(value);
    if (settings === undefined || Object.values(settings).some(isFile)) return;
    this.#form.takeSettings(settings, name.replace(/\.html?$/i, ""));
  }

  /** @param {string} name @param {Exclude<Kind, "report">} kind */
  async #use(name, kind) {
    if (kind === "film" || kind === "curves") {
      this.#measured.take([name], kind === "film" ? "film" : "curve");
      return void this.#measured.dispatchEvent(new Event("read"));
    }
    if (kind === "arrays") return this.#pair(name);
    if (kind === "stack") return this.#as("stack", name);
    if (kind === "model") return void ((await this.#learn(name)) && this.#form.takeModel(name));
    if (kind === "run") {
      const answer = await this.#engine.ask({ ask: "settings", name });
      if (this.#doing.failed(answer) || answer.settings === undefined) return;
      const model = String(answer.settings["cell.model"] ?? "");
      if (!MODELS.test(model) || (await this.#learn(model))) {
        if (this.#measured.shape !== null) this.#measured.leave();
        this.#form.takeSettings(answer.settings, name);
      }
      return;
    }
    this.#leave();
    this.#builtIn.hidden = false;
    if (kind === "outline") return this.#form.takeShape({ "shape.outline": name });
    find("sample-picture", HTMLSelectElement).value = "";
    this.#picture = { "shape.picture": name };
    this.#pixelPlace.hidden = false;
    await this.#look();
  }

  /** Offers the cell model of a file that is held. @param {string} name @returns {Promise<boolean>} Whether it can be read. */
  async #learn(name) {
    const answer = await this.#engine.ask({ ask: "model", name });
    if (this.#doing.failed(answer) || answer.model === undefined) return false;
    this.#form.offerModel(answer.model);
    return true;
  }

  /** The cell is no picture and no stack any more. */
  #leave() {
    if (this.#measured.shape !== null) this.#measured.leave();
    this.#picture = {};
    this.#pixelSize.value = "";
    find("allow-cut", HTMLInputElement).checked = false;
    this.#builtIn.hidden = this.#pixelPlace.hidden = true;
    this.#outlines.hide();
  }

  /** Asks how long a scale bar is. @param {number} pixels */
  #measure(pixels) {
    if (pixels < 2) return;
    this.#barPixels = pixels;
    find("bar-place", HTMLElement).hidden = false;
    this.#bar.focus();
  }

  /** The size of a pixel, by a scale bar. */
  #scale() {
    if (!(this.#bar.valueAsNumber > 0)) return;
    this.#pixelSize.value = String(Number((this.#bar.valueAsNumber / this.#barPixels).toPrecision(4)));
    find("bar-place", HTMLElement).hidden = true;
    this.#pixelSize.dispatchEvent(new Event("change"));
  }

  /** Reads the picture in another way. @param {Record<string, Value>} settings */
  async #change(settings) {
    this.#picture = { ...without(this.#picture, "segmentation.outline"), ...settings };
    await this.#look();
  }

  /** Shows the cells of the picture, and beats the one that is taken. */
  async #look() {
    const { picture, ...answer } = await this.#engine.ask({ ask: "cells", settings: this.#picture });
    if (this.#doing.failed(answer) || picture === undefined) return this.#outlines.hide();
    this.#outlines.show(picture);
    if (picture.taken !== null) this.#form.takeShape(this.#picture);
    else if (picture.refused !== null) this.#doing.fail({ message: picture.refused, advice: null });
  }

  /** Beats the outline that a person has drawn. */
  async #edit() {
    const name = "edited.geojson";
    const held = await this.#engine.ask({ ask: "hold", name }, new TextEncoder().encode(this.#outlines.geojson));
    if (this.#doing.failed(held)) return;
    this.#picture = { ...without(this.#picture, "segmentation.cell"), "segmentation.outline": name };
    this.#form.takeShape(this.#picture);
  }

  /** The outline of what a brush has left. @param {Blob | null} mask */
  async #trace(mask) {
    if (mask === null) return;
    const name = "edited_mask.png";
    const held = await this.#engine.ask({ ask: "hold", name }, new Uint8Array(await mask.arrayBuffer()));
    if (this.#doing.failed(held)) return;
    const { every, pixelSize } = this.#outlines.scale;
    const settings = { "shape.picture": name, "shape.pixel_size": `${pixelSize * every} um`, "segmentation.modality": "mask", "segmentation.allow_cut": true };
    const { picture, ...answer } = await this.#engine.ask({ ask: "cells", settings });
    if (this.#doing.failed(answer) || picture === undefined) return;
    const whole = picture.cells.find(({ number }) => number === picture.taken);
    const inPicture = (/** @type {[number, number]} */ [x, y]) => /** @type {[number, number]} */ ([x * every, y * every]);
    if (whole !== undefined) this.#outlines.take(whole.rings.map((ring) => ring.map(inPicture)));
  }
}

/** @param {Record<string, Value>} settings @param {string} key */
function without(settings, key) {
  return Object.fromEntries(Object.entries(settings).filter(([other]) => other !== key));
}
