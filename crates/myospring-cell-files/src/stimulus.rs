//! The stimulus of a file: its variable, its sign, and the pulse that it states.

use crate::draft::{Draft, Kind, Problem};
use crate::emit::{Emission, Item, StimulusAt};
use crate::roles::{named, states_of, tagged};
use crate::unit::Unit;
use myospring_core::cell::equations::{DefaultStimulus, Found};

const NAMES: [&str; 20] = [
    "i_stim",
    "istim",
    "i_st",
    "i_stimulus",
    "istimulus",
    "i_app",
    "iapp",
    "ist",
    "stim",
    "stimulus",
    "i_ext",
    "iext",
    "i_inj",
    "stimcurrent",
    "stim_current",
    "ist_tot",
    "i_stim_current",
    "j_stim",
    "jstim",
    "i_stimapp",
];

/// What was found.
pub(crate) struct FoundStimulus {
    pub(crate) at: StimulusAt,
    pub(crate) default: DefaultStimulus,
    pub(crate) found: Found,
}

/// Finds the stimulus; `states` are the values at the start, `potential` the state that it changes.
pub(crate) fn find(
    draft: &Draft,
    choice: Option<usize>,
    states: &[f64],
    potential: usize,
) -> Result<FoundStimulus, Problem> {
    let candidate = choice.map(|index| (index, Found::User)).or_else(|| candidate(draft));
    if let Some((index, found)) = candidate {
        let weight = weight(draft, StimulusAt::Variable(index, true), states, potential)?;
        if weight != 0.0 && weight.is_finite() {
            let default = default(draft, index, states, (weight, potential))?;
            return Ok(FoundStimulus {
                at: StimulusAt::Variable(index, weight > 0.0),
                default,
                found,
            });
        }
        if found == Found::User {
            let variable = &draft.variables[index];
            let reason = format!(
                "{} was chosen as stimulus, but it does not change the rate of {}",
                variable.name, draft.variables[potential].name
            );
            return Err(Problem::of(variable, reason));
        }
    }
    Ok(FoundStimulus {
        at: StimulusAt::Rate(potential),
        default: assumed(draft, potential, 1.0),
        found: Found::Reason(
            "no stimulus in the file: it is added to the rate of the potential".to_owned(),
        ),
    })
}

fn candidate(draft: &Draft) -> Option<(usize, Found)> {
    let is_current = |index: usize| {
        draft.variables[index].unit.is_some_and(|unit| {
            [Unit::AMPERE, Unit::AMPERE_PER_FARAD, Unit::AMPERE_PER_AREA]
                .iter()
                .any(|&current| unit.same_dimension(current))
        })
    };
    // Sinoatrial cells have a sustained inward current of the same name.
    let is_applied = |index: usize| states_of(draft, index).is_empty();
    let annotated =
        |tag: &str| tagged(draft, tag).map(|index| (index, Found::Annotation(tag.to_owned())));
    annotated("oxmeta membrane_stimulus_current")
        .or_else(|| annotated("label stimulus_current"))
        .or_else(|| paced(draft, &is_current))
        .or_else(|| {
            named(draft, &NAMES, &|index| is_current(index) && is_applied(index))
                .map(|index| (index, Found::Name))
        })
        .or_else(|| named(draft, &NAMES, &is_applied).map(|index| (index, Found::Name)))
}

/// The current that the variable bound to pacing makes, or that variable itself.
fn paced(draft: &Draft, is_current: &dyn Fn(usize) -> bool) -> Option<(usize, Found)> {
    let pace = tagged(draft, "bind pace")?;
    let found = || Found::Annotation("bind pace".to_owned());
    let uses = |index: usize| {
        let Kind::Value(root) = draft.variables[index].kind else { return false };
        let mut seen = vec![false; draft.terms.0.len()];
        draft
            .operands_first(root, &mut seen)
            .iter()
            .any(|&id| draft.terms.0[id] == crate::draft::Term::Variable(pace))
    };
    let users: Vec<usize> =
        (0..draft.variables.len()).filter(|&index| index != pace && uses(index)).collect();
    let is_named =
        |&&index: &&usize| draft.variables[index].short().to_ascii_lowercase().contains("st");
    let user = users
        .iter()
        .find(|&&index| is_current(index))
        .or_else(|| users.iter().find(is_named))
        .copied();
    Some((user.unwrap_or(pace), found()))
}

/// The derivative of the potential's rate by the stimulus.
fn weight(draft: &Draft, at: StimulusAt, states: &[f64], potential: usize) -> Result<f64, Problem> {
    let mut emission = Emission::new(draft, at, &|_| true);
    let rate = emission.rate_per_ms(potential)?;
    let of = |stimulus| emission.values(states, 0.0, stimulus)[rate.index()];
    Ok(of(1.0) - of(0.0))
}

/// A pulse for files that state none: it moves the potential by 40 mV within 1 ms.
fn assumed(draft: &Draft, potential: usize, weight: f64) -> DefaultStimulus {
    let unit = draft.variables[potential].unit;
    let volts = unit.and_then(|unit| unit.in_units_of(Unit::VOLT));
    let jump = volts.map_or(0.5, |volts| 0.04 / volts);
    DefaultStimulus {
        amplitude: jump / weight.abs(),
        duration_ms: 1.0,
        period_ms: None,
        found: Found::Reason("assumed: the file states no usable pulse".to_owned()),
    }
}

fn default(
    draft: &Draft,
    index: usize,
    states: &[f64],
    (weight, potential): (f64, usize),
) -> Result<DefaultStimulus, Problem> {
    let of_protocol = protocol_pulse(draft, index, states)?;
    let found = match of_protocol {
        Some(pulse) => Some(pulse),
        None => timed_pulse(draft, index, states)?,
    };
    let signed = found
        .map(|pulse| DefaultStimulus { amplitude: pulse.amplitude * weight.signum(), ..pulse });
    let volts = draft.variables[potential].unit.and_then(|unit| unit.in_units_of(Unit::VOLT));
    // 10 V/ms is a mistake of the file: no cell is stimulated so.
    let is_plausible = |pulse: &DefaultStimulus| {
        volts.is_none_or(|volts| pulse.amplitude * weight.abs() * volts < 10.0)
    };
    let usual = signed.filter(|pulse| pulse.amplitude > 0.0 && is_plausible(pulse));
    Ok(usual.unwrap_or_else(|| assumed(draft, potential, weight)))
}

/// The pulse of a `.mmt` file: the level of its protocol, through the variable bound to pacing.
fn protocol_pulse(
    draft: &Draft,
    index: usize,
    states: &[f64],
) -> Result<Option<DefaultStimulus>, Problem> {
    let (Some(pulse), Some(pace)) = (draft.protocol, tagged(draft, "bind pace")) else {
        return Ok(None);
    };
    let at = |level: f64| -> Result<f64, Problem> {
        if index == pace {
            return Ok(level);
        }
        let mut emission = Emission::new(draft, StimulusAt::Variable(pace, true), &|_| true);
        emission.add(Item::Value(index))?;
        let values = emission.values(states, 0.0, level);
        let own = emission.intermediates.iter().find(|&&(own, _)| own == index);
        Ok(own.map_or(0.0, |&(_, place)| values[place.index()]))
    };
    let amplitude = at(pulse.level)? - at(0.0)?;
    Ok(Some(DefaultStimulus {
        amplitude,
        duration_ms: pulse.duration * draft.milliseconds,
        period_ms: pulse.period.map(|period| period * draft.milliseconds),
        found: Found::Annotation("protocol of the file".to_owned()),
    }))
}

/// Until when a pulse is looked for, ms.
const LATEST_MS: f64 = 12_000.0;

/// How long a pulse must be to be seen, ms.
const SHORTEST_MS: f64 = 0.1;

/// The pulse of a stimulus that is a function of time.
fn timed_pulse(
    draft: &Draft,
    index: usize,
    states: &[f64],
) -> Result<Option<DefaultStimulus>, Problem> {
    let mut emission = Emission::new(draft, StimulusAt::Nowhere, &|_| true);
    emission.add(Item::Value(index))?;
    let own = emission.intermediates.iter().find(|&&(own, _)| own == index);
    let Some(&(_, place)) = own else { return Ok(None) };
    if emission.nodes.len() > 2000 {
        return Ok(None);
    }
    let at = |time: f64| emission.values(states, time, 0.0)[place.index()];
    let is_on = |time: f64| at(time) != 0.0;
    let edge = |mut before: f64, mut after: f64| {
        let wanted = is_on(after);
        for _ in 0..60 {
            let middle = f64::midpoint(before, after);
            if is_on(middle) == wanted { after = middle } else { before = middle }
        }
        after
    };
    let step = SHORTEST_MS / 2.0;
    let mut edges = Vec::new();
    let mut last = is_on(0.0);
    if last {
        edges.push(0.0);
    }
    let mut time = 0.0;
    while time < LATEST_MS && edges.len() < 3 {
        let now = is_on(time + step);
        if now != last {
            edges.push(edge(time, time + step));
        }
        (last, time) = (now, time + step);
    }
    let &[start, end, ..] = edges.as_slice() else { return Ok(None) };
    let tidy = |time: f64| (time * 1e6).round() / 1e6;
    let amplitude = at(f64::midpoint(start, end));
    Ok(amplitude.is_finite().then(|| DefaultStimulus {
        amplitude,
        duration_ms: tidy(end - start),
        period_ms: edges.get(2).map(|next| tidy(next - start)),
        found: Found::Reason("the pulse of the file's own stimulus".to_owned()),
    }))
}
