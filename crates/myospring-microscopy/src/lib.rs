//! Pictures to cells: bytes in, outlines, masks and fibre directions out; no file is opened here.
//!
//! In reading order: [`read`] decodes a [`picture`] and gives one [`plane`] of it; [`hot_pixels`]
//! removes hot pixels, [`burned_in`] scale bars and letters; [`segment`] finds the cells in the
//! plane; [`outlines`] reads outlines that were drawn elsewhere, and writes outlines; [`report`]
//! measures the shape of a cell; [`fibres`] reads the direction of its myofibrils. [`cells`]
//! combines these steps; [`whole_frame`] reads fibres where no cell has an outline. A [`film`] is
//! many such planes; [`motion`] follows a cell through them, [`posts`] the two posts
//! of a tissue, [`optical`] the waves that its light shows. A [`stack`] is many such planes in
//! depth; it gives the voxels of a thick cell.

pub mod burned_in;
pub mod cells;
mod dilation;
pub mod fibres;
pub mod film;
pub mod filter;
pub mod hot_pixels;
pub mod motion;
pub mod optical;
pub mod outlines;
pub mod picture;
pub mod plane;
pub mod posts;
pub mod read;
mod region;
pub mod report;
mod runs;
pub mod segment;
pub mod stack;
pub mod whole_frame;
