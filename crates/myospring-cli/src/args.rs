//! The command line: names, help, examples.

mod measured;
mod output;

pub(crate) use measured::{AnalyseArgs, FitArgs, StimulusArgs, TableArgs};
pub(crate) use output::{OUTPUT, OutputArgs};

use crate::look::Look;
use crate::options::{Beat, Meshed, Seen, Settings};
use crate::outputs;
use clap::builder::styling::AnsiColor;
use clap::builder::{PossibleValue, PossibleValuesParser, Styles};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use myospring::cell_files::Choices;
use myospring::run_file::PRESETS;
use std::num::NonZeroUsize;
use std::path::PathBuf;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// Headings of options that are not settings.
const CELL: &str = "Cell model and stimulus";
const NUMERICS: &str = "Numerics";
const FILM: &str = "Film";
const POSTS: &str = "Posts of a tissue";

/// From a microscope picture of a heart cell to its beat.
#[derive(Debug, Parser)]
#[command(
    name = "myospring", version, styles = STYLES, max_term_width = 100,
    arg_required_else_help = true,
    after_help = "Examples:\n  \
        myospring run                                     simulate the built-in cell\n  \
        myospring run cell.tif --pixel-size \"0.27 um\"     simulate the cell of a picture\n  \
        myospring segment cell.tif                        only find its outline\n  \
        myospring track film.avi --pixel-size \"0.2 um\"    follow the cell of a film\n  \
        myospring batch pictures                          simulate the cells of a whole folder\n  \
        myospring analyse cell.csv                        measure the beats of a curve\n  \
        myospring fit cell.tif --to cell.csv              find that cell's own parameters\n  \
        myospring compare results/a results/b             compare two results\n  \
        myospring init beat.toml && myospring run beat.toml\n  \
        myospring paper                                   reproduce Figs 3, 5 and 6\n\n\
        Values carry their unit: \"50 kPa\", \"1.1 um\", \"600 ms\", \"30 deg\".\n\
        Exit codes: 0 done, 1 a run stopped early or a check failed, 2 bad input or usage, or results could \
        not be written, 129 ended as the terminal was closed, 130 by Ctrl-C, 143 by SIGTERM."
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
    /// Simulate the beat of a cell: curves, figures and numbers
    #[command(aliases = ["simulate", "beat"])]
    Run(Box<RunArgs>),
    /// Reproduce the paper's Figs 3, 5 and 6 and check every number that it states
    Paper(PaperArgs),
    /// Find the cells of a picture, without a simulation: outlines, shapes and confidence
    #[command(alias = "outline")]
    Segment(SegmentArgs),
    /// Track a cell in a film: length, stretches and sarcomeres over time, and the motion of its
    /// points
    Track(TrackArgs),
    /// Simulate the cells of a whole folder of pictures: one row per cell
    Batch(Box<BatchArgs>),
    /// Analyse the beats of measured curves: every metric of every beat, and where it was read
    #[command(alias = "analyze")]
    Analyse(Box<AnalyseArgs>),
    /// Find the tractions of a cell from displacements of the gel beneath it
    Traction(TractionArgs),
    /// Fit a cell's own parameters to its measured curve, with confidence intervals
    Fit(Box<FitArgs>),
    /// Compare runs: curves, cells and a table of differences; factors and doses
    Compare(Box<CompareArgs>),
    /// Run many simulations with varied numbers: sensitivity analyses and populations
    Study(StudyArgs),
    /// Mesh a cell and report on the mesh, without a simulation
    Mesh(MeshArgs),
    /// List the cell models, or the parameters of one
    #[command(alias = "model")]
    Models(ModelsArgs),
    /// Write a commented run file with every key and its default
    Init(InitArgs),
    /// Print the JSON Schema of run files or of studies
    Schema(SchemaArgs),
    /// Print a script that completes commands and options in a shell
    Completions(CompletionsArgs),
    /// Write the manual pages
    Manual(ManualArgs),
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
    myospring run --outputs none --frame-interval \"2 ms\"\n  \
    myospring run beat.toml --dry-run\n\n\
    Results: traces.csv, summary.json, fibres.csv (where the picture shows fibres), run.toml (every \
    setting) and run.json (version, hashes, timings), always; in addition what --outputs names.")]
pub(crate) struct RunArgs {
    /// Picture or mask (.png, .tif), outline (.geojson, .json, .csv, .roi, .zip, .txt) or run file (.toml);
    /// without it, the built-in adult ventricular cell
    #[arg(value_name = "PICTURE|OUTLINE|RUN.toml")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) settings: Settings<Beat>,
    /// Factors on numbers of the run, separated by commas: parameters of the cell model or settings
    /// (`tau_si=1.2,peak_tension=0.7`); run.toml has the products
    #[arg(long, value_name = "NAME=FACTOR,...", allow_hyphen_values = true, help_heading = CELL)]
    pub(crate) scale: Option<String>,
    /// Threads of the integrator; results do not depend on it [default: one core for every 8000
    /// masses (4000 of a thick cell), at most all cores]
    #[arg(long, value_name = "N", help_heading = NUMERICS)]
    pub(crate) threads: Option<NonZeroUsize>,
    #[arg(long, value_name = "WORDS", value_delimiter = ',', value_parser = outputs::words(),
          help = outputs::help(), help_heading = OUTPUT)]
    pub(crate) outputs: Option<Vec<String>>,
    #[command(flatten)]
    pub(crate) look: Look,
    /// Check everything, mesh the cell, print the plan; write nothing
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring paper`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myospring paper\n  myospring paper --output paper --threads 1"
)]
pub(crate) struct PaperArgs {
    /// Threads for the three runs, at most one per core; results do not depend on it [default: all
    /// cores]
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<usize>,
    /// Distance between neighbouring masses ("1.2 um"), to check that results do not depend on it
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) spacing: Option<String>,
    /// verlet (the paper's) or quasi-static, to check that results do not depend on it [default:
    /// verlet]
    #[arg(long, value_name = "NAME")]
    pub(crate) integrator: Option<String>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring compare`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring compare results/control results/treated\n  \
    myospring compare weak.toml usual.toml strong.toml --integrator quasi-static\n  \
    myospring compare --scale peak_tension=0.6 --scale peak_tension=0.8     Fig. 6 of the paper\n  \
    myospring compare cell.tif --pixel-size \"0.27 um\" --scale tau_si=1.05,thickness=0.9\n  \
    myospring compare beat.toml --doses drug.toml     a control and a series of doses\n\n\
    The other runs are compared with the first one. A file of doses has [[drug]] blocks:\n  \
    [[drug]]\n  \
    name = \"blocker\"\n  \
    parameter = \"peak_tension\"\n  \
    concentration = [\"0.3 uM\", \"1 uM\", \"10 uM\"]\n  \
    ic50 = \"1 uM\"\n  \
    hill = 1.0                # default 1\n  \
    maximal_effect = -0.8     # default -1\n\
    which multiply the parameter by 1 + maximal_effect c^hill / (ic50^hill + c^hill).\n\
    Blocks with the same name are one drug; a [[together]] block applies several drugs at once:\n  \
    doses = [\"blocker 1 uM\", \"other 30 nM\"]\n\
    Conductances of tor_ord_land are channels (P_Ca, G_Kr, G_Na, G_NaL, G_Ks, G_K1, G_to); \
    parameters of the minimal models are phenomenological and not single channels.\n\n\
    Results: report.html, figures/compared and contraction (SVG and PNG), metrics.csv, \
    comparison.json (settings and numbers that differ, warnings), runs/ (curves, run files).\n\
    Exit codes: 0 done, 1 a run stopped early, 2 bad input or usage.")]
pub(crate) struct CompareArgs {
    /// Result folders (read), or run files, pictures and outlines (run); without any, the built-in
    /// cell
    #[arg(value_name = "RESULTS|RUN.toml|PICTURE|OUTLINE")]
    pub(crate) inputs: Vec<PathBuf>,
    /// Adds a run of each input with these factors on its numbers: parameters of the cell model or
    /// settings (`tau_si=1.2,peak_tension=0.7`); may be given several times
    #[arg(long, value_name = "NAME=FACTOR,...", allow_hyphen_values = true)]
    pub(crate) scale: Vec<String>,
    /// File of drugs (.toml): adds a run of each input for each concentration
    #[arg(long, value_name = "FILE")]
    pub(crate) doses: Option<PathBuf>,
    /// Simultaneous runs, at most one per core [default: all cores]
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) settings: Settings<Beat>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring mesh`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring mesh cell.png --pixel-size \"0.27 um\"\n  \
    myospring mesh cell.tif --fibre picture --stain z-disc     look at figures/overlay.png\n  \
    myospring mesh cell.geojson --spacing \"0.8 um\" --output mesh")]
pub(crate) struct MeshArgs {
    /// Picture or mask (.png, .tif), outline (.geojson, .json, .csv, .roi, .zip, .txt) or run file (.toml);
    /// without it, the built-in cell
    #[arg(value_name = "PICTURE|OUTLINE|RUN.toml")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) settings: Settings<Meshed>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring segment`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring segment cell.tif                          look at results/cell_outline/overlay.png\n  \
    myospring segment cell.tif --pixel-size \"0.27 um\" -o cell.roi          correct it in Fiji, then\n  \
    myospring run cell.tif --pixel-size \"0.27 um\" --outline cell.roi       simulate it\n  \
    myospring segment dish.tif --cell all -o cells.zip -o cells_mask.png\n  \
    myospring segment sheet.tif --whole-frame           fibres and sarcomeres of a sheet or tissue\n\n\
    Without an ending, --output is a folder; otherwise the ending determines the format: .geojson (um), .roi or .zip (ImageJ), .txt (Cellpose), \
    .png (mask; with --cell all a label mask). An overlay is written next to the first file.")]
#[allow(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub(crate) struct SegmentArgs {
    /// Picture (.png, .tif)
    #[arg(value_name = "PICTURE")]
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) settings: Settings<Seen>,
    /// Do not search cells: read fibres and sarcomeres of the whole picture (a sheet or tissue);
    /// writes fibres.csv, an overlay and a report to `results/NAME_whole_frame`
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) whole_frame: bool,
    /// Folder for all results, or a file for the outline; may be given several times [default:
    /// `results/NAME_outline`]
    #[arg(short, long, value_name = "DIR|FILE", help_heading = OUTPUT)]
    pub(crate) output: Vec<PathBuf>,
    /// Replace existing files
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
    /// Print the report as JSON
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// No notes
    #[arg(short, long, help_heading = OUTPUT)]
    pub(crate) quiet: bool,
}

/// `myospring track`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring track film.avi --pixel-size \"0.18 um\" --frame-rate 30 --allow-cut\n  \
    myospring track film.ome.tif                       pixel size and frame rate from the file\n  \
    myospring track frames --pixel-size \"0.27 um\" --frame-rate 100       a folder of pictures\n  \
    myospring track film.tif --frame 12 --outline cell.roi      the cell as drawn on frame 12\n  \
    myospring track film.ome.tif --cell all            every cell of the film: a row a cell\n  \
    myospring track tissue.tif --posts --post-stiffness \"0.4 uN/um\"      the force of a tissue on two posts\n\n\
    Films: TIFF, OME-TIFF and ImageJ stacks, folders of .png and .tif, AVI (uncompressed, MJPEG, PNG), .y4m; others \
    through ffmpeg, if it is installed.\n\n\
    Results: track.csv (one row per frame: t_ms, length_um, shortening_pct, width_um, area_um2, stretch_1 and stretch_2, \
    sarcomere_um if there are stripes, interpolated_pct), track.json (settings, warnings, numbers), rest.tif and \
    outline.geojson (the cell at rest); then what --outputs names, and, unless that is none, report.html (the \
    moving cell with its curves, for the browser).\n\
    If interrupted (Ctrl-C), the completed frames are written.")]
pub(crate) struct TrackArgs {
    /// Film (.tif, .avi, ...) or folder of pictures
    #[arg(value_name = "FILM")]
    pub(crate) input: PathBuf,
    /// Frames a second (30, or "30 /s") [default: that of the film]
    #[arg(long, value_name = "RATE", allow_hyphen_values = true, help_heading = FILM)]
    pub(crate) frame_rate: Option<String>,
    /// Side of the squares of the picture that are matched in each frame ("4 um"): larger ones are
    /// more reliable, smaller ones resolve finer motion [default: "4 um", at least 17 pixels]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, help_heading = FILM)]
    pub(crate) subset: Option<String>,
    /// Follow the two posts that hold a tissue at its ends, instead of a cell: how far they bend and, with their stiffness, the force
    #[arg(long, help_heading = POSTS)]
    pub(crate) posts: bool,
    /// Where the posts are in the first frame, or in that of --frame: column, row and diameter of each in pixels from the upper left
    /// corner ("120,256,40 390,256,40"); of rectangular posts the sides along and across the tissue instead of the diameter
    /// ("120,256,30x60 390,256,30x60") [default: they are found]
    #[arg(long, value_name = "PLACES", requires = "posts", help_heading = POSTS)]
    pub(crate) post_places: Option<String>,
    /// Stiffness of one post ("0.4 uN/um"), or its length, width and modulus below [default: displacements alone]
    #[arg(long, value_name = "STIFFNESS", allow_hyphen_values = true, requires = "posts", conflicts_with = "post_length",
          help_heading = POSTS)]
    pub(crate) post_stiffness: Option<String>,
    /// Length of the posts from foot to tip ("3 mm")
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, requires_all = ["posts", "post_width", "post_modulus"],
          help_heading = POSTS)]
    pub(crate) post_length: Option<String>,
    /// Height of the tissue above the foot of the posts [default: at their tip]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, requires = "post_length", help_heading = POSTS)]
    pub(crate) post_load_height: Option<String>,
    /// Width of the posts across the tissue; of round posts their diameter ("1 mm")
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, requires = "post_length", help_heading = POSTS)]
    pub(crate) post_width: Option<String>,
    /// Thickness of rectangular posts along the tissue [default: round posts]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, requires = "post_length", help_heading = POSTS)]
    pub(crate) post_thickness: Option<String>,
    /// Young's modulus of the posts ("1600 kPa")
    #[arg(long, value_name = "MODULUS", allow_hyphen_values = true, requires = "post_length", help_heading = POSTS)]
    pub(crate) post_modulus: Option<String>,
    #[command(flatten)]
    pub(crate) settings: Settings<Seen>,
    /// Threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", help_heading = NUMERICS)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// What to write in addition to the curve, separated by commas
    #[arg(long, value_name = "WORDS", value_delimiter = ',', value_parser = outputs::of_track(),
          default_value = outputs::OF_TRACK, help_heading = OUTPUT)]
    pub(crate) outputs: Vec<String>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring traction`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring traction beads.tif --gel-modulus \"10 kPa\"                        a film; the gel is at rest in one of its frames\n  \
    myospring traction beads.tif --reference relaxed.tif --cell cell.roi --gel-modulus \"10 kPa\"\n  \
    myospring traction film.tif --channel 1 --cell film.tif --gel-modulus \"10 kPa\"   a film with a channel of the cell and one of beads\n  \
    myospring traction pulled.tif --reference relaxed.tif --pixel-size \"0.16 um\" --gel-modulus \"10 kPa\"   a pair\n  \
    myospring traction u.npy v.npy --pixel-size \"0.63 um\" --gel-modulus \"10 kPa\" --cell cell.png\n  \
    myospring traction u.npy v.npy --pixel-size \"2 um\" --unit \"1 um\" --frame-rate 30 --gel-modulus \"2 kPa\"\n\n\
    Results: traction.csv (forces, contractile moment, energy of the gel and noise floors of each frame), tractions.npz \
    (tractions in Pa, rows from the top), summary.json (also beats, and how fine the map is), figures/traction; of beads also \
    u.npy and v.npy (displacements to the right and downward in pixels of the pictures, for pyTFM).")]
pub(crate) struct TractionArgs {
    /// Film (.tif, .avi, ...), folder of pictures or one picture of the beads in the gel; or two NumPy arrays (.npy) of the
    /// displacements of the gel to the right and downward, rows from the top: of rows and columns, or of frames, rows and
    /// columns, as pyTFM has them; or a table of them (.csv, .txt, ...) with the columns x, y, u, v and perhaps frame, in pixels or in
    /// um if their names say so, as programs for particle image velocimetry write it
    #[arg(value_name = "FILM|U V|TABLE", num_args = 1..=2, required = true)]
    pub(crate) input: Vec<PathBuf>,
    /// Side of a pixel of the pictures ("0.16 um") [default: that of the file]; of arrays, the distance of neighbouring places
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) pixel_size: Option<String>,
    /// Arrays and tables: what a displacement of 1 is ("1 um") [default: of arrays the distance of neighbouring places, of tables a
    /// pixel]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) unit: Option<String>,
    /// Picture of the beads without the cell, or with the cell relaxed [default: a frame of the film, at rest]
    #[arg(long, value_name = "FILE", help_heading = FILM)]
    pub(crate) reference: Option<PathBuf>,
    /// Frame of the film, from 0, in which the cell is at rest [default: the frame that is most like a quarter of the film]
    #[arg(long, value_name = "N", conflicts_with = "reference", help_heading = FILM)]
    pub(crate) frame: Option<usize>,
    /// Side of the squares of the picture that are matched in each frame ("6 um"): larger ones are more reliable, smaller ones
    /// resolve finer tractions [default: the smallest that hold nine beads]. Of arrays, the side of the windows in which they
    /// were measured, where these overlap [default: they do not]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) subset: Option<String>,
    /// Channel of the beads, from 0 [default: 0]
    #[arg(long, value_name = "N", help_heading = FILM)]
    pub(crate) channel: Option<usize>,
    /// Frames a second (30, or "30 /s") [default: that of the film]
    #[arg(long, value_name = "RATE", allow_hyphen_values = true)]
    pub(crate) frame_rate: Option<String>,
    /// Young's modulus of the gel ("10 kPa")
    #[arg(long, value_name = "MODULUS", allow_hyphen_values = true)]
    pub(crate) gel_modulus: String,
    /// Poisson's ratio of the gel, from 0 to below 0.5
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true, default_value = "0.49")]
    pub(crate) gel_poisson: f64,
    /// Thickness of the gel, bonded to glass [default: so thick that the glass is not felt]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) gel_thickness: Option<String>,
    /// Where the cell is: a film or a picture of it in the same window (.tif, .avi, .png, ...), in which it is found and 2 um around it
    /// are added; or outlines (.roi, .zip, .geojson, .json, .txt) or a picture that is black elsewhere, a little larger than the
    /// cell. Of arrays a picture with a pixel for each place
    #[arg(long, value_name = "FILM|PICTURE|OUTLINE", visible_alias = "region")]
    pub(crate) cell: Option<PathBuf>,
    /// Channel that shows the cell, from 0 [default: 0]
    #[arg(long, value_name = "N", requires = "cell", help_heading = FILM)]
    pub(crate) cell_channel: Option<usize>,
    /// Threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", help_heading = NUMERICS)]
    pub(crate) threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring batch`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring batch pictures --pixel-size \"0.27 um\" --output beats\n  \
    myospring batch pictures --pattern \"*_actinin.tif\" --integrator quasi-static --figures\n  \
    myospring batch --table pictures.csv              each picture with its own settings\n  \
    myospring batch stacks --stacks --z-step \"0.5 um\"   a thick cell of each z-stack\n\n\
    Results: report.html, every cell with its numbers; cells.csv, one row per cell, failed pictures with the \
    reason; cells.parquet, the same; overlays/ of all pictures; with --figures a folder for each cell. Cells cut \
    by the frame, doubtful ones and those outside --min-area to --max-area are left out with the reason.\n\
    After an interruption (Ctrl-C), the same command continues.\n\
    Exit codes: 0 all pictures gave a simulated cell, 1 some failed, 2 bad input or usage.")]
pub(crate) struct BatchArgs {
    /// Folder of pictures (.png, .tif), including all subfolders; with --table, the folder of its
    /// files [default: that of the table]
    #[arg(value_name = "FOLDER", required_unless_present = "table")]
    pub(crate) folder: Option<PathBuf>,
    /// Pictures with individual settings (.csv): a column `file`, and any of `pixel_size`,
    /// modality, channel, threshold, seed, outline, stain or another option; a column `stack`
    /// instead of `file` names stacks of slices; `group` is copied to cells.csv. Several rows for one file are several cells of it
    #[arg(long, value_name = "FILE")]
    pub(crate) table: Option<PathBuf>,
    /// Only files whose name matches (with wildcards * and ?) [default: *.png, *.tif, *.tiff]
    #[arg(long, value_name = "PATTERN", conflicts_with = "table")]
    pub(crate) pattern: Option<String>,
    /// Each file is a stack of slices, with one thick cell: the largest, or that of --label
    #[arg(long)]
    pub(crate) stacks: bool,
    /// Simultaneous pictures, at most one per core [default: all cores]
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) settings: Settings<Beat>,
    /// Write curves and figures of each cell, in a folder of its own
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) figures: bool,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring study`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring study init study.toml                   a description to start from\n  \
    myospring study run study.toml                    runs or continues it\n  \
    myospring study run study.toml --shard 3/20       the third of twenty parts, for a job array\n  \
    myospring study merge study.toml                  when all parts are done\n  \
    myospring study figures study.toml                redraws its figures from members.csv\n\n\
    Results: members.csv and members.parquet, one row per member with its values, metrics, status and reason; \
    report.html; study.json, with Sobol's or Morris's indices if the sampler is saltelli or morris; figures: \
    sensitivity, distributions, scatter or response curves of each metric.\n\
    After an interruption, the same command continues.")]
pub(crate) struct StudyArgs {
    #[command(subcommand)]
    pub(crate) command: StudyCommand,
}

/// What to do with a study.
#[derive(Debug, Subcommand)]
pub(crate) enum StudyCommand {
    /// Run or continue a study
    Run(StudyRunArgs),
    /// Merge the parts of a study that were run with --shard
    Merge(StudyMergeArgs),
    /// Redraw the figures of a study from its members.csv
    Figures(StudyFiguresArgs),
    /// Write a commented description of a study to start from
    Init(StudyInitArgs),
}

impl StudyCommand {
    /// The description that is read.
    pub(crate) fn file(&self) -> Option<&PathBuf> {
        match self {
            Self::Run(args) => Some(&args.study),
            Self::Merge(args) => Some(&args.study),
            Self::Figures(args) => Some(&args.study),
            Self::Init(_) => None,
        }
    }
}

/// `myospring study run`.
#[derive(Debug, Args)]
pub(crate) struct StudyRunArgs {
    /// Description of the study (.toml)
    #[arg(value_name = "STUDY.toml")]
    pub(crate) study: PathBuf,
    /// Simultaneous members, at most one per core; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,
    /// Only the i-th of N parts; `study merge` merges them
    #[arg(long, value_name = "i/N")]
    pub(crate) shard: Option<String>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// `myospring study merge`.
#[derive(Debug, Args)]
pub(crate) struct StudyMergeArgs {
    /// Description of the study (.toml), the same as that of its parts
    #[arg(value_name = "STUDY.toml")]
    pub(crate) study: PathBuf,
    /// Folder with the parts, also for the results [default: `results/NAME_study`]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
    /// Print results as JSON
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
}

/// `myospring study figures`.
#[derive(Debug, Args)]
pub(crate) struct StudyFiguresArgs {
    /// Description of the study (.toml)
    #[arg(value_name = "STUDY.toml")]
    pub(crate) study: PathBuf,
    /// Folder with its results [default: `results/NAME_study`]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
}

/// `myospring study init`.
#[derive(Debug, Args)]
pub(crate) struct StudyInitArgs {
    /// File to write; without it, the description goes to stdout
    pub(crate) file: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    pub(crate) force: bool,
}

/// `myospring models`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  myospring models\n  myospring models coelho_2021 --json\n  \
    myospring models paci-2020.mmt\n  \
    myospring models paci-2020.mmt --rates\n  \
    myospring models model.cellml --variables stimulus=membrane.i_app,calcium=Ca.cai")]
pub(crate) struct ModelsArgs {
    /// Show the parameters of this model, or what is in this .cellml or .mmt file
    pub(crate) name: Option<String>,
    /// Print as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Print the rates of all states at the start, per ms, without a stimulus, as JSON
    #[arg(long, requires = "name", conflicts_with = "json")]
    pub(crate) rates: bool,
    /// Integrate one beat in two ways, and say how far they lie apart
    #[arg(long, requires = "name", conflicts_with_all = ["json", "rates"])]
    pub(crate) check: bool,
    /// Variables that a file does not tell: ROLE=VARIABLE, separated by commas, with the roles potential,
    /// stimulus, calcium and tension
    #[arg(long, requires = "name", value_name = "ROLE=VARIABLE,...")]
    pub(crate) variables: Option<Choices>,
}

/// `myospring schema`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring schema > run.schema.json\n  \
    myospring schema study > study.schema.json\n\n\
    An editor that knows TOML (Even Better TOML, Taplo) uses it by the first line of a file:\n  \
    #:schema run.schema.json")]
pub(crate) struct SchemaArgs {
    /// The kind of files
    #[arg(value_enum, default_value = "run")]
    pub(crate) of: SchemaOf,
}

/// The kind of files that a schema describes.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(crate) enum SchemaOf {
    /// Run files
    Run,
    /// Descriptions of studies
    Study,
}

/// `myospring completions`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring completions bash > ~/.local/share/bash-completion/completions/myospring\n  \
    myospring completions zsh > \"${fpath[1]}/_myospring\"\n  \
    myospring completions fish > ~/.config/fish/completions/myospring.fish\n  \
    myospring completions powershell >> $PROFILE")]
pub(crate) struct CompletionsArgs {
    /// The shell
    pub(crate) shell: Shell,
}

/// `myospring manual`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myospring manual ~/.local/share/man/man1 && man myospring-run"
)]
pub(crate) struct ManualArgs {
    /// Folder for the pages, one per command
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
}

/// Names of presets, and `list`.
fn presets() -> PossibleValuesParser {
    let named = PRESETS.iter().map(|preset| PossibleValue::new(preset.name).help(preset.about));
    PossibleValuesParser::new(named.chain([PossibleValue::new(LIST).help("print these lines")]))
}

/// The word that lists presets instead of writing one.
pub(crate) const LIST: &str = "list";

/// `myospring init`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  myospring init beat.toml                            every setting with its default
  myospring init --preset list                        the presets
  myospring init --preset hipsc-on-gel gel.toml       one of them")]
pub(crate) struct InitArgs {
    /// Write this run file instead, with the source of each number; `list` lists them
    #[arg(long, value_name = "NAME", value_parser = presets())]
    pub(crate) preset: Option<String>,
    /// File to write; without it, the run file goes to stdout
    pub(crate) file: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    pub(crate) force: bool,
}
