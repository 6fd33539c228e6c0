//! Run files to start from, in which every number has its source.

/// A run file to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// Name on the command line.
    pub name: &'static str,
    /// One-line description.
    pub about: &'static str,
    /// The file of a published cell model that it needs beside it, which the user brings.
    pub model_file: Option<&'static str>,
    /// The run file, with the source of each number beside it.
    pub text: &'static str,
}

/// All presets.
///
/// # Example
/// ```
/// use myospring::run_file::{PRESETS, RunFile};
/// for preset in PRESETS {
///     let resolved = RunFile::from_text(preset.text)?.resolve();
///     assert!(resolved.is_ok() || preset.model_file.is_some(), "{}", preset.name);
/// }
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "adult-human",
        about: "adult human ventricular cell, free, 1 Hz: ToR-ORd with Land's myofilaments",
        model_file: None,
        text: include_str!("../../presets/adult_human.toml"),
    },
    Preset {
        name: "guinea-pig-unloaded",
        about: "guinea pig ventricular cell, free: 8.1 % shortening",
        model_file: None,
        text: include_str!("../../presets/guinea_pig_unloaded.toml"),
    },
    Preset {
        name: "rabbit-unloaded",
        about: "rabbit ventricular cell, free: 9.0 % shortening",
        model_file: None,
        text: include_str!("../../presets/rabbit_unloaded.toml"),
    },
    Preset {
        name: "hipsc-on-gel",
        about: "cardiomyocyte from human stem cells on a gel of 10 kPa: 13.9 nN, peak tension near 0.3 kPa",
        model_file: None,
        text: include_str!("../../presets/hipsc_on_gel.toml"),
    },
    Preset {
        name: "hipsc-paci-2020",
        about: "that cell with action potential and calcium of Paci et al. 2020, from your copy of paci-2020.mmt",
        model_file: Some("paci-2020.mmt"),
        text: include_str!("../../presets/hipsc_paci_2020.toml"),
    },
];
