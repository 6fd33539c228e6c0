//! A field of directions over a cell.

use super::grid::between;
use super::tensor::{Place, Smoothed};
use myospring_core::mesh::Mesh;

/// Below this part of its neighbourhood in the cell a place has the long axis.
const LEAST_SHARE: f32 = 1e-3;

/// The fibre at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fibre {
    /// Unit vector along the fibre, y upward; of the two the one that points along the long axis.
    pub direction: [f64; 2],
    /// Coherency of the picture, 0 for none to 1 for one direction only.
    pub coherency: f64,
    /// Whether the picture has the larger say; otherwise the long axis has.
    pub from_picture: bool,
}

impl Fibre {
    /// Angle from x, counter-clockwise, degrees, above -90 and up to 90.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::fibres::Fibre;
    /// let fibre = Fibre { direction: [0.0, -1.0], coherency: 1.0, from_picture: true };
    /// assert_eq!(fibre.angle_deg(), 90.0);
    /// ```
    pub fn angle_deg(&self) -> f64 {
        let [x, y] = self.direction;
        line_angle_deg(y.atan2(x))
    }
}

/// An angle in radians as that of a line, degrees above -90 and up to 90.
fn line_angle_deg(angle: f64) -> f64 {
    let degrees = angle.to_degrees();
    90.0 - (90.0 - degrees).rem_euclid(180.0)
}

/// Numbers that sum up a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FibreSummary {
    /// Part of the cell's area in which the picture has the larger say, 0 to 1.
    pub share_from_picture: f64,
    /// Mean direction against the long axis, degrees counter-clockwise, above -90 and up to 90.
    pub mean_angle_deg: f64,
    /// Order parameter over the cell, `|mean of (cos 2 theta, sin 2 theta)|`: 1 for parallel fibres, 0 for
    /// fibres in all directions. Places where the long axis stands in count as such.
    pub order: f64,
    /// Mean coherency of the picture over the cell.
    pub mean_coherency: f64,
}

/// Below this part of the cell, and above this angle from its long axis, a person is told.
const SMALL_SHARE: f64 = 0.25;
const LARGE_ANGLE_DEG: f64 = 45.0;

impl FibreSummary {
    /// What a person should know before they trust the field, a sentence each: that the picture decided
    /// in a small part of the cell only, that the fibres lie across the cell.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::fibres::FibreSummary;
    /// let summary = FibreSummary {
    ///     share_from_picture: 0.8,
    ///     mean_angle_deg: -85.0,
    ///     order: 0.9,
    ///     mean_coherency: 0.5,
    /// };
    /// assert!(summary.warnings()[0].contains("is the stain right?"));
    /// ```
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.share_from_picture < SMALL_SHARE {
            warnings.push(format!(
                "the picture shows fibres in only {:.0} % of the cell; elsewhere the long axis stands in",
                100.0 * self.share_from_picture
            ));
        }
        if self.mean_angle_deg.abs() > LARGE_ANGLE_DEG {
            warnings.push(format!(
                "the fibres lie across the cell, at {:.0} degrees from its long axis on average: is the \
                 stain right? Z-discs lie across the fibre, filaments along it",
                self.mean_angle_deg
            ));
        }
        warnings
    }
}

/// Directions of the myofibrils everywhere in a cell; see [`fibres`](super::fibres()).
#[derive(Debug, Clone, PartialEq)]
pub struct FibreField {
    smoothed: Smoothed,
    /// Vectors at twice the angle of the fibre, picture and long axis mixed.
    mixed: Vec<[f32; 2]>,
    least_coherency: f64,
    /// Unit vector.
    long_axis: [f64; 2],
}

impl FibreField {
    /// Mixes the picture's directions with the long axis, and smooths the border between the two.
    pub(super) fn new(
        smoothed: Smoothed,
        long_axis: [f64; 2],
        least_coherency: f64,
        border_um: f64,
    ) -> Self {
        let axis = double(long_axis);
        let Place { grid, block_um, share, .. } = &smoothed.place;
        let mix = |vector: [f32; 2]| {
            let [x, y] = vector.map(f64::from);
            let coherency = x.hypot(y);
            let part = smooth_step(coherency / least_coherency - 0.5);
            let towards = |axis: f64, x: f64| {
                if part > 0.0 { (1.0 - part) * axis + part * x / coherency } else { axis }
            };
            [towards(axis[0], x), towards(axis[1], y)]
        };
        let mut mixed = [grid.zeros(), grid.zeros()];
        for (at, vector) in smoothed.doubled.iter().enumerate() {
            let vector = mix(*vector);
            for i in 0..2 {
                mixed[i][at] = share[at] * vector[i] as f32;
            }
        }
        // Places outside the cell have no weight.
        let mut weight = share.clone();
        for values in mixed.iter_mut().chain([&mut weight]) {
            grid.blur(values, border_um / block_um);
        }
        let mixed = (0..weight.len())
            .map(|at| {
                if weight[at] < LEAST_SHARE {
                    return axis.map(|x| x as f32);
                }
                [0, 1].map(|i: usize| mixed[i][at] / weight[at])
            })
            .collect();
        Self { smoothed, mixed, least_coherency, long_axis }
    }

    /// The fibre at a point, um from the lower left corner of the picture, y upward.
    ///
    /// Outside the cell it is that of the nearest part of the picture that was looked at, or the long
    /// axis; so a triangle that reaches over the outline has a fibre too.
    pub fn at(&self, point_um: [f64; 2]) -> Fibre {
        let places = self.corners(point_um);
        let between = |vectors: &[[f32; 2]]| {
            [0, 1].map(|axis: usize| {
                places.iter().map(|&(at, part)| part * f64::from(vectors[at][axis])).sum::<f64>()
            })
        };
        self.fibre(between(&self.smoothed.doubled), between(&self.mixed))
    }

    /// One unit vector for each triangle of a mesh (`mesh.simplices`), at the triangle's centre, as
    /// [`Simulation::fibres`](myospring_core::simulation::Simulation::fibres) wants them. The mesh must lie where
    /// the cell lies in the picture, as [`lattice::from_mask`](myospring_core::mesh::lattice::from_mask) makes it.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{lattice, pixel_size::PixelSize};
    /// use myospring::microscopy::fibres::{FibreSettings, Stain, fibres};
    /// use myospring::microscopy::plane::Plane;
    /// let plane = Plane::new(50, 50, vec![1.0; 2500]).unwrap();
    /// let settings = FibreSettings::of(Stain::ZDisc);
    /// let field = fibres(&plane, &[true; 2500], PixelSize::new(0.2)?, [0.0, 2.0], &settings)?;
    /// let mesh = lattice::rectangle(5, 5, 1.0).unwrap();
    /// // Nothing to see: the long axis.
    /// assert_eq!(field.on_mesh(&mesh), vec![[0.0, 1.0]; mesh.simplices.len()]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn on_mesh(&self, mesh: &Mesh) -> Vec<[f64; 2]> {
        let centre = |nodes: [u32; 3]| {
            let [a, b, c] = nodes.map(|node| mesh.point(node as usize));
            [0, 1].map(|axis: usize| (a[axis] + b[axis] + c[axis]) / 3.0)
        };
        mesh.simplices.iter().map(|triangle| self.at(centre(triangle.nodes)).direction).collect()
    }

    /// Points of a square grid within the cell with their fibres, row by row from the top: what a
    /// figure draws. `spacing_um` is the distance of neighbours; less than the field's own grid is taken
    /// as that, so that the list is never longer than the picture.
    pub fn on_grid(&self, spacing_um: f64) -> Vec<([f64; 2], Fibre)> {
        let place = &self.smoothed.place;
        let step = if spacing_um.is_finite() { spacing_um } else { 0.0 }.max(place.block_um);
        let count = place.grid.size.map(|blocks| (blocks as f64 * place.block_um / step) as usize);
        let mut points = Vec::new();
        for row in 0..count[1] {
            for column in 0..count[0] {
                let [x, y] = [column, row].map(|n| (n as f64 + 0.5) * step);
                let point = [place.corner_um[0] + x, place.corner_um[1] - y];
                let share: f64 = self
                    .corners(point)
                    .iter()
                    .map(|&(at, part)| part * f64::from(place.share[at]))
                    .sum();
                if share >= 0.5 {
                    points.push((point, self.at(point)));
                }
            }
        }
        points
    }

    /// The long axis that stands in where the picture shows no direction, a unit vector.
    pub fn long_axis(&self) -> [f64; 2] {
        self.long_axis
    }

    /// Numbers over the whole cell, each part of it weighed by its area.
    pub fn summary(&self) -> FibreSummary {
        let (mut area, mut from_picture, mut coherency) = (0.0, 0.0, 0.0);
        let mut sum = [0.0; 2];
        let [along_x, along_y] = self.long_axis;
        let vectors = self.smoothed.doubled.iter().zip(&self.mixed);
        for ((doubled, mixed), &share) in vectors.zip(&self.smoothed.place.share) {
            if share == 0.0 {
                continue;
            }
            let share = f64::from(share);
            let fibre = self.fibre(doubled.map(f64::from), mixed.map(f64::from));
            let [x, y] = fibre.direction;
            // Along and across the long axis.
            let turned = [x * along_x + y * along_y, y * along_x - x * along_y];
            let doubled = double(turned);
            area += share;
            from_picture += if fibre.from_picture { share } else { 0.0 };
            coherency += share * fibre.coherency;
            sum = [sum[0] + share * doubled[0], sum[1] + share * doubled[1]];
        }
        if area == 0.0 {
            area = 1.0;
        }
        FibreSummary {
            share_from_picture: from_picture / area,
            mean_angle_deg: line_angle_deg(0.5 * sum[1].atan2(sum[0])),
            order: (sum[0].hypot(sum[1]) / area).min(1.0),
            mean_coherency: coherency / area,
        }
    }

    /// The four blocks around a point with their parts.
    fn corners(&self, [x, y]: [f64; 2]) -> [(usize, f64); 4] {
        let place = &self.smoothed.place;
        let [columns, rows] = place.grid.size;
        let (column, right) = between((x - place.corner_um[0]) / place.block_um - 0.5, columns);
        let (row, below) = between((place.corner_um[1] - y) / place.block_um - 0.5, rows);
        let next = [(column + 1).min(columns - 1), (row + 1).min(rows - 1)];
        [
            (row * columns + column, (1.0 - below) * (1.0 - right)),
            (row * columns + next[0], (1.0 - below) * right),
            (next[1] * columns + column, below * (1.0 - right)),
            (next[1] * columns + next[0], below * right),
        ]
    }

    /// The fibre of the picture's doubled vector and of the mixed one.
    fn fibre(&self, doubled: [f64; 2], [x, y]: [f64; 2]) -> Fibre {
        let coherency = doubled[0].hypot(doubled[1]).min(1.0);
        let from_picture = coherency >= self.least_coherency;
        // Picture and long axis may cancel: then there is no direction between the two. Where there is
        // only the long axis it stays as it was given, to the last digit.
        let axis = double(self.long_axis);
        if x.hypot(y) < 1e-6 || (x - axis[0]).hypot(y - axis[1]) < 1e-6 {
            return Fibre { direction: self.long_axis, coherency, from_picture };
        }
        let (sin, cos) = (0.5 * y.atan2(x)).sin_cos();
        let along = cos * self.long_axis[0] + sin * self.long_axis[1];
        let direction = if along < 0.0 { [-cos, -sin] } else { [cos, sin] };
        Fibre { direction, coherency, from_picture }
    }
}

/// A unit vector at twice the angle.
fn double([x, y]: [f64; 2]) -> [f64; 2] {
    [x * x - y * y, 2.0 * x * y]
}

/// From 0 at 0 to 1 at 1 without a kink.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
