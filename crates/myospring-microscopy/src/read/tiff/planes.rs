//! Which page contains which channel, frame and slice.

use std::collections::BTreeMap;

use crate::read::PictureError;
use crate::read::check::check_range;

/// Largest number of channels, frames or slices of a file.
pub(super) const MOST_PLANES: u64 = 1_000_000;

/// The axes, in the order of the arrays below.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    Channel = 0,
    Slice = 1,
    Frame = 2,
}

/// The order of ImageJ and most programs: channels fastest, then slices, then frames.
pub(super) const CHANNEL_FIRST: [Axis; 3] = [Axis::Channel, Axis::Slice, Axis::Frame];

/// Consecutive pages with consecutive planes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Run {
    /// Number of the first page.
    pub(super) page: u64,
    /// Number of pages.
    pub(super) count: u64,
    /// The other file of the set that contains them; `None` for this file.
    pub(super) elsewhere: Option<String>,
}

/// The planes of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Planes {
    /// Numbers of channels, slices and frames, each 1 to [`MOST_PLANES`]. Samples within a page
    /// count as one channel.
    sizes: [u64; 3],
    /// Fastest axis first.
    order: [Axis; 3],
    /// Runs by the number of their first plane in this order.
    runs: BTreeMap<u64, Run>,
}

impl Planes {
    /// Planes without pages; `None` if a size is outside 1 to [`MOST_PLANES`].
    pub(super) fn new(sizes: [u64; 3], order: [Axis; 3]) -> Option<Self> {
        let fit = sizes.iter().all(|size| (1..=MOST_PLANES).contains(size));
        fit.then_some(Self { sizes, order, runs: BTreeMap::new() })
    }

    /// Adds pages from a plane on.
    pub(super) fn add(&mut self, at: [u64; 3], run: Run) {
        self.runs.insert(self.index(at), run);
    }

    /// Number of channels, frames or slices.
    pub(super) fn size(&self, axis: Axis) -> usize {
        self.sizes[axis as usize] as usize
    }

    /// Number of all planes.
    pub(super) fn count(&self) -> u64 {
        self.sizes.iter().product()
    }

    /// Number of a plane; below 10^18, since sizes are at most [`MOST_PLANES`].
    fn index(&self, at: [u64; 3]) -> u64 {
        let by_axis = self.order.iter().rev();
        by_axis.fold(0, |index, &axis| index * self.sizes[axis as usize] + at[axis as usize])
    }

    /// The page that contains a plane.
    pub(super) fn page(
        &self,
        channel: usize,
        slice: usize,
        frame: usize,
        pages: usize,
    ) -> Result<usize, PictureError> {
        for (what, axis, asked) in [
            ("channel", Axis::Channel, channel),
            ("slice", Axis::Slice, slice),
            ("frame", Axis::Frame, frame),
        ] {
            check_range(what, asked, self.size(axis))?;
        }
        let index = self.index([channel, slice, frame].map(|number| number as u64));
        let run = self.runs.range(..=index).next_back();
        let run = run.filter(|(first, run)| index - **first < run.count);
        if let Some((_, Run { elsewhere: Some(file), .. })) = run {
            return Err(PictureError::Elsewhere { file: file.clone() });
        }
        let page = run.and_then(|(first, run)| run.page.checked_add(index - first));
        let page = page.and_then(|page| usize::try_from(page).ok()).filter(|&page| page < pages);
        page.ok_or(PictureError::MissingPlane { channel, frame, slice, pages })
    }
}
