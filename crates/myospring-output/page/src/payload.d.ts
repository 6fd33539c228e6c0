/** What stands in the page as data: what Rust's `page::payload` writes. Numbers come in the units of their names. */

/** Numbers in bytes, little-endian, base64. */
export type Packed = string;

export interface Payload {
  /** Of this form. */
  form: 1;
  title: string;
  version: string;
  /** What the cell is coloured by at first. */
  colour: FieldKey;
  /** To know first: of the page as a whole. */
  warnings: string[];
  /** Settings in which the runs differ. */
  differences: Difference[];
  /** One for a report, several for a comparison; the first is what others are compared with. */
  runs: Run[];
  /** What the only run was fitted to. */
  fit: Fit | null;
}

export interface Fit {
  /** Whether the model follows the curves. */
  verdict: "fits" | "fits-nearly" | "does-not-fit";
  /** The same in a sentence. */
  headline: string;
  estimates: FittedNumber[];
  curves: FittedCurve[];
  profiles: Profile[];
  /** What is to be known of it, a sentence each. */
  notes: string[];
  figures: Figure[];
}

/** A number that was fitted, in words. */
export interface FittedNumber {
  name: string;
  meaning: string;
  value: string;
  /** 95 %; empty where there is none. */
  interval: string;
  verdict: string;
}

/** In the time of the run. */
export interface FittedCurve {
  /** With its unit. */
  label: string;
  unit: string;
  t_ms: number[];
  /** Of the frames that counted, and of the others. */
  measured: (number | null)[];
  left_out: (number | null)[];
  fitted: (number | null)[];
  /** Measured minus fitted. */
  residual: (number | null)[];
  /** Standard deviation of the noise at rest. */
  noise: number;
}

/** The likelihood of one number. */
export interface Profile {
  /** With its unit. */
  label: string;
  value: number;
  interval: [number | null, number | null];
  /** Value and rise of chi squared. */
  points: [number, number][];
  /** Rise at the ends of the interval. */
  at_ends: number;
}

export interface Figure {
  title: string;
  /** `data:image/svg+xml;base64,...` */
  light: string;
  dark: string;
  words: string;
  notes: string[];
}

export interface Difference {
  name: string;
  /** One for each run. */
  values: string[];
}

export interface Run {
  /** Short, to tell runs apart. */
  label: string;
  /** What was run, a fact each. */
  facts: string[];
  /** Stimuli that raised an action potential, or may have. */
  stimuli_ms: number[];
  /** Stimuli that raised none. */
  missed_ms: number[];
  curves: Curves;
  cell: Cell;
  metrics: MetricGroup[];
  parameters: ParameterGroup[];
  warnings: string[];
  /** What is known of the cell model and seen in this run. */
  about_model: string | null;
  /** The run file that repeats the run, TOML. */
  run_file: string;
  /** BibTeX. */
  citations: string;
  picture: Picture | null;
}

export interface Curves {
  t_ms: number[];
  list: Curve[];
}

export interface Curve {
  key: string;
  name: string;
  unit: string;
  values: (number | null)[];
  /** What is seen in experiments. */
  band: Band | null;
}

export interface Band {
  low: number;
  high: number;
  scope: string;
}

export interface Cell {
  /** Points at rest, um, x and y in turn: the corners of the squares, then the outline. f32. */
  rest_um: Packed;
  /** Four corners of each square, counter-clockwise. u32. */
  corners: Packed;
  /** As many squares are of the mesh; those after them carry its colour to the outline. */
  within: number;
  /** Direction of the fibre in each square, radians counter-clockwise from x. f32. */
  fibre: Packed;
  /** Points of each ring of the outline, after the corners of the squares. */
  rings: number[];
  frames: Frames;
  /** Side of a square, um. */
  spacing_um: number;
  /** By how much a point drawn may be off, um. */
  accuracy_um: number;
  fields: Field[];
}

export interface Frames {
  t_ms: number[];
  /** Displacement from rest of each point in each frame, x and y in turn, in steps of `step_um`. i16. */
  displacement: Packed;
  step_um: number;
  /** Active tension, kPa: its mean over the cell. */
  ta_kpa: number[];
  /** Active stress of each square in each frame, in steps of `stress_step_kpa`, where it differs. u16. */
  stress: Packed | null;
  stress_step_kpa: number;
}

/** What the cell can be coloured by. */
export interface Field {
  key: FieldKey;
  name: string;
  unit: string;
  /** What it is, in a sentence. */
  definition: string;
  /** Of the scale of colours. */
  low: number;
  high: number;
  /** Colours from low to high, equally far apart: `#rrggbb`. */
  colours: string[];
  /** Least and greatest value in the frames shown, as the program computed them on its own mesh. */
  extremes: [number, number];
}

export type FieldKey =
  | "fibre-strain"
  | "cross-strain"
  | "area-ratio"
  | "active-stress"
  | "displacement";

export interface MetricGroup {
  name: string;
  rows: Metric[];
}

export interface Metric {
  name: string;
  value: number | null;
  /** Why there is no value, in words, where there is none. */
  missing: string | null;
  /** Standard deviation over the beats, where there are several. */
  spread: number | null;
  unit: string;
  definition: string;
  /** Of measured, unloaded cells. */
  band: Band | null;
  /** Where the value lies against it. */
  place: "below" | "in" | "above" | null;
}

export interface ParameterGroup {
  name: string;
  rows: Parameter[];
}

export interface Parameter {
  name: string;
  value: string;
  unit: string;
  meaning: string;
  source: string;
  /** Whether it is neither the default nor the published one. */
  changed: boolean;
}

export interface Picture {
  /** `data:image/png;base64,...` */
  href: string;
  /** Lower left and upper right corner in the coordinates of the cell, um. */
  corners_um: [[number, number], [number, number]];
}
