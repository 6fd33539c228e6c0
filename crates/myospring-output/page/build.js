// Makes dist/report.html, the one file that the program fills with the data of a run.
//
// `node build.js` writes it; `node build.js --check` fails where the file that is there differs.

import { build } from "esbuild";
import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";

const TARGET = new URL("dist/report.html", import.meta.url);

/** @param {string} entry */
async function bundled(entry) {
  const result = await build({
    absWorkingDir: new URL(".", import.meta.url).pathname,
    entryPoints: [entry],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: ["chrome100", "firefox100", "safari15"],
    charset: "utf8",
    legalComments: "inline",
    logLevel: "warning",
  });
  // What ends a script element must not stand within one.
  return result.outputFiles[0].text.trim().replaceAll("</script", "<\\/script");
}

/** @param {string} text */
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

const [page, script, style] = await Promise.all([
  readFile(new URL("src/report.html", import.meta.url), "utf8"),
  bundled("src/report.js"),
  bundled("src/report.css"),
]);

// Nothing but what stands in the file: no network, no other script.
const policy = [
  "default-src 'none'",
  `script-src ${hash(script)}`,
  `style-src ${hash(style)}`,
  "img-src data:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");

/** @type {Record<string, string>} */
const parts = { policy, script, style };
const html = page.replace(/\{\{(policy|script|style)\}\}/g, (_, name) => parts[name]);

if (process.argv.includes("--check")) {
  const present = await readFile(TARGET, "utf8").catch(() => "");
  if (present !== html) {
    process.stderr.write("dist/report.html is not what the source gives; run `npm run build`\n");
    process.exit(1);
  }
} else {
  await writeFile(TARGET, html);
  process.stdout.write(`dist/report.html: ${(html.length / 1000).toFixed(0)} kB\n`);
}
