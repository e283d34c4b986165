//! APNG: PNG that moves (PNG, third edition, section 11.3.6).

use super::png::{encoder, samples};
use crate::pipeline::Frame;
use png::EncodingError;

/// Encodes `count` frames of one size and kind, each as it comes; they are shown for `delay_cs`
/// hundredths of a second each, over and over.
///
/// # Errors
/// The first of the frames' own.
///
/// # Panics
/// If `frames` are not `count`, or differ in size or kind.
pub fn apng<E>(
    frames: impl IntoIterator<Item = Result<Frame, E>>,
    count: u32,
    delay_cs: u16,
) -> Result<Vec<u8>, E> {
    let mut frames = frames.into_iter();
    let mut frame = frames.next().expect("an animation has a frame")?;
    let mut bytes = Vec::new();
    let start = |bytes| {
        let mut encoder = encoder(&frame, bytes);
        encoder.set_animated(count, FOR_EVER)?;
        encoder.set_frame_delay(delay_cs, 100)?;
        encoder.write_header()
    };
    let in_memory = "frames of one kind are written to memory";
    let mut writer = start(&mut bytes).expect(in_memory);
    loop {
        writer.write_image_data(&samples(&frame.pixels)).expect(in_memory);
        match frames.next() {
            Some(next) => frame = next?,
            None => break,
        }
    }
    let end: Result<(), EncodingError> = writer.finish();
    end.expect("as many frames as were announced");
    Ok(bytes)
}

/// The number of plays that never ends.
const FOR_EVER: u32 = 0;
