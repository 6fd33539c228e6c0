// Files that are dropped on the page or chosen: each goes where it belongs.

import { find } from "./elements.js";
import { FILMS, TABLES } from "./measured.js";

/** @import { Engine } from "./engine.js" */
/** @import { Form } from "./form.js" */
/** @import { Measured } from "./measured.js" */
/** @import { Answer, Failure, Request } from "./requests.js" */

/** The largest file that is read, bytes. */
const LARGEST = 500e6;

const PICTURES = /\.(png|tiff?|jpe?g)$/i;
const OUTLINES = /\.(geojson|json|roi|zip)$/i;

/** @typedef {"picture" | "outline" | "film" | "curves" | "run" | "report"} Kind */

/**
 * What the page does besides.
 *
 * @typedef {object} Doing
 * @property {(answer: Answer) => boolean} failed Whether there is an error, which is then shown.
 * @property {(failure: Failure) => void} fail
 * @property {(request: Request) => Promise<number | null>} show
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
  /** The picture that is the cell. */
  #picture = "";

  /** @param {Engine} engine @param {Form} form @param {Measured} measured @param {Doing} doing */
  constructor(engine, form, measured, doing) {
    this.#engine = engine;
    this.#form = form;
    this.#measured = measured;
    this.#doing = doing;
    this.#input.addEventListener("change", () => this.#take(this.#input.files?.[0]));
    this.#pixelSize.addEventListener("change", () => {
      /** @type {Record<string, string>} */
      const size = this.#pixelSize.value === "" ? {} : { "shape.pixel_size": `${this.#pixelSize.value} um` };
      form.takeShape({ "shape.picture": this.#picture, ...size });
    });
    this.#builtIn.addEventListener("click", () => {
      this.#builtIn.hidden = this.#pixelPlace.hidden = true;
      this.#input.value = "";
      form.takeShape({});
    });
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      void this.#take(event.dataTransfer?.files[0]);
    });
  }

  /** @param {File | undefined} file */
  async #take(file) {
    if (file === undefined) return;
    const { name, size } = file;
    if (size > LARGEST) {
      const message = `${name} has ${(size / 1e6).toFixed(0)} MB; this page reads files of at most ${LARGEST / 1e6} MB.`;
      return this.#doing.fail({ message, advice: "The program reads larger ones." });
    }
    if (!/\.(toml|html?)$/i.test(name) && ![PICTURES, OUTLINES, FILMS, TABLES].some((kind) => kind.test(name))) {
      const advice = "Give a picture (.png, .tif), an outline (.geojson, .roi), a curve (.csv, .xlsx), a film (.avi, .tif, .y4m), a run file (.toml) or a report (.html).";
      return this.#doing.fail({ message: `${name} is of a kind that this page does not read.`, advice });
    }
    const held = await this.#engine.ask({ ask: "hold", name }, new Uint8Array(await file.arrayBuffer()));
    if (this.#doing.failed(held)) return;
    const kind = await this.#kind(name);
    if (kind !== null) await this.#use(name, kind);
  }

  /** What a file is; of some the name does not say it. @param {string} name @returns {Promise<Kind | null>} */
  async #kind(name) {
    if (/\.toml$/i.test(name)) return "run";
    if (/\.html?$/i.test(name)) return "report";
    if (FILMS.test(name)) return "film";
    if (OUTLINES.test(name)) return "outline";
    if (/\.(png|jpe?g)$/i.test(name)) return "picture";
    const answer = await this.#engine.ask({ ask: "kind", name });
    if (this.#doing.failed(answer) || answer.kind === undefined) return null;
    return PICTURES.test(name) && answer.kind !== "film" ? "picture" : answer.kind;
  }

  /** @param {string} name @param {Kind} kind */
  async #use(name, kind) {
    if (kind === "report") return void (await this.#doing.show({ ask: "open", name }));
    if (kind === "film" || kind === "curves") {
      this.#measured.take(name, kind === "film");
      return void this.#measured.dispatchEvent(new Event("read"));
    }
    if (kind === "run") {
      const answer = await this.#engine.ask({ ask: "settings", name });
      if (!this.#doing.failed(answer) && answer.settings !== undefined) this.#form.takeSettings(answer.settings, name);
      return;
    }
    this.#picture = kind === "picture" ? name : "";
    this.#pixelSize.value = "";
    this.#pixelPlace.hidden = this.#picture === "";
    this.#builtIn.hidden = false;
    this.#form.takeShape({ [`shape.${kind}`]: name });
  }
}
