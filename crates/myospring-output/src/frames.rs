//! `frames.npz`: the shapes of a run with mesh and fibres, in full precision, for NumPy.
//!
//! | array | shape | what |
//! |---|---|---|
//! | `t_ms` | frames | time |
//! | `tension_kPa` | frames | active tension, the mean over the cell |
//! | `positions_um` | frames, nodes, 2 | x and y of each mass, y upward |
//! | `rest_um` | nodes, 2  position at rest |
//! | `area_um2` | nodes | area that the mass represents |
//! | `triangles` | triangles, 3 | corners, counter-clockwise, 0 is the first mass |
//! | `weights` | triangles | 1/2 if two triangles cover the same place, so that sums count it once |
//! | `column_row` | nodes, 2 | column and row in the lattice, if the mesh is one |
//! | `spacing_um` | | distance between neighbours in the lattice |
//! | `fibre` | triangles, 2 | unit vector along the fibre at rest |
//! | `content` | triangles | content of myofibrils; only if it is not uniform |
//! | `tension_by_triangle_kPa` | frames, triangles | only if the tension is not uniform |
//! | `positions_in_space_um`, `rest_in_space_um` | frames, points, 3; points, 3 | of a thick cell: all its points |
//! | `cubes` | cubes, 8 | of a thick cell: corners of each cube, by x, then y, then z |
//! | `fibre_in_space` | cubes, 3 | of a thick cell: unit vector along the fibre at rest |
//! | `force_on_gel_in_space_nN` | frames, points, 3 | of a thick cell on a gel: z upward |
//! | `outline_um` | points, 2 | the outline that was meshed, at rest |
//! | `outline_ring` | points | ring to which each point belongs: 0 the cell's rim, others its holes |

use super::npz::{self, Array, NpzError};
use myospring_core::mesh::cubes;
use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::{Lattice, Mesh, Simplex};
use myospring_core::recording::{Frame, Recording};

/// The frames of a recording as the bytes of `frames.npz`; `fibres` has a unit vector for each
/// triangle, `content` its content of myofibrils, if that is not uniform, and `thick` the cubes of a thick cell with a unit vector for each
/// tetrahedron.
///
/// # Errors
/// More than an archive can hold.
pub fn to_npz(
    mesh: &Mesh,
    thick: Option<(&Mesh<3, 4>, &[[f64; 3]])>,
    recording: &Recording,
    fibres: &[[f64; 2]],
    content: Option<&[f64]>,
    outline: &Outline,
) -> Result<Vec<u8>, NpzError> {
    let more = thick.map_or_else(Vec::new, |(mesh, fibres)| in_space(mesh, fibres, recording));
    to_npz_with(mesh, &recording.frames, fibres, content, outline, more)
}

/// Like [`to_npz`], for frames from any source, with further arrays.
///
/// # Errors
/// More than an archive can hold.
pub fn to_npz_with(
    mesh: &Mesh,
    frames: &[Frame],
    fibres: &[[f64; 2]],
    content: Option<&[f64]>,
    outline: &Outline,
    more: Vec<(&'static str, Array)>,
) -> Result<Vec<u8>, NpzError> {
    let (nodes, triangles) = (mesh.points[0].len(), mesh.simplices.len());
    let pairs = |[xs, ys]: &[Vec<f64>; 2]| -> Vec<f64> {
        xs.iter().zip(ys).flat_map(|(x, y)| [*x, *y]).collect()
    };
    let corners = mesh.simplices.iter().flat_map(|simplex| simplex.nodes.map(u32::cast_signed));
    let points: Vec<(i32, [f64; 2])> = outline
        .rings()
        .zip(0..)
        .flat_map(|(points, ring)| points.iter().map(move |point| (ring, *point)))
        .collect();
    let mut arrays = vec![
        ("t_ms", Array::floats([frames.len()], frames.iter().map(|frame| frame.t_ms))),
        ("tension_kPa", Array::floats([frames.len()], frames.iter().map(|frame| frame.ta_kpa))),
        (
            "positions_um",
            Array::floats(
                [frames.len(), nodes, 2],
                frames.iter().flat_map(|frame| pairs(&frame.positions)),
            ),
        ),
        ("rest_um", Array::floats([nodes, 2], pairs(&mesh.points))),
        ("area_um2", Array::floats([nodes], mesh.areas.iter().copied())),
        ("triangles", Array::whole([triangles, 3], corners)),
        (
            "weights",
            Array::floats([triangles], mesh.simplices.iter().map(|simplex| simplex.weight)),
        ),
        ("fibre", Array::floats([triangles, 2], fibres.iter().copied().flatten())),
        (
            "outline_um",
            Array::floats([points.len(), 2], points.iter().flat_map(|(_, point)| *point)),
        ),
        ("outline_ring", Array::whole([points.len()], points.iter().map(|(ring, _)| *ring))),
    ];
    if let Some(lattice) = &mesh.lattice {
        let places = lattice.cells.iter().flat_map(|place| place.map(u32::cast_signed));
        arrays.push(("column_row", Array::whole([nodes, 2], places)));
        arrays.push(("spacing_um", Array::floats([], [lattice.spacing])));
    }
    if let Some(content) = content {
        arrays.push(("content", Array::floats([triangles], content.iter().copied())));
    }
    let by_triangle: Option<Vec<&Vec<f64>>> =
        frames.iter().map(|frame| frame.ta_by_triangle_kpa.as_ref()).collect();
    if let Some(tensions) = by_triangle.filter(|tensions| !tensions.is_empty()) {
        let tensions = tensions.into_iter().flatten().copied();
        let array = Array::floats([frames.len(), triangles], tensions);
        arrays.push(("tension_by_triangle_kPa", array));
    }
    let on_gel: Option<Vec<&[Vec<f64>; 2]>> =
        frames.iter().map(|frame| frame.on_gel_nn.as_ref()).collect();
    if let Some(forces) = on_gel.filter(|forces| !forces.is_empty()) {
        let array = Array::floats([frames.len(), nodes, 2], forces.into_iter().flat_map(pairs));
        arrays.push(("force_on_gel_nN", array));
    }
    let potentials: Option<Vec<&Vec<f64>>> =
        frames.iter().map(|frame| frame.potential_mv.as_ref()).collect();
    if let Some(potentials) = potentials.filter(|potentials| !potentials.is_empty()) {
        let potentials = potentials.into_iter().flatten().copied();
        arrays.push(("potential_mV", Array::floats([frames.len(), nodes], potentials)));
    }
    arrays.extend(more);
    npz::to_bytes(&arrays)
}

/// The arrays of a thick cell.
fn in_space(
    mesh: &Mesh<3, 4>,
    fibres: &[[f64; 3]],
    recording: &Recording,
) -> Vec<(&'static str, Array)> {
    let points = mesh.len();
    let triples = |axes: &[Vec<f64>; 3]| -> Vec<f64> {
        (0..points).flat_map(|at| axes.each_ref().map(|axis| axis[at])).collect()
    };
    let frames = &recording.in_space;
    let moved = frames.iter().flat_map(|frame| triples(&frame.positions));
    let corners: Vec<[u32; 8]> = cubes::corners(mesh).collect();
    let directions = fibres.chunks(cubes::TETRAHEDRA_OF_A_CUBE).flat_map(common_direction);
    let mut arrays = vec![
        ("positions_in_space_um", Array::floats([frames.len(), points, 3], moved)),
        ("rest_in_space_um", Array::floats([points, 3], triples(&mesh.points))),
        ("fibre_in_space", Array::floats([corners.len(), 3], directions)),
        (
            "cubes",
            Array::whole(
                [corners.len(), 8],
                corners.into_iter().flat_map(|cube| cube.map(u32::cast_signed)),
            ),
        ),
    ];
    let on_gel: Option<Vec<&[Vec<f64>; 3]>> =
        frames.iter().map(|frame| frame.on_gel_nn.as_ref()).collect();
    if let Some(forces) = on_gel.filter(|forces| !forces.is_empty()) {
        let array = Array::floats([frames.len(), points, 3], forces.into_iter().flat_map(triples));
        arrays.push(("force_on_gel_in_space_nN", array));
    }
    arrays
}

/// The unit vector along fibres that are nearly parallel. A fibre has no sign: each is turned to the side of those before it.
fn common_direction(fibres: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for fibre in fibres {
        let along: f64 = sum.iter().zip(fibre).map(|(a, b)| a * b).sum();
        let sign = if along < 0.0 { -1.0 } else { 1.0 };
        for (sum, part) in sum.iter_mut().zip(fibre) {
            *sum += sign * part;
        }
    }
    let length = sum.into_iter().fold(0.0, f64::hypot);
    sum.map(|part| part / length)
}

/// Content of `frames.npz`: a mesh without springs, enough to draw it, and its frames.
#[derive(Debug, Clone, PartialEq)]
pub struct SavedFrames {
    /// Points, areas and triangles.
    pub mesh: Mesh,
    /// Unit vector along the fibre of each triangle, at rest.
    pub fibres: Vec<[f64; 2]>,
    /// Rings of the outline at rest, um; the exterior first.
    pub rings: Vec<Vec<[f64; 2]>>,
    /// Shapes in order of time.
    pub frames: Vec<Frame>,
}

/// Reads the output of [`to_npz`]; `None` if arrays are missing or inconsistent.
///
/// # Errors
/// Bytes that are not an archive of arrays.
pub fn read(bytes: &[u8]) -> Result<Option<SavedFrames>, NpzError> {
    let arrays = npz::read(bytes)?;
    Ok(kept(&|name| arrays.get(name)))
}

fn kept<'a>(array: &dyn Fn(&str) -> Option<&'a Array>) -> Option<SavedFrames> {
    let floats = |name: &str| array(name).and_then(Array::as_floats);
    let axes = |pairs: &[[f64; 2]]| -> [Vec<f64>; 2] {
        [0, 1].map(|axis: usize| pairs.iter().map(|pair| pair[axis]).collect())
    };
    let rest = floats("rest_um")?.as_chunks::<2>().0;
    let nodes = rest.len();
    let areas = floats("area_um2").filter(|areas| areas.len() == nodes)?.to_vec();
    let corners = array("triangles")?.as_whole()?.as_chunks::<3>().0;
    let weights = floats("weights").filter(|weights| weights.len() == corners.len())?;
    let simplices: Option<Vec<Simplex<3>>> = corners
        .iter()
        .zip(weights)
        .map(|(corners, &weight)| {
            let known = corners.iter().all(|&node| usize::try_from(node).is_ok_and(|n| n < nodes));
            known.then(|| Simplex { nodes: corners.map(|node| node as u32), weight })
        })
        .collect();
    let simplices = simplices?;
    let fibres = floats("fibre")?.as_chunks::<2>().0;
    let (times, tensions) = (floats("t_ms")?, floats("tension_kPa")?);
    let positions = floats("positions_um")?;
    let fits = fibres.len() == simplices.len()
        && nodes > 0
        && tensions.len() == times.len()
        && positions.len() == 2 * nodes * times.len();
    let by_triangle = floats("tension_by_triangle_kPa")
        .filter(|tensions| tensions.len() == times.len() * simplices.len());
    let on_gel = floats("force_on_gel_nN").filter(|forces| forces.len() == 2 * nodes * times.len());
    let potentials = floats("potential_mV").filter(|all| all.len() == nodes * times.len());
    let frame = |(index, positions): (usize, &[f64])| Frame {
        t_ms: times[index],
        ta_kpa: tensions[index],
        ta_by_triangle_kpa: by_triangle.map(|tensions| {
            tensions[index * simplices.len()..(index + 1) * simplices.len()].to_vec()
        }),
        on_gel_nn: on_gel.map(|forces| {
            axes(forces[2 * nodes * index..2 * nodes * (index + 1)].as_chunks::<2>().0)
        }),
        potential_mv: potentials.map(|all| all[nodes * index..nodes * (index + 1)].to_vec()),
        positions: axes(positions.as_chunks::<2>().0),
    };
    let frames = if fits {
        positions.chunks_exact(2 * nodes).enumerate().map(frame).collect()
    } else {
        return None;
    };
    let points = floats("outline_um")?.as_chunks::<2>().0;
    let ring = array("outline_ring")?.as_whole()?;
    let mut rings: Vec<Vec<[f64; 2]>> = Vec::new();
    for (point, ring) in points.iter().zip(ring) {
        let ring = usize::try_from(*ring).ok().filter(|ring| *ring <= rings.len())?;
        if ring == rings.len() {
            rings.push(Vec::new());
        }
        rings[ring].push(*point);
    }
    let lattice =
        lattice(rest, array("column_row").and_then(Array::as_whole), floats("spacing_um"));
    let mesh = Mesh { points: axes(rest), areas, springs: Vec::new(), simplices, lattice };
    Some(SavedFrames { mesh, fibres: fibres.to_vec(), rings, frames })
}

/// The lattice of the points, if they have columns and rows.
fn lattice(rest: &[[f64; 2]], places: Option<&[i32]>, spacing: Option<&[f64]>) -> Option<Lattice> {
    let (places, &[spacing]) = (places?.as_chunks::<2>().0, spacing?) else { return None };
    let place =
        |place: &[i32; 2]| Some([u32::try_from(place[0]).ok()?, u32::try_from(place[1]).ok()?]);
    let cells: Vec<[u32; 2]> = places.iter().map(place).collect::<Option<_>>()?;
    let (first, at) = (*cells.first()?, *rest.first()?);
    let count = |axis: usize| cells.iter().map(|cell| cell[axis] as usize + 1).max().unwrap_or(0);
    let origin = [0, 1].map(|axis: usize| at[axis] - f64::from(first[axis]) * spacing);
    let (shape, fits) = ([count(0), count(1)], cells.len() == rest.len());
    fits.then_some(Lattice { spacing, shape, origin, cells })
}

#[cfg(test)]
mod tests {
    #[test]
    fn fibres_that_point_to_either_side_of_one_line_have_it_in_common() {
        // As those of an upright cell at 89 and -89 degrees, which are 2 degrees apart.
        let fibre = |angle: f64| [angle.to_radians().cos(), angle.to_radians().sin(), 0.0];
        let alternating: Vec<[f64; 3]> =
            (0..10).map(|index| fibre(if index % 2 == 0 { 89.0 } else { -89.0 })).collect();
        let [x, y, z] = super::common_direction(&alternating);
        assert!(x.abs() < 1e-12 && (y.abs() - 1.0).abs() < 1e-12 && z == 0.0, "{x}, {y}");
        let opposite = [[0.6, 0.8, 0.0], [-0.6, -0.8, 0.0]];
        assert_eq!(super::common_direction(&opposite), [0.6, 0.8, 0.0]);
    }

    use super::*;
    use myospring_core::mesh::{built_in, lattice};

    #[test]
    fn what_is_written_comes_back_to_the_bit() {
        let outline = built_in::adult_ventricular();
        let mesh = lattice::rectangle(6, 3, 2.0).unwrap();
        let frame = |t_ms: f64| Frame {
            t_ms,
            ta_kpa: 0.3 * t_ms,
            ta_by_triangle_kpa: Some(vec![t_ms / 7.0; mesh.simplices.len()]),
            on_gel_nn: Some([vec![t_ms / 3.0; mesh.len()], vec![-t_ms; mesh.len()]]),
            potential_mv: Some(vec![-84.0 + t_ms / 9.0; mesh.len()]),
            positions: mesh.points.clone().map(|xs| xs.iter().map(|x| x * 0.9 + t_ms).collect()),
        };
        let frames = vec![frame(0.0), frame(5.0)];
        let recording = Recording { frames: frames.clone(), ..Recording::default() };
        let fibres = vec![[0.6, 0.8]; mesh.simplices.len()];
        let bytes = to_npz(&mesh, None, &recording, &fibres, None, &outline).unwrap();
        let kept = read(&bytes).unwrap().unwrap();
        assert_eq!((&kept.frames, &kept.fibres), (&frames, &fibres));
        assert_eq!(kept.rings, outline.rings().map(<[_]>::to_vec).collect::<Vec<_>>());
        let Mesh { points, areas, simplices, lattice, .. } = kept.mesh;
        assert_eq!((points, areas, simplices), (mesh.points, mesh.areas, mesh.simplices));
        assert_eq!(lattice, mesh.lattice);
    }

    #[test]
    fn of_a_thick_cell_there_are_fibres_and_forces_on_the_gel_in_space() {
        let outline = built_in::adult_ventricular();
        let (mesh, cubes) =
            (lattice::rectangle(6, 3, 2.0).unwrap(), cubes::block([6, 3, 2], 2.0).unwrap());
        let shape = Frame {
            on_gel_nn: Some([0.0, 1.0, 2.0].map(|axis| vec![axis; cubes.len()])),
            ..Frame::new(0.0, 0.0, cubes.points.clone())
        };
        let frames = vec![Frame::new(0.0, 0.0, mesh.points.clone())];
        let recording = Recording { frames, in_space: vec![shape], ..Recording::default() };
        let (flat, turned) =
            (vec![[1.0, 0.0]; mesh.simplices.len()], vec![[0.6, 0.8, 0.0]; cubes.simplices.len()]);
        let thick = Some((&cubes, &turned[..]));
        let bytes = to_npz(&mesh, thick, &recording, &flat, None, &outline).unwrap();
        let arrays = npz::read(&bytes).unwrap();
        let fibres = arrays["fibre_in_space"].as_floats().unwrap();
        assert_eq!(fibres.len(), 3 * 36);
        assert!(
            fibres.as_chunks::<3>().0.iter().all(|[x, y, z]| {
                (x - 0.6).abs() < 1e-12 && (y - 0.8).abs() < 1e-12 && *z == 0.0
            })
        );
        let forces = arrays["force_on_gel_in_space_nN"].as_floats().unwrap();
        assert_eq!(forces.len(), 3 * cubes.len());
        assert!(forces.as_chunks::<3>().0.iter().all(|force| *force == [0.0, 1.0, 2.0]));
    }

    #[test]
    fn an_archive_of_other_arrays_is_no_run() {
        let times = npz::to_bytes(&[("t_ms", Array::floats([1], [0.0]))]).unwrap();
        assert_eq!(read(&times).unwrap(), None);
    }
}
