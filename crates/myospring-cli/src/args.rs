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
        myospring run cell.png --pixel-size \"0.27 um\"     beat the cell of a mask\n  \
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
    /// Side of one pixel of a picture ("0.27 um"); never guessed
    #[arg(long, value_name = "LENGTH", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) pixel_size: Option<String>,
    /// In a label picture, the grey value of the cell
    #[arg(long, value_name = "N", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) label: Option<i64>,
    /// Distance of neighbouring masses ("1.1 um"); by default about 2000 masses
    #[arg(long, value_name = "LENGTH", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) spacing: Option<String>,
    /// Turn an outline or the built-in cell counter-clockwise ("30 deg")
    #[arg(long, value_name = "ANGLE", help_heading = SHAPING, allow_hyphen_values = true)]
    pub(crate) rotate: Option<String>,
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
    myospring run cell.png --pixel-size \"0.27 um\" --spacing \"1 um\"\n  \
    myospring run cell.png --pixel-size \"0.27 um\" --integrator quasi-static\n  \
    myospring run --support elastic-bed --bed-stiffness \"0.5 kPa/um\"\n  \
    myospring run beat.toml --dry-run\n\n\
    Results: traces.csv, summary.json, figures/ (SVG and PNG), run.toml (every setting), run.json\n\
    (version, hashes, timings).")]
pub(crate) struct RunArgs {
    /// Mask (.png, .tif), outline in um (.geojson, .json, .csv) or run file (.toml); without it,
    /// the built-in adult ventricular cell
    #[arg(value_name = "PICTURE|OUTLINE|RUN.toml")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Cell model; `myospring models` lists them
    #[arg(long, value_name = "NAME", help_heading = CELL)]
    pub(crate) model: Option<String>,
    /// Peak of the active tension ("50 kPa")
    #[arg(long, value_name = "TENSION", help_heading = CELL, allow_hyphen_values = true)]
    pub(crate) peak_tension: Option<String>,
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
    /// Fibre direction: "long axis" or an angle ("15 deg")
    #[arg(long, value_name = "DIRECTION", help_heading = MATERIAL, allow_hyphen_values = true)]
    pub(crate) fibre: Option<String>,
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
    /// Threads that move the masses; the numbers do not depend on it [default: a core for every 900
    /// masses, as far as there are cores]
    #[arg(long, value_name = "N", help_heading = NUMERICS)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Mechanical time step of Verlet's method ("0.004 ms"); by default 0.95 of the stability limit
    #[arg(long, value_name = "TIME", help_heading = NUMERICS, allow_hyphen_values = true)]
    pub(crate) time_step: Option<String>,
    /// Check everything, mesh the cell, print the plan; write nothing
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

impl RunArgs {
    /// Options that stand for a key of the run file: option, key, value.
    pub(crate) fn overrides(&self) -> Vec<(&'static str, &'static str, toml::Value)> {
        let text = |value: &Option<String>| value.clone().map(toml::Value::String);
        let number = |value: Option<i64>| value.map(toml::Value::Integer);
        let rows = [
            ("--pixel-size", "shape.pixel_size", text(&self.shape.pixel_size)),
            ("--label", "shape.label", number(self.shape.label)),
            ("--spacing", "shape.spacing", text(&self.shape.spacing)),
            ("--rotate", "shape.rotate", text(&self.shape.rotate)),
            ("--model", "cell.model", text(&self.model)),
            ("--peak-tension", "cell.peak_tension", text(&self.peak_tension)),
            (
                "--authors-step",
                "cell.authors_step",
                self.authors_step.then_some(toml::Value::Boolean(true)),
            ),
            ("--beats", "stimulus.beats", number(self.beats)),
            ("--cycle-length", "stimulus.cycle_length", text(&self.cycle_length)),
            ("--young-modulus", "material.young_modulus", text(&self.young_modulus)),
            ("--thickness", "material.thickness", text(&self.thickness)),
            ("--area-law", "material.area_law", text(&self.area_law)),
            ("--active", "mechanics.active", text(&self.active)),
            ("--fibre", "mechanics.fibre", text(&self.fibre)),
            ("--support", "mechanics.support", text(&self.support)),
            ("--end-stiffness", "mechanics.end_stiffness", text(&self.end_stiffness)),
            ("--bed-stiffness", "mechanics.bed_stiffness", text(&self.bed_stiffness)),
            ("--integrator", "numerics.integrator", text(&self.integrator)),
            ("--time-step", "numerics.time_step", text(&self.time_step)),
            ("--duration", "run.duration", text(&self.duration)),
        ];
        rows.into_iter().filter_map(|(name, key, value)| Some((name, key, value?))).collect()
    }
}

/// `myospring paper`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myospring paper\n  myospring paper --output paper --threads 1"
)]
pub(crate) struct PaperArgs {
    /// Threads for the three runs; the numbers do not depend on it [default: all cores]
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
    /// Mask (.png, .tif), outline in um (.geojson, .json, .csv) or run file (.toml); without it,
    /// the built-in cell
    #[arg(value_name = "PICTURE|OUTLINE|RUN.toml")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

impl MeshArgs {
    /// Options that stand for a key of the run file.
    pub(crate) fn overrides(&self) -> Vec<(&'static str, &'static str, toml::Value)> {
        let text = |value: &Option<String>| value.clone().map(toml::Value::String);
        let rows = [
            ("--pixel-size", "shape.pixel_size", text(&self.shape.pixel_size)),
            ("--label", "shape.label", self.shape.label.map(toml::Value::Integer)),
            ("--spacing", "shape.spacing", text(&self.shape.spacing)),
            ("--rotate", "shape.rotate", text(&self.shape.rotate)),
        ];
        rows.into_iter().filter_map(|(name, key, value)| Some((name, key, value?))).collect()
    }
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
