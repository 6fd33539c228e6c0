//! Fits in words.

use crate::table::aligned;
use myospring::experiment::fit::words::{TRIED, estimates, headline, precise, residual, tried};
use myospring::experiment::fit::{Fits, FittedCell, Shapes};
use myospring::experiment::tension_map::FilmMap;
use myospring::fit::Fit;
use std::fmt::Write as _;

/// The printed text.
pub(super) fn for_people(fits: &Fits) -> String {
    let mut text = match fits.cells.as_slice() {
        [FittedCell { found: Ok(fit), .. }] => one(fit),
        _ => several(fits),
    };
    let shapes = fits.shapes.iter().map(Shapes::words);
    for line in shapes.chain(fits.map.iter().map(FilmMap::words)) {
        let newline = if text.ends_with('\n') { "" } else { "\n" };
        let _ = write!(text, "{newline}{line}");
    }
    text
}

fn one(fit: &Fit) -> String {
    let mut rows = vec![["", "value", "95 % interval", ""].map(str::to_owned).to_vec()];
    rows.extend(estimates(fit).into_iter().map(|row| row.to_vec()));
    let mut text = format!("{}\n\n{}", headline(fit), aligned(&rows, &[]));
    for curve in &fit.curves {
        let _ = write!(text, "\n{}", residual(curve));
    }
    let tried = tried(fit);
    if !tried.is_empty() {
        let rows = [TRIED.map(str::to_owned)].into_iter().chain(tried).map(Vec::from);
        let _ = write!(text, "\n\n{}", aligned(&rows.collect::<Vec<_>>(), &[]));
    }
    text
}

fn several(fits: &Fits) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (_, fit) in fits.fitted() {
        for estimate in &fit.estimates {
            if !names.contains(&estimate.name.as_str()) {
                names.push(&estimate.name);
            }
        }
    }
    let mut head = ["cell", "model", "verdict"].map(str::to_owned).to_vec();
    head.extend(names.iter().map(|name| (*name).to_owned()));
    let mut rows = vec![head];
    for cell in &fits.cells {
        let mut row = vec![cell.name.clone()];
        match &cell.found {
            Ok(fit) => {
                row.push(fit.model.clone());
                row.push(fit.verdict.word().replace('-', " "));
                row.extend(names.iter().map(|name| {
                    fit.estimate(name)
                        .map_or_else(String::new, |estimate| precise(estimate.value, estimate))
                }));
            }
            Err(why) => row.extend([String::new(), format!("not fitted: {why}")]),
        }
        rows.push(row);
    }
    aligned(&rows, &[])
}
