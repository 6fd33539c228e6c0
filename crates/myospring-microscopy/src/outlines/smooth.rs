//! Smooth outlines from rings along pixel edges.

use geo::Simplify;

use super::PixelFrame;
use myospring_core::mesh::outline::Outline;

/// Largest distance of a removed point from the smooth outline, pixels; halved if the result
/// crosses itself or has the wrong area.
const DEVIATION: f64 = 0.5;

/// Largest number of halvings of [`DEVIATION`].
const HALVINGS: u32 = 3;

/// Number of rounds of averaging neighbouring points, with weights 1, 2, 1. It removes the pixels'
/// steps, so that the length is right to 0.5 % (discs and slanted ellipses of 30 pixels and more;
/// without averaging it is 2 to 3 % too long), and still keeps tips. It reduces the area by about a
/// pixel and a half, which is too much for a small cell; such a cell gets fewer rounds or none.
const AVERAGES: usize = 2;

/// Shortest ring that is averaged, in pixel sides; smaller holes would close.
const SHORTEST_AVERAGED: usize = 16;

/// Largest relative change of the area.
const AREA_ERROR: f64 = 0.005;

/// Joins the midpoints of all pixel edges, averages neighbours, and removes points that deviate
/// little (Douglas and Peucker 1973). `None` if no such outline keeps the area.
///
/// Joining midpoints cuts each outer corner of a pixel and fills each inner one by the same
/// triangle; a ring has four more outer corners, so the area decreases by exactly half a pixel.
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

/// The ring after `times` rounds of averaging each point (weight 2) with its neighbours (weight 1).
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

/// Area of a ring in pixels; holes run the other way and have the opposite sign.
fn signed_area(ring: &[[f64; 2]]) -> f64 {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    edges.map(|(p, q)| 0.5 * (p[0] * q[1] - q[0] * p[1])).sum()
}

/// Midpoints of the pixel sides along a ring, which is given by its corners.
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
