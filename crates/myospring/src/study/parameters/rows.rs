//! The results of many members in columns: 9 bytes for each and 8 for each metric, and up to twice that while there are more to come.

use super::super::Status;
use super::member::VariationRow;
use std::collections::BTreeMap;

/// The results of members, without the hashes of their curves.
///
/// # Example
/// ```
/// use myospring::study::Status;
/// use myospring::study::parameters::{Rows, VariationRow};
///
/// let row = VariationRow {
///     member: 7,
///     status: Status::Ok,
///     reason: String::new(),
///     metrics: vec![Some(9.5), None],
///     curves: String::new(),
/// };
/// let rows: Rows = [row].into_iter().collect();
/// let row = rows.get(0).unwrap();
/// assert_eq!((row.member, row.metric(0), row.metric(1)), (7, Some(9.5), None));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Rows {
    members: Vec<usize>,
    statuses: Vec<Status>,
    /// Reasons that are not empty, by the places of their rows.
    reasons: BTreeMap<usize, String>,
    /// Number of metrics of each row.
    width: usize,
    /// The metrics, row by row; NaN where there is none.
    metrics: Vec<f64>,
}

/// A row of [`Rows`].
#[derive(Debug, Clone, Copy)]
pub struct MemberRow<'a> {
    /// The member's number, from 1.
    pub member: usize,
    /// Its status.
    pub status: Status,
    /// Why it is not ok, or why some metrics are missing; else empty.
    pub reason: &'a str,
    metrics: &'a [f64],
}

impl MemberRow<'_> {
    /// A metric, by its place among those that the study wants; `None` where the curve does not
    /// show it.
    pub fn metric(&self, at: usize) -> Option<f64> {
        self.metrics.get(at).copied().filter(|value| !value.is_nan())
    }
}

impl Rows {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// The row at a place.
    pub fn get(&self, at: usize) -> Option<MemberRow<'_>> {
        Some(MemberRow {
            member: *self.members.get(at)?,
            status: self.statuses[at],
            reason: self.reasons.get(&at).map_or("", String::as_str),
            metrics: &self.metrics[at * self.width..(at + 1) * self.width],
        })
    }

    /// All rows, in their order.
    pub fn iter(&self) -> impl Iterator<Item = MemberRow<'_>> + Clone {
        (0..self.len()).filter_map(|at| self.get(at))
    }

    /// In the order of the members, the first row of each.
    pub(super) fn sorted(self) -> Self {
        if self.members.is_sorted_by(|one, next| one < next) {
            return self;
        }
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_by_key(|at| self.members[*at]);
        order.dedup_by_key(|at| self.members[*at]);
        let mut sorted = Self { width: self.width, ..Self::default() };
        for row in order.into_iter().filter_map(|at| self.get(at)) {
            sorted.push(row.member, row.status, row.reason);
            sorted.metrics.extend_from_slice(row.metrics);
        }
        sorted
    }

    /// Adds a row without its metrics, which the caller adds.
    fn push(&mut self, member: usize, status: Status, reason: &str) {
        if !reason.is_empty() {
            self.reasons.insert(self.len(), reason.to_owned());
        }
        self.members.push(member);
        self.statuses.push(status);
    }

    /// Gives each row `width` metrics; the added ones are missing.
    fn widen(&mut self, width: usize) {
        let mut metrics = Vec::with_capacity(width * self.len());
        for at in 0..self.len() {
            metrics.extend_from_slice(&self.metrics[at * self.width..(at + 1) * self.width]);
            metrics.resize((at + 1) * width, f64::NAN);
        }
        (self.width, self.metrics) = (width, metrics);
    }
}

impl Extend<VariationRow> for Rows {
    fn extend<I: IntoIterator<Item = VariationRow>>(&mut self, rows: I) {
        for VariationRow { member, status, reason, metrics, .. } in rows {
            if metrics.len() > self.width {
                self.widen(metrics.len());
            }
            self.push(member, status, &reason);
            self.metrics.extend(metrics.into_iter().map(|value| value.unwrap_or(f64::NAN)));
            self.metrics.resize(self.len() * self.width, f64::NAN);
        }
    }
}

impl FromIterator<VariationRow> for Rows {
    fn from_iter<I: IntoIterator<Item = VariationRow>>(rows: I) -> Self {
        let mut all = Self::default();
        all.extend(rows);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Row as _;
    use super::*;

    #[test]
    fn rows_in_columns_are_those_that_were_added_in_the_order_of_their_members() {
        let done = |member, metrics: &[Option<f64>]| VariationRow::done(member, metrics.to_vec());
        let given = [
            VariationRow::failed("5", "blown up".to_owned()),
            done(2, &[Some(1.5), None]),
            done(4, &[Some(2.5), Some(-0.0)]).noting(Some("no capture".to_owned())),
            done(2, &[Some(9.0), Some(9.0)]),
            done(1, &[None, Some(f64::INFINITY)]),
        ];
        let rows: Rows = given.iter().cloned().collect();
        let seen = |rows: &Rows| {
            let seen = rows.iter().map(|row| VariationRow {
                reason: row.reason.to_owned(),
                status: row.status,
                ..VariationRow::done(row.member, [0, 1].map(|at| row.metric(at)).to_vec())
            });
            seen.collect::<Vec<_>>()
        };
        let mut expected = given.to_vec();
        expected[0].metrics = vec![None; 2];
        assert_eq!(seen(&rows), expected);
        assert!(rows.get(5).is_none() && rows.get(4).unwrap().metric(2).is_none());
        let order = [4, 1, 2, 0].map(|at| expected[at].clone());
        assert_eq!(seen(&rows.sorted()), order);
        assert!(Rows::default().is_empty() && Rows::default().sorted().is_empty());
    }
}
