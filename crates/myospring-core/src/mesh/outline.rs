//! The outline of a cell: a polygon in micrometres, from GeoJSON or a list of points, and back.

mod error;
mod simple;
mod text;

pub use error::{LARGEST_EXTENT_UM, OutlineError, SMALLEST_AREA_UM2};

use simple::edges;

/// A polygon in micrometres, y upward: the exterior counter-clockwise, holes clockwise, no ring
/// repeats its first point; checked to be simple.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    exterior: Vec<[f64; 2]>,
    holes: Vec<Vec<[f64; 2]>>,
}

impl Outline {
    /// Makes an outline from its exterior and holes, um, in either direction, closed or not.
    ///
    /// # Errors
    /// Fewer than 3 points, coordinates that are not finite, no area, an impossible size, edges
    /// that cross, holes outside.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::outline::Outline;
    /// let corners = vec![[0.0, 0.0], [100.0, 0.0], [100.0, 20.0], [0.0, 20.0]];
    /// assert_eq!(Outline::new(corners, vec![]).unwrap().area(), 2000.0);
    ///
    /// let bow_tie = vec![[0.0, 0.0], [100.0, 20.0], [100.0, 0.0], [0.0, 30.0]];
    /// assert_eq!(
    ///     Outline::new(bow_tie, vec![]).unwrap_err().to_string(),
    ///     "the outline crosses or touches itself at (60, 12) um: its edges must go once around the cell"
    /// );
    /// ```
    pub fn new(exterior: Vec<[f64; 2]>, holes: Vec<Vec<[f64; 2]>>) -> Result<Self, OutlineError> {
        let exterior = tidy_ring("exterior", exterior, 1.0)?;
        let holes = holes
            .into_iter()
            .map(|hole| tidy_ring("hole", hole, -1.0))
            .collect::<Result<Vec<_>, _>>()?;
        let outline = Self { exterior, holes };
        let [low, high] = outline.bounds();
        let extent = (high[0] - low[0]).max(high[1] - low[1]);
        if extent > LARGEST_EXTENT_UM {
            return Err(OutlineError::TooLarge { extent });
        }
        // Checked before the area, which is meaningless for a ring that crosses itself.
        if extent * extent < SMALLEST_AREA_UM2 || outline.is_flat() {
            return Err(OutlineError::TooSmall { area: outline.area() });
        }
        simple::check(&outline.rings().collect::<Vec<_>>())?;
        if outline.area() < SMALLEST_AREA_UM2 {
            return Err(OutlineError::TooSmall { area: outline.area() });
        }
        Ok(outline)
    }

    /// Points around the cell, um, counter-clockwise; the first is not repeated.
    pub fn exterior(&self) -> &[[f64; 2]] {
        &self.exterior
    }

    /// Holes, um, each clockwise.
    pub fn holes(&self) -> &[Vec<[f64; 2]>] {
        &self.holes
    }

    /// The exterior, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        std::iter::once(self.exterior.as_slice()).chain(self.holes.iter().map(Vec::as_slice))
    }

    /// Area within the exterior and outside the holes, um^2.
    pub fn area(&self) -> f64 {
        self.rings().map(ring_area).sum()
    }

    /// Length of the exterior, um.
    pub fn perimeter(&self) -> f64 {
        edges(&self.exterior).map(|(p, q)| (q[0] - p[0]).hypot(q[1] - p[1])).sum()
    }

    /// Lower left and upper right corner of the bounding box, um.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for point in &self.exterior {
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(point[axis]);
                bounds[1][axis] = bounds[1][axis].max(point[axis]);
            }
        }
        bounds
    }

    /// Centre of the area, um.
    pub fn centroid(&self) -> [f64; 2] {
        // Relative to a point of the ring, so that a distant origin does not reduce precision.
        let base = self.exterior[0];
        let (mut area, mut sum) = (0.0, [0.0; 2]);
        for (p, q) in self.rings().flat_map(edges) {
            let (p, q) = (minus(p, base), minus(q, base));
            let cross = p[0] * q[1] - q[0] * p[1];
            area += cross / 2.0;
            sum[0] += cross * (p[0] + q[0]) / 6.0;
            sum[1] += cross * (p[1] + q[1]) / 6.0;
        }
        [base[0] + sum[0] / area, base[1] + sum[1] / area]
    }

    /// Second moments of area about the centroid, um^4: `[int x^2, int y^2, int x y] dA`.
    pub fn second_moments(&self) -> [f64; 3] {
        let centre = self.centroid();
        let mut sums = [0.0; 3];
        for (p, q) in self.rings().flat_map(edges) {
            let (p, q) = (minus(p, centre), minus(q, centre));
            let cross = p[0] * q[1] - q[0] * p[1];
            for (axis, sum) in sums.iter_mut().take(2).enumerate() {
                *sum += cross * (p[axis] * p[axis] + p[axis] * q[axis] + q[axis] * q[axis]) / 12.0;
            }
            sums[2] +=
                cross * (p[0] * q[1] + 2.0 * p[0] * p[1] + 2.0 * q[0] * q[1] + q[0] * p[1]) / 24.0;
        }
        sums
    }

    /// The outline rotated counter-clockwise by `angle_deg` degrees about its centroid.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::built_in;
    /// let cell = built_in::adult_ventricular();
    /// assert!((cell.rotated(30.0).area() - cell.area()).abs() < 1e-9 * cell.area());
    /// ```
    #[must_use]
    pub fn rotated(&self, angle_deg: f64) -> Self {
        // Quarter turns exactly, so that they map the lattice onto itself.
        let [cos, sin] = match angle_deg.rem_euclid(360.0) {
            0.0 => [1.0, 0.0],
            90.0 => [0.0, 1.0],
            180.0 => [-1.0, 0.0],
            270.0 => [0.0, -1.0],
            angle => [angle.to_radians().cos(), angle.to_radians().sin()],
        };
        let centre = self.centroid();
        self.map(|point| {
            let [x, y] = minus(point, centre);
            [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
        })
    }

    /// The outline moved by `shift` um.
    #[must_use]
    pub fn moved(&self, shift: [f64; 2]) -> Self {
        self.map(|point| [point[0] + shift[0], point[1] + shift[1]])
    }

    fn map(&self, change: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        let ring = |points: &Vec<[f64; 2]>| points.iter().map(|&point| change(point)).collect();
        Self { exterior: ring(&self.exterior), holes: self.holes.iter().map(ring).collect() }
    }

    /// Whether all points of the exterior lie on one line.
    fn is_flat(&self) -> bool {
        let base = self.exterior[0];
        let far = self
            .exterior
            .iter()
            .map(|&point| minus(point, base))
            .max_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])))
            .unwrap_or_default();
        let reach = far[0].hypot(far[1]);
        self.exterior.iter().all(|&point| {
            let [x, y] = minus(point, base);
            (x * far[1] - y * far[0]).abs() <= 1e-12 * reach * reach
        })
    }
}

/// Drops repeated points, checks the rest and orients the ring.
fn tidy_ring(
    name: &'static str,
    mut ring: Vec<[f64; 2]>,
    direction: f64,
) -> Result<Vec<[f64; 2]>, OutlineError> {
    if let Some(point) = ring.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        let [x, y] = ring[point];
        return Err(OutlineError::NotFinite { ring: name, point, x, y });
    }
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    if ring.len() < 3 {
        return Err(OutlineError::TooFewPoints { ring: name, found: ring.len() });
    }
    if ring_area(&ring) * direction < 0.0 {
        ring.reverse();
    }
    Ok(ring)
}

/// Area of a ring, positive when counter-clockwise, um^2.
fn ring_area(ring: &[[f64; 2]]) -> f64 {
    let base = ring[0];
    edges(ring)
        .map(|(p, q)| {
            let (p, q) = (minus(p, base), minus(q, base));
            0.5 * (p[0] * q[1] - q[0] * p[1])
        })
        .sum()
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
