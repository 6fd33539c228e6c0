//! Checks that the rings of an outline are simple: no crossing edges, holes inside and separate.

use geo::algorithm::Validation;
use geo::coordinate_position::{CoordPos, CoordinatePosition};
use geo::line_intersection::{LineIntersection, line_intersection};

use super::error::OutlineError;

/// Pairs of neighbouring points, including the last with the first.
pub(super) fn edges(ring: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

/// One edge with its ring and its index in it.
struct Edge {
    line: geo::Line,
    ring: usize,
    place: usize,
}

impl Edge {
    fn low(&self, axis: usize) -> f64 {
        let ends = [self.line.start, self.line.end].map(|end| [end.x, end.y][axis]);
        ends[0].min(ends[1])
    }

    fn high(&self, axis: usize) -> f64 {
        let ends = [self.line.start, self.line.end].map(|end| [end.x, end.y][axis]);
        ends[0].max(ends[1])
    }
}

/// Checks tidy rings, the exterior first; see [`super::Outline::new`] for what is rejected.
///
/// Edges are sorted by their left end, and only edges that overlap in x and y are compared, so an
/// outline of a hundred thousand short edges takes a fraction of a second.
pub(super) fn check(rings: &[&[[f64; 2]]]) -> Result<(), OutlineError> {
    let sizes: Vec<usize> = rings.iter().map(|points| points.len()).collect();
    let mut sorted: Vec<Edge> = rings
        .iter()
        .enumerate()
        .flat_map(|(ring, points)| {
            edges(points).enumerate().map(move |(place, (p, q))| Edge {
                line: geo::Line::new(p, q),
                ring,
                place,
            })
        })
        .collect();
    sorted.sort_by(|a, b| a.low(0).total_cmp(&b.low(0)));

    let mut rings_touch = false;
    for (index, first) in sorted.iter().enumerate() {
        let [right, bottom, top] = [first.high(0), first.low(1), first.high(1)];
        for second in sorted[index + 1..].iter().take_while(|second| second.low(0) <= right) {
            if second.low(1) > top || second.high(1) < bottom {
                continue;
            }
            if first.ring == second.ring && neighbours(first.place, second.place, sizes[first.ring])
            {
                continue;
            }
            match line_intersection(first.line, second.line) {
                None => {}
                Some(meeting) if first.ring == second.ring => {
                    return Err(OutlineError::SelfIntersecting { place: place(&meeting) });
                }
                Some(LineIntersection::SinglePoint { is_proper: false, .. }) => rings_touch = true,
                Some(meeting) => {
                    let reason = format!("two of its rings cross{}", place(&meeting));
                    return Err(OutlineError::Holes { reason });
                }
            }
        }
    }
    if rings_touch { check_touching(rings) } else { check_apart(rings) }
}

fn neighbours(a: usize, b: usize, count: usize) -> bool {
    let apart = a.abs_diff(b);
    apart == 1 || apart == count - 1
}

/// ` at (x, y) um`, to a nanometre.
fn place(meeting: &LineIntersection<f64>) -> String {
    let at = match meeting {
        LineIntersection::SinglePoint { intersection, .. } => *intersection,
        LineIntersection::Collinear { intersection } => intersection.start,
    };
    let round = |value: f64| (value * 1e3).round() / 1e3 + 0.0;
    format!(" at ({}, {}) um", round(at.x), round(at.y))
}

/// Checks rings that share no point, where one point of each hole is enough: it must lie within the
/// exterior and not within another hole.
fn check_apart(rings: &[&[[f64; 2]]]) -> Result<(), OutlineError> {
    let ring = |points: &[[f64; 2]]| {
        let polygon = geo::Polygon::new(points.iter().copied().collect(), Vec::new());
        (polygon, bounds(points))
    };
    let within = |point: [f64; 2], (polygon, [low, high]): &(geo::Polygon, [[f64; 2]; 2])| {
        (0..2).all(|axis| (low[axis]..=high[axis]).contains(&point[axis]))
            && polygon.coordinate_position(&point.into()) == CoordPos::Inside
    };
    let (exterior, inner) = (ring(rings[0]), &rings[1..]);
    let holes: Vec<_> = inner.iter().map(|hole| ring(hole)).collect();
    for (index, hole) in inner.iter().enumerate() {
        if !within(hole[0], &exterior) {
            return Err(OutlineError::Holes {
                reason: format!("hole {index} is not within the exterior"),
            });
        }
        let around =
            holes.iter().enumerate().find(|(other, ring)| *other != index && within(hole[0], ring));
        if let Some((other, _)) = around {
            return Err(OutlineError::Holes {
                reason: format!("hole {index} lies within hole {other}"),
            });
        }
    }
    Ok(())
}

fn bounds(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.iter().fold(start, |[low, high], point| {
        [[0, 1].map(|k| low[k].min(point[k])), [0, 1].map(|k| high[k].max(point[k]))]
    })
}

/// Checks rings that touch in single points, which is allowed for polygons if they do not cross
/// there. This general check takes a time quadratic in the number of edges.
fn check_touching(rings: &[&[[f64; 2]]]) -> Result<(), OutlineError> {
    use geo::algorithm::validation::InvalidPolygon as Invalid;
    const LONGEST: usize = 20_000;
    if rings.iter().map(|points| points.len()).sum::<usize>() > LONGEST {
        let reason = "two of its rings touch".to_owned();
        return Err(OutlineError::Holes { reason });
    }
    let ring = |points: &[[f64; 2]]| points.iter().copied().collect::<geo::LineString>();
    let polygon =
        geo::Polygon::new(ring(rings[0]), rings[1..].iter().map(|hole| ring(hole)).collect());
    match polygon.check_validation() {
        Ok(()) => Ok(()),
        Err(Invalid::SelfIntersection(_)) => {
            Err(OutlineError::SelfIntersecting { place: String::new() })
        }
        Err(error) => Err(OutlineError::Holes { reason: error.to_string() }),
    }
}
