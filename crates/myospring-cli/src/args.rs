//! The command line: names, help, examples.

use clap::builder::Styles;
use clap::builder::styling::AnsiColor;
use clap::{Args, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

const SHAPING: &str = "Shape";
const SEGMENTATION: &str = "Finding the cell in a picture";
const CELL: &str = "Cell model and stimulus";
const MATERIAL: &str = "Material and mechanics";
const NUMERICS: &str = "Numerics";
const OUTPUT: &str = "Output";

/// From a microscope picture of a heart cell to its beat.
#[derive(Debug, Parser)]
#[command(
    name = "myospring", version, styles = STYLES, max_term_width = 100,
    arg_required_else_help = true,
    after_help = "Examples:\n  \
        myospring run                                     beat the built-in cell\n  \
        myospring run cell.tif --pixel-size \"0.27 um\"     beat the cell of a picture\n  \
        myospring segment cell.tif                        only find its outline\n  \
        myospring batch pictures                          beat the cells of a whole folder\n  \
        myospring init beat.toml && myospring run beat.toml\n  \
        myospring paper                                   reproduce Figs 3, 5 and 6\n\n\
        Values carry their unit: \"50 kPa\", \"1.1 um\", \"600 ms\", \"30 deg\".\n\
        Exit codes: 0 done, 1 a run stopped early or a check was not met, 2 bad input or usage."
)]
pub(crate) struct Cli {
    /// Print what to cite, as BibTeX
    #[arg(long, global = true)]
    pub(crate) cite: bool,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Beat a cell: curves, figures and numbers
    Run(Box<RunArgs>),
    /// Reproduce the paper's Figs 3, 5 and 6 and check every number that it states
    Paper(PaperArgs),
    /// Find the cells of a picture: outlines, their shapes and how sure they are; nothing beats
    Segment(SegmentArgs),
    /// Beat the cells of a whole folder of pictures: one row a cell
    Batch(Box<BatchArgs>),
    /// Mesh a cell and report; nothing beats
    Mesh(MeshArgs),
    /// List the cell models, or the parameters of one
    Models(ModelsArgs),
    /// Write a commented run file with every key and its default
    Init(InitArgs),
    /// Print the JSON Schema of run files
    Schema,
}

/// Where the cell's shape comes from.
#[derive(Debug, Args)]
pub(crate) struct ShapeArgs {
    /// Side of one pixel of a picture ("0.27 um") [default: what the picture says of itself]
    #[arg(long, value_name = "LENGTH", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) pixel_size: Option<String>,
    /// In a label mask, the grey value of the cell
    #[arg(long, value_name = "N", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) label: Option<i64>,
    /// Distance of neighbouring masses ("1.1 um"); by default about 2000 masses
    #[arg(long, value_name = "LENGTH", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) spacing: Option<String>,
    /// Turn an outline or the built-in cell counter-clockwise ("30 deg")
    #[arg(long, value_name = "ANGLE", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) rotate: Option<String>,
    #[command(flatten)]
    pub(crate) segmentation: SegmentationArgs,
}

/// How the cell of a picture is found.
#[derive(Debug, Args)]
pub(crate) struct SegmentationArgs {
    /// How the picture was taken: auto, fluorescence, brightfield, mask [default: auto]
    #[arg(long, value_name = "NAME", help_heading = SEGMENTATION)]
    pub(crate) modality: Option<String>,
    /// Channel of the picture, from 0 [default: the first; of a colour picture its luminance]
    #[arg(long, value_name = "N", help_heading = SEGMENTATION, allow_hyphen_values = true)]
    pub(crate) channel: Option<i64>,
    /// Frame (time point) of the picture, from 0 [default: 0]
    #[arg(long, value_name = "N", help_heading = SEGMENTATION, allow_hyphen_values = true)]
    pub(crate) frame: Option<i64>,
    /// Of a stack in depth: max, mean, or the number of a slice, from 0 [default: max]
    #[arg(long, value_name = "max|mean|N", help_heading = SEGMENTATION)]
    pub(crate) z: Option<String>,
    /// Less takes in more. Fluorescence: grey value above which a pixel is cell; brightfield: least relative
    /// change of brightness per um that is an edge [default: found from the picture, and printed]
    #[arg(long, value_name = "NUMBER", help_heading = SEGMENTATION, allow_hyphen_values = true)]
    pub(crate) threshold: Option<f64>,
    /// Scale of smoothing [default: "0.5 um" for fluorescence, "0.8 um" for brightfield]
    #[arg(long, value_name = "LENGTH", help_heading = SEGMENTATION, allow_hyphen_values = true)]
    pub(crate) smooth: Option<String>,
    /// Take the cell at this place: column and row in pixels from the top left ("120,85")
    #[arg(long, value_name = "X,Y", help_heading = SEGMENTATION, allow_hyphen_values = true)]
    pub(crate) seed: Option<String>,
    /// Which cell: largest, or a number by size, 1 being the largest; segment and batch also take all
    /// [default: largest; batch: all]
    #[arg(long, value_name = "all|largest|N", help_heading = SEGMENTATION)]
    pub(crate) cell: Option<String>,
    /// Take a cell although the frame of the picture cuts it
    #[arg(long, help_heading = SEGMENTATION)]
    pub(crate) allow_cut: bool,
    /// Outline drawn on the picture elsewhere, instead of finding it (.geojson, .roi, .zip, Cellpose's .txt)
    #[arg(long, value_name = "FILE", help_heading = SEGMENTATION)]
    pub(crate) outline: Option<String>,
}

/// What beats, and where its shape comes from.
#[derive(Debug, Args)]
pub(crate) struct BeatArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) simulation: SimulationArgs,
}

impl BeatArgs {
    /// Options that stand for a key of the run file.
    pub(crate) fn overrides(&self) -> Overrides {
        given(self.shape.rows().into_iter().chain(self.simulation.rows()))
    }
}

impl ShapeArgs {
    /// Options that stand for a key of the run file.
    pub(crate) fn overrides(&self) -> Overrides {
        given(self.rows())
    }

    fn rows(&self) -> Rows {
        let mut rows = vec![
            ("--pixel-size", "shape.pixel_size", text(self.pixel_size.as_ref())),
            ("--label", "shape.label", number(self.label)),
            ("--spacing", "shape.spacing", text(self.spacing.as_ref())),
            ("--rotate", "shape.rotate", text(self.rotate.as_ref())),
        ];
        rows.extend(self.segmentation.rows());
        rows
    }
}

impl SegmentationArgs {
    /// Whether every cell was asked for.
    pub(crate) fn all(&self) -> bool {
        self.cell.as_deref() == Some("all")
    }

    /// Options that stand for a key of the run file: option, key, value. `--cell all` is none.
    fn rows(&self) -> Rows {
        let cell = self.cell.as_ref().filter(|_| !self.all());
        vec![
            ("--modality", "segmentation.modality", text(self.modality.as_ref())),
            ("--channel", "segmentation.channel", number(self.channel)),
            ("--frame", "segmentation.frame", number(self.frame)),
            ("--z", "segmentation.z", text(self.z.as_ref())),
            ("--threshold", "segmentation.threshold", self.threshold.map(toml::Value::Float)),
            ("--smooth", "segmentation.smooth", text(self.smooth.as_ref())),
            ("--seed", "segmentation.seed", text(self.seed.as_ref())),
            ("--cell", "segmentation.cell", text(cell)),
            ("--allow-cut", "segmentation.allow_cut", yes(self.allow_cut)),
            ("--outline", "segmentation.outline", text(self.outline.as_ref())),
        ]
    }
}

/// An option that stands for a key of the run file: option, key, value.
type Row = (&'static str, &'static str, Option<toml::Value>);
type Rows = Vec<Row>;

/// What overrides a run file: option, key, value.
pub(crate) type Overrides = Vec<(&'static str, &'static str, toml::Value)>;

fn text(value: Option<&String>) -> Option<toml::Value> {
    value.cloned().map(toml::Value::String)
}

fn number(value: Option<i64>) -> Option<toml::Value> {
    value.map(toml::Value::Integer)
}

fn yes(flag: bool) -> Option<toml::Value> {
    flag.then_some(toml::Value::Boolean(true))
}

fn given(rows: impl IntoIterator<Item = Row>) -> Overrides {
    rows.into_iter().filter_map(|(name, key, value)| Some((name, key, value?))).collect()
}

/// Where results go and what is printed.
#[derive(Debug, Args)]
pub(crate) struct OutputArgs {
    /// Folder for the results [default: results/NAME]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
    /// Replace results that are already there
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
    /// Print results as JSON
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// No progress bar and no notes
    #[arg(short, long, help_heading = OUTPUT)]
    pub(crate) quiet: bool,
}

/// `myospring run`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring run\n  \
    myospring run --peak-tension \"40 kPa\" --beats 3 --output three-beats\n  \
    myospring run cell.tif --pixel-size \"0.27 um\" --spacing \"1 um\"\n  \
    myospring run cell.tif --fibre picture --stain z-disc --integrator quasi-static\n  \
    myospring run cell.tif --outline mended.roi\n  \
    myospring run --support elastic-bed --bed-stiffness \"0.5 kPa/um\"\n  \
    myospring run beat.toml --dry-run\n\n\
    Results: traces.csv, summary.json, figures/ (SVG and PNG), run.toml (every setting), run.json\n\
    (version, hashes, timings).")]
pub(crate) struct RunArgs {
    /// Picture or mask (.png, .tif), outline (.geojson, .json, .csv, .roi, .zip, .txt) or run file (.toml);
    /// without it, the built-in adult ventricular cell
    #[arg(value_name = "PICTURE|OUTLINE|RUN.toml")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) beat: BeatArgs,
    /// Threads that move the masses; the numbers do not depend on it [default: a core for every 8000
    /// masses, as far as there are cores]
    #[arg(long, value_name = "N", help_heading = NUMERICS)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Check everything, mesh the cell, print the plan; write nothing
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// What beats, and how.
#[derive(Debug, Args)]
pub(crate) struct SimulationArgs {
    /// Cell model; `myospring models` lists them
    #[arg(long, value_name = "NAME", help_heading = CELL)]
    pub(crate) model: Option<String>,
    /// Peak of the active tension ("50 kPa")
    #[arg(long, value_name = "TENSION", help_heading = CELL, allow_hyphen_values = true)]
    pub(crate) peak_tension: Option<String>,
    /// Whose peak is scaled to that: published (of the model's published parameters; changed ones make the
    /// cell stronger or weaker) or own-peak (the model's own, whatever its parameters) [default: published]
    #[arg(long, value_name = "NAME", help_heading = CELL)]
    pub(crate) tension_scale: Option<String>,
    /// Number of stimuli
    #[arg(long, value_name = "N", help_heading = CELL, allow_hyphen_values = true)]
    pub(crate) beats: Option<i64>,
    /// Time from one stimulus to the next ("1000 ms")
    #[arg(long, value_name = "TIME", help_heading = CELL, allow_hyphen_values = true)]
    pub(crate) cycle_length: Option<String>,
    /// Integrate the cell model as the authors of `coelho_2021` did
    #[arg(long, help_heading = CELL)]
    pub(crate) authors_step: bool,
    /// Young's modulus ("308 kPa")
    #[arg(long, value_name = "MODULUS", help_heading = MATERIAL, allow_hyphen_values = true)]
    pub(crate) young_modulus: Option<String>,
    /// Thickness of the cell ("10 um")
    #[arg(long, value_name = "LENGTH", help_heading = MATERIAL, allow_hyphen_values = true)]
    pub(crate) thickness: Option<String>,
    /// What keeps the area: gradient, barycentric, printed
    #[arg(long, value_name = "LAW", help_heading = MATERIAL)]
    pub(crate) area_law: Option<String>,
    /// How the tension acts: fibre, ends
    #[arg(long, value_name = "LAW", help_heading = MATERIAL)]
    pub(crate) active: Option<String>,
    /// Fibre direction: "long axis", an angle ("15 deg"), or picture, which reads it from stripes or filaments
    /// [default: long axis]
    #[arg(long, value_name = "DIRECTION", help_heading = MATERIAL, allow_hyphen_values = true)]
    pub(crate) fibre: Option<String>,
    /// What the picture shows, for --fibre picture: z-disc (stripes across the fibre, such as alpha-actinin) or
    /// filament (along it, such as phalloidin) [default: z-disc]
    #[arg(long, value_name = "NAME", help_heading = MATERIAL)]
    pub(crate) stain: Option<String>,
    /// Scale over which --fibre picture averages directions [default: "3 um"]
    #[arg(long, value_name = "LENGTH", help_heading = MATERIAL, allow_hyphen_values = true)]
    pub(crate) fibre_smoothing: Option<String>,
    /// What holds the cell: mass-centre, clamped-end, clamped-ends, spring-held-ends, elastic-bed
    #[arg(long, value_name = "KIND", help_heading = MATERIAL)]
    pub(crate) support: Option<String>,
    /// Stiffness of each spring of spring-held-ends, such as a carbon fibre ("100 nN/um")
    #[arg(long, value_name = "STIFFNESS", help_heading = MATERIAL, allow_hyphen_values = true)]
    pub(crate) end_stiffness: Option<String>,
    /// Stiffness of an elastic-bed, such as a gel, traction per displacement ("0.5 kPa/um")
    #[arg(long, value_name = "STIFFNESS", help_heading = MATERIAL, allow_hyphen_values = true)]
    pub(crate) bed_stiffness: Option<String>,
    /// Time simulated ("600 ms"); by default 550 ms after the last stimulus
    #[arg(long, value_name = "TIME", help_heading = NUMERICS, allow_hyphen_values = true)]
    pub(crate) duration: Option<String>,
    /// verlet (in time, as in the paper) or quasi-static (along the equilibria, many times faster);
    /// also stoermer-verlet, velocity-verlet [default: verlet]
    #[arg(long, value_name = "NAME", help_heading = NUMERICS)]
    pub(crate) integrator: Option<String>,
    /// Mechanical time step of Verlet's method ("0.004 ms"); by default 0.95 of the stability limit
    #[arg(long, value_name = "TIME", help_heading = NUMERICS, allow_hyphen_values = true)]
    pub(crate) time_step: Option<String>,
}

impl SimulationArgs {
    /// The option that names the cell model.
    pub(crate) fn model(&self) -> Overrides {
        given(self.rows().into_iter().filter(|(_, key, _)| *key == "cell.model"))
    }

    fn rows(&self) -> Rows {
        vec![
            ("--model", "cell.model", text(self.model.as_ref())),
            ("--peak-tension", "cell.peak_tension", text(self.peak_tension.as_ref())),
            ("--tension-scale", "cell.tension_scale", text(self.tension_scale.as_ref())),
            ("--authors-step", "cell.authors_step", yes(self.authors_step)),
            ("--beats", "stimulus.beats", number(self.beats)),
            ("--cycle-length", "stimulus.cycle_length", text(self.cycle_length.as_ref())),
            ("--young-modulus", "material.young_modulus", text(self.young_modulus.as_ref())),
            ("--thickness", "material.thickness", text(self.thickness.as_ref())),
            ("--area-law", "material.area_law", text(self.area_law.as_ref())),
            ("--active", "mechanics.active", text(self.active.as_ref())),
            ("--fibre", "mechanics.fibre", text(self.fibre.as_ref())),
            ("--stain", "mechanics.stain", text(self.stain.as_ref())),
            ("--fibre-smoothing", "mechanics.fibre_smoothing", text(self.fibre_smoothing.as_ref())),
            ("--support", "mechanics.support", text(self.support.as_ref())),
            ("--end-stiffness", "mechanics.end_stiffness", text(self.end_stiffness.as_ref())),
            ("--bed-stiffness", "mechanics.bed_stiffness", text(self.bed_stiffness.as_ref())),
            ("--integrator", "numerics.integrator", text(self.integrator.as_ref())),
            ("--time-step", "numerics.time_step", text(self.time_step.as_ref())),
            ("--duration", "run.duration", text(self.duration.as_ref())),
        ]
    }
}

/// `myospring paper`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myospring paper\n  myospring paper --output paper --threads 1"
)]
pub(crate) struct PaperArgs {
    /// Threads for the three runs, at most one for each core; the numbers do not depend on it [default:
    /// all cores]
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<usize>,
    /// Distance of neighbouring masses ("1.2 um"), to see that the answer does not depend on it
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) spacing: Option<String>,
    /// verlet (the paper's) or quasi-static, to see that the answer does not depend on it
    /// [default: verlet]
    #[arg(long, value_name = "NAME")]
    pub(crate) integrator: Option<String>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring mesh`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring mesh cell.png --pixel-size \"0.27 um\"\n  \
    myospring mesh cell.geojson --spacing \"0.8 um\" --output mesh")]
pub(crate) struct MeshArgs {
    /// Picture or mask (.png, .tif), outline (.geojson, .json, .csv, .roi, .zip, .txt) or run file (.toml);
    /// without it, the built-in cell
    #[arg(value_name = "PICTURE|OUTLINE|RUN.toml")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring segment`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring segment cell.tif                                 look at results/cell_outline/overlay.png\n  \
    myospring segment cell.tif --pixel-size \"0.27 um\" --output cell.roi      mend it in Fiji, then\n  \
    myospring run cell.tif --pixel-size \"0.27 um\" --outline cell.roi         come back\n  \
    myospring segment dish.tif --cell all -o cells.zip -o cells_mask.png\n\n\
    The ending of each --output says what it holds: .geojson (um), .roi or .zip (ImageJ), .txt (Cellpose),\n\
    .png (mask; with --cell all a label mask). An overlay is written beside the first of them.")]
pub(crate) struct SegmentArgs {
    /// Picture (.png, .tif)
    #[arg(value_name = "PICTURE")]
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// File for the outline; may be given several times [default: a folder `results/NAME_outline` with all]
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    pub(crate) output: Vec<PathBuf>,
    /// Replace files that are already there
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
    /// Print the report as JSON
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// No notes
    #[arg(short, long, help_heading = OUTPUT)]
    pub(crate) quiet: bool,
}

/// `myospring batch`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring batch pictures --pixel-size \"0.27 um\" --output beats\n  \
    myospring batch pictures --pattern \"*_actinin.tif\" --integrator quasi-static --figures\n\n\
    Results: cells.csv, one row a cell, failed pictures with their reason; cells.parquet, the same; overlays/;\n\
    with --figures a folder for each cell. Interrupted, the same command goes on where it was.\n\
    Exit codes: 0 all pictures gave a cell that beat, 1 some failed, 2 bad input or usage.")]
pub(crate) struct BatchArgs {
    /// Folder of pictures (.png, .tif), searched with all folders in it
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Only files whose name matches (* and ? stand for anything) [default: *.png, *.tif, *.tiff]
    #[arg(long, value_name = "PATTERN")]
    pub(crate) pattern: Option<String>,
    /// Pictures at a time, at most one for each core [default: all cores]
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) beat: BeatArgs,
    /// Write curves and figures of each cell, in a folder of its own
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) figures: bool,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring models`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  myospring models\n  myospring models coelho_2021 --json")]
pub(crate) struct ModelsArgs {
    /// Show the parameters of this model
    pub(crate) name: Option<String>,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// `myospring init`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  myospring init beat.toml\n  myospring init > beat.toml")]
pub(crate) struct InitArgs {
    /// File to write; without it, the run file goes to stdout
    pub(crate) file: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    pub(crate) force: bool,
}
