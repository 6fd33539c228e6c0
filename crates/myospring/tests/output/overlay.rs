//! The overlay: a made-up picture with lines over it.

use myospring::mesh::pixel_size::PixelSize;
use myospring::mesh::{Mesh, lattice};
use myospring::output::figure::{
    self, Contour, Figure, FigureError, Overlay, Sarcomeres, Tick, overlay,
};

use super::drawn::{Pixels, size};

const PIXEL: f64 = 0.5;
const SIZE: [usize; 2] = [120, 100];
/// Corners of a cell in the upper left of the picture, um, y upward.
const CELL: [[f64; 2]; 4] = [[6.0, 26.0], [36.0, 26.0], [36.0, 44.0], [6.0, 44.0]];

/// Grey, with a bright block where [`CELL`] is.
fn picture() -> Vec<f32> {
    let bright = |at: usize| {
        let [x, y] = [at % SIZE[0], SIZE[1] - 1 - at / SIZE[0]].map(|i| (i as f64 + 0.5) * PIXEL);
        (6.0..36.0).contains(&x) && (26.0..44.0).contains(&y)
    };
    (0..SIZE[0] * SIZE[1]).map(|at| if bright(at) { 900.0 } else { 300.0 }).collect()
}

fn plain(values: &[f32]) -> Overlay<'_> {
    Overlay {
        title: "picture.tif",
        width: SIZE[0],
        height: SIZE[1],
        values,
        pixel_size: PixelSize::new(PIXEL).unwrap(),
        cells: &[],
        chosen: figure::CELL,
        mesh: None,
        fibres: &[],
        sarcomeres: None,
        warnings: &[],
    }
}

/// The lattice of [`CELL`], there.
fn mesh() -> Mesh {
    let mut mesh = lattice::rectangle(15, 9, 2.0).unwrap();
    for (axis, shift) in [6.0, 26.0].into_iter().enumerate() {
        mesh.points[axis].iter_mut().for_each(|x| *x += shift);
    }
    mesh
}

/// Pixels per px of the drawing.
const SCALE: f64 = 3.0;

fn drawn(figure: &Figure) -> Pixels {
    Pixels::of(figure, 96.0 * SCALE)
}

/// Left, top, width and height of a panel, px, if the figure has it.
fn panel(figure: &Figure, name: &str) -> Option<[f64; 4]> {
    let svg = figure.to_svg();
    let (_, rest) = svg.split_once(&format!(r#"<clipPath id="panel-{name}-"#))?;
    let (_, rest) = rest.split_once(r#""><path d="m"#)?;
    // A corner, then steps to the right and down.
    let steps = rest.split_once('z').unwrap().0.replace('-', " -");
    let steps: Vec<f64> = steps.split_whitespace().map(|step| step.parse().unwrap()).collect();
    Some([steps[0], steps[1], steps[2], steps[5]])
}

/// The colour at a point of panel A, which shows the whole picture.
fn colour(figure: &Figure, png: &Pixels, [x, y]: [f64; 2]) -> [u8; 3] {
    let [left, top, width, height] = panel(figure, "A").unwrap();
    let full = SIZE.map(|length| length as f64 * PIXEL);
    let at = [left + width * x / full[0], top + height * (1.0 - y / full[1])];
    png.at(at.map(|at| (SCALE * at) as usize))
}

fn is_yellow([red, green, blue]: [u8; 3]) -> bool {
    red > 190 && green > 180 && blue < 150
}

#[test]
fn the_outline_lies_on_the_edge_that_the_picture_shows() {
    let values = picture();
    let cell = Contour { name: "1", rings: vec![&CELL], chosen: true };
    let figure = overlay(&Overlay { cells: &[cell], ..plain(&values) }).unwrap();
    let png = drawn(&figure);
    for on in [[6.0, 35.0], [36.0, 30.0], [20.0, 44.0], [20.0, 26.0]] {
        let found = colour(&figure, &png, on);
        assert!(is_yellow(found), "{on:?}: {found:?}");
        // 1 um is some ten px of the drawing, the line one.
        for near in [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]] {
            let off = colour(&figure, &png, [on[0] + near[0], on[1] + near[1]]);
            assert!(!is_yellow(off), "{on:?} + {near:?}: {off:?}");
        }
    }
    // The block is white and its surroundings black, after stretching.
    assert_eq!(colour(&figure, &png, [10.0, 40.0]), [255; 3]);
    assert_eq!(colour(&figure, &png, [50.0, 10.0]), [0; 3]);
    assert_eq!(colour(&figure, &png, [10.0, 10.0]), [0; 3]);
}

#[test]
fn a_line_stays_readable_on_white_and_on_black() {
    for level in [0.0, 255.0] {
        // Two grey values, so that the picture is stretched from black to white.
        let mut values = vec![level; SIZE[0] * SIZE[1]];
        values[..600].fill(255.0 - level);
        let cell = Contour { name: "1", rings: vec![&CELL], chosen: true };
        let figure = overlay(&Overlay { cells: &[cell], ..plain(&values) }).unwrap();
        let png = drawn(&figure);
        let across: Vec<[u8; 3]> =
            (-40..40).map(|k| colour(&figure, &png, [6.0 + 0.02 * f64::from(k), 35.0])).collect();
        assert!(across.iter().any(|&found| is_yellow(found)), "{across:?}");
        // Beside the line it is dark, on white too.
        assert!(across.iter().any(|found| found.iter().all(|&level| level < 140)), "{across:?}");
    }
}

#[test]
fn fibres_point_up_where_they_should() {
    let values = picture();
    let cell = Contour { name: "1", rings: vec![&CELL], chosen: true };
    let half = 0.5_f64.sqrt();
    let tick = |from_picture| Tick {
        point_um: [21.0, 35.0],
        direction: [half, half],
        coherency: 0.9,
        from_picture,
    };
    for (from_picture, label) in [(true, "fibre (faint"), (false, "fibre assumed")] {
        let fibres = [tick(from_picture)];
        let cells = [cell.clone()];
        let figure =
            overlay(&Overlay { cells: &cells, fibres: &fibres, ..plain(&values) }).unwrap();
        assert!(figure.to_svg().contains(label), "{label}");
        // Panel B is centred on the cell, and so is the tick; the block behind is white.
        let [left, top, width, height] = panel(&figure, "B").unwrap();
        let png = drawn(&figure);
        let near = |dx: f64, dy: f64| {
            let at = [left + 0.5 * width + dx, top + 0.5 * height + dy];
            png.at(at.map(|at| (SCALE * at) as usize))
        };
        assert_eq!(near(2.0, 2.0), [255; 3]);
        assert_ne!(near(1.6, -1.6), [255; 3]);
        assert_ne!(near(-1.6, 1.6), [255; 3]);
    }
}

#[test]
fn lattice_and_fibres_get_a_panel_of_their_own() {
    let values = picture();
    let mesh = mesh();
    let cells = [
        Contour { name: "7", rings: vec![&CELL], chosen: true },
        Contour {
            name: "8",
            rings: vec![&[[50.0, 5.0], [58.0, 5.0], [54.0, 12.0]]],
            chosen: false,
        },
    ];
    let warnings = ["the cell touches the frame".to_owned(), "two <cells> & more".to_owned()];
    let whole = Overlay { cells: &cells, mesh: Some(&mesh), warnings: &warnings, ..plain(&values) };
    let figure = overlay(&whole).unwrap();
    assert!(panel(&figure, "A").is_some() && panel(&figure, "B").is_some());
    for words in [
        "picture.tif",
        "Picture and outline",
        "Lattice",
        "other cells",
        ">8<",
        "10 \u{b5}m",
        "the cell touches the frame",
        "two &lt;cells&gt; &amp; more",
    ] {
        assert!(figure.to_svg().contains(words), "{words} is missing");
    }
    let [width, _] = size(&figure);
    assert!((width * 25.4 / 96.0 - 178.0).abs() < 0.01, "{width} px");
    assert_eq!(overlay(&whole).unwrap(), figure);
    // With neither, and the cell nearly as large as the picture, one panel is enough.
    let large = [[2.0, 2.0], [58.0, 2.0], [58.0, 48.0], [2.0, 48.0]];
    let cells = [Contour { name: "1", rings: vec![&large], chosen: true }];
    let figure = overlay(&Overlay { cells: &cells, ..plain(&values) }).unwrap();
    assert!(panel(&figure, "B").is_none());
}

#[test]
fn lengths_of_sarcomeres_stand_below_the_panels_with_their_median() {
    let values = picture();
    let cells = [Contour { name: "1", rings: vec![&CELL], chosen: true }];
    let without = overlay(&Overlay { cells: &cells, ..plain(&values) }).unwrap();
    let with = |lengths_um: &[f64]| {
        let sarcomeres = Some(Sarcomeres { lengths_um, median_um: 1.834, read_pct: 63.0 });
        overlay(&Overlay { cells: &cells, sarcomeres, ..plain(&values) }).unwrap()
    };
    // One length is far beside all others, as is one that is no number.
    let lengths: Vec<f64> = (0..200).map(|i| 1.7 + 0.001 * f64::from(i)).collect();
    let figure = with(&[&lengths[..], &[50.0, f64::NAN]].concat());
    for words in ["median 1.83 \u{b5}m", "n = 201 triangles", "63 % of the cell read", ">1.4<"] {
        assert!(figure.to_svg().contains(words), "{words} is missing");
    }
    assert!(!figure.to_svg().contains("NaN"));
    // The panels stay where they are: the histogram covers nothing.
    for name in ["A", "B"] {
        assert_eq!(panel(&figure, name), panel(&without, name));
    }
    assert!(size(&figure)[1] > size(&without)[1] + 80.0);
    assert!(with(&[]) == without, "of no length nothing is drawn");
}

#[test]
fn a_large_picture_is_embedded_small() {
    let values: Vec<f32> = (0..4000 * 1000).map(|at| (at % 977) as f32).collect();
    let figure = overlay(&Overlay { width: 4000, height: 1000, ..plain(&values) }).unwrap();
    // 1600 x 400 pixels, a byte each at most, and a third more as text.
    let length = figure.to_svg().len();
    assert!(length < 900_000, "{length}");
}

#[test]
fn odd_pictures_are_drawn() {
    for (width, height) in [(1, 1), (1, 900), (900, 1), (30, 20)] {
        for value in [0.0, 7.0, f32::NAN, f32::INFINITY, f32::MAX] {
            let mut values = vec![value; width * height];
            values[0] = -f32::MAX;
            let ring = [[0.0, 0.0], [1e9, 0.0], [0.0, -1e9]];
            let cells =
                [Contour { name: "1", rings: vec![&ring, &[], &[[0.1, 0.1]]], chosen: true }];
            let odd = Overlay { width, height, cells: &cells, ..plain(&values) };
            let figure = overlay(&odd).unwrap();
            let svg = figure.to_svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            figure.to_png(96.0).unwrap();
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_an_error_that_names_it() {
    let values = picture();
    let nowhere = [[1.0, 1.0], [f64::NAN, 2.0], [3.0, 1.0]];
    let broken = [Contour { name: "5", rings: vec![&nowhere], chosen: false }];
    let tick =
        Tick { point_um: [1.0, 1.0], direction: [0.0, 0.0], coherency: 1.0, from_picture: true };
    let lost = [Tick { point_um: [f64::INFINITY, 0.0], direction: [1.0, 0.0], ..tick }];
    let mut mesh = mesh();
    mesh.points[1][3] = f64::NAN;
    let full = plain(&values);
    for (wrong, message) in [
        (Overlay { width: 0, ..full.clone() }, "given 0 pixels"),
        (Overlay { height: 99, ..full.clone() }, "120 x 99 pixels needs 11880 values, but 12000"),
        (Overlay { width: usize::MAX, ..full.clone() }, "but 12000 were given"),
        (Overlay { cells: &broken, ..full.clone() }, "the outline of cell \"5\" puts point 1 at"),
        (Overlay { fibres: &[tick], ..full.clone() }, "fibre direction (0, 0)"),
        (Overlay { fibres: &lost, ..full.clone() }, "the fibre field puts point 0 at (inf, 0)"),
        (Overlay { mesh: Some(&mesh), ..full.clone() }, "the mesh puts point 3"),
    ] {
        let error: FigureError = overlay(&wrong).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
}

#[test]
fn several_cells_carry_their_names_in_a_single_panel_too() {
    let square = |x: f64| [[x, 1.0], [x + 8.0, 1.0], [x + 8.0, 19.0], [x, 19.0]];
    let rings = [square(1.0), square(11.0)];
    let cells: Vec<Contour> = ["left one", "right one"]
        .into_iter()
        .zip(&rings)
        .map(|(name, ring)| Contour { name, rings: vec![ring], chosen: true })
        .collect();
    let figure = overlay(&Overlay {
        title: "",
        width: 20,
        height: 20,
        values: &[0.5; 400],
        pixel_size: PixelSize::MICROMETRE,
        cells: &cells,
        chosen: figure::CELL,
        mesh: None,
        fibres: &[],
        sarcomeres: None,
        warnings: &[],
    });
    let svg = figure.unwrap().to_svg();
    assert!(svg.contains("left one") && svg.contains("right one") && !svg.contains("panel-B"));
}
