//! What was measured, for machines and for people.

use super::followed::Followed;
use crate::microscopy::motion::{self, CellMotion, Measure, Stage};
use crate::microscopy::report::ShapeReport;
use crate::output::track::TrackRow;
use crate::settings::FibreReport;
use crate::study::sha256;
use serde::Serialize;
use std::path::Path;

/// Numbers of repeated frames that are named.
const MOST_NAMED: usize = 10;

/// All numbers of a film: `track.json`.
#[derive(Serialize)]
pub struct TrackReport {
    /// `myospring`.
    pub program: &'static str,
    /// Its version.
    pub version: &'static str,
    /// The film.
    pub film: String,
    /// Frames of the film.
    pub frames: usize,
    /// How many of these were tracked.
    pub frames_followed: usize,
    /// The first frame that was tracked.
    pub first_frame: usize,
    /// Frames that repeat the one before; they have no rows in `track.csv`.
    pub repeated_frames: Vec<usize>,
    /// The frame at rest.
    pub rest_frame: usize,
    /// Frames a second.
    pub frames_per_second: f64,
    /// `given`, or `the film`.
    pub frame_rate_source: &'static str,
    /// Side of a pixel.
    pub pixel_size_um: f64,
    /// `given`, or `the film`.
    pub pixel_size_source: &'static str,
    /// Side of a subset.
    pub subset_um: f64,
    /// Spacing of the lattice.
    pub spacing_um: f64,
    /// Points of the lattice.
    pub points: usize,
    /// Standard deviation of the noise, grey levels.
    pub noise_grey_levels: f64,
    /// Standard error of a point's displacement from noise, before neighbours are averaged; median.
    pub noise_error_um: Option<f64>,
    /// Share of interpolated points, per cent, mean over frames.
    pub interpolated_pct_mean: f64,
    /// The same in the worst frame.
    pub interpolated_pct_most: f64,
    /// What the motion of the stage was read from.
    pub stage: String,
    /// How far the stage moved.
    pub stage_largest_um: f64,
    /// How much the cell contracts, by the column that can be trusted.
    pub headline: HeadlineReport,
    /// Length in the frame at rest.
    pub resting_length_um: f64,
    /// Largest shortening of the length.
    pub peak_shortening_pct: f64,
    /// The frame of the peak.
    pub peak_frame: usize,
    /// Smallest mean stretch of the cell.
    pub least_stretch: f64,
    /// Its frame.
    pub least_stretch_frame: usize,
    /// Places at which sarcomeres were read.
    pub sarcomere_places: usize,
    /// Parts of the cell so far apart that they share no stripes.
    pub sarcomere_parts: usize,
    /// Mean length of the sarcomeres at rest.
    pub sarcomere_rest_um: Option<f64>,
    /// 95 %, from how much the parts differ.
    pub sarcomere_rest_interval_um: Option<[f64; 2]>,
    /// Their least mean length.
    pub sarcomere_least_um: Option<f64>,
    /// How much they shorten.
    pub sarcomere_shortening_pct: Option<f64>,
    /// Its 95 % interval.
    pub sarcomere_shortening_interval_pct: Option<[f64; 2]>,
    /// Hash of `rest.tif`.
    pub rest_picture_sha256: String,
    /// Shape of the cell at rest.
    pub cell: Option<ShapeReport>,
    /// Its fibres.
    pub fibres: FibreReport,
    /// What a reader must know.
    pub warnings: Vec<String>,
    /// A row a frame: `track.csv`.
    #[serde(skip)]
    pub rows: Vec<TrackRow>,
}

/// How much the cell contracts.
#[derive(Serialize)]
pub struct HeadlineReport {
    /// The column of `track.csv` that it is read from.
    pub column: &'static str,
    /// The largest contraction.
    pub peak_contraction_pct: f64,
    /// The frame of the peak.
    pub peak_frame: usize,
    /// Why that column.
    pub because: String,
    /// Of each row, %.
    #[serde(skip)]
    pub contraction_pct: Vec<f64>,
    /// The row of the peak.
    #[serde(skip)]
    pub at: usize,
}

impl HeadlineReport {
    /// The headline of these rows; the peak is one of the frames that show the cell.
    fn of(
        motion::Headline { measure, reason }: motion::Headline,
        rows: &[TrackRow],
        seen: &[usize],
    ) -> Self {
        let (column, of): (_, fn(&TrackRow) -> f64) = match measure {
            Measure::Length => ("length_um", |row| row.shortening_pct),
            Measure::Stretch => ("stretch_1", |row| 100.0 * (1.0 - row.stretch_1)),
        };
        let contraction_pct: Vec<f64> = rows.iter().map(of).collect();
        let at = seen.iter().copied();
        let at = at.max_by(|&a, &b| contraction_pct[a].total_cmp(&contraction_pct[b])).unwrap_or(0);
        Self {
            column,
            peak_contraction_pct: contraction_pct[at],
            peak_frame: rows[at].frame,
            because: reason.to_string(),
            contraction_pct,
            at,
        }
    }
}

impl TrackReport {
    /// The report of a tracked cell.
    #[must_use]
    pub fn of(path: &Path, followed: &Followed) -> Self {
        let Followed { film, motion, shaped, fibres, .. } = followed;
        let rows = rows(motion);
        let rest = motion.rest_index();
        let is_doubtful =
            shaped.picture.as_ref().is_some_and(|(_, cell)| cell.confidence.is_doubtful());
        let headline = motion.headline();
        let headline = if is_doubtful { headline.with_doubtful_outline() } else { headline };
        let seen = motion.frames_with_cell();
        let headline = HeadlineReport::of(headline, &rows, &seen);
        let most =
            |of: &dyn Fn(&TrackRow) -> f64| rows.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        let shown = || seen.iter().map(|&at| &rows[at]);
        let peak = shown().max_by(|a, b| a.shortening_pct.total_cmp(&b.shortening_pct));
        let strained = shown().min_by(|a, b| a.stretch_1.total_cmp(&b.stretch_1));
        let lengths = (0..rows.len()).filter_map(|at| Some((at, rows[at].sarcomere_um?)));
        let shortest = lengths.min_by(|a, b| a.1.total_cmp(&b.1));
        let shortening = shortest.and_then(|(at, _)| motion.sarcomere_shortening_pct(at));
        let stage = match motion.stage {
            Stage::Background { points } => format!("background, median over {points} places"),
            Stage::CellMean { cells: 1 } => {
                "mean of the cell (the background has no texture)".to_owned()
            }
            Stage::CellMean { cells } => {
                format!("mean of {cells} cells (the background has no texture)")
            }
        };
        let spacing_um = shaped.report.spacing_um;
        let picture = shaped.picture.as_ref();
        Self {
            program: "myospring",
            version: env!("CARGO_PKG_VERSION"),
            film: path.display().to_string(),
            frames: film.len(),
            frames_followed: motion.len(),
            first_frame: rows[0].frame,
            repeated_frames: motion.repeated.clone(),
            rest_frame: motion.rest,
            frames_per_second: followed.frames_per_second,
            frame_rate_source: if followed.rate_given { "given" } else { "the film" },
            pixel_size_um: motion.pixel_um,
            pixel_size_source: if followed
                .run
                .shape
                .source
                .picture()
                .is_some_and(|it| it.options.pixel_size.is_some())
            {
                "given"
            } else {
                "the film"
            },
            subset_um: motion.subset_um,
            spacing_um,
            points: motion.mesh.len(),
            noise_grey_levels: motion.noise,
            noise_error_um: motion.error_um,
            interpolated_pct_mean: rows.iter().map(|row| row.interpolated_pct).sum::<f64>()
                / rows.len() as f64,
            interpolated_pct_most: most(&|row| row.interpolated_pct),
            stage,
            stage_largest_um: most(&|row| row.stage_um[0].hypot(row.stage_um[1])),
            headline,
            resting_length_um: rows[rest].length_um,
            peak_shortening_pct: peak.map_or(0.0, |row| row.shortening_pct),
            peak_frame: peak.map_or(0, |row| row.frame),
            least_stretch: strained.map_or(1.0, |row| row.stretch_1),
            least_stretch_frame: strained.map_or(0, |row| row.frame),
            sarcomere_places: motion.sarcomere_places,
            sarcomere_parts: motion.sarcomere_parts,
            sarcomere_rest_um: rows[rest].sarcomere_um,
            sarcomere_rest_interval_um: motion.sarcomere_length_um(rest).map(|it| it.interval),
            sarcomere_least_um: shortest.map(|(_, least)| least),
            sarcomere_shortening_pct: shortening.map(|it| it.value),
            sarcomere_shortening_interval_pct: shortening.map(|it| it.interval),
            rest_picture_sha256: sha256(&followed.rest_picture),
            cell: picture.map(|(_, cell)| cell.shape.clone()),
            fibres: fibres.report(),
            warnings: warnings(followed, &rows),
            rows,
        }
    }
}

fn rows(motion: &CellMotion) -> Vec<TrackRow> {
    let extents = motion.extents();
    let rest = extents[motion.rest_index()].length;
    let all = motion.stretches();
    let row = |(at, extent): (usize, &crate::analysis::shape::Extent)| {
        let stretches = all[at];
        TrackRow {
            frame: motion.frames[at],
            t_ms: motion.times_ms[at],
            length_um: extent.length,
            shortening_pct: 100.0 * (1.0 - extent.length / rest),
            width_um: extent.width,
            area_um2: motion.area_um2(at),
            stretch_1: stretches.smaller,
            stretch_2: stretches.larger,
            sarcomere_um: motion.sarcomeres_um[at],
            interpolated_pct: 100.0 * motion.interpolated_share(at),
            correlation: motion.correlation[at],
            stage_um: motion.stage_um[at],
        }
    };
    extents.iter().enumerate().map(row).collect()
}

fn warnings(followed: &Followed, rows: &[TrackRow]) -> Vec<String> {
    let Followed { film, motion, shaped, fibres, .. } = followed;
    let mut warnings = film.notes.clone();
    warnings.extend(shaped.report.warnings.iter().cloned());
    warnings.extend(fibres.warnings.iter().cloned());
    if !motion.repeated.is_empty() {
        warnings.push(repeated(&motion.repeated, film.len()));
    }
    let (first, last) = (rows[0].frame, rows[rows.len() - 1].frame);
    if motion.interrupted {
        warnings
            .push(format!("interrupted: frames {first} to {last} of {} were followed", film.len()));
    }
    if let (Some(own), true) = (film.frames_per_second, followed.rate_given) {
        let given = followed.frames_per_second;
        if (own / given - 1.0).abs() > 0.01 {
            warnings.push(format!(
                "the film says {own:.4} frames a second, but {given} were given and are used (a film often states \
                the speed of playback)"
            ));
        }
    }
    warnings.extend(motion.doubts());
    warnings
}

/// The warning about repeated frames.
fn repeated(frames: &[usize], all: usize) -> String {
    let named: Vec<String> = frames.iter().take(MOST_NAMED).map(usize::to_string).collect();
    let more = match frames.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        more => format!(" and {more} more (track.json has them)"),
    };
    format!(
        "{} of {all} frames repeat the frame before them and are left out: {}{more}. The film was recorded or converted at \
         another rate than the camera's, so check --frame-rate",
        frames.len(),
        named.join(", ")
    )
}
