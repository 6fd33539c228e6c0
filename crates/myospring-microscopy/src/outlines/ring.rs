//! Rings in pixels: combined into polygons, and separated where they touch.

use std::collections::HashMap;

use geo::coordinate_position::{CoordPos, CoordinatePosition};

/// Length by which a corner is cut where a ring passes a point twice, pixels: far below the
/// resolution of a picture, and exact in binary. Each such point changes the area by half the
/// square of this length.
pub(super) const CUT: f64 = 1.0 / 1024.0;

/// Separates rings that touch in a common vertex by cutting both corners there by `cut`, in the
/// unit of the points.
///
/// Traced outlines pass a corner twice where two pixels meet only there, but an outline must not.
/// Spikes without width, along which a ring runs forth and back, are removed. Nothing else changes.
pub(super) fn part_touching(rings: &mut [Vec<[f64; 2]>], cut: f64) {
    let key = |point: [f64; 2]| point.map(|value| (value + 0.0).to_bits());
    let mut passes: HashMap<[u64; 2], u32> = HashMap::new();
    for ring in rings.iter_mut() {
        ring.dedup();
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        take_threads_off(ring);
        for &point in ring.iter() {
            *passes.entry(key(point)).or_default() += 1;
        }
    }
    if passes.values().all(|&count| count == 1) {
        return;
    }
    for ring in rings {
        let count = ring.len();
        let mut parted = Vec::with_capacity(count);
        for (index, &point) in ring.iter().enumerate() {
            if passes.get(&key(point)).is_none_or(|&count| count == 1) || count < 3 {
                parted.push(point);
                continue;
            }
            let [before, after] = [ring[(index + count - 1) % count], ring[(index + 1) % count]];
            parted.push(toward(point, before, cut));
            parted.push(toward(point, after, cut));
        }
        *ring = parted;
    }
}

/// Removes spikes without width: `a b a` becomes `a`.
fn take_threads_off(ring: &mut Vec<[f64; 2]>) {
    let mut kept: Vec<[f64; 2]> = Vec::with_capacity(ring.len());
    for &point in ring.iter() {
        if kept.len() > 1 && kept[kept.len() - 2] == point {
            kept.pop();
        } else if kept.last() != Some(&point) {
            kept.push(point);
        }
    }
    // A spike at the beginning or end of the list.
    let (mut first, mut last) = (0, kept.len());
    while last - first > 2 {
        if kept[last - 2] == kept[first] {
            last -= 2;
        } else if kept[last - 1] == kept[first + 1] {
            (first, last) = (first + 1, last - 1);
        } else {
            break;
        }
    }
    *ring = kept[first..last].to_vec();
}

/// The point at distance `cut` from `from` towards `to`, at most a quarter of the way.
fn toward(from: [f64; 2], to: [f64; 2], cut: f64) -> [f64; 2] {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let share = (cut / dx.hypot(dy)).min(0.25);
    [from[0] + share * dx, from[1] + share * dy]
}

/// Combines nested rings into polygons by the even-odd rule: a ring within an even number of others
/// is an exterior, one within an odd number a hole of the smallest ring around it. Rings of fewer
/// than three points and without area are dropped.
pub(super) fn nest(rings: Vec<Vec<[f64; 2]>>) -> Vec<Vec<Vec<[f64; 2]>>> {
    struct Ring {
        points: Vec<[f64; 2]>,
        polygon: geo::Polygon,
        bounds: geo::Rect,
        area: f64,
    }
    let mut sorted: Vec<Ring> = rings
        .into_iter()
        .filter_map(|points| {
            use geo::{Area, BoundingRect};
            let polygon = geo::Polygon::new(points.iter().copied().collect(), Vec::new());
            let (area, bounds) = (polygon.unsigned_area(), polygon.bounding_rect()?);
            (points.len() > 2 && area > 0.0).then_some(Ring { points, polygon, bounds, area })
        })
        .collect();
    // Large ones first, so that a ring comes after all rings around it.
    sorted.sort_by(|a, b| b.area.total_cmp(&a.area));
    let around = |inner: &Ring, outer: &Ring| {
        let within = |point: &[f64; 2]| {
            let [low, high] = [outer.bounds.min(), outer.bounds.max()];
            if !(low.x..=high.x).contains(&point[0]) || !(low.y..=high.y).contains(&point[1]) {
                return CoordPos::Outside;
            }
            outer.polygon.coordinate_position(&(*point).into())
        };
        let decisive = inner.points.iter().map(within).find(|&at| at != CoordPos::OnBoundary);
        decisive.is_none_or(|at| at == CoordPos::Inside)
    };
    // Depth of each ring, and the index of the polygon that it is the exterior of.
    let mut depths = vec![0; sorted.len()];
    let mut polygon_of = vec![usize::MAX; sorted.len()];
    let mut polygons: Vec<Vec<Vec<[f64; 2]>>> = Vec::new();
    for index in 0..sorted.len() {
        let parents = (0..index).rev().filter(|&other| around(&sorted[index], &sorted[other]));
        let parent = parents.max_by_key(|&other| depths[other]);
        depths[index] = parent.map_or(0, |parent| depths[parent] + 1);
        let points = sorted[index].points.clone();
        match parent {
            Some(parent) if depths[index] % 2 == 1 => polygons[polygon_of[parent]].push(points),
            _ => {
                polygon_of[index] = polygons.len();
                polygons.push(vec![points]);
            }
        }
    }
    polygons
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::outline::Outline;

    fn square(low: f64, high: f64) -> Vec<[f64; 2]> {
        vec![[low, low], [high, low], [high, high], [low, high]]
    }

    #[test]
    fn threads_without_width_are_taken_off_wherever_the_ring_begins() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        // A thread of two steps with a fork at its end, out of a corner and back.
        let thread = [[5.0, 5.0], [6.0, 5.0], [5.0, 5.0], [5.0, 6.0], [5.0, 5.0], [4.0, 4.0]];
        let ring = [&square[..3], &thread, &square[3..]].concat();
        for start in 0..ring.len() {
            let mut turned = vec![[&ring[start..], &ring[..start]].concat()];
            part_touching(&mut turned, CUT);
            let place = turned[0].iter().position(|point| *point == square[0]).unwrap();
            turned[0].rotate_left(place);
            assert_eq!(turned[0], square, "from {start} on");
        }
    }

    #[test]
    fn an_island_in_a_hole_is_a_polygon_of_its_own() {
        let rings = vec![square(4.0, 6.0), square(0.0, 10.0), square(2.0, 8.0), square(20.0, 21.0)];
        let polygons = nest(rings);
        assert_eq!(
            polygons,
            [
                vec![square(0.0, 10.0), square(2.0, 8.0)],
                vec![square(4.0, 6.0)],
                vec![square(20.0, 21.0)]
            ]
        );
    }

    #[test]
    fn squares_that_meet_in_a_corner_become_one_simple_ring() {
        let mut rings = vec![vec![
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 5.0],
            [10.0, 5.0],
            [10.0, 10.0],
            [5.0, 10.0],
            [5.0, 5.0],
            [0.0, 5.0],
        ]];
        assert!(Outline::new(rings[0].clone(), vec![]).is_err());
        part_touching(&mut rings, CUT);
        let outline = Outline::new(rings[0].clone(), vec![]).unwrap();
        // Two corners cut, each by half a square of the cut.
        assert!((outline.area() - 50.0).abs() <= CUT * CUT);
    }

    #[test]
    fn rings_that_touch_nothing_stay_as_they_are() {
        let mut rings = vec![square(0.0, 9.0), square(2.0, 3.0)];
        let before = rings.clone();
        part_touching(&mut rings, CUT);
        assert_eq!(rings, before);
    }
}
