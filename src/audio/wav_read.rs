//! Reads WAV files with any number of channels to mono.

use std::io::{self, BufReader};
use std::path::Path;

use hound::{SampleFormat, WavReader};

use super::{AudioError, check_rate};
use crate::file_input::{InputError, InputFile};
use crate::resample::length_after;

/// Maximum size of a WAV file in bytes: [`MOST_SAMPLES`] in stereo, 32 bits each.
const LARGEST_FILE: u64 = 2 * 4 * MOST_SAMPLES;

/// Maximum samples of a clip, in the file or after resampling: 128 MiB of memory, 11 minutes at 48
/// kHz.
const MOST_SAMPLES: u64 = 1 << 25;

/// The largest magnitude of a sample to be resampled, where 1 is full scale. Float files made from 32-bit integers
/// contain samples of this magnitude. The sums over the filter stay far below overflow; the resampler panics if they
/// are not finite.
const LOUDEST: f32 = 2_147_483_648.0;

/// A WAV file's sound at its own rate; never empty, always finite.
pub(super) struct MonoWav {
    pub(super) samples: Vec<f32>,
    pub(super) rate_hz: u32,
}

type Reader = WavReader<BufReader<InputFile>>;

/// Reads a sound for playback at `to_hz`.
pub(super) fn read_mono(path: &Path, to_hz: u32) -> Result<MonoWav, AudioError> {
    let (reader, file_bytes) = open(path)?;
    let spec = reader.spec();
    if check_rate(spec.sample_rate).is_err() {
        return Err(unsupported(
            path,
            format!("sound at {} Hz", spec.sample_rate),
        ));
    }
    check_length(path, &reader, file_bytes, to_hz)?;
    let rate_hz = spec.sample_rate;
    let loudest = if rate_hz == to_hz { f32::MAX } else { LOUDEST };
    let samples = read_samples(reader, path, loudest)?;
    if samples.is_empty() {
        return Err(AudioError::EmptyWav { path: path.into() });
    }
    Ok(MonoWav { samples, rate_hz })
}

/// The reader, positioned after the file's header, and the file's length in bytes.
fn open(path: &Path) -> Result<(Reader, u64), AudioError> {
    let cannot_open = |source| AudioError::OpenWav {
        path: path.into(),
        source,
    };
    let file = InputFile::open(path, LARGEST_FILE).map_err(cannot_open)?;
    let bytes = file.length();
    let reader = WavReader::new(BufReader::new(file)).map_err(|error| match error {
        hound::Error::IoError(source) if !is_short(&source) => {
            cannot_open(InputError::from_reading(source))
        }
        hound::Error::Unsupported => unsupported(path, "an encoding that is not plain PCM".into()),
        // The reader recognises a WAV file, but does not support this sample width.
        hound::Error::FormatError(reason) if reason.starts_with("bits per sample") => {
            unsupported(path, format!("samples of an unsupported width ({reason})"))
        }
        source => AudioError::NotWav {
            path: path.into(),
            source,
        },
    })?;
    Ok((reader, bytes))
}

/// Rejects files that would not fit into memory, based only on the header and the file's length.
fn check_length(
    path: &Path,
    reader: &Reader,
    file_bytes: u64,
    to_hz: u32,
) -> Result<(), AudioError> {
    let spec = reader.spec();
    // A header may state more data than the file contains. Reading then ends at the file's end. A sample takes at least
    // one byte.
    let channels = u64::from(spec.channels);
    let frames = u64::from(reader.duration()).min(file_bytes / channels);
    let after = length_after(frames as usize, spec.sample_rate, to_hz) as u64;
    let needed = frames.max(after);
    if needed <= MOST_SAMPLES {
        return Ok(());
    }
    Err(AudioError::LongWav {
        path: path.into(),
        frames,
        channels: spec.channels,
        rate_hz: spec.sample_rate,
        needed,
        to_hz,
        limit: MOST_SAMPLES,
    })
}

/// Whether the file is shorter than its header states; the WAV reader reports this as "other".
fn is_short(error: &io::Error) -> bool {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => true,
        io::ErrorKind::Other => !error
            .get_ref()
            .is_some_and(|inner| inner.is::<InputError>()),
        _ => false,
    }
}

fn unsupported(path: &Path, found: String) -> AudioError {
    AudioError::UnsupportedWav {
        path: path.into(),
        found,
    }
}

/// The mean of the channels, sample by sample, scaled so that full scale is 1.
fn read_samples(reader: Reader, path: &Path, loudest: f32) -> Result<Vec<f32>, AudioError> {
    let spec = reader.spec();
    let channels = spec.channels.into();
    match (spec.sample_format, spec.bits_per_sample) {
        (SampleFormat::Float, 32) => {
            let read = reader.into_samples::<f32>();
            mean_of_channels(read, channels, path, |index, sample| {
                check_sample(path, index, sample, loudest)
            })
        }
        (SampleFormat::Int, bits @ (8 | 16 | 24 | 32)) => {
            let full_scale = f64::from(bits - 1).exp2();
            let read = reader.into_samples::<i32>();
            mean_of_channels(read, channels, path, |_, sample| {
                Ok((f64::from(sample) / full_scale) as f32)
            })
        }
        (SampleFormat::Float, bits) => Err(unsupported(path, format!("{bits}-bit float samples"))),
        (SampleFormat::Int, bits) => Err(unsupported(path, format!("{bits}-bit integer samples"))),
    }
}

/// Sums each frame in `f64`, so that no sum overflows, and stores only the means. Drops an incomplete last frame.
fn mean_of_channels<S>(
    read: impl Iterator<Item = hound::Result<S>>,
    channels: usize,
    path: &Path,
    scale: impl Fn(u64, S) -> Result<f32, AudioError>,
) -> Result<Vec<f32>, AudioError> {
    let mut means = Vec::new();
    let (mut sum, mut summed) = (0.0, 0);
    for (index, sample) in read.enumerate() {
        let index = index as u64;
        let sample = sample.map_err(|source| damaged(path, index, source))?;
        sum += f64::from(scale(index, sample)?);
        summed += 1;
        if summed == channels {
            means.push((sum / channels as f64) as f32);
            (sum, summed) = (0.0, 0);
        }
    }
    Ok(means)
}

fn damaged(path: &Path, sample: u64, source: hound::Error) -> AudioError {
    match source {
        hound::Error::Unsupported => unsupported(path, "an unsupported packing of samples".into()),
        source => AudioError::DamagedWav {
            path: path.into(),
            sample,
            source,
        },
    }
}

fn check_sample(path: &Path, index: u64, sample: f32, loudest: f32) -> Result<f32, AudioError> {
    if !sample.is_finite() {
        return Err(AudioError::NonFiniteSample {
            path: path.into(),
            sample: index,
        });
    }
    if sample.abs() > loudest {
        return Err(AudioError::LoudSample {
            path: path.into(),
            sample: index,
            value: sample,
            limit: loudest,
        });
    }
    Ok(sample)
}
