//! Units as factor and powers of the seven base units of the SI.

/// Powers of kg, m, s, A, K, cd, mol, and how many of their product one unit is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    pub(crate) factor: f64,
    pub(crate) powers: [f64; 7],
    /// What is added to a value in this unit before its factor: 273.15 for degrees Celsius.
    pub(crate) offset: f64,
}

const fn si(factor: f64, powers: [i8; 7]) -> Unit {
    let mut all = [0.0; 7];
    let mut index = 0;
    while index < 7 {
        all[index] = powers[index] as f64;
        index += 1;
    }
    Unit { factor, powers: all, offset: 0.0 }
}

/// Units by symbol, for `.mmt`, and by name, for CellML.
const UNITS: [(&str, &str, Unit); 33] = [
    ("m", "metre", si(1.0, [0, 1, 0, 0, 0, 0, 0])),
    ("g", "gram", si(1e-3, [1, 0, 0, 0, 0, 0, 0])),
    ("s", "second", si(1.0, [0, 0, 1, 0, 0, 0, 0])),
    ("A", "ampere", si(1.0, [0, 0, 0, 1, 0, 0, 0])),
    ("K", "kelvin", si(1.0, [0, 0, 0, 0, 1, 0, 0])),
    ("cd", "candela", si(1.0, [0, 0, 0, 0, 0, 1, 0])),
    ("mol", "mole", si(1.0, [0, 0, 0, 0, 0, 0, 1])),
    ("V", "volt", si(1.0, [1, 2, -3, -1, 0, 0, 0])),
    ("F", "farad", si(1.0, [-1, -2, 4, 2, 0, 0, 0])),
    ("S", "siemens", si(1.0, [-1, -2, 3, 2, 0, 0, 0])),
    ("C", "coulomb", si(1.0, [0, 0, 1, 1, 0, 0, 0])),
    ("L", "litre", si(1e-3, [0, 3, 0, 0, 0, 0, 0])),
    ("L", "liter", si(1e-3, [0, 3, 0, 0, 0, 0, 0])),
    ("m", "meter", si(1.0, [0, 1, 0, 0, 0, 0, 0])),
    ("M", "molar", si(1e3, [0, -3, 0, 0, 0, 0, 1])),
    ("J", "joule", si(1.0, [1, 2, -2, 0, 0, 0, 0])),
    ("N", "newton", si(1.0, [1, 1, -2, 0, 0, 0, 0])),
    ("Pa", "pascal", si(1.0, [1, -1, -2, 0, 0, 0, 0])),
    ("W", "watt", si(1.0, [1, 2, -3, 0, 0, 0, 0])),
    ("Ohm", "ohm", si(1.0, [1, 2, -3, -2, 0, 0, 0])),
    ("R", "ohm", si(1.0, [1, 2, -3, -2, 0, 0, 0])),
    ("Hz", "hertz", si(1.0, [0, 0, -1, 0, 0, 0, 0])),
    ("Bq", "becquerel", si(1.0, [0, 0, -1, 0, 0, 0, 0])),
    ("H", "henry", si(1.0, [1, 2, -2, -2, 0, 0, 0])),
    ("T", "tesla", si(1.0, [1, 0, -2, -1, 0, 0, 0])),
    ("Wb", "weber", si(1.0, [1, 2, -2, -1, 0, 0, 0])),
    ("Gy", "gray", si(1.0, [0, 2, -2, 0, 0, 0, 0])),
    ("Sv", "sievert", si(1.0, [0, 2, -2, 0, 0, 0, 0])),
    ("kat", "katal", si(1.0, [0, 0, -1, 0, 0, 0, 1])),
    ("lm", "lumen", si(1.0, [0, 0, 0, 0, 0, 1, 0])),
    ("lx", "lux", si(1.0, [0, -2, 0, 0, 0, 1, 0])),
    ("rad", "radian", si(1.0, [0; 7])),
    ("sr", "steradian", si(1.0, [0; 7])),
];

/// Further units of `.mmt` files that take no prefix.
const OTHERS: [(&str, Unit); 7] = [
    ("minute", si(60.0, [0, 0, 1, 0, 0, 0, 0])),
    ("h", si(3600.0, [0, 0, 1, 0, 0, 0, 0])),
    ("hour", si(3600.0, [0, 0, 1, 0, 0, 0, 0])),
    ("day", si(86400.0, [0, 0, 1, 0, 0, 0, 0])),
    ("cc", si(1e-6, [0, 3, 0, 0, 0, 0, 0])),
    ("bar", si(1e5, [1, -1, -2, 0, 0, 0, 0])),
    ("atm", si(101_325.0, [1, -1, -2, 0, 0, 0, 0])),
];

/// Prefixes by symbol and name, with their power of ten.
const PREFIXES: [(&str, &str, i32); 20] = [
    ("Y", "yotta", 24),
    ("Z", "zetta", 21),
    ("E", "exa", 18),
    ("P", "peta", 15),
    ("T", "tera", 12),
    ("G", "giga", 9),
    ("M", "mega", 6),
    ("k", "kilo", 3),
    ("h", "hecto", 2),
    ("da", "deca", 1),
    ("d", "deci", -1),
    ("c", "centi", -2),
    ("m", "milli", -3),
    ("u", "micro", -6),
    ("n", "nano", -9),
    ("p", "pico", -12),
    ("f", "femto", -15),
    ("a", "atto", -18),
    ("z", "zepto", -21),
    ("y", "yocto", -24),
];

/// Usual ways to write units, tried in order.
const USUAL: [&str; 63] = [
    "mV",
    "V",
    "ms",
    "s",
    "1/ms",
    "1/s",
    "mM",
    "uM",
    "nM",
    "M",
    "A/F",
    "mV/ms",
    "V/s",
    "uA/cm^2",
    "A/m^2",
    "pA",
    "nA",
    "uA",
    "pF",
    "nF",
    "uF",
    "mS/uF",
    "nS",
    "uS",
    "mS",
    "mS/cm^2",
    "uF/cm^2",
    "mM/ms",
    "mM/s",
    "uM/ms",
    "uM/s",
    "1/mV",
    "1/V",
    "1/mV/ms",
    "1/mV/s",
    "1/mM",
    "1/uM",
    "1/mM/ms",
    "1/uM/ms",
    "1/mM/s",
    "kPa",
    "Pa",
    "um",
    "cm",
    "um^2",
    "cm^2",
    "um^3",
    "pL",
    "nL",
    "uL",
    "L",
    "K",
    "C/mol",
    "J/mol/K",
    "nS/pF",
    "mL",
    "1/mM^2/ms",
    "1/uM/s",
    "cm/s",
    "L/F/ms",
    "kPa/ms",
    "mol",
    "S",
];

impl Unit {
    pub(crate) const ONE: Self = si(1.0, [0; 7]);
    pub(crate) const VOLT: Self = si(1.0, [1, 2, -3, -1, 0, 0, 0]);
    pub(crate) const SECOND: Self = si(1.0, [0, 0, 1, 0, 0, 0, 0]);
    pub(crate) const MOLES_PER_VOLUME: Self = si(1.0, [0, -3, 0, 0, 0, 0, 1]);
    pub(crate) const PASCAL: Self = si(1.0, [1, -1, -2, 0, 0, 0, 0]);
    pub(crate) const AMPERE: Self = si(1.0, [0, 0, 0, 1, 0, 0, 0]);
    pub(crate) const AMPERE_PER_FARAD: Self = si(1.0, [1, 2, -4, -1, 0, 0, 0]);
    pub(crate) const AMPERE_PER_AREA: Self = si(1.0, [0, -2, 0, 1, 0, 0, 0]);

    /// A unit of CellML by name, without prefix.
    pub(crate) fn named(name: &str) -> Option<Self> {
        match name {
            "dimensionless" | "boolean" => Some(Self::ONE),
            "kilogram" => Some(si(1.0, [1, 0, 0, 0, 0, 0, 0])),
            "celsius" => Some(Self { offset: 273.15, ..si(1.0, [0, 0, 0, 0, 1, 0, 0]) }),
            _ => UNITS.iter().find(|(_, own, _)| *own == name).map(|&(_, _, unit)| unit),
        }
    }

    /// The power of ten of a prefix of CellML, a name or a whole number.
    pub(crate) fn prefix(text: &str) -> Option<f64> {
        let named = PREFIXES.iter().find(|(_, name, _)| *name == text).map(|&(_, _, power)| power);
        let named = named.or_else(|| (text == "deka").then_some(1));
        named
            .or_else(|| text.parse().ok().filter(|power: &i32| power.abs() <= 300))
            .map(|p| 10_f64.powi(p))
    }

    /// A unit of `.mmt` files by symbol, with or without prefix.
    pub(crate) fn symbol(text: &str) -> Option<Self> {
        let plain =
            |text: &str| UNITS.iter().find(|(symbol, ..)| *symbol == text).map(|&(.., unit)| unit);
        let whole = if text == "1" { Some(Self::ONE) } else { plain(text) };
        whole
            .or_else(|| OTHERS.iter().find(|(name, _)| *name == text).map(|&(_, unit)| unit))
            .or_else(|| Self::named(text).filter(|unit| unit.offset == 0.0))
            .or_else(|| {
                PREFIXES.iter().find_map(|&(symbol, _, power)| {
                    let unit = plain(text.strip_prefix(symbol)?)?;
                    Some(Self { factor: unit.factor * 10_f64.powi(power), ..unit })
                })
            })
    }

    pub(crate) fn power(self, exponent: f64) -> Self {
        let powers = self.powers.map(|power| power * exponent);
        Self { factor: self.factor.powf(exponent), powers, offset: 0.0 }
    }

    pub(crate) fn times(self, other: Self) -> Self {
        let mut powers = self.powers;
        powers.iter_mut().zip(other.powers).for_each(|(own, other)| *own += other);
        Self { factor: self.factor * other.factor, powers, offset: 0.0 }
    }

    pub(crate) fn same_dimension(self, other: Self) -> bool {
        self.powers.iter().zip(other.powers).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    /// How many of `other` one of this unit is; `None` for another dimension.
    pub(crate) fn in_units_of(self, other: Self) -> Option<f64> {
        if !self.same_dimension(other) {
            return None;
        }
        Some(rounded(self.factor / other.factor))
    }

    /// As people write it: `mV`; empty for a pure number.
    pub(crate) fn text(self) -> String {
        let same = |unit: Self| {
            self.same_dimension(unit) && (self.factor / unit.factor - 1.0).abs() < 1e-9
        };
        if self.offset != 0.0 {
            return "degC".to_owned();
        }
        if same(Self::ONE) {
            return String::new();
        }
        if let Some(usual) = USUAL.iter().find(|usual| parse_usual(usual).is_some_and(same)) {
            return (*usual).to_owned();
        }
        let mut text = String::new();
        for (symbol, power) in ["kg", "m", "s", "A", "K", "cd", "mol"].iter().zip(self.powers) {
            if power.abs() > 1e-9 {
                let gap = if text.is_empty() { "" } else { "*" };
                let power = if power == 1.0 { String::new() } else { format!("^{power}") };
                text = format!("{text}{gap}{symbol}{power}");
            }
        }
        let base = if text.is_empty() { "1".to_owned() } else { text };
        if (self.factor - 1.0).abs() < 1e-9 {
            base
        } else {
            format!("{base} ({})", rounded(self.factor))
        }
    }
}

/// Powers of ten that came out with an error of rounding are exact.
fn rounded(factor: f64) -> f64 {
    let power = factor.log10().round();
    let exact = if power < 0.0 { 1.0 / 10_f64.powf(-power) } else { 10_f64.powf(power) };
    if (factor / exact - 1.0).abs() < 1e-12 { exact } else { factor }
}

/// One of [`USUAL`]: symbols joined by `/`, with whole powers.
fn parse_usual(text: &str) -> Option<Unit> {
    let mut unit = Unit::ONE;
    for (index, part) in text.split('/').enumerate() {
        let (symbol, power) = part.split_once('^').unwrap_or((part, "1"));
        let power: f64 = power.parse().ok()?;
        unit = unit.times(Unit::symbol(symbol)?.power(if index == 0 { power } else { -power }));
    }
    Some(unit)
}

/// ms per unit of time, of a unit of so many seconds.
pub(crate) fn milliseconds(seconds: f64) -> f64 {
    let exact = seconds * 1000.0;
    if (exact - exact.round()).abs() < 1e-9 * exact { exact.round() } else { exact }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_units_are_read_and_written() {
        for usual in USUAL {
            assert_eq!(Unit::symbol("mol").unwrap().text(), "mol");
            let unit = parse_usual(usual).unwrap_or_else(|| panic!("{usual}"));
            assert!(!unit.text().is_empty());
        }

        assert_eq!(Unit::symbol("mV").unwrap().in_units_of(Unit::VOLT), Some(1e-3));
        assert_eq!(Unit::symbol("ms").unwrap().in_units_of(Unit::SECOND), Some(1e-3));
    }
}
