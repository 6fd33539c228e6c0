//! Frames for ParaView and other readers of VTK's XML files: one unstructured grid per frame, and a
//! collection with their times.
//!
//! Cells are lattice squares (triangles of other meshes), of a thick cell its cubes (hexahedra;
//! tetrahedra of other meshes), without overlap, so that sums over them count each place once. Arrays are 32-bit floats, compressed by zlib (`vtkZLibDataCompressor`),
//! as base64 text: 7 digits, more precise than any picture. `frames.npz` ([`super::npz`]) has full
//! precision.
//!
//! | array | of | what |
//! |---|---|---|
//! | `displacement_um` | point | from rest |
//! | `displacement_magnitude_um` | point | its length |
//! | `velocity_um_per_s` | point | from the neighbouring frames, so smoothed over twice the frame interval |
//! | `traction_Pa` | point | force on the gel per area at rest, of a flat cell on one |
//! | `force_on_gel_nN` | point | force of a thick cell on its gel |
//! | `fibre` | cell | unit vector along the fibre at that time |
//! | `fibre_strain_pct` | cell | along the fibre, negative where it is shorter |
//! | `cross_strain_pct` | cell | of what is across the fibre at rest; of a thick cell the mean of the directions across |
//! | `area_ratio` | cell | area of a flat cell relative to that at rest |
//! | `volume_ratio` | cell | volume of a thick cell relative to that at rest |
//! | `active_stress_kPa` | cell | active tension times the content of myofibrils |

use super::field::{Field, FieldError, Fields};
use super::figure::FigureError;
use super::figure::facets::{Facet, check_frame, check_mesh, facets};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use myospring_core::mesh::{Mesh, Simplex, simplex};
use myospring_core::recording::Frame;
use std::fmt::Write as _;
use std::io::Write as _;

/// VTK's numbers of cell types.
const VTK_TRIANGLE: u8 = 5;
const VTK_POLYGON: u8 = 7;
const VTK_QUAD: u8 = 9;
const VTK_TETRA: u8 = 10;
const VTK_HEXAHEDRON: u8 = 12;
const VTK_CONVEX_POINT_SET: u8 = 41;

/// Cell arrays and their fields, of a cell with this number of axes.
const fn cell_arrays(axes: usize) -> [(&'static str, Field); 4] {
    let measure = if axes == 2 {
        ("area_ratio", Field::AreaRatio)
    } else {
        ("volume_ratio", Field::VolumeRatio)
    };
    [
        ("fibre_strain_pct", Field::FibreStrain),
        ("cross_strain_pct", Field::CrossStrain),
        measure,
        ("active_stress_kPa", Field::ActiveStress),
    ]
}

/// Why frames cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum VtuError {
    /// Frames of another mesh, or positions that are not finite.
    #[error(transparent)]
    Shape(#[from] FigureError),
    /// Fibres or contents of another mesh.
    #[error(transparent)]
    Field(#[from] FieldError),
}

/// The frames of a run, written one by one: `D` = 2, `N` = 3 of a flat cell, `D` = 3, `N` = 4 of a thick
/// one.
#[derive(Debug, Clone)]
pub struct Frames<'a, const D: usize = 2, const N: usize = 3> {
    fields: Fields<'a, D, N>,
    shapes: &'a [Frame<D>],
    fibres: &'a [[f64; D]],
    facets: Vec<Facet>,
    /// Resting area or volume of each simplex, um^2 or um^3: its weight in its facet.
    areas: Vec<f64>,
    /// The `Cells` element, the same for all frames.
    cells: String,
}

impl<'a, const D: usize, const N: usize> Frames<'a, D, N> {
    /// Frames of a mesh with the resting direction of the fibre in each of its triangles or
    /// tetrahedra and the content of myofibrils, if it is not uniform.
    ///
    /// # Errors
    /// Frames, fibres or contents of another mesh, or positions that are not finite.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::cubes;
    /// use myospring::output::vtu::Frames;
    /// use myospring::recording::Frame;
    /// let mesh = cubes::block([4, 2, 2], 2.0)?;
    /// let stretches = [0.88, 1.0 / 0.88_f64.sqrt(), 1.0 / 0.88_f64.sqrt()];
    /// let positions = [0, 1, 2].map(|axis: usize| mesh.points[axis].iter().map(|x| stretches[axis] * x).collect());
    /// let frame = Frame::new(171.0, 50.0, positions);
    /// let (shapes, fibres) = ([frame], vec![[1.0, 0.0, 0.0]; mesh.simplices.len()]);
    /// let frames = Frames::new(&mesh, &shapes, &fibres, None)?;
    /// // The ten tetrahedra of a cube are one hexahedron.
    /// assert!(frames.frame(0).contains("NumberOfPoints=\"45\" NumberOfCells=\"16\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        mesh: &'a Mesh<D, N>,
        frames: &'a [Frame<D>],
        fibres: &'a [[f64; D]],
        content: Option<&'a [f64]>,
    ) -> Result<Self, VtuError> {
        check_mesh(mesh)?;
        frames.iter().try_for_each(|frame| check_frame(mesh, frame))?;
        let fields = Fields::new(mesh, fibres, content)?;
        let facets = facets(mesh);
        let cells = cells(&facets, D);
        let area = |simplex: &Simplex<N>| {
            simplex.weight * simplex::measure_at(&mesh.points, simplex.nodes).abs()
        };
        let areas = mesh.simplices.iter().map(area).collect();
        Ok(Self { fields, shapes: frames, fibres, facets, areas, cells })
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Name of a frame's file: `cell_0012.vtu`.
    pub fn name(&self, index: usize) -> String {
        format!("cell_{index:04}.vtu")
    }

    /// The collection of all frames, a `.pvd` file beside their folder; times are ms.
    pub fn collection(&self, folder: &str) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
             <Collection>\n",
        );
        for (index, frame) in self.shapes.iter().enumerate() {
            let (time, name) = (frame.t_ms, self.name(index));
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{time}\" part=\"0\" file=\"{folder}/{name}\"/>"
            );
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        text
    }

    /// One frame, a `.vtu` file.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn frame(&self, index: usize) -> String {
        let frame = &self.shapes[index];
        let rest = &self.fields.mesh().points;
        let moved = |axis: usize, node: usize| frame.positions[axis][node] - rest[axis][node];
        let points = rest[0].len();
        let vectors = |of: &dyn Fn(usize) -> [f64; D]| -> Vec<f32> {
            (0..points).flat_map(|node| in_space(of(node))).collect()
        };
        let displacement = |node: usize| std::array::from_fn(|axis| moved(axis, node));
        let magnitude: Vec<f32> =
            (0..points).map(|node| length(displacement(node)) as f32).collect();
        let velocities = self.velocities(index);
        let fibres: Vec<f32> =
            self.facets.iter().flat_map(|facet| in_space(self.fibre(frame, facet))).collect();

        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n\
             <UnstructuredGrid>\n<FieldData>\n",
        );
        array(&mut text, "TimeValue", 0, &[frame.t_ms as f32]);
        let _ = writeln!(
            text,
            "</FieldData>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{}\">\n\
             <PointData Vectors=\"displacement_um\">",
            self.facets.len()
        );
        array(&mut text, "displacement_um", 3, &vectors(&displacement));
        array(&mut text, "displacement_magnitude_um", 1, &magnitude);
        array(&mut text, "velocity_um_per_s", 3, &vectors(&velocities));
        if let Some(forces) = &frame.on_gel_nn {
            let force = |node: usize| forces.each_ref().map(|axis| axis[node]);
            if D == 2 {
                let areas = &self.fields.mesh().areas;
                // 1 nN/um^2 is 1000 Pa.
                let traction = |node: usize| force(node).map(|part| 1000.0 * part / areas[node]);
                array(&mut text, "traction_Pa", 3, &vectors(&traction));
            } else {
                array(&mut text, "force_on_gel_nN", 3, &vectors(&force));
            }
        }
        if let Some(potentials) = &frame.potential_mv {
            let potentials: Vec<f32> = potentials.iter().map(|&value| value as f32).collect();
            array(&mut text, "potential_mV", 1, &potentials);
        }
        text.push_str("</PointData>\n<CellData Scalars=\"fibre_strain_pct\" Vectors=\"fibre\">\n");
        array(&mut text, "fibre", 3, &fibres);
        for (name, field) in cell_arrays(D) {
            let values = self.fields.on_triangles(field, frame);
            let mean = |facet: &Facet| self.mean(facet, field.at_rest(), |index| values[index]);
            array(&mut text, name, 1, &self.facets.iter().map(mean).collect::<Vec<f32>>());
        }
        text.push_str("</CellData>\n<Points>\n");
        let at = |node: usize| frame.positions.each_ref().map(|axis| axis[node]);
        array(&mut text, "points_um", 3, &vectors(&at));
        text.push_str("</Points>\n");
        text.push_str(&self.cells);
        text.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        text
    }

    /// The velocity of each node, um/s, from the frames before and after; one-sided at the first
    /// and last frame.
    fn velocities(&self, index: usize) -> impl Fn(usize) -> [f64; D] + use<'_, D, N> {
        let before = &self.shapes[index.saturating_sub(1)];
        let after = &self.shapes[(index + 1).min(self.shapes.len() - 1)];
        let seconds = (after.t_ms - before.t_ms) / 1e3;
        move |node| {
            std::array::from_fn(|axis| {
                let way = after.positions[axis][node] - before.positions[axis][node];
                if seconds > 0.0 { way / seconds } else { 0.0 }
            })
        }
    }

    /// The mean over the simplices of a facet, by their resting areas or volumes; the value at rest if
    /// these are zero.
    fn mean(&self, facet: &Facet, at_rest: f64, value: impl Fn(usize) -> f64) -> f32 {
        let (sum, total) = facet.simplices.iter().fold((0.0, 0.0), |(sum, total), &index| {
            (sum + self.areas[index] * value(index), total + self.areas[index])
        });
        if total > 0.0 { (sum / total) as f32 } else { at_rest as f32 }
    }

    /// The unit vector along the fibre of a facet at that time: F f0 divided by its length.
    fn fibre(&self, frame: &Frame<D>, facet: &Facet) -> [f64; D] {
        let mesh = self.fields.mesh();
        let mut sum = [0.0; D];
        for &index in &facet.simplices {
            let nodes = mesh.simplices[index].nodes;
            let corners = nodes.map(|node| mesh.point(node as usize));
            // F f0 = sum x_i (grad N_i . f0), and grad N_i is the gradient of the content divided
            // by the content.
            let mut now = [0.0; D];
            for (node, gradient) in nodes.into_iter().zip(simplex::measure_gradients(&corners)) {
                let share = dot(gradient, self.fibres[index]);
                for (axis, part) in now.iter_mut().enumerate() {
                    *part += share * frame.positions[axis][node as usize];
                }
            }
            // A fibre has no sign; the vectors of a facet are aligned with the first.
            let sign = if dot(now, sum) < 0.0 { -1.0 } else { 1.0 };
            sum = std::array::from_fn(|axis| sum[axis] + sign * now[axis]);
        }
        let length = length(sum);
        if length > 0.0 { sum.map(|part| part / length) } else { sum }
    }
}

/// A vector in space; a flat one has no third component.
fn in_space<const D: usize>(vector: [f64; D]) -> [f32; 3] {
    std::array::from_fn(|axis| vector.get(axis).map_or(0.0, |part| *part as f32))
}

fn length<const D: usize>(vector: [f64; D]) -> f64 {
    vector.into_iter().fold(0.0, f64::hypot)
}

fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The `Cells` element.
fn cells(facets: &[Facet], axes: usize) -> String {
    let connectivity: Vec<u32> =
        facets.iter().flat_map(|facet| facet.corners.iter().copied()).collect();
    let offsets: Vec<u32> = facets
        .iter()
        .scan(0, |end, facet| {
            *end += facet.corners.len() as u32;
            Some(*end)
        })
        .collect();
    let kinds: Vec<u8> = facets
        .iter()
        .map(|facet| match (axes, facet.corners.len()) {
            (2, 3) => VTK_TRIANGLE,
            (2, 4) => VTK_QUAD,
            (2, _) => VTK_POLYGON,
            (_, 4) => VTK_TETRA,
            (_, 8) => VTK_HEXAHEDRON,
            _ => VTK_CONVEX_POINT_SET,
        })
        .collect();
    let mut text = String::from("<Cells>\n");
    array(&mut text, "connectivity", 1, &connectivity);
    array(&mut text, "offsets", 1, &offsets);
    array(&mut text, "types", 1, &kinds);
    text.push_str("</Cells>\n");
    text
}

/// A number type of VTK, with its bytes in the file.
trait Number: Copy {
    const NAME: &'static str;
    fn put(self, bytes: &mut Vec<u8>);
}

macro_rules! numbers {
    ($($kind:ty = $name:literal),*) => {$(
        impl Number for $kind {
            const NAME: &'static str = $name;
            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    )*};
}

numbers!(f32 = "Float32", u32 = "UInt32", u8 = "UInt8");

/// Writes an array as one compressed block: number of blocks, their size, size of the last,
/// compressed size, and the block. Components are 0 in field data, which has tuples instead.
fn array<T: Number>(text: &mut String, name: &str, components: usize, values: &[T]) {
    let mut bytes = Vec::with_capacity(std::mem::size_of_val(values));
    for value in values {
        value.put(&mut bytes);
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    // Writing to memory cannot fail.
    let packed = encoder.write_all(&bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    let size = bytes.len() as u64;
    let header = [1, size, size, packed.len() as u64].map(u64::to_le_bytes).concat();
    let shape = match components {
        0 => format!(" NumberOfTuples=\"{}\"", values.len()),
        // The default; stating it would make a matrix of one column.
        1 => String::new(),
        _ => format!(" NumberOfComponents=\"{components}\""),
    };
    let _ = write!(
        text,
        "<DataArray type=\"{}\" Name=\"{name}\"{shape} format=\"binary\">\n{}",
        T::NAME,
        STANDARD.encode(header)
    );
    STANDARD.encode_string(&packed, text);
    text.push_str("\n</DataArray>\n");
}
