//! Sarcomeres by their period: what repeats answers, however weak; what does not stays silent, however strong.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::f64::consts::TAU;

use crate::common::{self, pixels_of};
use crate::fibres::{Scene, apart, noise};
use myospring::microscopy::fibres::{FibreField, FibreSettings, SarcomereDoubt, Stain, fibres};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::read::read_picture;

/// A slender cell that lies at an angle.
fn rod(pixel: f64, axis_deg: f64) -> Scene {
    Scene { side_um: 64.0, pixel, half: [30.0, 10.0], axis_deg }
}

/// Narrow stripes 0 to 1 along `u`, so far apart.
fn stripes(u: f64, period_um: f64) -> f64 {
    (1.5 * ((TAU * u / period_um).cos() - 1.0)).exp()
}

/// Bright columns along a rod, 1 to 1.5 um apart, which wander: their height across it, at `v`.
fn columns(u: f64, v: f64) -> f64 {
    let wandering = v + 0.3 * (u / 5.0).sin() + 0.2 * (u / 2.3 + 0.4 * v).cos();
    // Distances that vary with incommensurate waves.
    let place =
        wandering / 1.25 + 0.35 * (0.9 * wandering).sin() + 0.2 * (2.1 * wandering + 1.0).sin();
    (3.0 * ((TAU * place).cos() - 1.0)).exp() * (1.0 + 0.4 * (u / 4.0 + 3.0 * place).sin())
}

/// A picture of a rod by what it shows along and across it.
fn read(scene: &Scene, grey: impl Fn(f64, f64) -> f64, noisy: f64) -> FibreField {
    let (sin, cos) = scene.axis_deg.to_radians().sin_cos();
    let mut noise = noise(scene.axis_deg as u64 + 5);
    let plane = scene
        .plane(|[x, y]| 1000.0 * (grey(cos * x + sin * y, cos * y - sin * x) + noisy * noise()));
    scene.field(&plane, Stain::ZDisc)
}

/// The length of the sarcomeres that were read.
fn length(field: &FibreField) -> f64 {
    field.summary().median_sarcomere_um.unwrap()
}

#[test]
fn columns_ten_times_as_strong_as_the_stripes_do_not_turn_the_fibres() {
    for (pixel, angle) in [(0.1, 20.0), (0.2, 0.0), (0.2, 65.0), (0.3, 140.0), (0.4, 110.0)] {
        for strength in [1.0, 10.0] {
            let scene = rod(pixel, angle);
            let grey = |u: f64, v: f64| strength * columns(u, v) + stripes(u, 1.85);
            let field = read(&scene, grey, 0.2);
            let answered: Vec<f64> = (field.on_grid(1.0).into_iter())
                .filter(|(_, fibre)| fibre.from_picture)
                .map(|(_, fibre)| apart(fibre.angle_deg(), angle))
                .collect();
            let far =
                answered.iter().filter(|&&off| off > 30.0).count() as f64 / answered.len() as f64;
            let mut sorted = answered;
            sorted.sort_by(f64::total_cmp);
            let median = sorted[sorted.len() / 2];
            let summary = field.summary();
            let case = format!("{pixel} um, {angle} deg, columns {strength}: {summary:?}");
            // Through the strongest columns coarse pixels show stripes in two thirds of the cell.
            assert!(summary.share_from_picture > 0.6, "{case}");
            assert!(median < 3.0 && far < 0.02, "{case}: median {median} deg, {far} far off");
            // Columns that wander bend the phase of what is seen through them by a little.
            assert!((length(&field) / 1.85 - 1.0).abs() < 0.01, "{case}");
        }
    }
}

#[test]
fn sarcomeres_have_their_length_within_half_a_per_cent() {
    for (pixel, period) in [(0.08, 1.6), (0.15, 1.85), (0.2, 2.0), (0.3, 2.2), (0.27, 1.5)] {
        let field = read(&rod(pixel, 33.0), |u, _| stripes(u, period), 0.1);
        let found = length(&field);
        // The peak is half a sample wide of the list of wave numbers, which grow by 7 %.
        assert!((found / period - 1.0).abs() < 0.005, "{pixel} um: {found} for {period}");
        let [first, third] = field.summary().sarcomere_quartiles_um.unwrap();
        assert!(third - first < 0.02, "{pixel} um: {first} to {third}");
    }
}

#[test]
fn what_has_no_period_does_not_answer() {
    type Grey<'a> = &'a dyn Fn(f64, f64) -> f64;
    let scene = rod(0.2, 40.0);
    let line = |x: f64| (-0.5 * (x / 0.3).powi(2)).exp();
    let pictures: [(&str, Grey<'_>); 6] = [
        ("noise", &|_, _| 0.0),
        ("columns", &|u, v| 5.0 * columns(u, v)),
        ("one line along", &|_, v| 10.0 * line(v - 1.0)),
        ("one line across", &|u, _| 10.0 * line(u - 3.0)),
        ("an edge", &|u, v| if 0.5 * u + v > 0.0 { 5.0 } else { 0.0 }),
        ("a rim", &|u, v| 10.0 * line(4.0 * ((u / 30.0).hypot(v / 10.0) - 0.95))),
    ];
    for (name, grey) in pictures {
        let summary = read(&scene, grey, 0.3).summary();
        assert!(summary.share_from_picture < 0.02, "{name}: {summary:?}");
    }
}

#[test]
fn a_nucleus_among_stripes_stays_silent() {
    let scene = rod(0.15, 10.0);
    let within = |u: f64, v: f64| (u / 7.0).hypot(v / 5.0);
    let field = read(&scene, |u, v| if within(u, v) < 1.0 { 0.4 } else { stripes(u, 1.85) }, 0.15);
    let [middle, beside] = [[0.0, 0.0], [14.0, 2.0]].map(|at| field.at(scene.point(at)));
    assert!(!middle.from_picture && middle.sarcomere_um.is_none(), "{middle:?}");
    assert!(beside.from_picture && beside.coverage > 0.9, "{beside:?}");
    assert!(middle.coverage < 0.5 && middle.order < 0.1, "{middle:?}");
}

#[test]
fn stripes_that_no_sarcomere_has_are_said_and_not_used() {
    for (period, pixel) in [(1.09, 0.1), (0.8, 0.1), (3.7, 0.3), (3.0, 0.3)] {
        let scene = Scene { side_um: 44.0, half: [20.0, 9.0], ..rod(pixel, 25.0) };
        let field = read(&scene, |u, _| stripes(u, period), 0.1);
        assert_eq!(field.summary().share_from_picture, 0.0, "{period} um");
        let misfit = field.misfit().unwrap();
        assert!((misfit.period_um / period - 1.0).abs() < 0.03, "{period} um: {misfit:?}");
        let warning = field.warnings().remove(0);
        assert!(warning.contains("um apart: is the pixel size"), "{warning}");
        assert!(warning.contains("sarcomeres are 1.4 to 2.6 um long"), "{warning}");
        let fitting = pixel * 1.85 / period;
        assert!((misfit.fitting_pixel_um() / fitting - 1.0).abs() < 0.03, "{misfit:?}");
    }
}

#[test]
fn a_length_that_is_printed_is_right_or_said_to_be_doubtful() {
    // Made-up cells over what sarcomeres have and beyond, at pixels that show them well and hardly.
    for (pixel, step) in [(0.12, 0.07), (0.3, 0.14)] {
        let periods =
            (0..).map(|at| 1.1 + step * f64::from(at)).take_while(|period| *period < 3.25);
        for period in periods {
            let scene = Scene { side_um: 40.0, half: [18.0, 8.0], ..rod(pixel, 25.0) };
            let field = read(&scene, |u, _| stripes(u, period), 0.1);
            let summary = field.summary();
            let case = format!("{period:.2} um in pixels of {pixel} um: {summary:?}");
            let is_usual = (1.56..2.32).contains(&period);
            match (summary.median_sarcomere_um, summary.sarcomere_doubt) {
                // As of the lengths in the middle of the band; ends of a small cell cost another half per cent.
                (Some(found), None) => {
                    assert!((found / period - 1.0).abs() < 0.01 && is_usual, "{case}");
                }
                (Some(_), Some(doubt)) => {
                    assert!(!is_usual, "{case}");
                    let said = field.doubts().concat();
                    assert!(
                        said.contains("is doubtful") && said.contains(&doubt.to_string()),
                        "{said}"
                    );
                }
                (None, _) => assert!(!(1.45..2.55).contains(&period), "{case}"),
            }
            // What is beyond the band is measured there, not at its end.
            if let Some(misfit) = field.misfit() {
                assert!((misfit.period_um / period - 1.0).abs() < 0.03, "{case} {misfit:?}");
            }
        }
    }
}

#[test]
fn a_length_from_a_small_part_of_a_cell_is_doubtful() {
    let scene = rod(0.15, 10.0);
    let patch = |u: f64, v: f64| (u + 20.0).hypot(v) < 4.0;
    let field = read(&scene, |u, v| if patch(u, v) { stripes(u, 1.85) } else { 0.4 }, 0.1);
    let summary = field.summary();
    let doubt = summary.sarcomere_doubt;
    assert!(matches!(doubt, Some(SarcomereDoubt::FewPlaces { .. })), "{summary:?}");
    assert!(field.doubtful_lengths()(1.85), "{summary:?}");
    let whole = read(&scene, |u, _| stripes(u, 1.85), 0.1);
    assert_eq!(whole.summary().sarcomere_doubt, None);
    let is_doubtful = whole.doubtful_lengths();
    assert_eq!([1.45, 1.85, 2.5].map(is_doubtful), [true, false, true]);
}

#[test]
fn doublets_a_sarcomere_apart_have_the_length_of_the_sarcomere() {
    // M-bands half as bright between z-discs: the half period is stronger than the whole one.
    let field = read(&rod(0.15, 70.0), |u, _| stripes(u, 1.9) + 0.6 * stripes(u + 0.95, 1.9), 0.1);
    assert!((length(&field) / 1.9 - 1.0).abs() < 0.01, "{:?}", field.summary());
}

#[test]
fn fibres_across_a_slender_cell_are_named_with_what_to_try() {
    let scene = rod(0.2, 0.0);
    let plane = scene.plane(|[_, y]| 1000.0 * stripes(y, 1.85));
    let warning = scene.field(&plane, Stain::ZDisc).warnings().remove(0);
    for part in ["lie across the cell (3 times as long as wide", "90 degrees", "--stain filament"] {
        assert!(warning.contains(part), "{warning}");
    }
}

#[test]
fn real_cells_have_the_sarcomeres_that_another_program_finds() {
    // Medians of SarcGraph 0.3.0 over the whole picture, um: distances of z-discs that it pairs.
    for (picture, mask, pixel, expected) in [
        ("images/sarcgraph_e2_rest.png", Some("images/sarcgraph_e2_mask.png"), 0.18, 2.019),
        ("images/sarcgraph_e1_rest.png", None, 0.18, 2.004),
    ] {
        let read = |file: &str| {
            let bytes = std::fs::read(common::shared_data(file)?).unwrap();
            Some(read_picture(&bytes, &Selection::default()).unwrap().plane)
        };
        let Some(plane) = read(picture) else { return };
        let inside = match mask {
            None => vec![true; plane.values().len()],
            Some(mask) => {
                let Some(mask) = read(mask) else { return };
                mask.values().iter().map(|&value| value > 0.0).collect()
            }
        };
        let settings = FibreSettings::of(Stain::ZDisc);
        let field = fibres(&plane, &inside, pixels_of(pixel), [1.0, 0.0], &settings).unwrap();
        // It measures straight distances of what it takes for neighbours, in a larger area.
        let found = length(&field);
        assert!((found / expected - 1.0).abs() < 0.03, "{picture}: {found} um, {expected} um");
        assert!(field.summary().share_from_picture > 0.5, "{picture}: {:?}", field.summary());
    }
}
