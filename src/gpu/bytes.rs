//! Conversion between floats and the bytes that GL takes and returns.

use std::borrow::Cow;

/// The floats as bytes in memory order.
pub(super) fn of_floats(floats: &[f32]) -> &[u8] {
    // SAFETY: f32 has no padding, u8 needs no alignment, and the length in bytes is that of the same slice.
    unsafe { std::slice::from_raw_parts(floats.as_ptr().cast(), size_of_val(floats)) }
}

/// The floats as mutable bytes.
pub(super) fn of_floats_mut(floats: &mut [f32]) -> &mut [u8] {
    // SAFETY: as above; in addition, every bit pattern is a valid f32, so any bytes may be written.
    unsafe { std::slice::from_raw_parts_mut(floats.as_mut_ptr().cast(), size_of_val(floats)) }
}

/// Bytes in memory order as floats, without the incomplete float at the end; copied if the bytes are not aligned for
/// floats.
pub(super) fn as_floats(bytes: &[u8]) -> Cow<'_, [f32]> {
    // SAFETY: every bit pattern is a valid f32.
    match unsafe { bytes.align_to::<f32>() } {
        ([], floats, _) => Cow::Borrowed(floats),
        _ => bytes
            .as_chunks()
            .0
            .iter()
            .map(|four| f32::from_ne_bytes(*four))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects read-backs with drivers that map a buffer at any address.
    #[test]
    fn bytes_at_any_address_are_the_same_floats() {
        let floats = [1.5_f32, -2.0, 1e30];
        let aligned = as_floats(of_floats(&floats));
        assert!(matches!(aligned, Cow::Borrowed(_)));
        let mut shifted = [0; 16];
        let start = usize::from(shifted.as_ptr().addr() % 4 == 0);
        shifted[start..start + 12].copy_from_slice(of_floats(&floats));
        let unaligned = as_floats(&shifted[start..start + 12]);
        assert!(matches!(unaligned, Cow::Owned(_)));
        assert_eq!((&aligned[..], &unaligned[..]), (&floats[..], &floats[..]));
    }
}
