//! Tractions from displacements of the gel: traction-force microscopy.
//!
//! In a window that goes on periodically, displacement and traction of each wave are in proportion (`butler_2002`; of a layer,
//! `wave`). Noise of short waves would be multiplied, so they are damped (`sabass_2008`):
//!
//! ```text
//! t(k) = g u(k) / (g^2 + lambda^2)         g: displacement over traction, along the wave vector and across it
//! ```
//!
//! `lambda` is chosen by generalised cross-validation (`golub_1979`): it makes the sum of `(1 - f)^2 |u|^2` over the square of
//! the sum of `1 - f` least, with `f = g^2/(g^2 + lambda^2)`. The displacements that the damped
//! tractions do not explain estimate the noise of the displacements; the noise of the tractions follows from it.
//!
//! Displacements that were measured in overlapping squares share their errors with their neighbours, so the noise seems smaller than it
//! is. Smoothing and noise are then those of the places that are so far apart that their squares do not overlap.
//!
//! With a region, tractions are 0 outside of it: they are those whose displacements, in an endless plane, are nearest to the
//! measured ones up to a shift, with the same `lambda`, by conjugate gradients on the normal equations.

use super::conjugate;
use super::convolution::{Convolution, Number, Waves};
use super::description::{Gel, GelError};
use super::green::Green;
use super::pull::PullAxis;
use super::surface::Surface;
use super::wave;
use crate::mechanics::vectors::{Vectors, add_scaled};
use std::f64::consts::{PI, TAU};

/// How many values of `lambda` are tried, and the decades that they cover below the largest `g`.
const TRIED: usize = 49;
const DECADES: f64 = 6.0;
/// Rounds of conjugate gradients, and the part of the residual at which they end.
const ROUNDS: usize = 200;
const ENOUGH: f64 = 1e-8;
/// Fewest places along an axis of a surface from which noise is estimated.
const FEWEST: usize = 4;

/// What is known of the errors of displacements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Along each axis, the number of places that share their errors since they were measured in overlapping squares; 1 where
    /// each has its own.
    pub overlap: usize,
    /// Standard deviation that they have at least, um. Noise below what the shortest waves move cannot be found otherwise.
    pub least_um: f64,
}

impl Default for Errors {
    /// Each place has its own error, of unknown size.
    fn default() -> Self {
        Self { overlap: 1, least_um: 0.0 }
    }
}

/// Tractions on a gel, at the places of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Tractions {
    /// Along x and y, Pa, row by row from the lowest.
    pub tractions_pa: Vectors,
    /// How much short waves are damped, um/kPa.
    pub smoothing: f64,
    /// Waves shorter than this are damped to less than half, um.
    pub shortest_wave_um: f64,
    /// Standard deviation of the noise of a displacement, um.
    pub noise_um: f64,
    /// Standard deviation of a traction that this noise makes, Pa, where tractions are not confined to a region.
    pub noise_pa: f64,
    /// Along each axis, the number of places that share their errors.
    pub overlap: usize,
}

impl Tractions {
    /// Sum of the absolute tractions over places of this spacing, um, in nN; of those in a region, if there is one.
    pub fn force_nn(&self, spacing: f64, region: Option<&[bool]>) -> f64 {
        let [x, y] = &self.tractions_pa;
        let within = |place: usize| region.is_none_or(|region| region[place]);
        let sizes = x.iter().zip(y).enumerate().filter(|(place, _)| within(*place));
        1e-3 * spacing * spacing * sizes.map(|(_, (x, y))| x.hypot(*y)).sum::<f64>()
    }

    /// Force that noise alone makes in this number of places, nN.
    pub fn noise_floor_nn(&self, spacing: f64, places: usize) -> f64 {
        // The mean length of a vector of two normal numbers.
        1e-3 * spacing * spacing * places as f64 * self.noise_pa * (0.5 * PI).sqrt()
    }
}

/// A wave.
struct Wave {
    /// Displacement over traction, along its wave vector and across it, um/kPa.
    compliance: [f64; 2],
    /// Of the wave vector.
    direction: [f64; 2],
    /// 1/um.
    number: f64,
}

/// The tractions that move a surface as it was measured, of each of a number of measurements, such as those of a film: one
/// smoothing serves all.
///
/// # Errors
/// A layer thinner than the distance of places.
///
/// # Panics
/// If displacements or region are not one for each place, or surfaces are of several shapes.
///
/// # Example
/// The tractions of a simulated cell, from the displacements around it:
/// ```
/// use myospring::mechanics::compliance::Compliance;
/// use myospring::mechanics::gel::cytometry::{Errors, tractions};
/// use myospring::mechanics::gel::{Gel, GelBed};
/// use myospring::mesh::lattice;
///
/// let strip = lattice::rectangle(40, 12, 1.0)?;
/// let gel = Gel::half_space(10.0);
/// let bed = GelBed::new(gel, &strip, [1.0, 0.0])?;
/// let x = strip.points[0].iter().map(|x| 20.0 + 0.98 * (x - 20.0)).collect();
/// let forces = bed.forces(&bed.displacements(&[x, strip.points[1].clone()]));
/// let total: f64 = forces[0].iter().zip(&forces[1]).map(|(x, y)| x.hypot(*y)).sum();
/// let surface = bed.surface(&forces, 1.0);
/// let inside = surface.within(|[x, y]| (-1.0..41.0).contains(&x) && (-1.0..13.0).contains(&y));
/// let found = tractions(&gel, &[surface], Some(&inside), Errors::default())?;
/// assert!((found[0].force_nn(1.0, Some(&inside)) / total - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn tractions(
    gel: &Gel,
    surfaces: &[Surface],
    region: Option<&[bool]>,
    errors: Errors,
) -> Result<Vec<Tractions>, GelError> {
    let Some(first) = surfaces.first() else { return Ok(Vec::new()) };
    gel.check_spacing(first.spacing)?;
    let places = first.shape[0] * first.shape[1];
    let waves = Waves::new(first.shape);
    // A surface of few places cannot be parted.
    let overlap = errors.overlap.clamp(1, (first.shape[0].min(first.shape[1]) / FEWEST).max(1));
    let spectra: Vec<Vec<Spectrum>> = surfaces
        .iter()
        .map(|surface| {
            assert_eq!(surface.shape, first.shape, "surfaces of one shape");
            let lengths = surface.displacements.each_ref().map(Vec::len);
            assert_eq!(lengths, [places; 2], "one displacement for each place");
            let parts = parted(surface, overlap);
            parts.iter().map(|part| Spectrum::of(gel, part, &Waves::new(part.shape))).collect()
        })
        .collect();
    let smoothing = cross_validated(&spectra);
    let inverse = region.map(|region| Confined::new(gel, first, region, smoothing));
    let one = |(surface, spectra): (&Surface, &Vec<Spectrum>)| {
        let [noise_um, gain] = noise(spectra, smoothing);
        let noise_um = noise_um.max(errors.least_um);
        let tractions = match &inverse {
            Some(inverse) => inverse.tractions(surface),
            None => everywhere(gel, surface, &waves, smoothing),
        };
        Tractions {
            // kPa.
            tractions_pa: tractions.map(|axis| axis.into_iter().map(|t| 1e3 * t).collect()),
            smoothing,
            shortest_wave_um: shortest(spectra, smoothing),
            noise_um,
            noise_pa: 1e3 * noise_um * gain,
            overlap,
        }
    };
    Ok(surfaces.iter().zip(&spectra).map(one).collect())
}

/// Standard deviation of the axial force that noise of the displacements alone makes, nN; of tractions within a region as if
/// they had not been confined to it.
pub fn axial_noise_nn(
    gel: &Gel,
    surface: &Surface,
    found: &Tractions,
    axis: &PullAxis,
    region: Option<&[bool]>,
) -> f64 {
    // Tractions are `K u` with a symmetric `K`, so a force `w . K u` has the variance `noise^2 |K w|^2`.
    let weights = Surface { displacements: axis.weights(surface, region), ..surface.clone() };
    let waves = Waves::new(surface.shape);
    let gathered = everywhere(gel, &weights, &waves, found.smoothing);
    let squares = gathered.iter().flatten().map(|value| value * value).sum::<f64>();
    // The weights are those of Pa. Places that share an error have it all together.
    1e3 * found.noise_um * found.overlap as f64 * squares.sqrt()
}

/// Tractions (kPa) of all waves, damped.
fn everywhere(gel: &Gel, surface: &Surface, waves: &Waves, smoothing: f64) -> Vectors {
    let square = smoothing * smoothing;
    waves.changed(&centred(&surface.displacements), |place, [x, y]| {
        let Wave { compliance, direction: [cosine, sine], .. } = wave_at(gel, surface, place);
        let [along, across] = [x * cosine + y * sine, y * cosine - x * sine];
        let damped = |part: Number, g: f64| {
            if g > 0.0 { part * (g / (g * g + square)) } else { Number::default() }
        };
        let [along, across] = [damped(along, compliance[0]), damped(across, compliance[1])];
        [along * cosine - across * sine, along * sine + across * cosine]
    })
}

/// Without the mean.
fn centred(vectors: &Vectors) -> Vectors {
    vectors.each_ref().map(|axis| {
        let mean = axis.iter().sum::<f64>() / axis.len() as f64;
        axis.iter().map(|x| x - mean).collect()
    })
}

/// A wave of a surface. The mean is one that moves nothing.
fn wave_at(gel: &Gel, surface: &Surface, place: [usize; 2]) -> Wave {
    let k = [0, 1].map(|axis: usize| {
        let (at, count) = (place[axis] as f64, surface.shape[axis] as f64);
        TAU * if 2.0 * at <= count { at } else { at - count } / (count * surface.spacing)
    });
    let number = k[0].hypot(k[1]);
    if number == 0.0 {
        return Wave { compliance: [0.0; 2], direction: [1.0, 0.0], number };
    }
    let in_units = match gel.thickness {
        Some(thickness) => {
            let [along, across, _] = wave::compliance(gel.poisson, number * thickness);
            [along, across]
        }
        None => [1.0 - gel.poisson, 1.0],
    };
    let compliance = in_units.map(|part| part / (gel.shear_modulus() * number));
    Wave { compliance, direction: k.map(|part| part / number), number }
}

/// The measured waves, each with both of its parts.
struct Spectrum {
    places: f64,
    /// Compliance, um/kPa, and square of the displacement, um^2, of a part, times how often it occurs.
    parts: Vec<[f64; 3]>,
    /// Numbers of the waves, 1/um, with the compliance across them.
    numbers: Vec<[f64; 2]>,
}

impl Spectrum {
    fn of(gel: &Gel, surface: &Surface, waves: &Waves) -> Self {
        let places = (surface.shape[0] * surface.shape[1]) as f64;
        let (mut parts, mut numbers) = (Vec::new(), Vec::new());
        waves.changed(&centred(&surface.displacements), |place, [x, y]| {
            let Wave { compliance, direction: [cosine, sine], number } =
                wave_at(gel, surface, place);
            // The opposite wave is alike, unless it is this one.
            let opposite =
                [0, 1].map(|axis: usize| (surface.shape[axis] - place[axis]) % surface.shape[axis]);
            let times = if opposite == place { 1.0 } else { 2.0 };
            // By Parseval, with transforms that are not divided by the number of places.
            let sizes =
                [x * cosine + y * sine, y * cosine - x * sine].map(|part| part.norm_sqr() / places);
            if number > 0.0 {
                parts.extend(compliance.iter().zip(sizes).map(|(g, size)| [*g, size, times]));
                numbers.push([number, compliance[1]]);
            }
            [x, y]
        });
        Self { places, parts, numbers }
    }

    /// Sum of squares that a smoothing leaves, um^2, and the number of independent ones.
    fn left(&self, smoothing: f64) -> [f64; 2] {
        let square = smoothing * smoothing;
        self.parts.iter().fold([0.0; 2], |[left, freedom], [g, size, times]| {
            let lost = square / (g * g + square);
            [left + times * lost * lost * size, freedom + times * lost]
        })
    }

    /// Sum over all parts of the square of what noise is multiplied by in tractions, (kPa/um)^2.
    fn gain(&self, smoothing: f64) -> f64 {
        let parts = self.parts.iter();
        parts.map(|[g, _, times]| times * (g / (g * g + smoothing * smoothing)).powi(2)).sum()
    }
}

/// Standard deviation of the displacements' noise, um, and what it is multiplied by in tractions, kPa/um.
fn noise(spectra: &[Spectrum], smoothing: f64) -> [f64; 2] {
    let [left, freedom] = left(spectra.iter(), smoothing);
    let gain = spectra.iter().map(|spectrum| spectrum.gain(smoothing)).sum::<f64>();
    let places = spectra.iter().map(|spectrum| spectrum.places).sum::<f64>();
    let gain = (gain / (2.0 * places)).sqrt();
    [if freedom > 0.0 { (left / freedom).sqrt() } else { 0.0 }, gain]
}

/// The shortest wave of which at least half is kept, um.
fn shortest(spectra: &[Spectrum], smoothing: f64) -> f64 {
    let kept = spectra.iter().flat_map(|spectrum| &spectrum.numbers);
    let kept = kept.filter(|[_, g]| *g >= smoothing);
    TAU / kept.map(|[number, _]| *number).fold(0.0, f64::max)
}

/// Sum of squares that a smoothing leaves of all, um^2, and the number of independent ones.
fn left<'a>(spectra: impl Iterator<Item = &'a Spectrum>, smoothing: f64) -> [f64; 2] {
    let sums = spectra.map(|spectrum| spectrum.left(smoothing));
    sums.fold([0.0; 2], |sum, next| [sum[0] + next[0], sum[1] + next[1]])
}

/// Surfaces of every so many-th place along each axis, from each first place.
fn parted(surface: &Surface, every: usize) -> Vec<Surface> {
    let [columns, rows] = surface.shape;
    let starts = (0..every).flat_map(|row| (0..every).map(move |column| [column, row]));
    let part = |[column, row]: [usize; 2]| Surface {
        spacing: every as f64 * surface.spacing,
        origin: surface.place(row * columns + column),
        shape: [(columns - column).div_ceil(every), (rows - row).div_ceil(every)],
        displacements: surface.displacements.each_ref().map(|axis| {
            let rows = axis.chunks_exact(columns).skip(row).step_by(every);
            rows.flat_map(|row| row[column..].iter().step_by(every)).copied().collect()
        }),
    };
    starts.map(part).collect()
}

/// The smoothing by generalised cross-validation of all measurements, um/kPa.
fn cross_validated(spectra: &[Vec<Spectrum>]) -> f64 {
    let parts = spectra.iter().flatten().flat_map(|spectrum| &spectrum.parts);
    let largest = parts.map(|[g, ..]| *g).fold(0.0, f64::max);
    let tried =
        (0..TRIED).map(|step| largest * 10f64.powf(-DECADES * step as f64 / (TRIED - 1) as f64));
    let score = |smoothing: f64| {
        let [left, freedom] = left(spectra.iter().flatten(), smoothing);
        left / (freedom * freedom)
    };
    let best = tried.map(|smoothing| (score(smoothing), smoothing));
    best.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(largest, |(_, smoothing)| smoothing)
}

/// The search for tractions that are 0 outside a region.
struct Confined<'a> {
    region: &'a [bool],
    convolution: Convolution,
    places: Vec<[u32; 2]>,
    /// Of a place, um^2.
    area: f64,
    /// Square of the smoothing.
    square: f64,
}

impl<'a> Confined<'a> {
    fn new(gel: &Gel, surface: &Surface, region: &'a [bool], smoothing: f64) -> Self {
        let &Surface { spacing, shape, .. } = surface;
        assert_eq!(region.len(), shape[0] * shape[1], "a region of that surface");
        let place = |place: usize| [(place % shape[0]) as u32, (place / shape[0]) as u32];
        Self {
            region,
            convolution: Convolution::new(&Green::new(*gel, spacing), spacing, shape),
            places: (0..region.len()).map(place).collect(),
            area: spacing * spacing,
            square: smoothing * smoothing,
        }
    }

    /// Displacements (um) without their mean under tractions (kPa).
    fn displaced(&self, tractions: &Vectors) -> Vectors {
        let forces = tractions.each_ref().map(|axis| axis.iter().map(|t| self.area * t).collect());
        centred(&self.convolution.displacements(&self.places, &forces))
    }

    /// The transposed of [`Confined::displaced`], of vectors without a mean: both are symmetric.
    fn gathered(&self, moved: &Vectors) -> Vectors {
        self.convolution.displacements(&self.places, moved).map(|axis| {
            let places = axis.into_iter().zip(self.region);
            places.map(|(x, inside)| if *inside { self.area * x } else { 0.0 }).collect()
        })
    }

    /// The tractions, kPa.
    fn tractions(&self, surface: &Surface) -> Vectors {
        let right = self.gathered(&centred(&surface.displacements));
        let times = |tractions: &Vectors| {
            let mut image = self.gathered(&self.displaced(tractions));
            add_scaled(&mut image, self.square, tractions);
            image
        };
        conjugate::solve(&right, times, Vectors::clone, ENOUGH, ROUNDS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::Compliance;
    use crate::mechanics::gel::GelBed;
    use crate::mesh::{Mesh, lattice};

    /// A strip of 48 x 14 um that shortens by a fiftieth, widens by a hundredth, and its gel.
    fn pulled(gel: Gel) -> (Mesh, Surface, f64) {
        let mesh = lattice::rectangle(48, 14, 1.0).unwrap();
        let bed = GelBed::new(gel, &mesh, [1.0, 0.0]).unwrap();
        let stretched = |axis: usize, middle: f64, by: f64| {
            mesh.points[axis].iter().map(|x| middle + by * (x - middle)).collect()
        };
        let positions = [stretched(0, 24.0, 0.98), stretched(1, 7.0, 1.01)];
        let forces = bed.forces(&bed.displacements(&positions));
        let total = forces[0].iter().zip(&forces[1]).map(|(x, y)| x.hypot(*y)).sum();
        let surface = bed.surface(&forces, 0.6);
        (mesh, surface, total)
    }

    fn one(gel: &Gel, surface: &Surface, region: Option<&[bool]>) -> Tractions {
        tractions(gel, std::slice::from_ref(surface), region, Errors::default()).unwrap().remove(0)
    }

    /// Numbers of a normal distribution, by sums of twelve.
    fn noise(count: usize, size: f64, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut even = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| size * ((0..12).map(|_| even()).sum::<f64>() - 6.0)).collect()
    }

    fn inside(surface: &Surface) -> Vec<bool> {
        surface.within(|[x, y]| (-1.1..49.1).contains(&x) && (-1.1..15.1).contains(&y))
    }

    #[test]
    fn tractions_come_back_from_the_displacements_that_they_make() {
        for gel in [
            Gel::half_space(3.0),
            Gel { poisson: 0.3, ..Gel::half_space(30.0) },
            Gel { thickness: Some(8.0), ..Gel::half_space(10.0) },
        ] {
            let (_, surface, total) = pulled(gel);
            let inside = inside(&surface);
            let open = one(&gel, &surface, None).force_nn(1.0, Some(&inside));
            let found = one(&gel, &surface, Some(&inside));
            let confined = found.force_nn(1.0, Some(&inside));
            // A window that goes on periodically, and rims that no wave resolves.
            assert!((open / total - 1.0).abs() < 0.05, "{gel:?}: {open} of {total} nN");
            assert!((confined / total - 1.0).abs() < 0.03, "{gel:?}: {confined} of {total} nN");
            assert_eq!(found.force_nn(1.0, None), confined);
        }
    }

    #[test]
    fn noise_is_told_and_the_force_comes_back_beside_it() {
        let gel = Gel::half_space(5.0);
        let (_, surface, total) = pulled(gel);
        let inside = inside(&surface);
        let most = surface.displacements[0].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for part in [0.01, 0.05] {
            for seed in 1..6 {
                let mut noisy = surface.clone();
                for (axis, moved) in noisy.displacements.iter_mut().enumerate() {
                    let added = noise(moved.len(), part * most, seed + 100 * axis as u64);
                    moved.iter_mut().zip(added).for_each(|(x, by)| *x += by);
                }
                let found = one(&gel, &noisy, Some(&inside));
                let told = found.noise_um / (part * most);
                assert!((0.85..1.15).contains(&told), "{part}: noise {told} of what it is");
                let force = found.force_nn(1.0, None);
                assert!((force / total - 1.0).abs() < 0.1, "{part}: {force} of {total} nN");
            }
        }
    }

    #[test]
    fn of_noise_alone_the_force_is_its_floor() {
        let gel = Gel::half_space(5.0);
        let (_, mut surface, _) = pulled(gel);
        for (axis, moved) in surface.displacements.iter_mut().enumerate() {
            *moved = noise(moved.len(), 0.05, 7 + axis as u64);
        }
        let found = one(&gel, &surface, None);
        let places = surface.shape[0] * surface.shape[1];
        let ratio = found.force_nn(1.0, None) / found.noise_floor_nn(1.0, places);
        assert!((0.8..1.2).contains(&ratio), "{ratio}");
    }

    #[test]
    fn noise_that_neighbours_share_is_told_and_the_axial_force_varies_as_stated() {
        let gel = Gel::half_space(5.0);
        let (_, clean, total) = pulled(gel);
        let [columns, rows] = clean.shape;
        // Means of 2 x 2 errors, as squares that overlap by half have them: their deviation is half of that of each.
        let shared = |seed: u64| {
            let own = noise((columns + 1) * (rows + 1), 0.04, seed);
            let at = |place: usize| {
                let first = place / columns * (columns + 1) + place % columns;
                [0, 1, columns + 1, columns + 2].map(|on| own[first + on]).iter().sum::<f64>() / 4.0
            };
            (0..columns * rows).map(at).collect::<Vec<f64>>()
        };
        let axis = PullAxis { direction: [1.0, 0.0], middle: [24.0, 7.0] };
        let (mut squares, mut stated, mut force, mut floor) = (0.0, 0.0, 0.0, 0.0);
        let seeds = 40;
        let errors = Errors { overlap: 2, ..Errors::default() };
        for seed in 0..seeds {
            let moved = Surface {
                displacements: [shared(2 * seed + 1), shared(2 * seed + 2)],
                ..clean.clone()
            };
            let mut noisy = clean.clone();
            for (axis, by) in noisy.displacements.iter_mut().zip(&moved.displacements) {
                axis.iter_mut().zip(by).for_each(|(x, by)| *x += by);
            }
            // The smoothing of the pulled gel, of noise alone.
            let found =
                tractions(&gel, std::slice::from_ref(&noisy), None, errors).unwrap().remove(0);
            assert!((0.85..1.15).contains(&(found.noise_um / 0.02)), "{}", found.noise_um);
            let waves = Waves::new(moved.shape);
            let alone = everywhere(&gel, &moved, &waves, found.smoothing)
                .map(|axis| axis.into_iter().map(|t| 1e3 * t).collect());
            squares += axis.force_nn(&moved, &alone).powi(2);
            stated += axial_noise_nn(&gel, &noisy, &found, &axis, None).powi(2);
            let alone = Tractions { tractions_pa: alone, ..found };
            force += alone.force_nn(1.0, None);
            floor += alone.noise_floor_nn(1.0, columns * rows);
        }
        // A standard deviation of 40 numbers is known to a ninth.
        let ratio = (squares / stated).sqrt();
        assert!((0.7..1.3).contains(&ratio), "axial force varies by {ratio} of what is stated");
        assert!((0.8..1.2).contains(&(force / floor)), "{force} {floor}");
        assert!((stated / seeds as f64).sqrt() < 0.1 * total);
    }

    #[test]
    fn a_wave_comes_back_to_the_digit() {
        let gel = Gel { thickness: Some(5.0), poisson: 0.4, ..Gel::half_space(7.0) };
        let shape = [60, 40];
        let number = TAU * 3.0 / 60.0;
        let [along, across, _] =
            wave::compliance(gel.poisson, 5.0 * number).map(|g| g / (gel.shear_modulus() * number));
        let wave = |size: f64| {
            (0..60 * 40)
                .map(|place| size * (number * f64::from(place % 60)).cos())
                .collect::<Vec<f64>>()
        };
        let surface = Surface {
            spacing: 1.0,
            origin: [0.0; 2],
            shape,
            displacements: [wave(2.0 * along), wave(0.5 * across)],
        };
        let found = one(&gel, &surface, None);
        for (axis, size) in [(0, 2000.0), (1, 500.0)] {
            for (found, wanted) in found.tractions_pa[axis].iter().zip(wave(size)) {
                // What the least smoothing that is tried takes away.
                assert!((found - wanted).abs() < 1e-6 * size, "{found} {wanted}");
            }
        }
    }
}
