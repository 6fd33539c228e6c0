//! Fits of curves whose truth is known.

use myospring::fit::{
    Fit, FitSettings, FitVerdict, Fitter, Loaded, Observed, Scale, Stimuli, Unknown, Verdict,
};
use myospring::integrate::Method;
use myospring::mechanics::gel::Gel;
use myospring::mechanics::material::Stiffness;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::lattice;
use myospring::recording::AXIAL_FORCE;
use myospring::run_file::RunFile;
use myospring::settings::Run;
use myospring::simulation::{Outcome, Simulation};
use myospring::study::sampling::{Distribution, Sampler, sample};

const LENGTH: f64 = 100.0;

fn run(text: &str) -> Run {
    RunFile::from_text(text).unwrap().resolve().unwrap()
}

fn fitter(text: &str) -> Fitter {
    Fitter::of(&run(text), |path| std::fs::read(path)).unwrap()
}

/// 163 frames, 250 a second.
fn times() -> Vec<f64> {
    (0..163).map(|frame| 4.0 * f64::from(frame)).collect()
}

fn with_noise(values: &[f64], deviation: f64, seed: u64) -> Vec<f64> {
    let normal = Distribution::Normal { mean: 0.0, standard_deviation: deviation };
    let noise = sample(&Sampler::LatinHypercube { size: values.len() }, &[normal], seed).unwrap();
    values.iter().zip(noise.iter()).map(|(value, noise)| value + noise[0]).collect()
}

fn observed(values: Vec<f64>, scale: Scale) -> Observed {
    let stimuli = Stimuli::Given(vec![50.0]);
    Observed { name: "cell".into(), times_ms: times(), values, scale, unit: "um".into(), stimuli }
}

fn free(names: &[&str]) -> FitSettings {
    FitSettings {
        free: Some(names.iter().map(|name| Unknown::named(name)).collect()),
        ..FitSettings::default()
    }
}

fn fitted(fitter: &Fitter, observed: Observed, settings: &FitSettings) -> Fit {
    fitter.fit(&[observed], settings, &|_| true).unwrap().unwrap()
}

#[test]
fn what_a_curve_was_made_with_is_found_as_surely_as_its_noise_allows() {
    let fitter = fitter("");
    let curve = fitter.curve(&[], LENGTH, &times()).unwrap();
    let noisy = observed(with_noise(&curve, 0.1, 3), Scale::Length);
    let names = ["tension_over_stiffness", "c_0", "x_3", "sigma"];
    let fit = fitted(&fitter, noisy, &free(&names));
    // Standard deviations that an independent program found for these settings, % (delay: ms).
    let expected = [
        ("tension_over_stiffness", fitter.tension_over_stiffness(), 0.24),
        ("c_0", 0.0166016, 0.48),
        ("x_3", 0.2925, 1.0),
        ("sigma", 0.046875, 1.9),
        ("resting_length", LENGTH, 0.014),
        ("delay", 0.0, 0.29),
    ];
    for (name, truth, deviation) in expected {
        let estimate = fit.estimate(name).unwrap();
        let found = estimate.standard_deviation.unwrap();
        let found = if name == "delay" { found } else { 100.0 * found / truth };
        assert!((found / deviation - 1.0).abs() < 0.25, "{name}: {found}, not {deviation}");
        let off = (estimate.value - truth) / estimate.standard_deviation.unwrap();
        assert!(off.abs() < 4.0, "{name} is {} and not {truth}", estimate.value);
        assert_eq!(estimate.verdict, Verdict::Determined, "{name}");
    }
    assert!(fit.verdict == FitVerdict::Fits && (fit.reduced_chi_squared - 1.0).abs() < 0.3);
}

#[test]
fn stiffness_shows_under_a_known_load_alone() {
    let fitter = fitter("[shape]\nspacing = \"5 um\"");
    let curve = fitter.curve(&[], LENGTH, &times()).unwrap();
    let both = free(&["tension_over_stiffness", "young_modulus", "c_0"]);
    let alone = fitted(&fitter, observed(with_noise(&curve, 0.1, 5), Scale::Length), &both);
    assert_eq!(alone.estimate("young_modulus").unwrap().verdict, Verdict::NotDetermined);

    let between = |stiffness: f64| {
        let support = SupportKind::SpringHeldEnds { stiffness };
        let text = format!(
            "[shape]\nspacing = \"5 um\"\n[mechanics]\nsupport = \"spring-held-ends\"\nend_stiffness = \"{stiffness} nN/um\""
        );
        let values = self::fitter(&text).curve(&[], LENGTH, &times()).unwrap();
        Loaded::exact(support, observed(with_noise(&values, 0.1, 7), Scale::Length))
    };
    let unloaded = Loaded { support: SupportKind::MassCentre, ..between(100.0) };
    let unloaded =
        Loaded { observed: observed(with_noise(&curve, 0.1, 5), Scale::Length), ..unloaded };
    let mut before = f64::INFINITY;
    for stiffness in [100.0, 500.0] {
        let curves = [unloaded.clone(), between(stiffness)];
        let fit = fitter.fit_loaded(&curves, &both, &|_| true).unwrap().unwrap();
        let modulus = fit.estimate("young_modulus").unwrap();
        assert_eq!(modulus.verdict, Verdict::Determined);
        let deviation = modulus.standard_deviation.unwrap();
        assert!(
            (modulus.value - 308.0).abs() < 4.0 * deviation,
            "{} ± {deviation} kPa",
            modulus.value
        );
        // A stiffer load tells more of what it is set against.
        assert!(deviation < 0.7 * before);
        before = deviation;
    }
}

/// The built-in cell of 154 kPa and 30 kPa under this support: its length, and the force along its axis on a gel.
fn pulling(support: SupportKind) -> [Vec<f64>; 2] {
    let run = run("[shape]\nspacing = \"7 um\"");
    let bytes = run.shape.bytes(|path| std::fs::read(path)).unwrap();
    let shaped = run.shape.mesh(&bytes).unwrap();
    let made = run.make(shaped, |path| std::fs::read(path)).unwrap().simulation;
    let mut simulation = Simulation { support, duration: 650.0, peak_tension: 30.0, ..made };
    simulation.material.stiffness = Stiffness::YoungModulus(154.0);
    simulation.material.area_modulus *= 0.5;
    simulation.numerics.method = Method::QuasiStatic;
    let recording = simulation.build().unwrap().run(|_| true).recording;
    let at = |values: &dyn Fn(usize) -> f64| {
        let samples = &recording.samples;
        let place = |time: f64| samples.partition_point(|sample| sample.t_ms < time);
        times().into_iter().map(|time| values(place(time).min(samples.len() - 1))).collect()
    };
    let force = recording.signals.iter().find(|signal| signal.name == AXIAL_FORCE);
    [
        at(&|place| recording.samples[place].length_um),
        force.map_or_else(Vec::new, |force| at(&|place| force.values[place])),
    ]
}

#[test]
fn a_force_on_a_gel_gives_tension_and_stiffness_in_kpa() {
    let gel = |modulus: f64| SupportKind::Gel(Gel::half_space(modulus));
    let fitter = fitter("[shape]\nspacing = \"7 um\"");
    let settings = free(&["tension_over_stiffness", "young_modulus"]);
    let settings = FitSettings { starts: 2, ..settings };
    let shape = |support, seed| {
        let [length, _] = pulling(support);
        Loaded::exact(support, observed(with_noise(&length, 0.1, seed), Scale::Length))
    };
    let force = |support, seed| {
        let [_, force] = pulling(support);
        let noise = 0.02 * force.iter().copied().fold(0.0, f64::max);
        let values = with_noise(&force, noise, seed);
        let observed = Observed { unit: "nN".into(), ..observed(values, Scale::Load(AXIAL_FORCE)) };
        Loaded { support, observed, scale_error: 0.05 }
    };
    let sure = |curves: &[Loaded]| {
        let fit = fitter.fit_loaded(curves, &settings, &|_| true).unwrap().unwrap();
        [("young_modulus", 154.0), ("peak_tension", 30.0)].map(|(name, truth)| {
            let found = fit.estimate(name).unwrap();
            let [low, high] = found.interval;
            let [low, high] = [low.unwrap_or(0.0), high.unwrap_or(f64::INFINITY)];
            assert!(low < truth && truth < high, "{name} {low} to {high}, truth {truth}");
            high / low
        })
    };
    let free_cell = sure(&[shape(SupportKind::MassCentre, 1), force(gel(10.0), 2)]);
    // At equal tension over stiffness, the force changes with the stiffness to the power of the part of the shortening that the
    // gel takes: the error of its scale, 1.96 standard deviations either way, counts that much more.
    let shortening = |support| {
        let [length, _] = pulling(support);
        1.0 - length.iter().copied().fold(f64::INFINITY, f64::min) / length[0]
    };
    let taken = 1.0 - shortening(gel(10.0)) / shortening(SupportKind::MassCentre);
    let expected = 2.0 * 1.96 * 0.05 / taken;
    for width in free_cell {
        assert!((width.ln() / expected - 1.0).abs() < 0.3, "{width}, {expected}");
    }
    // Shape and force on one gel follow from each other.
    let one_gel = sure(&[shape(gel(10.0), 3), force(gel(10.0), 4)]);
    assert!(one_gel.iter().all(|width| *width > 4.0), "{one_gel:?}");
}

/// A cell of 140 um with a section of 157 um^2 that shortens by 12 %.
fn bar(support: SupportKind) -> Simulation {
    let mut simulation = Simulation::new(lattice::rectangle(28, 4, 5.0).unwrap());
    let material = &mut simulation.material;
    let Stiffness::YoungModulus(usual) = material.stiffness else { panic!("it has a modulus") };
    let by = 200.0 / usual;
    material.stiffness = Stiffness::YoungModulus(200.0);
    material.area_modulus *= by;
    material.thickness = 157.0 / 20.0;
    simulation.peak_tension *= by;
    simulation.support = support;
    simulation
}

#[test]
fn modulus_and_tension_under_known_loads_are_as_sure_as_an_independent_program_found() {
    // A tenth of the noise that standard deviations are stated for, so that they are those at the truth.
    const NOISE: f64 = 0.01;
    let curve = |support: SupportKind, seed: u64| {
        let values = Fitter::new(bar(support)).unwrap().curve(&[], 140.0, &times()).unwrap();
        let observed = observed(with_noise(&values, NOISE, seed), Scale::Length);
        Loaded::exact(support, Observed { name: format!("{support:?}"), ..observed })
    };
    let springs = |stiffness: f64| SupportKind::SpringHeldEnds { stiffness };
    let settings = FitSettings { starts: 2, ..free(&["tension_over_stiffness", "young_modulus"]) };
    let unloaded = curve(SupportKind::MassCentre, 1);
    let fitter = Fitter::new(bar(SupportKind::MassCentre)).unwrap();
    let sure = |curves: &[Loaded]| {
        let fit = fitter.fit_loaded(curves, &settings, &|_| true).unwrap().unwrap();
        let [ratio, modulus] = ["tension_over_stiffness", "young_modulus"].map(|name| {
            let estimate = fit.estimate(name).unwrap();
            10.0 * 100.0 * estimate.standard_deviation.unwrap() / estimate.value
        });
        let correlation = fit.correlation("young_modulus", "tension_over_stiffness").unwrap();
        // The logarithm of the tension is the sum of both.
        let tension = ratio.hypot(modulus).powi(2) + 2.0 * correlation * ratio * modulus;
        [modulus, tension.sqrt()]
    };
    // Springs at each end, nN/um; standard deviations of modulus and tension, %. Its modulus was not stated.
    let expected = [(20.0, [7.2, 7.2]), (100.0, [1.6, 1.6]), (500.0, [0.6, 0.5])];
    for (stiffness, expected) in expected {
        let found = sure(&[unloaded.clone(), curve(springs(stiffness), 2)]);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!(
                (found / expected - 1.0).abs() < 0.25,
                "{stiffness} nN/um: {found} {expected} %"
            );
        }
    }
    // One loaded curve alone tells neither: 118 and 105 % there, more here, since all that is left to tell them apart is
    // how the cell's stiffness changes with its length.
    let alone = sure(&[curve(springs(100.0), 3)]);
    assert!(alone.iter().all(|deviation| *deviation > 100.0), "{alone:?} %");
}

#[test]
fn a_model_that_does_not_fit_states_no_interval_and_says_where_it_is_off_and_what_to_do() {
    let slow = fitter("[cell]\nmodel = \"land_2017\"\n[numerics]\nintegrator = \"quasi-static\"");
    let curve = slow.curve(&[], LENGTH, &times()).unwrap();
    let height = LENGTH - curve.iter().copied().fold(LENGTH, f64::min);
    let fast = fitter("");
    // Whatever the noise, as long as it does not hide the misfit.
    for noise in [1e-9, 1e-4, 0.01] {
        let noisy = observed(with_noise(&curve, noise * height, 1), Scale::Length);
        let fit = fitted(&fast, noisy, &FitSettings::default());
        assert_eq!(fit.verdict, FitVerdict::DoesNotFit, "{noise}: {}", fit.curves[0].unexplained);
        for estimate in &fit.estimates {
            assert_eq!((estimate.interval, estimate.standard_deviation), ([None; 2], None));
            assert!(estimate.verdict != Verdict::Determined && estimate.profile.is_empty());
        }
        let [where_off, what_to_do] = [&fit.verdicts[0], &fit.verdicts[1]];
        assert!(
            where_off.starts_with("coelho_2021 does not fit `cell`: it is off by"),
            "{where_off}"
        );
        assert!(where_off.contains("the measured cell is"), "{where_off}");
        assert!(what_to_do.contains("land_2017") && what_to_do.contains("no intervals"));
    }
}

#[test]
fn a_model_that_fits_says_so_whatever_the_noise_the_frame_rate_and_the_number_of_beats() {
    let fitter = fitter("[shape]\nspacing = \"7 um\"");
    let one = fitter.curve(&[], LENGTH, &times()).unwrap();
    let height = LENGTH - one.iter().copied().fold(LENGTH, f64::min);
    let settings = FitSettings { starts: 2, ..FitSettings::default() };
    for (noise, rate, beats) in
        [(1e-9, 250.0, 1), (1e-4, 30.0, 1), (0.02, 1000.0, 1), (0.2, 250.0, 4), (0.05, 60.0, 3)]
    {
        let frames = (0.8 * rate * f64::from(beats)) as u32;
        let times_ms: Vec<f64> = (0..frames).map(|at| f64::from(at) * 1000.0 / rate).collect();
        let phases: Vec<f64> = times_ms.iter().map(|time| time % 800.0).collect();
        let beat = |time: f64| fitter.curve(&[], LENGTH, &[0.0, time, 800.0]).unwrap()[1];
        let values: Vec<f64> = phases.iter().map(|time| beat(*time)).collect();
        let stimuli = (0..beats).map(|beat| 50.0 + 800.0 * f64::from(beat)).collect();
        let observed = Observed {
            name: "cell".into(),
            values: with_noise(&values, noise * height, 8),
            times_ms,
            scale: Scale::Length,
            unit: "um".into(),
            stimuli: Stimuli::Given(stimuli),
        };
        let fit = fitted(&fitter, observed, &settings);
        let curve = &fit.curves[0];
        assert_eq!(fit.verdict, FitVerdict::Fits, "{noise} {rate} {beats}: {}", curve.unexplained);
        assert!(fit.estimates.iter().all(|estimate| estimate.interval != [None; 2]));
    }
}

#[test]
fn a_small_misfit_that_is_sure_to_be_there_widens_the_intervals_so_that_they_hold() {
    let fitter = fitter("[shape]\nspacing = \"7 um\"");
    let truth = [("tension_over_stiffness", 0.9), ("c_0", 1.1)];
    let curve = fitter.curve(&truth, LENGTH, &times()).unwrap();
    let height = LENGTH - curve.iter().copied().fold(LENGTH, f64::min);
    // A wave of 3 % of the beat, as an instrument may add it, with hardly any noise.
    let wave = |time: f64| 0.03 * height * (std::f64::consts::TAU * time / 324.0).sin();
    let off: Vec<f64> =
        curve.iter().zip(times()).map(|(length, time)| length + wave(time)).collect();
    let fit = fitted(
        &fitter,
        observed(with_noise(&off, 0.02, 4), Scale::Length),
        &FitSettings::default(),
    );
    assert_eq!(fit.verdict, FitVerdict::FitsNearly, "{}", fit.curves[0].unexplained);
    assert!(fit.verdicts[0].contains("the intervals count this"), "{}", fit.verdicts[0]);
    let wider = (fit.variance_factor * fit.rise_at_ends / 3.84).sqrt();
    let mut missed = 0;
    for (name, truth) in [
        ("tension_over_stiffness", 0.9 * fitter.tension_over_stiffness()),
        ("c_0", 1.1 * 0.0166016),
        ("delay", 0.0),
        ("resting_length", LENGTH),
    ] {
        let estimate = fit.estimate(name).unwrap();
        let [low, high] = estimate.interval.map(Option::unwrap);
        assert!(low < truth && truth < high, "{name}: {truth} is not in {low} to {high}");
        let end = if truth < estimate.value { low } else { high };
        let without = (end - estimate.value).abs() / wider;
        missed += usize::from((truth - estimate.value).abs() > without);
    }
    assert!(missed > 0, "as if every frame told something of its own");
}

#[test]
fn square_waves_and_ramps_are_no_beats_of_a_cell() {
    let fitter = fitter("[shape]\nspacing = \"7 um\"");
    let settings = FitSettings { starts: 2, ..FitSettings::default() };
    let square = |time: f64| if (60.0..300.0).contains(&time) { 10.0 } else { 0.0 };
    let ramp = |time: f64| 10.0 * ((time - 60.0) / 500.0).clamp(0.0, 1.0);
    let shapes: [&dyn Fn(f64) -> f64; 2] = [&square, &ramp];
    for (shape, noise) in shapes.iter().flat_map(|shape| [1e-9, 0.3].map(|noise| (shape, noise))) {
        let values: Vec<f64> = times().iter().map(|time| LENGTH - shape(*time)).collect();
        let noisy = observed(with_noise(&values, noise, 3), Scale::Length);
        let fit = fitted(&fitter, noisy, &settings);
        assert_eq!(fit.verdict, FitVerdict::DoesNotFit, "{noise}: {}", fit.curves[0].unexplained);
    }
}

#[test]
fn myofilaments_that_feel_their_length_find_their_own_curve() {
    let fitter = fitter("[cell]\nmodel = \"land_2017\"\n[numerics]\nintegrator = \"quasi-static\"");
    let factors = [("tension_over_stiffness", 0.9), ("k_ws", 1.1)];
    let curve = fitter.curve(&factors, LENGTH, &times()).unwrap();
    let settings = FitSettings { starts: 2, ..FitSettings::default() };
    let fit = fitted(&fitter, observed(with_noise(&curve, 0.1, 9), Scale::Length), &settings);
    for (name, factor) in factors {
        let estimate = fit.estimate(name).unwrap();
        let usual = if name == "k_ws" { 0.012 } else { fitter.tension_over_stiffness() };
        let off = (estimate.value - factor * usual) / estimate.standard_deviation.unwrap();
        assert!(off.abs() < 4.0, "{name} is off by {off} standard deviations");
    }
    assert_eq!(fit.verdict, FitVerdict::Fits);
}

#[test]
fn sensitivity_to_calcium_is_found_beside_the_height_or_the_rate() {
    let fitter = fitter("[cell]\nmodel = \"land_2017\"\n[shape]\nspacing = \"5 um\"");
    for (other, usual) in
        [("tension_over_stiffness", fitter.tension_over_stiffness()), ("k_ws", 0.012)]
    {
        let truth = [(other, 1.1, usual), ("Ca50_ref", 0.95, 0.805)];
        let factors = truth.map(|(name, factor, _)| (name, factor));
        let curve = fitter.curve(&factors, LENGTH, &times()).unwrap();
        let noisy = observed(with_noise(&curve, 0.1, 12), Scale::Length);
        let fit = fitted(&fitter, noisy, &free(&[other, "Ca50_ref"]));
        for (name, factor, usual) in truth {
            let estimate = fit.estimate(name).unwrap();
            let deviation = estimate.standard_deviation.unwrap();
            let off = (estimate.value - factor * usual) / deviation;
            assert!(off.abs() < 4.0, "{name} is off by {off} standard deviations");
            assert_eq!(estimate.verdict, Verdict::Determined, "{name}");
            // The three of them are known to a few per cent, each pair to about one.
            assert!(deviation < 0.03 * estimate.value, "{name} ± {deviation}");
        }
        assert_eq!(fit.verdict, FitVerdict::Fits);
    }
}

#[test]
fn of_height_sensitivity_and_rate_of_myofilaments_two_are_sought_at_most() {
    let fitter = fitter("[cell]\nmodel = \"land_2017\"\n[shape]\nspacing = \"5 um\"");
    let curve = fitter.curve(&[], LENGTH, &times()).unwrap();
    let all = free(&["tension_over_stiffness", "Ca50_ref", "k_ws"]);
    let error = fitter.fit(&[observed(curve, Scale::Length)], &all, &|_| true).unwrap_err();
    assert!(error.to_string().contains("at most two"), "{error}");
}

#[test]
fn cells_shorten_in_a_fit_as_they_do_in_a_run() {
    let between_springs =
        "[mechanics]\nsupport = \"spring-held-ends\"\nend_stiffness = \"100 nN/um\"\n";
    let viscous = |time: f64| format!("[material]\nretardation_time = \"{time} ms\"\n");
    for (model, other) in [
        ("land_2017", String::new()),
        ("land_2017", between_springs.to_owned()),
        ("land_2017", viscous(2.0)),
        ("land_2017", viscous(40.0)),
        ("tor_ord_land", String::new()),
        ("tor_ord_land", viscous(20.0)),
        ("coelho_2021", viscous(2.0)),
        ("coelho_2021", viscous(40.0)),
    ] {
        let text = format!(
            "[cell]\nmodel = \"{model}\"\n[shape]\nspacing = \"5 um\"\n\
             [numerics]\nintegrator = \"quasi-static\"\n{other}"
        );
        let fitter = fitter(&text);
        // In a fit the peak of a tension that is given is this cell's own, as it is of the published parameters.
        let quick = fitter.curve(&[], LENGTH, &times()).unwrap();
        let mut simulation = fitter.simulation().clone();
        simulation.duration = 648.0;
        simulation.protocol.start_ms = 50.0;
        let outcome = simulation.build().unwrap().run(|_| true);
        let samples = &outcome.recording.samples;
        let height = LENGTH - quick.iter().copied().fold(LENGTH, f64::min);
        for (time, quick) in times().iter().zip(&quick) {
            let near = |sample: &&myospring::recording::Sample| (sample.t_ms - time).abs() < 0.1;
            let sample = samples.iter().find(near).unwrap();
            let whole = LENGTH * (1.0 - sample.shortening_pct / 100.0);
            // The exchange of a run is of the first order in its interval.
            let off = (quick - whole).abs();
            assert!(off < 1e-3 * height, "{text}{time} ms: {quick} and {whole} um");
        }
    }
}

#[test]
fn single_bad_frames_move_nothing_and_are_counted() {
    let fitter = fitter("");
    let mut values = with_noise(&fitter.curve(&[], LENGTH, &times()).unwrap(), 0.1, 2);
    let sound = fitted(&fitter, observed(values.clone(), Scale::Length), &FitSettings::default());
    values[70] += 6.0;
    values[31] -= 4.0;
    let fit = fitted(&fitter, observed(values, Scale::Length), &FitSettings::default());
    let bad = |fit: &Fit| fit.curves[0].used.iter().filter(|used| !**used).count();
    assert_eq!((bad(&sound), bad(&fit)), (0, 2));
    for (with, without) in fit.estimates.iter().zip(&sound.estimates) {
        let off = (with.value - without.value) / without.standard_deviation.unwrap();
        assert!(off.abs() < 0.5, "{} moves by {off} standard deviations", with.name);
    }
}

#[test]
fn a_height_in_arbitrary_units_says_nothing_of_the_tension() {
    let fitter = fitter("");
    let curve = fitter.curve(&[("c_0", 1.2)], LENGTH, &times()).unwrap();
    let values = with_noise(&curve, 0.1, 4).iter().map(|length| 7.0 * (LENGTH - length)).collect();
    let fit = fitted(&fitter, observed(values, Scale::Arbitrary), &FitSettings::default());
    assert!(fit.estimate("tension_over_stiffness").is_none());
    let rate = fit.estimate("c_0").unwrap();
    assert!((rate.value / (1.2 * 0.0166016) - 1.0).abs() < 0.03, "{}", rate.value);
}

#[test]
fn the_run_of_a_fit_repeats_the_fitted_curve() {
    let text = "[numerics]\nintegrator = \"quasi-static\"";
    let fitter = fitter(text);
    let factors = [("tension_over_stiffness", 0.7), ("c_0", 1.3), ("sigma", 1.1)];
    let values = fitter.curve(&factors, LENGTH, &times()).unwrap();
    let settings = free(&["tension_over_stiffness", "c_0", "sigma"]);
    let fit = fitted(&fitter, observed(with_noise(&values, 0.05, 6), Scale::Length), &settings);
    // Half a sample of 0.5 ms at the largest rate, 0.2 um/ms.
    assert!(left_by_the_run(text, &fitter, &fit) < 0.12);
}

#[test]
fn the_run_of_a_fit_to_a_train_that_began_before_its_curve_repeats_it() {
    // The first beats of this model from rest are much stronger than those of a fast train.
    let text =
        "[cell]\nmodel = \"bueno_orovio_2008_pb\"\n[numerics]\nintegrator = \"quasi-static\"";
    let paced = "\n[stimulus]\nbeats = 6\ncycle_length = \"500 ms\"\nsteady_state = 1e-4\n[run]\nduration = \"3050 ms\"";
    let outcome = beaten(&run(&format!("{text}{paced}")));
    let samples = outcome.recording.samples.iter().step_by(20);
    let (times_ms, values): (Vec<f64>, Vec<f64>) =
        samples.map(|sample| (sample.t_ms, sample.length_um)).unzip();
    let stimuli = Stimuli::Given(outcome.stimulus_times_ms);
    let observed = Observed {
        name: "cell".into(),
        times_ms,
        values: with_noise(&values, 0.05, 6),
        scale: Scale::Length,
        unit: "um".into(),
        stimuli,
    };
    let fitter = fitter(text);
    let fit = fitted(&fitter, observed, &free(&["tension_over_stiffness", "c_0"]));
    assert!(fit.beats_before > 0);
    // The largest difference is at the first frames: the fit counts no tension before the first stimulus.
    let left = left_by_the_run(text, &fitter, &fit);
    assert!(left < 0.3, "{left} um");
}

#[test]
fn a_train_that_never_becomes_steady_has_a_run_that_begins_at_rest() {
    if crate::common::left_to_full() {
        return;
    }
    // At 130 ms the model follows no regular pattern.
    let times_ms: Vec<f64> = (0..1000).map(|frame| 2.0 * f64::from(frame)).collect();
    let stimuli: Vec<f64> = (0..15).map(|beat| 50.0 + 130.0 * f64::from(beat)).collect();
    let length = |time: &f64| {
        let part = ((time + 80.0) % 130.0 - 10.0).max(0.0) / 28.0;
        100.0 - 6.0 * part.powi(2) * (2.0 * (1.0 - part)).exp()
    };
    let (values, stimuli) = (times_ms.iter().map(length).collect(), Stimuli::Given(stimuli));
    let (name, unit) = ("cell".into(), "um".into());
    let observed = Observed { name, times_ms, values, scale: Scale::Length, unit, stimuli };
    let text = "[numerics]\nintegrator = \"quasi-static\"";
    let fitter = fitter(text);
    // Which numbers it has does not matter.
    let settings = free(&["tension_over_stiffness", "c_0"]);
    let settings = FitSettings { starts: 1, intervals: false, ..settings };
    let fit = fitted(&fitter, observed, &settings);
    let again = fitter.fitted(run(text), &Fit { beats_before: 10, ..fit }).unwrap();
    assert_eq!(again.steady_state, None);
}

fn beaten(run: &Run) -> Outcome {
    let bytes = run.shape.bytes(|path| std::fs::read(path)).unwrap();
    let made = run.make(run.shape.mesh(&bytes).unwrap(), |path| std::fs::read(path)).unwrap();
    made.simulation.build().unwrap().run(|_| true)
}

/// The largest distance, um, of the run of a fit from its curve.
fn left_by_the_run(text: &str, fitter: &Fitter, fit: &Fit) -> f64 {
    let again = fitter.fitted(run(text), fit).unwrap();
    let outcome = beaten(&again);
    let samples = &outcome.recording.samples;
    let (rest, length) = (samples[0].length_um, fit.estimate("resting_length").unwrap().value);
    let curve = &fit.curves[0];
    let shift = again.protocol.start_ms - curve.stimuli_ms[0];
    let left = |(time, fitted): (&f64, &f64)| {
        let near = |t: &&myospring::recording::Sample| t.t_ms >= time + shift;
        let sample = samples.iter().find(near).unwrap();
        (length * sample.length_um / rest - fitted).abs()
    };
    curve.times_ms.iter().zip(&curve.fitted).map(left).fold(0.0, f64::max)
}
