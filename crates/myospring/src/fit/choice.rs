//! Which curves of a table are fitted, where a cell has several.

use crate::analysis::kind::Kind;
use crate::measured::{Curve, listed};

/// Kinds that are fitted, the most informative first.
const KINDS: [Kind; 6] = [
    Kind::NormalisedLength,
    Kind::Length,
    Kind::SarcomereLength,
    Kind::Shortening,
    Kind::Contraction,
    Kind::Unknown,
];

/// One curve for each cell, and a note on which were chosen.
///
/// Curves of one kind are several cells; of several kinds, or the two principal stretches of one
/// deformation, they are of the same cell. Then the stretch along its contraction is chosen, or
/// else its length, sarcomere length, shortening, or motion.
///
/// # Example
/// ```
/// use myospring::measured::{TableOptions, read_bytes};
/// let file = "t_ms,length_um,stretch_1,stretch_2\n0,120,1,1\n10,118,0.98,1.01\n20,119,0.99,1.0\n";
/// let table = read_bytes("track.csv", file.as_bytes(), &TableOptions::default())?;
/// let (curves, note) = myospring::fit::of_each_cell(table.curves);
/// assert_eq!(curves[0].name, "stretch_1");
/// assert!(curves.len() == 1 && note.unwrap().contains("`length_um`, `stretch_2`"));
/// # Ok::<(), myospring::measured::ReadError>(())
/// ```
pub fn of_each_cell(curves: Vec<Curve>) -> (Vec<Curve>, Option<String>) {
    let has = |number| curves.iter().any(|curve| principal(&curve.name) == Some(number));
    let stretches = has(1) && has(2);
    let kind = KINDS.into_iter().find(|kind| curves.iter().any(|curve| curve.kind == *kind));
    let Some(kind) = kind else { return (curves, None) };
    let (taken, others): (Vec<Curve>, Vec<Curve>) = curves.into_iter().partition(|curve| {
        if stretches { principal(&curve.name) == Some(1) } else { curve.kind == kind }
    });
    if others.is_empty() {
        return (taken, None);
    }
    let names = |curves: &[Curve]| {
        listed(&curves.iter().map(|curve| curve.name.clone()).collect::<Vec<_>>())
    };
    let note = format!(
        "fitted: {}; not fitted, since they are other curves of the same cell: {} (--columns chooses one)",
        names(&taken),
        names(&others)
    );
    (taken, Some(note))
}

/// Which principal stretch a column has, by its name.
fn principal(name: &str) -> Option<u32> {
    let name = name.to_lowercase().replace(['_', ' '], "");
    let stem = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let ends = ["stretch", "lambda", "λ"].into_iter().any(|word| stem.ends_with(word));
    name[stem.len()..].parse().ok().filter(|_| ends)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::{TableOptions, read_bytes};

    fn taken(header: &str) -> (Vec<String>, Option<String>) {
        let fields = header.split(',').count();
        let rows: Vec<String> = (0..3).map(|row| vec![row.to_string(); fields].join(",")).collect();
        let text = format!("{header}\n{}\n", rows.join("\n"));
        let table = read_bytes("cell.csv", text.as_bytes(), &TableOptions::default()).unwrap();
        let (curves, note) = of_each_cell(table.curves);
        (curves.into_iter().map(|curve| curve.name).collect(), note)
    }

    #[test]
    fn curves_of_several_kinds_are_of_one_cell_and_those_of_one_kind_are_several() {
        let track =
            "t_ms,length_um,shortening_pct,width_um,area_um2,stretch_1,stretch_2,sarcomere_um";
        let (names, note) = taken(track);
        assert_eq!(names, ["stretch_1"]);
        assert!(note.unwrap().contains("`sarcomere_um`"));
        assert_eq!(taken("t_ms,lambda1,lambda2,mean_norm_sarc_len").0, ["lambda1"]);
        assert_eq!(taken("t_ms,ta_kPa,length_um,shortening_pct").0, ["length_um"]);
        assert_eq!(taken("t_ms,Ratio,Sarc Length (um)").0, ["Sarc Length (um)"]);
        assert_eq!(
            taken("t_ms,length a,length b"),
            (vec!["length a".into(), "length b".into()], None)
        );
        assert_eq!(taken("t_ms,stretch_1"), (vec!["stretch_1".into()], None));
        // What cannot be fitted is an error that says so, later.
        assert_eq!(taken("t_ms,Vm (mV),Ca_nM").0.len(), 2);
    }
}
