//! The loop of a run: activation and mesh are coupled in every exchange interval and recorded.

use super::coupler::{Coupler, Shaping};
use super::observer::{Progress, RunObserver, RunPart};
use super::setup::Setup;
use super::space::Space;
use super::{Simulation, StopReason};
use crate::cell::Output;
use crate::exchange::Activation;
use crate::mechanics::{Vectors, zeros};
use crate::recording::{Frame, Recording, Sample, Signal, Wave};

/// The recorded quantities of a shape; units as in [`Sample`].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Observed {
    pub(super) length: f64,
    pub(super) width: f64,
    pub(super) area: f64,
    pub(super) elastic_energy: f64,
    pub(super) kinetic_energy: f64,
    pub(super) active_work: f64,
    pub(super) dissipated_energy: f64,
    pub(super) momentum: f64,
    pub(super) angular_momentum: f64,
    /// Those of the gauges.
    pub(super) gauges: Vec<f64>,
}

/// A shape as it is seen from above, and in space if it is thick.
type Shown = (Frame, Option<Frame<3>>);

/// A shape that can be recorded.
pub(super) trait Observable<const D: usize>: Shaping {
    /// The recorded quantities now.
    fn observe(&self) -> Observed;
    /// Positions now, um.
    fn positions(&self) -> Vectors<D>;
    /// The forces of the nodes that adhere to a body outside, nN, if they are known already.
    fn pulls(&self) -> Option<Vectors<D>> {
        None
    }
}

impl<const D: usize, const N: usize> Setup<D, N>
where
    Simulation: Space<D, N>,
{
    fn coupler(&self) -> Coupler<'_> {
        let every = self.simulation.numerics.exchange_interval;
        Coupler::new(self.activation.boxed(), self.strongest, every, &self.volumes)
    }

    /// The force of each node on the gel, nN, if the cell adheres to one.
    fn on_gel(&self, shaping: &impl Observable<D>) -> Option<Vectors<D>> {
        let gel = self.assembly.system.compliance()?;
        let pulls = shaping.pulls();
        let pulls = pulls.unwrap_or_else(|| gel.forces(&gel.displacements(&shaping.positions())));
        let mut all = zeros(self.assembly.body.len());
        for (all, pulls) in all.iter_mut().zip(pulls) {
            for (&node, pull) in gel.nodes().iter().zip(pulls) {
                all[node] = pull;
            }
        }
        Some(all)
    }

    /// The stretch of the activation's sites in a shape.
    pub(super) fn stretch_at(&self, positions: &Vectors<D>) -> Vec<f64> {
        match &self.fibre_stretch {
            Some(fibres) => fibres.stretches(positions),
            None => vec![self.assembly.stretch(self.assembly.measure(positions).length)],
        }
    }

    /// Solves for the common equilibrium of a mesh along equilibria and its activation.
    pub(super) fn settle(&self, shaping: &mut impl Shaping) -> Result<(), StopReason> {
        self.coupler().begin(shaping)
    }

    /// The loop.
    pub(super) fn run(
        &self,
        shaping: &mut impl Observable<D>,
        observer: &mut dyn RunObserver,
    ) -> (Recording, Option<StopReason>) {
        let Simulation { duration, numerics, .. } = &self.simulation;
        let exchange = numerics.exchange_interval;
        let exchanges = (duration / exchange).round() as u64;
        let per_sample = (numerics.output_interval / exchange).round().max(1.0) as u64;
        let per_frame = (numerics.frame_interval / exchange).round().max(1.0) as u64;

        let mut meeting = self.coupler();
        let signal = |output: Output| Signal {
            name: output.name.into_owned(),
            unit: output.unit.into_owned(),
            values: Vec::new(),
        };
        let outputs = self.activation.outputs().into_iter().chain(self.assembly.gauges.outputs());
        let mut recording =
            Recording { signals: outputs.map(signal).collect(), ..Recording::default() };
        let mut strongest: Option<Shown> = None;
        let mut stop = meeting.begin(shaping).err();
        let exchanges = if stop.is_some() { 0 } else { exchanges };
        for index in 0..=exchanges {
            let time = index as f64 * exchange;
            if self.simulation.interruption.is_requested() {
                stop = Some(StopReason::Interrupted { time });
                break;
            }
            if index > 0
                && let Err(reason) = meeting.pass(time, shaping, observer)
            {
                stop = Some(reason);
                break;
            }
            observer.begins(RunPart::Recording);
            let tension = meeting.tension.average(&self.volumes);
            let snapshot = || {
                let (frame, in_space) =
                    self.shown(time, tension, meeting.tension.by_element(), shaping);
                (Frame { potential_mv: meeting.activation.potentials_mv(), ..frame }, in_space)
            };
            if index % per_sample == 0 {
                let observed = shaping.observe();
                recording.samples.push(self.sample(time, &*meeting.activation, tension, &observed));
                let values = meeting.activation.output_values().into_iter().chain(observed.gauges);
                for (signal, value) in recording.signals.iter_mut().zip(values) {
                    signal.values.push(value);
                }
                if strongest.as_ref().is_none_or(|(frame, _)| tension > frame.ta_kpa) {
                    strongest = Some(snapshot());
                }
            }
            if index % per_frame == 0 {
                let (frame, in_space) = snapshot();
                recording.frames.push(frame);
                recording.in_space.extend(in_space);
            }
            if index % per_sample == 0 && !observer.sample(Progress { time, duration: *duration }) {
                stop = Some(StopReason::Interrupted { time });
                break;
            }
        }
        recording.wave = meeting.activation.local_beats().map(|beats| {
            let mesh = &self.simulation.mesh;
            Wave {
                points: mesh.points.clone(),
                triangles: mesh.simplices.iter().map(|triangle| triangle.nodes).collect(),
                beats,
                tips: meeting.activation.wave_tips().to_vec(),
            }
        });
        // The shape at the peak of tension is always recorded, whatever the frame interval.
        if let Some((frame, in_space)) = strongest {
            let place = recording.frames.partition_point(|other| other.t_ms < frame.t_ms);
            if recording.frames.get(place).is_none_or(|other| other.t_ms > frame.t_ms) {
                recording.frames.insert(place, frame);
                if let Some(in_space) = in_space {
                    recording.in_space.insert(place, in_space);
                }
            }
        }
        (recording, stop)
    }

    /// The shape now.
    fn shown(
        &self,
        time: f64,
        tension: f64,
        by_element: Option<&[f64]>,
        shaping: &impl Observable<D>,
    ) -> Shown {
        let (simulation, positions) = (&self.simulation, shaping.positions());
        let on_gel = self.on_gel(shaping);
        let in_space = simulation.with_three_axes(&positions).map(|positions| Frame {
            ta_by_triangle_kpa: by_element.map(<[f64]>::to_vec),
            on_gel_nn: on_gel.as_ref().and_then(|pulls| simulation.with_three_axes(pulls)),
            ..Frame::new(time, tension, positions)
        });
        let frame = Frame {
            ta_by_triangle_kpa: by_element.map(|tension| simulation.by_triangle(tension)),
            on_gel_nn: on_gel.map(|pulls| simulation.added_from_above(pulls)),
            ..Frame::new(time, tension, simulation.seen_from_above(&positions).into_owned())
        };
        (frame, in_space)
    }

    fn sample(
        &self,
        time: f64,
        activation: &dyn Activation,
        tension: f64,
        observed: &Observed,
    ) -> Sample {
        Sample {
            t_ms: time,
            u: activation.potential(),
            vm_mv: activation.membrane_potential_mv(),
            ta_kpa: tension,
            length_um: observed.length,
            width_um: observed.width,
            area_um2: observed.area,
            shortening_pct: 100.0 * (1.0 - observed.length / self.assembly.held_length),
            elastic_energy_fj: observed.elastic_energy,
            kinetic_energy_fj: observed.kinetic_energy,
            active_work_fj: observed.active_work,
            dissipated_energy_fj: observed.dissipated_energy,
            momentum_nn_ms: observed.momentum,
            angular_momentum_nn_um_ms: observed.angular_momentum,
        }
    }
}
