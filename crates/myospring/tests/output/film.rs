//! Films of made-up beats, read back as a viewer does.

use crate::synthetic::{STIMULUS, elongated, recording};

use gif::{DecodeOptions, DisposalMethod, Repeat};
use myospring::mesh::lattice;
use myospring::mesh::outline::Outline;
use myospring::output::field::{Field, Fields};
use myospring::output::figure::{BeatFilm, DrawnCell, FigureError, Theme};
use myospring::recording::Recording;

fn disc(radius: f64) -> Outline {
    let corner = |k| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 360.0).sin_cos();
        [radius * cos, radius * sin]
    };
    Outline::new((0..360).map(corner).collect(), Vec::new()).unwrap()
}

#[test]
fn a_gif_decodes_to_the_frames_that_were_drawn() {
    let mesh = elongated(4.0);
    let run = recording(&mesh, [1.0, 0.0], 50.0, false);
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let cell = DrawnCell::new(Fields::new(&mesh, &fibres, None).unwrap(), None).unwrap();
    let film = BeatFilm::new(&cell, &run, &[STIMULUS], 5.0, Theme::Light).unwrap();
    // 600 ms in steps of 40 ms of film, 8 ms of the beat, both ends included.
    assert_eq!((film.len(), film.time(1), film.time(75)), (76, 8.0, 600.0));
    let stills: Vec<_> = (0..film.len()).map(|index| film.still(index).unwrap()).collect();
    let bytes = film.gif(&stills).unwrap();
    assert!(bytes.len() < 1_000_000, "{} bytes", bytes.len());

    let mut options = DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes.as_slice()).unwrap();
    let size = [decoder.width(), decoder.height()].map(usize::from);
    assert_eq!((size[0], decoder.repeat()), (480, Repeat::Infinite));
    let mut canvas = vec![0; 4 * size[0] * size[1]];
    let (mut count, mut worst) = (0, 0);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!((frame.delay, frame.dispose), (4, DisposalMethod::Keep));
        let [left, top] = [frame.left, frame.top].map(usize::from);
        for (row, pixels) in frame.buffer.chunks_exact(4 * usize::from(frame.width)).enumerate() {
            for (column, pixel) in pixels.chunks_exact(4).enumerate().filter(|(_, p)| p[3] > 0) {
                let at = 4 * ((top + row) * size[0] + left + column);
                canvas[at..at + 4].copy_from_slice(pixel);
            }
        }
        let (drawn_size, drawn) = film.pixels(count, 1.0).unwrap();
        assert_eq!(drawn_size.map(|side| side as usize), size);
        let off = canvas
            .chunks_exact(4)
            .zip(drawn.chunks_exact(3))
            .filter(|(shown, drawn)| shown.iter().zip(*drawn).any(|(a, b)| a.abs_diff(*b) > 40));
        worst = worst.max(off.count());
        count += 1;
    }
    assert_eq!(count, film.len());
    // Colours of the edges of letters and dots lie between those of the palette.
    assert!(worst < size[0] * size[1] / 200, "{worst} pixels are off");
}

#[test]
fn the_colour_reaches_the_outline_everywhere_without_a_gap() {
    let outline = disc(20.0);
    // Steps of 4 um would stand out 40 px far.
    let (mesh, _) = lattice::from_outline(&outline, Some(4.0)).unwrap();
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let run = recording(&mesh, [1.0, 0.0], 50.0, false);
    let rest = Recording { frames: run.frames[..1].to_vec(), ..Recording::default() };
    let cell = DrawnCell::new(Fields::new(&mesh, &fibres, None).unwrap(), Some(&outline)).unwrap();
    let cell = cell.coloured_by(Field::Displacement).scaled_to(&run.frames);
    let film = BeatFilm::new(&cell, &rest, &[], 1.0, Theme::Light).unwrap();
    assert_eq!(film.len(), 1);
    let ([width, _], pixels) = film.pixels(0, 1.0).unwrap();
    // The cell is 320 px high and starts 30 px from the top.
    let (radius, middle) = (160.0, [240.0, 190.0]);
    let inside = &pixels[3 * (190 * width as usize + 240)..][..3];
    // The first of 64 steps from rest.
    assert!(inside.iter().zip([0xfc, 0xfd, 0xbf]).all(|(a, b)| a.abs_diff(b) < 3), "{inside:?}");
    for (index, pixel) in pixels.chunks_exact(3).enumerate() {
        let (x, y) = (index % width as usize, index / width as usize);
        let away = (x as f64 + 0.5 - middle[0]).hypot(y as f64 + 0.5 - middle[1]);
        // Half a pen and the edge of a pixel on either side of the line.
        if away < radius - 2.0 {
            assert_eq!(pixel, inside, "({x}, {y})");
        } else if away > radius + 2.0 && (30..350).contains(&y) {
            assert_eq!(pixel, [0xff; 3], "({x}, {y})");
        }
    }
}

#[test]
fn a_film_ends_with_its_beat_and_is_dark_where_that_was_asked_for() {
    let mesh = elongated(4.0);
    let run = recording(&mesh, [1.0, 0.0], 50.0, false);
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let cell = DrawnCell::new(Fields::new(&mesh, &fibres, None).unwrap(), None).unwrap();
    let film = BeatFilm::new(&cell, &run, &[STIMULUS, 450.0], 1.0, Theme::Dark).unwrap();
    // 450 ms in steps of 40 ms.
    assert_eq!((film.len(), film.time(11)), (12, 440.0));
    let (_, pixels) = film.pixels(3, 1.0).unwrap();
    assert_eq!(pixels[..3], [0x14, 0x17, 0x1c]);
    let empty = Recording::default();
    let none = BeatFilm::new(&cell, &empty, &[], 1.0, Theme::Light);
    assert!(matches!(none, Err(FigureError::Nothing { what: "frames" })));
    for slowed in [0.0, 0.5, f64::NAN, f64::INFINITY] {
        let error = BeatFilm::new(&cell, &run, &[], slowed, Theme::Light).unwrap_err();
        assert!(matches!(error, FigureError::Slowed { .. }));
    }
}
