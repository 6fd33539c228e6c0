//! What was measured, for machines and for people.

use super::follow::Followed;
use myospring::microscopy::motion::{self, FEWEST_PARTS, Measure, Motion, Stage};
use myospring::microscopy::report::ShapeReport;
use myospring::output::track::TrackRow;
use myospring::settings::FibreReport;
use myospring::study::sha256;
use serde::Serialize;
use std::path::Path;

/// Share of healed points from which on a person is told, per cent.
const MANY_HEALED_PCT: f64 = 30.0;
/// Numbers of repeated frames that are named.
const MOST_NAMED: usize = 10;
/// Part of its excursion by which a cell may be longer than at rest.
const LONGER: f64 = 0.5;

/// `track.json`.
#[derive(Serialize)]
pub(crate) struct Report<'a> {
    program: &'static str,
    version: &'static str,
    film: String,
    frames: usize,
    /// Of these followed, from this one on.
    frames_followed: usize,
    first_frame: usize,
    /// Frames that repeat the one before: they are no rows of `track.csv`.
    repeated_frames: Vec<usize>,
    rest_frame: usize,
    frames_per_second: f64,
    frame_rate_source: &'static str,
    pixel_size_um: f64,
    pixel_size_source: &'static str,
    subset_um: f64,
    spacing_um: f64,
    points: usize,
    /// Standard deviation of the noise, grey levels.
    noise_grey_levels: f64,
    /// Standard error of a point's displacement that the noise makes, before neighbours are averaged; median.
    noise_error_um: Option<f64>,
    healed_pct_mean: f64,
    healed_pct_most: f64,
    stage: String,
    stage_largest_um: f64,
    /// How much the cell contracts, by the column that can be trusted.
    pub(super) headline: Headline,
    resting_length_um: f64,
    peak_shortening_pct: f64,
    peak_frame: usize,
    least_stretch: f64,
    least_stretch_frame: usize,
    sarcomere_places: usize,
    /// So far apart that none shows the stripes of another.
    sarcomere_parts: usize,
    sarcomere_rest_um: Option<f64>,
    /// 95 %, from how much the parts differ.
    sarcomere_rest_interval_um: Option<[f64; 2]>,
    sarcomere_least_um: Option<f64>,
    sarcomere_shortening_pct: Option<f64>,
    sarcomere_shortening_interval_pct: Option<[f64; 2]>,
    rest_picture_sha256: String,
    cell: Option<&'a ShapeReport>,
    fibres: FibreReport,
    pub(crate) warnings: Vec<String>,
    /// A row a frame: `track.csv`.
    #[serde(skip)]
    pub(crate) rows: Vec<TrackRow>,
}

/// How much the cell contracts.
#[derive(Serialize)]
pub(super) struct Headline {
    /// The column of `track.csv` that says it.
    pub(super) column: &'static str,
    peak_contraction_pct: f64,
    peak_frame: usize,
    /// Why that column.
    because: String,
    /// Of each row, %.
    #[serde(skip)]
    pub(super) contraction_pct: Vec<f64>,
    /// The row of the peak.
    #[serde(skip)]
    pub(super) at: usize,
}

impl Headline {
    fn of(motion::Headline { measure, reason }: motion::Headline, rows: &[TrackRow]) -> Self {
        let (column, of): (_, fn(&TrackRow) -> f64) = match measure {
            Measure::Length => ("length_um", |row| row.shortening_pct),
            Measure::Stretch => ("stretch_1", |row| 100.0 * (1.0 - row.stretch_1)),
        };
        let contraction_pct: Vec<f64> = rows.iter().map(of).collect();
        let at = (0..rows.len())
            .max_by(|&a, &b| contraction_pct[a].total_cmp(&contraction_pct[b]))
            .unwrap_or(0);
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

impl<'a> Report<'a> {
    pub(crate) fn of(path: &Path, followed: &'a Followed) -> Self {
        let Followed { film, motion, shaped, fibres, .. } = followed;
        let rows = rows(motion);
        let rest = motion.rest_index();
        let is_doubtful =
            shaped.picture.as_ref().is_some_and(|(_, cell)| cell.confidence.is_doubtful());
        let headline = motion.headline();
        let headline = if is_doubtful { headline.with_doubtful_outline() } else { headline };
        let headline = Headline::of(headline, &rows);
        let most =
            |of: &dyn Fn(&TrackRow) -> f64| rows.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        let peak = rows.iter().max_by(|a, b| a.shortening_pct.total_cmp(&b.shortening_pct));
        let strained = rows.iter().min_by(|a, b| a.stretch_1.total_cmp(&b.stretch_1));
        let lengths = (0..rows.len()).filter_map(|at| Some((at, rows[at].sarcomere_um?)));
        let shortest = lengths.min_by(|a, b| a.1.total_cmp(&b.1));
        let shortening = shortest.and_then(|(at, _)| motion.sarcomere_shortening_pct(at));
        let stage = match motion.stage {
            Stage::Background { points } => format!("background, median over {points} places"),
            Stage::CellMean => "mean of the cell (the background has no texture)".to_owned(),
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
            healed_pct_mean: rows.iter().map(|row| row.healed_pct).sum::<f64>() / rows.len() as f64,
            healed_pct_most: most(&|row| row.healed_pct),
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
            cell: picture.map(|(_, cell)| &cell.shape),
            fibres: fibres.report(),
            warnings: warnings(followed, &rows, rest),
            rows,
        }
    }

    pub(super) fn for_people(&self) -> String {
        let mut lines = vec![format!(
            "{}: {} of {} frames at {} /s ({}), pixels of {} um; at rest in frame {}",
            self.film,
            self.frames_followed,
            self.frames,
            rounded(self.frames_per_second),
            self.frame_rate_source,
            rounded(self.pixel_size_um),
            self.rest_frame
        )];
        let Headline { column, peak_contraction_pct, peak_frame, because, .. } = &self.headline;
        lines.push(format!(
            "contracts by {peak_contraction_pct:.2} % (frame {peak_frame}), read from {column}: {because}"
        ));
        lines.push(format!(
            "length {:.1} um at rest, shortens by {:.2} % (frame {})",
            self.resting_length_um, self.peak_shortening_pct, self.peak_frame
        ));
        lines.push(format!(
            "strains of the whole cell: stretch_1 at least {:.4} (frame {})",
            self.least_stretch, self.least_stretch_frame
        ));
        if let (Some(rest), Some([low, high])) =
            (self.sarcomere_rest_um, self.sarcomere_rest_interval_um)
            && let (Some(least), Some(shorter), Some([from, to])) = (
                self.sarcomere_least_um,
                self.sarcomere_shortening_pct,
                self.sarcomere_shortening_interval_pct,
            )
        {
            lines.push(format!(
                "sarcomeres {rest:.3} um at rest ({low:.3} to {high:.3}), {least:.3} um at least: {shorter:.1} % shorter \
                 ({from:.1} to {to:.1}); mean of {} places in {} parts of the cell, 95 % intervals",
                self.sarcomere_places, self.sarcomere_parts
            ));
        }
        lines.push(format!(
            "{} points, subsets of {:.1} um, healed {:.1} % on average, {:.1} % at most",
            self.points, self.subset_um, self.healed_pct_mean, self.healed_pct_most
        ));
        lines.push(format!(
            "motion of the stage: {}, up to {:.2} um",
            self.stage, self.stage_largest_um
        ));
        lines.join("\n")
    }
}

fn rows(motion: &Motion) -> Vec<TrackRow> {
    let extents = motion.extents();
    let rest = extents[motion.rest_index()].length;
    let all = motion.stretches();
    let row = |(at, extent): (usize, &myospring::analysis::shape::Extent)| {
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
            healed_pct: 100.0 * motion.healed_share(at),
            correlation: motion.correlation[at],
            stage_um: motion.stage_um[at],
        }
    };
    extents.iter().enumerate().map(row).collect()
}

fn warnings(followed: &Followed, rows: &[TrackRow], rest: usize) -> Vec<String> {
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
                "the film says {own:.4} frames a second, but {given} were given and are used (what a film says is \
                 often how fast it is to be shown)"
            ));
        }
    }
    if motion.sarcomere_places > 0 && motion.sarcomeres_by_part_um.is_empty() {
        warnings.push(format!(
            "there is no sarcomere_um: stripes can be read in nearly all frames at {} places in {} parts of the cell only, \
             and sarcomeres differ from part to part, so fewer than {FEWEST_PARTS} parts say little of the cell",
            motion.sarcomere_places, motion.sarcomere_parts
        ));
    }
    let worst = rows.iter().max_by(|a, b| a.healed_pct.total_cmp(&b.healed_pct));
    if let Some(row) = worst.filter(|row| row.healed_pct > MANY_HEALED_PCT) {
        let frames = rows.iter().filter(|row| row.healed_pct > MANY_HEALED_PCT).count();
        warnings.push(format!(
            "in {frames} frames more than {MANY_HEALED_PCT} % of the points were not found again but put where their \
             neighbours would have them (frame {}: {:.0} %)",
            row.frame, row.healed_pct
        ));
    }
    let shortest = rows.iter().map(|row| row.shortening_pct).fold(0.0, f64::max);
    let longest = rows.iter().map(|row| -row.shortening_pct).fold(0.0, f64::max);
    let strained = rows.iter().map(|row| 100.0 * (1.0 - row.stretch_1)).fold(0.0, f64::max);
    let error_pct = 100.0 * motion.error_um.unwrap_or(0.0) / rows[rest].length_um;
    let least = motion.least_contraction_pct();
    if shortest.max(longest).max(strained) < least {
        warnings.push(format!(
            "the cell hardly moves: it shortens by {shortest:.3} % at most, while the noise makes an error of \
             {error_pct:.3} %"
        ));
    } else if longest > least.max(LONGER * (shortest + longest)) {
        warnings.push(format!(
            "the cell is up to {longest:.1} % longer than in frame {}, which was taken for rest; choose it with --frame",
            motion.rest
        ));
    }
    warnings
}

/// Says which frames repeat others, and what that means.
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

/// Without the digits that a file's ratio of whole numbers leaves.
fn rounded(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}
