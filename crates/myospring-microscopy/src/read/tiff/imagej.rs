//! The description that ImageJ writes: lines of `name=value` after `ImageJ=version`.

use super::planes::{Axis, CHANNEL_FIRST, Planes, Run};
use crate::picture::PixelSizeSource;
use crate::read::PictureError;
use crate::read::pixel_size::{Stated, unit_um};

/// The content of ImageJ's description.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ImageJ {
    images: u64,
    channels: u64,
    slices: u64,
    frames: u64,
    /// Whether the axes were set by a user or an instrument; otherwise `slices` is only the number
    /// of pages.
    hyperstack: bool,
    /// Distance between slices in `unit`, which only a stack in depth has.
    spacing: Option<f64>,
    unit: Option<String>,
    /// Time between two frames, s.
    frame_interval_s: Option<f64>,
}

impl ImageJ {
    /// Reads a description; `None` if another program wrote it.
    pub(super) fn read(description: &str) -> Option<Self> {
        description.starts_with("ImageJ=").then(|| {
            let value = |name: &str| {
                description.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='))
            };
            let number = |name| value(name).and_then(|text| text.trim().parse().ok()).unwrap_or(1);
            let real = |name| value(name).and_then(|text| text.trim().parse::<f64>().ok());
            // `finterval` is the recorded interval; without it, `fps`, the speed of display, is
            // used.
            let per_unit = match value("tunit").map(str::trim) {
                Some("ms" | "msec") => 1e-3,
                Some("min") => 60.0,
                _ => 1.0,
            };
            let recorded = real("finterval").filter(|interval| *interval > 0.0);
            let shown = real("fps").filter(|rate| *rate > 0.0).map(f64::recip);
            let interval = recorded.map(|interval| interval * per_unit).or(shown);
            Self {
                images: number("images"),
                channels: number("channels"),
                slices: number("slices"),
                frames: number("frames"),
                hyperstack: value("hyperstack").is_some_and(|text| text.trim() == "true"),
                spacing: value("spacing").map(|text| text.trim().parse().unwrap_or(f64::NAN)),
                unit: value("unit").map(str::to_owned),
                frame_interval_s: interval,
            }
        })
    }

    /// Whether the description states the meaning of the pages.
    ///
    /// ImageJ writes `slices=5` for any series of 5 pages, also for a film.
    pub(super) fn says_axes(&self) -> bool {
        self.hyperstack || self.spacing.is_some() || self.channels > 1 || self.frames > 1
    }

    /// Which plane each page contains; `None` if the numbers do not match the pages.
    ///
    /// # Errors
    /// A file above 4 GB, in which ImageJ writes one page for all images.
    pub(super) fn planes(&self, pages: u64) -> Result<Option<Planes>, PictureError> {
        if self.images > 1 && pages == 1 {
            return Err(PictureError::TooMuch {
                what: format!("{} images under one page, as ImageJ writes above 4 GB", self.images),
                most: "one image per page is read".to_owned(),
                mend: "save it as OME-TIFF, or duplicate the part that you need",
            });
        }
        let planes = Planes::new([self.channels, self.slices, self.frames], CHANNEL_FIRST);
        Ok(planes.filter(|planes| planes.count() == pages).map(|mut planes| {
            planes.add([0; 3], Run { page: 0, count: pages, elsewhere: None });
            planes
        }))
    }

    /// Time between two frames, s.
    pub(super) fn frame_interval_s(&self) -> Option<f64> {
        self.frame_interval_s
    }

    /// Size of a pixel from the resolution tags, which count pixels per unit.
    pub(super) fn pixel_size(&self, per_unit: [Option<f64>; 2]) -> Option<Stated> {
        let um = unit_um(self.unit.as_ref()?)?;
        let side =
            |per_unit: Option<f64>| per_unit.filter(|&count| count > 0.0).map(|count| um / count);
        let x_um = side(per_unit[0])?;
        let y_um = side(per_unit[1]).unwrap_or(x_um);
        Some(Stated { x_um, y_um, source: PixelSizeSource::ImageJ })
    }

    /// Distance of two slices, um; its sign is only the direction in which the stage moved.
    pub(super) fn z_step_um(&self) -> Option<f64> {
        let um = unit_um(self.unit.as_ref()?)?;
        self.spacing.map(|spacing| spacing.abs() * um)
    }

    /// The declared numbers in words.
    pub(super) fn words(&self) -> String {
        let [channels, slices, frames] = [self.channels, self.slices, self.frames];
        format!("{channels} channels x {slices} slices x {frames} frames")
    }
}

/// Pages without stated meaning, assigned to one axis.
pub(super) fn series(axis: Axis, pages: u64) -> Option<Planes> {
    let mut sizes = [1; 3];
    sizes[axis as usize] = pages;
    let mut planes = Planes::new(sizes, CHANNEL_FIRST)?;
    planes.add([0; 3], Run { page: 0, count: pages, elsewhere: None });
    Some(planes)
}
