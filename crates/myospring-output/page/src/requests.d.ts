/** What the page asks and the engine answers: what Rust's `request` and `engine` read and write. */

import type { Payload } from "./payload.js";

export type Request =
  | { ask: "about" }
  | { ask: "hold"; name: string }
  | ({ ask: "run" } & Setup)
  | { ask: "doses"; text: string }
  | { ask: "pin" }
  | { ask: "unpin" }
  | { ask: "save"; what: "report" | "traces" | "run" | "picture" }
  | { ask: "save-all" }
  | { ask: "result"; name: string }
  | { ask: "keep" }
  | { ask: "kind"; name: string }
  | { ask: "settings"; name: string }
  | { ask: "model"; name: string }
  | { ask: "open"; name: string }
  | { ask: "cells"; settings: Record<string, Value> }
  | { ask: "outline"; settings: Record<string, Value>; name: string }
  | ({ ask: "analyse" } & Reading)
  | { ask: "track"; name: string; frame_rate_per_s: number | null; settings: Record<string, Value> }
  | { ask: "posts"; name: string; frame_rate_per_s: number | null; settings: Record<string, Value>; post_places: string | null; post_stiffness_un_per_um: number | null }
  | { ask: "map-waves"; name: string; frame_rate_per_s: number | null; pixel_size_um: number | null; stimulus_period_ms: number | null }
  | ({ ask: "traction" } & Displaced)
  | ({ ask: "fit"; settings: Record<string, Value>; free?: string[]; peak_shortening_pct: number | null } & Partial<OnGel> & Reading);

/** Displacements of a gel, or pictures of the beads in it, and what they do not say themselves. */
export interface Displaced {
  /** Two arrays of displacements, to the right and downward; or a film or a picture of beads. */
  files: string[];
  gel_modulus_kpa: number | null;
  gel_poisson: number | null;
  gel_thickness_um: number | null;
  pixel_size_um: number | null;
  /** What a displacement of 1 is; a pixel unless stated. */
  unit_um: number | null;
  /** Side of the squares in which displacements are, or were, measured. */
  subset_um: number | null;
  frame_rate_per_s: number | null;
  /** A picture of the relaxed gel. */
  reference: string | null;
  /** A picture or outlines of the cell. */
  cell: string | null;
}

/** A table of the force of the same cell on a gel. */
export interface OnGel {
  traction: string | null;
  gel_modulus_kpa: number | null;
}

/** A table of curves, and how it is read; whatever is absent is detected. */
export interface Reading {
  name: string;
  frame_rate_per_s: number | null;
  pixel_size_um: number | null;
  columns: string[];
  kind: string | null;
  unit: string | null;
  time_unit: string | null;
  from_ms: number | null;
  until_ms: number | null;
  stimulus_period_ms: number | null;
}

/** A value of a setting as a run file has it. */
export type Value = boolean | number | string | { [name: string]: number | string };

export interface Setup {
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
  results?: Results;
  kind?: "curves" | "outline" | "film" | "stack";
  picture?: ShownCells;
  settings?: Record<string, Value>;
  model?: Model;
  error?: Failure;
}

/** A picture with its cells, in columns and rows of the picture. */
export interface ShownCells {
  size: [number, number];
  /** Null where nothing says it; then no cell was sought. */
  pixel_size_um: number | null;
  /** Grey values in base64, one of each `every` columns and rows. */
  grey: string;
  every: number;
  cells: ShownCell[];
  taken: number | null;
  refused: string | null;
  notes: string[];
}

export interface ShownCell {
  number: number;
  name: string;
  area_um2: number;
  confidence: number;
  reasons: string[];
  rings: [number, number][][];
}

export interface Results {
  /** What the report of these results shows. */
  page: Payload | null;
  files: { name: string; bytes: number }[];
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
  anyOf?: { oneOf?: { const: string; description: string }[] }[];
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
