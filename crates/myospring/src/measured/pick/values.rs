//! Reads the numbers of curves, and decides between possible meanings of them.

use super::picked::Picked;
use crate::analysis::kind::Kind;
use crate::measured::column::Scale;
use crate::measured::curve::Curve;
use crate::measured::error::ReadError;
use crate::measured::number::{self, Cell};
use crate::measured::sheet::Row;
use crate::measured::times::Clock;

impl Picked<'_> {
    pub(super) fn check_times(
        &self,
        rows: &[&Row],
        times: &[Option<f64>],
        clock: Clock,
    ) -> Result<(), ReadError> {
        let mut before = f64::NEG_INFINITY;
        for (row, time) in rows.iter().zip(times) {
            let Some(time) = *time else { continue };
            if time <= before {
                let (line, column) = self.sheet.place(row, clock.column().unwrap_or(0));
                return Err(ReadError::Field {
                    path: self.path.to_owned(),
                    line,
                    column,
                    cause: format!(
                        "time {time} ms does not come after {before} ms; times must increase from row to row (several \
                         recordings one below the other need a file each)"
                    ),
                });
            }
            before = time;
        }
        Ok(())
    }

    /// Reads a curve from its fields and their times; it may begin later or end earlier than the
    /// table.
    pub(super) fn curve<'r>(
        &self,
        name: String,
        scale: Scale,
        fields: impl Iterator<Item = (&'r Row, usize, Option<f64>)>,
    ) -> Result<Curve, ReadError> {
        let (mut times_ms, mut values, mut lines) = (Vec::new(), Vec::new(), Vec::new());
        let mut gap = None;
        for (row, at, time) in fields {
            let field = |cause: String| {
                let (line, column) = self.sheet.place(row, at);
                ReadError::Field { path: self.path.to_owned(), line, column, cause }
            };
            let text = row.fields.get(at).map_or("", String::as_str);
            match (self.sheet.cell(row, at), time) {
                (Cell::Number(value), Some(time)) => {
                    if let Some(error) = gap.take() {
                        return Err(error);
                    }
                    if let Some(cause) = number::is_too_large(value) {
                        return Err(field(cause));
                    }
                    times_ms.push(time);
                    values.push(value * scale.factor);
                    lines.push(self.sheet.line(row, at));
                }
                (Cell::Number(value), None) => return Err(field(format!("{value} has no time"))),
                (Cell::Missing, _) if values.is_empty() || self.options.skip_gaps => {}
                (Cell::Missing, _) => {
                    gap.get_or_insert(field(format!(
                        "\"{text}\" is not a finite number; delete the row, or leave such frames out (--skip-gaps)"
                    )));
                }
                (Cell::Text, _) => {
                    return Err(field(format!(
                        "\"{text}\" is not a finite number; correct or delete the row (a decimal comma needs another \
                         delimiter than the comma)"
                    )));
                }
            }
        }
        if values.is_empty() {
            return Err(self.error(format!("column `{name}` has no number")));
        }
        if let Some(cause) = number::are_too_small(&values) {
            return Err(self.error(format!("column `{name}`: {cause}")));
        }
        Ok(Curve {
            name,
            kind: scale.kind,
            unit: scale.unit,
            times_ms,
            values,
            lines,
            stimuli_ms: Vec::new(),
        })
    }

    /// Decides between two possible meanings of the values, with a note; `says_unit` is whether the
    /// table or the user states their unit.
    pub(super) fn settle(&mut self, curve: &mut Curve, says_unit: bool) {
        let count = curve.values.len().max(1) as f64;
        let mean = curve.values.iter().sum::<f64>() / count;
        let most = curve.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let mut note = |text: String| {
            if self.shared.insert(text.clone()) {
                self.notes.push(text);
            }
        };
        match curve.kind {
            Kind::Shortening if !says_unit && most <= 1.0 => {
                curve.values.iter_mut().for_each(|value| *value *= 100.0);
                note("a shortening without a unit that is at most 1 is read as a fraction (--unit % if not)".to_owned());
            }
            Kind::NormalisedLength if mean.abs() < 0.5 => {
                curve.values.iter_mut().for_each(|value| *value += 1.0);
                note(
                    "a normalised length around 0 is read as the change from its mean, (L - mean) / mean".to_owned(),
                );
            }
            Kind::NormalisedLength if !says_unit && mean > 20.0 => {
                curve.values.iter_mut().for_each(|value| *value *= 0.01);
                note("a normalised length near 100 is read as % (state it by --unit %)".to_owned());
            }
            Kind::Length | Kind::SarcomereLength
                if curve.unit == "um" && !says_unit && self.options.pixel_size_um.is_none() =>
            {
                note(format!(
                    "{} without a unit: read as um (--unit px, with --pixel-size, if not)",
                    curve.kind
                ));
            }
            Kind::Unknown => note(format!(
                "column `{}` does not say what it is: read as a motion in arbitrary units, in either direction \
                 (--kind length, shortening, calcium-ratio, ... says it)",
                curve.name
            )),
            _ => {}
        }
    }

    /// Returns the mean of curves with the same times.
    pub(super) fn mean(&self, curves: &[Curve]) -> Result<Curve, ReadError> {
        let first = &curves[0];
        if let Some(other) = curves.iter().find(|curve| {
            (curve.kind, curve.unit) != (first.kind, first.unit) || curve.times_ms != first.times_ms
        }) {
            return Err(self.error(format!(
                "`{}` and `{}` have no mean: it needs curves of one kind and unit at the same times",
                first.name, other.name
            )));
        }
        let count = curves.len() as f64;
        let value = |at: usize| curves.iter().map(|curve| curve.values[at]).sum::<f64>() / count;
        Ok(Curve {
            name: format!("mean of {}", curves.len()),
            values: (0..first.values.len()).map(value).collect(),
            ..first.clone()
        })
    }
}
