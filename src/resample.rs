//! Resampling of a whole clip.

use rubato::{FftFixedInOut, Resampler};

/// Minimum length of the resampler's filter, in input samples. A longer filter loses a narrower band below half the
/// lower rate.
const LEAST_BLOCK: u32 = 1024;

/// Resamples a mono clip to `samples.len() · to_hz / from_hz` samples, rounded, and removes the filter's delay.
pub(crate) fn to_rate(samples: Vec<f32>, from_hz: u32, to_hz: u32) -> Result<Vec<f32>, String> {
    if from_hz == to_hz {
        return Ok(samples);
    }
    let block = block_for(from_hz, to_hz) as usize;
    let mut resampler = FftFixedInOut::<f32>::new(from_hz as usize, to_hz as usize, block, 1)
        .map_err(|error| error.to_string())?;
    let (length, delay) = (
        length_after(samples.len(), from_hz, to_hz),
        resampler.output_delay(),
    );
    let mut resampled = Vec::with_capacity(length + delay + resampler.output_frames_max());
    let mut blocks = samples.chunks(block).map(|block| [block]);
    while resampled.len() < length + delay {
        // The last block, and the blocks that flush the delay, are padded with silence.
        let next = blocks.next();
        let block = resampler.process_partial(next.as_ref().map(|block| &block[..]), None);
        resampled.extend(block.map_err(|error| error.to_string())?.concat());
    }
    resampled.drain(..delay);
    resampled.truncate(length);
    Ok(resampled)
}

/// The filter's length: an even number of whole periods of the two rates. The delay of a filter of odd length would lie
/// between two samples and could not be removed exactly.
fn block_for(from_hz: u32, to_hz: u32) -> u32 {
    let period = from_hz / greatest_common_divisor(from_hz, to_hz);
    2 * period * LEAST_BLOCK.div_ceil(2 * period)
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

/// The number of samples after resampling, rounded to the nearest.
pub(super) fn length_after(count: usize, from_hz: u32, to_hz: u32) -> usize {
    let (count, from, to) = (count as u128, u128::from(from_hz), u128::from(to_hz));
    ((count * to + from / 2) / from) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the sharpness of the filter, the removal of its delay, and the computing time: its length is the
    /// smallest even number of whole periods with at least the required number of samples.
    #[test]
    fn the_filter_has_the_least_even_number_of_periods_that_suffices() {
        for (from_hz, to_hz, period) in [
            (24_000, 48_000, 1),
            (96_000, 48_000, 2),
            (44_100, 48_000, 147),
            (48_000, 44_100, 160),
            (44_101, 48_000, 44_101),
        ] {
            let block = block_for(from_hz, to_hz);
            assert_eq!(block % (2 * period), 0, "{from_hz} to {to_hz} Hz");
            let enough = LEAST_BLOCK..LEAST_BLOCK + 2 * period;
            assert!(enough.contains(&block), "{from_hz} to {to_hz} Hz: {block}");
        }
    }
}
