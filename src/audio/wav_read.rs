//! WAV files in: any channel count to mono.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use hound::{SampleFormat, WavReader};

use super::AudioError;
use super::sound::check_rate;

/// A WAV file's sound at its own rate; never empty, always finite.
pub(super) struct MonoWav {
    pub(super) samples: Vec<f32>,
    pub(super) rate_hz: u32,
}

type Reader = WavReader<BufReader<File>>;

pub(super) fn read_mono(path: &Path) -> Result<MonoWav, AudioError> {
    let reader = open(path)?;
    let spec = reader.spec();
    if check_rate(spec.sample_rate).is_err() {
        return Err(unsupported(
            path,
            format!("sound at {} Hz", spec.sample_rate),
        ));
    }
    let samples = read_interleaved(reader, path)?;
    if samples.is_empty() {
        return Err(AudioError::EmptyWav { path: path.into() });
    }
    Ok(MonoWav {
        samples: mean_of_channels(&samples, spec.channels),
        rate_hz: spec.sample_rate,
    })
}

fn open(path: &Path) -> Result<Reader, AudioError> {
    let cannot_open = |source| AudioError::OpenWav {
        path: path.into(),
        source,
    };
    let file = File::open(path).map_err(cannot_open)?;
    WavReader::new(BufReader::new(file)).map_err(|error| match error {
        hound::Error::IoError(source) if !is_short(&source) => cannot_open(source),
        hound::Error::Unsupported => unsupported(path, "an encoding that is not plain PCM".into()),
        // The reader knows that it is a WAV file, but not this width of sample.
        hound::Error::FormatError(reason) if reason.starts_with("bits per sample") => {
            unsupported(path, format!("samples of an unread width ({reason})"))
        }
        source => AudioError::NotWav {
            path: path.into(),
            source,
        },
    })
}

/// Whether the file ended before its header did; the WAV reader reports that as "other".
fn is_short(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::UnexpectedEof | io::ErrorKind::Other
    )
}

fn unsupported(path: &Path, found: String) -> AudioError {
    AudioError::UnsupportedWav {
        path: path.into(),
        found,
    }
}

/// All channels' samples, as they stand in the file, scaled so that full scale is 1.
fn read_interleaved(reader: Reader, path: &Path) -> Result<Vec<f32>, AudioError> {
    let spec = reader.spec();
    match (spec.sample_format, spec.bits_per_sample) {
        (SampleFormat::Float, 32) => {
            let samples = collect(reader.into_samples::<f32>(), path, |sample| sample)?;
            check_finite(&samples, path)?;
            Ok(samples)
        }
        (SampleFormat::Int, bits @ (8 | 16 | 24 | 32)) => {
            let full_scale = f64::from(bits - 1).exp2();
            collect(reader.into_samples::<i32>(), path, |sample| {
                (f64::from(sample) / full_scale) as f32
            })
        }
        (SampleFormat::Float, bits) => Err(unsupported(path, format!("{bits}-bit float samples"))),
        (SampleFormat::Int, bits) => Err(unsupported(path, format!("{bits}-bit integer samples"))),
    }
}

fn collect<S>(
    read: impl Iterator<Item = hound::Result<S>>,
    path: &Path,
    scale: impl Fn(S) -> f32,
) -> Result<Vec<f32>, AudioError> {
    let mut samples = Vec::new();
    for sample in read {
        let sample = sample.map_err(|source| damaged(path, samples.len() as u64, source))?;
        samples.push(scale(sample));
    }
    Ok(samples)
}

fn damaged(path: &Path, sample: u64, source: hound::Error) -> AudioError {
    match source {
        hound::Error::Unsupported => unsupported(path, "an uncommon packing of samples".into()),
        source => AudioError::DamagedWav {
            path: path.into(),
            sample,
            source,
        },
    }
}

fn check_finite(samples: &[f32], path: &Path) -> Result<(), AudioError> {
    match samples.iter().position(|sample| !sample.is_finite()) {
        None => Ok(()),
        Some(index) => Err(AudioError::NonFiniteSample {
            path: path.into(),
            sample: index as u64,
        }),
    }
}

/// The channels' mean, sample by sample, summed in `f64` so that no sum overflows.
fn mean_of_channels(samples: &[f32], channels: u16) -> Vec<f32> {
    let mean = |frame: &[f32]| {
        let sum: f64 = frame.iter().copied().map(f64::from).sum();
        (sum / f64::from(channels)) as f32
    };
    samples.chunks_exact(channels.into()).map(mean).collect()
}
