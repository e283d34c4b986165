//! What stands before and between coded strips (ITU-T T.81, annex B).

use super::Chroma;
use super::tables::{CHROMA, HuffmanSpec, LUMA, Quantization, ZIGZAG};

const START_OF_IMAGE: u8 = 0xD8;
const APPLICATION_0: u8 = 0xE0;
const COMMENT: u8 = 0xFE;
const QUANTIZATION_TABLES: u8 = 0xDB;
const BASELINE_FRAME: u8 = 0xC0;
const HUFFMAN_TABLES: u8 = 0xC4;
const RESTART_INTERVAL: u8 = 0xDD;
const START_OF_SCAN: u8 = 0xDA;
const RESTART: u8 = 0xD0;

/// The last marker.
pub(super) const END_OF_IMAGE: [u8; 2] = [0xFF, 0xD9];

/// The marker behind strip `at`.
pub(super) fn restart(at: usize) -> [u8; 2] {
    [0xFF, RESTART | at.to_le_bytes()[0] & 7]
}

/// Everything before the first strip. `size` is width and height, an empty comment is left out, a restart
/// comes after every `interval` coded units.
pub(super) fn headers(
    size: [u32; 2],
    comment: &str,
    chroma: Chroma,
    quantization: &Quantization,
    interval: usize,
) -> Vec<u8> {
    let mut bytes = vec![0xFF, START_OF_IMAGE];
    // Version 1.1, square pixels, no thumbnail.
    segment(&mut bytes, APPLICATION_0, b"JFIF\0\x01\x01\0\0\x01\0\x01\0\0");
    if !comment.is_empty() {
        segment(&mut bytes, COMMENT, comment.as_bytes());
    }
    for (table, steps) in [(0, &quantization.luma), (1, &quantization.chroma)] {
        let mut content = vec![table];
        content.extend(ZIGZAG.map(|at| steps[usize::from(at)]));
        segment(&mut bytes, QUANTIZATION_TABLES, &content);
    }
    segment(&mut bytes, BASELINE_FRAME, &frame(size, chroma));
    for (table, specs) in [(0, &LUMA), (1, &CHROMA)] {
        // The upper half of the first byte: 0 for the first coefficient, 1 for the others.
        segment(&mut bytes, HUFFMAN_TABLES, &huffman(table, &specs[0]));
        segment(&mut bytes, HUFFMAN_TABLES, &huffman(table | 0x10, &specs[1]));
    }
    segment(&mut bytes, RESTART_INTERVAL, &short(interval));
    // Three components with their Huffman tables, and all 64 coefficients in one go.
    segment(&mut bytes, START_OF_SCAN, &[3, 1, 0x00, 2, 0x11, 3, 0x11, 0, 63, 0]);
    bytes
}

/// Eight bits, rows, columns, and three components: name, sampling, quantization table.
fn frame([width, height]: [u32; 2], chroma: Chroma) -> Vec<u8> {
    let sampling = match chroma {
        Chroma::Full => 0x11,
        Chroma::Quarter => 0x22,
    };
    let mut content = vec![8];
    content.extend(short(height as usize));
    content.extend(short(width as usize));
    content.extend([3, 1, sampling, 0, 2, 0x11, 1, 3, 0x11, 1]);
    content
}

fn huffman(table: u8, spec: &HuffmanSpec) -> Vec<u8> {
    [&[table], spec.counts.as_slice(), spec.symbols].concat()
}

fn segment(bytes: &mut Vec<u8>, marker: u8, content: &[u8]) {
    bytes.extend([0xFF, marker]);
    bytes.extend(short(content.len() + 2));
    bytes.extend(content);
}

/// Sides, lengths and intervals are at most 16384.
fn short(n: usize) -> [u8; 2] {
    u16::try_from(n).expect("at most 16384").to_be_bytes()
}
