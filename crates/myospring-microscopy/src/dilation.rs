//! Dilation and erosion of sets of pixels by a radius.

/// How distance is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Norm {
    /// Euclidean distance.
    Euclid,
    /// The larger of the distances along rows and columns: a diagonal step has length one.
    Chessboard,
}

impl Norm {
    /// Half-width of a ball of the radius in a row `away` rows from its centre.
    fn half_width(self, radius: usize, away: usize) -> usize {
        match self {
            Self::Euclid => (radius * radius - away * away).isqrt(),
            Self::Chessboard => radius,
        }
    }
}

/// The pixels within `radius` pixels of one of the set, row by row as the set is.
///
/// Columns first, then rows, as in distance transforms (Felzenszwalb and Huttenlocher 2012), but in
/// whole numbers and only up to the radius: the distance to the set within a column determines how
/// far the ball reaches along the row. The cost is four steps per pixel, whatever the radius.
pub(super) fn dilated(inside: &[bool], width: usize, radius: usize, norm: Norm) -> Vec<bool> {
    let radius = radius.min(usize::from(u16::MAX) - 1);
    let away = away_in_columns(inside, width, radius as u16 + 1);
    // Half-width for each distance within the column; negative beyond the radius.
    let half_widths: Vec<i32> = (0..=radius)
        .map(|away| i32::try_from(norm.half_width(radius, away)).unwrap_or(i32::MAX))
        .chain(std::iter::once(-1))
        .collect();
    let mut near = vec![false; inside.len()];
    for (near, away) in near.chunks_exact_mut(width).zip(away.chunks_exact(width)) {
        // How many pixels further the farthest-reaching ball covers from here.
        let mut left = -1;
        for (near, &away) in near.iter_mut().zip(away) {
            left = half_widths[usize::from(away)].max(left - 1);
            *near = left >= 0;
        }
        left = -1;
        for (near, &away) in near.iter_mut().zip(away).rev() {
            left = half_widths[usize::from(away)].max(left - 1);
            *near |= left >= 0;
        }
    }
    near
}

/// The pixels of the set whose distance to every pixel outside it exceeds `radius` pixels; beyond
/// the picture's rim nothing counts as outside.
pub(super) fn eroded(inside: &[bool], width: usize, radius: usize, norm: Norm) -> Vec<bool> {
    let outside: Vec<bool> = inside.iter().map(|inside| !inside).collect();
    let mut near = dilated(&outside, width, radius, norm);
    for near in &mut near {
        *near = !*near;
    }
    near
}

/// The distance of each pixel from the set along its column, at most `most`.
fn away_in_columns(inside: &[bool], width: usize, most: u16) -> Vec<u16> {
    let mut away: Vec<u16> = inside.iter().map(|&is| if is { 0 } else { most }).collect();
    let nearer = |row: &mut [u16], next: &[u16]| {
        for (away, next) in row.iter_mut().zip(next) {
            *away = (*away).min(next.saturating_add(1));
        }
    };
    for start in (width..away.len()).step_by(width.max(1)) {
        let (above, row) = away.split_at_mut(start);
        nearer(&mut row[..width], &above[start - width..]);
    }
    for start in (width..away.len()).step_by(width.max(1)).rev() {
        let (row, below) = away.split_at_mut(start);
        nearer(&mut row[start - width..], &below[..width]);
    }
    away
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Whether any pixel of the set is within the radius, by looking at all of them.
    fn by_looking(inside: &[bool], width: usize, radius: usize, norm: Norm) -> Vec<bool> {
        let place = |at: usize| [at % width, at / width];
        let near = |a: [usize; 2], b: [usize; 2]| {
            let [x, y] = [a[0].abs_diff(b[0]), a[1].abs_diff(b[1])];
            match norm {
                Norm::Euclid => x * x + y * y <= radius * radius,
                Norm::Chessboard => x.max(y) <= radius,
            }
        };
        let set: Vec<usize> = (0..inside.len()).filter(|&at| inside[at]).collect();
        (0..inside.len()).map(|at| set.iter().any(|&of| near(place(at), place(of)))).collect()
    }

    proptest! {
        #[test]
        fn what_is_near_is_what_looking_at_every_pixel_finds(
            width in 1_usize..30,
            share in 0.0_f64..0.3,
            seeds in proptest::collection::vec(0.0_f64..1.0, 30..500),
            radius in 0_usize..40,
        ) {
            let inside: Vec<bool> =
                seeds[..seeds.len() / width * width].iter().map(|&seed| seed < share).collect();
            for norm in [Norm::Euclid, Norm::Chessboard] {
                let near = by_looking(&inside, width, radius, norm);
                prop_assert_eq!(&dilated(&inside, width, radius, norm), &near);
                let outside: Vec<bool> = inside.iter().map(|is| !is).collect();
                let far: Vec<bool> = near.iter().map(|near| !near).collect();
                prop_assert_eq!(eroded(&outside, width, radius, norm), far);
            }
        }
    }

    #[test]
    fn nothing_is_near_an_empty_set_and_all_is_left_of_a_full_one() {
        for radius in [0, 1, 7, 70_000] {
            assert!(!dilated(&[false; 12], 4, radius, Norm::Euclid).contains(&true));
            assert!(!eroded(&[true; 12], 4, radius, Norm::Chessboard).contains(&false));
        }
    }
}
