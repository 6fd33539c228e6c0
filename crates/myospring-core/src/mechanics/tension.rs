//! The active tension as input of the forces: one number, or one for each triangle.

/// Active tension, kPa.
///
/// # Example
/// ```
/// use myospring::mechanics::Tension;
/// let wave = [10.0, 20.0, 0.0];
/// assert_eq!(Tension::PerElement(&wave).at(1), 20.0);
/// assert_eq!(Tension::from(50.0).at(1), 50.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tension<'a> {
    /// Uniform tension.
    Uniform(f64),
    /// One for each triangle (tetrahedron) of the mesh.
    PerElement(&'a [f64]),
    /// One for each triangle, which depends on the triangle's own stretch and rate of stretch.
    Following(Following<'a>),
}

/// Tensions that depend linearly on the stretch of their triangle along the fibre and on its rate, about a
/// state:
///
/// ```text
/// Ta = tension + per_stretch (stretch now - stretch) + per_rate (rate now - rate)
/// ```
///
/// All lists run over the triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Following<'a> {
    /// Tension in that state, kPa.
    pub tension: &'a [f64],
    /// Its derivative with respect to the stretch, kPa.
    pub per_stretch: &'a [f64],
    /// Its derivative with respect to the rate of stretch, kPa ms.
    pub per_rate: &'a [f64],
    /// Stretch in that state, length over resting length.
    pub stretch: &'a [f64],
    /// Rate of stretch in that state, 1/ms.
    pub rate: &'a [f64],
}

impl Following<'_> {
    /// Tension of a triangle at a stretch and a rate of stretch (1/ms), kPa.
    pub fn at(&self, element: usize, stretch: f64, rate: f64) -> f64 {
        self.tension[element]
            + self.per_stretch[element] * (stretch - self.stretch[element])
            + self.per_rate[element] * (rate - self.rate[element])
    }
}

impl Tension<'_> {
    /// Tension of a triangle, kPa; one that depends on the stretch is taken in its reference state.
    pub fn at(&self, element: usize) -> f64 {
        match self {
            Self::Uniform(tension) => *tension,
            Self::PerElement(tensions) => tensions[element],
            Self::Following(law) => law.tension[element],
        }
    }

    /// The tension, kPa, if it is uniform.
    pub fn uniform(&self) -> Option<f64> {
        match self {
            Self::Uniform(tension) => Some(*tension),
            Self::PerElement(_) | Self::Following(_) => None,
        }
    }

    /// The tension at a fraction (0 to 1) of the way from one to another; `buffer` is a workspace
    /// for the tensions of the triangles. If both depend on the stretch, their reference state is
    /// interpolated, too, so that nothing jumps at the start.
    pub fn between<'b>(
        [from, to]: [Tension<'b>; 2],
        part: f64,
        buffer: &'b mut Vec<f64>,
    ) -> Tension<'b> {
        let mixed = |from: f64, to: f64| from + (to - from) * part;
        let count = match (from, to) {
            (Tension::Uniform(from), Tension::Uniform(to)) => {
                return Tension::Uniform(mixed(from, to));
            }
            (
                _,
                Tension::PerElement(list) | Tension::Following(Following { tension: list, .. }),
            )
            | (
                Tension::PerElement(list) | Tension::Following(Following { tension: list, .. }),
                _,
            ) => list.len(),
        };
        // Expanded about the state at the end, but with the tension of the start at the state of
        // the start.
        let first = |element: usize| match (from, to) {
            (Tension::Following(start), Tension::Following(end)) => {
                start.tension[element]
                    + end.per_stretch[element] * (end.stretch[element] - start.stretch[element])
                    + end.per_rate[element] * (end.rate[element] - start.rate[element])
            }
            _ => from.at(element),
        };
        buffer.clear();
        buffer.extend((0..count).map(|element| mixed(first(element), to.at(element))));
        match to {
            Tension::Following(law) => Tension::Following(Following { tension: buffer, ..law }),
            _ => Tension::PerElement(buffer),
        }
    }

    /// The largest tension, kPa; 0 without triangles.
    pub fn highest(&self) -> f64 {
        match self {
            Self::Uniform(tension) => *tension,
            Self::PerElement(tensions) | Self::Following(Following { tension: tensions, .. }) => {
                tensions.iter().copied().reduce(f64::max).unwrap_or_default()
            }
        }
    }
}

impl From<f64> for Tension<'_> {
    fn from(tension: f64) -> Self {
        Self::Uniform(tension)
    }
}
