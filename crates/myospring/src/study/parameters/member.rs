//! A member of a study of parameters, and its result.

use super::super::{Member, Row, Status, sha256};
use crate::output::table::{Column, Table};
use serde::{Deserialize, Serialize};

/// A member: its number and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Variation {
    /// Its number, the first is 1.
    pub number: usize,
    /// Its number as a name.
    pub name: String,
    /// One value for each number that varies, in its unit.
    pub values: Vec<f64>,
}

impl Variation {
    /// The member of a number.
    pub fn new(number: usize, values: Vec<f64>) -> Self {
        Self { number, name: number.to_string(), values }
    }
}

impl Member for Variation {
    const KIND: &'static str = "member";
    type Row = VariationRow;

    fn name(&self) -> &str {
        &self.name
    }

    /// Of every value to the last bit.
    fn key(&self) -> Option<String> {
        let bytes: Vec<u8> = self.values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Some(sha256(&bytes))
    }
}

/// The result of a member; its values follow from its number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VariationRow {
    /// The member's number, from 1.
    pub member: usize,
    /// Its status.
    pub status: Status,
    /// Why it is not ok, or why some metrics are missing, such as without capture; else empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reason: String,
    /// The metrics that the study wants, in its order; `None` where the curve does not show one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub metrics: Vec<Option<f64>>,
    /// The hash of its curves in [`TRACES`](super::TRACES), by which damage is detected; empty
    /// without curves.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub curves: String,
}

impl VariationRow {
    /// The row of a finished member.
    pub(super) fn done(member: usize, metrics: Vec<Option<f64>>) -> Self {
        Self { member, status: Status::Ok, reason: String::new(), metrics, curves: String::new() }
    }

    /// Adds a reason, such as stimuli that raised no action potential.
    pub(super) fn noting(self, reason: Option<String>) -> Self {
        Self { reason: reason.unwrap_or(self.reason), ..self }
    }
}

impl Row for VariationRow {
    fn failed(member: &str, reason: String) -> Self {
        let member = member.parse().unwrap_or(0);
        Self { member, status: Status::Failed, reason, metrics: Vec::new(), curves: String::new() }
    }

    fn status(&self) -> Status {
        self.status
    }

    /// Only status and reason; [`Answer::table`](super::Answer::table) adds the numbers.
    fn table(rows: &[Self]) -> Table {
        let member = rows.iter().map(|row| Some(row.member as f64)).collect();
        let status = rows.iter().map(|row| Some(row.status.to_string())).collect();
        let reason = rows.iter().map(|row| Some(row.reason.clone())).collect();
        Table {
            columns: vec![
                Column::Number { name: "member".to_owned(), values: member },
                Column::Text { name: "status".to_owned(), values: status },
                Column::Text { name: "reason".to_owned(), values: reason },
            ],
        }
    }
}
