//! The light of a simulated tissue is mapped to what was simulated.

use myospring::analysis::order::median;
use myospring::analysis::value;
use myospring::microscopy::film::Film;
use myospring::microscopy::optical::{OpticalMap, OpticalSettings};
use myospring::microscopy::picture::Selection;
use myospring::run_file::RunFile;

#[test]
#[ignore = "slow"]
fn the_light_of_a_simulated_sheet_gives_its_activation_velocity_and_durations() {
    let text = "[cell]\nmodel = \"bueno_orovio_2008_epi\"\npeak_tension = \"0.01 kPa\"\n\
                [tissue]\nconduction_velocity = \"40 cm/s\"\nvelocity_ratio = 2\n\
                [shape]\nbuilt_in = \"tissue_sheet\"\nspacing = \"250 um\"\n\
                [run]\nduration = \"450 ms\"\n[numerics]\nframe_interval = \"2 ms\"";
    let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let run = RunFile::from_text(text).unwrap().resolve().unwrap();
    let shaped = run.shape.mesh(&run.shape.bytes(none).unwrap()).unwrap();
    let outcome = run.make(shaped, none).unwrap().simulation.build().unwrap().run(|_| true);
    let recording = &outcome.recording;
    let simulated = recording.wave.as_ref().unwrap();
    // A pixel for each node; the light of the dye falls where the potential rises.
    let nodes = simulated.beats.len();
    let low = simulated.points.each_ref().map(|x| x.iter().copied().fold(f64::INFINITY, f64::min));
    let place = |node: usize| {
        [0, 1].map(|k: usize| ((simulated.points[k][node] - low[k]) / 250.0).round() as usize)
    };
    let [right, high] = [0, 1].map(|k: usize| (0..nodes).map(|node| place(node)[k]).max().unwrap());
    let (columns, rows) = (right + 1, high + 1);
    let mut bytes = format!("YUV4MPEG2 W{columns} H{rows} F500:1 Cmono16\n").into_bytes();
    let mut frames = 0;
    for frame in recording.frames.iter().filter(|frame| frame.t_ms.rem_euclid(2.0) == 0.0) {
        let mut light = vec![20_000_u16; columns * rows];
        for (node, potential) in frame.potential_mv.as_ref().unwrap().iter().enumerate() {
            let [column, up] = place(node);
            light[(high - up) * columns + column] = (20_000.0 - 20.0 * potential) as u16;
        }
        bytes.extend(b"FRAME\n");
        bytes.extend(light.iter().flat_map(|value| value.to_le_bytes()));
        frames += 1;
    }
    assert_eq!(frames, 226);
    let film = Film::read(bytes, &Selection::default()).unwrap();
    let settings = OpticalSettings {
        frames_per_second: 500.0,
        pixel_um: 250.0,
        stimuli_ms: vec![50.0],
        falls: None,
    };
    let map = OpticalMap::of(&film, &settings, |_| true).unwrap();
    assert!(map.falls && map.beats.len() == 1);
    let truth = outcome.wave_map().unwrap();
    // Both are lists of the nodes of a lattice, perhaps in another order.
    let found = map.in_frame(&map.beats[0].map.activation_ms);
    let lasted = map.in_frame(&map.beats[0].map.duration_ms);
    let (mut off, mut longer) = (Vec::new(), Vec::new());
    for node in 0..nodes {
        let [column, up] = place(node);
        let at = |frame: &[Vec<f64>]| frame[high - up][column];
        if let (Some(time), true) = (truth.activation_ms[node], at(&found).is_finite()) {
            off.push((at(&found) - time).abs());
        }
        if let (Some(time), true) = (truth.duration_ms[node], at(&lasted).is_finite()) {
            longer.push((at(&lasted) - time).abs());
        }
    }
    // To half a frame, where most places are.
    assert!(
        10 * off.len() > 9 * nodes && 10 * longer.len() > 9 * nodes,
        "{} {}",
        off.len(),
        longer.len()
    );
    let [off, longer] = [off, longer].map(|all| median(all).unwrap());
    assert!(off < 1.0 && longer < 4.0, "{off} {longer} ms");
    let velocity = |metrics| value(metrics, "conduction_velocity").unwrap();
    let (measured, known) =
        (velocity(&map.beats[0].metrics), outcome.beats()[0].value("conduction_velocity").unwrap());
    assert!((measured / known - 1.0).abs() < 0.05, "{measured} and {known} cm/s");
}
