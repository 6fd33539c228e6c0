//! `[tissue]`.

use super::super::bounds::Bounds;
use super::super::conductivity::{self, CONDUCTIVITY_ENDINGS};
use super::super::run::Run;
use super::super::setting::{Setting, ValueKind};
use super::super::tissue::{Conducts, TissueSettings};
use super::super::words::{Word, Worded, worded};
use crate::exchange::StimulusPlace;
use crate::units::Dimension;

worded! { StimulusPlace {
    StimulusPlace::Everywhere = "everywhere": "All cells.",
    StimulusPlace::End = "end": "The end where the long axis starts.",
    StimulusPlace::Centre = "centre": "A disc in the middle.",
    StimulusPlace::Half = "half": "The half to the right of the long axis, as for a spiral wave by S1 and S2.",
} }

pub(super) const ROWS: &[Setting] = &[
    Setting::quantity(
        "tissue.conduction_velocity",
        "Velocity along the fibres of a wave that goes from cell to cell: with it the shape is a tissue of coupled cells, one at each \
         point of the mesh, instead of one cell. The diffusion of the potential is that which gives this velocity on this mesh with the published parameters of the cell model. \
         Human ventricles have 60 to 70 cm/s, cultures of stem-cell-derived myocytes 5 to 20 cm/s; 10 um/ms are 1 cm/s.",
        Bounds::any(Dimension::Speed, "200 um/ms").from(1.0).to(5000.0),
        |run| match run.tissue.as_ref()?.conducts? {
            Conducts::Velocity(velocity) => Some(velocity),
            Conducts::Diffusion(_) => None,
        },
        |run, velocity| tissue(run).conducts = Some(Conducts::Velocity(velocity)),
    )
    .otherwise("one cell")
    .option_saying(
        "--conduction-velocity",
        "SPEED",
        "Make the shape a tissue of coupled cells in which waves have this velocity along the fibres",
    ),
    Setting::quantity(
        "tissue.diffusion",
        "The same, by the diffusion coefficient of the potential along the fibres; the velocity follows from it, and is smaller on \
         a coarse mesh.",
        Bounds::any(Dimension::Diffusion, "117100 um^2/ms").from(0.0).to(1e8),
        |run| match run.tissue.as_ref()?.conducts? {
            Conducts::Velocity(_) => None,
            Conducts::Diffusion(diffusion) => Some(diffusion),
        },
        |run, diffusion| tissue(run).conducts = Some(Conducts::Diffusion(diffusion)),
    )
    .option_saying(
        "--diffusion",
        "COEFFICIENT",
        "The same, by the diffusion coefficient of the potential along the fibres",
    ),
    Setting::quantity(
        "tissue.velocity_ratio",
        "Conduction velocity along the fibres over that across them.",
        Bounds::any(Dimension::Number, "2.5").from(0.1).to(10.0),
        |run| Some(run.tissue.as_ref()?.velocity_ratio),
        |run, ratio| tissue(run).velocity_ratio = ratio,
    )
    .otherwise("1")
    .option_saying(
        "--velocity-ratio",
        "RATIO",
        "Conduction velocity of a tissue along its fibres over that across them",
    ),
    Setting::new(
        "tissue.conductivity",
        "Where a tissue conducts: \"uniform\", or a file, relative to this one: a table (.csv) with the header conductivity, a row for \
         each triangle, or x_um,y_um,conductivity, where 0 is a scar and 1 conducts as the tissue does, or a picture of the same \
         frame as the tissue's, whose grey values are used relative to the largest. A factor on the diffusion coefficient.",
        ValueKind::File {
            endings: CONDUCTIVITY_ENDINGS,
            words: conductivity::WORDS,
            example: "scar.csv",
            get: |run| {
                let written = run.tissue.as_ref()?.conductivity.clone();
                Some(written.unwrap_or_else(|| conductivity::EVEN.to_owned()))
            },
            set: |run, text| {
                tissue(run).conductivity = (text != conductivity::EVEN).then_some(text);
            },
        },
    )
    .otherwise("uniform")
    .option_saying(
        "--conductivity",
        "WHERE",
        "Where a tissue conducts: uniform, a table (.csv: conductivity, or x_um,y_um,conductivity; 0 is a scar), or a picture of the \
         same frame",
    ),
    Setting::new(
        "tissue.stimulated",
        "What part of a tissue the stimuli reach.",
        ValueKind::Words {
            words: StimulusPlace::WORDS,
            get: |run| Some(run.tissue.as_ref()?.stimulated.word()),
            set: |run, word| {
                tissue(run).stimulated = StimulusPlace::of_word(word)?;
                Some(())
            },
        },
    )
    .otherwise("end")
    .option_saying("--stimulated", "PLACE", "What part of a tissue the stimuli reach"),
    Setting::new(
        "tissue.s2_stimulated",
        "What part of a tissue an extra stimulus S2 reaches.",
        ValueKind::Words {
            words: StimulusPlace::WORDS,
            get: |run| Some(run.tissue.as_ref()?.s2_stimulated?.word()),
            set: |run, word| {
                tissue(run).s2_stimulated = Some(StimulusPlace::of_word(word)?);
                Some(())
            },
        },
    )
    .otherwise("as `stimulated`")
    .option_saying("--s2-stimulated", "PLACE", "What part of a tissue an extra stimulus reaches"),
    Setting::quantity(
        "tissue.stretch_conductance",
        "Mechano-electric feedback: conductance of channels that stretch opens, over the membrane's capacitance. Their current is \
         conductance max(0, stretch - 1) (potential - reversal potential), with the stretch of the fibres relative to rest \
         (Panfilov et al. 2007 take the root of the area's). Around 0.05 mS/uF a wave goes on as before, and a stretched place at rest is \
         nearer to its threshold; 0 is no feedback.",
        Bounds::any(Dimension::ConductanceDensity, "0.05 mS/uF").from(0.0).to(10.0),
        |run| Some(run.tissue.as_ref()?.stretch_current.conductance),
        |run, conductance| tissue(run).stretch_current.conductance = conductance,
    )
    .otherwise("0: no feedback")
    .option_saying(
        "--stretch-conductance",
        "CONDUCTANCE",
        "Let stretch open channels of this conductance in a tissue (mechano-electric feedback)",
    ),
    Setting::quantity(
        "tissue.stretch_reversal",
        "Reversal potential of those channels; measured were 0 to -20 mV (Kohl et al. 1999). A model without millivolts has 1 in the \
         unit of its potential.",
        Bounds::any(Dimension::Voltage, "-10 mV").from(-100.0).to(100.0),
        |run| Some(run.tissue.as_ref()?.stretch_current.reversal_mv),
        |run, reversal_mv| tissue(run).stretch_current.reversal_mv = reversal_mv,
    )
    .option_saying(
        "--stretch-reversal",
        "POTENTIAL",
        "Reversal potential of the channels that stretch opens",
    ),
];

fn tissue(run: &mut Run) -> &mut TissueSettings {
    run.tissue.get_or_insert_default()
}
