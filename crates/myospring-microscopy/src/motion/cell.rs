//! A cell at rest, how it is followed, and its motion.

use super::neighbours::{self, REACH};
use super::stage::Stage;
use crate::fibres::FibreField;
use myospring_core::mesh::Mesh;
use myospring_core::mesh::pixel_size::PixelSize;

/// Options for following a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackingSettings {
    /// Frames a second.
    pub frames_per_second: f64,
    /// Side of a subset, um; limited to 17 to 61 pixels, or of beads to 161.
    pub subset_um: f64,
    /// Number of threads; `None` uses one per core. Results do not depend on it.
    pub threads: Option<usize>,
    /// What the pictures show, which decides how far points may be searched.
    pub texture: Texture,
}

/// The texture whose motion is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Texture {
    /// The inside of a cell, with stripes that repeat at the length of a sarcomere.
    Cell,
    /// Beads at random places. Displacements are not smoothed, and the whole picture may jump between frames.
    Beads {
        /// Mean distance of beads, um.
        distance_um: f64,
    },
}

impl TrackingSettings {
    /// Default side of a subset, um: two sarcomeres.
    pub const SUBSET_UM: f64 = 4.0;
    /// Sides of a subset that make sense, um.
    pub const SUBSETS_UM: [f64; 2] = [0.5, 100.0];
    /// No camera takes more frames a second.
    pub const HIGHEST_FRAME_RATE: f64 = 1e6;

    /// The defaults for a frame rate.
    pub const fn at(frames_per_second: f64) -> Self {
        Self {
            frames_per_second,
            subset_um: Self::SUBSET_UM,
            threads: None,
            texture: Texture::Cell,
        }
    }
}

/// The cell in the frame at rest.
#[derive(Debug, Clone, Copy)]
pub struct CellAtRest<'a> {
    /// Its lattice, um from the lower left corner of the picture.
    pub mesh: &'a Mesh,
    /// For each pixel, row by row from the top left: whether it belongs to this cell.
    pub inside: &'a [bool],
    /// For each pixel, row by row from the top left: whether it belongs to any cell, this one or
    /// another.
    pub any_cell: &'a [bool],
    /// Side of a pixel.
    pub pixel_size: PixelSize,
    /// Its fibres; used to measure sarcomeres.
    pub fibres: Option<&'a FibreField>,
}

/// The motion of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellMotion {
    /// The lattice at rest.
    pub mesh: Mesh,
    /// Numbers in the film of the frames that were followed, ascending. All lists by frame below
    /// are in this order.
    pub frames: Vec<usize>,
    /// Numbers of the frames that repeat the one before ([`Film::repeats`](crate::film::Film::repeats)); they were not
    /// followed.
    pub repeated: Vec<usize>,
    /// Whether `goes_on` stopped it before all frames were done.
    pub interrupted: bool,
    /// Number in the film of the frame at rest; it is one of [`CellMotion::frames`].
    pub rest: usize,
    /// Time of each frame from the first of the film, ms.
    pub times_ms: Vec<f64>,
    /// Displacement of each point from its position at rest, without the motion of the stage, um, y
    /// upward: `displacements_um[frame][axis][point]`.
    pub displacements_um: Vec<[Vec<f64>; 2]>,
    /// Which points were interpolated from their neighbours: `interpolated[frame][point]`.
    pub interpolated: Vec<Vec<bool>>,
    /// Median zero-normalised correlation of the points that were found, by frame; 1 for a perfect
    /// match.
    pub correlation: Vec<Option<f64>>,
    /// How the motion of the stage was determined.
    pub stage: Stage,
    /// Motion of the stage that was subtracted in each frame, um, y upward.
    pub stage_um: Vec<[f64; 2]>,
    /// Mean length of the sarcomeres in each frame by the period of the stripes, um; `None` where the picture shows
    /// none.
    pub sarcomeres_um: Vec<Option<f64>>,
    /// Number of places at which sarcomeres were read.
    pub sarcomere_places: usize,
    /// Number of independent parts of the cell in which these places lie: the parts are so far
    /// apart that they share no stripes.
    pub sarcomere_parts: usize,
    /// Mean length in each frame, in each of these parts, um; empty if there are too few parts for
    /// a mean.
    pub sarcomeres_by_part_um: Vec<Vec<Option<f64>>>,
    /// Median standard error of a point's displacement due to noise, um.
    pub error_um: Option<f64>,
    /// Standard deviation of the noise, grey levels.
    pub noise: f64,
    /// Side of a subset, um.
    pub subset_um: f64,
    /// Side of a pixel, um.
    pub pixel_um: f64,
    /// Width and height of the frame, um; its lower left corner is the origin.
    pub frame_um: [f64; 2],
}

/// Progress: number of frames done, and of all frames to follow (without repeats).
pub type Progress = (usize, usize);

impl CellMotion {
    /// Which points lie within one spacing of the frame's edge, where the frame may cut the cell.
    pub fn cut(&self) -> Vec<bool> {
        let reach = spacing(&self.mesh);
        let at_edge = |point: usize| {
            let place = self.mesh.point(point);
            (0..2).any(|axis| place[axis] < reach || self.frame_um[axis] - place[axis] < reach)
        };
        (0..self.mesh.len()).map(at_edge).collect()
    }

    /// Standard deviation of the Gaussian that averages a point with its neighbours, um.
    pub fn smoothing_um(&self) -> f64 {
        f64::from(REACH / neighbours::SMOOTHING) * spacing(&self.mesh)
    }

    /// Side of a square within which the errors of points are correlated, um, because subsets
    /// overlap and neighbours are averaged. The cell has about as many independent errors as it has
    /// such squares.
    pub fn alike_um(&self) -> f64 {
        let smoothing = self.smoothing_um();
        // Areas of correlation add: a side a has a^2, a Gaussian of standard deviation s has 4 pi
        // s^2.
        (self.subset_um.powi(2) + 4.0 * std::f64::consts::PI * smoothing.powi(2)).sqrt()
    }
}

/// Distance of neighbouring points, um.
pub(super) fn spacing(mesh: &Mesh) -> f64 {
    let mean = || (mesh.area() / mesh.len() as f64).sqrt();
    mesh.lattice.as_ref().map_or_else(mean, |lattice| lattice.spacing)
}
