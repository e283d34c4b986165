//! Quantized blocks to bits (ITU-T T.81, F.1.2).

use super::Chroma;
use super::bits::Bits;
use super::tables::{CHROMA, HuffmanSpec, LUMA};
use std::sync::LazyLock;

/// Quantized coefficients in the order of the zigzag, within ±1023.
pub(super) type Block = [i16; 64];

/// Sixteen zeros.
const ZERO_RUN: usize = 0xF0;
/// Nothing but zeros to the end of the block.
const END_OF_BLOCK: usize = 0x00;

/// Code and length of every symbol.
struct Codes([(u32, u32); 256]);

/// Of brightness and chroma, first coefficients and others.
static CODES: LazyLock<[[Codes; 2]; 2]> =
    LazyLock::new(|| [LUMA, CHROMA].map(|specs| specs.map(|spec| Codes::of(&spec))));

impl Codes {
    /// Consecutive codes of each length, from the shortest (T.81, annex C).
    fn of(spec: &HuffmanSpec) -> Self {
        let (mut codes, mut code) = ([(0, 0); 256], 0);
        let mut symbols = spec.symbols.iter();
        for (length, count) in (1..).zip(spec.counts) {
            for symbol in symbols.by_ref().take(count.into()) {
                codes[usize::from(*symbol)] = (code, length);
                code += 1;
            }
            code <<= 1;
        }
        Self(codes)
    }

    /// The code of `symbol` with the bits of `value` behind it, `size` of them.
    fn put(&self, bits: &mut Bits, symbol: usize, value: i32, size: u32) {
        let (code, length) = self.0[symbol];
        // Negative values are counted from the lowest of their size, −2^size + 1.
        let value = if value < 0 { value - 1 } else { value };
        let value = value.cast_unsigned() & ((1 << size) - 1);
        bits.put(code << size | value, length + size);
    }
}

/// Bits of a value's magnitude.
fn size(value: i32) -> u32 {
    32 - value.unsigned_abs().leading_zeros()
}

/// Codes the blocks between two restarts.
pub(super) struct Coder {
    bits: Bits,
    /// The first coefficients of the blocks before, by component.
    before: [i32; 3],
}

impl Coder {
    pub(super) fn new() -> Self {
        Self { bits: Bits::default(), before: [0; 3] }
    }

    /// Codes units of brightness, blue and red chroma.
    pub(super) fn code(mut self, blocks: &[Block], chroma: Chroma) -> Vec<u8> {
        let components: &[usize] = match chroma {
            Chroma::Full => &[0, 1, 2],
            Chroma::Quarter => &[0, 0, 0, 0, 1, 2],
        };
        for (block, component) in blocks.iter().zip(components.iter().cycle()) {
            self.block(block, *component);
        }
        self.bits.finish()
    }

    fn block(&mut self, block: &Block, component: usize) {
        let [first_codes, codes] = &CODES[component.min(1)];
        let first = i32::from(block[0]);
        let difference = first - std::mem::replace(&mut self.before[component], first);
        let bits = size(difference);
        first_codes.put(&mut self.bits, bits as usize, difference, bits);

        // One bit for each coefficient that is not zero, the second in the lowest place.
        let mut present =
            block.iter().rev().fold(0u64, |mask, value| mask << 1 | u64::from(*value != 0)) >> 1;
        let mut at = 0;
        while present != 0 {
            let mut zeros = present.trailing_zeros() as usize;
            present >>= zeros;
            present >>= 1;
            at += zeros + 1;
            while zeros >= 16 {
                codes.put(&mut self.bits, ZERO_RUN, 0, 0);
                zeros -= 16;
            }
            let value = i32::from(block[at]);
            let bits = size(value);
            codes.put(&mut self.bits, zeros << 4 | bits as usize, value, bits);
        }
        if at < 63 {
            codes.put(&mut self.bits, END_OF_BLOCK, 0, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_of_annex_k() {
        let [[first, others], [_, chroma]] = &*CODES;
        assert_eq!(first.0[0], (0b00, 2));
        assert_eq!(first.0[11], (0b1_1111_1110, 9));
        assert_eq!(others.0[END_OF_BLOCK], (0b1010, 4));
        assert_eq!(others.0[ZERO_RUN], (0b111_1111_1001, 11));
        assert_eq!(chroma.0[END_OF_BLOCK], (0b00, 2));
        assert_eq!(chroma.0[0xFA], (0xFFFE, 16));
    }

    #[test]
    fn a_flat_block_is_six_bits() {
        // Difference 0, end of block; padded with ones.
        assert_eq!(Coder::new().code(&[[0; 64]], Chroma::Full), [0b0010_1011]);
    }

    #[test]
    fn the_last_coefficient_needs_no_end_and_long_gaps_have_their_symbol() {
        let mut block = [0; 64];
        block[63] = -1;
        // Difference 0; three runs of sixteen; 14 zeros and one bit, which is 0 for −1.
        let (run, last) = ("11111111001", "1111111111101011");
        let expected = format!("00{run}{run}{run}{last}0");
        let (code, length) = CODES[0][1].0[0xE1];
        assert_eq!(format!("{code:0width$b}", width = length as usize), last);
        let bytes = Coder::new().code(&[block], Chroma::Full);
        let bits: String = bytes.iter().map(|byte| format!("{byte:08b}")).collect();
        // 0xFF bytes have a zero behind them.
        let stuffed: String = bits.replace("1111111100000000", "11111111");
        assert!(stuffed.starts_with(&expected), "{stuffed} {expected}");
    }
}
