//! The constants of the myofilaments, with their source.

use crate::parameter::{Parameter, ParameterSet};

const LAND: &str =
    "land_2017, intact human tissue, as in the public ToR-ORd-Land code (margara_2021)";
/// Source of the two parameters in which public codes differ.
const FITTED: &str = "public ToR-ORd-Land code (margara_2021); land_2017 and simcardems have";

/// Name, value, unit, smallest and largest, meaning.
type Row = (&'static str, f64, &'static str, [f64; 2], &'static str);

const TABLE: [Row; 17] = [
    ("k_TRPN", 0.1, "1/ms", [1e-4, 10.0], "rate at which calcium leaves troponin"),
    ("n_TRPN", 2.0, "", [0.5, 10.0], "cooperativity of calcium's binding to troponin"),
    ("Ca50_ref", 0.805, "uM", [1e-3, 100.0], "calcium that half fills troponin at resting length"),
    ("k_u", 0.021, "1/ms", [1e-4, 100.0], "rate at which tropomyosin sets binding sites free"),
    ("n_Tm", 2.036, "", [0.1, 20.0], "cooperativity of the thin filament"),
    (
        "TRPN50",
        0.35,
        "",
        [0.01, 0.99],
        "part of troponin with calcium at which half the sites are free",
    ),
    ("k_uw", 0.182, "1/ms", [1e-4, 10.0], "rate from unbound to weakly bound crossbridges"),
    ("k_ws", 0.012, "1/ms", [1e-5, 10.0], "rate from weakly to strongly bound crossbridges"),
    (
        "r_w",
        0.5,
        "",
        [0.01, 0.99],
        "steady part of weakly bound among crossbridges not strongly bound",
    ),
    ("r_s", 0.25, "", [0.01, 0.99], "steady part of strongly bound crossbridges"),
    (
        "gamma_s",
        0.0085,
        "1/ms",
        [0.0, 10.0],
        "rate at which distortion tears strongly bound crossbridges",
    ),
    (
        "gamma_w",
        0.615,
        "1/ms",
        [0.0, 10.0],
        "rate at which distortion tears weakly bound crossbridges",
    ),
    (
        "phi",
        2.23,
        "",
        [0.01, 100.0],
        "how fast distortions decay, in terms of the crossbridges' cycle",
    ),
    ("A_tot", 25.0, "", [0.0, 1000.0], "distortion by a change of length"),
    ("beta_0", 2.3, "", [0.0, 20.0], "how steeply tension follows the overlap of the filaments"),
    ("beta_1", -2.4, "uM", [-20.0, 0.0], "change of Ca50 with stretch"),
    ("T_ref", 120.0, "kPa", [0.0, 1e4], "greatest tension at resting length"),
];

/// The rows of the myofilaments, for a model with further parameters.
pub fn rows() -> Vec<Parameter> {
    let row = |&(name, value, unit, range, meaning): &Row| {
        let source = match name {
            "k_u" => format!("{FITTED} 1 and 0.04"),
            "n_Tm" => format!("{FITTED} 5 and 2.4"),
            _ => LAND.to_owned(),
        };
        Parameter::new(name, value, unit, range, meaning, source)
    };
    TABLE.iter().map(row).collect()
}

/// The 17 parameters of the myofilaments, as in the public ToR-ORd-Land code.
///
/// # Example
/// ```
/// use myospring::cell::land_2017;
/// assert_eq!(land_2017::parameters().get("T_ref"), Some(120.0));
/// ```
pub fn parameters() -> ParameterSet {
    ParameterSet::new(rows())
}
