//! Time series as comma-separated values, tidy, with the unit in each column's name.

use myospring_core::recording::{Recording, Sample, Signal};

/// Significant digits written: below what a measurement can tell, above rounding noise.
const DIGITS: usize = 9;

/// Why a table was not rendered.
#[derive(Debug, thiserror::Error)]
pub enum CsvError {
    /// The recording holds no samples.
    #[error("the recording has 0 samples, at least 1 is needed for a table; record while running")]
    NoSamples,
    /// The CSV writer refused a row.
    #[error("row {row} of the table could not be written: {source}")]
    Row {
        /// Row, counted from 0 without the header.
        row: usize,
        /// What the writer says.
        source: ::csv::Error,
    },
}

type Column = (&'static str, fn(&Sample) -> Option<f64>);

/// Columns of `traces.csv` in their order.
const COLUMNS: [Column; 14] = [
    ("t_ms", |s| Some(s.t_ms)),
    ("u", |s| Some(s.u)),
    ("vm_mV", |s| s.vm_mv),
    ("ta_kPa", |s| Some(s.ta_kpa)),
    ("length_um", |s| Some(s.length_um)),
    ("width_um", |s| Some(s.width_um)),
    ("area_um2", |s| Some(s.area_um2)),
    ("shortening_pct", |s| Some(s.shortening_pct)),
    ("elastic_energy_fJ", |s| Some(s.elastic_energy_fj)),
    ("kinetic_energy_fJ", |s| Some(s.kinetic_energy_fj)),
    ("active_work_fJ", |s| Some(s.active_work_fj)),
    ("dissipated_energy_fJ", |s| Some(s.dissipated_energy_fj)),
    ("momentum_nN_ms", |s| Some(s.momentum_nn_ms)),
    ("angular_momentum_nN_um_ms", |s| Some(s.angular_momentum_nn_um_ms)),
];

/// The time series as the text of `traces.csv`.
///
/// Columns: `t_ms, u, vm_mV, ta_kPa, length_um, width_um, area_um2, shortening_pct,
/// elastic_energy_fJ, kinetic_energy_fJ, active_work_fJ, dissipated_energy_fJ, momentum_nN_ms,
/// angular_momentum_nN_um_ms`. A column that no
/// sample defines (`vm_mV` of a dimensionless cell model) is left out; where only some samples
/// define it, the others stay empty. What the cell model tells besides follows, such as `Ca_i_uM`.
/// Numbers have 9 significant digits.
///
/// # Errors
/// A recording without samples.
///
/// # Example
/// ```
/// # use myospring::recording::{Recording, Sample};
/// # let sample = Sample {
/// #     t_ms: 0.5, u: 0.25, vm_mv: None, ta_kpa: 0.0, length_um: 140.0, width_um: 21.0,
/// #     area_um2: 2940.0, shortening_pct: 0.0, elastic_energy_fj: 0.0, kinetic_energy_fj: 0.0,
/// #     active_work_fj: 0.0, dissipated_energy_fj: 0.0, momentum_nn_ms: 0.0,
/// #     angular_momentum_nn_um_ms: 0.0,
/// # };
/// let recording = Recording { samples: vec![sample], ..Recording::default() };
/// let table = myospring::output::csv::traces(&recording)?;
/// assert!(table.starts_with("t_ms,u,ta_kPa,length_um"));
/// # Ok::<(), myospring::output::csv::CsvError>(())
/// ```
pub fn traces(recording: &Recording) -> Result<String, CsvError> {
    if recording.samples.is_empty() {
        return Err(CsvError::NoSamples);
    }
    let columns: Vec<&Column> = COLUMNS
        .iter()
        .filter(|(_, value)| recording.samples.iter().any(|sample| value(sample).is_some()))
        .collect();
    let signals = &recording.signals;
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let names = columns.iter().map(|column| column.0.to_owned()).chain(signals.iter().map(named));
    writer.write_record(names).map_err(|source| CsvError::Row { row: 0, source })?;
    for (row, sample) in recording.samples.iter().enumerate() {
        let own = columns.iter().map(|(_, value)| value(sample));
        let told = signals.iter().map(|signal| signal.values.get(row).copied());
        writer
            .write_record(own.chain(told).map(|value| value.map_or_else(String::new, number)))
            .map_err(|source| CsvError::Row { row, source })?;
    }
    let rows = writer.into_inner().map_err(|error| CsvError::Row {
        row: recording.samples.len(),
        source: error.into_error().into(),
    })?;
    Ok(String::from_utf8_lossy(&rows).into_owned())
}

/// `Ca_i` in `uM` gives `Ca_i_uM`; `A/F` becomes `A_per_F`.
fn named(signal: &Signal) -> String {
    match signal.unit.as_str() {
        "" => signal.name.clone(),
        unit => format!("{}_{}", signal.name, unit.replace('/', "_per_").replace(' ', "_")),
    }
}

/// The shortest text that reads back to the value rounded to [`DIGITS`] significant digits.
pub(crate) fn number(value: f64) -> String {
    let rounded = format!("{value:.*e}", DIGITS - 1).parse::<f64>().unwrap_or(value);
    if rounded == 0.0 {
        "0".to_owned()
    } else if !(1e-5..1e15).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        rounded.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Recording {
        let sample = |i: u32| {
            let x = f64::from(i) / 3.0;
            Sample {
                t_ms: x * 0.05,
                u: x.sin(),
                vm_mv: None,
                ta_kpa: x.exp(),
                length_um: 140.0 - x,
                width_um: 21.0 + x / 7.0,
                area_um2: 2940.0 * x,
                shortening_pct: -x * 1e-9,
                elastic_energy_fj: 1e18 * x,
                kinetic_energy_fj: f64::MIN_POSITIVE * x,
                active_work_fj: -x,
                dissipated_energy_fj: x.sqrt(),
                momentum_nn_ms: 1e-16 * x,
                angular_momentum_nn_um_ms: -1e-16 * x,
            }
        };
        Recording { samples: (0..20).map(sample).collect(), ..Recording::default() }
    }

    #[test]
    fn a_written_table_reads_back_to_the_same_numbers() {
        let recording = recording();
        let table = traces(&recording).unwrap();
        let mut reader = ::csv::Reader::from_reader(table.as_bytes());
        let header: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let written: Vec<&Column> =
            COLUMNS.iter().filter(|column| header.iter().any(|name| name == column.0)).collect();
        assert_eq!(header.len(), written.len());
        let mut rows = 0;
        for (record, sample) in reader.records().zip(&recording.samples) {
            for (field, (name, value)) in record.unwrap().iter().zip(&written) {
                let (read, value) = (field.parse::<f64>().unwrap(), value(sample).unwrap());
                // Half a unit of the ninth digit.
                assert!((read - value).abs() <= 5e-9 * value.abs(), "{name}: {read} {value}");
            }
            rows += 1;
        }
        assert_eq!(rows, recording.samples.len());
    }

    #[test]
    fn a_potential_in_mv_has_a_column_only_where_it_is_defined() {
        let mut recording = recording();
        assert!(!traces(&recording).unwrap().contains("vm_mV"));
        recording.samples[1].vm_mv = Some(-84.0);
        let table = traces(&recording).unwrap();
        assert!(table.starts_with("t_ms,u,vm_mV,ta_kPa,"));
        let rows: Vec<&str> = table.lines().collect();
        assert_eq!(rows[1].split(',').nth(2), Some(""));
        assert_eq!(rows[2].split(',').nth(2), Some("-84"));
    }

    #[test]
    fn numbers_carry_nine_digits_and_no_noise() {
        for (value, text) in [
            (0.1 + 0.2, "0.3"),
            (-0.0, "0"),
            (1.0 / 3.0, "0.333333333"),
            (123_456.789_012_3, "123456.789"),
            (1.234e-12, "1.234e-12"),
            (-2.5e20, "-2.5e20"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn an_empty_recording_is_an_error() {
        assert!(matches!(traces(&Recording::default()), Err(CsvError::NoSamples)));
    }
}
