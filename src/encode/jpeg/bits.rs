//! Codes of any length, one behind the other.

/// Bytes in the making.
#[derive(Default)]
pub(super) struct Bits {
    bytes: Vec<u8>,
    /// The last `count` bits are not yet bytes.
    pending: u64,
    /// Below 32 between calls.
    count: u32,
}

impl Bits {
    /// Appends the low `length` bits of `code`, at most 32; the others must be 0.
    pub(super) fn put(&mut self, code: u32, length: u32) {
        self.pending = self.pending << length | u64::from(code);
        self.count += length;
        if self.count >= 32 {
            self.count -= 32;
            let [.., a, b, c, d] = (self.pending >> self.count).to_be_bytes();
            self.write([a, b, c, d]);
        }
    }

    /// Fills the last byte with ones (T.81, F.1.2.3) and gives all of them.
    pub(super) fn finish(mut self) -> Vec<u8> {
        let padding = self.count.wrapping_neg() % 8;
        self.pending = self.pending << padding | ((1 << padding) - 1);
        self.count += padding;
        while self.count > 0 {
            self.count -= 8;
            let byte = (self.pending >> self.count).to_le_bytes()[0];
            self.stuff(byte);
        }
        self.bytes
    }

    fn write(&mut self, bytes: [u8; 4]) {
        if bytes.contains(&0xFF) {
            bytes.into_iter().for_each(|byte| self.stuff(byte));
        } else {
            self.bytes.extend(bytes);
        }
    }

    /// A zero behind it tells 0xFF from a marker (T.81, B.1.1.5).
    fn stuff(&mut self, byte: u8) {
        self.bytes.push(byte);
        if byte == 0xFF {
            self.bytes.push(0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_lie_one_behind_the_other() {
        let mut bits = Bits::default();
        bits.put(0b101, 3);
        bits.put(0, 0);
        bits.put(0b1_1111, 5);
        bits.put(0xABCD_EF01, 32);
        bits.put(0b10, 2);
        assert_eq!(bits.finish(), [0b1011_1111, 0xAB, 0xCD, 0xEF, 0x01, 0b1011_1111]);
        assert!(Bits::default().finish().is_empty());
    }

    #[test]
    fn no_byte_looks_like_a_marker() {
        let mut bits = Bits::default();
        (0..9).for_each(|_| bits.put(0xFF, 8));
        assert_eq!(bits.finish(), [0xFF, 0].repeat(9));
    }
}
