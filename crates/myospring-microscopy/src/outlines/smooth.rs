//! A smooth outline of rings along pixel edges.

use geo::Simplify;

use super::PixelFrame;
use myospring_core::mesh::outline::Outline;

/// Largest distance of a left-out point from the smooth outline, pixels; halved where the result
/// crosses itself or misses the area.
const DEVIATION: f64 = 0.5;

/// How often [`DEVIATION`] is halved.
const HALVINGS: u32 = 3;

/// How often neighbouring points are averaged, with weights 1, 2, 1: enough to take the steps of the pixels
/// out of the length of the outline, which is then right to 0.5 % (discs and slanted ellipses of 30 pixels and
/// more), little enough to keep tips. Without it the length is 2 to 3 % too long. It costs about a pixel and
/// a half of the area, too much for a small cell, which has fewer averages or none.
const AVERAGES: usize = 2;

/// Shortest ring that is averaged, in sides of pixels; small holes would close.
const SHORTEST_AVERAGED: usize = 16;

/// Largest change of the area.
const AREA_ERROR: f64 = 0.005;

/// Joins the middles of all pixel edges, averages neighbours, and leaves out points that deviate little (Douglas and
/// Peucker 1973). `None` where no such outline keeps the area.
///
/// Joining the middles cuts each outer corner of a pixel and fills each inner one by the same
/// triangle; a ring has four outer corners more, so the area falls by just half a pixel.
pub(super) fn smooth(rings: &[Vec<[f64; 2]>], frame: &PixelFrame) -> Option<Outline> {
    let pixel = frame.pixel_size().um();
    let exact = rings.iter().map(|ring| signed_area(ring)).sum::<f64>().abs() * pixel * pixel;
    (0..=AVERAGES).rev().find_map(|times| {
        let fine: Vec<geo::Polygon> = rings
            .iter()
            .map(|ring| averaged(edge_middles(ring), times).into_iter().collect())
            .map(|ring| geo::Polygon::new(ring, Vec::new()))
            .collect();
        (0..=HALVINGS).find_map(|halvings| {
            let deviation = DEVIATION / f64::from(1 << halvings);
            let simple = fine.iter().map(|ring| {
                let points = ring.simplify(deviation);
                points.exterior().points().map(|point| [point.x(), point.y()]).collect()
            });
            let outline = frame.outline(simple.collect()).ok()?;
            ((outline.area() - exact).abs() <= AREA_ERROR * exact).then_some(outline)
        })
    })
}

/// The ring with each point moved to the mean of itself, twice, and its neighbours, so many times.
fn averaged(mut ring: Vec<[f64; 2]>, times: usize) -> Vec<[f64; 2]> {
    let count = ring.len();
    if count < SHORTEST_AVERAGED {
        return ring;
    }
    for _ in 0..times {
        let mean = |index: usize| {
            let [before, at, after] =
                [index + count - 1, index, index + 1].map(|index| ring[index % count]);
            [0, 1].map(|axis| 0.25 * (before[axis] + 2.0 * at[axis] + after[axis]))
        };
        ring = (0..count).map(mean).collect();
    }
    ring
}

/// Area of a ring in pixels; holes, walked the other way, have the other sign.
fn signed_area(ring: &[[f64; 2]]) -> f64 {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    edges.map(|(p, q)| 0.5 * (p[0] * q[1] - q[0] * p[1])).sum()
}

/// Middles of the sides of pixels along a ring given by its corners.
fn edge_middles(ring: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut middles = Vec::new();
    for (p, q) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
        let length = dx.abs() + dy.abs();
        for step in 0..length as usize {
            let share = (step as f64 + 0.5) / length;
            middles.push([p[0] + share * dx, p[1] + share * dy]);
        }
    }
    middles
}
