//! A table of many runs, one row each: CSV for people, Parquet for programs.

use std::borrow::Borrow;
use std::io::Write;
#[cfg(feature = "parquet")]
use std::sync::Arc;

#[cfg(feature = "parquet")]
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
#[cfg(feature = "parquet")]
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
#[cfg(feature = "parquet")]
use parquet::errors::ParquetError;
#[cfg(feature = "parquet")]
use parquet::file::properties::WriterProperties;
#[cfg(feature = "parquet")]
use parquet::file::writer::SerializedFileWriter;
#[cfg(feature = "parquet")]
use parquet::schema::types::Type;

use super::csv::CsvError;
use super::digits;

/// One column: its name, including the unit, and an optional value for each row.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// Words.
    Text {
        /// Name.
        name: String,
        /// One for each row.
        values: Vec<Option<String>>,
    },
    /// Numbers.
    Number {
        /// Name.
        name: String,
        /// One for each row; a value that is not finite counts as missing.
        values: Vec<Option<f64>>,
    },
}

/// The name of a column: `peak_tension` in `kPa` gives `peak_tension_kPa`; `L0/s` becomes `L0_per_s`.
///
/// # Example
/// ```
/// use myospring_output::table::column_name;
/// assert_eq!(column_name("maximum_shortening_rate", "L0/s"), "maximum_shortening_rate_L0_per_s");
/// ```
pub fn column_name(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => {
            let unit = unit.replace('%', "pct").replace('/', "_per_");
            format!("{name}_{}", unit.replace('^', "").replace(' ', "_"))
        }
    }
}

/// Columns of equal length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns, from left to right.
    pub columns: Vec<Column>,
}

impl Column {
    /// Its name, with the unit.
    pub fn name(&self) -> &str {
        let (Self::Text { name, .. } | Self::Number { name, .. }) = self;
        name
    }

    fn len(&self) -> usize {
        match self {
            Self::Text { values, .. } => values.len(),
            Self::Number { values, .. } => values.len(),
        }
    }

    /// The field of a CSV row; empty for a missing value.
    fn field(&self, row: usize) -> String {
        match self {
            Self::Text { values, .. } => {
                values.get(row).and_then(Option::as_deref).map(no_formula).unwrap_or_default()
            }
            Self::Number { values, .. } => {
                let value = values.get(row).copied().flatten().filter(|value| value.is_finite());
                value.map(digits::written).unwrap_or_default()
            }
        }
    }
}

/// Protects a text from being read as a formula by a spreadsheet: an apostrophe is put before one
/// that begins like a formula.
fn no_formula(text: &str) -> String {
    let apostrophe = if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { "'" } else { "" };
    format!("{apostrophe}{text}")
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(Column::len).max().unwrap_or(0)
    }

    /// The table with numbers rounded to [`digits::DIGITS`] significant digits.
    #[must_use]
    pub fn for_people(mut self) -> Self {
        for column in &mut self.columns {
            if let Column::Number { values, .. } = column {
                values.iter_mut().flatten().for_each(|value| *value = digits::rounded(*value));
            }
        }
        self
    }

    /// The table as CSV: a line of names, then a line for each row. An apostrophe is put before
    /// text that begins with `=`, `+`, `-` or `@`, so that a spreadsheet does not read it as a
    /// formula.
    ///
    /// # Errors
    /// A table cannot cause one; the CSV writer's signature has it.
    ///
    /// # Example
    /// ```
    /// use myospring::output::table::{Column, Table};
    /// let cell = Column::Text { name: "cell".into(), values: vec![Some("1".into()), None] };
    /// let area = Column::Number { name: "area_um2".into(), values: vec![None, Some(2.5)] };
    /// let table = Table { columns: vec![cell, area] };
    /// assert_eq!(String::from_utf8(table.to_csv()?).unwrap(), "cell,area_um2\n1,\n,2.5\n");
    ///
    /// let cell = Column::Text { name: "cell".into(), values: vec![Some("=1+1.tif".into())] };
    /// let table = Table { columns: vec![cell] };
    /// assert_eq!(String::from_utf8(table.to_csv()?).unwrap(), "cell\n'=1+1.tif\n");
    /// # Ok::<(), myospring::output::csv::CsvError>(())
    /// ```
    pub fn to_csv(&self) -> Result<Vec<u8>, CsvError> {
        let mut bytes = Vec::new();
        write_csv(&mut bytes, [self])?;
        Ok(bytes)
    }

    /// The table as Apache Parquet: text as UTF-8 strings, numbers as doubles, missing values as
    /// null.
    ///
    /// # Errors
    /// Columns of different lengths.
    #[cfg(feature = "parquet")]
    pub fn to_parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let mut bytes = Vec::new();
        write_parquet(&mut bytes, [self])?;
        Ok(bytes)
    }

    /// The columns with their types, as a Parquet schema.
    #[cfg(feature = "parquet")]
    fn schema(&self) -> Result<Type, ParquetError> {
        let fields = self.columns.iter().map(|column| {
            let field = match column {
                Column::Text { name, .. } => {
                    Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
                        .with_logical_type(Some(LogicalType::String))
                }
                Column::Number { name, .. } => Type::primitive_type_builder(name, Physical::DOUBLE),
            };
            field.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
        });
        let fields = fields.collect::<Result<Vec<_>, _>>()?;
        Type::group_type_builder("cells").with_fields(fields).build()
    }
}

/// Writes consecutive pieces of one table as CSV; only one piece at a time is in memory.
///
/// # Errors
/// Errors of the sink, with the row.
pub fn write_csv<T: Borrow<Table>>(
    sink: impl Write,
    pieces: impl IntoIterator<Item = T>,
) -> Result<(), CsvError> {
    let failed = |row, source| CsvError::Row { row, source };
    let mut writer = ::csv::Writer::from_writer(sink);
    let mut before = 0;
    for (index, piece) in pieces.into_iter().enumerate() {
        let piece = piece.borrow();
        if index == 0 {
            let names = piece.columns.iter().map(|column| no_formula(column.name()));
            writer.write_record(names).map_err(|error| failed(0, error))?;
        }
        for row in 0..piece.rows() {
            writer
                .write_record(piece.columns.iter().map(|column| column.field(row)))
                .map_err(|error| failed(before + row, error))?;
        }
        before += piece.rows();
    }
    writer.flush().map_err(|error| failed(before, error.into()))
}

/// Writes consecutive pieces of one table as Apache Parquet, each as a row group; only one piece at
/// a time is in memory.
///
/// # Errors
/// No piece, or columns of different lengths.
#[cfg(feature = "parquet")]
pub fn write_parquet<T: Borrow<Table>>(
    sink: impl Write + Send,
    pieces: impl IntoIterator<Item = T>,
) -> Result<(), ParquetError> {
    let mut pieces = pieces.into_iter();
    let Some(first) = pieces.next() else {
        return Err(ParquetError::General("a table has at least one piece".to_owned()));
    };
    let schema = Arc::new(first.borrow().schema()?);
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut file = SerializedFileWriter::new(sink, schema, Arc::new(properties))?;
    for piece in std::iter::once(first).chain(pieces) {
        let mut group = file.next_row_group()?;
        for column in &piece.borrow().columns {
            let Some(mut writer) = group.next_column()? else { break };
            match column {
                Column::Text { values, .. } => {
                    let there: Vec<ByteArray> =
                        values.iter().flatten().map(|text| text.as_str().into()).collect();
                    let levels: Vec<i16> =
                        values.iter().map(|value| i16::from(value.is_some())).collect();
                    writer.typed::<ByteArrayType>().write_batch(&there, Some(&levels), None)?;
                }
                Column::Number { values, .. } => {
                    let finite = |value: &Option<f64>| value.filter(|value| value.is_finite());
                    let there: Vec<f64> = values.iter().filter_map(finite).collect();
                    let levels: Vec<i16> =
                        values.iter().map(|value| i16::from(finite(value).is_some())).collect();
                    writer.typed::<DoubleType>().write_batch(&there, Some(&levels), None)?;
                }
            }
            writer.close()?;
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}
