//! Cache of steady states in files, so that pacing is done only once.
//!
//! A file is named after the model and a hash of its key, which contains everything on which the
//! state depends. The key is also stored in the file and compared. In addition to parameters,
//! pacing and method, it contains the rates of the model in two states and over its course, so that
//! changed equations count as another model. A damaged file is reported and replaced. A file is
//! written under another name and then renamed, so that it is never read incomplete.

use crate::cell::CellModel;
use crate::cell::Input;
use crate::cell::pacing::{Protocol, Stimulus};
use crate::cell::solve::SolverSettings;
use crate::cell::steady::{SteadyError, SteadyState, pace};
use crate::interruption::Interruption;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why there is no steady state.
#[derive(Debug, thiserror::Error)]
pub enum CacheError {
    /// The cell does not become steady.
    #[error(transparent)]
    Steady(#[from] SteadyError),
    /// The folder or its file cannot be written.
    #[error("the steady state cannot be stored in `{path}`: {cause}", path = path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

/// The content of a file.
#[derive(Serialize, Deserialize)]
struct Kept {
    key: String,
    beats: u32,
    change: f64,
    /// The bits of each value, so that a state is restored exactly.
    state: Vec<String>,
    /// Hash of the other fields.
    check: String,
}

impl Kept {
    fn sum(&self) -> String {
        let Self { key, beats, change, state, .. } = self;
        hash(&format!("{key}\n{beats}\n{change:e}\n{}", state.join(" ")))
    }
}

/// Fowler-Noll-Vo hash, 64 bits, the same on every machine.
fn hash(text: &str) -> String {
    let of = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", text.bytes().fold(0xcbf2_9ce4_8422_2325, of))
}

fn bits(values: impl IntoIterator<Item = f64>) -> Vec<String> {
    values.into_iter().map(|value| format!("{:016x}", value.to_bits())).collect()
}

/// Everything that a steady state depends on.
fn key(
    model: &dyn CellModel,
    protocol: Protocol,
    settings: SolverSettings,
    tolerance: f64,
) -> String {
    let parameters = model.parameters().rows().iter();
    let parameters: Vec<String> =
        parameters.map(|row| format!("{}={:e}", row.name, row.value)).collect();
    // The rates in two states, and over the prescribed course after a stimulus.
    let start = model.initial_state();
    let other: Vec<f64> = start.iter().map(|value| 1.01 * value + 1e-3).collect();
    let mut seen = String::new();
    let mut rates = vec![0.0; start.len()];
    for state in [&start, &other] {
        for since in 0..=1000 {
            let input = Input { since_stimulus_ms: f64::from(since), ..Input::REST };
            model.derivatives(state, &input, &mut rates);
            seen = hash(&format!("{seen}{}", bits(rates.iter().copied()).concat()));
        }
    }
    let Protocol { stimulus, start_ms, cycle_length_ms, .. } = protocol;
    let stimulus = match stimulus {
        Stimulus::Jump { amplitude } => format!("jump {amplitude:e}"),
        Stimulus::Pulse { amplitude, duration_ms } => {
            format!("pulse {amplitude:e} {duration_ms:e}")
        }
    };
    let way = if settings.method.chooses_steps() { settings.tolerance } else { settings.step_ms };
    format!(
        "myospring {}; {}; {}; equations {seen}; {stimulus} from {start_ms:e} ms each {cycle_length_ms:e} ms; {} {way:e}; \
         tolerance {tolerance:e}",
        env!("CARGO_PKG_VERSION"),
        model.name(),
        parameters.join(", "),
        settings.method.name(),
    )
}

/// The steady state of a cell model, from the folder if it is stored there, else by pacing, and
/// then stored; with a warning if there is one.
///
/// # Errors
/// A cell that does not become steady, or a folder that cannot be written.
pub(super) fn steady_state(
    model: &Arc<dyn CellModel>,
    protocol: Protocol,
    settings: SolverSettings,
    tolerance: f64,
    folder: Option<&Path>,
    interruption: &Interruption,
) -> Result<(SteadyState, Option<String>), CacheError> {
    let paced = || pace(model, protocol, settings, tolerance, interruption);
    let Some(folder) = folder else { return Ok((paced()?, None)) };
    let key = key(&**model, protocol, settings, tolerance);
    let path = folder.join(format!("{}-{}.json", model.name(), hash(&key)));
    let mut told = None;
    match fs::read(&path) {
        Ok(bytes) => match kept(&bytes, &key, model.states().len()) {
            Ok(found) => return Ok((found, None)),
            Err(why) => {
                let path = path.display();
                told = Some(format!(
                    "the steady state in `{path}` {why}; it was computed and written again"
                ));
            }
        },
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => {}
        Err(cause) => told = Some(format!("`{}` cannot be read: {cause}", path.display())),
    }
    let found = paced()?;
    let (beats, change) = (found.beats, found.change);
    let state = bits(found.state.iter().copied());
    let mut kept = Kept { key, beats, change, state, check: String::new() };
    kept.check = kept.sum();
    let failed = |path: &Path, cause| CacheError::Write { path: path.to_owned(), cause };
    let text = serde_json::to_string_pretty(&kept)
        .map_err(|error| failed(&path, io::Error::other(error)))?;
    fs::create_dir_all(folder).map_err(|cause| failed(folder, cause))?;
    // A unique name for each process and thread, so that concurrent writers do not conflict.
    let unique = format!("{}.{:?}.part", std::process::id(), std::thread::current().id());
    let part = path.with_extension(unique);
    fs::write(&part, text).map_err(|cause| failed(&part, cause))?;
    fs::rename(&part, &path).map_err(|cause| failed(&path, cause))?;
    Ok((found, told))
}

/// The steady state in a file, or why it cannot be used.
fn kept(bytes: &[u8], key: &str, states: usize) -> Result<SteadyState, &'static str> {
    let kept: Kept = serde_json::from_slice(bytes).map_err(|_| "is damaged")?;
    let state: Option<Vec<f64>> = kept
        .state
        .iter()
        .map(|bits| Some(f64::from_bits(u64::from_str_radix(bits, 16).ok()?)))
        .collect();
    let state = state.filter(|state| state.iter().all(|value| value.is_finite()));
    match state {
        Some(state) if kept.sum() == kept.check && state.len() == states => {
            let Kept { beats, change, .. } = kept;
            if kept.key == key {
                Ok(SteadyState { state, beats, change })
            } else {
                Err("is of another cell")
            }
        }
        _ => Err("is damaged"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell;

    fn protocol(model: &Arc<dyn CellModel>, cycle_length_ms: f64) -> Protocol {
        Protocol { cycle_length_ms, ..Protocol::once(model.default_stimulus()) }
    }

    fn changed(model: &Arc<dyn CellModel>, name: &str, factor: f64) -> Arc<dyn CellModel> {
        let mut parameters = model.parameters().clone();
        parameters.set(name, factor * parameters.get(name).unwrap()).unwrap();
        model.with_parameters(parameters).unwrap()
    }

    #[test]
    fn every_change_of_what_it_depends_on_is_another_key() {
        let model = cell::model("coelho_2021").unwrap();
        let (pacing, settings) = (protocol(&model, 600.0), model.usual_settings());
        let mut keys = vec![
            key(&*model, pacing, settings, 1e-3),
            key(&*changed(&model, "tau_si", 1.0 + 1e-12), pacing, settings, 1e-3),
            key(&*model, protocol(&model, 601.0), settings, 1e-3),
            key(&*model, Protocol { start_ms: 51.0, ..pacing }, settings, 1e-3),
            key(
                &*model,
                Protocol { stimulus: Stimulus::Jump { amplitude: 0.3 }, ..pacing },
                settings,
                1e-3,
            ),
            key(&*model, pacing, SolverSettings { tolerance: 1e-6, ..settings }, 1e-3),
            key(&*model, pacing, SolverSettings::default(), 1e-3),
            key(
                &*model,
                pacing,
                SolverSettings { step_ms: 0.01, ..SolverSettings::default() },
                1e-3,
            ),
            key(&*model, pacing, settings, 1e-4),
            key(&*cell::model("bueno_orovio_2008_epi").unwrap(), pacing, settings, 1e-3),
        ];
        let count = keys.len();
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), count);
    }

    #[test]
    fn a_steady_state_is_paced_once_and_comes_back_to_the_bit_unless_its_file_is_damaged() {
        let folder = tempfile::tempdir().unwrap();
        let model = cell::model("coelho_2021").unwrap();
        let (pacing, settings) = (protocol(&model, 600.0), model.usual_settings());
        let find = |model| {
            steady_state(
                model,
                pacing,
                settings,
                1e-3,
                Some(folder.path()),
                &Interruption::default(),
            )
            .unwrap()
        };
        let files = || {
            let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
            names.collect::<Vec<_>>()
        };
        let (first, told) = find(&model);
        assert_eq!((told, files().len()), (None, 1));
        // Something that pacing would not give shows that it was read.
        let path = &files()[0];
        let good = fs::read(path).unwrap();
        let mut other: Kept = serde_json::from_slice(&good).unwrap();
        other.beats = 999;
        other.check = other.sum();
        fs::write(path, serde_json::to_string(&other).unwrap()).unwrap();
        let (second, told) = find(&model);
        assert_eq!((second.beats, second.state.clone(), told), (999, first.state.clone(), None));
        // Another cell has another file.
        let stronger = changed(&model, "tau_si", 1.1);
        let (third, _) = find(&stronger);
        assert!(third.state != first.state && files().len() == 2);
        // Cut, with a digit changed, of another cell, or nothing at all: told, and made anew.
        let text = String::from_utf8(good.clone()).unwrap();
        let digit = text.replacen("\"state\": [\n    \"3", "\"state\": [\n    \"4", 1);
        assert_ne!(digit, text);
        for (bad, why) in [
            (text[..text.len() / 2].to_owned(), "is damaged"),
            (digit, "is damaged"),
            (String::new(), "is damaged"),
            (
                {
                    let mut other: Kept = serde_json::from_slice(&good).unwrap();
                    other.key.push('x');
                    other.check = other.sum();
                    serde_json::to_string(&other).unwrap()
                },
                "is of another cell",
            ),
        ] {
            fs::write(path, bad).unwrap();
            let (found, told) = find(&model);
            let told = told.unwrap();
            assert!(told.contains(why) && told.contains(&path.display().to_string()), "{told}");
            assert_eq!(found, first);
            assert_eq!(fs::read(path).unwrap(), good, "written anew");
        }
    }
}
