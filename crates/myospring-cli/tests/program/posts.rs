//! The posts of a tissue in a film.

use super::{json, myospring, names, stderr, stdout};
use std::fs;
use std::path::Path;

/// Two dark squares of 20 pixels, 100 pixels apart, that a tissue between them draws together by up to 4 pixels each, twice; 50 frames a
/// second, with a little noise.
fn film(path: &Path) {
    let (width, height) = (160_usize, 50_usize);
    let mut bytes = format!("YUV4MPEG2 W{width} H{height} F50:1 Cmono\n").into_bytes();
    let mut noise = 1_u32;
    for frame in 0..100 {
        bytes.extend(b"FRAME\n");
        let phase = f64::from(frame % 50) / 50.0;
        let moved =
            4.0 * (std::f64::consts::PI * ((phase - 0.2) / 0.4).clamp(0.0, 1.0)).sin().powi(2);
        // How much of a pixel an edge covers.
        let covered = |x: f64, from: f64| {
            (x + 1.0 - from).clamp(0.0, 1.0) - (x + 1.0 - from - 20.0).clamp(0.0, 1.0)
        };
        for at in 0..width * height {
            let (x, y) = ((at % width) as f64, at / width);
            let post = covered(x, 20.0 + moved) + covered(x, 120.0 - moved);
            let dark = if (15..35).contains(&y) { post } else { 0.0 };
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            bytes.push((200.0 - 140.0 * dark + f64::from(noise >> 24) / 32.0) as u8);
        }
    }
    fs::write(path, bytes).unwrap();
}

#[test]
fn a_film_of_a_tissue_on_posts_gives_its_force() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    film(&at.join("tissue.y4m"));
    let scale = ["--pixel-size", "2 um", "--post-stiffness", "0.5 uN/um"];
    let track =
        [&["track", "tissue.y4m", "--posts", "--output", "posts", "--json"][..], &scale].concat();
    let output = myospring(at, &track);
    assert!(output.status.success(), "{}", stderr(&output));
    let report = json(&output);
    let number = |name: &str| report[name].as_f64().unwrap_or_else(|| panic!("{name}: {report}"));
    // Each post moves by 4 pixels of 2 um: 8 um times 500 nN/um.
    assert!((number("largest_approach_um") - 16.0).abs() < 0.2, "{report}");
    assert!((number("largest_force_nn") - 4000.0).abs() < 50.0, "{report}");
    assert!((number("distance_um") - 200.0).abs() < 4.0, "{report}");
    assert_eq!(number("found_pct"), 100.0);
    let written = names(&at.join("posts"));
    for file in ["posts.csv", "posts.json", "metrics.csv", "report.html", "figures"] {
        assert!(written.contains(&file.to_owned()), "{file}: {written:?}");
    }
    assert!(at.join("posts/figures/posts.svg").is_file());

    // Stated places, and stiffness by the shape of the posts: a round post of 100 um, 1 mm long, of 1.6 MPa.
    let stated = ["--post-places", "29.5,24.5,20x20 129.5,24.5,20x20", "--post-length", "1 mm"];
    let shape = ["--post-width", "100 um", "--post-modulus", "1.6 MPa", "--pixel-size", "2 um"];
    let output =
        myospring(at, &[&["track", "tissue.y4m", "--posts"][..], &stated, &shape].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let told = stdout(&output);
    // 3 E I/L^3 = 23.56 nN/um times 8 um.
    assert!(
        told.contains("as stated") && told.contains("0.189 uN") && told.contains("2 beats"),
        "{told}"
    );
}

#[test]
fn posts_that_cannot_be_followed_are_refused_with_the_place() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    film(&at.join("tissue.y4m"));
    for (places, message) in [
        ("30,25,20", "column, row and size of two posts"),
        ("30,25,20 400,25,20", "column 400, row 25"),
        ("30,25,20 130,25,2", "at least 5"),
    ] {
        let output = myospring(
            at,
            &["track", "tissue.y4m", "--posts", "--pixel-size", "2 um", "--post-places", places],
        );
        assert_eq!(output.status.code(), Some(2), "{places}");
        assert!(
            stderr(&output).replace('\n', " ").contains(message),
            "{places}: {}",
            stderr(&output)
        );
        assert!(!at.join("results").exists());
    }
}
