// The engine in its worker: asked by messages, stopped by ending the worker.

import { find } from "./elements.js";

/** @import { Answer, Request } from "./requests.js" */

/** Why a request has no answer: the engine was stopped. */
export class Stopped extends Error {}

/** Requests about what an engine has done before: a new one cannot answer them. */
const OF_BEFORE = ["pin", "unpin", "save", "save-all", "result", "keep"];

/**
 * @typedef {object} Waiting
 * @property {Request} request
 * @property {Uint8Array} bytes
 * @property {(answer: Answer) => void} resolve
 * @property {(error: Error) => void} reject
 */

/** Asks the engine. One that was stopped, or that failed, is replaced by a new one that knows the same. */
export class Engine {
  #module;
  #address;
  /** @type {Worker} */
  #worker;
  #number = 0;
  /** @type {Map<number, Waiting>} */
  #waiting = new Map();
  /** What a new engine must be told: files, and runs that were pinned. @type {[Request, Uint8Array][]} */
  #known = [];
  /** The last run that was asked for. @type {Request | null} */
  #last = null;
  /** Names of the last results. @type {string[]} */
  #results = [];
  /** Is told how far an experiment is. @type {(what: string, done: number, of: number) => void} */
  onprogress = () => {};

  /** @param {WebAssembly.Module} module */
  constructor(module) {
    this.#module = module;
    const text = find("worker", HTMLScriptElement).textContent;
    this.#address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    this.#worker = this.#begin();
  }

  /** The engine that is in the page. */
  static async inPage() {
    const [unpacker, packed] = ["unpacker", "engine"].map((id) => {
      const place = find(id, HTMLScriptElement);
      const bytes = bytesOf(place.textContent.trim());
      place.remove();
      return bytes;
    });
    const { memory, input, unpack, unpacked_length: length } = /** @type {any} */ ((await WebAssembly.instantiate(unpacker, {})).instance.exports);
    const room = input(packed.length);
    new Uint8Array(memory.buffer, room, packed.length).set(packed);
    const at = unpack();
    return new Engine(await WebAssembly.compile(new Uint8Array(memory.buffer, at, length())));
  }

  /**
   * @param {Request} request
   * @param {Uint8Array} bytes Of a file that it holds from now on.
   * @returns {Promise<Answer>}
   */
  async ask(request, bytes = new Uint8Array()) {
    if (request.ask === "run") this.#last = request;
    // Results are the engine's own; a new one gets them as files.
    const names = request.ask === "keep" ? this.#results : [];
    const results = names.map((name) => this.#send({ ask: "result", name }, new Uint8Array()));
    const [answer, ...kept] = await Promise.all([this.#send(request, bytes), ...results]);
    if (answer.error !== undefined) return answer;
    if (answer.results !== undefined) this.#results = answer.results.files.map(({ name }) => name);
    if (request.ask === "hold") this.#remember([request, bytes]);
    if (request.ask === "pin" && this.#last !== null) this.#remember([this.#last, new Uint8Array()], [request, bytes]);
    if (request.ask === "unpin") {
      this.#known = this.#known.filter(([known]) => known.ask === "hold");
      this.#remember();
    }
    for (const [at, { file }] of kept.entries()) {
      if (file !== undefined) this.#remember([{ ask: "hold", name: names[at] }, bytesOf(file.base64)]);
    }
    return answer;
  }

  /** @param {[Request, Uint8Array][]} more */
  #remember(...more) {
    this.#known.push(...more);
    // A pinned run may need a file as it was then.
    if (this.#known.some(([{ ask }]) => ask === "pin")) return;
    const last = new Map(this.#known.map((known) => [known[0].ask === "hold" ? known[0].name : known[0], known]));
    this.#known = [...last.values()];
  }

  /** Ends what the engine does now. Requests that wait are refused by `Stopped`. */
  stop() {
    for (const { reject } of this.#renew()) reject(new Stopped());
  }

  /** Goes on with a new engine; gives what waited for the one before. */
  #renew() {
    this.#worker.terminate();
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    this.#worker = this.#begin();
    for (const [request, bytes] of this.#known) this.#send(request, bytes).catch(() => {});
    return waiting.filter(({ request }) => !this.#known.some(([known]) => known === request));
  }

  /** The engine has failed at a request: those behind it are asked again, where a new engine can answer them. @param {number} number @param {string} message */
  #fail(number, message) {
    const failed = this.#waiting.get(number);
    this.#waiting.delete(number);
    // What a new engine fails at, too, it is not told again.
    this.#known = this.#known.filter(([known]) => known !== failed?.request);
    const advice = "This is an error of Myospring; please report it with the run file.";
    const answer = { error: { message, advice } };
    failed?.resolve(answer);
    for (const { request, bytes, resolve, reject } of this.#renew()) {
      if (OF_BEFORE.includes(request.ask)) resolve(answer);
      else this.#send(request, bytes).then(resolve, reject);
    }
  }

  #begin() {
    const worker = new Worker(this.#address);
    worker.postMessage({ module: this.#module });
    worker.addEventListener("message", ({ data: { progress, number, said, panic } }) => {
      if (worker !== this.#worker) return;
      if (progress !== undefined) return this.onprogress(progress.what, progress.done, progress.of);
      // What ends without a panic, such as for want of memory, leaves the answer before.
      if (panic !== null) return this.#fail(number, said.startsWith("panicked") ? said : `The engine has ended: ${panic}`);
      const waiting = this.#waiting.get(number);
      this.#waiting.delete(number);
      const answer = JSON.parse(said);
      waiting?.resolve(answer === "done" ? {} : answer);
    });
    return worker;
  }

  /**
   * @param {Request} request
   * @param {Uint8Array} bytes
   * @returns {Promise<Answer>}
   */
  #send(request, bytes) {
    const number = this.#number++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(number, { request, bytes, resolve, reject });
      this.#worker.postMessage({ number, request: JSON.stringify(request), bytes });
    });
  }
}

/** @param {string} base64 */
export function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}
