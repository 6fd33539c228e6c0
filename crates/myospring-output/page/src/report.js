// Puts the page together: its head, its sections, and what moves in them.

import { showBeat } from "./beat.js";
import { readPayload } from "./data.js";
import { writeHead } from "./header.js";
import { setUpPrinting } from "./paper.js";
import { writeSections } from "./sections.js";

const payload = readPayload(document);
writeHead(payload);
const charts = writeSections(payload);
const beat = payload.sections.flatMap(({ parts }) => parts).find((part) => part.kind === "beat");
const shown = beat === undefined ? null : showBeat(beat, payload.times_ms);
setUpPrinting(charts, shown);
