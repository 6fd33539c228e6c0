//! A thick cell that turns: its surface, reduced to the accuracy that is visible.

use super::error::PageError;
use super::fields::{self, FieldData};
use super::frames::{self, Candidate, Fitted, UNSEEN, packed};
use super::section::{self, Section};
use crate::digits::rounded;
use crate::field::{Field, Fields};
use crate::figure::{FigureError, check_frame, check_mesh};
use crate::surface::{SmoothSurface, extents, unit};
use myospring_core::mesh::Mesh;
use myospring_core::recording::Frame;
use serde::Serialize;

/// Bytes of the frames of all thick cells of a page together, before base64 makes them a third larger.
const BUDGET: usize = 1_400_000;
/// Nodes of a surface that is drawn with all of them; those of larger ones are drawn in groups.
const FINE: usize = 2500;

/// A thick cell on a page, which shows it in space.
#[derive(Debug, Clone, Copy)]
pub struct ThickCell<'a> {
    /// Its mesh at rest; its surface is that of its lattice.
    pub mesh: &'a Mesh<3, 4>,
    /// Its shapes; their times may differ from those of the cell seen from above.
    pub frames: &'a [Frame<3>],
    /// Vector along the fibre in each tetrahedron, of any length.
    pub fibres: &'a [[f64; 3]],
    /// Content of myofibrils of each tetrahedron; `None` is 1 everywhere.
    pub myofibril_content: Option<&'a [f64]>,
    /// Direction of the long axis seen from above, of any length.
    pub long_axis: [f64; 2],
}

#[derive(Debug, Serialize)]
pub(super) struct ThickData {
    rest_um: String,
    corners: String,
    long_axis: f64,
    sections: [Vec<PartData>; 2],
    frames: ThickFrames,
    spacing_um: f64,
    accuracy_um: f64,
    fields: Vec<ThickField>,
}

/// A grid of a section.
#[derive(Debug, Serialize)]
struct PartData {
    layers: usize,
    ends: String,
    weights: String,
}

#[derive(Debug, Serialize)]
struct ThickFrames {
    t_ms: Vec<f64>,
    displacement: String,
    step_um: f64,
    size_um: Vec<[f64; 3]>,
}

#[derive(Debug, Serialize)]
struct ThickField {
    #[serde(flatten)]
    field: FieldData,
    values: String,
}

/// A thick cell on a page of `share` cells.
pub(super) fn of(
    cell: &ThickCell<'_>,
    has_tension: bool,
    share: usize,
) -> Result<ThickData, PageError> {
    let mesh = cell.mesh;
    check_mesh(mesh)?;
    let fields = Fields::new(mesh, cell.fibres, cell.myofibril_content)?;
    let at_rest = Frame::new(0.0, 0.0, mesh.points.clone());
    // The last frames of a run that failed may be invalid.
    let is_finite = |frame: &&Frame<3>| frame.positions.iter().flatten().all(|x| x.is_finite());
    let mut all: Vec<&Frame<3>> = cell.frames.iter().filter(is_finite).collect();
    if all.is_empty() {
        all.push(&at_rest);
    }
    for frame in &all {
        check_frame(mesh, frame)?;
    }
    let known: Vec<Field> =
        Field::THICK.into_iter().filter(|field| field.is_known(&all, has_tension)).collect();
    let small = small(cell, &all, known.len(), BUDGET / share)?;
    let (displacement, step) = frames::quantised(&small);
    let Fitted { drawn: Drawn { surface, sections }, kept, tolerance, .. } = small;
    let shown = || kept.iter().map(|&at| all[at]);
    let field = |field| {
        let drawn = |frame| {
            let nodes = fields.on_nodes(field, frame);
            let mut values = surface.means(&nodes);
            let parts = sections.iter().flat_map(|section| &section.parts);
            values.extend(parts.flat_map(|part| part.values(&nodes)));
            values
        };
        let values: Vec<Vec<f64>> = shown().map(drawn).collect();
        let field = fields::data(field, values.iter().cloned());
        let part = |value: &f64| (value - field.low) / (field.high - field.low);
        let bytes = values.iter().flatten().map(|value| [(255.0 * part(value)).round() as u8]);
        ThickField { values: packed(bytes), field }
    };
    let [x, y] = unit(cell.long_axis);
    let rest = surface.positions(&mesh.points);
    Ok(ThickData {
        rest_um: packed(rest.iter().flatten().map(|&x| (x as f32).to_le_bytes())),
        corners: packed(surface.quads().iter().flatten().map(|corner| corner.to_le_bytes())),
        long_axis: rounded(y.atan2(x)),
        sections: sections.each_ref().map(|section| section.parts.iter().map(part).collect()),
        frames: ThickFrames {
            t_ms: shown().map(|frame| rounded(frame.t_ms)).collect(),
            displacement,
            step_um: step,
            size_um: shown()
                .map(|frame| extents(&frame.positions, cell.long_axis).map(rounded))
                .collect(),
        },
        spacing_um: rounded(surface.spacing()),
        accuracy_um: rounded(tolerance + step),
        fields: known.into_iter().map(field).collect(),
    })
}

fn part(part: &section::Part) -> PartData {
    let ends = part.ends.iter().flat_map(|(ends, _)| ends).map(|end| end.to_le_bytes());
    let weights = part.ends.iter().flat_map(|(_, weights)| weights).map(|part| part.to_le_bytes());
    PartData { layers: part.layers, ends: packed(ends), weights: packed(weights) }
}

/// A surface, and its sections along and across the long axis.
struct Drawn {
    surface: SmoothSurface,
    sections: [Section; 2],
}

/// A surface and frames that fit into some bytes.
fn small(
    cell: &ThickCell<'_>,
    all: &[&Frame<3>],
    fields: usize,
    budget: usize,
) -> Result<Fitted<Drawn>, FigureError> {
    let finest = SmoothSurface::new(cell.mesh).ok_or(FigureError::NoCubes)?;
    let times: Vec<f64> = all.iter().map(|frame| frame.t_ms).collect();
    let size = extents(&cell.mesh.points, cell.long_axis);
    let tolerance = UNSEEN * size.into_iter().fold(0.0, f64::max);
    let coarser = (finest.len() as f64 / FINE as f64).sqrt().ceil().max(1.0) as u32;
    let candidate = |coarser| {
        let surface = finest.coarser(coarser);
        let rest = surface.positions(&cell.mesh.points);
        let moved = |frame: &&Frame<3>| {
            let now = surface.positions(&frame.positions);
            let pairs = now.iter().flatten().zip(rest.iter().flatten());
            pairs.map(|(now, rest)| (now - rest) as f32).collect()
        };
        let displacements = all.iter().map(moved).collect();
        let sections = section::both(cell.mesh, &surface, cell.long_axis);
        let within: usize =
            sections.iter().flat_map(|section| &section.parts).map(section::Part::len).sum();
        let bytes = (6 + fields) * rest.len() + fields * within;
        Candidate { points: rest.len(), bytes, displacements, drawn: Drawn { surface, sections } }
    };
    Ok(frames::fitted(&times, coarser, tolerance, budget, candidate))
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::cubes;

    /// A block that shortens by up to 12 % and widens as much as its volume asks for.
    fn beating(mesh: &Mesh<3, 4>, frames: usize) -> Vec<Frame<3>> {
        let frame = |index: usize| {
            let part = 0.12 * (std::f64::consts::PI * index as f64 / frames as f64).sin();
            let stretches = [1.0 - part, (1.0 - part).powf(-0.5), (1.0 - part).powf(-0.5)];
            Frame::new(
                5.0 * index as f64,
                400.0 * part,
                [0, 1, 2].map(|axis: usize| {
                    mesh.points[axis].iter().map(|x| stretches[axis] * x).collect()
                }),
            )
        };
        (0..frames).map(frame).collect()
    }

    fn data(cubes: [usize; 3], frames: usize, share: usize) -> ThickData {
        let mesh = cubes::block(cubes, 2.0).unwrap();
        let (frames, fibres) =
            (beating(&mesh, frames), vec![[1.0, 0.0, 0.0]; mesh.simplices.len()]);
        let cell = ThickCell {
            mesh: &mesh,
            frames: &frames,
            fibres: &fibres,
            myofibril_content: None,
            long_axis: [5.0, 0.0],
        };
        of(&cell, true, share).unwrap()
    }

    #[test]
    fn its_data_have_the_size_of_the_mesh_and_every_field() {
        let data = data([24, 8, 4], 61, 1);
        assert_eq!(data.frames.size_um[0], [48.0, 16.0, 8.0]);
        let shortest = data.frames.size_um.iter().map(|size| size[0]).fold(f64::INFINITY, f64::min);
        assert!((shortest - 0.88 * 48.0).abs() < 0.02, "{shortest}");
        assert!(data.frames.size_um.iter().all(|[l, w, t]| (l * w * t - 6144.0).abs() < 0.01));
        assert_eq!(data.fields.len(), Field::THICK.len());
        let strain = &data.fields[0].field;
        assert!((strain.low + 12.0).abs() < 0.02 && strain.high == 0.0);
        assert!(data.accuracy_um < 0.05);
        // Not more than three bytes in four characters, of each number.
        let points = data.rest_um.len() * 3 / 4 / 12;
        let parts = data.sections.iter().flatten();
        let within: usize = parts.map(|part| part.ends.len() * 3 / 4 / 32 * part.layers).sum();
        assert!(within > 100);
        let bytes = data.fields[0].values.len() * 3 / 4;
        assert!(bytes.abs_diff((points + within) * data.frames.t_ms.len()) < 3);
    }

    #[test]
    #[ignore = "slow"]
    fn large_cells_and_long_runs_stay_small() {
        let all = std::env::var_os("MYOSPRING_ALL_CASES").is_some();
        let large = if all { [90, 30, 12] } else { [60, 20, 8] };
        for (cubes, frames, share) in [(large, 40, 1), ([30, 10, 4], 600, 6)] {
            let data = data(cubes, frames, share);
            let texts =
                data.fields.iter().map(|field| &field.values).chain([&data.frames.displacement]);
            let size: usize = texts.map(String::len).sum();
            assert!(size * share < 1_900_000, "{cubes:?}: {size}");
            assert!(data.frames.t_ms.len() > 3);
        }
    }

    #[test]
    fn a_mesh_without_cubes_is_refused() {
        let mut mesh = cubes::block([2, 1, 1], 2.0).unwrap();
        mesh.lattice = None;
        let fibres = vec![[1.0, 0.0, 0.0]; mesh.simplices.len()];
        let (frames, myofibril_content, long_axis) = (&[][..], None, [1.0, 0.0]);
        let cell = ThickCell { mesh: &mesh, frames, fibres: &fibres, myofibril_content, long_axis };
        assert!(of(&cell, true, 1).unwrap_err().to_string().contains("no cubes"));
    }
}
