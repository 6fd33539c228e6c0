//! The two flexible posts that hold a tissue: how a film shows them bend, and the force that bends them.
//!
//! The force of the tissue on each post is the stiffness of a post times half of the distance by which the two have come nearer. What
//! shifts both alike, such as the stage, is not in it.

mod report;

use super::analyse::{Analyse, Analysed, Shown};
use super::track::{OpenedFilm, Track, film_name};
use super::{Draw, Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::analysis::kind::Kind;
use crate::measured::Curve;
use crate::microscopy::plane::Plane;
use crate::microscopy::posts::{self, Post, PostMotion, PostPlaces, PostShape};
use crate::output::figure::{self, Contour, Figure, FigureError, Overlay, Theme};
use crate::output::json;
use crate::output::table::{Column, Table};
pub use report::{PostReport, PostsReport};
use serde::Serialize;
use std::f64::consts::TAU;

/// Follows the posts of a film.
pub struct FollowPosts {
    /// The film, with its frame rate, and settings of its pixel size and channel.
    pub track: Track,
    /// Where the posts are in the frame that the settings state, or else in the first; `None` finds them.
    pub posts: Option<[Post; 2]>,
    /// Force per displacement of one post, nN/um; `None` gives displacements alone.
    pub stiffness: Option<f64>,
}

/// Posts that were followed.
pub struct FollowedPosts {
    /// Name of the film.
    pub name: String,
    /// Their motion, pixels.
    pub motion: PostMotion,
    /// Every number.
    pub report: PostsReport,
    /// The beats of the force, or of the approach where the stiffness is not known; why none were found.
    pub beats: Result<Analysed, String>,
    /// The frame at rest.
    rest: Plane,
    stiffness: Option<f64>,
    times_ms: Vec<f64>,
}

/// Two posts as written: column, row and size of each in pixels, `120,256,40 390,256,30x60`.
///
/// # Errors
/// A text of another form.
///
/// # Example
/// ```
/// use myospring::experiment::posts::places;
/// let [one, other] = places("120,256,40 390,256,30x60")?;
/// assert_eq!((one.middle_px, other.middle_px), ([120.0, 256.0], [390.0, 256.0]));
/// assert!(places("120,256").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn places(text: &str) -> Result<[Post; 2], ExperimentError> {
    let wrong = || {
        ExperimentError::new(format!(
            "--post-places is `{text}`; it must have column, row and size of two posts"
        ))
        .advise("give them in pixels from the upper left corner, like --post-places \"120,256,40 390,256,40\"")
    };
    let one = |text: &str| {
        let parts: Vec<&str> = text.split(',').collect();
        let &[column, row, size] = parts.as_slice() else { return None };
        let parse =
            |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let shape = match size.split_once('x') {
            None => PostShape::Round { diameter_px: parse(size)? },
            Some((along, across)) => {
                PostShape::Rectangle { along_px: parse(along)?, across_px: parse(across)? }
            }
        };
        Some(Post { middle_px: [parse(column)?, parse(row)?], shape })
    };
    let posts: Option<Vec<Post>> = text.split_whitespace().map(one).collect();
    posts.and_then(|posts| posts.try_into().ok()).ok_or_else(wrong)
}

impl Experiment for FollowPosts {
    type Outcome = FollowedPosts;

    fn run(
        &self,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<FollowedPosts, ExperimentError> {
        let name = film_name(&self.track.film, files)?;
        let failed = |error: &dyn std::fmt::Display| {
            ExperimentError::new(format!("`{}`: {error}", self.track.film.display()))
        };
        if let Some(stiffness) = self.stiffness.filter(|it| !(it.is_finite() && *it > 0.0)) {
            return Err(ExperimentError::new(format!(
                "the stiffness of a post is {stiffness} nN/um; it must be above 0"
            )));
        }
        let OpenedFilm { film, frames_per_second, .. } =
            OpenedFilm::of(&self.track, files, observer)?;
        let Some(pixel_size) = film.pixel_size.map(|stated| stated.size) else {
            return Err(failed(&"the film does not say how large its pixels are")
                .advise("give it like --pixel-size \"1.6 um\""));
        };
        let advise = "state the places of the posts: column, row and diameter of each in pixels of the film, as in `120,256,40 390,256,40`";
        let (places, found) = if let Some(posts) = self.posts {
            (PostPlaces { frame: self.track.stated_frame().unwrap_or(0), posts }, None)
        } else {
            observer.stage("posts", 1);
            let found = posts::find(&film).map_err(|error| failed(&error).advise(advise))?;
            observer.reached(1);
            (found.places, Some(found))
        };
        observer.keeps("the frames that are done are written");
        let interruption = observer.interruption();
        let mut begun = false;
        let goes_on = |(done, all): (usize, usize)| {
            if !begun {
                observer.stage("frames", all as u64);
                begun = true;
            }
            observer.reached(done as u64);
            !interruption.is_requested()
        };
        let motion = posts::follow(&film, &places, goes_on)
            .map_err(|error| failed(&error).advise(advise))?;
        let rest = film.frame(motion.rest.frame).map_err(|error| failed(&error))?;
        let times_ms: Vec<f64> =
            motion.frames.iter().map(|&frame| 1000.0 * frame as f64 / frames_per_second).collect();
        let mut report = PostsReport::of(&self.track.film, &film, &motion, found.as_ref());
        report.pixel_size_um = pixel_size.um();
        report.frames_per_second = frames_per_second;
        report.stiffness_nn_per_um = self.stiffness;
        let mut followed = FollowedPosts {
            name,
            motion,
            report,
            beats: Err(String::new()),
            rest,
            stiffness: self.stiffness,
            times_ms,
        };
        followed.report.measure(&followed.motion);
        let analyse = Analyse { curves: vec![followed.curve()], ..Analyse::default() };
        followed.beats = analyse.run(files, &()).map_err(|error| error.to_string());
        let shown = followed.overlay().map(|figure| Shown {
            of: followed.name.clone(),
            id: "posts",
            title: "The posts",
            words: "The frame at rest with the posts that were followed.".to_owned(),
            figure,
            tiles: Vec::new(),
        });
        if let Ok(beats) = &mut followed.beats {
            beats.shown = shown.ok();
            beats.notes.extend(followed.report.warnings.iter().cloned());
        }
        Ok(followed)
    }
}

impl FollowedPosts {
    /// Times of the frames, ms.
    pub fn times_ms(&self) -> &[f64] {
        &self.times_ms
    }

    /// How much nearer the posts are than at rest, um, by frame.
    pub fn approach_um(&self) -> Vec<Option<f64>> {
        let pixel = self.report.pixel_size_um;
        self.motion.approach_px().iter().map(|approach| approach.map(|px| pixel * px)).collect()
    }

    /// The force on each post, nN, by frame; `None` where the stiffness is not known.
    pub fn force_nn(&self) -> Option<Vec<Option<f64>>> {
        let half = 0.5 * self.stiffness?;
        Some(self.approach_um().iter().map(|approach| approach.map(|um| half * um)).collect())
    }

    /// The force over time, or the approach where the stiffness is not known.
    fn curve(&self) -> Curve {
        let force = self.force_nn();
        let (name, kind, unit) = match force {
            Some(_) => ("force_nN", Kind::Force, "nN"),
            None => ("approach_um", Kind::Contraction, "um"),
        };
        let values = force.unwrap_or_else(|| self.approach_um());
        // The names of the columns are the first line of the table.
        let rows = values.iter().zip(&self.times_ms).zip(2..);
        let rows = rows.filter_map(|((value, time), line)| Some(((*value)?, *time, line)));
        let (mut values, mut times_ms, mut lines) = (Vec::new(), Vec::new(), Vec::new());
        for (value, time, line) in rows {
            values.push(value);
            times_ms.push(time);
            lines.push(line);
        }
        Curve { name: name.to_owned(), kind, unit, values, times_ms, lines, stimuli_ms: Vec::new() }
    }

    /// A row for each frame.
    fn table(&self) -> Table {
        let pixel = self.report.pixel_size_um;
        let [first, second] = self.motion.inward_px();
        let um =
            |px: &[Option<f64>]| px.iter().map(|px| px.map(|px| pixel * px)).collect::<Vec<_>>();
        let all = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
        let [one, two] = &self.motion.tracks;
        let frames = self.motion.frames.iter().map(|&frame| Some(frame as f64)).collect();
        let columns = [
            ("frame", frames),
            ("t_ms", all(&self.times_ms)),
            ("approach_um", self.approach_um()),
            ("post_1_inward_um", um(&first)),
            ("post_2_inward_um", um(&second)),
            ("post_1_error_um", um(&one.error_px)),
            ("post_2_error_um", um(&two.error_px)),
            ("post_1_correlation", one.correlation.clone()),
            ("post_2_correlation", two.correlation.clone()),
        ];
        let force = self.force_nn().map(|force| ("force_nN", force));
        let column = |(name, values): (&str, Vec<Option<f64>>)| Column::Number {
            name: name.to_owned(),
            values,
        };
        Table { columns: columns.into_iter().chain(force).map(column).collect() }
    }

    /// The frame at rest with the posts drawn on it.
    fn overlay(&self) -> Result<Figure, FigureError> {
        let pixel = self.report.pixel_size_um;
        let height = self.rest.height() as f64;
        let axis = self.motion.rest.axis();
        let rings = self.motion.rest.posts.map(|post| {
            let corner = |along: f64, across: f64| {
                let [x, y] = post.middle_px;
                let [u, v] = [
                    x + along * axis[0] - across * axis[1],
                    y + along * axis[1] + across * axis[0],
                ];
                [pixel * (u + 0.5), pixel * (height - v - 0.5)]
            };
            match post.shape {
                PostShape::Round { diameter_px } => (0..64)
                    .map(|k| {
                        let (sin, cos) = (TAU * f64::from(k) / 64.0).sin_cos();
                        corner(0.5 * diameter_px * cos, 0.5 * diameter_px * sin)
                    })
                    .collect::<Vec<_>>(),
                PostShape::Rectangle { along_px, across_px } => {
                    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                        .map(|[a, b]| corner(0.5 * a * along_px, 0.5 * b * across_px))
                        .to_vec()
                }
            }
        });
        let contour = |(name, ring)| Contour { name, rings: vec![ring], chosen: true };
        let contours: Vec<Contour<'_>> =
            ["1", "2"].into_iter().zip(rings.iter().map(Vec::as_slice)).map(contour).collect();
        figure::overlay(&Overlay {
            title: &self.name,
            width: self.rest.width(),
            height: self.rest.height(),
            values: self.rest.values(),
            pixel_size: self
                .report
                .pixel_size()
                .map_err(|_| FigureError::Nothing { what: "pixels" })?,
            cells: &contours,
            chosen: ["post", "posts"],
            mesh: None,
            fibres: &[],
            sarcomeres: None,
            warnings: &self.warnings(),
        })
    }
}

impl Outcome for FollowedPosts {
    fn numbers(&self) -> impl Serialize {
        &self.report
    }

    fn warnings(&self) -> Vec<String> {
        match &self.beats {
            Ok(beats) => beats.warnings(),
            Err(why) => {
                let why = format!("no beats: {why}");
                self.report.warnings.iter().cloned().chain([why]).collect()
            }
        }
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        folder.write("posts.csv", self.table().for_people().to_csv()?)?;
        folder.write("posts.json", json::for_people(&self.report)?)?;
        let overlay = || self.overlay();
        let figures: [(&str, Draw<'_>); 1] = [("posts", &overlay)];
        folder.figures(Theme::Light, &figures, observer)?;
        match &self.beats {
            Ok(beats) => beats.save(folder, observer),
            Err(_) => Ok(()),
        }
    }
}
