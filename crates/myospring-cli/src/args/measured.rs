//! Commands for measured curves.

use super::OutputArgs;
use crate::options::{Beat, Settings};
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Headings of options that are not settings.
const BEATS: &str = "Beats";
const TABLE: &str = "Table";
const FIT: &str = "Fit";

/// `myospring analyse`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring analyse cell.csv                                      columns by their names and units\n  \
    myospring analyse contraction.txt                               MUSCLEMOTION: time (ms), amplitude\n  \
    myospring analyse lengths.txt --frame-rate 250 --kind length --unit um\n  \
    myospring analyse export.txt --time 1 --columns 3 --kind sarcomere-length --unit um\n  \
    myospring analyse edge.csv --unit px --pixel-size \"0.27 um\" --frame-rate 100\n  \
    myospring analyse fura.csv --kind calcium-ratio --stimulus-period \"1 s\"\n  \
    myospring analyse sarcomeres.csv --frame-rate 30 --mean         one row per sarcomere (SarcGraph)\n  \
    myospring analyse results.xlsx --sheet \"Data (ROIs)\"             default: every sheet\n  \
    myospring analyse long.csv --from \"20 s\" --to \"45 s\"             a part of the recording\n  \
    myospring analyse dye.tif --frame-rate 500 --pixel-size \"100 um\"  waves in a film of a tissue's light (optical mapping)\n\n\
    A table needs a column of times, or --frame-rate, and one of values for each cell: `time (ms)`, `t_s`, `length_um`, \
    `Sarc Length (um)`, `shortening (%)`, `force_nN`, `ratio`, `Ca_nM`, `F/F0`, `Vm (mV)`. Delimiter, decimal comma, \
    header, encoding and lines above the table are detected.\n\
    Results: report.html (the curves with their beats, all numbers), metrics.csv (one row per beat), summary.csv (mean, \
    standard deviation, unit and definition of each metric), summary.json (everything, with the processing of each curve), \
    figures/trace_NAME (SVG and PNG); of a film also activation.csv and figures/activation (when each place is activated, \
    and for how long), waves.csv (one row per wave) and waves.json.\n\
    Exit codes: 0 done, 2 bad input or usage, or no curve with a beat.")]
pub(crate) struct AnalyseArgs {
    /// Tables of measured curves (.csv, .txt, .tsv, .atf, .xlsx), or folders of them; or a film of a tissue's light (.tif, .avi, .y4m)
    #[arg(value_name = "TRACE", required = true)]
    pub(crate) inputs: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) table: TableArgs,
    /// Size of a pixel ("0.27 um"): lengths in pixels become um
    #[arg(long, value_name = "LENGTH", help_heading = TABLE)]
    pub(crate) pixel_size: Option<String>,
    /// End of the analysed part of the recording ("45 s"), like --from [default: its end]
    #[arg(
        long,
        value_name = "TIME",
        visible_alias = "until",
        allow_hyphen_values = true,
        help_heading = TABLE
    )]
    pub(crate) to: Option<String>,
    #[command(flatten)]
    pub(crate) stimuli: StimulusArgs,
    /// Half of the smoothing window (local parabolas, "5 ms"), 0 for none [default: by the noise]
    #[arg(long, value_name = "TIME", help_heading = BEATS)]
    pub(crate) smooth: Option<String>,
    /// Do not subtract the drift of the baseline
    #[arg(long, help_heading = BEATS)]
    pub(crate) keep_drift: bool,
    /// Whether the light of a film rises or falls in a beat [default: as its steepest changes do]
    #[arg(long, value_name = "WAY", value_parser = ["rises", "falls"], help_heading = BEATS)]
    pub(crate) light: Option<String>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}

/// Stimulus times of a measured curve.
#[derive(Debug, Args)]
#[command(next_help_heading = BEATS)]
#[allow(clippy::struct_field_names, reason = "the names are those of the options")]
pub(crate) struct StimulusArgs {
    /// Stimulus times on the clock of the table ("100 ms, 1.1 s"); ms without unit
    #[arg(
        long,
        value_name = "TIMES",
        value_delimiter = ',',
        allow_hyphen_values = true,
        conflicts_with = "stimulus_period"
    )]
    pub(crate) stimulus_times: Vec<String>,
    /// Stimuli at regular intervals ("1 s") from --stimulus-start on
    #[arg(long, value_name = "TIME")]
    pub(crate) stimulus_period: Option<String>,
    /// Time of the first one, on the clock of the table ("200 ms") [default: the first frame]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, requires = "stimulus_period")]
    pub(crate) stimulus_start: Option<String>,
}

/// How tables of measured curves are read.
#[derive(Debug, Args)]
#[command(next_help_heading = TABLE)]
pub(crate) struct TableArgs {
    /// Columns with curves (or rows, in a table whose rows are curves), by name or number from 1
    /// [default: all with known names]
    #[arg(long, value_name = "NAME|N,...", value_delimiter = ',')]
    pub(crate) columns: Vec<String>,
    /// Column of times, by name or number
    #[arg(long, value_name = "NAME|N")]
    pub(crate) time: Option<String>,
    /// Kind of the curves: length, sarcomere-length, normalised-length, shortening, contraction,
    /// force, tension, moment, calcium, calcium-ratio, fluorescence, potential or unknown [default: by the
    /// columns' names]
    #[arg(long, value_name = "KIND")]
    pub(crate) kind: Option<String>,
    /// Unit of their values: um, px, %, nN, kPa, uM, mV, ... [default: by the columns' names]
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<String>,
    /// Unit of the times: s, ms, us, or ticks of a clock ("0.01 ms") [default: by the column's name]
    #[arg(long, value_name = "UNIT")]
    pub(crate) time_unit: Option<String>,
    /// Frames a second, if there are no times
    #[arg(long, value_name = "PER_SECOND")]
    pub(crate) frame_rate: Option<String>,
    /// Sheets of a workbook, by name or number from 1 [default: all]
    #[arg(long, value_name = "NAME|N,...", value_delimiter = ',')]
    pub(crate) sheet: Vec<String>,
    /// Start of the analysed part of the recording ("20 s"), on the clock of the table; ms without
    /// unit [default: its start]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) from: Option<String>,
    /// Separator of fields: comma, semicolon, tab or space [default: detected]
    #[arg(long, value_name = "WORD", value_parser = ["comma", "semicolon", "tab", "space"])]
    pub(crate) delimiter: Option<String>,
    /// Decimal separator: point or comma [default: detected]
    #[arg(long, value_name = "WORD", value_parser = ["point", "comma"])]
    pub(crate) decimal: Option<String>,
    /// Whether columns or rows are curves [default: detected]
    #[arg(long, value_name = "WORD", value_parser = ["columns", "rows"])]
    pub(crate) layout: Option<String>,
    /// Ignore a pacer's marks in the table: beats are found in the curve itself
    #[arg(long)]
    pub(crate) ignore_marks: bool,
    /// Leave out frames in which a curve has no number
    #[arg(long)]
    pub(crate) skip_gaps: bool,
    /// Analyse the mean of all curves of each file
    #[arg(long)]
    pub(crate) mean: bool,
}

/// `myospring fit`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    myospring fit --to cell.csv                                     the built-in cell's shape\n  \
    myospring fit cell.tif --pixel-size \"0.27 um\" --to cell.csv     the cell of a picture\n  \
    myospring fit --to lengths.txt --frame-rate 250 --kind length --unit um\n  \
    myospring fit --to cell.csv --free c_0,x_3,sigma                more unknowns\n  \
    myospring fit --to cell.csv --model land_2017 --fix k_ws        one cell model\n  \
    myospring fit --to cell.csv --model given_tension               the tension that the curve needs\n  \
    myospring fit --to length.csv --recorded-calcium ca.csv --model land_2017   calcium of the same beats drives it\n  \
    myospring fit film.avi --pixel-size \"0.18 um\" --frame-rate 30   the cell of a film, to its motion\n  \
    myospring fit --to free.csv --loaded \"100 nN/um=fibres.csv\"     both stiffness and tension\n  \
    myospring fit --to free.csv --traction \"10 kPa=force.csv\"       the same, by a force on a gel\n  \
    myospring fit --to length.csv --support gel --gel-modulus \"10 kPa\" --traction force.csv   both on one gel\n  \
    myospring fit cell.tif --traction \"10 kPa=beads.tif\"            films of the cell and of the beads under it\n\n\
    Without --model, every model whose fit takes seconds is tried. The one with the lowest BIC is taken among those that \
    follow the curve; if there is none, the tension that the curve needs (given_tension). models.csv has what each leaves.\n\n\
    A curve of a free cell determines the ratio of tension to stiffness, not both; verdicts say what else it does not \
    determine. Delays and the length at rest are always fitted. Several curves (columns, files) are several cells.\n\n\
    Results: fit.json (every number with its unit, 95 % interval, profile and verdict), curve.csv (measured, fitted, \
    residual), run.toml (reproduces the beat with `myospring run`), figures/fit (SVG and PNG), report.html; for several \
    cells fits.csv, one row each, and these files in cells/N.\n\
    Exit codes: 0 done, 1 a cell of several could not be fitted, 2 bad input or usage.")]
pub(crate) struct FitArgs {
    /// Picture or mask (.png, .tif), outline (.geojson, .json, .csv, .roi, .zip, .txt) or run file (.toml) of the cell;
    /// without it, the cell of the film, or the built-in adult ventricular cell. Alone: a film, or a table of curves
    #[arg(value_name = "PICTURE|OUTLINE|RUN.toml|FILM|TRACE")]
    pub(crate) input: Option<PathBuf>,
    /// Measured curves (.csv, .txt, .tsv, .atf, .xlsx): length, sarcomere length, shortening or
    /// another motion; several columns of one kind, files, or a folder of them are several cells;
    /// from `track.csv` and other tables with several kinds of curves of one cell, the stretch is
    /// used, or else the length. Or a film, whose cell is tracked [default: the film or table that was
    /// given alone]
    #[arg(long, value_name = "TRACE|FILM", num_args = 1.., help_heading = FIT)]
    pub(crate) to: Vec<PathBuf>,
    /// A curve of the same cell between two springs, such as carbon fibres, each of this stiffness
    /// ("100 nN/um=fibres.csv"); may be given several times
    #[arg(long, value_name = "STIFFNESS=TRACE", help_heading = FIT)]
    pub(crate) loaded: Vec<String>,
    /// A force of the same cell on a gel, as `myospring traction` and others measure it (nN; `traction.csv` as it is), or a film of the
    /// beads in the gel: gives tension and stiffness in kPa. The gel is that of --support gel, or of the modulus before the file ("10
    /// kPa=force.csv"); may be given several times, for several gels
    #[arg(long, value_name = "[MODULUS=]TRACE|FILM", help_heading = FIT)]
    pub(crate) traction: Vec<String>,
    /// Error of the scale of these forces ("10 %"), one standard deviation, apart from noise; that of the gel's modulus does not count,
    /// since it scales every answer in kPa alike [default: 5 %]
    #[arg(long, value_name = "PERCENT", help_heading = FIT, requires = "traction")]
    pub(crate) traction_error: Option<String>,
    /// How far the cell shortens at the peak of its beat ("10 %"), for a curve in arbitrary units (MUSCLEMOTION, pillars),
    /// which does not say so; tensions depend on it [default: models are fitted to its timing alone, its own tension to 10 %]
    #[arg(long, value_name = "PERCENT", help_heading = FIT)]
    pub(crate) peak_shortening: Option<String>,
    /// Calcium that was recorded together with the curve, on the same clock (.csv, .xlsx, ...): it drives `land_2017`, beat for beat. A
    /// column of calcium in the curve's own table is used without this option
    #[arg(long, value_name = "TRACE", help_heading = FIT)]
    pub(crate) recorded_calcium: Option<PathBuf>,
    /// Calcium at rest ("0.1 uM") in a recording that is a ratio or a fluorescence
    #[arg(long, value_name = "CONCENTRATION", help_heading = FIT, requires = "calcium_peak")]
    pub(crate) calcium_rest: Option<String>,
    /// Calcium at the peak of its mean beat ("0.6 uM") in such a recording
    #[arg(long, value_name = "CONCENTRATION", help_heading = FIT, requires = "calcium_rest")]
    pub(crate) calcium_peak: Option<String>,
    /// Numbers to fit in addition to delays and the length at rest: `tension_over_stiffness`,
    /// `young_modulus` (with --loaded or --traction), or parameters of the cell model [default: those that a
    /// curve determines: `tension_over_stiffness` with `c_0` or `k_ws`]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', help_heading = FIT)]
    pub(crate) free: Vec<String>,
    /// Numbers of the default to leave fixed
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', help_heading = FIT)]
    pub(crate) fix: Vec<String>,
    /// Bounds of a parameter, in its unit (`c_0=0.01:0.05`); may be given several times [default: a
    /// factor of 4 up and down]
    #[arg(long, value_name = "NAME=LOW:HIGH", help_heading = FIT)]
    pub(crate) bounds: Vec<String>,
    /// Number of starts; thresholds in the equations cause local minima
    #[arg(long, value_name = "N", default_value = "8", help_heading = FIT)]
    pub(crate) starts: NonZeroUsize,
    /// Seed of the random starts
    #[arg(long, value_name = "N", default_value = "1", help_heading = FIT)]
    pub(crate) fit_seed: u64,
    #[command(flatten)]
    pub(crate) stimuli: StimulusArgs,
    #[command(flatten)]
    pub(crate) table: TableArgs,
    /// End of the analysed part of the recording ("45 s"), like --from [default: its end]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, help_heading = TABLE)]
    pub(crate) until: Option<String>,
    #[command(flatten)]
    pub(crate) settings: Settings<Beat>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
}
