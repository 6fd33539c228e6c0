// Puts the page together: its head, its sections, and what moves in them.

import { readPayload } from "./data.js";
import { showPage } from "./whole.js";
import { setUpPrinting } from "./paper.js";

const report = showPage(readPayload(document), null);
setUpPrinting(() => report);
