//! FNV-1a with 64 bits: a hash of a sequence of numbers, the same on every machine.
//!
//! G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, *The FNV Non-Cryptographic Hash Algorithm*, IETF draft. The standard
//! algorithm takes bytes; here whole numbers are accepted as well.

/// The hash of an empty sequence.
pub const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// The hash with one more number appended.
pub fn with(hash: u64, number: u64) -> u64 {
    (hash ^ number).wrapping_mul(0x0000_0100_0000_01b3)
}

/// The hash of these bytes.
pub fn of_bytes(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(OFFSET, |hash, byte| with(hash, u64::from(*byte)))
}

#[cfg(test)]
mod tests {
    /// Protects fingerprints from wrong constants: the draft's test vectors.
    #[test]
    fn hashes_are_those_of_fnv_1a() {
        assert_eq!(super::of_bytes(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(super::of_bytes(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(super::of_bytes(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
