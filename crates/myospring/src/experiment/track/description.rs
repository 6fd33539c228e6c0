//! The description of tracking a film.

use crate::experiment::input::ChosenSetting;
use crate::experiment::refused::Place;
use crate::microscopy::motion::TrackingSettings;
use crate::settings::Value;
use std::path::PathBuf;

/// Follows the cell of a film.
#[derive(Debug, Clone)]
pub struct Track {
    /// The film, or the folder of its pictures.
    pub film: PathBuf,
    /// Settings of shape, segmentation and fibres.
    pub settings: Vec<ChosenSetting>,
    /// Frames a second; `None` uses that of the film.
    pub frame_rate: Option<f64>,
    /// Side of the squares of the picture that are searched in each frame, um.
    pub subset_um: f64,
    /// Threads; `None` uses all cores. The numbers do not depend on it.
    pub threads: Option<usize>,
    /// Where an overlay goes if the film shows no cell.
    pub refused: Option<Place>,
    /// What is saved in addition to the curve.
    pub outputs: Vec<Output>,
}

impl Track {
    /// A film, with defaults for all else.
    pub fn of(film: impl Into<PathBuf>) -> Self {
        Self {
            film: film.into(),
            settings: Vec::new(),
            frame_rate: None,
            subset_um: TrackingSettings::SUBSET_UM,
            threads: None,
            refused: None,
            outputs: Output::DEFAULT.to_vec(),
        }
    }

    /// The frame that the settings state, from 0.
    pub(in crate::experiment) fn stated_frame(&self) -> Option<usize> {
        self.settings.iter().find_map(|(setting, value)| match value {
            Value::Whole(frame) if setting.key == "segmentation.frame" => {
                usize::try_from(*frame).ok()
            }
            _ => None,
        })
    }
}

/// What is saved in addition to the curve of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Pictures of the cell and its curves.
    Figures,
    /// The film with the lattice laid over.
    Gif,
    /// Positions for NumPy.
    Frames,
    /// Displacements and strains for `ParaView`.
    Vtu,
}

impl Output {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Figures, Self::Gif, Self::Frames, Self::Vtu];
    /// What is saved by default.
    pub const DEFAULT: [Self; 3] = [Self::Figures, Self::Gif, Self::Frames];

    /// Its word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Figures => "figures",
            Self::Gif => "gif",
            Self::Frames => "frames",
            Self::Vtu => "vtu",
        }
    }

    /// What it is, with the names of its files.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Figures => "cell at rest and shortest, curves: figures/track, SVG and PNG",
            Self::Gif => "the film with the lattice laid over (track.gif)",
            Self::Frames => {
                "positions of all points, which were interpolated, mesh and fibres, for NumPy (frames.npz)"
            }
            Self::Vtu => {
                "displacements and strains for ParaView: open cell.pvd (and the folder vtu/)"
            }
        }
    }
}
