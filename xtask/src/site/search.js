// Finds the parts of the documentation that have all words of a search.
(() => {
  const up = document.currentScript.dataset.up;
  const [input, found] = ["search", "found"].map((id) => document.getElementById(id));
  const MOST = 12;
  const AROUND = 80;
  const parts = PARTS.map((part) => ({ ...part, all: `${part.page} ${part.heading} ${part.text}`.toLowerCase() }));

  /** A title counts more than a text. */
  function score({ page, heading, all }, words) {
    if (!words.every((word) => all.includes(word))) return 0;
    const has = (text) => words.filter((word) => text.toLowerCase().includes(word)).length;
    return 1 + 10 * has(heading) + 5 * has(page);
  }

  function show() {
    const words = input.value.toLowerCase().split(/\s+/).filter((word) => word.length > 1);
    const best = words.length === 0 ? [] : parts.map((part) => [score(part, words), part]).filter(([score]) => score > 0).sort((a, b) => b[0] - a[0]).slice(0, MOST);
    found.hidden = words.length === 0;
    found.replaceChildren(...best.map(([, { at, page, heading, text }]) => {
      const link = Object.assign(document.createElement("a"), { href: up + at, textContent: heading === page ? page : `${page}: ${heading}` });
      const from = Math.max(0, text.toLowerCase().indexOf(words[0]) - AROUND);
      const around = Object.assign(document.createElement("p"), { textContent: text.slice(from, from + 3 * AROUND) });
      const item = document.createElement("li");
      item.append(link, around);
      return item;
    }));
    if (!found.hidden && best.length === 0) found.append(Object.assign(document.createElement("li"), { textContent: "Nothing has all of these words." }));
  }

  input.addEventListener("input", show);
})();
