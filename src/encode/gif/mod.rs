//! GIF that moves: one palette for all frames, only what changes in each.

mod boxes;
mod dither;
mod nearest;
mod palette;

use super::colors;
use crate::pipeline::{Cancelled, Frame, Work};
use ::gif::{DisposalMethod, Encoder, Repeat};
use palette::{Palette, TRANSPARENT};
use std::borrow::Cow;

/// Encodes frames of colours of one size, shown for `delay_cs` hundredths of a second each, over and
/// over.
///
/// The palette holds up to 255 colours, the best for all frames together, so that nothing flickers from
/// one to the next. Alpha is 1 from one half on, else 0.
///
/// # Errors
/// [`Cancelled`].
///
/// # Panics
/// Without frames, for pictures of values, and where sizes differ.
pub fn gif(frames: &[Frame], delay_cs: u16, work: &Work) -> Result<Vec<u8>, Cancelled> {
    let palette = Palette::of(frames.iter().map(|frame| colors(frame).0), work)?;
    let width = frames[0].width as usize;
    let indexed = work.map(
        frames.iter().collect(),
        || (),
        |(), frame: &Frame| dither::indices(&palette, colors(frame).0, width),
    )?;

    let opaque = frames.iter().all(|frame| colors(frame).1);
    let changes: Vec<Change> = match opaque {
        true => changes(&indexed),
        false => indexed.iter().map(|indices| Change::all(indices)).collect(),
    };
    let dispose = if opaque { DisposalMethod::Keep } else { DisposalMethod::Background };
    let packed = work.map(changes, || (), |(), change| change.packed(width, delay_cs, dispose))?;
    Ok(write(&frames[0], &palette, &packed))
}

/// What one frame draws over the one before.
#[derive(Clone, Copy)]
struct Change<'a> {
    /// The frame before, if what is like it may stay.
    before: Option<&'a [u8]>,
    now: &'a [u8],
}

/// The first frame whole, each other against the one before.
fn changes(indexed: &[Vec<u8>]) -> Vec<Change<'_>> {
    let before = std::iter::once(None).chain(indexed.iter().map(|indices| Some(indices.as_slice())));
    indexed.iter().zip(before).map(|(now, before)| Change { before, now }).collect()
}

impl<'a> Change<'a> {
    /// The whole frame.
    fn all(now: &'a [u8]) -> Self {
        Self { before: None, now }
    }

    /// Index `at`, transparent where it stays.
    fn index(self, at: usize) -> u8 {
        match self.before {
            Some(before) if before[at] == self.now[at] => TRANSPARENT,
            _ => self.now[at],
        }
    }

    /// The smallest rectangle with all that changes, compressed.
    fn packed(self, width: usize, delay: u16, dispose: DisposalMethod) -> ::gif::Frame<'static> {
        let [left, top, right, bottom] = self.bounds(width);
        let rows = top..bottom;
        let buffer: Vec<u8> =
            rows.flat_map(|y| (left..right).map(move |x| self.index(y * width + x))).collect();
        let mut frame = ::gif::Frame {
            delay,
            dispose,
            transparent: Some(TRANSPARENT),
            left: side(left),
            top: side(top),
            width: side(right - left),
            height: side(bottom - top),
            buffer: Cow::Owned(buffer),
            ..::gif::Frame::default()
        };
        frame.make_lzw_pre_encoded();
        frame
    }

    /// Left, top, right, bottom around all that changes; one pixel if nothing does.
    fn bounds(self, width: usize) -> [usize; 4] {
        let Some(before) = self.before else { return [0, 0, width, self.now.len() / width] };
        let mut bounds = [width, usize::MAX, 0, 0];
        for (y, (now, before)) in self.now.chunks(width).zip(before.chunks(width)).enumerate() {
            let differs = |&x: &usize| now[x] != before[x];
            let Some(first) = (0..width).find(differs) else { continue };
            let last = (first..width).rfind(differs).unwrap_or(first);
            bounds = [bounds[0].min(first), bounds[1].min(y), bounds[2].max(last + 1), y + 1];
        }
        if bounds[2] == 0 { [0, 0, 1, 1] } else { bounds }
    }
}

fn write(size: &Frame, palette: &Palette, frames: &[::gif::Frame]) -> Vec<u8> {
    let (width, height) = (side(size.width as usize), side(size.height as usize));
    let encode = || -> Result<Vec<u8>, ::gif::EncodingError> {
        let mut encoder = Encoder::new(Vec::new(), width, height, &palette.rgb())?;
        encoder.set_repeat(Repeat::Infinite)?;
        frames.iter().try_for_each(|frame| encoder.write_lzw_pre_encoded_frame(frame))?;
        encoder.into_inner()
    };
    encode().expect("frames within the picture are written to memory")
}

/// A length that GIF can say: a picture has at most 16384 pixels a side.
fn side(n: usize) -> u16 {
    u16::try_from(n).expect("at most 16384")
}

#[cfg(test)]
mod tests;
