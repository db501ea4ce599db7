//! Sample rates.

use super::{AudioError, SAMPLE_RATES};

/// Rejects an unsupported sample rate.
pub(super) fn check_rate(sample_rate_hz: u32) -> Result<(), AudioError> {
    if SAMPLE_RATES.contains(&sample_rate_hz) {
        Ok(())
    } else {
        Err(AudioError::BadSampleRate { sample_rate_hz })
    }
}
