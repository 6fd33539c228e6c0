//! How two posts moved.

use super::post::PostPlaces;

/// One post in all frames that were followed. All lists have one entry for each frame of [`PostMotion::frames`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PostTrack {
    /// Displacement from the frame at rest, pixels, to the right and downward; `None` where the post was lost. The motion of the
    /// stage is in it.
    pub displacement_px: Vec<Option<[f64; 2]>>,
    /// Best zero-normalised cross-correlation with the frame at rest, -1 to 1, also where it was too low for the post to count as
    /// found; `None` where there was nothing to compare.
    pub correlation: Vec<Option<f64>>,
    /// Standard error of the displacement in its worst direction, pixels, from the residual grey values of the match; `None` where
    /// the post was lost.
    pub error_px: Vec<Option<f64>>,
}

/// The motion of two posts.
#[derive(Debug, Clone, PartialEq)]
pub struct PostMotion {
    /// The posts in the frame at rest, in which they are farthest apart.
    pub rest: PostPlaces,
    /// Numbers in the film of the frames that were followed, ascending.
    pub frames: Vec<usize>,
    /// Whether `goes_on` stopped it before all frames were done.
    pub interrupted: bool,
    /// Each post.
    pub tracks: [PostTrack; 2],
}

impl PostMotion {
    /// How much nearer the posts are to each other than at rest, pixels, by frame; `None` where one of them was lost. A motion of
    /// the stage does not change it.
    pub fn approach_px(&self) -> Vec<Option<f64>> {
        let [a, b] = self.rest.posts.map(|post| post.middle_px);
        let distance = self.rest.distance_px();
        let approach = |at: usize| {
            let [u, v] = self.both(at)?;
            let apart = |k: usize| b[k] + v[k] - a[k] - u[k];
            Some(distance - apart(0).hypot(apart(1)))
        };
        (0..self.frames.len()).map(approach).collect()
    }

    /// Mean displacement of both posts, pixels, by frame, to the right and downward; `None` where one of them was lost. It is the
    /// motion of the stage where both posts give way alike.
    pub fn drift_px(&self) -> Vec<Option<[f64; 2]>> {
        let mean = |at: usize| {
            let [u, v] = self.both(at)?;
            Some([0, 1].map(|k: usize| f64::midpoint(u[k], v[k])))
        };
        (0..self.frames.len()).map(mean).collect()
    }

    /// Displacement of each post along the line to the other at rest, pixels, by frame; positive toward the other; `None` where
    /// the post was lost. The motion of the stage is in it.
    pub fn inward_px(&self) -> [Vec<Option<f64>>; 2] {
        let axis = self.rest.axis();
        [(0, 1.0), (1, -1.0)].map(|(post, sign): (usize, f64)| {
            let moved = self.tracks[post].displacement_px.iter();
            moved.map(|moved| moved.map(|[x, y]| sign * (x * axis[0] + y * axis[1]))).collect()
        })
    }

    /// The displacements of the posts minus the mean of both, which is taken for the motion of the stage: the posts then move by
    /// the same amount in opposite directions. `None` where one of them was lost.
    pub fn without_drift_px(&self) -> [Vec<Option<[f64; 2]>>; 2] {
        let drift = self.drift_px();
        [0, 1].map(|post: usize| {
            let moved = self.tracks[post].displacement_px.iter().zip(&drift);
            let minus = |(moved, drift): (&Option<[f64; 2]>, &Option<[f64; 2]>)| {
                let (moved, drift) = moved.as_ref().zip(drift.as_ref())?;
                Some([0, 1].map(|k: usize| moved[k] - drift[k]))
            };
            moved.map(minus).collect()
        })
    }

    /// Part of the frames in which both posts were found, 0 to 1.
    pub fn found_share(&self) -> f64 {
        let found = (0..self.frames.len()).filter(|&at| self.both(at).is_some()).count();
        found as f64 / self.frames.len().max(1) as f64
    }

    /// Displacements of both posts in a frame where both were found.
    fn both(&self, at: usize) -> Option<[[f64; 2]; 2]> {
        let [u, v] = [0, 1].map(|post: usize| self.tracks[post].displacement_px[at]);
        Some([u?, v?])
    }
}
