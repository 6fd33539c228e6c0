//! Figures of many members of a study.

use super::drawn::{Pixels, size};
use myospring::output::figure::{
    Distribution, Figure, FigureError, MemberResponse, Numbers, ResponseMap, Scatter, TraceBand,
    distributions, response_map, responses, scatter, trace_bands,
};

const DOUBLE: f64 = 178.0 * 96.0 / 25.4;
const SINGLE: f64 = 85.0 * 96.0 / 25.4;

fn numbers(label: &str, count: usize, value: impl Fn(f64) -> f64) -> Numbers {
    Numbers { label: label.to_owned(), values: (0..count).map(|i| value(i as f64)).collect() }
}

/// Members on a winding curve, so that they do not lie in order.
fn cloud(count: usize) -> Scatter {
    let x = |i: f64| (0.7 * i).sin();
    Scatter {
        metric: numbers("Peak tension (kPa)", count, |i| {
            50.0 + 20.0 * x(i) + 5.0 * (3.1 * i).cos()
        }),
        parameters: (0..5)
            .map(|k| numbers(&format!("tau_{k} (ms)"), count, |i| x(i + f64::from(k))))
            .collect(),
        kept: Some((0..count).map(|i| i % 3 > 0).collect()),
        band: Some([40.0, 60.0]),
    }
}

fn all() -> Vec<(Figure, f64)> {
    let panel = |label: &str, count| Distribution {
        metric: numbers(label, count, |i| (0.7 * i).sin() + (0.01 * i).cos()),
        band: Some([-0.5, 0.5]),
        usual: Some(0.1),
    };
    let kept: Vec<bool> = (0..500).map(|i| i % 2 == 0).collect();
    let response = |metric: &str| MemberResponse {
        parameter: "tau_si (ms)".to_owned(),
        metric: metric.to_owned(),
        points: (0..9).map(|i| [f64::from(i), f64::from(i * i)]).collect(),
        usual: Some(4.0),
        band: Some([10.0, 20.0]),
    };
    let map = |levels: usize| ResponseMap {
        parameters: ["tau_si (ms)", "tau_so1 (ms)"].map(str::to_owned),
        values: [0, 1].map(|_| (0..levels).map(|i| i as f64).collect()),
        metrics: vec![(
            "Peak tension (kPa)".to_owned(),
            (0..levels * levels).map(|i| i as f64).collect(),
        )],
    };
    let times: Vec<f64> = (0..100).map(f64::from).collect();
    let curve = |of: f64| times.iter().map(|t| of * (0.03 * t).sin()).collect::<Vec<f64>>();
    let band = |label: &str| TraceBand {
        label: label.to_owned(),
        quantiles: [1.0, 2.0, 3.0, 4.0, 5.0].map(curve),
        usual: curve(3.5),
    };
    let bands: Vec<TraceBand> =
        ["Potential u", "Active tension (kPa)", "Shortening (%)"].map(band).into();
    vec![
        (scatter(&cloud(300)).unwrap(), DOUBLE),
        (scatter(&cloud(20_000)).unwrap(), DOUBLE),
        (distributions(&[panel("a", 500), panel("b", 500)], Some(&kept)).unwrap(), DOUBLE),
        (distributions(&[panel("a", 5)], None).unwrap(), DOUBLE),
        (responses(&[response("a"), response("a"), response("b"), response("b")]).unwrap(), DOUBLE),
        (response_map(&map(5)).unwrap(), DOUBLE),
        (response_map(&map(12)).unwrap(), DOUBLE),
        (trace_bands(&times, &bands, "2000 members").unwrap(), SINGLE),
    ]
}

#[test]
fn figures_of_members_have_the_width_of_columns_and_are_the_same_bytes_each_time() {
    for ((figure, width), (again, _)) in all().into_iter().zip(all()) {
        // Sizes are whole hundredths of a millimetre.
        assert!((size(&figure)[0] - width).abs() < 0.05);
        assert_eq!(figure.to_svg(), again.to_svg());
        let pixels = Pixels::of(&figure, 96.0);
        let white = pixels.colours.iter().filter(|colour| **colour == [255; 3]).count();
        assert!(white * 3 > pixels.colours.len(), "more paper than ink");
    }
}

#[test]
fn a_scatter_of_a_hundred_thousand_members_is_hardly_larger_than_one_of_ten_thousand() {
    let length = |count| scatter(&cloud(count)).unwrap().to_svg().len();
    let (some, many) = (length(10_000), length(100_000));
    assert!(many < 500_000 && many < 2 * some, "{some} and {many} bytes");
}

#[test]
fn kept_and_rejected_members_have_colours_of_their_own() {
    let svg = scatter(&cloud(300)).unwrap().to_svg();
    assert!(svg.contains("200 members kept") && svg.contains("100 rejected"));
    let one = Scatter { kept: None, ..cloud(300) };
    assert!(!scatter(&one).unwrap().to_svg().contains("rejected"));
}

#[test]
fn members_without_a_number_are_no_figure() {
    let none = |result: Result<Figure, FigureError>| {
        assert!(matches!(result, Err(FigureError::Nothing { .. })));
    };
    let nowhere = numbers("a", 3, |_| f64::NAN);
    none(scatter(&Scatter { metric: nowhere.clone(), ..cloud(3) }));
    none(scatter(&Scatter { parameters: Vec::new(), ..cloud(3) }));
    none(distributions(&[Distribution { metric: nowhere, band: None, usual: None }], None));
    none(responses(&[]));
    none(trace_bands(&[0.0], &[], ""));
    none(response_map(&ResponseMap {
        parameters: ["a", "b"].map(str::to_owned),
        values: [vec![1.0], vec![1.0]],
        metrics: vec![("m".to_owned(), vec![f64::NAN])],
    }));
}
