// What stands below the beat: the fit, numbers, settings, how to repeat and cite the run.

import { find, make, say, withCode } from "./elements.js";
import { profileDrawing } from "./profiles.js";
import { differenceTable, fittedNumbers, keyNumbers, metricTables, parameterTables } from "./tables.js";

/** @import { Fit, Payload, Run } from "./payload.js" */

/** @param {Payload} payload */
export function writeSections({ version, differences, runs, fit }) {
  const one = runs.length === 1;
  find("key", HTMLElement).append(fit === null ? keyNumbers(runs) : fittedNumbers(fit.estimates));
  if (fit !== null) writeFit(fit);
  const about = new Set(runs.flatMap((run) => run.about_model ?? []));
  find("about", HTMLElement).append(...withCode([...about].join(" ")));
  find("about", HTMLElement).hidden = about.size === 0;
  find("changes", HTMLElement).hidden = one;
  const differ = find("differences", HTMLElement);
  differ.hidden = one;
  differ.append(
    differences.length > 0
      ? differenceTable(differences, runs)
      : make("p", {}, "The runs have the same settings."),
  );
  find("metrics", HTMLElement).append(...metricTables(runs));
  runs.forEach((run, index) => writeRun(run, one ? null : index));
  const citations = new Set(runs.map((run) => run.citations));
  find("cite", HTMLElement).append(...[...citations].map((text) => snippet(text, "BibTeX", "myospring.bib")));
  find("version", HTMLElement).textContent = `Made by Myospring ${version}.`;
}

/**
 * Parameters of a run and how to repeat it.
 *
 * @param {Run} run
 * @param {number | null} index Among several.
 */
function writeRun(run, index) {
  const parameters = parameterTables(run.parameters);
  const repeat = [
    make(
      "p",
      {},
      make("span", { class: "on-screen" }, "Save this as ", make("code", {}, "run.toml"), ", then: "),
      make("span", { class: "on-paper" }, "The file run.toml beside this page: "),
      make("code", {}, "myospring run run.toml"),
    ),
    snippet(run.run_file, "run file", "run.toml", index === null ? "" : ` of ${run.label}`),
  ];
  const shown = (/** @type {HTMLElement[]} */ all) => (index === null ? all : [folded(run.label, index, all)]);
  find("parameters", HTMLElement).append(...shown(parameters));
  find("repeat", HTMLElement).append(...shown(repeat));
}

/** @param {Fit} fit */
function writeFit({ profiles, notes, figures }) {
  find("fit", HTMLElement).hidden = false;
  find("profiles", HTMLElement).append(...profiles.map(profileDrawing));
  find("profiles", HTMLElement).hidden = profiles.length === 0;
  find("profiles-hint", HTMLElement).hidden = profiles.length === 0;
  find("fit-notes", HTMLElement).append(...notes.map((text) => make("li", {}, ...withCode(text))));
  find("figures", HTMLElement).append(
    ...figures.flatMap(({ title, light, dark, words, notes }) => [
      make("h2", {}, title),
      make(
        "div",
        { class: "wide", role: "region", "aria-label": title, tabindex: "0" },
        make(
          "picture",
          {},
          make("source", { srcset: dark, media: "screen and (prefers-color-scheme: dark)" }),
          make("img", { src: light, alt: words, class: "drawn" }),
        ),
      ),
      make("p", {}, words),
      make("ul", {}, ...notes.map((text) => make("li", {}, ...withCode(text)))),
    ]),
  );
}

/**
 * What is told of each of several runs; on paper of the first only, since the table above says in what the others
 * differ.
 *
 * @param {string} label
 * @param {number} index
 * @param {HTMLElement[]} content
 */
function folded(label, index, content) {
  const kind = index === 0 ? "each-run" : "each-run on-screen";
  return make("details", { class: kind }, make("summary", {}, label), ...content);
}

/**
 * Text to copy or to keep as a file.
 *
 * @param {string} text
 * @param {string} what
 * @param {string} file
 * @param {string} of Whose it is, where there are several.
 */
function snippet(text, what, file, of = "") {
  const block = make("pre", { tabindex: "0", role: "region", "aria-label": `${what}${of}` }, text);
  const copy = make("button", { type: "button" }, `Copy ${what}`);
  copy.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text);
      say(`The ${what} is copied.`);
      copy.textContent = "Copied";
      setTimeout(() => (copy.textContent = `Copy ${what}`), 1500);
    } catch {
      getSelection()?.selectAllChildren(block);
      say(`Copying is not allowed here; the ${what} is selected.`);
    }
  });
  const save = make("button", { type: "button" }, `Save ${file}`);
  save.addEventListener("click", () => {
    const address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
    make("a", { href: address, download: file }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  });
  return make("div", {}, block, make("div", { class: "actions" }, copy, save));
}
