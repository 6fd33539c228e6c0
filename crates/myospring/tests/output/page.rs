//! `report.html`: what goes into the page. That it beats is tested in a browser, beside the page's source.

use crate::synthetic::{STIMULUS, recording};
use myospring::analysis::curve::{CurveOptions, analyse};
use myospring::analysis::kind::Kind;
use myospring::analysis::summary::Summary;
use myospring::mesh::outline::Outline;
use myospring::mesh::pixel_size::PixelSize;
use myospring::mesh::{Mesh, lattice};
use myospring::output::field::Field;
use myospring::output::figure::Measured;
use myospring::output::page::{
    self, Chart, Page, PageError, PageRun, Part, Photograph, Runs, Section,
};
use myospring::recording::Recording;
use serde_json::Value;

const NASTY: &str = "</script><script>alert(1)</script>\"'&\u{2028}{{data}}";

/// A cell of 140 um x 20 um with rounded ends, its beat, and what is said of it.
struct Cell {
    outline: Outline,
    mesh: Mesh,
    fibres: Vec<[f64; 2]>,
    recording: Recording,
    summary: Summary,
}

impl Cell {
    fn new(spacing: f64) -> Self {
        let ring = (0..200).map(|step| {
            let (sin, cos) = (f64::from(step) / 200.0 * std::f64::consts::TAU).sin_cos();
            [70.0 * cos.signum() * cos.abs().powf(0.3), 10.0 * sin.signum() * sin.abs().powf(0.6)]
        });
        let outline = Outline::new(ring.collect(), Vec::new()).unwrap();
        let (mesh, report) = lattice::from_outline(&outline, Some(spacing)).unwrap();
        let recording = recording(&mesh, [1.0, 0.0], 50.0, false);
        let summary = Summary::new(&recording, &[STIMULUS], None, report, vec![NASTY.to_owned()]);
        Self { outline, fibres: vec![[1.0, 0.0]; mesh.simplices.len()], mesh, recording, summary }
    }

    fn on_page(&self) -> PageRun<'_> {
        PageRun {
            label: "50 kPa",
            summary: &self.summary,
            recording: &self.recording,
            mesh: &self.mesh,
            fibres: &self.fibres,
            myofibril_content: None,
            outline: &self.outline,
            stimulus_times_ms: &[STIMULUS],
            parameters: Vec::new(),
            run_file: NASTY,
            citations: "",
            picture: None,
            thick: None,
        }
    }
}

fn made(runs: Vec<PageRun<'_>>) -> Result<String, PageError> {
    let runs = Runs { runs, differences: &[] };
    let mut sections = vec![runs.key_numbers(), runs.beat(Field::FibreStrain, Vec::new())];
    sections.extend(runs.record());
    page::html(&Page {
        kind: "",
        title: NASTY,
        facts: vec![NASTY.to_owned()],
        answer: None,
        warnings: runs.warnings(),
        sections,
    })
}

fn html(runs: Vec<PageRun<'_>>) -> String {
    made(runs).unwrap()
}

/// The cells in the data of a page.
fn cells(html: &str) -> Value {
    data(html)["sections"][1]["parts"][0]["cells"].clone()
}

/// The data of a page.
fn data(html: &str) -> Value {
    let (_, rest) = html.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn whatever_a_run_is_called_stays_text() {
    let cell = Cell::new(4.0);
    let page = html(vec![cell.on_page()]);
    assert!(!page.contains("alert(1)</script>"));
    assert_eq!(page.matches("<title>").count(), 1);
    let data = data(&page);
    let repeat =
        data["sections"].as_array().unwrap().iter().find(|it| it["id"] == "repeat").unwrap();
    let run_file = &repeat["parts"][1]["text"];
    for text in [&data["title"], &data["facts"][0], &data["warnings"][0], run_file] {
        assert_eq!(text, NASTY);
    }
}

#[test]
fn a_page_asks_nothing_of_any_network() {
    let cell = Cell::new(4.0);
    let page = html(vec![cell.on_page()]);
    assert!(page.contains("default-src 'none'"));
    for word in ["src=\"http", "href=\"http", "@import", "url(http", "fetch(", "XMLHttpRequest"] {
        assert!(!page.contains(word), "{word}");
    }
}

#[test]
#[ignore = "slow"]
fn a_large_cell_and_many_frames_still_make_a_page_of_less_than_three_megabytes() {
    let mut cell = Cell::new(0.35);
    assert!(cell.mesh.len() > 20_000);
    let page = html(vec![cell.on_page()]);
    assert!(page.len() < 3_000_000, "{}", page.len());
    let drawn = cells(&page)[0].clone();
    // Several squares as one, and still no step that is seen: a five-hundredth of the cell.
    assert!(drawn["spacing_um"].as_f64().unwrap() > 0.6);
    assert!(drawn["accuracy_um"].as_f64().unwrap() < 140.0 / 500.0);
    // Twenty beats of a cell of the usual size.
    cell = Cell::new(1.2);
    let beat = cell.recording.frames.clone();
    for number in 1..20 {
        cell.recording.frames.extend(beat.iter().cloned().map(|mut frame| {
            frame.t_ms += 1000.0 * f64::from(number);
            frame
        }));
    }
    let page = html(vec![cell.on_page()]);
    assert!(page.len() < 3_000_000, "{}", page.len());
    assert!(cells(&page)[0]["accuracy_um"].as_f64().unwrap() < 140.0 / 100.0);
    if crate::common::left_to_full() {
        return;
    }
    // And eight of them beside each other, as doses of a drug are, which leave little room for each.
    let runs: Vec<_> = (0..8).map(|_| cell.on_page()).collect();
    let page = html(runs);
    assert!(page.len() < 3_000_000, "{}", page.len());
}

#[test]
fn runs_beside_each_other_share_the_room_of_a_page() {
    let (fine, coarse) = (Cell::new(0.8), Cell::new(3.0));
    let runs = vec![fine.on_page(), coarse.on_page(), fine.on_page()];
    let page = html(runs);
    assert!(page.len() < 3_000_000, "{}", page.len());
    assert_eq!(cells(&page).as_array().unwrap().len(), 3);
    let beat = page::BeatingCells {
        colour: Field::FibreStrain,
        cells: Vec::new(),
        charts: Vec::new(),
        folded: (String::new(), Vec::new()),
        words: String::new(),
    };
    let none = page::html(&Page {
        kind: "",
        title: "",
        facts: Vec::new(),
        answer: None,
        warnings: Vec::new(),
        sections: vec![Section::new("beat", "", vec![Part::Beat(beat)])],
    });
    assert!(matches!(none, Err(PageError::NoRuns)));
}

#[test]
fn a_run_that_broke_or_kept_nothing_has_a_page() {
    let mut cell = Cell::new(4.0);
    for frame in &mut cell.recording.frames[30..] {
        frame.positions[0][3] = f64::NAN;
    }
    for sample in &mut cell.recording.samples[300..] {
        sample.ta_kpa = f64::NAN;
    }
    let shown = cells(&html(vec![cell.on_page()]));
    let frames = &shown[0]["frames"]["t_ms"];
    assert!(frames.as_array().unwrap().iter().all(|t| t.as_f64().unwrap() < 150.0), "{frames}");
    cell.recording = Recording::default();
    let shown = cells(&html(vec![cell.on_page()]));
    assert_eq!(shown[0]["frames"]["t_ms"], serde_json::json!([0.0]));
}

#[test]
fn frames_and_fibres_of_another_mesh_are_refused() {
    let (cell, other) = (Cell::new(4.0), Cell::new(3.0));
    let said = |run: PageRun<'_>| made(vec![run]).unwrap_err().to_string();
    let error = said(PageRun { fibres: &other.fibres, ..cell.on_page() });
    assert!(error.contains("one for each of the triangles"), "{error}");
    let error = said(PageRun { recording: &other.recording, ..cell.on_page() });
    assert!(error.contains("positions along axis 0"), "{error}");
}

#[test]
fn of_a_picture_the_part_around_the_cell_lies_where_the_cell_is() {
    let mut cell = Cell::new(4.0);
    // A picture of 400 um x 100 um with the cell in its middle.
    cell.outline = cell.outline.moved([200.0, 50.0]);
    let values: Vec<f32> = (0..800 * 200).map(|pixel| (pixel % 800) as f32).collect();
    let picture = Photograph {
        width: 800,
        height: 200,
        values: &values,
        pixel_size: PixelSize::new(0.5).unwrap(),
    };
    let shown = cells(&html(vec![PageRun { picture: Some(picture), ..cell.on_page() }]));
    let part = &shown[0]["picture"];
    // 70 um from the middle, and 15 % of 140 um around.
    assert_eq!(part["corners_um"], serde_json::json!([[109.0, 19.0], [291.0, 81.0]]));
    assert!(part["href"].as_str().unwrap().starts_with("data:image/png;base64,iVBOR"));
    // Where they do not meet there is none.
    cell.outline = cell.outline.moved([5000.0, 0.0]);
    let away = cells(&html(vec![PageRun { picture: Some(picture), ..cell.on_page() }]));
    assert_eq!(away[0]["picture"], Value::Null);
}

/// A made-up length of ten beats; in the fifth somebody touches the table, and some frames are missing in the eighth.
fn ten_beats() -> (Vec<f64>, Vec<f64>) {
    let times = (0..1250).map(|frame| 8.0 * f64::from(frame));
    let times: Vec<f64> = times.filter(|time| !(7250.0..7450.0).contains(time)).collect();
    let length = |time: &f64| {
        let phase = (time + 800.0).rem_euclid(1000.0);
        let pulse = if phase < 300.0 { (phase / 300.0 * std::f64::consts::PI).sin() } else { 0.0 };
        let touched = if (4700.0..5100.0).contains(time) { 60.0 } else { 0.0 };
        120.0 - 10.0 * pulse + touched + 0.02 * (7.0 * time * time).sin()
    };
    let values = times.iter().map(length).collect();
    (times, values)
}

#[test]
fn a_measured_curve_is_drawn_whole_and_as_one_beat_without_artefacts_that_would_make_it_small() {
    let (times, values) = ten_beats();
    let analysis = analyse(&times, &values, Kind::Length, "um", &CurveOptions::default()).unwrap();
    let [whole, one] = Chart::of_curve(&Measured {
        title: "cell",
        kind: Kind::Length,
        unit: "um",
        times_ms: &times,
        values: &values,
        analysis: &analysis,
        numbers: &[],
    })
    .try_into()
    .unwrap();
    let numbers = whole.dots.iter().filter(|dot| !dot.words.is_empty()).count();
    assert_eq!(numbers, analysis.beats.len());
    let shaded: Vec<&str> = whole.spans.iter().map(|span| span.words).collect();
    assert!(shaded.contains(&"artefact") && shaded.contains(&"no frames"), "{shaded:?}");
    let highest = |chart: &Chart| {
        let values = chart.series.iter().flat_map(|series| &series.values);
        values.copied().filter(|value| value.is_finite()).fold(0.0, f64::max)
    };
    assert!(highest(&whole) < 125.0, "{}", highest(&whole));
    // Onset, peak, 10, 50 and 90 % of the rise, 50 and 90 % of the way back.
    assert!(one.dots.len() >= 7, "{:?}", one.dots);
    assert!(one.series[0].times_ms.len() < times.len() / 5);
}

#[test]
fn a_thumbnail_is_small_and_a_cell_outside_of_its_picture_has_none() {
    let values: Vec<f32> = (0..800 * 200).map(|pixel| (pixel % 800) as f32).collect();
    let pixel_size = PixelSize::new(0.5).unwrap();
    let picture = Photograph { width: 800, height: 200, values: &values, pixel_size };
    let cell = Cell::new(4.0);
    for (shift, turned) in [([200.0, 50.0], 0.0), ([200.0, 50.0], 90.0)] {
        let outline = cell.outline.rotated(turned).moved(shift);
        let png = picture.thumbnail(&outline).unwrap().unwrap();
        let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        let (width, height) = (side(16), side(20));
        assert!(width.max(height) <= 161 && width.min(height) > 20, "{width} x {height}");
        assert!(png.len() < 40_000, "{}", png.len());
    }
    assert!(picture.thumbnail(&cell.outline.moved([5000.0, 0.0])).unwrap().is_none());
}
