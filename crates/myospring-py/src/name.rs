//! What a setting is called in Python.

use myospring::settings::{Setting, ValueKind};

/// Ends of names for units.
const SUFFIXES: [(&str, &str); 14] = [
    ("ms", "_ms"),
    ("um", "_um"),
    ("um^2", "_um2"),
    ("kPa", "_kpa"),
    ("nN", "_nn"),
    // Micrometres have the short name.
    ("uM", "_micromolar"),
    ("nN/um", "_nn_per_um"),
    ("kPa/um", "_kpa_per_um"),
    ("deg", "_deg"),
    ("1/ms", "_per_ms"),
    ("um/ms", "_um_per_ms"),
    ("um^2/ms", "_um2_per_ms"),
    ("mV", "_mv"),
    ("mS/uF", "_ms_per_uf"),
];

/// The name of a setting in Python. One that has no option has no name of its own on the command line either, so
/// those of cell and stimulus say what they are of.
pub(crate) fn name(setting: &Setting) -> String {
    let (table, bare) = setting.key.split_once('.').unwrap_or(("", setting.key));
    let of_table = setting.option.is_none() && ["cell", "stimulus"].contains(&table);
    let stem = match setting.key {
        "cell.parameters" => bare.to_owned(),
        _ if of_table => format!("{table}_{bare}"),
        _ => bare.to_owned(),
    };
    let unit = match setting.kind {
        ValueKind::Quantity { .. } => setting.unit().unwrap_or_default(),
        _ => "",
    };
    let suffix = SUFFIXES.iter().find(|(known, _)| *known == unit).map_or("", |(_, suffix)| suffix);
    stem + suffix
}
