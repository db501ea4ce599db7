//! Floats seen as the bytes that GL takes and gives.

/// The floats as bytes in memory order.
pub(super) fn of_floats(floats: &[f32]) -> &[u8] {
    // SAFETY: f32 has no padding, u8 needs no alignment, and the length in bytes is that of the same slice.
    unsafe { std::slice::from_raw_parts(floats.as_ptr().cast(), size_of_val(floats)) }
}

/// The floats as bytes to be overwritten.
pub(super) fn of_floats_mut(floats: &mut [f32]) -> &mut [u8] {
    // SAFETY: as above; besides, every pattern of bits is an f32, so that any bytes may be written.
    unsafe { std::slice::from_raw_parts_mut(floats.as_mut_ptr().cast(), size_of_val(floats)) }
}
