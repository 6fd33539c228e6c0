//! Frames for ParaView and other readers of VTK's XML files: one unstructured grid per frame, and a
//! collection with their times.
//!
//! Cells are lattice squares (triangles of other meshes), without overlap, so that sums over them
//! count each place once. Arrays are 32-bit floats, compressed by zlib (`vtkZLibDataCompressor`),
//! as base64 text: 7 digits, more precise than any picture. `frames.npz` ([`super::npz`]) has full
//! precision.
//!
//! | array | of | what |
//! |---|---|---|
//! | `displacement_um` | point | from rest |
//! | `displacement_magnitude_um` | point | its length |
//! | `velocity_um_per_s` | point | from the neighbouring frames, so smoothed over twice the frame interval |
//! | `traction_Pa` | point | force on the gel per area at rest, of a cell on one |
//! | `fibre` | cell | unit vector along the fibre at that time |
//! | `fibre_strain_pct` | cell | along the fibre, negative where it is shorter |
//! | `cross_strain_pct` | cell | of the direction that is across the fibre at rest |
//! | `area_ratio` | cell | area relative to that at rest |
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

/// Cell arrays and their fields.
const CELL_ARRAYS: [(&str, Field); 4] = [
    ("fibre_strain_pct", Field::FibreStrain),
    ("cross_strain_pct", Field::CrossStrain),
    ("area_ratio", Field::AreaRatio),
    ("active_stress_kPa", Field::ActiveStress),
];

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

/// The frames of a run, written one by one.
#[derive(Debug, Clone)]
pub struct Frames<'a> {
    fields: Fields<'a>,
    shapes: &'a [Frame],
    fibres: &'a [[f64; 2]],
    facets: Vec<Facet>,
    /// Resting area of each triangle, um^2: its weight in its facet.
    areas: Vec<f64>,
    /// The `Cells` element, the same for all frames.
    cells: String,
}

impl<'a> Frames<'a> {
    /// Frames of a mesh with the resting direction of the fibre in each of its triangles and the
    /// content of myofibrils, if it is not uniform.
    ///
    /// # Errors
    /// Frames, fibres or contents of another mesh, or positions that are not finite.
    pub fn new(
        mesh: &'a Mesh,
        frames: &'a [Frame],
        fibres: &'a [[f64; 2]],
        content: Option<&'a [f64]>,
    ) -> Result<Self, VtuError> {
        check_mesh(mesh)?;
        frames.iter().try_for_each(|frame| check_frame(mesh, frame))?;
        let fields = Fields::new(mesh, fibres, content)?;
        let facets = facets(mesh);
        let cells = cells(&facets);
        let area = |triangle: &Simplex<3>| {
            triangle.weight * simplex::measure_at(&mesh.points, triangle.nodes).abs()
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
        let vectors = |of: &dyn Fn(usize) -> [f64; 2]| -> Vec<f32> {
            (0..points).flat_map(|node| flat(of(node))).collect()
        };
        let displacement = |node: usize| [moved(0, node), moved(1, node)];
        let magnitude: Vec<f32> =
            (0..points).map(|node| moved(0, node).hypot(moved(1, node)) as f32).collect();
        let velocities = self.velocities(index);
        let fibres: Vec<f32> =
            self.facets.iter().flat_map(|facet| flat(self.fibre(frame, facet))).collect();

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
            let areas = &self.fields.mesh().areas;
            // 1 nN/um^2 is 1000 Pa.
            let traction =
                |node: usize| [0, 1].map(|axis: usize| 1000.0 * forces[axis][node] / areas[node]);
            array(&mut text, "traction_Pa", 3, &vectors(&traction));
        }
        text.push_str("</PointData>\n<CellData Scalars=\"fibre_strain_pct\" Vectors=\"fibre\">\n");
        array(&mut text, "fibre", 3, &fibres);
        for (name, field) in CELL_ARRAYS {
            let values = self.fields.on_triangles(field, frame);
            let mean = |facet: &Facet| self.mean(facet, field.at_rest(), |index| values[index]);
            array(&mut text, name, 1, &self.facets.iter().map(mean).collect::<Vec<f32>>());
        }
        text.push_str("</CellData>\n<Points>\n");
        let at = |node: usize| [frame.positions[0][node], frame.positions[1][node]];
        array(&mut text, "points_um", 3, &vectors(&at));
        text.push_str("</Points>\n");
        text.push_str(&self.cells);
        text.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        text
    }

    /// The velocity of each node, um/s, from the frames before and after; one-sided at the first
    /// and last frame.
    fn velocities(&self, index: usize) -> impl Fn(usize) -> [f64; 2] + use<'_> {
        let before = &self.shapes[index.saturating_sub(1)];
        let after = &self.shapes[(index + 1).min(self.shapes.len() - 1)];
        let seconds = (after.t_ms - before.t_ms) / 1e3;
        move |node| {
            [0, 1].map(|axis: usize| {
                let way = after.positions[axis][node] - before.positions[axis][node];
                if seconds > 0.0 { way / seconds } else { 0.0 }
            })
        }
    }

    /// The mean over the triangles of a facet, by their resting areas; for zero area, the value at
    /// rest.
    fn mean(&self, facet: &Facet, at_rest: f64, value: impl Fn(usize) -> f64) -> f32 {
        let (sum, total) = facet.triangles.iter().fold((0.0, 0.0), |(sum, total), &index| {
            (sum + self.areas[index] * value(index), total + self.areas[index])
        });
        if total > 0.0 { (sum / total) as f32 } else { at_rest as f32 }
    }

    /// The unit vector along the fibre of a facet at that time: F f0 divided by its length.
    fn fibre(&self, frame: &Frame, facet: &Facet) -> [f64; 2] {
        let mesh = self.fields.mesh();
        let mut sum = [0.0; 2];
        for &index in &facet.triangles {
            let (nodes, [x, y]) = (mesh.simplices[index].nodes, self.fibres[index]);
            let corners = nodes.map(|node| mesh.points.each_ref().map(|xs| xs[node as usize]));
            // F f0 = sum x_i (grad N_i . f0), and grad N_i is the gradient of the content divided
            // by the content.
            let mut now = [0.0; 2];
            for (node, gradient) in nodes.into_iter().zip(simplex::measure_gradients(&corners)) {
                let share = gradient[0] * x + gradient[1] * y;
                for (axis, part) in now.iter_mut().enumerate() {
                    *part += share * frame.positions[axis][node as usize];
                }
            }
            // A fibre has no sign; the vectors of a square are aligned with the first.
            let sign = if now[0] * sum[0] + now[1] * sum[1] < 0.0 { -1.0 } else { 1.0 };
            sum = [sum[0] + sign * now[0], sum[1] + sign * now[1]];
        }
        let length = sum[0].hypot(sum[1]);
        if length > 0.0 { sum.map(|part| part / length) } else { sum }
    }
}

/// A flat vector in space.
fn flat([x, y]: [f64; 2]) -> [f32; 3] {
    [x as f32, y as f32, 0.0]
}

/// The `Cells` element.
fn cells(facets: &[Facet]) -> String {
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
        .map(|facet| match facet.corners.len() {
            3 => VTK_TRIANGLE,
            4 => VTK_QUAD,
            _ => VTK_POLYGON,
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
