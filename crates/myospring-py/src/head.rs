//! All that a worker needs of a study beside the values of its members, as bytes.

use ciborium::{from_reader, into_writer};
use myospring::run_file::RunFile;
use myospring::settings::NumericSetting;
use myospring::study::parameters::{Common, CountedBeat, MemberKind, ParameterStudy};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

const VERSION: &str = env!("CARGO_PKG_VERSION");

#[derive(Serialize, Deserialize)]
struct Head<'a> {
    version: String,
    kind: MemberKind,
    beat: CountedBeat,
    run_file: String,
    /// Key and unit of each number that varies.
    numbers: Vec<(String, String)>,
    metrics: Vec<String>,
    traces: bool,
    files: Cow<'a, BTreeMap<String, Vec<u8>>>,
}

/// The bytes.
pub(crate) fn write(study: &ParameterStudy, common: &Common) -> Result<Vec<u8>, String> {
    let numbers = study.varied.iter().map(|varied| &varied.number);
    let head = Head {
        version: VERSION.to_owned(),
        kind: study.kind,
        beat: study.beat,
        run_file: study.run.to_toml(),
        numbers: numbers.map(|number| (number.key.clone(), number.unit.clone())).collect(),
        metrics: study.metrics.clone(),
        traces: study.traces,
        files: Cow::Borrowed(common.files()),
    };
    let mut written = Vec::new();
    into_writer(&head, &mut written).map_err(|error| error.to_string())?;
    Ok(written)
}

/// The study, without members, and the files that they need.
pub(crate) fn read(bytes: &[u8]) -> Result<(ParameterStudy, BTreeMap<String, Vec<u8>>), String> {
    let head: Head<'_> = from_reader(bytes).map_err(|error| error.to_string())?;
    let Head { version, kind, beat, run_file, numbers, metrics, traces, files } = head;
    if version != VERSION {
        return Err(format!(
            "this worker has myospring {VERSION}, but the study was begun with {version}; install the same everywhere"
        ));
    }
    let file = RunFile::from_text(&run_file).map_err(|error| error.to_string())?;
    let numbers = numbers.into_iter().map(|(key, unit)| NumericSetting { key, unit }).collect();
    let study = ParameterStudy::of_rows(file, numbers, metrics, Vec::new());
    let study = study.map_err(|error| error.to_string())?;
    Ok((ParameterStudy { kind, beat, traces, ..study }, files.into_owned()))
}
