//! Studies: many members, each computed independently, on as many threads as there are cores.
//!
//! A [`Member`] has a name and a key, the hash of its input. [`run`] calls a closure for each
//! member, which returns its [`Row`]s of the table. A [`Journal`] records finished members, so an
//! interrupted study resumes, and a member whose input has changed is computed again. A member that
//! fails becomes a row with the reason and does not affect the others. Rows do not depend on the
//! number of threads.
//!
//! | module | a member is |
//! |---|---|
//! | [`pictures`] | a picture: its cells are found, meshed and simulated, or skipped with the reason |
//! | [`cells`] | a cell without a mesh; many cells are integrated together |
//! | [`parameters`] | a run with its own parameter values: sensitivity analyses, populations |
//!
//! [`sampling`] chooses the parameter values of the members, and [`sensitivity`] computes which
//! parameters matter.
//!
//! # Example
//! Anything can be a member:
//! ```
//! use myospring::output::table::{Column, Table};
//! use myospring::study::{self, Journal, Member, Row, Status, Threads, sha256};
//! use serde::{Deserialize, Serialize};
//!
//! struct Number(String);
//!
//! #[derive(Clone, Serialize, Deserialize)]
//! struct Root {
//!     of: String,
//!     root: Result<f64, String>,
//! }
//!
//! impl Member for Number {
//!     const KIND: &'static str = "number";
//!     type Row = Root;
//!     fn name(&self) -> &str {
//!         &self.0
//!     }
//!     fn key(&self) -> Option<String> {
//!         Some(sha256(self.0.as_bytes()))
//!     }
//! }
//!
//! impl Row for Root {
//!     fn failed(member: &str, reason: String) -> Self {
//!         Self { of: member.to_owned(), root: Err(reason) }
//!     }
//!     fn status(&self) -> Status {
//!         if self.root.is_ok() { Status::Ok } else { Status::Failed }
//!     }
//!     fn table(rows: &[Self]) -> Table {
//!         let values = rows.iter().map(|row| row.root.clone().ok()).collect();
//!         Table { columns: vec![Column::Number { name: "root".into(), values }] }
//!     }
//! }
//!
//! let members = ["4", "nine"].map(|text| Number(text.to_owned()));
//! let report = study::run(&members, &Journal::in_memory(), &Threads::new(None)?, &(), |member| {
//!     let root = Ok(member.0.parse::<f64>()?.sqrt());
//!     Ok(vec![Root { of: member.0.clone(), root }])
//! })?;
//! assert_eq!(report.rows[0].root, Ok(2.0));
//! assert_eq!(report.rows[1].root, Err("invalid float literal".to_owned()));
//! # Ok::<(), study::StudyError>(())
//! ```

pub mod cells;
mod error;
mod journal;
mod member;
mod observer;
pub mod parameters;
pub mod pictures;
mod runner;
pub mod sampling;
pub mod sensitivity;
mod threads;

/// Error that the work on a member returns when it ends early because the study is asked to stop.
/// The member then has no row; a resumed study computes it again.
pub use crate::interruption::Interrupted;
pub use crate::output::files::sha256;
pub use error::{Cause, StudyError};
pub use journal::Journal;
pub use member::{Member, Row, Status};
pub use observer::{StudyObserver, TABLE_EVERY};
pub use runner::{StudyReport, run, run_together};
pub use threads::Threads;
