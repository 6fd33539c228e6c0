//! Frames for ParaView are XML that says of each array what it holds. VTK and meshio read them in
//! `cargo xtask test`.

use crate::synthetic::{elongated, recording};
use myospring::output::vtu::Frames;

#[test]
fn a_frame_names_every_array_once_and_covers_the_cell_once() {
    let mesh = elongated(4.0);
    let run = recording(&mesh, [1.0, 0.0], 50.0, false);
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let frames = Frames::new(&mesh, &run.frames, &fibres, None).unwrap();
    let text = frames.frame(3);
    let document = roxmltree::Document::parse(&text).unwrap();
    let piece = document.descendants().find(|node| node.has_tag_name("Piece")).unwrap();
    let count = |name: &str| piece.attribute(name).unwrap().parse::<usize>().unwrap();
    assert_eq!(count("NumberOfPoints"), mesh.len());
    // Four triangles of half weight make a square.
    assert_eq!(count("NumberOfCells") * 4, mesh.simplices.len());
    let arrays = document.descendants().filter(|node| node.has_tag_name("DataArray"));
    let names: Vec<&str> = arrays.map(|array| array.attribute("Name").unwrap()).collect();
    let expected = [
        "TimeValue",
        "displacement_um",
        "displacement_magnitude_um",
        "velocity_um_per_s",
        "fibre",
        "fibre_strain_pct",
        "cross_strain_pct",
        "area_ratio",
        "active_stress_kPa",
        "points_um",
        "connectivity",
        "offsets",
        "types",
    ];
    assert_eq!(names, expected);
    assert!(roxmltree::Document::parse(&frames.collection("vtu")).is_ok());
    assert!(text == frames.frame(3), "the same run gives the same bytes");
}

#[test]
fn frames_and_fibres_of_another_mesh_are_refused() {
    let (mesh, other) = (elongated(4.0), elongated(2.0));
    let run = recording(&mesh, [1.0, 0.0], 50.0, false);
    let fibres = vec![[1.0, 0.0]; other.simplices.len()];
    let error = Frames::new(&other, &run.frames, &fibres, None).unwrap_err().to_string();
    assert!(error.contains("positions along axis 0"), "{error}");
    let error = Frames::new(&mesh, &run.frames, &fibres, None).unwrap_err().to_string();
    assert!(error.contains("one for each of the triangles"), "{error}");
}
