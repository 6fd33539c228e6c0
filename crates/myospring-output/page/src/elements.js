// Elements from text, never from markup: a title is only a title.

/**
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, string>} attributes
 * @param {(string | Node)[]} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/**
 * An element of a drawing.
 *
 * @param {string} tag
 * @param {Record<string, string | number>} attributes
 * @param {(string | Node)[]} children
 */
export function draw(tag, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

/** How often each name was given. @type {Map<string, number>} */
const given = new Map();

/**
 * A name for a region that no other region has.
 *
 * @param {string} name
 */
export function ownName(name) {
  const times = (given.get(name) ?? 0) + 1;
  given.set(name, times);
  return times > 1 ? `${name}, ${times}` : name;
}

/** All names are free again. */
export function forgetNames() {
  given.clear();
}

/**
 * Text in which what stands between backticks is code.
 *
 * @param {string} text
 * @returns {(string | Node)[]}
 */
export function withCode(text) {
  return text.split("`").map((part, index) => (index % 2 === 1 ? make("code", {}, part) : part));
}

/**
 * The element of an id, of the kind that it must be.
 *
 * @template {HTMLElement} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
export function find(id, kind) {
  const element = document.getElementById(id);
  if (!(element instanceof kind)) throw new Error(`the page has no ${kind.name} #${id}`);
  return element;
}

/** @param {string} text Is spoken by a screen reader. */
export function say(text) {
  find("said", HTMLElement).textContent = text;
}

// A notebook makes the frame of a page as high as the page, which must not grow with it.
const heightAtFirst = globalThis.innerHeight;
export const isFramed = globalThis.parent !== globalThis.window;

/** Height of the window, px. */
export const windowHeight = () => (isFramed ? heightAtFirst : innerHeight);
