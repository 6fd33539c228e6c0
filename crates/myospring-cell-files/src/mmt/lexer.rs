//! Lines to tokens: comments dropped, lines joined within parentheses, indentation as tokens.

use crate::draft::Problem;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Name(String),
    Number(f64),
    /// An operator or bracket.
    Sign(&'static str),
    /// What follows a colon.
    Text(String),
    Indent,
    Dedent,
    EndOfLine,
    EndOfFile,
}

/// A token and its line.
pub(super) type Placed = (Token, usize);

const SIGNS: [&str; 23] = [
    "//", "==", "!=", "<=", ">=", "+", "-", "*", "/", "%", "^", "(", ")", "[", "]", "<", ">", "=",
    ",", ".", ":", "&", "|",
];

/// The tokens of a section whose first line has the number `first`.
pub(super) fn tokens(lines: &[&str], first: usize) -> Result<Vec<Placed>, Problem> {
    let mut lexer = Lexer { tokens: Vec::new(), columns: vec![0], depth: 0, joined: false };
    let mut index = 0;
    while index < lines.len() {
        index += lexer.line(&lines[index..], first + index)?;
    }
    let last = first + lines.len();
    if lexer.depth > 0 {
        return Err(Problem::at(last, "a parenthesis `(` is not closed"));
    }
    lexer.tokens.push((Token::EndOfLine, last));
    for _ in 1..lexer.columns.len() {
        lexer.tokens.push((Token::Dedent, last));
    }
    lexer.tokens.push((Token::EndOfFile, last));
    Ok(lexer.tokens)
}

struct Lexer {
    tokens: Vec<Placed>,
    columns: Vec<usize>,
    depth: usize,
    /// The last line ended with a backslash.
    joined: bool,
}

impl Lexer {
    /// Reads one line, or more where a text goes on; returns how many.
    fn line(&mut self, lines: &[&str], number: usize) -> Result<usize, Problem> {
        let Some(&whole) = lines.first() else { return Ok(1) };
        if let Some(rest) = whole.strip_prefix("\"\"\"") {
            return if rest.contains("\"\"\"") { Ok(1) } else { Ok(1 + lines_to_end(&lines[1..])) };
        }
        let code = whole.split('#').next().unwrap_or("").trim_end();
        if code.trim().is_empty() {
            return Ok(1);
        }
        if self.depth == 0 && !self.joined {
            self.indent(code, number)?;
        }
        self.joined = false;
        let mut rest = code.trim_start();
        while !rest.is_empty() {
            if rest == "\\" {
                self.joined = true;
                return Ok(1);
            }
            if let Some(text) = rest.strip_prefix(':') {
                self.tokens.push((Token::Sign(":"), number));
                return Ok(self.text(text, lines, number));
            }
            rest = self.token(rest, number)?.trim_start();
        }
        if self.depth == 0 {
            self.tokens.push((Token::EndOfLine, number));
        }
        Ok(1)
    }

    fn indent(&mut self, code: &str, number: usize) -> Result<(), Problem> {
        let column = code
            .chars()
            .take_while(|c| c.is_whitespace())
            .fold(0, |column, c| if c == '\t' { (1 + column / 8) * 8 } else { column + 1 });
        let last = |columns: &[usize]| columns.last().copied().unwrap_or(0);
        if column > last(&self.columns) {
            self.columns.push(column);
            self.tokens.push((Token::Indent, number));
        }
        while column < last(&self.columns) {
            self.columns.pop();
            self.tokens.push((Token::Dedent, number));
        }
        if column == last(&self.columns) {
            return Ok(());
        }
        Err(Problem::at(number, "the indentation fits no line above"))
    }

    /// The text after a colon: to the end of the line, or between triple quotes.
    fn text(&mut self, text: &str, lines: &[&str], number: usize) -> usize {
        let text = text.trim();
        let (text, used) = match text.strip_prefix("\"\"\"") {
            None => (text.to_owned(), 1),
            Some(start) => {
                if let Some((inside, _)) = start.split_once("\"\"\"") {
                    (inside.to_owned(), 1)
                } else {
                    let further = lines_to_end(&lines[1..]);
                    let inside = lines[1..=further.min(lines.len() - 1)].iter();
                    let inside: Vec<&str> =
                        inside.map(|line| line.trim().trim_end_matches("\"\"\"")).collect();
                    (format!("{start}\n{}", inside.join("\n")), 1 + further)
                }
            }
        };
        self.tokens.push((Token::Text(text.trim().to_owned()), number));
        self.tokens.push((Token::EndOfLine, number));
        used
    }

    fn token<'a>(&mut self, rest: &'a str, number: usize) -> Result<&'a str, Problem> {
        let first = rest.chars().next().unwrap_or(' ');
        if first.is_ascii_digit()
            || first == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit())
        {
            let length = number_length(rest.as_bytes());
            let value = rest[..length].parse().map_err(|_| {
                Problem::at(number, format!("`{}` is not a number", &rest[..length]))
            })?;
            self.tokens.push((Token::Number(value), number));
            return Ok(&rest[length..]);
        }
        if first.is_ascii_alphabetic() || first == '_' {
            let length =
                rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
            self.tokens.push((Token::Name(rest[..length].to_owned()), number));
            return Ok(&rest[length..]);
        }
        let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) else {
            return Err(Problem::at(
                number,
                format!("the character `{first}` is not expected here"),
            ));
        };
        match *sign {
            "(" => self.depth += 1,
            ")" if self.depth == 0 => {
                return Err(Problem::at(number, "a parenthesis `)` was never opened"));
            }
            ")" => self.depth -= 1,
            _ => {}
        }
        self.tokens.push((Token::Sign(sign), number));
        Ok(&rest[sign.len()..])
    }
}

/// Number of lines up to and including that with the closing quotes.
fn lines_to_end(lines: &[&str]) -> usize {
    lines.iter().position(|line| line.contains("\"\"\"")).map_or(lines.len(), |place| place + 1)
}

fn number_length(bytes: &[u8]) -> usize {
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}
