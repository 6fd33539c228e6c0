//! A table of pictures: the own settings of each, and its group.

use super::Picture;
use crate::measured::decoded;
use crate::parameter::nearest;
use crate::settings::{Setting, Value, ValueKind, table};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Columns that name the picture, and that of a stack of slices.
const FILE: [&str; 2] = ["file", "picture"];
const STACK: &str = "stack";
/// Column that is copied to the results.
const GROUP: &str = "group";
/// Keys that are not columns: the title, and keys that would name the shape a second time.
const NO_COLUMNS: [&str; 5] =
    ["title", "shape.built_in", "shape.picture", "shape.outline", "shape.stack"];
/// How many missing files are named.
const FEW: usize = 10;

/// Errors of a table of pictures.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableError {
    /// It is not a text table.
    #[error("`{table}`: {cause}; save it as CSV, with the names of the columns in the first line")]
    Unreadable {
        /// The table.
        table: String,
        /// What is wrong, with the line.
        cause: String,
    },
    /// A column that is not a setting.
    #[error(
        "`{table}`, line 1, column {column}: there is no setting `{name}`{}; columns are file, group, and any option \
         or key of a run file, like pixel_size, modality, channel, threshold, seed, outline, stain",
        guess(suggestion.as_ref())
    )]
    UnknownColumn {
        /// The table.
        table: String,
        /// Which column, from 1.
        column: usize,
        /// Its name.
        name: String,
        /// The name that may be meant.
        suggestion: Option<String>,
    },
    /// Two columns of one meaning.
    #[error(
        "`{table}`, line 1: the columns {first} and {second} both mean `{name}`; leave one out"
    )]
    SameColumn {
        /// The table.
        table: String,
        /// The first, from 1.
        first: usize,
        /// The second.
        second: usize,
        /// Their meaning.
        name: String,
    },
    /// No column of files.
    #[error("`{table}`, line 1: no column is named `file` or `stack`; its columns are {columns}")]
    NoFiles {
        /// The table.
        table: String,
        /// Those that it has.
        columns: String,
    },
    /// More values than columns.
    #[error(
        "`{table}`, line {line} has {found} values, but the first line names {columns} columns; a value with a comma \
         needs quotes, like \"120,85\""
    )]
    TooMany {
        /// The table.
        table: String,
        /// The line.
        line: u64,
        /// How many values it has.
        found: usize,
        /// How many columns there are.
        columns: usize,
    },
    /// Lines without a file, or files that are not there.
    #[error("`{table}`: {}", missing(places))]
    Missing {
        /// The table.
        table: String,
        /// Each place with what is missing there.
        places: Vec<String>,
    },
    /// A line that repeats another.
    #[error(
        "`{table}`, line {line} repeats line {first}: the cell would count twice; leave one out, or give them \
         seeds"
    )]
    Twice {
        /// The table.
        table: String,
        /// The line.
        line: u64,
        /// The one before.
        first: u64,
    },
    /// Nothing below the header.
    #[error("`{table}` lists no picture; give each a row below the names of the columns")]
    Empty {
        /// The table.
        table: String,
    },
}

fn guess(suggestion: Option<&String>) -> String {
    suggestion.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

fn missing(places: &[String]) -> String {
    let more = places.len().saturating_sub(FEW);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    format!("{}{more}", places[..places.len().min(FEW)].join("; "))
}

/// A setting that a line of a table gives.
#[derive(Debug, Clone, PartialEq)]
pub struct TableSetting {
    /// Key of the setting.
    pub key: &'static str,
    /// Its value.
    pub value: Value,
    /// Line of the table, the header is 1.
    pub line: u64,
    /// Name of the column, as written.
    pub column: String,
}

/// The meaning of a column.
#[derive(Clone, Copy)]
enum Column {
    File { is_stack: bool },
    Group,
    Setting(&'static Setting),
}

impl Column {
    fn name(self) -> &'static str {
        match self {
            Self::File { .. } => FILE[0],
            Self::Group => GROUP,
            Self::Setting(setting) => setting.key,
        }
    }

    /// The column of a name: that of an option or key, with or without the unit behind it.
    fn of(name: &str) -> Option<Self> {
        let name = plain(name);
        if FILE.contains(&name.as_str()) || name == STACK {
            return Some(Self::File { is_stack: name == STACK });
        }
        if name == GROUP {
            return Some(Self::Group);
        }
        let setting = settings().find(|setting| {
            let short = setting.name();
            let with_unit = || format!("{short}_{}", unit(setting).replace('^', ""));
            let alias = || setting.option.as_ref().and_then(|option| option.alias).map(plain);
            let by_option = setting.option.is_some() && (name == short || name == with_unit());
            by_option || name == setting.key || alias() == Some(name.clone())
        });
        setting.map(Self::Setting)
    }
}

/// `--pixel-size` and `Pixel size` give `pixel_size`.
fn plain(name: &str) -> String {
    name.trim().trim_start_matches("--").to_lowercase().replace(['-', ' '], "_")
}

fn unit(setting: &Setting) -> &'static str {
    setting.unit().unwrap_or_default()
}

/// Settings that may be columns.
fn settings() -> impl Iterator<Item = &'static Setting> {
    table().filter(|setting| {
        !NO_COLUMNS.contains(&setting.key) && !matches!(setting.kind, ValueKind::Named { .. })
    })
}

/// Reads a table of pictures: `bytes` are those of the file `name`, and files are looked for in `folder`.
///
/// The first line names the columns: `file`, or `stack` for stacks of slices; `group`, which is copied to the results; and any
/// option or key of a setting. Values are written as options take them, numbers also without their
/// unit, which is then um, ms, kPa and so on; an empty one leaves the common setting unchanged.
/// Commas, semicolons or tabs separate the columns. Several lines may name one file, for several of
/// its cells.
///
/// # Errors
/// A table that cannot be read, unknown columns, files that are not there, a line that repeats
/// another.
///
/// # Example
/// ```
/// use myospring::study::pictures::read_table;
/// let folder = tempfile::tempdir()?;
/// std::fs::write(folder.path().join("dish.tif"), "")?;
/// let table = "file,pixel_size,seed,group\ndish.tif,0.27,\"120,85\",drug\ndish.tif,0.27 um,\"40,60\",drug\n";
/// let pictures = read_table(table.as_bytes(), "pictures.csv", folder.path())?;
/// assert_eq!(pictures[1].name, "dish.tif-2");
/// assert_eq!(pictures[1].group.as_deref(), Some("drug"));
/// assert_eq!(pictures[0].given[0].value, "0.27 um".into());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_table(bytes: &[u8], name: &str, folder: &Path) -> Result<Vec<Picture>, TableError> {
    let table = name.to_owned();
    let unreadable = |cause: String| TableError::Unreadable { table: table.clone(), cause };
    let text = &*decoded(bytes).map_err(|what| unreadable(format!("this is {what}")))?;
    let separator = separator(text);
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let names = reader.headers().map_err(|error| unreadable(error.to_string()))?.clone();
    let columns = columns(&names, name)?;
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| unreadable(error.to_string()))?;
        let line = line_of(text, record.position());
        if record.iter().all(str::is_empty) {
            continue;
        }
        if record.iter().skip(columns.len()).any(|value| !value.is_empty()) {
            let (found, columns) = (record.len(), columns.len());
            return Err(TableError::TooMany { table, line, found, columns });
        }
        let values = columns.iter().zip(&names).zip(record.iter());
        lines.push(values.fold(Line::new(line), |mut entry, ((column, name), value)| {
            if !value.is_empty() {
                entry.take(*column, name, value, separator == b';', folder);
            }
            entry
        }));
    }
    checked(lines, table, folder)
}

/// The line of a record, from 1; a position is that before skipped empty lines and comments.
fn line_of(text: &str, position: Option<&csv::Position>) -> u64 {
    let byte = position.map_or(0, |position| position.byte() as usize).min(text.len());
    let (before, rest) = text.split_at(byte);
    let passed = rest.lines().take_while(|line| line.is_empty() || line.starts_with('#'));
    (before.matches('\n').count() + passed.count() + 1) as u64
}

/// The separator of columns: the most frequent one in the first line.
fn separator(text: &str) -> u8 {
    let lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let first = lines.take(1).collect::<String>();
    let count = |byte: &u8| first.bytes().filter(|other| other == byte).count();
    // Of equals the last counts.
    [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',')
}

fn columns(names: &csv::StringRecord, table: &str) -> Result<Vec<Option<Column>>, TableError> {
    let mut columns: Vec<Option<Column>> = Vec::new();
    for (at, name) in names.iter().enumerate() {
        let column = Column::of(name);
        // Spreadsheets add columns without a name.
        if column.is_none() && !name.is_empty() {
            let known = settings().filter(|setting| setting.option.is_some()).map(Setting::name);
            let suggestion = nearest(&plain(name), known.chain([FILE[0], GROUP]));
            let suggestion = suggestion.map(str::to_owned);
            let (table, name) = (table.to_owned(), name.to_owned());
            return Err(TableError::UnknownColumn { table, column: at + 1, name, suggestion });
        }
        let stands_for = |column: &Option<Column>| column.map(Column::name);
        let first = columns.iter().position(|other| stands_for(other) == stands_for(&column));
        if let (Some(column), Some(first)) = (column, first) {
            let (table, name) = (table.to_owned(), column.name().to_owned());
            return Err(TableError::SameColumn { table, first: first + 1, second: at + 1, name });
        }
        columns.push(column);
    }
    if !columns.iter().any(|column| matches!(column, Some(Column::File { .. }))) {
        let columns: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        let (table, columns) = (table.to_owned(), columns.join(", "));
        return Err(TableError::NoFiles { table, columns });
    }
    Ok(columns)
}

/// A line of the table.
#[derive(Default)]
struct Line {
    number: u64,
    file: Option<String>,
    is_stack: bool,
    group: Option<String>,
    given: Vec<TableSetting>,
    /// Other files, each with its column.
    files: Vec<(PathBuf, String)>,
}

impl Line {
    fn new(number: u64) -> Self {
        Self { number, ..Self::default() }
    }

    fn take(
        &mut self,
        column: Option<Column>,
        name: &str,
        value: &str,
        decimal_commas: bool,
        folder: &Path,
    ) {
        match column {
            None => {}
            Some(Column::File { is_stack }) => {
                (self.file, self.is_stack) = (Some(value.to_owned()), is_stack);
            }
            Some(Column::Group) => self.group = Some(value.to_owned()),
            Some(Column::Setting(setting)) => {
                let mut value = read(setting, value, decimal_commas);
                if let Value::Text(path) = &mut value
                    && setting.names_file(path)
                {
                    let place = folder.join(&*path);
                    *path = place.to_string_lossy().into_owned();
                    self.files.push((place, name.to_owned()));
                }
                let (line, column) = (self.number, name.to_owned());
                self.given.push(TableSetting { key: setting.key, value, line, column });
            }
        }
    }

    /// All of its content, to compare it with other lines.
    fn content(&self) -> String {
        let given: Vec<String> =
            self.given.iter().map(|given| format!("{} = {}", given.key, given.value)).collect();
        format!("{:?}\n{}", self.file, given.join("\n"))
    }
}

/// A value as an option takes it; a bare number has the internal unit.
fn read(setting: &Setting, text: &str, decimal_commas: bool) -> Value {
    match setting.kind {
        ValueKind::Flag { .. } => match text.to_lowercase().as_str() {
            "true" | "yes" | "1" => Value::Flag(true),
            "false" | "no" | "0" => Value::Flag(false),
            _ => Value::from(text),
        },
        // Spreadsheets write 2.0 where 2 was meant.
        ValueKind::Whole { .. } => match text.parse::<f64>() {
            Ok(number) if number.fract() == 0.0 => Value::Whole(number as i64),
            _ => Value::from(text),
        },
        ValueKind::Quantity { .. } => {
            let text = if decimal_commas { text.replacen(',', ".", 1) } else { text.to_owned() };
            match (text.parse::<f64>(), unit(setting)) {
                (Ok(number), "") => Value::Number(number),
                (Ok(_), unit) => Value::Text(format!("{text} {unit}")),
                (Err(_), _) => Value::Text(text),
            }
        }
        _ => Value::from(text),
    }
}

/// The pictures of the lines, each with a unique name.
fn checked(lines: Vec<Line>, table: String, folder: &Path) -> Result<Vec<Picture>, TableError> {
    if lines.is_empty() {
        return Err(TableError::Empty { table });
    }
    let mut places = Vec::new();
    for Line { number: line, file, files, .. } in &lines {
        let Some(file) = file else {
            places.push(format!("line {line} names no file"));
            continue;
        };
        let own = (folder.join(file), FILE[0].to_owned());
        for (path, column) in [&own].into_iter().chain(files).filter(|(path, _)| !path.is_file()) {
            let path = path.display();
            places.push(format!("line {line}, column `{column}`: there is no file `{path}`"));
        }
    }
    if !places.is_empty() {
        return Err(TableError::Missing { table, places });
    }
    let mut seen: BTreeMap<String, u64> = BTreeMap::new();
    let mut of_file: BTreeMap<String, usize> = BTreeMap::new();
    let mut pictures = Vec::new();
    for line in lines {
        if let Some(first) = seen.insert(line.content(), line.number) {
            return Err(TableError::Twice { table, line: line.number, first });
        }
        let Line { file, is_stack, group, given, files, .. } = line;
        let file = file.unwrap_or_default();
        let count = of_file.entry(file.clone()).or_default();
        *count += 1;
        let name = if *count == 1 { file.clone() } else { format!("{file}-{count}") };
        let path = folder.join(&file);
        let files = files.into_iter().map(|(path, _)| path).collect();
        pictures.push(Picture { name, file, path, group, given, files, is_stack });
    }
    Ok(pictures)
}
