//! What to cite.

use crate::cell::CellModel;
use crate::references;

/// BibTeX entries of this program, the paper behind it, and the papers of a cell model.
pub fn bibtex(model: &dyn CellModel) -> String {
    let mut keys = vec!["coelho_2021"];
    for key in model.citations() {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let version = env!("CARGO_PKG_VERSION");
    let program = format!(
        "@software{{myospring,\n  author  = {{{{The Myospring developers}}}},\n  title   = \
         {{Myospring: from a microscope picture of a heart cell to its beat}},\n  version = \
         {{{version}}},\n  year    = {{2026}}\n}}"
    );
    let papers = keys.into_iter().filter_map(references::entry).map(str::to_owned);
    std::iter::once(program).chain(papers).collect::<Vec<_>>().join("\n\n")
}
