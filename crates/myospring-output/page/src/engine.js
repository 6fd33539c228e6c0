// The engine in its worker: asked by messages, stopped by ending the worker.

import { find } from "./elements.js";

/** @import { Answer, Request } from "./requests.js" */

/** Why a request has no answer: the engine was stopped. */
export class Stopped extends Error {}

/**
 * @typedef {object} Waiting
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
    const place = find("engine", HTMLScriptElement);
    const packed = Uint8Array.from(atob(place.textContent.trim()), (letter) => letter.charCodeAt(0));
    place.remove();
    const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Engine(await WebAssembly.compile(await new Response(unpacked).arrayBuffer()));
  }

  /**
   * @param {Request} request
   * @param {Uint8Array} bytes Of a file that it holds from now on.
   * @returns {Promise<Answer>}
   */
  async ask(request, bytes = new Uint8Array()) {
    if (request.ask === "run") this.#last = request;
    const answer = await this.#send(request, bytes);
    if (answer.error !== undefined) return answer;
    if (request.ask === "hold") {
      this.#known = this.#known.filter(([known]) => known.ask !== "hold" || known.name !== request.name);
      this.#known.push([request, bytes]);
    }
    if (request.ask === "pin" && this.#last !== null) this.#known.push([this.#last, new Uint8Array()], [request, bytes]);
    if (request.ask === "unpin") this.#known = this.#known.filter(([known]) => known.ask === "hold");
    return answer;
  }

  /** Ends what the engine does now. Requests that wait are refused by `Stopped`. */
  stop() {
    this.#worker.terminate();
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    waiting.forEach(({ reject }) => reject(new Stopped()));
    this.#worker = this.#begin();
    for (const [request, bytes] of this.#known) this.#send(request, bytes).catch(() => {});
  }

  #begin() {
    const worker = new Worker(this.#address);
    worker.postMessage({ module: this.#module });
    worker.addEventListener("message", ({ data: { progress, number, said, panic } }) => {
      if (progress !== undefined) {
        if (worker === this.#worker) this.onprogress(progress.what, progress.done, progress.of);
        return;
      }
      const waiting = this.#waiting.get(number);
      this.#waiting.delete(number);
      if (panic === null) {
        const answer = JSON.parse(said);
        waiting?.resolve(answer === "done" ? {} : answer);
        return;
      }
      const advice = "This is an error of Myospring; please report it with the run file.";
      waiting?.resolve({ error: { message: said || panic, advice } });
      this.stop();
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
      this.#waiting.set(number, { resolve, reject });
      this.#worker.postMessage({ number, request: JSON.stringify(request), bytes });
    });
  }
}
