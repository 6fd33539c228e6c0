// The engine of the page in Node.js.

import { readFile } from "node:fs/promises";

/** @import { Answer, Request } from "../src/requests.js" */

/** An engine that answers at once. */
export async function engine() {
  const module = await WebAssembly.compile(await readFile(process.env.ENGINE ?? ""));
  /** @type {Record<string, Record<string, () => void>>} */
  const unused = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) (unused[from] ??= {})[name] = () => {};
  const instance = await WebAssembly.instantiate(module, unused);
  const { memory, input, answer, answer_place: place, answer_length: length } = /** @type {any} */ (instance.exports);
  return {
    /** Bytes of its memory. */
    size: () => memory.buffer.byteLength,
    /**
     * @param {Request} request
     * @param {Uint8Array} bytes
     * @returns {Answer}
     */
    ask(request, bytes = new Uint8Array()) {
      const text = new TextEncoder().encode(JSON.stringify(request));
      const at = input(text.length + bytes.length);
      new Uint8Array(memory.buffer, at, text.length).set(text);
      new Uint8Array(memory.buffer, at + text.length, bytes.length).set(bytes);
      answer(text.length);
      const said = JSON.parse(new TextDecoder().decode(new Uint8Array(memory.buffer, place(), length())));
      return said === "done" ? {} : said;
    },
  };
}

/**
 * A request for a run.
 *
 * @param {Record<string, import("../src/requests.js").Value>} settings
 * @returns {Request}
 */
export const run = (settings) => ({
  ask: "run",
  settings: { "numerics.integrator": "quasi-static", ...settings },
  dose: null,
  label: "a run",
});
