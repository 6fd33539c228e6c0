/** What the page asks and the engine answers: what Rust's `request` and `engine` read and write. */

import type { Payload } from "./payload.js";

export type Request =
  | { ask: "about" }
  | { ask: "hold"; name: string }
  | ({ ask: "run" } & Setup)
  | { ask: "doses"; text: string }
  | { ask: "pin" }
  | { ask: "unpin" }
  | { ask: "save"; what: "report" | "traces" | "run" | "picture" };

/** A value of a setting as a run file has it. */
export type Value = boolean | number | string | { [name: string]: number | string };

export interface Setup {
  /** Name of a run file that the engine holds. */
  file: string | null;
  settings: Record<string, Value>;
  /** A file of doses, and the label of the one that is given. */
  dose: [string, string] | null;
  /** What the run is called among others. */
  label: string;
}

export interface Answer {
  about?: About;
  page?: Payload;
  /** Labels of doses, the control first. */
  doses?: string[];
  file?: { name: string; base64: string };
  error?: Failure;
}

export interface Failure {
  message: string;
  advice: string | null;
}

export interface About {
  version: string;
  /** JSON Schema of run files. */
  settings: { properties: Record<string, { properties?: Record<string, SettingSchema> }> };
  models: Model[];
  /** An example of a file of doses. */
  doses: string;
}

export interface SettingSchema {
  description: string;
  default?: Value;
  enum?: string[];
  oneOf?: { const: string; description: string }[];
  minimum?: number;
  maximum?: number;
  "x-unit"?: string;
  "x-bounds"?: string;
}

export interface Model {
  name: string;
  /** Whether its tension is scaled to a peak tension. */
  is_scaled: boolean;
  parameters: Parameter[];
}

export interface Parameter {
  name: string;
  value: number;
  unit: string;
  minimum: number;
  maximum: number;
  meaning: string;
  source: string;
}
