// The picture of a report, or of the page that simulates, in the documentation: `node picture.js report.html report.png`, with CHROMIUM
// as in the tests.

import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [report, picture] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ["--no-sandbox"] });
const page = await browser.newPage({
  viewport: { width: 1400, height: 900 },
  colorScheme: "light",
  reducedMotion: "reduce",
});
await page.goto(pathToFileURL(report).href);
// The page that simulates has colours once its first beat is there.
await page.waitForSelector("#field option", { state: "attached", timeout: 60_000 });
await page.selectOption("#field", "displacement");
await page.fill("#time", "150");
await page.locator("#time").blur();
await page.screenshot({ path: picture });
await browser.close();
