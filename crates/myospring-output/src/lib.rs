//! Curves, figures and numbers for people and machines.
//!
//! Every renderer is a pure function: it takes recorded data and returns text or bytes, always the
//! same for the same input. Only [`files`] touches the disk.
//!
//! | module | gives |
//! |---|---|
//! | [`csv`] | `traces.csv`, one row per sample, units in the column names |
//! | [`fibres`] | `fibres.csv`, one row per triangle |
//! | [`field`] | fields by which a cell is coloured: values, units, colours |
//! | [`frames`] | `frames.npz`, all shapes with mesh and fibres, for NumPy |
//! | [`npy`] | NumPy's file of one array, written record by record in any order |
//! | [`npz`] | NumPy's archive of arrays, written and read |
//! | [`vtu`] | frames for ParaView, compressed |
//! | [`json`] | any serialisable value for machines |
//! | [`figure`] | the figures of a paper, as SVG and PNG |
//! | [`page`] | `report.html`: a page with the beating cell, curves and numbers of one or several runs |
//! | [`table`] | one row per run, as CSV and Parquet |
//! | [`track`] | `track.csv`, a tracked cell, one row per frame |
//! | [`files`] | atomic writing of files and folders |

pub mod csv;
pub mod digits;
pub mod fibres;
pub mod field;
pub mod figure;
pub mod files;
pub mod frames;
pub mod json;
pub mod npy;
pub mod npz;
pub mod page;
mod surface;
pub mod table;
pub mod track;
pub mod vtu;
