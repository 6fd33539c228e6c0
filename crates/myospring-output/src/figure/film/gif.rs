//! Animated GIFs from frames of few colours; each frame stores only its difference from the one
//! before.

use std::borrow::Cow;
use std::collections::HashMap;

use ::gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use crate::figure::FigureError;

/// A frame whose pixels are indices of a palette.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Still {
    size: [u16; 2],
    pixels: Vec<u8>,
}

/// A painted frame in the nearest colours of a palette of at most 255.
pub(in crate::figure) fn still(palette: &[[u8; 3]], size: [u32; 2], colours: &[u8]) -> Still {
    // Few colours, many pixels.
    let mut known: HashMap<[u8; 3], u8> = HashMap::new();
    let pixels = colours.chunks_exact(3).map(|pixel| {
        let colour = [pixel[0], pixel[1], pixel[2]];
        *known.entry(colour).or_insert_with(|| nearest(palette, colour))
    });
    Still { size: size.map(|side| side as u16), pixels: pixels.collect() }
}

fn nearest(palette: &[[u8; 3]], colour: [u8; 3]) -> u8 {
    let distance = |other: &[u8; 3]| -> u32 {
        other.iter().zip(colour).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    let best = palette.iter().take(255).enumerate().min_by_key(|(_, other)| distance(other));
    best.map_or(0, |(index, _)| index as u8)
}

/// Joins frames into an endless GIF, each shown for `delay` hundredths of a second.
pub(in crate::figure) fn animated(
    palette: &[[u8; 3]],
    stills: &[Still],
    delay: u16,
) -> Result<Vec<u8>, FigureError> {
    let Some(first) = stills.first() else { return Err(FigureError::Nothing { what: "frames" }) };
    let same = palette.len().min(255) as u8;
    let mut colours: Vec<u8> = palette[..usize::from(same)].concat();
    // The index of unchanged pixels.
    colours.extend([0; 3]);
    let failed = |error: EncodingError| FigureError::Raster { reason: error.to_string() };
    let mut bytes = Vec::new();
    let mut encoder =
        Encoder::new(&mut bytes, first.size[0], first.size[1], &colours).map_err(failed)?;
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    let mut before: Option<&Still> = None;
    for still in stills {
        let mut frame = match before.filter(|before| before.size == still.size) {
            Some(before) => changed(before, still, same),
            None => Frame {
                width: still.size[0],
                height: still.size[1],
                buffer: Cow::Borrowed(&still.pixels),
                ..Frame::default()
            },
        };
        frame.delay = delay;
        frame.dispose = DisposalMethod::Keep;
        encoder.write_frame(&frame).map_err(failed)?;
        before = Some(still);
    }
    drop(encoder);
    Ok(bytes)
}

/// The part of a frame that differs from the one before; unchanged pixels within it are `same`.
fn changed(before: &Still, now: &Still, same: u8) -> Frame<'static> {
    let width = usize::from(now.size[0]);
    let differs = |(a, b): (&u8, &u8)| a != b;
    let rows: Vec<(&[u8], &[u8])> =
        before.pixels.chunks_exact(width).zip(now.pixels.chunks_exact(width)).collect();
    let top = rows.iter().position(|(a, b)| a != b).unwrap_or(0);
    let bottom = rows.iter().rposition(|(a, b)| a != b).unwrap_or(0);
    let columns = |row: &(&[u8], &[u8])| {
        let mut places = row.0.iter().zip(row.1);
        let first = places.clone().position(differs)?;
        Some((first, places.rposition(differs)?))
    };
    let ends = rows[top..=bottom].iter().filter_map(columns);
    let (left, right) = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0, 0));
    let part = rows[top..=bottom].iter().flat_map(|(a, b)| {
        let pixels = a[left..=right].iter().zip(&b[left..=right]);
        pixels.map(|(a, b)| if a == b { same } else { *b })
    });
    Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        transparent: Some(same),
        buffer: Cow::Owned(part.collect()),
        ..Frame::default()
    }
}
