//! Settings: everything that a user may choose, one row each, and the resulting [`Run`].
//!
//! A row ([`Setting`]) has the key, the allowed values, a description, the option on the command
//! line, and how it is read from and written to a run. Run files, their JSON Schema and template,
//! the program's options and help, and the run files written with results come from this one table.
//! To add a setting, add a row in `settings/rows/`, and the field of [`Run`] that it sets.
//!
//! # Example
//! ```
//! use myospring::settings;
//!
//! // Every setting with its unit and bounds, such as a form on a page would show it.
//! for setting in settings::table().filter(|setting| setting.key.starts_with("material.")) {
//!     let bounds = setting.bounds_in_words().unwrap_or_default();
//!     println!("{}: {} {bounds} {:?}", setting.key, setting.doc, setting.default());
//! }
//! let thickness = settings::find("material.thickness").unwrap();
//! assert_eq!(thickness.unit(), Some("um"));
//! assert_eq!(thickness.bounds_in_words().unwrap(), "above 0 um, at most 5000 um");
//! assert_eq!(thickness.default(), Some("10 um".into()));
//! ```

mod adhesion;
mod bounds;
mod calcium;
mod conductivity;
mod content;
mod fibres;
mod models;
mod number;
mod overlay;
mod places;
mod problem;
mod rows;
mod run;
mod sarcomeres;
mod setting;
mod shape;
mod shown;
mod steady;
mod tension;
mod tissue;
mod toml_text;
mod value;
mod words;

pub use adhesion::{ADHESION_ENDINGS, AdhesionError};
pub use bounds::{Bounds, Whole};
pub use calcium::{CALCIUM_ENDINGS, CalciumError, Calibration};
pub use conductivity::{CONDUCTIVITY_ENDINGS, ConductivityError};
pub use content::{CONTENT_ENDINGS, ContentError};
pub use fibres::{
    Asked, FibreDirection, FibreReport, Fibres, FibresError, NotRead, PictureFibres, SeenReport,
};
pub use models::{FromFile, Models};
pub use number::{NumberError, NumericSetting};
pub use overlay::OverlayError;
pub use places::{FromPlaces, PlacesError};
pub use problem::{Failure, Problem};
pub use rows::Table;
pub use run::{DrivenError, MakeError, MeshedRun, Places, Run};
pub use sarcomeres::{SARCOMERE_ENDINGS, SarcomereError};
pub use setting::{CommandOption, Get, Named, Set, Setting, ValueKind};
pub use shape::{
    Meshed, OUTLINE_ENDINGS, PICTURE_ENDINGS, PictureSource, STACK_ENDINGS, Shape, ShapeBytes,
    ShapeError, Shaped, Source,
};
pub use shown::{Shown, StackCell};
pub use steady::CacheError;
pub use tension::{TENSION_ENDINGS, TensionError};
pub use tissue::{Conducts, TissueSettings};
pub use toml_text::read_toml;
pub use value::Value;
pub use words::Word;

/// All settings, table by table.
pub fn tables() -> &'static [Table] {
    rows::TABLES
}

/// All settings, in the order in which they are shown and applied to a run.
pub fn table() -> impl Iterator<Item = &'static Setting> {
    tables().iter().flat_map(|table| table.settings)
}

/// The setting with this key, if there is one.
///
/// # Example
/// ```
/// use myospring::settings;
/// assert!(settings::find("shape.spacing").is_some());
/// assert!(settings::find("spacing").is_none());
/// ```
pub fn find(key: &str) -> Option<&'static Setting> {
    table().find(|setting| setting.key == key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashSet;

    /// A run in which a setting has a place: some are of a picture, of one support, or of a pulse.
    fn run_with_place(setting: &Setting) -> Run {
        let mut run = Run::default_run();
        let before: &[(&str, &str)] = match setting.key {
            "cell.step" => &[("cell.integrator", "runge-kutta-4")],
            "stimulus.duration" => &[("stimulus.kind", "pulse")],
            "shape.pixel_size" | "shape.label" | "shape.any_size" => {
                &[("shape.picture", "cell.tif")]
            }
            "shape.z_step" | "shape.first_slice" | "shape.stack_stain" => {
                &[("shape.stack", "cell.tif")]
            }
            "material.poisson_ratio" | "mechanics.helix_angle" => &[("shape.profile", "slab")],
            "mechanics.stain" | "mechanics.fibre_smoothing" => &[("mechanics.fibre", "picture")],
            "mechanics.end_stiffness" => &[("mechanics.support", "spring-held-ends")],
            "mechanics.afterload" => &[("mechanics.support", "afterloaded-ends")],
            "mechanics.bed_stiffness" => &[("mechanics.support", "elastic-bed")],
            "mechanics.gel_modulus"
            | "mechanics.gel_poisson"
            | "mechanics.gel_thickness"
            | "mechanics.adhesion"
            | "mechanics.adhesion_stiffness" => &[("mechanics.support", "gel")],
            key if key.starts_with("mechanics.post_") => &[("mechanics.support", "posts")],
            key if key.starts_with("segmentation.") => &[("shape.picture", "cell.tif")],
            _ => &[],
        };
        for (key, value) in before {
            find(key).unwrap().set(&mut run, &(*value).into()).unwrap();
        }
        run
    }

    /// What a run has after a setting was put into it.
    fn round(setting: &Setting, value: &Value) -> Option<Value> {
        let mut run = run_with_place(setting);
        setting.set(&mut run, value).unwrap_or_else(|(key, problem)| panic!("{key}: {problem}"));
        setting.get(&run)
    }

    #[test]
    fn every_setting_is_explained_in_its_own_table_under_a_key_and_an_option_of_its_own() {
        let (mut keys, mut options) = (HashSet::new(), HashSet::new());
        for table in tables() {
            for setting in table.settings {
                let key = setting.key;
                assert!(keys.insert(key), "{key} twice");
                assert_eq!(key.rsplit_once('.').map_or("", |(table, _)| table), table.name);
                assert!(setting.doc.ends_with('.'), "{key}: {}", setting.doc);
                let Some(option) = setting.option else { continue };
                for name in [Some(option.name), option.alias].into_iter().flatten() {
                    assert!(options.insert(name), "{name} twice");
                }
                // Who knows the key knows the option.
                assert_eq!(option.name, format!("--{}", setting.name().replace('_', "-")));
                assert_eq!(option.value.is_empty(), matches!(setting.kind, ValueKind::Flag { .. }));
            }
        }
        assert!(keys.len() > 50);
    }

    #[test]
    fn every_default_and_every_example_is_within_the_bounds_and_comes_back() {
        for setting in table() {
            for value in setting.default().into_iter().chain(setting.example()) {
                let back = match setting.key {
                    // It stands for a method and a step, which come back instead.
                    "cell.authors_step" => None,
                    // A parameter comes back as a number in its own unit.
                    "cell.parameters" => {
                        Some(Value::Named([("tau_si".to_owned(), 1.9.into())].into()))
                    }
                    _ => Some(value.clone()),
                };
                assert_eq!(round(setting, &value), back, "{}", setting.key);
            }
        }
    }

    #[test]
    fn the_areas_that_are_expected_are_stated_as_they_are() {
        use crate::microscopy::report::USUAL_AREAS_UM2;
        for (key, area) in ["min", "max"].into_iter().zip(USUAL_AREAS_UM2) {
            let setting = find(&format!("segmentation.{key}_area")).unwrap();
            let stated = crate::units::format(area, crate::units::Dimension::Area);
            assert_eq!(setting.otherwise, Some(format!("\"{stated}\"").as_str()));
        }
    }

    #[test]
    fn every_word_comes_back() {
        for setting in table() {
            for word in setting.words() {
                // Two names of one method: the shorter comes back.
                let back = if word.name == "stoermer-verlet" { "verlet" } else { word.name };
                assert_eq!(round(setting, &word.name.into()), Some(back.into()), "{}", setting.key);
            }
        }
    }

    proptest! {
        #[test]
        fn every_number_within_its_bounds_comes_back_and_every_other_is_refused(
            share in 0.0..=1.0_f64, beyond in 1e-9..1e6_f64,
        ) {
            for setting in table() {
                match setting.kind {
                    ValueKind::Quantity { bounds, .. } => {
                        let Bounds { dimension, minimum, maximum, .. } = bounds;
                        let number = minimum * (1.0 - share) + maximum * share;
                        let value = bounds.write(number);
                        if bounds.contains(number) {
                            prop_assert_eq!(round(setting, &value), Some(value), "{}", setting.key);
                        }
                        for outside in [minimum - beyond, maximum + beyond] {
                            if outside.is_finite() && !bounds.contains(outside) {
                                let value = crate::units::format(outside, dimension).into();
                                let set = setting.set(&mut run_with_place(setting), &value);
                                prop_assert!(
                                    matches!(set, Err((_, Problem::OutOfBounds { .. }))),
                                    "{}: {:?}", setting.key, value
                                );
                            }
                        }
                    }
                    ValueKind::Whole { bounds: Whole { minimum, maximum, .. }, .. } => {
                        let [low, high] = [minimum, maximum].map(i64::from);
                        let number = low + ((high - low) as f64 * share) as i64;
                        let value = Value::Whole(number);
                        prop_assert_eq!(round(setting, &value), Some(value), "{}", setting.key);
                        for outside in [low - 1 - beyond as i64, high + 1 + beyond as i64] {
                            prop_assert!(setting.accept(outside.into()).is_err(), "{}", setting.key);
                        }
                    }
                    _ => {}
                }
            }
        }
    }
}
