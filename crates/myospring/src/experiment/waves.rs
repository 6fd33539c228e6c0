//! How a wave spread over a tissue, simulated or measured: a table and a figure.

use super::ExperimentError;
use crate::analysis::wave::WaveMap;
use crate::output::figure::{self, DrawnCell, Figure, FigureError, Map};
use crate::output::table::{Column, Table};
use crate::recording::Wave;

/// The name of the table.
pub(super) const FILE: &str = "activation.csv";

/// The table: a row for each place.
pub(super) fn table(wave: &Wave, map: &WaveMap) -> Result<Vec<u8>, ExperimentError> {
    let [x, y] = wave.points.each_ref().map(|all| all.iter().copied().map(Some).collect());
    let columns = [
        ("x_um", x),
        ("y_um", y),
        ("activation_ms", map.activation_ms.clone()),
        ("action_potential_duration_90_ms", map.duration_ms.clone()),
    ];
    let column =
        |(name, values): (&str, Vec<Option<f64>>)| Column::Number { name: name.to_owned(), values };
    Ok(Table { columns: columns.map(column).into() }.for_people().to_csv()?)
}

/// The figure: when each place was activated, counted from what `since` says, and for how long.
pub(super) fn draw(
    cell: &DrawnCell<'_>,
    wave: &Wave,
    map: &WaveMap,
    since: &str,
) -> Result<Figure, FigureError> {
    let tips: Vec<[f64; 2]> = wave.tips.iter().map(|tip| [tip.x_um, tip.y_um]).collect();
    let one = |name: &str, values: &[Option<f64>], quantity: &str, missing, has_tips: bool| {
        let known = || values.iter().flatten().copied();
        let low = known().fold(f64::INFINITY, f64::min);
        let high = known().fold(low, f64::max);
        let without = |value: &Option<f64>| if value.is_none() { 1.0 } else { 0.0 };
        Map {
            name: name.to_owned(),
            positions: &wave.points,
            values: values.iter().map(|value| value.unwrap_or(low)).collect(),
            quantity: quantity.to_owned(),
            limits: low.is_finite().then_some([low, high]),
            doubts: values
                .iter()
                .any(Option::is_none)
                .then(|| values.iter().map(without).collect()),
            hatched: missing,
            dots: (has_tips && !tips.is_empty()).then(|| (tips.clone(), "tips of waves")),
        }
    };
    let maps = [
        one("Activation", &map.activation_ms, since, "not activated", true),
        one(
            "Action potential duration",
            &map.duration_ms,
            "To 90 % repolarisation (ms)",
            "not repolarised",
            false,
        ),
    ];
    figure::maps(cell, &maps, None)
}
