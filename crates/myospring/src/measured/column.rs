//! Recognises what a column contains by its name and unit: `time (ms)`, `Length [µm]`, `Ca_nM`,
//! `frame`.

use crate::analysis::kind::Kind;
use crate::units::{self, Dimension};

/// Content of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Holds {
    Time,
    /// Frame number.
    Frame,
    /// Time of a mark, such as a stimulus; another column says what was marked.
    MarkTime,
    /// Identifier of the cell, sarcomere or region that a row belongs to.
    Identity,
    Curve(Kind),
    /// The name is that of this kind of curve, but the unit is that of another quantity: `I_Ca
    /// (pA)`, `calcium rise (ms)`.
    Contradicts(Kind),
    /// Anything else.
    Other,
}

/// A column's name and unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Title {
    /// Name without the unit.
    pub(super) name: String,
    /// Unit as `units` writes it; empty if the header gives none.
    pub(super) unit: String,
}

/// Spellings of units that [`units::symbol`] does not know, with the unit.
const WRITTEN: [(&str, &str); 16] = [
    ("pixel", "px"),
    ("pixels", "px"),
    ("pix", "px"),
    ("pct", "%"),
    ("au", "a.u."),
    ("a.u", "a.u."),
    ("arb. units", "a.u."),
    ("arb. unit", "a.u."),
    ("arb.u", "a.u."),
    ("arbitrary units", "a.u."),
    ("arbitrary unit", "a.u."),
    ("rfu", "a.u."),
    ("counts", "a.u."),
    ("mn/mm^2", "mN/mm^2"),
    ("nn/um^2", "nN/um^2"),
    ("1", ""),
];

/// Unit of forces in programs that use SI units.
const NEWTON: &str = "N";

/// Dimensions of curves.
const DIMENSIONS: [Dimension; 7] = [
    Dimension::Time,
    Dimension::Length,
    Dimension::Pressure,
    Dimension::Force,
    Dimension::Energy,
    Dimension::Concentration,
    Dimension::Voltage,
];

/// Returns a unit as `units` writes it, `px`, `%` or `a.u.`; `None` if the text is not a unit.
pub(super) fn unit(text: &str) -> Option<String> {
    let text = units::symbol(text);
    let whole = text.to_lowercase();
    if let Some((_, unit)) = WRITTEN.iter().find(|(written, _)| *written == whole) {
        return Some((*unit).to_owned());
    }
    if ["px", "%"].contains(&whole.as_str()) {
        return Some(whole);
    }
    if text == NEWTON {
        return Some(text);
    }
    // First unchanged, then in lower case: `MS` and `Um` are units, too, but `mM` must not become
    // `mm`.
    [text, whole].into_iter().find(|unit| {
        let one = format!("1 {unit}");
        !unit.is_empty()
            && DIMENSIONS.iter().any(|dimension| units::parse(&one, *dimension).is_ok())
    })
}

/// Whether a field contains only a unit, with or without brackets.
pub(super) fn is_unit(field: &str) -> bool {
    unit(field.trim_matches(['(', ')', '[', ']'])).is_some()
}

/// Splits a header into name and unit: `time (ms)`, `time [ms]`, `time_ms`, `time/ms`, `time, ms`.
pub(super) fn title(header: &str) -> Title {
    let header = header.trim();
    for (open, close) in [('(', ')'), ('[', ']')] {
        let parts = header.strip_suffix(close).and_then(|text| text.rsplit_once(open));
        if let Some((name, unit_text)) = parts {
            if name.trim().is_empty() {
                continue;
            }
            let unit = unit(unit_text).unwrap_or_else(|| unit_text.trim().to_owned());
            return Title { name: name.trim().to_owned(), unit };
        }
    }
    if let Some(title) = of_ratio(header) {
        return title;
    }
    for mark in ['_', ' ', '/', ',', '.'] {
        let Some((name, text)) = header.rsplit_once(mark) else { continue };
        if let Some(unit) = unit(text).filter(|unit| !unit.is_empty() && !name.trim().is_empty()) {
            let title = Title { name: name.trim().trim_end_matches(',').to_owned(), unit };
            if text.trim().chars().count() > 1 || agrees(&title) {
                return title;
            }
        }
    }
    // `Sec` alone is the name of a column of times.
    let unit = unit(header).filter(|unit| !unit.is_empty()).unwrap_or_default();
    Title { name: header.to_owned(), unit }
}

/// Splits a header that ends in a ratio of units such as `mM_per_ms`, as our own tables write it.
fn of_ratio(header: &str) -> Option<Title> {
    let (front, below) = header.rsplit_once("_per_")?;
    let (name, above) = front.rsplit_once('_')?;
    let is_symbol = |text: &str| !text.is_empty() && text.chars().all(char::is_alphanumeric);
    (is_symbol(above) && is_symbol(below) && !name.is_empty())
        .then(|| Title { name: name.to_owned(), unit: format!("{above}/{below}") })
}

/// Whether a single letter at the end of a name is a unit: it is in `t_s` and `Vm_V`, but not in
/// `f_Ca_s`, the slow gate of a calcium current. The letter must be a unit of the quantity that the
/// name states.
fn agrees(title: &Title) -> bool {
    matches!(holds(title), Holds::Time | Holds::Curve(_))
}

/// Returns what a column with this title contains.
pub(super) fn holds(title: &Title) -> Holds {
    match by_name(title) {
        Holds::Curve(kind)
            if unit(&title.unit).is_some_and(|unit| scale(kind, &unit, None).is_err()) =>
        {
            Holds::Contradicts(kind)
        }
        held => held,
    }
}

/// Returns what the columns of a table contain. If one column is a time by its name, a column
/// called only `s` or `ms`, such as a gate of a cell model, is not a time.
pub(super) fn all_hold(titles: &[Title]) -> Vec<Holds> {
    let mut held: Vec<Holds> = titles.iter().map(holds).collect();
    let is_bare = |title: &Title| unit(&title.name).is_some();
    let is_time = |at: &usize| held[*at] == Holds::Time;
    let (bare, named): (Vec<usize>, Vec<usize>) =
        (0..titles.len()).filter(is_time).partition(|at| is_bare(&titles[*at]));
    if !named.is_empty() {
        for at in bare {
            held[at] = Holds::Other;
        }
    }
    held
}

/// Largest number of letters in an index of a symbol.
const LONGEST_INDEX: usize = 3;

/// Whether a name is a letter with indices, such as `f_Ca` or `x_s1`; not `t`, `L_0` or `V_1`,
/// where the indices are numbers.
fn is_symbol(name: &str) -> bool {
    let mut parts = name.split('_');
    let letter = parts.next().is_some_and(|first| first.chars().count() == 1);
    letter && parts.any(|index| index.starts_with(char::is_alphabetic))
}

/// Names of numbers of frames.
const FRAMES: [&str; 14] = [
    "frame",
    "frames",
    "frame number",
    "frame no",
    "frame index",
    "frame #",
    "image",
    "slice",
    "index",
    "#",
    "sample",
    "point",
    "stack",
    "nd t",
];

/// Names of times.
const TIMES: [&str; 8] =
    ["time", "t", "times", "zeit", "elapsed time", "time point", "timestamp", "time stamp"];

/// Names of what a row is of.
const IDENTITIES: [&str; 10] = [
    "sarc id",
    "sarcomere id",
    "cell id",
    "cell",
    "roi",
    "roi id",
    "id",
    "track",
    "track id",
    "particle",
];

/// Words of stimuli and other marks.
const MARKS: [&str; 9] =
    ["mark", "marks", "marker", "event", "events", "pacer", "stim", "stimulus", "ttl"];

/// Parts of names of what is read from a curve and is none: the rate or the time of a quantity; a width is not a length.
const READ_FROM_CURVES: [&str; 11] = [
    "speed",
    "velocity",
    "rate",
    "d/dt",
    "derivative",
    "width",
    "angle",
    "area",
    "energy",
    "work",
    "shortening time",
];

/// Words of calcium.
const CALCIUM: [&str; 10] =
    ["ca", "cai", "ca2+", "[ca2+]", "[ca2+]i", "[ca]i", "[ca]", "ca2+i", "cai2+", "catransient"];

/// Parts of names of a dye's brightness.
const BRIGHT: [&str; 20] = [
    "f/f0",
    "df/f",
    "δf/f",
    "∆f/f",
    "fluo",
    "intensity",
    "gcamp",
    "geco",
    "rhod",
    "cal 520",
    "mean grey",
    "mean gray",
    "gray value",
    "grey value",
    "df f0",
    "dff0",
    "fitc",
    "tritc",
    "gfp",
    "cal520",
];

/// Parts of names of a motion.
const MOTIONS: [&str; 6] =
    ["contraction", "displacement", "motion", "amplitude", "movement", "deflection"];

/// A name in lower case without marks, and its words.
struct Name<'a> {
    title: &'a Title,
    text: String,
    words: Vec<String>,
}

impl<'a> Name<'a> {
    fn of(title: &'a Title) -> Self {
        // Text in brackets that is not a unit, such as the name of a dye, is used like the name.
        let known = title.unit.is_empty() || unit(&title.unit).is_some();
        let whole =
            if known { title.name.clone() } else { format!("{} {}", title.name, title.unit) };
        let name = whole.to_lowercase().replace(['_', '-', '.'], " ");
        let mut words: Vec<String> = name.split_whitespace().map(str::to_owned).collect();
        // A letter with indices, such as `f_Ca_f` or `h_L`, is a symbol of a model: its indices do
        // not mean calcium or length.
        if is_symbol(&whole) {
            words.retain(|word| word.len() > LONGEST_INDEX);
        }
        Self { title, text: name.trim().to_owned(), words }
    }

    /// Whether it is one of these names.
    fn is(&self, names: &[&str]) -> bool {
        names.contains(&self.text.as_str())
    }

    /// Whether it contains one of these texts.
    fn has(&self, parts: &[&str]) -> bool {
        parts.iter().any(|part| self.text.contains(part))
    }

    /// Whether one of its words is one of these.
    fn word(&self, ones: &[&str]) -> bool {
        self.words.iter().any(|word| ones.contains(&word.as_str()))
    }

    /// Whether its unit is one of this quantity.
    fn is_in(&self, dimension: Dimension) -> bool {
        units::parse(&format!("1 {}", self.title.unit), dimension).is_ok()
    }

    fn is_time(&self) -> bool {
        let words: Vec<&str> = self.words.iter().map(String::as_str).collect();
        // `Time 0`, `Time 1`: one column of times per channel.
        let numbered = matches!(words[..], ["time", number] if number.parse::<u32>().is_ok());
        let of_time = self.is_in(Dimension::Time);
        let named = words.first() == Some(&"time") && !self.word(&["to", "of", "constant"]);
        self.is(&TIMES) || numbered || of_time && (named || unit(&self.title.name).is_some())
    }

    /// The kind of the curve that a column with this name contains.
    fn kind(&self) -> Option<Kind> {
        let unit = self.title.unit.as_str();
        if self.word(&["fs"]) || self.has(&["shortening"]) {
            return Some(match unit {
                "um" | "px" | "nm" | "mm" | "a.u." => Kind::Contraction,
                _ => Kind::Shortening,
            });
        }
        self.length().or_else(|| self.calcium()).or_else(|| {
            if self.has(&["force"]) || unit == NEWTON {
                Some(Kind::Force)
            } else if self.has(&["moment"]) {
                Some(Kind::Moment)
            } else if self.has(&["tension", "stress"])
                || self.word(&["ta"]) && self.is_in(Dimension::Pressure)
            {
                Some(Kind::Tension)
            } else if self.has(&["potential", "voltage"]) || self.word(&["vm", "em", "v", "mv"]) {
                Some(Kind::Potential)
            } else if self.has(&MOTIONS) {
                Some(Kind::Contraction)
            } else {
                // A trace with a general name, such as `Trace #1 (mV)`, is recognised by a unit that
                // only potentials have.
                (unit == "mV").then_some(Kind::Potential)
            }
        })
    }

    /// The kind of a length, if it is one.
    fn length(&self) -> Option<Kind> {
        if self.has(&["stretch", "lambda", "λ"]) || self.is(&["l/l0", "l/lmax"]) {
            return Some(Kind::NormalisedLength);
        }
        let unit = self.title.unit.as_str();
        let sarcomere = self.has(&["sarc"]) || self.word(&["sl", "ssl", "zdisc"]);
        if !(sarcomere || self.has(&["length"]) || self.word(&["len", "l", "länge"])) {
            None
        } else if self.has(&["norm", "relative"]) || unit == "%" || unit.starts_with("norm") {
            Some(Kind::NormalisedLength)
        } else if sarcomere {
            Some(Kind::SarcomereLength)
        } else {
            Some(Kind::Length)
        }
    }

    /// The kind of a signal of calcium, if it is one.
    fn calcium(&self) -> Option<Kind> {
        if self.has(&["ratio", "340/380", "340:380", "fura", "indo"]) {
            return Some(Kind::CalciumRatio);
        }
        let calcium = self.word(&CALCIUM) || self.has(&["calcium", "[ca"]);
        if calcium && !matches!(self.title.unit.as_str(), "" | "a.u." | "%") {
            return Some(Kind::Calcium);
        }
        // `Mean`, `Mean1`: mean values of regions in ImageJ.
        let mean = self
            .text
            .strip_prefix("mean")
            .is_some_and(|of| of.parse::<u32>().is_ok() || of.is_empty());
        (calcium || mean || self.has(&BRIGHT)).then_some(Kind::Fluorescence)
    }
}

/// Returns what a column contains by its name alone, without regard to its unit.
fn by_name(title: &Title) -> Holds {
    let name = Name::of(title);
    if name.is(&FRAMES) {
        Holds::Frame
    } else if name.word(&["time", "times"]) && name.word(&MARKS) {
        Holds::MarkTime
    } else if name.is_time() {
        Holds::Time
    } else if name.is(&IDENTITIES) {
        Holds::Identity
    } else if name.has(&READ_FROM_CURVES) {
        Holds::Other
    } else {
        name.kind().map_or(Holds::Other, Holds::Curve)
    }
}

/// Conversion from the numbers of a column to the values of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    pub(super) kind: Kind,
    pub(super) factor: f64,
    pub(super) unit: &'static str,
}

/// Returns the conversion from numbers of this kind and unit to values of a curve. `pixel_um` is
/// the pixel size in um.
pub(super) fn scale(kind: Kind, unit: &str, pixel_um: Option<f64>) -> Result<Scale, String> {
    let fixed = |kind, factor, unit| Ok(Scale { kind, factor, unit });
    let of = |dimension: Dimension, written: &'static str| {
        let factor =
            units::parse(&format!("1 {unit}"), dimension).map_err(|error| error.to_string());
        factor.map(|factor| Scale { kind, factor, unit: written })
    };
    let pixels = |kind| match pixel_um {
        Some(size) => fixed(kind, size, "um"),
        None => fixed(kind, 1.0, "px"),
    };
    match kind {
        Kind::Length | Kind::SarcomereLength => match unit {
            "px" => pixels(kind),
            "" if pixel_um.is_some() => pixels(kind),
            "" => fixed(kind, 1.0, "um"),
            "a.u." => fixed(kind, 1.0, "a.u."),
            _ => of(Dimension::Length, "um"),
        },
        Kind::NormalisedLength => match unit {
            "%" => fixed(kind, 0.01, ""),
            _ => fixed(kind, 1.0, ""),
        },
        Kind::Shortening => match unit {
            "" | "%" => fixed(kind, 1.0, "%"),
            _ => Err(format!(
                "a shortening is a percentage of a length, not in `{unit}`; give %, or --kind contraction for a distance"
            )),
        },
        Kind::Contraction => match unit {
            "px" => pixels(kind),
            "%" => fixed(kind, 1.0, "%"),
            _ => of(Dimension::Length, "um").or_else(|_| fixed(kind, 1.0, "a.u.")),
        },
        Kind::Force if matches!(unit, "" | "a.u.") => fixed(kind, 1.0, "a.u."),
        Kind::Force if unit == NEWTON => fixed(kind, 1e9, "nN"),
        Kind::Force => of(Dimension::Force, "nN"),
        Kind::Moment if matches!(unit, "" | "a.u.") => fixed(kind, 1.0, "a.u."),
        Kind::Moment => of(Dimension::Energy, "fJ"),
        Kind::Tension if matches!(unit, "" | "a.u.") => fixed(kind, 1.0, "a.u."),
        Kind::Tension => of(Dimension::Pressure, "kPa"),
        Kind::Calcium if matches!(unit, "" | "a.u.") => fixed(Kind::Fluorescence, 1.0, "a.u."),
        Kind::Calcium => of(Dimension::Concentration, "uM"),
        Kind::CalciumRatio => fixed(kind, 1.0, ""),
        Kind::Potential if matches!(unit, "" | "a.u.") => fixed(kind, 1.0, "a.u."),
        Kind::Potential => of(Dimension::Voltage, "mV"),
        Kind::Fluorescence | Kind::Unknown => fixed(kind, 1.0, "a.u."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::too_many_lines, reason = "a table")]
    fn columns_are_known_by_their_names_in_any_form() {
        use Holds::{Contradicts, Curve, Frame, Identity, MarkTime, Other, Time};
        for (header, held, unit) in [
            ("time (ms)", Time, "ms"),
            ("Time [s]", Time, "s"),
            ("t_ms", Time, "ms"),
            ("Time (sec)", Time, "s"),
            ("Sec", Time, "s"),
            ("Time", Time, ""),
            ("frame", Frame, ""),
            ("sarc_id", Identity, ""),
            ("length_um", Curve(Kind::Length), "um"),
            ("Length (µm)", Curve(Kind::Length), "um"),
            ("Cell length [microns]", Curve(Kind::Length), "um"),
            ("length_px", Curve(Kind::Length), "px"),
            ("Sarc Length (um)", Curve(Kind::SarcomereLength), "um"),
            ("Sarcomere Length/µm", Curve(Kind::SarcomereLength), "um"),
            ("sarcomere_um", Curve(Kind::SarcomereLength), "um"),
            ("mean_norm_sarc_len", Curve(Kind::NormalisedLength), ""),
            ("stretch_1", Curve(Kind::NormalisedLength), ""),
            ("lambda1", Curve(Kind::NormalisedLength), ""),
            ("shortening_pct", Curve(Kind::Shortening), "%"),
            ("Fractional shortening (%)", Curve(Kind::Shortening), "%"),
            ("Shortening (um)", Curve(Kind::Contraction), "um"),
            ("Contraction (a.u.)", Curve(Kind::Contraction), "a.u."),
            ("displacement [um]", Curve(Kind::Contraction), "um"),
            ("Speed of contraction (a.u.)", Other, "a.u."),
            ("width_um", Other, "um"),
            ("force_nN", Curve(Kind::Force), "nN"),
            // The columns of `traction.csv`.
            ("traction_force_nN", Curve(Kind::Force), "nN"),
            ("axial_force_nN", Curve(Kind::Force), "nN"),
            ("Traction force (\u{b5}N)", Curve(Kind::Force), "uN"),
            ("contractile_moment_fJ", Curve(Kind::Moment), "fJ"),
            ("Contractile moment [pJ]", Curve(Kind::Moment), "pJ"),
            ("gel_energy_fJ", Other, "fJ"),
            ("noise_floor_nN", Other, "nN"),
            ("axial_noise_floor_nN", Other, "nN"),
            ("moment (ms)", Contradicts(Kind::Moment), "ms"),
            ("ta_kPa", Curve(Kind::Tension), "kPa"),
            ("Stress (mN/mm2)", Curve(Kind::Tension), "mN/mm^2"),
            ("Ca_nM", Curve(Kind::Calcium), "nM"),
            ("[Ca2+]i [nM]", Curve(Kind::Calcium), "nM"),
            ("Ca_i_uM", Curve(Kind::Calcium), "uM"),
            ("calcium (mM)", Curve(Kind::Calcium), "mM"),
            ("Ca2+", Curve(Kind::Fluorescence), ""),
            ("F/F0", Curve(Kind::Fluorescence), ""),
            ("Ratio", Curve(Kind::CalciumRatio), ""),
            ("Ratio 340/380", Curve(Kind::CalciumRatio), ""),
            ("Vm (mV)", Curve(Kind::Potential), "mV"),
            ("vm_mV", Curve(Kind::Potential), "mV"),
            ("Time 0", Time, ""),
            ("Mark Time", MarkTime, ""),
            ("Time to peak (ms)", Other, "ms"),
            ("ND.T", Frame, ""),
            ("ND.Z", Other, ""),
            ("#1 (  FITC    )", Curve(Kind::Fluorescence), "FITC"),
            ("Mean2", Curve(Kind::Fluorescence), ""),
            ("Trace #1 (mV)", Curve(Kind::Potential), "mV"),
            ("Trace #1 (pA)", Other, "pA"),
            ("Ftot [N]", Curve(Kind::Force), "N"),
            ("sarc.Sarc Const", Curve(Kind::SarcomereLength), ""),
            ("cell 1", Other, ""),
            ("elastic_energy_fJ", Other, "fJ"),
            // Units of one letter, where the name agrees; else they are part of it.
            ("time_s", Time, "s"),
            ("length_m", Curve(Kind::Length), "m"),
            ("Vm_V", Curve(Kind::Potential), "V"),
            ("force_N", Curve(Kind::Force), "N"),
            ("Ca_M", Curve(Kind::Calcium), "M"),
            ("f_Ca_s", Other, ""),
            ("length_s", Curve(Kind::Length), ""),
            ("zeta_s", Other, ""),
            // Symbols of models.
            ("f_Ca_f", Other, ""),
            ("j_Ca", Other, ""),
            ("h_L_p", Other, ""),
            ("I_Ca_pA", Other, ""),
            ("I_CaL_A_per_F", Other, "A/F"),
            ("J_rel_mM_per_ms", Other, "mM/ms"),
            ("Ca_i", Curve(Kind::Fluorescence), ""),
            ("L_0", Curve(Kind::Length), ""),
            // Units of something else.
            ("length (s)", Contradicts(Kind::Length), "s"),
            ("calcium_ms", Contradicts(Kind::Calcium), "ms"),
        ] {
            let title = title(header);
            assert_eq!((holds(&title), title.unit.as_str()), (held, unit), "{header}: {title:?}");
        }
    }
}
