//! Converts units in any spelling to the symbols of the tables: `microns`, `µm`, `milliseconds`,
//! `um²`.

/// Prefixes as words.
const PREFIXES: [(&str, &str); 7] = [
    ("femto", "f"),
    ("pico", "p"),
    ("nano", "n"),
    ("micro", "u"),
    ("milli", "m"),
    ("kilo", "k"),
    ("mega", "M"),
];

/// Names of units, without the `s` of their plural.
const NAMES: [(&str, &str); 17] = [
    ("meter", "m"),
    ("metre", "m"),
    ("second", "s"),
    ("sec", "s"),
    ("minute", "min"),
    ("gram", "g"),
    ("newton", "N"),
    ("pascal", "Pa"),
    ("joule", "J"),
    ("volt", "V"),
    ("ampere", "A"),
    ("amp", "A"),
    ("farad", "F"),
    ("siemens", "S"),
    ("molar", "M"),
    ("hertz", "Hz"),
    ("radian", "rad"),
];

/// Irregular names.
const OTHERS: [(&str, &str); 10] = [
    ("micron", "um"),
    ("microns", "um"),
    ("msec", "ms"),
    ("msecs", "ms"),
    ("usec", "us"),
    ("mins", "min"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("percent", "%"),
    ("fps", "1/s"),
];

/// The symbol of a unit: `um` of `µm`, `micrometers` and `microns`, `nN/um^2` of `nN / µm²`;
/// unknown words stay unchanged.
///
/// # Example
/// ```
/// use myospring::units::symbol;
/// assert_eq!(symbol("milliseconds"), "ms");
/// assert_eq!(symbol("newtons per metre"), "N/m");
/// assert_eq!(symbol("µm²"), "um^2");
/// assert_eq!(symbol("furlong"), "furlong");
/// ```
pub fn symbol(unit: &str) -> String {
    // UTF-8 misread as Latin-1 has another letter before the micro sign.
    let unit = unit.replace("\u{c2}\u{b5}", "u").replace("\u{ce}\u{bc}", "u");
    let unit = unit.replace(['\u{b5}', '\u{3bc}'], "u").replace('²', "^2").replace('³', "^3");
    let spaced = unit.replace(['·', '⋅', '*', '\u{a0}', '\u{202f}'], " ");
    let spaced = spaced.trim().trim_end_matches('.').replace("per cent", "%");
    let (mut plain, mut word) = (String::new(), String::new());
    let mut letters = spaced.chars().peekable();
    while let Some(letter) = letters.next() {
        word.push(letter);
        let goes_on = letters.peek().is_some_and(|next| next.is_alphabetic());
        if !letter.is_alphabetic() || !goes_on {
            // `um2` is `um^2`.
            if letter.is_alphabetic() && letters.peek().is_some_and(char::is_ascii_digit) {
                word.push('^');
            }
            plain.push_str(&of_word(&word));
            word.clear();
        }
    }
    // `nN / um` is `nN/um`.
    let parts: Vec<&str> = plain.split('/').map(str::trim).collect();
    let symbol = parts.join("/").split_whitespace().collect::<Vec<_>>().join(" ");
    let frames = symbol.strip_prefix("frame").map(|rest| rest.trim_start_matches('s'));
    match frames.filter(|rest| rest.starts_with('/')) {
        Some(rate) => format!("1{rate}"),
        None => symbol,
    }
}

fn of_word(word: &str) -> String {
    let (name, power) = match word.strip_suffix('^') {
        Some(name) => (name, "^"),
        None => (word, ""),
    };
    let small = name.to_lowercase();
    let known = OTHERS.iter().find(|(written, _)| *written == small);
    let symbol = match known {
        _ if small == "per" => "/".to_owned(),
        Some((_, symbol)) => (*symbol).to_owned(),
        None => of_name(&small).unwrap_or_else(|| name.to_owned()),
    };
    format!("{symbol}{power}")
}

/// Splits a name like `micrometers` into prefix, name and plural.
fn of_name(name: &str) -> Option<String> {
    let prefix = PREFIXES.iter().find(|(prefix, _)| name.starts_with(prefix));
    let (written, symbol) = prefix.copied().unwrap_or_default();
    let base = &name[written.len()..];
    let is_it = |(name, _): &&(&str, &str)| base == *name || base.strip_suffix('s') == Some(name);
    Some(format!("{symbol}{}", NAMES.iter().find(is_it)?.1))
}
