// Six questions for students, beside the cell: the steps of a tutorial of the documentation.

import { find, make } from "./elements.js";

/** @import { Value } from "./requests.js" */
/** @import { Form } from "./form.js" */

/**
 * A step of the tutorial.
 *
 * @typedef {object} Step
 * @property {string} title
 * @property {string[]} words Paragraphs, in which `code` and *what the page calls so* are marked.
 * @property {string} question
 * @property {[string, Record<string, Value>][]} tries Set-ups with their names.
 */

/** What stands before a question, and around set-ups in JSON. */
const QUESTION = "**Question.** ";
const TRY = /^<!-- try (.*) -->$/s;

/** The steps of a tutorial in Markdown: the parts whose headings have a number. @param {string} text @returns {Step[]} */
export function stepsOf(text) {
  const parts = text.split(/^## /m).filter((part) => /^\d+\. /.test(part));
  return parts.map((part) => {
    const [heading, ...blocks] = part.trim().split(/\n{2,}/);
    const paragraphs = blocks.map((block) => block.replaceAll("\n", " "));
    /** @type {Record<string, Record<string, Value>>[]} */
    const settings = paragraphs.flatMap((block) => TRY.exec(block)?.[1] ?? []).map((json) => JSON.parse(json));
    return {
      title: heading.replace(/^\d+\. /, ""),
      words: paragraphs.filter((block) => !TRY.test(block) && !block.startsWith(QUESTION)),
      question: paragraphs.find((block) => block.startsWith(QUESTION))?.slice(QUESTION.length) ?? "",
      tries: settings.flatMap((all) => Object.entries(all)),
    };
  });
}

/** Shows the tour on request. */
export class Tour {
  #form;
  #steps = stepsOf(find("tour-text", HTMLScriptElement).textContent);
  #place = find("tour", HTMLElement);
  #title = find("tour-title", HTMLElement);
  #words = find("tour-words", HTMLElement);
  #tries = find("tour-tries", HTMLElement);
  #question = find("tour-question", HTMLElement);
  #back = find("tour-back", HTMLButtonElement);
  #next = find("tour-next", HTMLButtonElement);
  #open = find("tour-open", HTMLButtonElement);
  #step = 0;

  /** @param {Form} form */
  constructor(form) {
    this.#form = form;
    this.#open.addEventListener("click", () => this.#show(0));
    this.#back.addEventListener("click", () => this.#show(this.#step - 1));
    this.#next.addEventListener("click", () => (this.#step + 1 < this.#steps.length ? this.#show(this.#step + 1) : this.#close()));
    find("tour-close", HTMLButtonElement).addEventListener("click", () => this.#close());
  }

  /** @param {number} step */
  #show(step) {
    this.#step = step;
    const { title, words, question, tries } = this.#steps[step];
    this.#title.textContent = `${step + 1} of ${this.#steps.length}: ${title}`;
    this.#words.replaceChildren(...words.map((text) => make("p", {}, ...marked(text))));
    this.#question.replaceChildren(...marked(question));
    this.#tries.replaceChildren(
      ...tries.map(([name, settings]) => {
        const button = make("button", { type: "button" }, ...marked(name));
        button.addEventListener("click", () => this.#form.take(keptOf(settings)));
        return button;
      }),
    );
    this.#back.disabled = step === 0;
    this.#next.textContent = step + 1 < this.#steps.length ? "Next question" : "End";
    this.#place.hidden = false;
    this.#open.hidden = true;
    this.#title.focus();
  }

  #close() {
    this.#place.hidden = true;
    this.#open.hidden = false;
    this.#open.focus();
  }
}

/** A set-up of a step, without anything that was set up before. @param {Record<string, Value>} settings */
function keptOf(settings) {
  const { "cell.parameters": parameters, ...others } = settings;
  return { settings: others, parameters: /** @type {Record<string, number>} */ (parameters ?? {}), doses: null, dose: "" };
}

/** Text with its marks. @param {string} text @returns {(string | Node)[]} */
function marked(text) {
  return text.split(/(`[^`]+`|\*[^*]+\*)/).map((part) => {
    const inner = part.slice(1, -1);
    if (part.startsWith("`")) return make("code", {}, inner);
    return part.startsWith("*") ? make("em", {}, inner) : part;
  });
}
