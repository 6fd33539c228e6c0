//! Time series as comma-separated values, tidy, with the unit in each column's name.

use myospring_core::recording::{Recording, Sample, Signal};

/// Number of significant digits: more precise than any measurement, coarser than rounding errors.
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
    ("u", |s| s.u),
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
/// angular_momentum_nN_um_ms`. A column that no sample defines (`vm_mV` of a dimensionless cell
/// model, both potentials where calcium is given) is left out; where only some samples define it,
/// the others stay empty. Further signals of the cell model follow, such as `Ca_i_uM`. Numbers have
/// 9 significant digits.
///
/// # Errors
/// A recording without samples.
///
/// # Example
/// ```
/// # use myospring::recording::{Recording, Sample};
/// # let sample = Sample { t_ms: 0.5, u: Some(0.25), length_um: 140.0, ..Sample::STILL };
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

/// Why a table cannot be read as curves.
#[derive(Debug, thiserror::Error)]
pub enum TracesError {
    /// Not a table.
    #[error("the table cannot be read: {0}")]
    Table(#[from] ::csv::Error),
    /// A column that every run has is missing.
    #[error("the column `{name}` is missing; give a table of curves as written by `myospring run`")]
    Missing {
        /// Its name.
        name: &'static str,
    },
    /// Text where a number is expected.
    #[error("line {line}, column `{name}`: \"{found}\" is not a number")]
    Number {
        /// Line, counted from 1, the header being the first.
        line: usize,
        /// The column.
        name: String,
        /// The text found there.
        found: String,
    },
}

/// Reads the curves of a table that [`traces`] has written, to its 9 digits; columns other than
/// those of samples become signals.
///
/// # Errors
/// Text that is not such a table.
///
/// # Example
/// ```
/// use myospring::output::csv::read_traces;
/// let error = read_traces("t_ms,u\n0,0\n").unwrap_err().to_string();
/// assert!(error.contains("the column `ta_kPa` is missing"), "{error}");
/// ```
pub fn read_traces(text: &str) -> Result<Recording, TracesError> {
    let mut reader = ::csv::Reader::from_reader(text.as_bytes());
    let header: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let place = |name: &str| header.iter().position(|other| other == name);
    let mut places = [None; COLUMNS.len()];
    for (found, (name, _)) in places.iter_mut().zip(COLUMNS) {
        *found = place(name);
        if found.is_none() && !["u", "vm_mV"].contains(&name) {
            return Err(TracesError::Missing { name });
        }
    }
    let told = |name: &String| COLUMNS.iter().all(|(own, _)| own != name);
    let mut signals: Vec<(usize, Signal)> = header
        .iter()
        .enumerate()
        .filter(|(_, name)| told(name))
        .map(|(index, name)| {
            (index, Signal { name: name.clone(), unit: String::new(), values: Vec::new() })
        })
        .collect();
    let mut samples = Vec::new();
    for (row, record) in reader.records().enumerate() {
        let record = record?;
        let number = |index: usize| {
            let text = record.get(index).unwrap_or_default();
            let wrong = || TracesError::Number {
                line: row + 2,
                name: header.get(index).cloned().unwrap_or_default(),
                found: text.to_owned(),
            };
            if text.is_empty() { Ok(None) } else { text.parse().map(Some).map_err(|_| wrong()) }
        };
        let mut values = [None; COLUMNS.len()];
        for (value, place) in values.iter_mut().zip(places) {
            *value = place.map_or(Ok(None), number)?;
        }
        for (index, signal) in &mut signals {
            signal.values.push(number(*index)?.unwrap_or(f64::NAN));
        }
        let of = |column: usize| values[column].unwrap_or(f64::NAN);
        samples.push(Sample {
            t_ms: of(0),
            u: values[1],
            vm_mv: values[2],
            ta_kpa: of(3),
            length_um: of(4),
            width_um: of(5),
            area_um2: of(6),
            shortening_pct: of(7),
            elastic_energy_fj: of(8),
            kinetic_energy_fj: of(9),
            active_work_fj: of(10),
            dissipated_energy_fj: of(11),
            momentum_nn_ms: of(12),
            angular_momentum_nn_um_ms: of(13),
        });
    }
    let signals = signals.into_iter().map(|(_, signal)| signal).collect();
    Ok(Recording { samples, signals, ..Recording::default() })
}

/// `Ca_i` in `uM` gives `Ca_i_uM`; `A/F` becomes `A_per_F`.
fn named(signal: &Signal) -> String {
    match signal.unit.as_str() {
        "" => signal.name.clone(),
        unit => format!("{}_{}", signal.name, unit.replace('/', "_per_").replace(' ', "_")),
    }
}

/// The shortest text of the value, rounded to [`DIGITS`] significant digits.
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
                u: Some(x.sin()),
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
    fn curves_that_were_written_and_read_are_written_the_same_again() {
        let mut recording = recording();
        recording.samples[1].vm_mv = Some(-84.0);
        let values = (0..20).map(f64::from).collect();
        recording.signals = vec![Signal { name: "Ca_i".into(), unit: "uM".into(), values }];
        let table = traces(&recording).unwrap();
        assert_eq!(traces(&read_traces(&table).unwrap()).unwrap(), table);
        let broken = table.replacen("0.333333333", "much", 1);
        let error = read_traces(&broken).unwrap_err().to_string();
        assert!(error.contains("much\" is not a number"), "{error}");
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
    fn a_cell_without_a_potential_has_no_column_for_it() {
        let mut recording = recording();
        for sample in &mut recording.samples {
            sample.u = None;
        }
        let table = traces(&recording).unwrap();
        assert!(table.starts_with("t_ms,ta_kPa,length_um,"), "{table}");
        assert_eq!(traces(&read_traces(&table).unwrap()).unwrap(), table);
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
