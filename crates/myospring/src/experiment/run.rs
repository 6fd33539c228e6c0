//! The simulation of one cell: from its settings to curves, numbers, figures, films, a page and
//! frames.

mod activation;
mod beaten;
mod figures;
mod film;
mod finished;
mod on_gel;
mod outputs;
mod page;
mod prepared;
mod record;
mod save;
mod series;
mod watch;

pub use beaten::{FinishedRun, RunNumbers};
pub use finished::Style;
pub use outputs::{ALL, NONE, OUTPUTS, Output, Written, WrittenOutputs, chosen};
pub(super) use page::thick_cell;
pub use page::{FILE, parameters};
pub use prepared::{BeatCell, PreparedRun, RunPlan};
pub use record::{Stop, Timings, resolved};
pub use save::SavedRun;
pub use series::RunSeries;

pub(super) use figures::write as write_figures;
pub(super) use finished::Finished;
pub(super) use save::write_numbers;
