/** What stands in the page as data: what Rust's `page::payload` writes. Numbers come in the units of their names. */

/** Numbers in bytes, little-endian, base64. */
export type Packed = string;

export interface Payload {
  /** Of this form. */
  form: 2;
  /** What the page is, above its title. */
  kind: string;
  title: string;
  version: string;
  /** What was done to what, a few words each. */
  facts: string[];
  answer: Answer | null;
  /** What to know first. */
  warnings: string[];
  /** Lists of times of the curves, ms. */
  times_ms: number[][];
  sections: Section[];
}

/** The answer in one line. */
export interface Answer {
  words: string;
  quality: "good" | "fair" | "poor";
}

/** A heading with what is below it. */
export interface Section {
  id: string;
  title: string;
  /** How to read it. */
  hint: string;
  parts: Part[];
}

export type Part =
  | Beat
  | { kind: "charts"; charts: ChartData[] }
  | { kind: "profiles"; profiles: Profile[] }
  | { kind: "tiles"; tiles: Tile[] }
  | Table
  | { kind: "gallery"; thumbnails: Thumbnail[] }
  | Figure
  | { kind: "words"; words: string[] }
  | Text
  | Folded;

/** Beating cells with the curves that go with them. */
export interface Beat {
  kind: "beat";
  /** What the cells are coloured by at first. */
  colour: FieldKey;
  /** One, or several that are compared with the first. */
  cells: Cell[];
  charts: ChartData[];
  /** Of the charts that unfold. */
  folded_title: string;
  folded: ChartData[];
  /** What is known of what is seen. */
  words: string;
}

/** A quantity over time. */
export interface ChartData {
  name: string;
  unit: string;
  /** How to read it; empty where that is clear. */
  note: string;
  /** A band of values behind the curves. */
  band: [number, number] | null;
  series: Series[];
  /** Stimuli that were captured, or may have been. */
  stimuli_ms: number[];
  /** Stimuli that were not. */
  missed_ms: number[];
  /** Parts of the time that stand out. */
  spans: { from_ms: number; to_ms: number; words: string }[];
  /** Places on the curve, with their words beside them; those that do not count are grey. */
  dots: { t_ms: number; value: number; words: string; side: "left" | "right" | "out"; counts: boolean }[];
}

export interface Series {
  label: string;
  /** Its colour: what it shows, or the index of a run. */
  tone: string;
  /** Points without a line: what was measured. */
  dotted: boolean;
  /** Which of the lists of times. */
  times: number;
  values: (number | null)[];
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

/** A key number. */
export interface Tile {
  name: string;
  definition?: string;
  /** Of several things each with its name. */
  values: [string, Entry][];
  /** What is said of it. */
  lines: Entry[];
}

export interface Table {
  kind: "table";
  caption: string;
  look: "wide" | "sortable" | "numbers" | "parameters";
  columns: { name: string; definition?: string; class?: string }[];
  rows: { cells: Entry[]; marked?: true }[];
}

/** What a table or a tile says in one place: text, a number or, where there is neither, a dash. */
export interface Entry {
  text?: string;
  number?: number;
  /** Standard deviation. */
  spread?: number;
  unit?: string;
  /** What the text is. */
  definition?: string;
  /** What is said below it. */
  note?: string;
  mark?: Mark;
  /** The number that it is compared with. */
  against?: [number | null];
}

/** A verdict: a filled dot where it is good. */
export interface Mark {
  good: boolean;
  words: string;
}

export interface Thumbnail {
  name: string;
  words: string;
  mark?: Mark;
  /** `data:image/png;base64,...` */
  image: string;
}

export interface Figure {
  kind: "figure";
  /** For those who cannot see it. */
  words: string;
  /** Addresses of images. */
  light: string;
  dark: string;
}

/** Text to copy or to keep as a file. */
export interface Text {
  kind: "text";
  what: string;
  file: string;
  text: string;
}

/** Parts that unfold. */
export interface Folded {
  kind: "folded";
  title: string;
  on_paper: boolean;
  parts: Part[];
}

/** A cell that moves. */
export interface Cell {
  /** Its name among others. */
  label: string;
  /** When it contracts most, ms. */
  peak_ms: number;
  picture: Picture | null;
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
  /** The same cell in space, if it is thick. */
  thick: Thick | null;
}

/** A thick cell: its surface. */
export interface Thick {
  /** Points at rest, um, x, y and z in turn. f32 */
  rest_um: Packed;
  /** Four corners of each patch, counter-clockwise seen from outside; the last two of a triangle are one. u32. */
  corners: Packed;
  /** Direction of the long axis seen from above, radians counter-clockwise from x. */
  long_axis: number;
  /** Upright sections through the middle, along the long axis and across it: grids that fit into the surface. */
  sections: [SectionPart[], SectionPart[]];
  frames: ThickFrames;
  /** Side of a patch, um. */
  spacing_um: number;
  /** By how much a point drawn may be off, um. */
  accuracy_um: number;
  fields: ThickField[];
}

/** A grid of a section: stations, each with points that lie evenly from the lower to the upper side. */
export interface SectionPart {
  /** Points of each station. */
  layers: number;
  /** Points of the surface whose weighted sum is the lower and the upper end of each station in turn, four of each. u32. */
  ends: Packed;
  /** Their weights. f32. */
  weights: Packed;
}

export interface ThickFrames {
  t_ms: number[];
  /** Displacement from rest of each point in each frame, x, y and z in turn, in steps of `step_um`. i16. */
  displacement: Packed;
  step_um: number;
  /** Length, width and thickness of the mesh in each frame, um. */
  size_um: [number, number, number][];
}

/** What a thick cell can be coloured by. */
export interface ThickField extends Field {
  /** The value of each point of the surface, then of the sections station by station, in each frame, in 255 steps from `low` to `high`. u8. */
  values: Packed;
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
  /** Traction on the gel of each square in each frame, x and y in turn, in steps of `traction_step_pa`. i16. */
  traction: Packed | null;
  traction_step_pa: number;
  /** Membrane potential of each square in each frame, in steps of `potential_step_mv`, where it differs. i16. */
  potential: Packed | null;
  potential_step_mv: number;
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
  | "volume-ratio"
  | "active-stress"
  | "displacement"
  | "traction"
  | "potential";

export interface Picture {
  /** `data:image/png;base64,...` */
  href: string;
  /** Lower left and upper right corner in the coordinates of the cell, um. */
  corners_um: [[number, number], [number, number]];
}
