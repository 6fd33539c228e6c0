//! The meeting of tension and stretch: toys whose answers are known.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::exchange::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Sites, StretchState,
};
use myospring::integrate::Method;
use myospring::integrate::engine::EngineUsed;
use myospring::integrate::quasi_static::Tolerance;
use myospring::integrate::stepper::Stepper;
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::{Body, System, Tension};
use myospring::mesh::{Mesh, lattice};
use myospring::recording::Sample;
use myospring::simulation::{Effort, Outcome, Simulation, StopReason};
use std::sync::Arc;

/// `Ta = drive(t, site) (1 + per_stretch (stretch - 1)) + per_rate rate`.
#[derive(Clone)]
pub(crate) struct Toy {
    sites: Sites,
    drive: Arc<dyn Fn(f64, usize) -> f64 + Send + Sync>,
    highest: f64,
    /// A pure number.
    per_stretch: f64,
    /// kPa ms.
    per_rate: f64,
    /// Whether it says that it feels nothing, though it does.
    understates: bool,
    /// Beyond this it fails, ms.
    ends: f64,
    tension: Vec<f64>,
    slopes: [Vec<f64>; 2],
}

impl Toy {
    pub(crate) fn new(
        sites: Sites,
        highest: f64,
        drive: impl Fn(f64, usize) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let count = sites.count();
        let start = (0..count).map(|site| drive(0.0, site)).collect();
        Self {
            sites,
            drive: Arc::new(drive),
            highest,
            per_stretch: 0.0,
            per_rate: 0.0,
            understates: false,
            ends: f64::INFINITY,
            tension: start,
            slopes: [vec![0.0; count], vec![0.0; count]],
        }
    }
}

impl Activation for Toy {
    fn sites(&self) -> Sites {
        self.sites
    }

    fn advance(&mut self, to_ms: f64, felt: StretchState<'_>) -> Result<(), ActivationError> {
        if to_ms > self.ends {
            return Err(ActivationError(format!("the trace ends at {} ms", self.ends)));
        }
        for site in 0..self.sites.count() {
            let drive = (self.drive)(to_ms, site);
            let longer = felt.stretch[site] - 1.0;
            self.tension[site] =
                drive * (1.0 + self.per_stretch * longer) + self.per_rate * felt.rate[site];
            self.slopes[0][site] = drive * self.per_stretch;
            self.slopes[1][site] = self.per_rate;
        }
        Ok(())
    }

    fn keep(&mut self) {}

    fn tension(&self) -> Tension<'_> {
        match self.sites {
            Sites::Whole => Tension::Uniform(self.tension[0]),
            Sites::PerElement(_) => Tension::PerElement(&self.tension),
        }
    }

    fn tangent(&self) -> Option<ActivationTangent<'_>> {
        let feels = self.per_stretch != 0.0 || self.per_rate != 0.0;
        let [per_stretch, per_rate] = &self.slopes;
        feels.then_some(ActivationTangent { per_stretch, per_rate })
    }

    fn strongest(&self) -> ActivationBounds {
        let Self { highest, per_stretch, per_rate, understates, .. } = *self;
        if understates {
            return ActivationBounds { tension: highest, ..ActivationBounds::default() };
        }
        ActivationBounds { tension: highest, per_stretch: highest * per_stretch, per_rate }
    }

    fn boxed(&self) -> Box<dyn Activation> {
        Box::new(self.clone())
    }
}

pub(crate) fn strip() -> Mesh {
    lattice::rectangle(12, 3, 5.0).unwrap()
}

/// One site, or one for each triangle.
fn both(mesh: &Mesh) -> [Sites; 2] {
    [Sites::Whole, Sites::PerElement(mesh.simplices.len())]
}

fn beat(mesh: Mesh, toy: Toy, method: Method, duration: f64) -> Simulation {
    let mut simulation =
        Simulation { activation: Some(Box::new(toy)), duration, ..Simulation::new(mesh) };
    simulation.numerics.method = method;
    simulation
}

/// A run that comes to its end.
pub(crate) fn run(simulation: &Simulation) -> Outcome {
    let outcome = simulation.build().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    outcome
}

fn last(outcome: &Outcome) -> &Sample {
    outcome.recording.samples.last().unwrap()
}

pub(crate) const IN_TIME: Method = Method::Verlet(Integrator::StoermerVerlet);

#[test]
fn a_tension_that_falls_with_length_agrees_with_the_length_that_it_causes() {
    // 50 kPa within 20 ms, a third less for each 10 % of shortening.
    let ramp = |t: f64, _: usize| 50.0 * (t / 20.0).min(1.0);
    let mesh = strip();
    let equilibria =
        Simulation::new(mesh.clone()).equilibria(&[60.0], Tolerance::default()).unwrap();
    let mut ends = Vec::new();
    for sites in both(&mesh) {
        for method in [Method::QuasiStatic, IN_TIME] {
            let toy = Toy { per_stretch: 10.0 / 3.0, ..Toy::new(sites, 50.0, ramp) };
            let outcome = run(&beat(mesh.clone(), toy, method, 40.0));
            for sample in &outcome.recording.samples {
                // The toy's own law, in every sample of one site; of triangles, whose stretches differ while
                // they vibrate, where all is at rest.
                let stretch = 1.0 - sample.shortening_pct / 100.0;
                let law = ramp(sample.t_ms, 0) * (1.0 + 10.0 / 3.0 * (stretch - 1.0));
                let at_rest = method == Method::QuasiStatic || sample.t_ms == 40.0;
                if sites == Sites::Whole || at_rest {
                    let allowed = if at_rest && method == IN_TIME { 1e-4 } else { 1e-7 };
                    let error = (sample.ta_kpa - law).abs();
                    assert!(
                        error < allowed,
                        "{sites:?}, {method:?}: {error} kPa at {} ms",
                        sample.t_ms
                    );
                }
                if method == Method::QuasiStatic {
                    // And the mesh's own: the equilibrium under that tension alone.
                    let rest = equilibria.follow(&[[0.0, sample.ta_kpa]]).unwrap()[0];
                    let error = (rest.shortening_pct - sample.shortening_pct).abs();
                    // Interpolation of the path: 1e-6 of the length.
                    assert!(error < 2e-4, "{sites:?}: {error} % at {} ms", sample.t_ms);
                }
            }
            ends.push((last(&outcome).ta_kpa, last(&outcome).shortening_pct));
        }
    }
    // A homogeneous strip does not know whether its triangles feel themselves or the whole.
    for (tension, shortening) in &ends {
        assert!((tension - ends[0].0).abs() < 2e-3, "{ends:?}");
        assert!((shortening - ends[0].1).abs() < 1e-3, "{ends:?}");
    }
}

/// Compliance of the strip, 1/kPa: shortening per small tension.
fn compliance(mesh: &Mesh) -> f64 {
    let equilibria =
        Simulation::new(mesh.clone()).equilibria(&[0.01], Tolerance::default()).unwrap();
    equilibria.follow(&[[0.0, 0.01]]).unwrap()[0].shortening_pct / 100.0 / 0.01
}

#[test]
fn a_tension_that_falls_with_the_rate_of_shortening_relaxes_at_the_known_rate() {
    // Ta = T0 + c dstretch/dt and stretch = 1 - kappa Ta give 1 - stretch = kappa T0 (1 - e^(-t/tau)) with
    // tau = c kappa. An exchange interval h, implicit, makes it (1 + h/tau)^-n instead of e^(-t/tau).
    let (mesh, small, tau) = (strip(), 0.02, 8.0);
    let compliance = compliance(&mesh);
    let whole = compliance * small;
    for sites in both(&mesh) {
        let mut errors = Vec::new();
        for exchange in [1.0, 0.5, 0.25] {
            let toy =
                Toy { per_rate: tau / compliance, ..Toy::new(sites, small, move |_, _| small) };
            let mut simulation = beat(mesh.clone(), toy, Method::QuasiStatic, 16.0);
            simulation.numerics.exchange_interval = exchange;
            simulation.numerics.output_interval = 1.0;
            // The start is at rest under the tension at 0 ms; begin unloaded.
            let outcome = run(&unloaded(simulation, small));
            for sample in &outcome.recording.samples {
                let left = 1.0 - sample.shortening_pct / 100.0 / whole;
                let steps = (sample.t_ms / exchange).round();
                let expected = (1.0 + exchange / tau).powf(-steps);
                // The strip is linear to a part in 1e4 under 0.02 of some 300 kPa.
                assert!(
                    (left - expected).abs() < 3e-4,
                    "{sites:?}, {exchange} ms: {left}, {expected}"
                );
            }
            let left = 1.0 - last(&outcome).shortening_pct / 100.0 / whole;
            errors.push((left - (-16.0_f64 / tau).exp()).abs());
        }
        // First order in the exchange interval: half of it, half the error.
        assert!((errors[0] / errors[1] - 2.0).abs() < 0.3, "{errors:?}");
        assert!((errors[1] / errors[2] - 2.0).abs() < 0.3, "{errors:?}");
    }
}

/// The same toy, without tension at 0 ms.
fn unloaded(mut simulation: Simulation, level: f64) -> Simulation {
    let sites = simulation.activation.as_ref().unwrap().sites();
    let per_rate = simulation.activation.as_ref().unwrap().strongest().per_rate;
    let step = move |t: f64, _: usize| if t > 0.0 { level } else { 0.0 };
    simulation.activation = Some(Box::new(Toy { per_rate, ..Toy::new(sites, level, step) }));
    simulation
}

#[test]
fn a_tension_that_bends_with_the_stretch_of_its_triangle_is_followed_by_repeating_the_interval() {
    /// Falls from 30 kPa to 10 within some width of stretch: a straight law misses it within an interval.
    #[derive(Clone)]
    struct Bent {
        width: f64,
        tension: Vec<f64>,
        slopes: [Vec<f64>; 2],
    }
    impl Activation for Bent {
        fn sites(&self) -> Sites {
            Sites::PerElement(self.tension.len())
        }
        fn advance(&mut self, to_ms: f64, felt: StretchState<'_>) -> Result<(), ActivationError> {
            for (site, stretch) in felt.stretch.iter().enumerate() {
                let bend = ((stretch - 0.97) / self.width).tanh();
                let rise = (to_ms / 10.0).min(1.0);
                self.tension[site] = rise * (20.0 + 10.0 * bend);
                self.slopes[0][site] = rise * 10.0 / self.width * (1.0 - bend * bend);
            }
            Ok(())
        }
        fn keep(&mut self) {}
        fn tension(&self) -> Tension<'_> {
            Tension::PerElement(&self.tension)
        }
        fn tangent(&self) -> Option<ActivationTangent<'_>> {
            let [per_stretch, per_rate] = &self.slopes;
            Some(ActivationTangent { per_stretch, per_rate })
        }
        fn strongest(&self) -> ActivationBounds {
            ActivationBounds { tension: 30.0, per_stretch: 10.0 / self.width, per_rate: 0.0 }
        }
        fn boxed(&self) -> Box<dyn Activation> {
            Box::new(self.clone())
        }
    }
    let mesh = lattice::rectangle(8, 2, 5.0).unwrap();
    let none = vec![0.0; mesh.simplices.len()];
    let until_8_ms = |width: f64, exchange: f64| {
        let bent = Bent { width, tension: none.clone(), slopes: [none.clone(), none.clone()] };
        let mut simulation = Simulation {
            activation: Some(Box::new(bent)),
            duration: 8.0,
            ..Simulation::new(mesh.clone())
        };
        simulation.numerics.exchange_interval = exchange;
        simulation.build().unwrap().run(|_| true)
    };
    let [coarse, fine] = [0.25, 0.025].map(|exchange| {
        let outcome = until_8_ms(0.01, exchange);
        assert_eq!(outcome.stop, None);
        *last(&outcome)
    });
    // Twice the thousandth of 30 kPa that an interval may miss.
    assert!((coarse.ta_kpa - fine.ta_kpa).abs() < 0.06, "{coarse:?}\n{fine:?}");
    // So steep that a triangle swings over all of the bend within an interval: refused, not guessed.
    let widths = [5e-4, 1e-4, 2e-5];
    let refused: Vec<String> = widths
        .into_iter()
        .filter_map(|width| Some(until_8_ms(width, 0.25).stop?.to_string()))
        .collect();
    assert!(!refused.is_empty());
    for steep in refused {
        assert!(steep.contains("take a shorter exchange interval"), "{steep}");
    }
}

#[test]
fn a_cell_that_begins_under_tension_begins_at_rest_and_stays_there() {
    let mesh = strip();
    for sites in both(&mesh) {
        for (per_stretch, per_rate) in [(0.0, 2000.0), (3.0, 0.0), (3.0, 2000.0)] {
            let constant = Toy::new(sites, 30.0, |_, _| 30.0);
            let toy = Toy { per_stretch, per_rate, ..constant };
            let outcome = run(&beat(mesh.clone(), toy, Method::QuasiStatic, 5.0));
            let first = &outcome.recording.samples[0];
            let law = 30.0 * (1.0 - per_stretch * first.shortening_pct / 100.0);
            assert!((first.ta_kpa - law).abs() < 1e-7, "{sites:?}: {} {law} kPa", first.ta_kpa);
            for sample in &outcome.recording.samples {
                // What Newton's method and the trials leave, times 2000 kPa ms.
                let moved = (sample.shortening_pct - first.shortening_pct).abs();
                assert!(moved < 1e-5, "{sites:?}: {moved} % at {} ms", sample.t_ms);
            }
        }
    }
}

#[test]
fn an_activation_that_does_not_keep_its_word_is_stopped_and_named() {
    let mesh = strip();
    let triangles = Sites::PerElement(mesh.simplices.len());
    // Steeper than it says: the time step would not be stable.
    let toy = Toy { per_rate: 100.0, understates: true, ..Toy::new(triangles, 10.0, |t, _| t) };
    let simulation = Simulation {
        activation: Some(Box::new(toy)),
        duration: 5.0,
        ..Simulation::new(mesh.clone())
    };
    let outcome = simulation.build().unwrap().run(|_| true);
    let Some(StopReason::CellModel { cause }) = &outcome.stop else { panic!("{:?}", outcome.stop) };
    assert!(cause.contains("rate of stretch is 100 at site 0, but it said 0 to 0"), "{cause}");
    // A path cannot be solved in advance for a tension that differs.
    let field = Toy::new(triangles, 10.0, |t, _| t);
    let field = Simulation { activation: Some(Box::new(field)), ..simulation };
    let refused = field.run_quasi_static(Tolerance::default(), |_| true).unwrap_err().to_string();
    assert!(refused.contains("prepare_field"), "{refused}");
}

#[test]
fn the_same_relaxation_is_found_in_time() {
    let (mesh, small, tau) = (lattice::rectangle(8, 2, 5.0).unwrap(), 0.02, 2.0);
    let compliance = compliance(&mesh);
    let whole = compliance * small;
    let exchange = 0.05;
    for sites in both(&mesh) {
        let toy = Toy { per_rate: tau / compliance, ..Toy::new(sites, small, move |_, _| small) };
        let mut simulation = beat(mesh.clone(), toy, IN_TIME, 6.0);
        simulation.material.slowest_period = Some(0.2);
        simulation.material.damping_ratio = 0.0;
        simulation.numerics.exchange_interval = exchange;
        simulation.numerics.output_interval = 0.5;
        simulation.numerics.frame_interval = 1.0;
        let outcome = run(&unloaded(simulation, small));
        for sample in &outcome.recording.samples[1..] {
            let left = 1.0 - sample.shortening_pct / 100.0 / whole;
            let expected = match sites {
                // Implicit over each exchange interval, as at equilibrium.
                Sites::Whole => (1.0 + exchange / tau).powf(-(sample.t_ms / exchange).round()),
                // Tensions that follow their triangles in every step; only the drive's step at 0 ms takes an
                // interval to rise.
                Sites::PerElement(_) => (-(sample.t_ms - 0.5 * exchange) / tau).exp(),
            };
            // Inertia: a mass on a spring of period T answers later, by some (T/2 pi)^2/tau of the time.
            let error = (left - expected).abs();
            assert!(error < 3e-3, "{sites:?}: {error} at {} ms", sample.t_ms);
        }
    }
}

#[test]
fn a_front_of_tension_that_travels_shortens_the_cell_at_the_known_rate() {
    // Behind the front 40 kPa, none before it. Far from the ends the shape about the front travels with it, so
    // a front that goes one square farther shortens the cell by the spacing times 1 - stretch(40 kPa).
    let (columns, spacing, speed, tension) = (60, 2.0, 2.0, 40.0);
    // A length changes as the distance between the means of the ends, relative to that distance at rest: an end has
    // 6 um, 3 squares, whose first nodes stand for half of one.
    let (whole, middle_of_end) = (120.0, (2.0 + 4.0 + 6.0) / 3.5);
    let of_whole = whole / (whole - 2.0 * middle_of_end);
    let mesh = lattice::rectangle(columns, 3, spacing).unwrap();
    let right: Vec<f64> = mesh
        .simplices
        .iter()
        .map(|s| s.nodes.iter().map(|&node| mesh.points[0][node as usize]).fold(0.0, f64::max))
        .collect();
    let sites = Sites::PerElement(mesh.simplices.len());
    let wave =
        move |t: f64, site: usize| if right[site] <= speed * t + 1e-9 { tension } else { 0.0 };
    let equilibria =
        Simulation::new(mesh.clone()).equilibria(&[tension], Tolerance::default()).unwrap();
    let behind = equilibria.follow(&[[0.0, tension]]).unwrap()[0].shortening_pct / 100.0;
    assert!(behind > 0.05);
    let toy = Toy::new(sites, tension, wave);
    let mut simulation = beat(mesh, toy, Method::QuasiStatic, 60.0);
    simulation.numerics.exchange_interval = 1.0;
    simulation.numerics.output_interval = 1.0;
    let outcome = run(&simulation);
    assert!(matches!(outcome.effort, Effort::Field { equilibria: 61, .. }), "{:?}", outcome.effort);
    let samples = &outcome.recording.samples;
    // 20 squares from either end the ends are no longer felt: e^(-20 2 pi/3 ...) of a square.
    for pair in samples.windows(2).filter(|pair| (20.0..40.0).contains(&pair[0].t_ms)) {
        let shorter = pair[0].length_um - pair[1].length_um;
        let expected = spacing * behind * of_whole;
        assert!(
            (shorter - expected).abs() < 1e-6,
            "{shorter} um, not {expected}, at {} ms",
            pair[1].t_ms
        );
        // The tension that is recorded is the mean over the cell.
        assert!((pair[1].ta_kpa - tension * pair[1].t_ms / 60.0).abs() < 1e-9);
    }
    // A shape knows the tension of each triangle: behind the front, and before it.
    let half = outcome.recording.frames.iter().find(|frame| frame.t_ms == 30.0).unwrap();
    let tensions = half.ta_by_triangle_kpa.as_ref().unwrap();
    assert_eq!(tensions.iter().filter(|t| **t == tension).count(), tensions.len() / 2);
    assert_eq!(tensions.iter().filter(|t| **t == 0.0).count(), tensions.len() / 2);
    let (end, peak) = (samples.last().unwrap().shortening_pct / 100.0, behind);
    assert!((end - peak).abs() < 2e-6, "the front has passed: {end}, {peak}");
}

#[test]
fn the_same_front_in_time_ends_as_at_equilibrium_and_moves_no_mass_centre() {
    let mesh = lattice::rectangle(20, 3, 2.0).unwrap();
    let right: Vec<f64> = mesh
        .simplices
        .iter()
        .map(|s| s.nodes.iter().map(|&node| mesh.points[0][node as usize]).fold(0.0, f64::max))
        .collect();
    let sites = Sites::PerElement(mesh.simplices.len());
    // Each triangle rises within 4 ms; the front crosses the cell in 20.
    let wave = move |t: f64, site: usize| 40.0 * ((2.0 * t - right[site]) / 8.0).clamp(0.0, 1.0);
    let [rest, moving] = [Method::QuasiStatic, IN_TIME]
        .map(|method| run(&beat(mesh.clone(), Toy::new(sites, 40.0, wave.clone()), method, 40.0)));
    for (a, b) in rest.recording.samples.iter().zip(&moving.recording.samples) {
        // Inertia and drag delay a motion by some tenth of a ms, at a quarter of a per cent a ms.
        assert!((a.shortening_pct - b.shortening_pct).abs() < 0.15, "{a:?}\n{b:?}");
        assert!(b.momentum_nn_ms < 1e-9, "{} nN ms", b.momentum_nn_ms);
    }
    let (a, b) = (last(&rest), last(&moving));
    assert!((a.shortening_pct - b.shortening_pct).abs() < 1e-3, "{a:?}\n{b:?}");
    for outcome in [&rest, &moving] {
        // What the tension works is stored, dissipated in motion, and missed by the trapezoidal rule.
        let end = last(outcome);
        let spent = end.elastic_energy_fj + end.dissipated_energy_fj + end.kinetic_energy_fj;
        assert!((end.active_work_fj / spent - 1.0).abs() < 5e-3, "{end:?}");
    }
    let Some(EngineUsed::Plain { instead_of_fused: Some(why) }) = &moving.engine else {
        panic!("{:?}", moving.engine)
    };
    assert!(why.contains("not uniform"), "{why}");
}

#[test]
fn triangles_without_myofibrils_do_not_pull_and_half_of_them_pull_by_half() {
    let mesh = lattice::rectangle(40, 3, 2.0).unwrap();
    let shortening = |content: Vec<f64>, peak_tension: f64, method: Method| {
        let mut simulation = Simulation {
            myofibril_content: Some(content),
            peak_tension,
            duration: 200.0,
            ..Simulation::new(mesh.clone())
        };
        simulation.numerics.method = method;
        let outcome = run(&simulation);
        outcome.recording.samples.iter().map(|s| s.shortening_pct).fold(0.0, f64::max)
    };
    let all = vec![1.0; mesh.simplices.len()];
    let half = vec![0.5; mesh.simplices.len()];
    let left: Vec<f64> = mesh
        .simplices
        .iter()
        .map(|s| f64::from(u8::from(s.nodes.iter().all(|&n| mesh.points[0][n as usize] <= 40.0))))
        .collect();
    for method in [Method::QuasiStatic, IN_TIME] {
        let whole = shortening(all.clone(), 40.0, method);
        assert!((shortening(half.clone(), 80.0, method) / whole - 1.0).abs() < 1e-6, "{method:?}");
        // One half of the length shortens, but for what happens about the border: less than a square's worth.
        let part = shortening(left.clone(), 40.0, method) / whole;
        assert!((part - 0.5).abs() < 0.02, "{method:?}: {part}");
    }
}

#[test]
fn a_stepper_from_outside_moves_the_masses() {
    /// Two small steps for each that is asked for.
    struct Halved<'a>(Motion<'a>);

    impl Stepper for Halved<'_> {
        fn advance(
            &mut self,
            steps: usize,
            tensions: [Tension<'_>; 2],
        ) -> Result<(), myospring::integrate::stepper::StepError> {
            Stepper::advance(&mut self.0, 2 * steps, tensions)
        }
        fn body(&self) -> &Body {
            &self.0.body
        }
        fn time_step(&self) -> f64 {
            2.0 * self.0.time_step()
        }
        fn steps(&self) -> u64 {
            self.0.steps() / 2
        }
        fn mark(&mut self) {
            self.0.mark();
        }
        fn back(&mut self) {
            self.0.back();
        }
    }

    fn make<'a>(system: &'a System, body: Body, time_step: f64) -> Box<dyn Stepper + 'a> {
        let form = Integrator::VelocityVerlet;
        Box::new(Halved(Motion::new(system, body, form, 0.5 * time_step)))
    }

    let usual = crate::beat::quick_twitch(strip());
    let own = Simulation { stepper: Some(Arc::new(make)), ..usual.clone() };
    let step = own.prepare().unwrap().time_step();
    let mut halved = usual;
    halved.numerics.method = Method::Verlet(Integrator::VelocityVerlet);
    halved.numerics.time_step = Some(0.5 * step);
    let [halved, own] = [halved, own].map(|simulation| run(&simulation));
    assert_eq!((&own.engine, own.effort.time_step()), (&Some(EngineUsed::Own), Some(step)));
    assert!(matches!(own.effort, Effort::OwnStepper { .. }), "{:?}", own.effort);
    assert_eq!(own.recording, halved.recording);
}

#[test]
fn an_activation_that_fails_stops_the_run_and_keeps_what_was_recorded() {
    let toy = Toy { ends: 5.0, ..Toy::new(Sites::Whole, 5.0, |t, _| t) };
    let simulation =
        Simulation { activation: Some(Box::new(toy)), duration: 10.0, ..Simulation::new(strip()) };
    let outcome = simulation.build().unwrap().run(|_| true);
    let Some(StopReason::CellModel { cause }) = &outcome.stop else { panic!("{:?}", outcome.stop) };
    assert!(cause.contains("5 ms"), "{cause}");
    assert_eq!(last(&outcome).t_ms, 5.0);
}
