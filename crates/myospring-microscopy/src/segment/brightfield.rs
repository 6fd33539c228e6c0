//! Segmentation of a cell that is visible by its edges.

use myospring_core::interruption::{Interrupted, Interruption};
use myospring_core::mesh::pixel_size::PixelSize;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::confidence::Candidate;
use super::found::{Found, Working};
use super::grain::{Grain, noise_of};
use super::ladder::Climbed;
use super::parting::Seen;
use super::{Confidence, Modality, SegmentError, Segmentation, SegmentationSettings};
use crate::filter::{self, otsu, quantile, sample};
use crate::plane::Plane;
use crate::region::{Connectivity, Region, Window};

/// Default scale of smoothing, um: beads and grains of a micrometre lose most of their edges, the
/// long straight rim of a cell loses nothing.
const SMOOTH_UM: f64 = 0.8;
/// Side up to which pixels are averaged, um.
const WORKING_PIXEL_UM: f64 = 0.3;
/// Scale of uneven illumination, um.
const LIGHT_UM: f64 = 15.0;
/// Least extent of a connected edge, um; edges of beads and specks are shorter.
const LEAST_EDGE_UM: f64 = 6.0;
/// Least extent of a connected edge, pixels: noise creates crests over a few pixels.
const LEAST_EDGE_PIXELS: f64 = 10.0;
/// Edges are searched within this distance of textured areas, um, if there are any.
const TEXTURED_UM: f64 = 20.0;
/// Low and high gradient thresholds (hysteresis, Canny 1986), in standard deviations of the
/// picture's noise. The high threshold must be reached along a length, not at one place, because
/// grains are strong but short. Several pairs are used and a cell is the area on which some agree,
/// so that it does not depend on one choice.
const LEVELS: [[f32; 2]; 5] = [[1.5, 4.0], [2.0, 4.0], [2.0, 5.0], [2.5, 4.0], [2.5, 5.0]];
/// How many pairs must agree: fewer than half, because a faint tip is visible only with some.
const AGREEING: usize = 2;
/// Coarsest pixel of the grid on which gaps are closed, um; the outline is then determined on the
/// finer one.
const CLOSING_PIXEL_UM: f64 = 1.1;
/// Radii by which gaps in the outline are closed, um; the smallest that encloses enough is used.
const CLOSING_UM: [f64; 5] = [1.0, 1.6, 2.5, 4.0, 6.0];
/// Part of the largest enclosed area (over all radii) that is enough: only bays of the outline may
/// be missing, not a piece of the cell.
const ENOUGH: f64 = 0.94;
/// Tips and necks narrower than twice this are removed, um.
const OPENING_UM: f64 = 1.0;
/// Largest distance of the outline inside and outside of the first guess, um. It is moved to the
/// highest crest in this band, because a bright halo has two sides and the first guess lies on the
/// outer one.
const BAND_UM: [f64; 2] = [2.6, 1.2];
/// Bays and cracks of the outline narrower than twice this are closed, um; debris on the rim causes
/// them.
const BAY_UM: f64 = 3.0;
/// Smoothing of the final outline, um.
const OUTLINE_UM: f64 = 0.6;

/// Strength of grains inside, relative to the change of brightness over 1 um at the outline: of a
/// smooth object, and of a cell.
const GRAIN: [f64; 2] = [0.03, 0.09];

pub(super) fn segment(
    plane: &Plane,
    pixel_size: PixelSize,
    settings: &SegmentationSettings,
    texture: &Climbed,
) -> Result<Segmentation, SegmentError> {
    let interruption = &settings.interruption;
    let Working { plane: working, factor, pixel_um: pixel, .. } =
        Working::of(plane, pixel_size, WORKING_PIXEL_UM, interruption)?;
    let smooth_um = settings.smooth_um.unwrap_or(SMOOTH_UM);
    let relative = relative(&working, pixel);
    interruption.check()?;
    let gradient = Gradient::of(&relative, smooth_um / pixel);
    let noise = gradient.noise();
    let unit =
        settings.threshold.map_or(noise, |threshold| (threshold * pixel) as f32 / LEVELS[2][0]);
    let threshold = f64::from(LEVELS[2][0] * unit) / pixel;
    // The edges of the first pair include those of all others. Work is limited to their
    // surroundings, because distances and islands over the whole field of view would dominate the
    // cost.
    let least_edge = (LEAST_EDGE_UM / pixel).max(LEAST_EDGE_PIXELS);
    let [weak, strong] = LEVELS[0].map(|level| level * unit);
    let mut crests = gradient.crests(weak);
    // In a large field of view, noise also has long edges, but it has no texture.
    if let Some(near) = texture.around(TEXTURED_UM, pixel, [working.width(), working.height()]) {
        crests = crests.and(&near);
    }
    interruption.check()?;
    let edges = gradient.edges(&crests, weak, strong, least_edge);
    let coarse = closing_factor(pixel);
    let margin = 2.0 * CLOSING_UM[CLOSING_UM.len() - 1] / pixel;
    let seen = edges.window(margin.ceil() as usize, coarse);
    let (edges, around) = (edges.cut(&seen), gradient.cut(&seen));
    let stricter = LEVELS[1..].iter().map(|level| {
        let [weak, strong] = level.map(|level| level * unit);
        around.edges(&edges, weak, strong, least_edge)
    });
    let tries: Vec<Guess> = std::iter::once(edges.clone())
        .chain(stricter)
        .map(|edges| Guess::within(edges, pixel, settings.smallest_cell_um2, interruption))
        .collect::<Result<_, _>>()?;
    let agreed = agreed(&tries);
    let smallest = settings.smallest_cell_um2 / (pixel * coarse as f64).powi(2);
    let agreed = agreed.kept(Connectivity::Four, |island| island.pixels as f64 >= smallest);
    if agreed.count() == 0 {
        return Err(SegmentError::NoCell {
            modality: "brightfield",
            threshold: format!("{threshold:.4} relative change of brightness per um"),
            why: format!(
                "no edges that are connected over {LEAST_EDGE_UM} um enclose {} um^2",
                settings.smallest_cell_um2
            ),
            pixel_size,
        });
    }
    let guess = agreed.spread(coarse, seen.width(), seen.height());
    let band = BAND_UM.map(|um| um / pixel);
    // Only around edges that enclose something; separate cells are processed separately.
    let Guess { edges, closing_um, .. } = &tries[2];
    let nothing = Region::new(seen.width(), seen.height(), std::iter::empty());
    let (mut region, mut near_edges) = (nothing.clone(), nothing);
    for window in guess.windows((2.0 * BAY_UM / pixel).ceil() as usize) {
        interruption.check()?;
        let (near, close) = (guess.cut(&window), around.cut(&window));
        let refined = flooded(&close.towards_the_light(&near, band), &near, band)
            .opened(OPENING_UM / pixel)
            .closed(BAY_UM / pixel)
            .filled(usize::MAX)
            .smoothed(OUTLINE_UM / pixel);
        region.put(&refined, &window);
        near_edges.put(&edges.cut(&window).grown(1.0 / pixel), &window);
    }
    let [region, near_edges] =
        [region, near_edges].map(|part| part.pasted(&seen, working.width(), working.height()));
    let smallest_um2 = settings.smallest_cell_um2;
    // The cell is as bright as its surroundings, so brightness is relative to them.
    let seen = Seen { brightness: &relative, dark: -1.0, pixel_um: pixel, smallest_um2 };
    let found = Found { region, seen, factor, modality: Modality::Brightfield, threshold };
    let judge = Judge {
        gradient: &gradient,
        noise,
        near_edges,
        brightness: &relative,
        grain_of_ground: noise_of(&relative),
        pixel_um: pixel,
        factor,
        closing_um: *closing_um,
    };
    Ok(found.finish(plane, pixel_size, settings, |cell| judge.confidence(cell, plane.width()))?)
}

/// The area on which enough guesses agree.
fn agreed(tries: &[Guess]) -> Region {
    let first = &tries[0].region;
    let votes = |at: usize| tries.iter().filter(|guess| guess.region.contains(at)).count();
    let most = (0..first.pixels()).map(|at| votes(at) >= AGREEING);
    Region::new(first.width(), first.height(), most)
}

/// What decides how sure a cell is.
struct Judge<'a> {
    gradient: &'a Gradient,
    /// Standard deviation of the gradient's noise.
    noise: f32,
    /// The surroundings of the edges that were seen.
    near_edges: Region,
    /// Brightness relative to that of the surroundings, and the strength of its grains there.
    brightness: &'a Plane,
    grain_of_ground: f32,
    /// A pixel of these, um and in pixels of the picture.
    pixel_um: f64,
    factor: usize,
    /// Radius by which gaps in outlines were closed, um.
    closing_um: f64,
}

impl Judge<'_> {
    /// How sure a cell is in a picture of this width, pixels.
    fn confidence(&self, candidate: &Candidate<'_>, width: usize) -> Confidence {
        let (width_here, height_here) = (self.near_edges.width(), self.near_edges.height());
        let place = |&pixel: &u32| {
            let at = pixel as usize;
            at / width / self.factor * width_here + at % width / self.factor
        };
        let mut confidence = Confidence::full();
        let rim: Vec<usize> = candidate.rim.iter().map(place).collect();
        let strengths: Vec<f32> = rim.iter().map(|&at| self.gradient.near(at)).collect();
        let contrast = f64::from(quantile(&strengths, 0.5) / self.noise.max(f32::MIN_POSITIVE));
        confidence.contrast = Some(contrast);
        confidence.weigh(contrast, 1.0, 4.0, || {
            format!("along its outline the brightness changes only {contrast:.1} times as fast as noise alone")
        });
        let seen = rim.iter().filter(|&&at| self.near_edges.contains(at)).count();
        let seen = seen as f64 / rim.len().max(1) as f64;
        confidence.weigh(seen, 0.3, 0.85, || {
            format!(
                "along {:.0} % of its outline no edge is visible; gaps were bridged",
                100.0 * (1.0 - seen)
            )
        });
        if let Some(own) = candidate.region(self.factor, [width_here, height_here])
            && let Some(grain) =
                Grain::within(self.brightness, &own, self.pixel_um, self.grain_of_ground)
        {
            // The grain that noise may hide counts in the cell's favour.
            let step = contrast * f64::from(self.noise) / self.pixel_um;
            let part = grain.most / step.max(f64::MIN_POSITIVE);
            confidence.weigh(part, GRAIN[0], GRAIN[1], || {
                format!(
                    "it is smooth inside: its grains are {part:.2} times as strong as the change over 1 um at its outline, those \
                     of cells 0.2 times and more; is it a mark, a bubble, a post, or a halo?"
                )
            });
        }
        let bridged = self.closing_um >= CLOSING_UM[CLOSING_UM.len() - 1];
        confidence.weigh(if bridged { 0.7 } else { 1.0 }, 0.0, 1.0, || {
            format!(
                "its outline closes only if gaps of {:.0} um are bridged",
                2.0 * self.closing_um
            )
        });
        confidence.weigh_shape(candidate, width);
        confidence
    }
}

/// Pixels along the side of a block of the grid on which gaps are closed.
fn closing_factor(pixel_um: f64) -> usize {
    ((CLOSING_PIXEL_UM / pixel_um) as usize).max(1)
}

/// Brightness relative to that of the surroundings.
fn relative(plane: &Plane, pixel_um: f64) -> Plane {
    let light = filter::slow_part(plane, LIGHT_UM / pixel_um);
    // The camera's offset is unknown, so dark corners must not be amplified.
    let middle = quantile(&sample(light.values(), 100_000), 0.5).abs();
    let least = (0.1 * middle).max(f32::MIN_POSITIVE);
    let values = plane.values().iter().zip(light.values());
    let values = values.map(|(value, light)| (value - light) / light.max(least)).collect();
    Plane::new(plane.width(), plane.height(), values).unwrap_or_else(|| plane.clone())
}

/// Gradient of a smoothed plane, per pixel.
struct Gradient {
    along: Vec<f32>,
    down: Vec<f32>,
    strength: Plane,
}

impl Gradient {
    fn of(plane: &Plane, sigma: f64) -> Self {
        let smooth = filter::gaussian(plane, sigma);
        let (width, height) = (plane.width(), plane.height());
        let [along, down] = filter::slopes(&smooth);
        let strength = along.iter().zip(&down).map(|(x, y): (&f32, &f32)| x.hypot(*y)).collect();
        let strength = Plane::new(width, height, strength).unwrap_or(smooth);
        Self { along, down, strength }
    }

    /// The part within a window.
    fn cut(&self, window: &Window) -> Self {
        let width = self.strength.width();
        let (along, down) = (window.cut(&self.along, width), window.cut(&self.down, width));
        let strength = window.cut(self.strength.values(), width);
        let strength = Plane::new(window.width(), window.height(), strength);
        Self { along, down, strength: strength.unwrap_or_else(|| self.strength.clone()) }
    }

    /// Standard deviation of one component away from edges. The strength of isotropic noise follows
    /// a Rayleigh distribution, whose median is 1.177 standard deviations.
    fn noise(&self) -> f32 {
        let strengths = sample(self.strength.values(), 400_000);
        // If edges fill much of the picture, the median is that of edges; Otsu's threshold excludes
        // them.
        let quiet: Vec<f32> = match otsu(&strengths) {
            Some([level, _]) => strengths.iter().copied().filter(|&value| value <= level).collect(),
            None => strengths,
        };
        quantile(&quiet, 0.5) / 1.177
    }

    /// The component of the gradient across the rim of a region, with the sign that changes from
    /// the dark line to the bright halo: the outline lies between them. The sign is determined from
    /// the band.
    fn towards_the_light(&self, region: &Region, [within, without]: [f64; 2]) -> Plane {
        let (width, height) = (region.width(), region.height());
        let values = region.inside().map(|is| if is { 1.0 } else { 0.0 }).collect();
        let Some(step) = Plane::new(width, height, values) else { return self.strength.clone() };
        let inward = Self::of(&step, within.max(without).max(1.0));
        let across: Vec<f32> = (0..width * height)
            .map(|at| {
                let slope = inward.strength.values()[at];
                if slope < 1e-6 {
                    return 0.0;
                }
                -(self.along[at] * inward.along[at] + self.down[at] * inward.down[at]) / slope
            })
            .collect();
        let squares = |sign: f32| -> f32 {
            across.iter().map(|&value| (sign * value).max(0.0).powi(2)).sum()
        };
        let sign = if squares(1.0) >= squares(-1.0) { 1.0 } else { -1.0 };
        let across = across.into_iter().map(|value| (sign * value).max(0.0)).collect();
        Plane::new(width, height, across).unwrap_or(step)
    }

    /// The strongest gradient at a place and its neighbours; an outline lies within a pixel of its
    /// crest.
    fn near(&self, at: usize) -> f32 {
        let (width, height) = (self.strength.width(), self.strength.height());
        let (column, row) = (at % width, at / width);
        let mut strongest = 0.0_f32;
        for y in row.saturating_sub(2)..(row + 3).min(height) {
            for x in column.saturating_sub(2)..(column + 3).min(width) {
                strongest = strongest.max(self.strength.at(x, y));
            }
        }
        strongest
    }

    /// Crests of the gradient above `weak`.
    fn crests(&self, weak: f32) -> Region {
        let (width, height) = (self.strength.width(), self.strength.height());
        let strength = self.strength.values();
        let crest = |at: usize| {
            let value = strength[at];
            let (column, row) = (at % width, at / width);
            let inner = column > 0 && row > 0 && column + 1 < width && row + 1 < height;
            inner && value > weak && {
                let (u, v) = (self.along[at] / value, self.down[at] / value);
                value >= self.between(column, row, u, v)
                    && value >= self.between(column, row, -u, -v)
            }
        };
        Region::new(width, height, (0..strength.len()).map(crest))
    }

    /// The crests that are connected above `weak` over `extent` pixels and are above `strong` in as
    /// many.
    fn edges(&self, crests: &Region, weak: f32, strong: f32, extent: f64) -> Region {
        let (width, height) = (self.strength.width(), self.strength.height());
        let strength = self.strength.values();
        let above = crests.inside().zip(strength).map(|(crest, &value)| crest && value > weak);
        let islands = Region::new(width, height, above).islands(Connectivity::Eight);
        let mut strong_pixels = vec![0_usize; islands.list.len() + 1];
        for (&number, &value) in islands.numbers.iter().zip(strength) {
            strong_pixels[number as usize] += usize::from(value >= strong);
        }
        let kept = |&number: &u32| {
            number > 0
                && islands.list[number as usize - 1].extent() >= extent
                && strong_pixels[number as usize] as f64 >= extent
        };
        Region::new(width, height, islands.numbers.iter().map(kept))
    }

    /// Gradient strength one pixel away in the direction (`u`, `v`), interpolated linearly.
    fn between(&self, column: usize, row: usize, u: f32, v: f32) -> f32 {
        let (x, y) = (column as f32 + u, row as f32 + v);
        let (i, j) = (x.floor(), y.floor());
        let (right, below) = (x - i, y - j);
        let at = |i: f32, j: f32| {
            let column = (i.max(0.0) as usize).min(self.strength.width() - 1);
            let row = (j.max(0.0) as usize).min(self.strength.height() - 1);
            self.strength.at(column, row)
        };
        let upper = at(i, j) * (1.0 - right) + at(i + 1.0, j) * right;
        let lower = at(i, j + 1.0) * (1.0 - right) + at(i + 1.0, j + 1.0) * right;
        upper * (1.0 - below) + lower * below
    }
}

/// The cells that edges enclose, on the grid on which gaps are closed.
struct Guess {
    edges: Region,
    region: Region,
    /// Radius by which gaps were closed, um.
    closing_um: f64,
}

impl Guess {
    /// The area enclosed by edges after closing gaps by the smallest sufficient radius: larger ones
    /// add little more than bays.
    fn within(
        edges: Region,
        pixel_um: f64,
        smallest_um2: f64,
        interruption: &Interruption,
    ) -> Result<Self, Interrupted> {
        let factor = closing_factor(pixel_um);
        let pixel_um = pixel_um * factor as f64;
        let coarse = edges.coarse(factor);
        let smallest = smallest_um2 / pixel_um.powi(2);
        let at_radius = |&radius_um: &f64| {
            interruption.check()?;
            let region = coarse
                .closed(radius_um / pixel_um)
                .filled(usize::MAX)
                .opened(OPENING_UM / pixel_um)
                .kept(Connectivity::Four, |island| island.pixels as f64 >= smallest);
            Ok((region, radius_um))
        };
        let tries: Vec<(Region, f64)> =
            CLOSING_UM.iter().map(at_radius).collect::<Result<_, _>>()?;
        let most = tries.iter().map(|(region, _)| region.count()).max().unwrap_or(0) as f64;
        let enough = |region: &Region| region.count() as f64 >= ENOUGH * most;
        let first = tries.into_iter().find(|(region, _)| enough(region));
        let (region, closing_um) = first.unwrap_or((coarse, CLOSING_UM[CLOSING_UM.len() - 1]));
        Ok(Self { edges, region, closing_um })
    }
}

/// The region whose rim lies on the highest crest within a band around the rim of a first guess.
/// Both sides of the band are flooded in the order of the gradient; the rim is where the floods
/// meet (watershed, Meyer 1994). `within` and `without` are the widths of the band inside and
/// outside, pixels.
fn flooded(strength: &Plane, guess: &Region, [within, without]: [f64; 2]) -> Region {
    const INSIDE: u8 = 1;
    const OUTSIDE: u8 = 2;
    let (width, height) = (guess.width(), guess.height());
    let (core, reach) = (guess.shrunk(within), guess.grown(without));
    let thick = core.grown(within);
    // Necks and tips thinner than the band get a core of their own.
    let thin_core = guess.shrunk(within / 3.0);
    let mut owner: Vec<u8> = (0..guess.pixels())
        .map(|at| {
            let thin = thin_core.contains(at) && !thick.contains(at);
            if core.contains(at) || thin { INSIDE } else { u8::from(!reach.contains(at)) * OUTSIDE }
        })
        .collect();
    let mut queue = BinaryHeap::new();
    let mut order = 0_u64;
    let mut push = |queue: &mut BinaryHeap<_>, at: usize, level: f32, owner: u8| {
        order += 1;
        // Strengths are not negative, so their bits sort like their values.
        queue.push(Reverse((strength.values()[at].max(level).to_bits(), order, at, owner)));
    };
    let neighbours = |at: usize| {
        let (column, row) = (at % width, at / width);
        [
            (column > 0).then(|| at - 1),
            (column + 1 < width).then(|| at + 1),
            (row > 0).then(|| at - width),
            (row + 1 < height).then(|| at + width),
        ]
    };
    for at in 0..owner.len() {
        if owner[at] != 0 {
            for next in neighbours(at).into_iter().flatten().filter(|&next| owner[next] == 0) {
                push(&mut queue, next, 0.0, owner[at]);
            }
        }
    }
    while let Some(Reverse((level, _, at, from))) = queue.pop() {
        if owner[at] != 0 {
            continue;
        }
        owner[at] = from;
        for next in neighbours(at).into_iter().flatten().filter(|&next| owner[next] == 0) {
            push(&mut queue, next, f32::from_bits(level), from);
        }
    }
    Region::new(width, height, owner.into_iter().map(|owner| owner == INSIDE))
}
