//! Waves in made-up films.

use crate::common::Sample;
use myospring::analysis::value;
use myospring::microscopy::film::Film;
use myospring::microscopy::optical::{OpticalMap, OpticalSettings};
use myospring::microscopy::picture::Selection;

/// A film of a tissue whose light rises or falls as action potentials do.
#[derive(Debug, Clone, Copy)]
struct Scene {
    /// Frames a second, pixels of um.
    rate: f64,
    pixel_um: f64,
    /// Velocity, cm/s, and the direction of the wave, degrees.
    velocity: f64,
    angle_deg: f64,
    /// Height of a beat and standard deviation of the noise, grey values above 20 000.
    height: f64,
    noise: f64,
    /// Bleaching over the film, grey values.
    bleached: f64,
    falls: bool,
    beats: usize,
    cycle_ms: f64,
    duration_ms: f64,
}

const CLEAR: Scene = Scene {
    rate: 500.0,
    pixel_um: 100.0,
    velocity: 20.0,
    angle_deg: 0.0,
    height: 2000.0,
    noise: 20.0,
    bleached: 0.0,
    falls: true,
    beats: 2,
    cycle_ms: 500.0,
    duration_ms: 200.0,
};

const SIDE: [usize; 2] = [36, 24];

impl Scene {
    /// When the wave is at a pixel, ms after the first beat begins; rows downward.
    fn arrives(&self, column: usize, row: usize) -> f64 {
        let (sin, cos) = self.angle_deg.to_radians().sin_cos();
        let way = self.pixel_um * (column as f64 * cos + row as f64 * sin);
        way / (10.0 * self.velocity)
    }

    fn film(&self) -> Film {
        let frames = ((100.0 + self.beats as f64 * self.cycle_ms) * self.rate / 1000.0) as usize;
        let [columns, rows] = SIDE;
        let mut bytes =
            format!("YUV4MPEG2 W{columns} H{rows} F{}:1 Cmono16\n", self.rate).into_bytes();
        let mut random = Random(7);
        for frame in 0..frames {
            bytes.extend(b"FRAME\n");
            let now = 1000.0 * frame as f64 / self.rate;
            for pixel in 0..columns * rows {
                let arrives = 60.0 + self.arrives(pixel % columns, pixel / columns);
                let up: f64 = (0..self.beats)
                    .map(|beat| {
                        let since = now - arrives - beat as f64 * self.cycle_ms;
                        // Half of the height when the wave arrives, a tenth left after the duration.
                        1.0 / (1.0 + (-since / 1.5).exp())
                            / (1.0 + ((since - self.duration_ms + 22.0) / 10.0).exp())
                    })
                    .sum();
                let sign = if self.falls { -1.0 } else { 1.0 };
                let bleached = self.bleached * now * self.rate / (1000.0 * frames as f64);
                let value =
                    20_000.0 + sign * self.height * up - bleached + self.noise * random.normal();
                bytes.extend((value.round() as u16).to_le_bytes());
            }
        }
        Film::read(bytes, &Selection::default()).unwrap()
    }

    fn map(&self) -> OpticalMap {
        let (frames_per_second, pixel_um) = (self.rate, self.pixel_um);
        let settings =
            OpticalSettings { frames_per_second, pixel_um, stimuli_ms: Vec::new(), falls: None };
        OpticalMap::of(&self.film(), &settings, |_| true).unwrap()
    }
}

/// `SplitMix64` (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Of standard deviation 1, by the sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

#[test]
fn waves_of_any_velocity_direction_rate_and_noise_are_mapped() {
    let mut sample = Sample::one_in(11);
    for velocity in [10.0, 20.0, 40.0] {
        for angle_deg in [0.0, 30.0, 90.0, 200.0] {
            for rate in [250.0, 1000.0] {
                for noise in [20.0, 100.0] {
                    if sample.leaves_out() {
                        continue;
                    }
                    let scene =
                        Scene { velocity, angle_deg, rate, noise, bleached: 2000.0, ..CLEAR };
                    check(scene);
                }
            }
        }
    }
}

fn check(scene: Scene) {
    let map = scene.map();
    assert_eq!(map.falls, scene.falls, "{scene:?}");
    assert_eq!(map.beats.len(), scene.beats, "{scene:?}");
    assert!(map.against < 0.05, "{scene:?}: {}", map.against);
    for beat in &map.beats {
        let of = |name| value(&beat.metrics, name).unwrap_or(f64::NAN);
        let velocity = of("conduction_velocity");
        // A wave that needs few frames to cross is timed by its noise.
        let crosses = 3600.0 / (10.0 * scene.velocity) * scene.rate / 1000.0;
        let bound = if crosses > 10.0 { 0.05 } else { 0.15 };
        assert!((velocity / scene.velocity - 1.0).abs() < bound, "{scene:?}: {velocity} cm/s");
        let duration = of("local_action_potential_duration_90");
        assert!((duration - scene.duration_ms).abs() < 8.0, "{scene:?}: {duration} ms");
        assert!(of("activated_part") > 90.0, "{scene:?}");
    }
    // Where the wave begins and ends, to a frame.
    let from_start = |column: usize, row: usize| scene.arrives(column, row);
    let known = |node: usize| {
        let [column, up] = map.mesh.point(node).map(|x| (x / scene.pixel_um).round() as usize);
        let row = SIDE[1] - 1 - up;
        Some((map.typical.activation_ms[node]?, from_start(column, row)))
    };
    let all: Vec<(f64, f64)> = (0..map.mesh.len()).filter_map(known).collect();
    let shift = all.iter().map(|(found, truth)| found - truth).sum::<f64>() / all.len() as f64;
    let off = all.iter().map(|(found, truth)| (found - truth - shift).powi(2)).sum::<f64>();
    let off = (off / all.len() as f64).sqrt();
    assert!(off < 1000.0 / scene.rate, "{scene:?}: {off} ms");
}

#[test]
fn light_that_rises_is_mapped_as_light_that_falls() {
    check(Scene { falls: false, ..CLEAR });
}

#[test]
fn a_film_without_beats_is_refused_with_the_reason() {
    let scene = Scene { height: 0.0, beats: 1, ..CLEAR };
    let settings = OpticalSettings {
        frames_per_second: scene.rate,
        pixel_um: scene.pixel_um,
        stimuli_ms: Vec::new(),
        falls: None,
    };
    let error = OpticalMap::of(&scene.film(), &settings, |_| true).unwrap_err().to_string();
    assert!(error.contains("no beat is seen") || error.contains("this is noise"), "{error}");
}

#[test]
fn stimuli_are_where_activation_counts_from() {
    let scene = CLEAR;
    let settings = OpticalSettings {
        frames_per_second: scene.rate,
        pixel_um: scene.pixel_um,
        stimuli_ms: vec![50.0, 550.0],
        falls: None,
    };
    let map = OpticalMap::of(&scene.film(), &settings, |_| true).unwrap();
    assert_eq!(map.beats.iter().map(|beat| beat.begins_ms).collect::<Vec<_>>(), [50.0, 550.0]);
    let last = value(&map.beats[0].metrics, "activation_time").unwrap();
    // 10 ms until the wave begins, 17.5 ms until it ends.
    assert!((last - 27.5).abs() < 2.0, "{last} ms");
}
