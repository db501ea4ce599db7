//! Convolution in blocks: uniformly partitioned, by overlap and save (T. G. Stockham, *High-speed
//! convolution and correlation*, AFIPS 1966; G. García, *Optimal filter partition for efficient
//! convolution with short input/output delay*, AES 113, 2002).
//!
//! The spectra of a signal's newest blocks are stored. The convolution of a block with a kernel takes one
//! multiplication for each partition of the kernel, and one inverse transform.
//!
//! The octave-band filters are such kernels: zero-phase filters that split a signal into bands. Scaling each band
//! separately then has the same effect on the signal as [`ImpulseResponse`](crate::response::ImpulseResponse) has on a
//! tap.

use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use crate::bands::BAND_COUNT;
use crate::response::tap_filter_gain;

/// Samples per block: 10.7 ms at 48 kHz. A kernel of one second then has 94 partitions. Half the block length would
/// halve the delay and double the work.
pub(super) const BLOCK: usize = 512;

/// Length in samples of a transform, and the size of its spectrum.
const TRANSFORM: usize = 2 * BLOCK;
const BINS: usize = BLOCK + 1;

/// A spectrum, with real and imaginary parts in separate rows so that products of whole rows are vectorised.
#[derive(Clone)]
struct Spectrum {
    real: [f32; BINS],
    imaginary: [f32; BINS],
}

impl Spectrum {
    const SILENT: Spectrum = Spectrum {
        real: [0.0; BINS],
        imaginary: [0.0; BINS],
    };

    fn set(&mut self, values: &[Complex<f32>]) {
        for (bin, value) in values.iter().enumerate() {
            self.real[bin] = value.re;
            self.imaginary[bin] = value.im;
        }
    }

    /// Adds the product of two spectra.
    fn add_product(&mut self, a: &Spectrum, b: &Spectrum) {
        for bin in 0..BINS {
            self.real[bin] += a.real[bin] * b.real[bin] - a.imaginary[bin] * b.imaginary[bin];
            self.imaginary[bin] += a.real[bin] * b.imaginary[bin] + a.imaginary[bin] * b.real[bin];
        }
    }
}

/// Responses of several channels to one signal, as spectra of their partitions. The default kernel is silent and owns
/// no memory.
#[derive(Clone, Default)]
pub(super) struct Kernel {
    channels: Vec<Vec<Spectrum>>,
}

impl Kernel {
    /// Creates a kernel from the samples of each channel.
    pub fn new(channels: &[Vec<f32>]) -> Kernel {
        let forward = RealFftPlanner::new().plan_fft_forward(TRANSFORM);
        let mut spectrum = forward.make_output_vec();
        let mut partition = |samples: &[f32]| {
            let mut padded = [0.0; TRANSFORM];
            padded[..samples.len()].copy_from_slice(samples);
            let done = forward.process(&mut padded, &mut spectrum);
            debug_assert!(done.is_ok(), "the buffers are as long as the plan's");
            let mut partition = Spectrum::SILENT;
            partition.set(&spectrum);
            partition
        };
        let partitions = |samples: &Vec<f32>| {
            samples
                .chunks(BLOCK)
                .map(&mut partition)
                .collect::<Vec<_>>()
        };
        Kernel {
            channels: channels.iter().map(partitions).collect(),
        }
    }

    /// Number of partitions of the longest channel.
    pub fn partitions(&self) -> usize {
        self.channels.iter().map(Vec::len).max().unwrap_or(0)
    }
}

impl fmt::Debug for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Kernel")
            .field("channels", &self.channels.len())
            .field("partitions", &self.partitions())
            .finish()
    }
}

/// The newest blocks of a signal, to be convolved with kernels.
pub(super) struct Signal {
    forward: Arc<dyn RealToComplex<f32>>,
    inverse: Arc<dyn ComplexToReal<f32>>,
    /// The previous block, then the newest.
    newest: [f32; TRANSFORM],
    /// Spectra of the newest blocks, as a ring.
    spectra: Vec<Spectrum>,
    /// Ring index of the newest block's spectrum.
    at: usize,
    sum: Spectrum,
    samples: Vec<f32>,
    values: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
}

impl Signal {
    /// Creates a silent signal, for kernels of at most `partitions` partitions.
    pub fn new(partitions: usize) -> Signal {
        let mut planner = RealFftPlanner::new();
        let forward = planner.plan_fft_forward(TRANSFORM);
        let inverse = planner.plan_fft_inverse(TRANSFORM);
        let scratch = forward.get_scratch_len().max(inverse.get_scratch_len());
        Signal {
            newest: [0.0; TRANSFORM],
            spectra: vec![Spectrum::SILENT; partitions.max(1)],
            at: 0,
            sum: Spectrum::SILENT,
            samples: forward.make_input_vec(),
            values: forward.make_output_vec(),
            scratch: vec![Complex::default(); scratch],
            forward,
            inverse,
        }
    }

    /// Adds the next block. Does not allocate.
    pub fn push(&mut self, block: &[f32; BLOCK]) {
        self.newest.copy_within(BLOCK.., 0);
        self.newest[BLOCK..].copy_from_slice(block);
        self.samples.copy_from_slice(&self.newest);
        let done = self.forward.process_with_scratch(
            &mut self.samples,
            &mut self.values,
            &mut self.scratch,
        );
        debug_assert!(done.is_ok(), "the buffers are as long as the plan's");
        self.at = (self.at + 1) % self.spectra.len();
        self.spectra[self.at].set(&self.values);
    }

    /// Convolves the newest block with one channel of a kernel. Partitions beyond the stored blocks are ignored. Does
    /// not allocate.
    pub fn convolve(&mut self, kernel: &Kernel, channel: usize, out: &mut [f32; BLOCK]) {
        let partitions = kernel.channels.get(channel).map_or(&[][..], Vec::as_slice);
        if partitions.is_empty() {
            out.fill(0.0);
            return;
        }
        let kept = self.spectra.len();
        self.sum = Spectrum::SILENT;
        for (age, partition) in partitions.iter().take(kept).enumerate() {
            let block = &self.spectra[(self.at + kept - age) % kept];
            self.sum.add_product(block, partition);
        }
        for (bin, value) in self.values.iter_mut().enumerate() {
            *value = Complex::new(self.sum.real[bin], self.sum.imaginary[bin]);
        }
        // The first and the last value of a real signal's spectrum are real. Rounding may leave an imaginary part,
        // which the transform would reject.
        self.values[0].im = 0.0;
        self.values[BINS - 1].im = 0.0;
        let done = self.inverse.process_with_scratch(
            &mut self.values,
            &mut self.samples,
            &mut self.scratch,
        );
        debug_assert!(done.is_ok(), "the spectrum is that of a real signal");
        for (out, sample) in out.iter_mut().zip(&self.samples[BLOCK..]) {
            *out = sample / TRANSFORM as f32;
        }
    }
}

impl fmt::Debug for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Signal")
            .field("partitions", &self.spectra.len())
            .finish_non_exhaustive()
    }
}

/// Delay of the split signal in samples: the reach of the filters to either side (21 ms at 48 kHz). This reach is too
/// short if the energies of 63 Hz and 125 Hz differ by 20 dB: the weaker band is then up to 0.7 dB off. From 250 Hz on
/// the error is 0.05 dB.
pub(super) const FILTER_DELAY: usize = 2 * BLOCK;

/// The share of [`FILTER_DELAY`] within which the filters are not tapered.
const FLAT: f64 = 0.75;

/// Length of a filter in samples.
const FILTER_LENGTH: usize = 2 * FILTER_DELAY;

/// Number of partitions of the filters.
pub(super) const FILTER_PARTITIONS: usize = FILTER_LENGTH / BLOCK;

/// The filters of all bands, one channel each.
pub(super) fn octave_filters(rate_hz: u32) -> Kernel {
    let filters: Vec<Vec<f32>> = (0..BAND_COUNT)
        .map(|band| filter(band, rate_hz.into()))
        .collect();
    Kernel::new(&filters)
}

/// The filter of a band: its zero-phase response, delayed, truncated and windowed.
fn filter(band: usize, rate_hz: f64) -> Vec<f32> {
    // Long enough to keep the truncated part from wrapping around.
    let length = 8 * FILTER_LENGTH;
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(length);
    let mut spectrum = inverse.make_input_vec();
    for (bin, value) in spectrum.iter_mut().enumerate() {
        *value = tap_filter_gain(band, bin as f64 * rate_hz / length as f64).into();
    }
    let mut samples = inverse.make_output_vec();
    let done = inverse.process(&mut spectrum, &mut samples);
    debug_assert!(done.is_ok(), "the spectrum is that of a real signal");
    let sample = |index: usize| {
        let offset = index as f64 - FILTER_DELAY as f64;
        let from_zero = (index + length - FILTER_DELAY) % length;
        let beyond = (offset.abs() / FILTER_DELAY as f64 - FLAT).max(0.0) / (1.0 - FLAT);
        let fade = 0.5 + 0.5 * (PI * beyond).cos();
        (samples[from_zero] / length as f64 * fade) as f32
    };
    (0..FILTER_LENGTH).map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{hash, unit_interval};

    fn noise(seed: u64, count: usize) -> Vec<f32> {
        let sample = |index| unit_interval(hash(hash(seed) ^ index)) as f32 - 0.5;
        (0..count as u64).map(sample).collect()
    }

    /// Protects every sample of a convolution, which is compared with the sum of products: with kernels shorter than a
    /// block, kernels of several blocks, and channels of different lengths.
    #[test]
    fn blocks_are_convolved_as_a_whole_signal_is() {
        let kernels = [noise(1, 3 * BLOCK + 7), noise(2, 90)];
        let kernel = Kernel::new(&kernels);
        assert_eq!(kernel.partitions(), 4);
        let input = noise(3, 9 * BLOCK);
        let mut signal = Signal::new(kernel.partitions());
        for (number, block) in input.as_chunks::<BLOCK>().0.iter().enumerate() {
            signal.push(block);
            for (channel, samples) in kernels.iter().enumerate() {
                let mut out = [0.0; BLOCK];
                signal.convolve(&kernel, channel, &mut out);
                for (index, out) in out.iter().enumerate() {
                    let at = number * BLOCK + index;
                    let terms = samples.iter().enumerate().take(at + 1);
                    let sum: f64 = terms
                        .map(|(age, h)| f64::from(*h) * f64::from(input[at - age]))
                        .sum();
                    // The tolerance for 1,500 products of `f32` numbers below one half.
                    assert!((f64::from(*out) - sum).abs() < 1e-4, "{at}: {out} {sum}");
                }
            }
        }
    }
}
