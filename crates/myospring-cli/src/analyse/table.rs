//! Options of the command line to those of the library.

use crate::args::{StimulusArgs, TableArgs};
use crate::failure::Failure;
use myospring::experiment::BeatOptions;
use myospring::measured::{Column, Kind, Layout, TableOptions as Table};
use myospring::microscopy::motion::TrackingSettings;
use myospring::units::{self, Dimension};

/// How tables are read; `until` is where the part that counts ends.
pub(crate) fn options(
    args: &TableArgs,
    pixel_size: Option<&str>,
    until: Option<(&'static str, &str)>,
) -> Result<Table, Failure> {
    let kind = args.kind.as_deref().map(|word| {
        Kind::of_word(word).ok_or_else(|| {
            let words: Vec<&str> = Kind::ALL.iter().map(|kind| kind.word()).collect();
            Failure::new(format!("--kind: `{word}` is no kind of curve"))
                .advise(format!("one of {}", words.join(", ")))
        })
    });
    let pixel = pixel_size.map(|text| {
        let size = quantity("--pixel-size", text, Dimension::Length)?;
        if size > 0.0 {
            return Ok(size);
        }
        Err(Failure::new(format!("--pixel-size is {size} um; it must be above 0")))
    });
    let delimiter = args.delimiter.as_deref().map(|word| match word {
        "comma" => ',',
        "semicolon" => ';',
        "tab" => '\t',
        _ => ' ',
    });
    let layout = args.layout.as_deref().map(|word| match word {
        "rows" => Layout::Rows,
        _ => Layout::Columns,
    });
    Ok(Table {
        time: args.time.as_deref().map(Column::of),
        values: args.columns.iter().map(|text| Column::of(text)).collect(),
        kind: kind.transpose()?,
        unit: args.unit.clone(),
        time_unit: args.time_unit.clone(),
        frame_rate_per_s: args.frame_rate.as_deref().map(frame_rate).transpose()?,
        pixel_size_um: pixel.transpose()?,
        sheets: args.sheet.iter().map(|text| Column::of(text)).collect(),
        from_ms: args.from.as_deref().map(|text| time("--from", text)).transpose()?,
        until_ms: until.map(|(option, text)| time(option, text)).transpose()?,
        delimiter,
        decimal: args.decimal.as_deref().map(|word| if word == "comma" { ',' } else { '.' }),
        layout,
        ignore_marks: args.ignore_marks,
        skip_gaps: args.skip_gaps,
        mean: args.mean,
        units_required: false,
    })
}

/// `250`, `250 /s`, `250 Hz`, `250 fps`, frames a second.
pub(crate) fn frame_rate(text: &str) -> Result<f64, Failure> {
    const MOST: f64 = TrackingSettings::HIGHEST_FRAME_RATE;
    let number = text.trim().parse::<f64>();
    // 1/ms to 1/s
    let rate = number.or_else(|_| units::parse(text, Dimension::Rate).map(|rate| 1e3 * rate));
    let wrong = match rate {
        Ok(rate) if rate > 0.0 && rate <= MOST => return Ok(rate),
        Ok(_) => String::new(),
        Err(error) => format!("; {error}"),
    };
    Err(Failure::new(format!(
        "--frame-rate is `{text}`; it must be a number of frames a second above 0, at most {MOST}{wrong}"
    ))
    .advise("give it like --frame-rate 30, as the camera was set"))
}

/// A time with its unit, or a number of ms.
fn time(option: &str, text: &str) -> Result<f64, Failure> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => quantity(option, text, Dimension::Time),
    }
}

pub(crate) fn quantity(option: &str, text: &str, dimension: Dimension) -> Result<f64, Failure> {
    units::parse(text, dimension).map_err(|error| Failure::new(format!("{option}: {error}")))
}

/// How beats are found and read.
pub(crate) fn beats(
    stimuli: &StimulusArgs,
    smooth: Option<&str>,
    keep_drift: bool,
) -> Result<BeatOptions, Failure> {
    let of =
        |option: &'static str, text: Option<&str>| text.map(|text| time(option, text)).transpose();
    let has_unit = |text: &String| text.trim().parse::<f64>().is_err();
    let bare = stimuli.stimulus_times.iter().find(|text| !has_unit(text));
    // `0,1 s` would be 0 ms and 1 s.
    if let Some(bare) = bare.filter(|_| stimuli.stimulus_times.iter().any(has_unit)) {
        return Err(Failure::new(format!(
            "--stimulus-times: `{bare}` has no unit, and others have one"
        ))
        .advise("write each with its unit, decimals with a point: \"100 ms, 1.1 s\""));
    }
    let times = stimuli.stimulus_times.iter().map(|text| time("--stimulus-times", text));
    let beats = BeatOptions {
        stimuli_ms: times.collect::<Result<_, _>>()?,
        period_ms: of("--stimulus-period", stimuli.stimulus_period.as_deref())?,
        start_ms: of("--stimulus-start", stimuli.stimulus_start.as_deref())?,
        smoothing_ms: of("--smooth", smooth)?,
        keep_drift,
    };
    beats.check()?;
    Ok(beats)
}
