//! Splits text into rows of fields: detects the delimiter, comments, lines above the table and the
//! header.

use super::number::{Cell, Decimal, cell, decimal};
use std::collections::{BTreeMap, BTreeSet};

/// A row of fields and its line in the file, from 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) line: u64,
    pub(super) fields: Vec<String>,
}

/// A table of a file, not interpreted yet.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet {
    /// Names of the columns, including units; empty if there is no header.
    pub(super) header: Vec<String>,
    /// Group of each column, from the row above the header (`Cell 1` above `Ratio` and
    /// `Numerator`); or empty.
    pub(super) groups: Vec<String>,
    /// Rows below the header.
    pub(super) rows: Vec<Row>,
    pub(super) decimal: Decimal,
    /// Number of lines with numbers above the header: another table, or another block of the
    /// recording.
    pub(super) above: usize,
    /// Columns that share their name with another column.
    pub(super) again: BTreeSet<usize>,
    /// Number of fields that most rows have.
    pub(super) usual: usize,
    /// For a transposed table, the line of the file that each column came from; else empty.
    pub(super) turned: Vec<u64>,
}

/// Delimiters of fields; among equally good ones the first is chosen.
const DELIMITERS: [char; 4] = ['\t', ';', ',', ' '];

/// Number of lines that are read to detect the delimiter.
const ENOUGH: usize = 400;

impl Sheet {
    /// Reads the table of a text; delimiter and decimal mark may be given. Returns `None` if no
    /// line has a number.
    pub(super) fn of(text: &str, delimiter: Option<char>, mark: Option<char>) -> Option<Self> {
        let mark = mark.map(|mark| if mark == ',' { Decimal::Comma } else { Decimal::Point });
        let lines: Vec<(u64, &str)> = (1..)
            .zip(text.lines())
            .map(|(number, line)| (number, line.trim_end_matches([' ', '\0'])))
            .filter(|(_, line)| !is_comment(line) && !line.trim().is_empty())
            .collect();
        let tried = match delimiter {
            Some(delimiter) => vec![delimiter],
            None => DELIMITERS.to_vec(),
        };
        let tries = tried.into_iter().filter_map(|delimiter| Try::of(&lines, delimiter, mark));
        // If tabs separate most lines of numbers, spaces are part of fields.
        let better = |best: Try, other: Try| {
            let tabs = best.delimiter == '\t' && best.width > 1 && 2 * best.rows > other.rows;
            let within = tabs && other.delimiter == ' ';
            if !within && other.score() > best.score() { other } else { best }
        };
        let best = tries.reduce(better)?;
        let best = best.or_one_column(&lines, delimiter, mark);
        let rows = lines
            .iter()
            .map(|&(line, text)| Row { line, fields: split(text, best.delimiter) })
            .collect();
        let text_of = |line: u64| {
            lines.iter().find(|(number, _)| *number == line).map_or("", |(_, text)| *text)
        };
        let mut sheet = best.sheet(rows, text_of);
        if sheet.header.is_empty() {
            // NumPy writes the header as a comment.
            let first = sheet.rows.first()?.line;
            let above = text.lines().take(first as usize - 1);
            let comment = above.filter(|line| is_comment(line)).last().unwrap_or_default();
            let words = comment.trim_start_matches(['#', '%', '/', ' ']);
            let names = best.header(words, &split(words, best.delimiter));
            let is_word = |name: &String| name.chars().any(char::is_alphabetic);
            if names.len() == best.width && names.iter().all(is_word) {
                sheet.header = names;
            }
        }
        Some(sheet)
    }

    /// Reads the table from the rows of a workbook; `None` if no row has a number.
    pub(super) fn of_rows(rows: Vec<Row>) -> Option<Self> {
        let fields: Vec<Vec<String>> =
            rows.iter().take(ENOUGH).map(|row| row.fields.clone()).collect();
        Some(Try::of_rows(&fields, '\t', Some(Decimal::Point))?.sheet(rows, |_| ""))
    }

    /// Returns the name of a column: its header with its group, or its number from 1; header and
    /// number if several columns share the name.
    pub(super) fn name(&self, column: usize) -> String {
        let group = self.groups.get(column).filter(|group| !group.is_empty());
        let name = match (self.header.get(column).filter(|name| !name.is_empty()), group) {
            (Some(name), Some(group)) => format!("{group} {name}"),
            (Some(name), None) => name.clone(),
            (None, _) => return (column + 1).to_string(),
        };
        if self.again.contains(&column) { format!("{name} (column {})", column + 1) } else { name }
    }

    /// Returns the position of a field in the file: its line and the name of its column.
    pub(super) fn place(&self, row: &Row, column: usize) -> (u64, String) {
        let is_turned = column < self.turned.len();
        let name = if is_turned { row.line.to_string() } else { self.name(column) };
        (self.line(row, column), name)
    }

    /// Returns the line of the file that contains a field.
    pub(super) fn line(&self, row: &Row, column: usize) -> u64 {
        self.turned.get(column).copied().unwrap_or(row.line)
    }

    /// Transposes the table. The first row, or the header, becomes a column of times or frames
    /// named `axis`; the first `labels` fields of the other rows become the names of their columns.
    pub(super) fn turn(self, axis: Option<&str>, labels: usize) -> Self {
        let width = self.width();
        let from_header = axis.is_some() && !self.header.is_empty();
        let first_line = self.rows.first().map_or(1, |row| row.line);
        let mut lines: Vec<u64> = self.rows.iter().map(|row| row.line).collect();
        if from_header {
            lines.insert(0, first_line.saturating_sub(1).max(1));
        }
        let mut header: Vec<String> = (1..)
            .zip(self.rows.iter().skip(usize::from(axis.is_some() && !from_header)))
            .map(|(number, row)| {
                let labels: Vec<&str> =
                    row.fields.iter().take(labels).map(String::as_str).collect();
                let label = labels.join(" ").trim().to_owned();
                if label.is_empty() { number.to_string() } else { label }
            })
            .collect();
        if let Some(axis) = axis {
            header.insert(0, axis.to_owned());
        }
        let field = |row: &Row, at: usize| row.fields.get(at).cloned().unwrap_or_default();
        let rows = (labels..width)
            .map(|at| {
                let number = |name: &String| name[number_at(name)..].to_owned();
                let frame = self.header.get(at).filter(|_| from_header).map(number);
                let fields = frame.into_iter().chain(self.rows.iter().map(|row| field(row, at)));
                Row { line: at as u64 + 1, fields: fields.collect() }
            })
            .collect();
        Self { header, groups: Vec::new(), rows, turned: lines, ..self }
    }

    /// Returns the row and the index of the first number beyond the last column. A table without
    /// names has as many columns as most of its rows.
    pub(super) fn beyond(&self) -> Option<(&Row, usize)> {
        let columns = if self.header.is_empty() { self.usual } else { self.header.len() };
        let number = |row: &Row| {
            (columns..row.fields.len()).find(|at| matches!(self.cell(row, *at), Cell::Number(_)))
        };
        self.rows.iter().find_map(|row| Some((row, number(row)?)))
    }

    /// Reads a field; missing if the row is too short.
    pub(super) fn cell(&self, row: &Row, column: usize) -> Cell {
        row.fields.get(column).map_or(Cell::Missing, |field| cell(field, self.decimal))
    }

    /// Records which columns share their name with another column.
    pub(super) fn note_names(&mut self) {
        let mut places = BTreeMap::<(&str, &str), Vec<usize>>::new();
        for (at, name) in self.header.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            let group = self.groups.get(at).map_or("", String::as_str);
            places.entry((group, name)).or_default().push(at);
        }
        self.again = places.into_values().filter(|places| places.len() > 1).flatten().collect();
    }

    /// Returns the number of columns of the widest row.
    pub(super) fn width(&self) -> usize {
        let widest = self.rows.iter().map(|row| row.fields.len()).max().unwrap_or(0);
        widest.max(self.header.len())
    }
}

fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with('#') || line.starts_with("//") || line.starts_with('%')
}

/// Splits a line into fields.
fn split(line: &str, delimiter: char) -> Vec<String> {
    if delimiter == ' ' {
        return line.split_whitespace().map(str::to_owned).collect();
    }
    // Splitting the line directly is faster than creating a CSV reader.
    if !line.contains('"') {
        return line.split(delimiter).map(|field| field.trim().to_owned()).collect();
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .delimiter(delimiter as u8)
        .buffer_capacity(line.len())
        .from_reader(line.as_bytes());
    let record = reader.records().next().and_then(Result::ok);
    record.map_or_else(Vec::new, |record| record.iter().map(str::to_owned).collect())
}

/// A way to split lines into fields.
struct Try {
    delimiter: char,
    decimal: Decimal,
    /// Number of fields that most rows with numbers have.
    width: usize,
    /// Number of rows with that many fields, at least one number, and no field that is neither
    /// number nor word.
    rows: usize,
}

impl Try {
    fn of(lines: &[(u64, &str)], delimiter: char, mark: Option<Decimal>) -> Option<Self> {
        let rows: Vec<Vec<String>> =
            lines.iter().take(ENOUGH).map(|(_, line)| split(line, delimiter)).collect();
        Self::of_rows(&rows, delimiter, mark)
    }

    fn of_rows(rows: &[Vec<String>], delimiter: char, mark: Option<Decimal>) -> Option<Self> {
        let decimal =
            mark.unwrap_or_else(|| decimal(rows.iter().flatten().map(String::as_str), delimiter));
        let widths = rows.iter().filter(|row| has_numbers(row, decimal)).map(Vec::len);
        let mut counts = std::collections::BTreeMap::<usize, usize>::new();
        for width in widths {
            *counts.entry(width).or_default() += 1;
        }
        let (&width, &rows) = counts.iter().max_by_key(|(width, count)| (**count, **width))?;
        Some(Self { delimiter, decimal, width, rows })
    }

    fn score(&self) -> (usize, usize) {
        (self.rows, self.width)
    }

    /// Returns a single column instead of two if these are one column of numbers with decimal
    /// commas, which looks like two columns of whole numbers.
    fn or_one_column(
        self,
        lines: &[(u64, &str)],
        given: Option<char>,
        mark: Option<Decimal>,
    ) -> Self {
        if given.is_some()
            || mark == Some(Decimal::Point)
            || (self.delimiter, self.width) != (',', 2)
        {
            return self;
        }
        let rows: Vec<Vec<String>> = lines.iter().map(|(_, line)| split(line, ',')).collect();
        let numbers: Vec<&Vec<String>> =
            rows.iter().filter(|row| row.len() == 2 && has_numbers(row, self.decimal)).collect();
        if numbers.iter().any(|row| row.iter().any(|field| field.contains('.') || field.is_empty()))
        {
            return self;
        }
        let header = rows.iter().find(|row| !has_numbers(row, self.decimal));
        let first = numbers.iter().filter_map(|row| row[0].parse::<f64>().ok());
        let rises = first.collect::<Vec<f64>>().windows(2).all(|pair| pair[1] > pair[0]);
        let one = header.map_or(!rises, |header| header.len() == 1);
        let other = Self::of(lines, ';', Some(Decimal::Comma)).filter(|_| one);
        other.unwrap_or(self)
    }

    /// Finds the table among the rows; `text_of` returns the text of a line.
    fn sheet<'t>(&self, rows: Vec<Row>, text_of: impl Fn(u64) -> &'t str) -> Sheet {
        let mut all: Vec<Row> = rows
            .into_iter()
            .filter(|row| row.fields.iter().any(|field| !field.is_empty()))
            .collect();
        let full = self.full(&all);
        let first = full.iter().position(|full| *full).unwrap_or(0);
        // Counts and settings above a table look like its rows, so the table begins with the
        // longest run of rows.
        let table = longest_run(&full).unwrap_or(first);
        // The header is the last row above without a number; rows in between are damaged data.
        // A row of words with too few fields is a title, unless spaces separate the fields.
        let fits = |row: &Row| {
            let used =
                row.fields.iter().rposition(|field| !field.is_empty()).map_or(0, |at| at + 1);
            self.delimiter == ' ' || 2 * used > self.width || used > 1
        };
        let names =
            all[..table].iter().rposition(|row| self.is_words(row)).filter(|&at| fits(&all[at]));
        let start = names.map_or_else(
            || first.checked_sub(1).filter(|at| self.is_axis(&all[*at])).unwrap_or(first),
            |at| at + 1,
        );
        let above = full[..start].iter().filter(|full| **full).count();
        let sheet = Sheet {
            header: Vec::new(),
            groups: Vec::new(),
            rows: all.split_off(start),
            decimal: self.decimal,
            above: if above > 2 { above } else { 0 },
            usual: self.width,
            again: BTreeSet::new(),
            turned: Vec::new(),
        };
        match names {
            Some(at) => self.named(sheet, &all[..=at], text_of(all[at].line)),
            None => sheet,
        }
    }

    /// Which rows have a number in a column of numbers, and no word in any.
    fn full(&self, rows: &[Row]) -> Vec<bool> {
        let of_width =
            |row: &&Row| row.fields.len() == self.width && has_numbers(&row.fields, self.decimal);
        let body: Vec<&Row> = rows.iter().filter(of_width).collect();
        // Columns in which most rows have numbers.
        let numeric: Vec<bool> = (0..self.width)
            .map(|column| {
                let is = |row: &&&Row| cell(&row.fields[column], self.decimal) != Cell::Text;
                2 * body.iter().filter(is).count() > body.len()
            })
            .collect();
        let is_full = |row: &Row| {
            let cells: Vec<(Cell, bool)> = row
                .fields
                .iter()
                .zip(&numeric)
                .map(|(field, numeric)| (cell(field, self.decimal), *numeric))
                .collect();
            row.fields.len() <= self.width
                && 2 * row.fields.len() >= self.width
                && cells.iter().any(|(cell, numeric)| *numeric && matches!(cell, Cell::Number(_)))
                && cells.iter().all(|(cell, numeric)| !numeric || *cell != Cell::Text)
        };
        rows.iter().map(is_full).collect()
    }

    fn is_words(&self, row: &Row) -> bool {
        row.fields.iter().all(|field| !matches!(cell(field, self.decimal), Cell::Number(_)))
            && row.fields.iter().any(|field| !field.is_empty())
    }

    /// Names the columns of a table by the last of the rows `above`, whose text is given.
    fn named(&self, mut sheet: Sheet, above: &[Row], text: &str) -> Sheet {
        let Some((own, before)) = above.split_last() else { return sheet };
        if let Some(header) = header_of_settings(above) {
            return Sheet { header, ..sheet };
        }
        sheet.header = self.header(text, &own.fields);
        let Some(upper) = before.last() else { return sheet };
        // A row of units below a row of names.
        let is_unit = |name: &String| name.is_empty() || super::column::is_unit(name);
        if sheet.header.iter().all(is_unit)
            && self.is_words(upper)
            && upper.fields.len() == sheet.header.len()
        {
            let with_unit =
                |(name, unit): (&String, &String)| match unit.trim_matches(['(', ')', '[', ']']) {
                    "" => name.clone(),
                    unit => format!("{name} ({unit})"),
                };
            sheet.header = upper.fields.iter().zip(&sheet.header).map(with_unit).collect();
            return sheet;
        }
        // Repeated names belong to the groups in the row above.
        if self.is_words(upper) && upper.line + 1 == own.line && come_again(&sheet.header) {
            let mut group = String::new();
            for (place, name) in sheet.header.iter().enumerate() {
                match upper.fields.get(place).filter(|upper| !upper.is_empty()) {
                    Some(upper) => group.clone_from(upper),
                    None if name.is_empty() => group.clear(),
                    None => {}
                }
                sheet.groups.push(if name.is_empty() { String::new() } else { group.clone() });
            }
        }
        sheet
    }

    /// Whether a row is a name followed by times or frames, such as `index,0,1,2`, above rows that
    /// are curves.
    fn is_axis(&self, row: &Row) -> bool {
        let mut before = f64::NEG_INFINITY;
        let mut numbers = 0;
        row.fields.len() == self.width
            && row.fields.iter().all(|field| match cell(field, self.decimal) {
                Cell::Number(number) => {
                    let rises = number > before;
                    before = number;
                    numbers += 1;
                    rises
                }
                _ => numbers == 0,
            })
            && numbers > 2
    }

    /// Returns the names in a row; where spaces separate the fields, names may contain spaces, too.
    fn header(&self, text: &str, fields: &[String]) -> Vec<String> {
        if self.delimiter != ' ' || fields.len() == self.width {
            return fields.to_vec();
        }
        let wide = text.split("  ").map(str::trim).filter(|name| !name.is_empty());
        let wide: Vec<String> = wide.map(str::to_owned).collect();
        if wide.len() == self.width {
            return wide;
        }
        // `Time (s) Length (um)`: text in brackets belongs to the name before it.
        let mut names: Vec<String> = Vec::new();
        for field in fields {
            match names.last_mut() {
                Some(name) if field.starts_with(['(', '[']) => {
                    name.push(' ');
                    name.push_str(field);
                }
                _ => names.push(field.clone()),
            }
        }
        if names.len() == self.width { names } else { fields.to_vec() }
    }
}

/// Returns the start of the longest run of rows.
fn longest_run(full: &[bool]) -> Option<usize> {
    let (mut best, mut begin) = (None::<(usize, usize)>, None);
    for at in 0..=full.len() {
        if full.get(at) == Some(&true) {
            begin.get_or_insert(at);
        } else if let Some(from) = begin.take()
            && best.is_none_or(|(length, _)| at - from > length)
        {
            best = Some((at - from, from));
        }
    }
    best.map(|(_, from)| from)
}

/// Whether a header contains a name, other than the empty one, twice.
fn come_again(header: &[String]) -> bool {
    let mut seen = BTreeSet::new();
    header.iter().any(|name| !name.is_empty() && !seen.insert(name))
}

/// Returns the names of columns from lines of settings such as `ChannelTitle=`, as `LabChart`
/// exports them; `None` if the lowest line is not such a setting.
fn header_of_settings(rows: &[Row]) -> Option<Vec<String>> {
    let key = |row: &Row| Some(row.fields.first()?.strip_suffix('=')?.to_lowercase());
    key(rows.last()?)?;
    let of =
        |part: &str| rows.iter().rev().find(|row| key(row).is_some_and(|key| key.contains(part)));
    let second = |row: &Row| Some(row.fields.get(1)?.split_whitespace().last()?.to_owned());
    let time =
        of("interval").and_then(second).map_or("Time".to_owned(), |unit| format!("Time ({unit})"));
    let titles = of("title").or_else(|| of("name")).or_else(|| of("signal"))?;
    let units = of("unit");
    let names = (1..titles.fields.len()).map(|at| {
        let name = &titles.fields[at];
        match units.and_then(|units| units.fields.get(at)).filter(|unit| !unit.is_empty()) {
            Some(unit) => format!("{name} ({unit})"),
            None => name.clone(),
        }
    });
    Some([time].into_iter().chain(names).collect())
}

/// Returns the start of the number at the end of a name.
pub(super) fn number_at(name: &str) -> usize {
    name.trim_end_matches(|letter: char| letter.is_ascii_digit()).len()
}

/// Whether a row has numbers, and only fields that are numbers or words; a field such as `05;0`
/// comes from the wrong delimiter.
fn has_numbers(row: &[String], decimal: Decimal) -> bool {
    let mut numbers = 0;
    for field in row {
        match cell(field, decimal) {
            Cell::Number(_) => numbers += 1,
            Cell::Missing => {}
            Cell::Text if field.chars().any(char::is_alphabetic) => {}
            Cell::Text => return false,
        }
    }
    numbers > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(text: &str) -> (Vec<String>, Vec<Cell>) {
        let sheet = Sheet::of(text, None, None).unwrap();
        let row = &sheet.rows[0];
        let cells = (0..row.fields.len()).map(|column| sheet.cell(row, column)).collect();
        (sheet.header.clone(), cells)
    }

    #[test]
    fn fields_are_parted_by_whatever_parts_them() {
        let numbers = vec![Cell::Number(0.0), Cell::Number(1.82)];
        let header = vec!["time (s)".to_owned(), "length (um)".to_owned()];
        for text in [
            "time (s),length (um)\n0,1.82\n0.01,1.81\n",
            "time (s);length (um)\n0;1,82\n0,01;1,81\n",
            "time (s)\tlength (um)\n0\t1,82\n0,01\t1,81\n",
            "time (s)  length (um)\n0  1.82\n0.01  1.81\n",
            "time (s) length (um)\n 0 1,82\n 0,01 1,81\n",
            "Cell 3, day 2\nFrame rate,100\n\ntime (s),length (um)\n0,1.82\n0.01,1.81\n",
            "# made by NumPy\n# time (s),length (um)\n0.0,1.82\n0.01,1.81\n",
            "% by a program\ntime,length\n(s),(um)\n0,1.82\n0.01,1.81\n",
            "\"time (s)\",\"length (um)\"\n\"0\",\"1.82\"\n\"0.01\",\"1.81\"\n",
        ] {
            assert_eq!(first(text), (header.clone(), numbers.clone()), "{text}");
        }
    }

    #[test]
    fn a_column_of_decimal_commas_is_one_column() {
        assert_eq!(first("1,82\n1,80\n1,82\n").1, [Cell::Number(1.82)]);
        assert_eq!(first("length\n1,82\n1,80\n1,82\n").1, [Cell::Number(1.82)]);
        assert_eq!(first("0,82\n1,80\n2,82\n").1.len(), 2);
    }

    #[test]
    fn a_bad_first_row_is_no_header() {
        let sheet = Sheet::of("t,l\n0,oops\n1,2\n2,3\n3,4\n", None, None).unwrap();
        assert_eq!(sheet.header, ["t", "l"]);
        assert_eq!(sheet.rows[0].fields, ["0", "oops"]);
        assert_eq!(sheet.rows[0].line, 2);
    }
}
