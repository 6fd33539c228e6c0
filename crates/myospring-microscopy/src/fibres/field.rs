//! A field of directions over a cell.

use super::doubt::{Band, SarcomereDoubt};
use super::grid::between;
use super::misfit::Misfit;
use super::reading::{Place, Reading, Readings};
use myospring_core::mesh::Mesh;

/// A place with less than this part of its neighbourhood in the cell takes the long axis.
const LEAST_SHARE: f32 = 1e-3;

/// The fibre at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fibre {
    /// Unit vector along the fibre, y upward; of the two opposite vectors, the one nearer to the
    /// long axis.
    pub direction: [f64; 2],
    /// Whether the direction comes mainly from the picture; otherwise it comes mainly from the long
    /// axis, because the picture shows too little here (order, coverage).
    pub from_picture: bool,
    /// Length of a sarcomere, um: the period of the stripes along the fibre. None where the picture shows
    /// none, and with stains that have no stripes.
    pub sarcomere_um: Option<f64>,
    /// How sharply the picture shows one direction and one period, 0 for not at all to 1.
    pub order: f64,
    /// Part of the neighbourhood within the cell that shows a direction, 0 to 1.
    pub coverage: f64,
}

impl Fibre {
    /// Angle from x, counter-clockwise, degrees, above -90 and up to 90.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::fibres::Fibre;
    /// let fibre = Fibre {
    ///     direction: [0.0, -1.0],
    ///     from_picture: true,
    ///     sarcomere_um: Some(1.8),
    ///     order: 0.9,
    ///     coverage: 1.0,
    /// };
    /// assert_eq!(fibre.angle_deg(), 90.0);
    /// ```
    pub fn angle_deg(&self) -> f64 {
        let [x, y] = self.direction;
        line_angle_deg(y.atan2(x))
    }
}

/// Angle of a line in degrees, above -90 and up to 90, from an angle in radians.
fn line_angle_deg(angle: f64) -> f64 {
    let degrees = angle.to_degrees();
    90.0 - (90.0 - degrees).rem_euclid(180.0)
}

/// Summary of a fibre field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FibreSummary {
    /// Part of the cell's area in which the direction comes mainly from the picture, 0 to 1.
    pub share_from_picture: f64,
    /// Mean angle to the long axis, degrees counter-clockwise, above -90 and up to 90.
    pub mean_angle_deg: f64,
    /// How parallel the fibres of the cell are, `|mean of (cos 2 theta, sin 2 theta)|`: 1 for all
    /// in one direction, 0 for all directions. Places where the long axis is used are included.
    pub alignment: f64,
    /// Mean over the cell of [`Fibre::order`]: how sharply the picture shows one direction and one
    /// period, 0 to 1.
    pub mean_order: f64,
    /// Median length of the sarcomeres that were read, um, each place weighed by its area.
    pub median_sarcomere_um: Option<f64>,
    /// First and third quartile of that length, um.
    pub sarcomere_quartiles_um: Option<[f64; 2]>,
    /// Why that length is doubtful, if it is.
    pub sarcomere_doubt: Option<SarcomereDoubt>,
}

/// A warning is given below this part of the cell read from the picture, and above this angle from
/// its long axis.
const SMALL_SHARE: f64 = 0.25;
const LARGE_ANGLE_DEG: f64 = 45.0;

/// A cell with at least this ratio of length to width is slender.
const SLENDER: f64 = 2.5;

/// Directions of the myofibrils everywhere in a cell; see [`fibres`](super::fibres()).
#[derive(Debug, Clone, PartialEq)]
pub struct FibreField {
    readings: Readings,
    /// Direction vectors at twice the fibre angle, mixed from picture and long axis.
    mixed: Vec<[f32; 2]>,
    /// Part of each place's neighbourhood that shows a direction.
    coverage: Vec<f32>,
    /// Unit vector.
    long_axis: [f64; 2],
    /// The periods that were searched, for stains with stripes.
    band: Option<Band>,
    /// Stripes with a period that sarcomeres cannot have.
    misfit: Option<Misfit>,
}

impl FibreField {
    /// Mixes the picture's directions with the long axis: the picture's direction is used where
    /// there is one, and changes into the long axis over `border_um` beside such places.
    pub(super) fn new(
        readings: Readings,
        band: Option<Band>,
        misfit: Option<Misfit>,
        long_axis: [f64; 2],
        border_um: f64,
    ) -> Self {
        let axis = double(long_axis);
        let Place { grid, block_um, share, .. } = &readings.place;
        let blurred = |value: &dyn Fn(usize) -> f32| {
            // Places outside the cell have no weight.
            let mut values: Vec<f32> = (0..share.len()).map(|at| share[at] * value(at)).collect();
            grid.blur(&mut values, border_um / block_um);
            values
        };
        let at = &readings.at;
        let near = [0, 1].map(|i: usize| blurred(&|place| at[place].part * at[place].doubled[i]));
        let answered = blurred(&|place| if at[place].part >= 0.5 { 1.0 } else { 0.0 });
        let cell = blurred(&|_| 1.0);
        let coverage: Vec<f32> = (answered.iter().zip(&cell))
            .map(|(answered, cell)| if *cell < LEAST_SHARE { 0.0 } else { answered / cell })
            .map(|part| part.min(1.0))
            .collect();
        let mixed = |place: usize| {
            // On a straight border half of the neighbourhood shows a direction.
            let beside = smooth_step(2.0 * f64::from(coverage[place]));
            let Reading { doubled, part, .. } = at[place];
            let vector =
                if part >= 0.5 { doubled } else { near.each_ref().map(|near| near[place]) };
            let [x, y] = vector.map(f64::from);
            let length = x.hypot(y);
            let part = if length > 1e-6 { f64::from(part).max(beside) } else { 0.0 };
            let mix = |axis: f64, x: f64| {
                (if part > 0.0 { (1.0 - part) * axis + part * x / length } else { axis }) as f32
            };
            [mix(axis[0], x), mix(axis[1], y)]
        };
        let mixed = (0..share.len()).map(mixed).collect();
        Self { readings, mixed, coverage, long_axis, band, misfit }
    }

    /// The fibre at a point, um from the lower left corner of the picture, y upward.
    ///
    /// Outside the cell it is that of the nearest examined part of the picture, or the long axis;
    /// so a triangle that reaches over the outline has a fibre, too.
    pub fn at(&self, point_um: [f64; 2]) -> Fibre {
        let mut places = self.corners(point_um);
        // Blocks outside the cell have no weight if another one lies inside.
        let share = |at: usize| f64::from(self.readings.place.share[at]);
        let within: f64 = places.iter().map(|&(at, part)| part * share(at)).sum();
        if within > f64::from(LEAST_SHARE) {
            places = places.map(|(at, part)| (at, part * share(at) / within));
        }
        let between = |value: &dyn Fn(usize) -> f64| {
            places.iter().map(|&(at, part)| part * value(at)).sum::<f64>()
        };
        let mixed = [0, 1].map(|axis: usize| between(&|at| f64::from(self.mixed[at][axis])));
        let readings = &self.readings.at;
        let sarcomeres: Vec<(f64, f64)> = (places.iter())
            .filter_map(|&(at, part)| Some((f64::from(readings[at].sarcomere_um?), part)))
            .collect();
        let weight: f64 = sarcomeres.iter().map(|(_, part)| part).sum();
        let length = sarcomeres.iter().map(|(length, part)| length * part).sum::<f64>() / weight;
        let from_picture = between(&|at| f64::from(readings[at].part)) >= 0.5;
        Fibre {
            direction: self.direction(mixed),
            from_picture,
            sarcomere_um: (from_picture && weight > 0.0).then_some(length),
            order: between(&|at| f64::from(readings[at].order)).min(1.0),
            coverage: between(&|at| f64::from(self.coverage[at])).min(1.0),
        }
    }

    /// The fibre in each triangle of a mesh (`mesh.simplices`), at the triangle's centre. The mesh
    /// must lie where the cell lies in the picture, as
    /// [`lattice::from_mask`](myospring_core::mesh::lattice::from_mask) makes it.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{lattice, pixel_size::PixelSize};
    /// use myospring::microscopy::fibres::{FibreSettings, Stain, fibres};
    /// use myospring::microscopy::plane::Plane;
    /// let plane = Plane::new(50, 50, vec![1.0; 2500]).unwrap();
    /// let settings = FibreSettings::of(Stain::ZDisc);
    /// let field = fibres(&plane, &[true; 2500], PixelSize::new(0.2)?, [0.0, 2.0], &settings)?;
    /// let triangles = field.on_triangles(&lattice::rectangle(5, 5, 1.0).unwrap());
    /// // Nothing to see: the long axis, and no sarcomere.
    /// assert!(triangles.iter().all(|fibre| !fibre.from_picture && fibre.sarcomere_um.is_none()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn on_triangles(&self, mesh: &Mesh) -> Vec<Fibre> {
        let centre = |nodes: [u32; 3]| {
            let [a, b, c] = nodes.map(|node| mesh.point(node as usize));
            [0, 1].map(|axis: usize| (a[axis] + b[axis] + c[axis]) / 3.0)
        };
        mesh.simplices.iter().map(|triangle| self.at(centre(triangle.nodes))).collect()
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
        self.on_triangles(mesh).into_iter().map(|fibre| fibre.direction).collect()
    }

    /// The fibres at the points of a square grid within the cell, row by row from the top, for
    /// figures. `spacing_um` is the distance between neighbours, at least that of the field's own
    /// grid.
    pub fn on_grid(&self, spacing_um: f64) -> Vec<([f64; 2], Fibre)> {
        let place = &self.readings.place;
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

    /// Stripes too far apart or too close for sarcomeres; they were not used.
    pub fn misfit(&self) -> Option<Misfit> {
        self.misfit
    }

    /// The long axis, used where the picture shows no direction; a unit vector.
    pub fn long_axis(&self) -> [f64; 2] {
        self.long_axis
    }

    /// Returns a function that determines whether a sarcomere length (um) is doubtful: near an end
    /// of the searched band, or in a cell that was read in too small a part.
    pub fn doubtful_lengths(&self) -> impl Fn(f64) -> bool {
        let doubt = self.summary().sarcomere_doubt;
        let of_all = matches!(doubt, Some(SarcomereDoubt::FewPlaces { .. }));
        let band = self.band;
        move |length| of_all || band.is_some_and(|band| band.doubt(length, 1.0).is_some())
    }

    /// Summary over the whole cell, weighted by area.
    pub fn summary(&self) -> FibreSummary {
        let (mut area, mut from_picture, mut order) = (0.0, 0.0, 0.0);
        let mut sum = [0.0; 2];
        let mut sarcomeres = Vec::new();
        let [along_x, along_y] = self.long_axis;
        let Readings { place, at } = &self.readings;
        for ((reading, mixed), &share) in at.iter().zip(&self.mixed).zip(&place.share) {
            if share == 0.0 {
                continue;
            }
            let share = f64::from(share);
            let [x, y] = self.direction(mixed.map(f64::from));
            // Along and across the long axis.
            let turned = [x * along_x + y * along_y, y * along_x - x * along_y];
            let doubled = double(turned);
            area += share;
            from_picture += if reading.part >= 0.5 { share } else { 0.0 };
            order += share * f64::from(reading.order);
            sum = [sum[0] + share * doubled[0], sum[1] + share * doubled[1]];
            sarcomeres.extend(reading.sarcomere_um.map(|length| (f64::from(length), share)));
        }
        if area == 0.0 {
            area = 1.0;
        }
        sarcomeres.sort_by(|a, b| a.0.total_cmp(&b.0));
        let median_sarcomere_um = quantile(&sarcomeres, 0.5);
        let read = sarcomeres.iter().map(|(_, share)| share).sum::<f64>() / area;
        let doubt = |(band, length): (Band, f64)| band.doubt(length, read);
        FibreSummary {
            share_from_picture: from_picture / area,
            mean_angle_deg: line_angle_deg(0.5 * sum[1].atan2(sum[0])),
            alignment: (sum[0].hypot(sum[1]) / area).min(1.0),
            mean_order: order / area,
            median_sarcomere_um,
            sarcomere_quartiles_um: quantile(&sarcomeres, 0.25)
                .zip(quantile(&sarcomeres, 0.75))
                .map(|(first, third)| [first, third]),
            sarcomere_doubt: self.band.zip(median_sarcomere_um).and_then(doubt),
        }
    }

    /// Warnings about the field, one sentence each, for instance that the picture shows fibres in a
    /// small part of the cell, or that they lie across the cell.
    pub fn warnings(&self) -> Vec<String> {
        let share = self.summary().share_from_picture;
        let mut warnings = self.doubts();
        if self.misfit.is_none() && share < SMALL_SHARE {
            warnings.push(format!(
                "the picture shows fibres in only {:.0} % of the cell; elsewhere the long axis is used",
                100.0 * share
            ));
        }
        warnings
    }

    /// The warnings that do not depend on how much of the cell was read: stripes of another period,
    /// a doubtful sarcomere length, fibres across the cell.
    pub fn doubts(&self) -> Vec<String> {
        let summary = self.summary();
        let mut warnings = Vec::new();
        if let Some(misfit) = self.misfit {
            warnings.push(format!("{misfit}; they are not used; the long axis is used instead"));
        }
        if let (Some(length), Some(doubt)) = (summary.median_sarcomere_um, summary.sarcomere_doubt)
        {
            warnings.push(format!("the sarcomere length of {length:.2} um is doubtful: {doubt}"));
        }
        if summary.share_from_picture > 0.0 && summary.mean_angle_deg.abs() > LARGE_ANGLE_DEG {
            let slender = self.slenderness();
            let shape = if slender >= SLENDER {
                format!(" ({slender:.0} times as long as wide, where myofibrils run along it)")
            } else {
                String::new()
            };
            warnings.push(format!(
                "the fibres lie across the cell{shape}, at {:.0} degrees from its long axis on average: is the \
                 stain right? Z-discs lie across the fibre (--stain z-disc), filaments along it (--stain filament); \
                 compare the overlay, or take --fibre \"long axis\"",
                summary.mean_angle_deg
            ));
        }
        warnings
    }

    /// The four blocks around a point with their interpolation weights.
    fn corners(&self, [x, y]: [f64; 2]) -> [(usize, f64); 4] {
        let place = &self.readings.place;
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

    /// The direction of a mixed vector.
    fn direction(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        // Picture and long axis may cancel; then the long axis is used. Where there is only the
        // long axis, it is returned exactly as given.
        let axis = double(self.long_axis);
        if x.hypot(y) < 1e-6 || (x - axis[0]).hypot(y - axis[1]) < 1e-6 {
            return self.long_axis;
        }
        let (sin, cos) = (0.5 * y.atan2(x)).sin_cos();
        let along = cos * self.long_axis[0] + sin * self.long_axis[1];
        if along < 0.0 { [-cos, -sin] } else { [cos, sin] }
    }

    /// Length over width of the cell, from the second moments of its area.
    fn slenderness(&self) -> f64 {
        let place = &self.readings.place;
        let mut sums = [0.0; 6];
        for (at, &share) in place.share.iter().enumerate() {
            let [x, y] = [at % place.grid.size[0], at / place.grid.size[0]].map(|n| n as f64);
            for (sum, term) in sums.iter_mut().zip([1.0, x, y, x * x, y * y, x * y]) {
                *sum += f64::from(share) * term;
            }
        }
        let [area, x, y, xx, yy, xy] = sums.map(|sum| sum / sums[0].max(f64::MIN_POSITIVE));
        // Second moment of a unit square about its centre.
        let square = 1.0 / 12.0;
        let (xx, yy, xy) = (xx - x * x + square, yy - y * y + square, xy - x * y);
        let half = (0.5 * (xx - yy)).hypot(xy);
        let middle = 0.5 * (xx + yy);
        if area > 0.0 { ((middle + half) / (middle - half)).sqrt() } else { 1.0 }
    }
}

/// Weighted quantile: the value below which the part `part` of the total weight lies. `values` are
/// (value, weight) in ascending order.
fn quantile(values: &[(f64, f64)], part: f64) -> Option<f64> {
    let whole: f64 = values.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    values
        .iter()
        .find(|(_, weight)| {
            below += weight;
            below >= part * whole
        })
        .map(|(value, _)| *value)
}

/// Smooth step from 0 at 0 to 1 at 1, with zero slope at both.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// A unit vector at twice the angle.
fn double([x, y]: [f64; 2]) -> [f64; 2] {
    [x * x - y * y, 2.0 * x * y]
}
