//! Text to rows of fields: delimiter, comments, what stands above the table, header.

use super::number::{Cell, Decimal, cell, decimal};

/// A row of fields and the line of the file that it stands in, from 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) line: u64,
    pub(super) fields: Vec<String>,
}

/// A table as it stands in a file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet {
    /// Names of the columns, units within; empty where there is no header.
    pub(super) header: Vec<String>,
    /// The rows below it.
    pub(super) rows: Vec<Row>,
    pub(super) delimiter: char,
    pub(super) decimal: Decimal,
    /// How many lines stand above the table, without comments.
    pub(super) above: usize,
}

/// What parts fields, in the order in which ties are settled.
const DELIMITERS: [char; 4] = ['\t', ';', ',', ' '];

/// Lines that tell which delimiter it is.
const ENOUGH: usize = 400;

impl Sheet {
    /// Of a text; delimiter and mark of decimals may be given. `None` where no line has a number.
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
        let best =
            tries.reduce(|best, other| if other.score() > best.score() { other } else { best })?;
        let best = best.or_one_column(&lines, delimiter, mark);
        let mut sheet = best.sheet(&lines);
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

    /// What a column is called: its header, or its number from 1.
    pub(super) fn name(&self, column: usize) -> String {
        match self.header.get(column) {
            Some(name) if !name.is_empty() => name.clone(),
            _ => (column + 1).to_string(),
        }
    }

    /// What a field holds; nothing where the row is too short.
    pub(super) fn cell(&self, row: &Row, column: usize) -> Cell {
        row.fields.get(column).map_or(Cell::Missing, |field| cell(field, self.decimal))
    }

    /// The number of columns of the widest row.
    pub(super) fn width(&self) -> usize {
        let widest = self.rows.iter().map(|row| row.fields.len()).max().unwrap_or(0);
        widest.max(self.header.len())
    }
}

fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with('#') || line.starts_with("//") || line.starts_with('%')
}

/// The fields of a line.
fn split(line: &str, delimiter: char) -> Vec<String> {
    if delimiter == ' ' {
        return line.split_whitespace().map(str::to_owned).collect();
    }
    // A reader takes longer to make than a line to part.
    if !line.contains('"') {
        return line.split(delimiter).map(|field| field.trim().to_owned()).collect();
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .delimiter(delimiter as u8)
        .from_reader(line.as_bytes());
    let record = reader.records().next().and_then(Result::ok);
    record.map_or_else(Vec::new, |record| record.iter().map(str::to_owned).collect())
}

/// A way to part the fields.
struct Try {
    delimiter: char,
    decimal: Decimal,
    /// Number of fields that most rows with numbers have.
    width: usize,
    /// How many rows have that many fields, with numbers, and none that is neither number nor word.
    rows: usize,
}

impl Try {
    fn of(lines: &[(u64, &str)], delimiter: char, mark: Option<Decimal>) -> Option<Self> {
        let rows: Vec<Vec<String>> =
            lines.iter().take(ENOUGH).map(|(_, line)| split(line, delimiter)).collect();
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

    /// A single column of numbers with decimal commas looks like two columns of whole numbers.
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

    /// The table among the lines.
    fn sheet(&self, lines: &[(u64, &str)]) -> Sheet {
        let all: Vec<Row> = lines
            .iter()
            .map(|&(line, text)| Row { line, fields: split(text, self.delimiter) })
            .filter(|row| row.fields.iter().any(|field| !field.is_empty()))
            .collect();
        let of_width =
            |row: &&Row| row.fields.len() == self.width && has_numbers(&row.fields, self.decimal);
        let body: Vec<&Row> = all.iter().filter(of_width).collect();
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
        let full = all.iter().position(is_full).unwrap_or(0);
        // The header is the last row above that has no number; rows between are data that went wrong.
        let is_words = |row: &Row| {
            row.fields.iter().all(|field| !matches!(cell(field, self.decimal), Cell::Number(_)))
                && row.fields.iter().any(|field| !field.is_empty())
        };
        let names = all[..full].iter().rposition(is_words);
        // Words above with too few fields are a title, unless spaces part the fields.
        let fits = |row: &Row| {
            self.delimiter == ' ' || 2 * row.fields.len() > self.width || row.fields.len() > 1
        };
        let names = names.filter(|&at| fits(&all[at]));
        let start = names.map_or(full, |at| at + 1);
        let mut header = names.map_or_else(Vec::new, |at| {
            let line = all[at].line;
            let text =
                lines.iter().find(|(number, _)| *number == line).map_or("", |(_, text)| text);
            self.header(text, &all[at].fields)
        });
        let mut above = names.unwrap_or(start);
        // A row of units below one of names.
        if let Some(at) = names.filter(|&at| at > 0) {
            let upper = &all[at - 1];
            let units = header.iter().all(|name| name.is_empty() || super::column::is_unit(name));
            if units && is_words(upper) && upper.fields.len() == header.len() {
                header = upper
                    .fields
                    .iter()
                    .zip(&header)
                    .map(|(name, unit)| match unit.trim_matches(['(', ')', '[', ']']) {
                        "" => name.clone(),
                        unit => format!("{name} ({unit})"),
                    })
                    .collect();
                above -= 1;
            }
        }
        let rows = all[start..].to_vec();
        Sheet { header, rows, delimiter: self.delimiter, decimal: self.decimal, above }
    }

    /// The names in a row; where spaces part the fields, names may have some, too.
    fn header(&self, text: &str, fields: &[String]) -> Vec<String> {
        if self.delimiter != ' ' || fields.len() == self.width {
            return fields.to_vec();
        }
        let wide = text.split("  ").map(str::trim).filter(|name| !name.is_empty());
        let wide: Vec<String> = wide.map(str::to_owned).collect();
        if wide.len() == self.width {
            return wide;
        }
        // `Time (s) Length (um)`: what stands in brackets belongs to the name before.
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

/// Whether a row has numbers and nothing that is neither a number nor a word (`05;0`, of the wrong delimiter).
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
