//! Run files to start from, in which every number has its source.

/// A run file to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// Name on the command line.
    pub name: &'static str,
    /// One-line description.
    pub about: &'static str,
    /// The run file, with the source of each number beside it.
    pub text: &'static str,
}

/// All presets.
///
/// # Example
/// ```
/// use myospring::run_file::{PRESETS, RunFile};
/// for preset in PRESETS {
///     assert!(RunFile::from_text(preset.text)?.resolve().is_ok(), "{}", preset.name);
/// }
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "adult-human",
        about: "adult human ventricular cell, free, 1 Hz: ToR-ORd with Land's myofilaments",
        text: include_str!("../../presets/adult_human.toml"),
    },
    Preset {
        name: "guinea-pig-unloaded",
        about: "guinea pig ventricular cell, free: 8.1 % shortening",
        text: include_str!("../../presets/guinea_pig_unloaded.toml"),
    },
    Preset {
        name: "rabbit-unloaded",
        about: "rabbit ventricular cell, free: 9.0 % shortening",
        text: include_str!("../../presets/rabbit_unloaded.toml"),
    },
    Preset {
        name: "hipsc-on-gel",
        about: "cardiomyocyte from human stem cells on a gel of 10 kPa: 13.9 nN, peak tension near 0.5 kPa",
        text: include_str!("../../presets/hipsc_on_gel.toml"),
    },
];
