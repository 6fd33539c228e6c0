//! A mask: the pixels of a picture that belong to the cell.

use super::pixel_size::PixelSize;

/// Why a list of pixels is not a valid mask.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MaskError {
    /// The list of pixels does not fill the picture.
    #[error("a mask of {width} x {height} pixels needs {} values, but {found} were given", width * height)]
    Shape {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        found: usize,
    },
    /// No pixel belongs to the cell.
    #[error(
        "the mask is empty: none of its {width} x {height} pixels belongs to the cell; paint the cell in a \
         non-zero value on a background of zero"
    )]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Every pixel belongs to the cell.
    #[error(
        "the mask has no background: all of its {width} x {height} pixels belong to the cell; the \
         background must be zero (is this the picture itself, not its mask?)"
    )]
    Full {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
}

/// The pixels of a picture that belong to the cell; row 0 is the top of the picture.
///
/// At least one pixel belongs to the cell and at least one does not. Only the bounding box of the
/// cell is stored, so that memory depends on the cell, not on the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    width: usize,
    height: usize,
    pixel_size: PixelSize,
    part: Part,
}

/// The bounding box of a cell with its pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Its first column in the picture.
    pub left: usize,
    /// Its first row in the picture.
    pub top: usize,
    /// Number of columns.
    pub width: usize,
    /// For each pixel, row by row from its top left: whether it belongs to the cell.
    pub inside: Vec<bool>,
}

impl Part {
    /// Number of rows.
    pub fn height(&self) -> usize {
        self.inside.len() / self.width.max(1)
    }

    /// The box without empty rows and columns at its sides; `None` if it is empty.
    fn cropped(self) -> Option<Self> {
        let rows = || self.inside.chunks_exact(self.width.max(1));
        let holds = |row: &[bool]| row.contains(&true);
        let first = rows().position(holds)?;
        let last = rows().rposition(holds)?;
        let (mut left, mut right) = (self.width, 0);
        for row in rows().take(last + 1).skip(first) {
            left = row.iter().take(left).position(|&is| is).unwrap_or(left);
            right = row.iter().rposition(|&is| is).map_or(right, |at| right.max(at + 1));
        }
        if (first, last + 1, left, right) == (0, self.height(), 0, self.width) {
            return Some(self);
        }
        let inside = rows().take(last + 1).skip(first).flat_map(|row| &row[left..right]);
        let inside = inside.copied().collect();
        Some(Self { left: self.left + left, top: self.top + first, width: right - left, inside })
    }
}

/// The islands that [`Mask::largest_part`] left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dropped {
    /// Number of islands other than the cell.
    pub components: usize,
    /// Their total number of pixels.
    pub pixels: usize,
}

impl Mask {
    /// Makes a mask of `width` x `height` pixels, row by row from the top left.
    ///
    /// # Errors
    /// A wrong number of values, an empty mask, or one without background.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{mask::Mask, pixel_size::PixelSize};
    /// let mask = Mask::new(3, 1, PixelSize::new(0.5)?, vec![false, true, true])?;
    /// assert_eq!(mask.area_um2(), 0.5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        width: usize,
        height: usize,
        pixel_size: PixelSize,
        inside: Vec<bool>,
    ) -> Result<Self, MaskError> {
        if width.checked_mul(height) != Some(inside.len()) {
            return Err(MaskError::Shape { width, height, found: inside.len() });
        }
        Self::of_part(width, height, pixel_size, Part { left: 0, top: 0, width, inside })
    }

    /// Makes a mask of `width` x `height` pixels whose cell lies entirely in `part`.
    ///
    /// # Errors
    /// A part that is not a box within the picture, an empty mask, or one without background.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{mask::{Mask, Part}, pixel_size::PixelSize};
    /// let part = Part { left: 2, top: 1, width: 2, inside: vec![true, false] };
    /// let mask = Mask::of_part(4, 2, PixelSize::new(0.5)?, part)?;
    /// assert_eq!(mask.inside(), [false, false, false, false, false, false, true, false]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_part(
        width: usize,
        height: usize,
        pixel_size: PixelSize,
        part: Part,
    ) -> Result<Self, MaskError> {
        let found = part.inside.len();
        let (right, bottom) =
            (part.left.saturating_add(part.width), part.top.saturating_add(part.height()));
        if part.width * part.height() != found || right > width || bottom > height {
            return Err(MaskError::Shape { width, height, found });
        }
        let part = part.cropped().ok_or(MaskError::Empty { width, height })?;
        if part.inside.len() == width * height && part.inside.iter().all(|&pixel| pixel) {
            return Err(MaskError::Full { width, height });
        }
        Ok(Self { width, height, pixel_size, part })
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Side of one pixel.
    pub fn pixel_size(&self) -> PixelSize {
        self.pixel_size
    }

    /// The bounding box of the cell.
    pub fn part(&self) -> &Part {
        &self.part
    }

    /// For each pixel of the picture, row by row from the top left: whether it belongs to the cell.
    pub fn inside(&self) -> Vec<bool> {
        let Part { left, top, width, inside } = &self.part;
        let mut all = vec![false; self.width * self.height];
        for (row, values) in inside.chunks_exact(*width).enumerate() {
            all[(top + row) * self.width + left..][..*width].copy_from_slice(values);
        }
        all
    }

    /// Number of pixels of the cell.
    pub fn cell_pixels(&self) -> usize {
        self.part.inside.iter().filter(|&&pixel| pixel).count()
    }

    /// Area of the cell, um^2.
    pub fn area_um2(&self) -> f64 {
        self.cell_pixels() as f64 * self.pixel_size.um() * self.pixel_size.um()
    }

    /// Whether the cell reaches the first or last row or column: it may be cut by the frame.
    pub fn touches_frame(&self) -> bool {
        let Part { left, top, width, .. } = self.part;
        left == 0
            || top == 0
            || left + width == self.width
            || top + self.part.height() == self.height
    }

    /// The largest island of pixels connected by sides or corners, and the islands left out.
    ///
    /// Of two islands of equal size, the first from the top is kept.
    pub fn largest_part(&self) -> (Self, Dropped) {
        const NONE: u32 = u32::MAX;
        let Part { width, inside, .. } = &self.part;
        let (width, height) = (*width, self.part.height());
        let mut island = vec![NONE; inside.len()];
        let mut sizes: Vec<usize> = Vec::new();
        let mut stack = Vec::new();
        for start in 0..inside.len() {
            if !inside[start] || island[start] != NONE {
                continue;
            }
            let name = sizes.len() as u32;
            let mut size = 0;
            island[start] = name;
            stack.push(start);
            while let Some(pixel) = stack.pop() {
                size += 1;
                let (row, column) = (pixel / width, pixel % width);
                for y in row.saturating_sub(1)..(row + 2).min(height) {
                    for x in column.saturating_sub(1)..(column + 2).min(width) {
                        let other = y * width + x;
                        if inside[other] && island[other] == NONE {
                            island[other] = name;
                            stack.push(other);
                        }
                    }
                }
            }
            sizes.push(size);
        }
        let largest = sizes.iter().copied().max().unwrap_or(0);
        let kept = sizes.iter().position(|&size| size == largest).unwrap_or(0) as u32;
        let dropped = Dropped {
            components: sizes.len().saturating_sub(1),
            pixels: sizes.iter().sum::<usize>() - largest,
        };
        if sizes.len() == 1 {
            return (self.clone(), dropped);
        }
        let inside = island.into_iter().map(|name| name == kept).collect();
        let part = Part { inside, ..self.part };
        // The largest island has a pixel.
        let part = part.cropped().unwrap_or_else(|| self.part.clone());
        (Self { part, ..*self }, dropped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(rows: &[&str]) -> Mask {
        let inside = rows.concat().chars().map(|c| c == '#').collect();
        Mask::new(rows[0].len(), rows.len(), PixelSize::new(1.0).unwrap(), inside).unwrap()
    }

    #[test]
    fn islands_beside_the_largest_are_dropped_and_counted() {
        let mask = drawn(&["#....", "..##.", ".###.", "....#", "#...."]);
        let (part, dropped) = mask.largest_part();
        assert_eq!(dropped, Dropped { components: 2, pixels: 2 });
        // The pixel that touches by a corner belongs to the cell.
        assert_eq!(part, drawn(&[".....", "..##.", ".###.", "....#", "....."]));
        assert!(part.touches_frame());
    }

    #[test]
    fn a_cell_within_the_picture_does_not_touch_the_frame() {
        assert!(!drawn(&["...", ".#.", "..."]).touches_frame());
        for frame in [["#..", "...", "..."], ["...", "..#", "..."], ["...", "...", ".#."]] {
            assert!(drawn(&frame).touches_frame(), "{frame:?}");
        }
    }

    #[test]
    fn an_unusable_mask_says_what_to_mend() {
        let pixel = PixelSize::new(1.0).unwrap();
        let message = |inside| Mask::new(2, 1, pixel, inside).unwrap_err().to_string();
        assert_eq!(
            message(vec![false, false]),
            "the mask is empty: none of its 2 x 1 pixels belongs to the cell; paint the cell in a non-zero \
             value on a background of zero"
        );
        assert_eq!(
            message(vec![true, true]),
            "the mask has no background: all of its 2 x 1 pixels belong to the cell; the background must \
             be zero (is this the picture itself, not its mask?)"
        );
        assert_eq!(message(vec![true]), "a mask of 2 x 1 pixels needs 2 values, but 1 were given");
    }
}
