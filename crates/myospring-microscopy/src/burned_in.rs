//! Marks that a program burned into a picture: scale bars, captions, letters, arrows.
//!
//! Three properties identify a mark. It has one grey value, often the largest or smallest of the
//! picture. Its edge is sharp along the whole rim: the grey value changes completely within two
//! pixels, whereas an image formed by a lens is blurred over more, also around an overexposed
//! place. It is a bar, a stroke of constant width, or next to one, with free space around it; the
//! stripes of a cell lie closer together. In a picture of one colour, everything in another colour
//! is a mark. Marks are replaced by a continuation of their surroundings, so that they count
//! neither as cells nor as fibres.

mod colour;

use super::filter;
use super::plane::Plane;
use super::region::{Connectivity, Island, Region, Window};
use myospring_core::interruption::{Interrupted, Interruption};

/// Largest spread of the grey values within one mark, as a part of the picture's range; lossy
/// compression spreads a single value this far.
const ONE_VALUE: f32 = 0.04;
/// Least part of a mark's pixels that has its median grey value exactly (bars), or within a
/// hundredth of the picture's range (letters; lossy compression adds that much). Noise leaves a
/// smaller part in anything that a camera has recorded, unless it is overexposed.
const NEARLY_ONE_VALUE: f64 = 0.5;
const NEARLY: f32 = 0.01;
/// Numbers of histogram classes in which the value of a mark is searched that is neither the
/// largest nor the smallest: fine for marks as drawn, coarse for marks that lossy compression has
/// spread.
const CLASSES: [usize; 2] = [128, 32];
/// Least frequency of such a value relative to the values around it, and its least number of
/// pixels.
const SPIKE: usize = 8;
const SPIKE_PIXELS: usize = 40;
/// Smallest mark, pixels; anything smaller is too small for a cell, too.
const LEAST_PIXELS: usize = 12;
/// Smallest mark that is recognised on its own, pixels; a smaller one must lie in line with
/// another. A few overexposed pixels may have any shape.
const LEAST_DRAWN: usize = 80;
/// The same for a bar, whose shape is easier to recognise.
const LEAST_BAR: usize = 40;
/// Least part of a mark's surroundings that does not have its value, for a mark on its own and for
/// one in line with another: gaps between overexposed stripes are narrower than those between
/// letters.
const FREE: f64 = 0.6;
const FREE_IN_LINE: f64 = 0.3;
/// Gaps within a mark up to twice this width count as not free, pixels.
const GAP: f64 = 1.5;
/// Largest part of the picture that one mark covers; anything larger is background or an object.
const MOST_SHARE: f64 = 0.05;
/// Largest part of the picture that may have a mark's grey value; a more frequent value is
/// background.
const MOST_OF_VALUE: f64 = 0.2;
/// Least change of grey value at the edge of a mark, as a part of the picture's range.
const LEAST_STEP: f32 = 0.15;
/// Part of that change which is complete two pixels beyond the edge: on average, and at nearly all
/// places.
const SHARP: f32 = 0.85;
const SHARP_EVERYWHERE: f32 = 0.4;
const NEARLY_ALL: f64 = 0.9;
/// Largest such part. Beyond a stripe lies a dark gap and then the next stripe, so the grey value
/// overshoots; beyond a mark it does not.
const OVERSHOOT: f32 = 1.15;
/// Width of the surroundings that are examined, pixels.
const AROUND: f64 = 6.0;
/// Least part of its bounding box that a bar fills, and its least ratio of length to width.
const FILLS_BOX: f64 = 0.95;
const BAR_ASPECT: f64 = 3.0;
/// Part of their area that strokes keep when all places narrower than six tenths of the widest are
/// removed.
const STROKE_KEPT: f64 = 0.7;
const STROKE_WIDTH: f64 = 0.6;
/// Strokes fill less than this of their box.
const STROKE_FILLS: f64 = 0.75;
/// Least ratio of length to width of a stroke.
const STROKE_ASPECT: f64 = 3.0;
/// Largest such ratio: overexposed stripes that are connected on coarse pixels are longer.
const STROKE_LONGEST: f64 = 60.0;
/// Width of the blurred rim that is painted over with a mark, pixels.
const RIM: f64 = 3.0;
/// Scales on which the surroundings are continued into a mark, pixels; the first one that fills it
/// is used.
const FILLING: [f64; 4] = [3.0, 8.0, 24.0, 72.0];

/// A picture without its burned-in marks.
#[derive(Debug, Clone, PartialEq)]
pub struct PaintedOver {
    /// The plane, with the marks painted over.
    pub plane: Plane,
    /// For each pixel, row by row from the top left: whether it was painted over.
    pub marks: Vec<bool>,
    /// Warning for the user.
    pub note: String,
}

/// The plane with its marks painted over; `None` if it has none.
///
/// # Example
/// ```
/// use myospring::microscopy::{burned_in, plane::Plane};
/// // Grains, and a scale bar of 40 x 5 pixels.
/// let bar = |at: usize| (20..60).contains(&(at % 90)) && (70..75).contains(&(at / 90));
/// let value = |at: usize| if bar(at) { 255.0 } else { (at * at % 37) as f32 };
/// let plane = Plane::new(90, 90, (0..8100).map(value).collect()).unwrap();
/// let found = burned_in::painted_over(&plane).unwrap();
/// assert!(found.marks[72 * 90 + 40] && found.plane.at(40, 72) < 37.0);
/// assert!(burned_in::painted_over(&found.plane).is_none());
/// ```
#[must_use]
pub fn painted_over(plane: &Plane) -> Option<PaintedOver> {
    found(plane, None, &Interruption::default()).ok().flatten()
}

/// The same of a picture whose red, green and blue are told, if it has any: what has another colour than nearly all of
/// it was drawn, too.
pub(crate) fn found(
    plane: &Plane,
    channels: Option<&[Plane; 3]>,
    interruption: &Interruption,
) -> Result<Option<PaintedOver>, Interrupted> {
    let Some(mut marks) = grey_marks(plane, interruption)? else { return Ok(None) };
    if let Some(drawn) = channels.and_then(colour::drawn) {
        marks.add(&drawn, &Window { columns: 0..plane.width(), rows: 0..plane.height() });
    }
    interruption.check()?;
    Ok(without(plane, &marks))
}

/// The marks of one grey value; `None` for a picture that cannot have any.
fn grey_marks(plane: &Plane, interruption: &Interruption) -> Result<Option<Region>, Interrupted> {
    let (width, height) = (plane.width(), plane.height());
    let [low, high] = plane.range();
    let range = high - low;
    if !(range > 0.0 && range.is_finite()) || width < 16 || height < 16 {
        return Ok(None);
    }
    let mut marks = Region::new(width, height, std::iter::empty());
    for value in values_of_marks(plane, [low, high]) {
        interruption.check()?;
        let drawing = Drawing { plane, value, range };
        for (own, window) in drawing.marks() {
            marks.add(&own, &window);
        }
    }
    Ok(Some(marks))
}

/// The plane with its marks painted over.
fn without(plane: &Plane, marks: &Region) -> Option<PaintedOver> {
    if marks.count() == 0 {
        return None;
    }
    let marks = marks.grown(RIM);
    let around = marks.window(0, 1);
    let plane = filled(plane, &marks)?;
    let share = 100.0 * marks.count() as f64 / marks.pixels() as f64;
    let (columns, rows) = (around.columns, around.rows);
    let note = format!(
        "marks are burned into the picture (a scale bar, letters or the like; columns {} to {}, rows {} to {}): they \
         were painted over, {share:.1} % of it, and are neither cells nor fibres",
        columns.start,
        columns.end - 1,
        rows.start,
        rows.end - 1
    );
    Some(PaintedOver { plane, marks: marks.inside().collect(), note })
}

/// Candidate grey values of marks: the largest, the smallest, and those far more frequent than
/// similar values.
fn values_of_marks(plane: &Plane, [low, high]: [f32; 2]) -> Vec<f32> {
    let mut values = vec![high, low];
    for classes in CLASSES {
        let scale = classes as f32 / (high - low);
        let mut histogram = vec![0_usize; classes];
        for value in plane.values().iter().filter(|value| value.is_finite()) {
            histogram[(((value - low) * scale) as usize).min(classes - 1)] += 1;
        }
        for class in 4..classes - 4 {
            let mut around: Vec<usize> = [4, 3, 2]
                .into_iter()
                .flat_map(|off| [class - off, class + off])
                .map(|at| histogram[at])
                .collect();
            around.sort_unstable();
            let usual = around[around.len() / 2];
            if histogram[class] >= SPIKE_PIXELS.max(SPIKE * usual) {
                values.push(low + (class as f32 + 0.5) / scale);
            }
        }
    }
    values
}

/// The pixels of one grey value, in which marks are searched.
struct Drawing<'a> {
    plane: &'a Plane,
    value: f32,
    range: f32,
}

/// A region of one grey value with a sharp edge.
struct Sharp {
    own: Region,
    window: Window,
    island: Island,
    drawn: bool,
}

impl Drawing<'_> {
    fn has_value(&self, at: usize) -> bool {
        (self.plane.values()[at] - self.value).abs() <= ONE_VALUE * self.range
    }

    /// The marks, each with its bounding window: bars and strokes with sharp edges, and sharp
    /// regions in line with them.
    fn marks(&self) -> Vec<(Region, Window)> {
        let (width, height) = (self.plane.width(), self.plane.height());
        let all = Region::new(width, height, (0..width * height).map(|at| self.has_value(at)));
        let size = (width * height) as f64;
        if all.count() as f64 > MOST_OF_VALUE * size {
            return Vec::new();
        }
        let most = MOST_SHARE * size;
        let islands = all.islands(Connectivity::Eight);
        let mut sharp: Vec<Sharp> = (1..)
            .zip(&islands.list)
            .filter(|(_, island)| island.pixels >= LEAST_PIXELS && (island.pixels as f64) < most)
            .filter(|(_, island)| island.sides(width, height) == 0 && self.stands_apart(island))
            .filter_map(|(number, island)| self.sharp(&islands.numbers, number, island))
            .collect();
        loop {
            let drawn: Vec<Island> =
                sharp.iter().filter(|sharp| sharp.drawn).map(|sharp| sharp.island).collect();
            let mut more = false;
            for other in sharp.iter_mut().filter(|sharp| !sharp.drawn) {
                other.drawn = drawn.iter().any(|island| in_line(island, &other.island));
                more |= other.drawn;
            }
            if !more {
                break;
            }
        }
        sharp.retain(|sharp| sharp.drawn);
        sharp.into_iter().map(|Sharp { own, window, .. }| (own, window)).collect()
    }

    /// Whether the grey value differs just outside the middle of most sides of the bounding box; a
    /// cheap test before the full one.
    fn stands_apart(&self, island: &Island) -> bool {
        const BESIDE: usize = 3;
        let (width, height) = (self.plane.width(), self.plane.height());
        let [left, right] = island.columns;
        let [top, bottom] = island.rows;
        let (column, row) = (usize::midpoint(left, right), usize::midpoint(top, bottom));
        let sides = [
            (left.checked_sub(BESIDE), Some(row)),
            (Some(right + BESIDE), Some(row)),
            (Some(column), top.checked_sub(BESIDE)),
            (Some(column), Some(bottom + BESIDE)),
        ];
        let apart = |(column, row): (Option<usize>, Option<usize>)| {
            let column = column.filter(|&column| column < width)?;
            let row = row.filter(|&row| row < height)?;
            Some((self.plane.at(column, row) - self.value).abs() > LEAST_STEP * self.range)
        };
        let seen: Vec<bool> = sides.into_iter().filter_map(apart).collect();
        seen.len() >= 2 && seen.iter().filter(|&&apart| !apart).count() <= 1
    }

    /// An island whose edge is sharp everywhere.
    fn sharp(&self, numbers: &[u32], number: u32, island: &Island) -> Option<Sharp> {
        let width = self.plane.width();
        let size = [width, self.plane.height()];
        let window = Window::around(island, AROUND as usize + 2, 1, size);
        let inside = window.cut(numbers, width).into_iter().map(|other| other == number);
        let own = Region::new(window.width(), window.height(), inside);
        let values = window.cut(self.plane.values(), width);
        // Other regions of this value, such as the next letter, are not surroundings.
        let others: Vec<bool> = values
            .iter()
            .map(|value| (value - self.value).abs() <= ONE_VALUE * self.range)
            .collect();
        let others = Region::new(own.width(), own.height(), others.into_iter()).grown(1.0);
        let [first, second, near, far] = [1.0, 2.0, 3.0, AROUND].map(|radius| own.grown(radius));
        let steps = |ring: &dyn Fn(usize) -> bool| -> Vec<f32> {
            let ring = (0..values.len()).filter(|&at| ring(at) && !others.contains(at));
            ring.map(|at| (values[at] - self.value).abs()).collect()
        };
        let close = |at: usize| second.contains(at) && !first.contains(at);
        // Gaps within the region are surroundings that are not free.
        let gaps = own.closed(GAP).count() - own.count();
        let all = (0..values.len()).filter(|&at| close(at)).count() + gaps;
        let beside = steps(&close);
        let free = beside.len() as f64 / all.max(1) as f64;
        if free < FREE_IN_LINE {
            return None;
        }
        let beyond = steps(&|at| far.contains(at) && !near.contains(at));
        if beside.len() < LEAST_PIXELS / 2 || beyond.len() < LEAST_PIXELS / 2 {
            return None;
        }
        let mean = |steps: &[f32]| steps.iter().sum::<f32>() / steps.len() as f32;
        let step = mean(&beyond);
        let enough = |beside: &&f32| **beside >= SHARP_EVERYWHERE * step;
        let everywhere =
            beside.iter().filter(enough).count() as f64 >= NEARLY_ALL * beside.len() as f64;
        let done = mean(&beside) / step;
        let sharp =
            step >= LEAST_STEP * self.range && (SHARP..=OVERSHOOT).contains(&done) && everywhere;
        let off = if is_bar(island) { 0.0 } else { NEARLY * self.range };
        let drawn =
            sharp && free >= FREE && is_drawn(&own, island) && is_of_one_value(&own, &values, off);
        sharp.then_some(Sharp { own, window, island: *island, drawn })
    }
}

/// Whether most of a mark has the same grey value.
fn is_of_one_value(own: &Region, values: &[f32], off: f32) -> bool {
    let inside: Vec<f32> =
        (0..values.len()).filter(|&at| own.contains(at)).map(|at| values[at]).collect();
    let middle = filter::quantile(&inside, 0.5);
    let alike = inside.iter().filter(|&&value| (value - middle).abs() <= off).count();
    alike as f64 >= NEARLY_ONE_VALUE * inside.len() as f64
}

/// Whether an island fills its bounding box evenly. Straight stripes in a camera's picture may fill
/// theirs, but noise makes them uneven.
fn is_bar(island: &Island) -> bool {
    let [across, down] = sides(island);
    island.pixels as f64 >= FILLS_BOX * across * down
}

/// Whether an island is a bar along rows or columns, or made of strokes of one width.
fn is_drawn(own: &Region, island: &Island) -> bool {
    let [across, down] = sides(island);
    let pixels = island.pixels as f64;
    if is_bar(island) {
        return island.pixels >= LEAST_BAR && across.max(down) >= BAR_ASPECT * across.min(down);
    }
    if island.pixels < LEAST_DRAWN {
        return false;
    }
    // Half of the widest place.
    let mut radius = 0.0;
    while radius < across.min(down) && own.shrunk(radius + 1.0).count() > 0 {
        radius += 1.0;
    }
    let wide = 2.0 * radius + 1.0;
    let kept = own.opened((STROKE_WIDTH * radius).floor()).count() as f64;
    let long = pixels / (wide * wide);
    pixels < STROKE_FILLS * across * down
        && (STROKE_ASPECT..=STROKE_LONGEST).contains(&long)
        && kept >= STROKE_KEPT * pixels
}

/// Whether an island is the next letter, the dot of a letter, or the scale bar above it: at most as
/// high as the mark, and no further away than its height.
fn in_line(mark: &Island, other: &Island) -> bool {
    let ([mark_across, mark_down], [across, down]) = (sides(mark), sides(other));
    let height = mark_down.max(mark_across.min(3.0 * mark_down));
    let gap = |a: [usize; 2], b: [usize; 2]| {
        a[0].saturating_sub(b[1]).max(b[0].saturating_sub(a[1])) as f64
    };
    let away = gap(mark.columns, other.columns).max(gap(mark.rows, other.rows));
    away <= 1.5 * height && down <= 2.0 * height && across <= 3.0 * height
}

fn sides(island: &Island) -> [f64; 2] {
    [island.columns, island.rows].map(|[first, last]| (last - first + 1) as f64)
}

/// The plane with the marks filled in from their surroundings.
fn filled(plane: &Plane, marks: &Region) -> Option<Plane> {
    let (width, height) = (plane.width(), plane.height());
    let mut values = plane.values().to_vec();
    let most = FILLING[FILLING.len() - 1];
    for window in marks.windows((2.0 * most) as usize) {
        let own = marks.cut(&window);
        let seen = window.cut(plane.values(), width);
        let part = |value: &dyn Fn(usize) -> f32| {
            Plane::new(window.width(), window.height(), (0..own.pixels()).map(value).collect())
        };
        let weights = part(&|at| f32::from(u8::from(!own.contains(at))))?;
        let known = part(&|at| if own.contains(at) { 0.0 } else { seen[at] })?;
        let scales: Vec<[Plane; 2]> = FILLING
            .iter()
            .map(|&sigma| [filter::slow_part(&known, sigma), filter::slow_part(&weights, sigma)])
            .collect();
        for at in (0..own.pixels()).filter(|&at| own.contains(at)) {
            let at_scale = |[sums, weights]: &[Plane; 2]| {
                let weight = weights.values()[at];
                (weight > 0.05).then(|| sums.values()[at] / weight)
            };
            let [column, row] = window.place(at % window.width(), at / window.width());
            if let Some(value) = scales.iter().find_map(at_scale) {
                values[row * width + column] = value;
            }
        }
    }
    Plane::new(width, height, values)
}
