// Runs the engine out of the page's way. Each message is a request, its number and the bytes of a file; the first one brings the
// engine itself. What it answers is JSON.

/** @type {Promise<any>} */
let engine;
/** The same, once it is there. @type {any} */
let told;

addEventListener("message", async ({ data: { module, number, request, bytes } }) => {
  if (module !== undefined) {
    const page = {
      tell: (/** @type {number} */ at, /** @type {number} */ length, /** @type {number} */ done, /** @type {number} */ of) => {
        const { memory } = told.exports;
        // A copy, since text is not decoded from memory that may grow.
        postMessage({ progress: { what: new TextDecoder().decode(new Uint8Array(memory.buffer, at, length).slice()), done, of } });
      },
    };
    // Random bytes for encrypted archives, which a dependency brings and nothing asks for.
    /** @type {Record<string, Record<string, () => void>>} */
    const imports = {};
    for (const { module: from, name } of WebAssembly.Module.imports(module)) (imports[from] ??= {})[name] = () => {};
    engine = WebAssembly.instantiate(module, { ...imports, page });
    engine.then((instance) => (told = instance));
    return;
  }
  let [said, panic] = ["", /** @type {string | null} */ (null)];
  try {
    const { memory, input, answer, answer_place: place, answer_length: length } = (await engine).exports;
    const text = new TextEncoder().encode(request);
    try {
      const at = input(text.length + bytes.length);
      new Uint8Array(memory.buffer, at, text.length).set(text);
      new Uint8Array(memory.buffer, at + text.length, bytes.length).set(bytes);
      answer(text.length);
    } catch (error) {
      panic = String(error);
    }
    said = new TextDecoder().decode(new Uint8Array(memory.buffer, place(), length()));
  } catch (error) {
    panic ??= String(error);
  }
  postMessage({ number, said, panic });
});
