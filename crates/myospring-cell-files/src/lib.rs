//! Published cell models in files: CellML 1.0, 1.1 and 2.0, and Myokit's `.mmt`, read to
//! [`Equations`].
//!
//! A file is foreign input: its size, depth and number of operations are bounded, imports stay in
//! its folder, and everything that cannot be read is one [`ReadError`] with file, component and line.
//!
//! # Example
//! ```
//! use myospring_cell_files::{Choices, read};
//!
//! let text = "[[model]]\nmembrane.V = -80\n\n[engine]\ntime = 0 [ms] in [ms] bind time\n\n\
//!             [membrane]\ndot(V) = -0.1 [1/ms] * (V + 80 [mV]) in [mV]\n";
//! let equations = read("decay.mmt", text, &Choices::default(), &|_| None)?;
//! assert_eq!(equations.states[0].name, "membrane.V");
//! assert_eq!(equations.evaluate(&[], &[-70.0], 0.0, 0.0).rates(), [-1.0]);
//! # Ok::<(), myospring_cell_files::ReadError>(())
//! ```

mod assemble;
mod cellml;
mod draft;
mod emit;
mod files;
mod mmt;
mod reading;
mod removable;
mod roles;
mod stimulus;
mod unit;

use myospring_core::cell::equations::Equations;

pub use files::open;
pub use reading::{Choices, LONGEST_FILE, ReadError};

/// Whether a name ends as a model file does: `.mmt`, `.cellml`.
pub fn is_model_file(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    [".mmt", ".cellml"].iter().any(|ending| name.ends_with(ending) && name.len() > ending.len())
}

/// Whether the content of a model file takes parts of the model from other files.
pub fn has_imports(content: &[u8]) -> bool {
    let text = String::from_utf8_lossy(content);
    roxmltree::Document::parse(&text).is_ok_and(|document| {
        document.descendants().any(|element| element.tag_name().name() == "import")
    })
}

/// Reads the text of a model file. `beside` returns the text of an imported file, by its path
/// relative to the folder of the file, or `None` if there is none.
///
/// # Errors
/// Text that is not a model, or a model that cannot be simulated; the error says where and why.
pub fn read(
    file: &str,
    text: &str,
    choices: &Choices,
    beside: &dyn Fn(&str) -> Option<String>,
) -> Result<Equations, ReadError> {
    if text.len() > LONGEST_FILE {
        return Err(ReadError {
            file: file.to_owned(),
            line: None,
            component: None,
            reason: format!("the file is longer than {} MB", LONGEST_FILE >> 20),
        });
    }
    let start = text.trim_start_matches('\u{feff}').trim_start();
    let draft =
        if start.starts_with('<') { cellml::parse(file, text, beside) } else { mmt::parse(text) };
    draft
        .and_then(|draft| assemble::assemble(file, draft, choices))
        .map_err(|problem| problem.in_file(file))
}
