//! The fields of a cell on its mesh.

use super::Field;
use crate::digits::point;
use myospring_core::mesh::{Mesh, Simplex, simplex};
use myospring_core::recording::Frame;

/// Why fibres or contents do not fit a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// Fibres or contents of another mesh.
    #[error(
        "{found} {what} were given for {count} {of}; give one for each of the {of} of this mesh"
    )]
    Count {
        /// Fibre directions or contents.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many triangles or tetrahedra the mesh has.
        count: usize,
        /// Triangles or tetrahedra.
        of: &'static str,
    },
    /// A fibre direction without length.
    #[error("the fibre direction {direction} has no finite length above 0; give one like (1, 0)")]
    Fibre {
        /// Its components: `(0, 0)`.
        direction: String,
    },
}

/// The fields of a cell: `D` = 2, `N` = 3 of a flat one, `D` = 3, `N` = 4 of a thick one.
#[derive(Debug, Clone)]
pub struct Fields<'a, const D: usize = 2, const N: usize = 3> {
    mesh: &'a Mesh<D, N>,
    /// One for each triangle or tetrahedron.
    shapes: Vec<Shape<D>>,
    content: Option<&'a [f64]>,
}

/// A triangle or tetrahedron at rest.
#[derive(Debug, Clone, Copy)]
struct Shape<const D: usize> {
    /// Its area or volume, um^2 or um^3; 0 of one without a shape.
    measure: f64,
    /// The unit vector of its fibre as parts of its edges.
    along: [f64; D],
    /// Unit vectors across the fibre, likewise: one with two axes, two with three.
    across: [[f64; D]; 2],
}

impl<const D: usize> Shape<D> {
    /// Of a simplex with a fibre along a unit vector.
    fn of<const N: usize>(mesh: &Mesh<D, N>, simplex: &Simplex<N>, fibre: [f64; D]) -> Self {
        let corners = simplex.nodes.map(|node| mesh.point(node as usize));
        let measure = simplex::measure(&corners);
        // A vector v is the sum of the edges from the first corner times (grad N_i . v).
        let gradients = simplex::measure_gradients(&corners);
        let parts =
            |v: [f64; D]| std::array::from_fn(|edge| dot(&gradients[edge + 1], &v) / measure);
        Self { measure, along: parts(fibre), across: across(fibre).map(parts) }
    }
}

/// Unit vectors at right angles to one and to each other; with two axes the second is zero.
fn across<const D: usize>(fibre: [f64; D]) -> [[f64; D]; 2] {
    let mut vectors = [[0.0; D]; 2];
    if D == 2 {
        vectors[0] = std::array::from_fn(|axis| [-fibre[1], fibre[0]][axis]);
        return vectors;
    }
    // The axis along which the fibre is shortest is not parallel to it.
    let least = (0..D).fold(0, |a, b| if fibre[b].abs() < fibre[a].abs() { b } else { a });
    let mut first: [f64; D] = std::array::from_fn(|axis| -fibre[least] * fibre[axis]);
    first[least] += 1.0;
    let length = norm(first);
    let first = first.map(|part| part / length);
    let turned = |axis: usize| {
        let [b, c] = [(axis + 1) % D, (axis + 2) % D];
        fibre[b] * first[c] - fibre[c] * first[b]
    };
    [first, std::array::from_fn(turned)]
}

impl<'a, const D: usize, const N: usize> Fields<'a, D, N> {
    /// Fields of a mesh with fibre directions by triangle or tetrahedron (of any length), and the
    /// content of myofibrils by triangle or tetrahedron if it is not uniform.
    ///
    /// # Errors
    /// Fibres or contents of another mesh, fibres of no length.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::lattice;
    /// use myospring::output::field::{Field, Fields};
    /// use myospring::recording::Frame;
    /// let mesh = lattice::rectangle(4, 2, 5.0)?;
    /// let fields = Fields::new(&mesh, &vec![[1.0, 0.0]; mesh.simplices.len()], None)?;
    /// let x = mesh.points[0].iter().map(|x| 0.88 * x).collect();
    /// let y = mesh.points[1].iter().map(|y| 1.05 * y).collect();
    /// let peak = Frame::new(171.0, 50.0, [x, y]);
    /// for (field, value) in [(Field::FibreStrain, -12.0), (Field::CrossStrain, 5.0), (Field::AreaRatio, 0.924)] {
    ///     assert!(fields.on_triangles(field, &peak).iter().all(|found| (found - value).abs() < 1e-12));
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        mesh: &'a Mesh<D, N>,
        fibres: &[[f64; D]],
        content: Option<&'a [f64]>,
    ) -> Result<Self, FieldError> {
        let count = mesh.simplices.len();
        let of = if D == 2 { "triangles" } else { "tetrahedra" };
        let counts =
            [("fibre directions", Some(fibres.len())), ("contents", content.map(<[f64]>::len))];
        for (what, found) in counts {
            if let Some(found) = found.filter(|&found| found != count) {
                return Err(FieldError::Count { what, found, count, of });
            }
        }
        let unit = |fibre: &[f64; D]| {
            let length = fibre.iter().fold(0.0_f64, |length, part| length.hypot(*part));
            let direction = length.is_finite() && length > 0.0;
            let unit = direction.then(|| fibre.map(|part| part / length));
            unit.ok_or_else(|| FieldError::Fibre { direction: point(fibre) })
        };
        let shapes = mesh
            .simplices
            .iter()
            .zip(fibres)
            .map(|(simplex, fibre)| unit(fibre).map(|fibre| Shape::of(mesh, simplex, fibre)));
        Ok(Self { mesh, shapes: shapes.collect::<Result<_, _>>()?, content })
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<D, N> {
        self.mesh
    }

    /// The value in each triangle or tetrahedron, in the field's unit; for displacement, traction
    /// and potential, the mean over the corners.
    ///
    /// # Panics
    /// If the frame is one of another mesh.
    pub fn on_triangles(&self, field: Field, frame: &Frame<D>) -> Vec<f64> {
        match field {
            Field::FibreStrain => {
                self.strains(frame, |edges, shape| norm(moved(edges, shape.along)))
            }
            Field::CrossStrain => self.strains(frame, |edges, shape| {
                let [a, b] = shape.across.map(|parts| moved(edges, parts));
                if D == 2 {
                    norm(a)
                } else {
                    // The area between both, which does not depend on the choice of them.
                    (dot(&a, &a) * dot(&b, &b) - dot(&a, &b).powi(2)).max(0.0).sqrt().sqrt()
                }
            }),
            Field::AreaRatio | Field::VolumeRatio => self.by_shape(field, |simplex, shape| {
                simplex::measure_at(&frame.positions, simplex.nodes) / shape.measure
            }),
            Field::ActiveStress => {
                let count = self.mesh.simplices.len();
                let tension = frame.ta_by_triangle_kpa.clone();
                let mut stress = tension.unwrap_or_else(|| vec![frame.ta_kpa; count]);
                for (stress, content) in stress.iter_mut().zip(self.content.into_iter().flatten()) {
                    *stress *= content;
                }
                stress
            }
            Field::Displacement | Field::Traction | Field::Potential => {
                let way = self.on_nodes(field, frame);
                let mean = |simplex: &Simplex<N>| {
                    simplex.nodes.iter().map(|&node| way[node as usize]).sum::<f64>() / N as f64
                };
                self.mesh.simplices.iter().map(mean).collect()
            }
        }
    }

    /// A stretch minus 1, per cent, from the edges of each simplex at a time.
    fn strains(
        &self,
        frame: &Frame<D>,
        stretch: impl Fn(&[[f64; D]; D], &Shape<D>) -> f64,
    ) -> Vec<f64> {
        self.by_shape(Field::FibreStrain, |simplex, shape| {
            100.0 * (stretch(&edges(&frame.positions, simplex), shape) - 1.0)
        })
    }

    /// A value for each simplex; that at rest where one has no shape.
    fn by_shape(&self, field: Field, value: impl Fn(&Simplex<N>, &Shape<D>) -> f64) -> Vec<f64> {
        let mut values = vec![field.at_rest(); self.shapes.len()];
        for (at, shape) in self.shapes.iter().enumerate() {
            if shape.measure != 0.0 {
                values[at] = value(&self.mesh.simplices[at], shape);
            }
        }
        values
    }

    /// The value at each node: for displacement, traction and potential its own, else the mean over adjacent
    /// triangles or tetrahedra, weighted by area or volume.
    ///
    /// # Panics
    /// If the frame is one of another mesh.
    pub fn on_nodes(&self, field: Field, frame: &Frame<D>) -> Vec<f64> {
        let at = |axes: &[Vec<f64>; D], node: usize| axes.each_ref().map(|axis| axis[node]);
        if field == Field::Displacement {
            let way = |node| {
                let (now, rest) = (at(&frame.positions, node), at(&self.mesh.points, node));
                norm(std::array::from_fn::<f64, D, _>(|axis| now[axis] - rest[axis]))
            };
            return (0..self.mesh.len()).map(way).collect();
        }
        if field == Field::Traction {
            let Some(forces) = &frame.on_gel_nn else { return vec![0.0; self.mesh.len()] };
            // 1 nN/um^2 is 1000 Pa.
            let of = |(node, area): (usize, &f64)| {
                let force = at(forces, node).into_iter().fold(0.0, f64::hypot);
                1000.0 * force / area
            };
            return self.mesh.areas.iter().enumerate().map(of).collect();
        }
        if field == Field::Potential {
            let potentials = frame.potential_mv.clone();
            return potentials.unwrap_or_else(|| vec![field.at_rest(); self.mesh.len()]);
        }
        self.averaged(field.at_rest(), &self.on_triangles(field, frame))
    }

    /// Averages values of triangles or tetrahedra to nodes: the mean over adjacent ones, weighted by
    /// area or volume.
    ///
    /// # Panics
    /// If there is not one value for each triangle or tetrahedron.
    pub fn from_triangles(&self, values: &[f64]) -> Vec<f64> {
        self.averaged(0.0, values)
    }

    fn averaged(&self, alone: f64, values: &[f64]) -> Vec<f64> {
        assert_eq!(values.len(), self.mesh.simplices.len(), "one value for each simplex");
        let mut sums = vec![[0.0; 2]; self.mesh.len()];
        for ((simplex, shape), value) in self.mesh.simplices.iter().zip(&self.shapes).zip(values) {
            let weight = simplex.weight * shape.measure.abs();
            for node in simplex.nodes {
                let [sum, weights] = &mut sums[node as usize];
                *sum += weight * value;
                *weights += weight;
            }
        }
        let mean = |[sum, weights]: [f64; 2]| if weights > 0.0 { sum / weights } else { alone };
        sums.into_iter().map(mean).collect()
    }

    /// Limits of the colour scale for some frames.
    pub fn limits<'f>(
        &self,
        field: Field,
        frames: impl IntoIterator<Item = &'f Frame<D>>,
    ) -> [f64; 2] {
        field.limits(frames.into_iter().flat_map(|frame| self.on_nodes(field, frame)))
    }
}

impl Fields<'_> {
    /// Traction of the cell on its gel in each triangle along x and y, Pa, the mean over the corners; `None` of a cell on none.
    ///
    /// # Panics
    /// If the frame is one of another mesh.
    pub fn tractions(&self, frame: &Frame) -> Option<[Vec<f64>; 2]> {
        let forces = frame.on_gel_nn.as_ref()?;
        Some(forces.each_ref().map(|forces| {
            let of = |&node: &u32| forces[node as usize] / self.mesh.areas[node as usize];
            // 1 nN/um^2 is 1000 Pa.
            let mean =
                |triangle: &Simplex<3>| 1000.0 * triangle.nodes.iter().map(of).sum::<f64>() / 3.0;
            self.mesh.simplices.iter().map(mean).collect()
        }))
    }
}

// Of every simplex in every frame: plain loops, which are quick however little the compiler is asked to optimise.

/// Edges from the first corner to each other one.
fn edges<const D: usize, const N: usize>(
    positions: &[Vec<f64>; D],
    simplex: &Simplex<N>,
) -> [[f64; D]; D] {
    let mut edges = [[0.0; D]; D];
    for axis in 0..D {
        let at = &positions[axis];
        let first = at[simplex.nodes[0] as usize];
        for edge in 0..D {
            edges[edge][axis] = at[simplex.nodes[edge + 1] as usize] - first;
        }
    }
    edges
}

/// A vector whose parts of the edges are given.
fn moved<const D: usize>(edges: &[[f64; D]; D], parts: [f64; D]) -> [f64; D] {
    let mut vector = [0.0; D];
    for edge in 0..D {
        for axis in 0..D {
            vector[axis] += edges[edge][axis] * parts[edge];
        }
    }
    vector
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for axis in 0..D {
        sum += a[axis] * b[axis];
    }
    sum
}

fn norm<const D: usize>(vector: [f64; D]) -> f64 {
    dot(&vector, &vector).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::{cubes, lattice};

    fn moved(mesh: &Mesh, map: impl Fn(f64, f64) -> [f64; 2]) -> Frame {
        let both = mesh.points[0].iter().zip(&mesh.points[1]).map(|(&x, &y)| map(x, y));
        let (xs, ys) = both.map(|[x, y]| (x, y)).unzip();
        Frame::new(0.0, 30.0, [xs, ys])
    }

    fn close(found: &[f64], wanted: f64) {
        assert!(found.iter().all(|value| (value - wanted).abs() < 1e-10), "{found:?}, {wanted}");
    }

    #[test]
    fn a_homogeneous_deformation_has_its_closed_form_in_every_place() {
        let mesh = lattice::rectangle(6, 4, 2.0).unwrap();
        // F = [[0.88, 0.05], [0, 1.066]] and the fibre at 30 degrees.
        let frame = moved(&mesh, |x, y| [0.88 * x + 0.05 * y + 3.0, 1.066 * y - 2.0]);
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let content = vec![0.5; mesh.simplices.len()];
        let fibres = vec![[4.0 * cos, 4.0 * sin]; mesh.simplices.len()];
        let fields = Fields::new(&mesh, &fibres, Some(&content)).unwrap();
        let along = (0.88 * cos + 0.05 * sin).hypot(1.066 * sin);
        let across = (-0.88 * sin + 0.05 * cos).hypot(1.066 * cos);
        for (field, wanted) in [
            (Field::FibreStrain, 100.0 * (along - 1.0)),
            (Field::CrossStrain, 100.0 * (across - 1.0)),
            (Field::AreaRatio, 0.88 * 1.066),
            (Field::ActiveStress, 15.0),
        ] {
            close(&fields.on_triangles(field, &frame), wanted);
            close(&fields.on_nodes(field, &frame), wanted);
        }
        let way = fields.on_nodes(Field::Displacement, &frame);
        assert_eq!(way[0], 3f64.hypot(2.0));
        // Frames at rest widen no scale.
        let still = moved(&mesh, |x, y| [x, y]);
        let wide = fields.limits(Field::CrossStrain, [&still, &moved(&mesh, |x, y| [x, 1.3 * y])]);
        // Stretching one way moves the other by rounding alone, in per cent.
        assert!(wide[0].abs() < 1e-12, "{wide:?}");
        let [low, high] = fields.limits(Field::AreaRatio, [&frame]);
        assert!((low - 0.88 * 1.066).abs() < 1e-12 && high == 1.0);
    }

    #[test]
    fn a_thick_cell_has_the_closed_form_of_a_homogeneous_deformation_too() {
        let mesh = cubes::block([4, 3, 2], 2.0).unwrap();
        // Along the axes, then about a turn and a shift, which are no strain.
        let (stretches, [sin, cos]) = ([0.88, 1.05, 1.02], [0.6, 0.8]);
        let place = |node: usize| {
            let [x, y, z] = mesh.point(node);
            let [x, y, z] = [stretches[0] * x, stretches[1] * y, stretches[2] * z];
            [cos * x - sin * z + 3.0, y - 1.0, sin * x + cos * z]
        };
        let positions =
            [0, 1, 2].map(|axis: usize| (0..mesh.len()).map(|n| place(n)[axis]).collect());
        let frame = Frame::new(0.0, 30.0, positions);
        let volume = stretches.iter().product::<f64>();
        // Along an axis, and askew: |cof(F) f| of a diagonal F has the products of the other two.
        for fibre in [[1.0, 0.0, 0.0], [0.0, 0.0, -2.0], [0.36, 0.48, 0.8]] {
            let fields = Fields::new(&mesh, &vec![fibre; mesh.simplices.len()], None).unwrap();
            let length = norm(fibre);
            let unit = fibre.map(|part| part / length);
            let along = norm([0, 1, 2].map(|axis: usize| stretches[axis] * unit[axis]));
            let section = norm([0, 1, 2].map(|axis: usize| volume / stretches[axis] * unit[axis]));
            for (field, wanted) in [
                (Field::FibreStrain, 100.0 * (along - 1.0)),
                (Field::CrossStrain, 100.0 * (section.sqrt() - 1.0)),
                (Field::VolumeRatio, volume),
                (Field::ActiveStress, 30.0),
            ] {
                close(&fields.on_triangles(field, &frame), wanted);
                close(&fields.on_nodes(field, &frame), wanted);
            }
        }
        let missing = Fields::new(&mesh, &[[1.0, 0.0, 0.0]], None).unwrap_err().to_string();
        assert!(missing.contains("240 tetrahedra"), "{missing}");
    }

    #[test]
    fn turning_and_shifting_the_cell_is_no_strain() {
        let mesh = lattice::rectangle(6, 4, 2.0).unwrap();
        let (sin, cos) = 0.7f64.sin_cos();
        let frame = moved(&mesh, |x, y| [cos * x - sin * y + 3.0, sin * x + cos * y - 1.0]);
        let fields = Fields::new(&mesh, &vec![[0.6, 0.8]; mesh.simplices.len()], None).unwrap();
        for field in [Field::FibreStrain, Field::CrossStrain, Field::AreaRatio] {
            close(&fields.on_triangles(field, &frame), field.at_rest());
        }
    }

    #[test]
    fn each_triangle_has_a_fibre_and_a_tension_of_its_own() {
        let mesh = lattice::rectangle(2, 1, 2.0).unwrap();
        let mut frame = moved(&mesh, |x, y| [0.88 * x, 1.066 * y]);
        let count = mesh.simplices.len();
        let fibres: Vec<[f64; 2]> =
            (0..count).map(|index| if index % 2 == 0 { [1.0, 0.0] } else { [0.0, 1.0] }).collect();
        frame.ta_by_triangle_kpa = Some((0..count).map(|index| index as f64).collect());
        let fields = Fields::new(&mesh, &fibres, None).unwrap();
        let strains = fields.on_triangles(Field::FibreStrain, &frame);
        assert!((strains[0] + 12.0).abs() < 1e-12 && (strains[1] - 6.6).abs() < 1e-12);
        assert_eq!(
            Some(fields.on_triangles(Field::ActiveStress, &frame)),
            frame.ta_by_triangle_kpa
        );
    }
}
