//! WAV files out: written beside the target, then renamed.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use hound::{SampleFormat, WavSpec};

use super::{AudioError, SAMPLE_RATE};
#[cfg(feature = "audio")]
use crate::file_output::visible_part_beside;
use crate::file_output::{PartFile, followed, temporary_beside};

/// Bytes of a sample.
const SAMPLE_BYTES: u64 = 4;

/// A WAV file counts its bytes in 32 bits, its header's included; this leaves room for that.
const MAX_BYTES: u64 = u32::MAX as u64 - 1024;

/// The channels of what is panned: left and right.
const STEREO: u16 = 2;

/// Writes a WAV file of 32-bit float samples, in stereo up to 3.1 hours at [`SAMPLE_RATE`].
///
/// The sound goes to a temporary file in the target's directory, which takes the target's name
/// in [`finish`](Self::finish). Until then an older file of that name stays whole, and a writer
/// that is dropped without it leaves nothing behind.
#[derive(Debug)]
pub struct WavWriter {
    target: PathBuf,
    rate_hz: u32,
    channels: u16,
    // Dropped in this order: the sound's end is written before the file goes.
    wav: Wav,
    temporary: PartFile,
    frames: u64,
}

/// Makes a temporary file beside another.
type Beside = fn(&Path) -> io::Result<PartFile>;

/// `hound`'s writer has no `Debug`.
struct Wav(hound::WavWriter<BufWriter<File>>);

impl std::fmt::Debug for Wav {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wav")
            .field("frames", &self.0.duration())
            .finish()
    }
}

impl WavWriter {
    /// Starts a stereo file at [`SAMPLE_RATE`] that will replace `target`, whose directory must exist.
    ///
    /// # Errors
    /// [`AudioError::WriteWav`] if nothing can be written beside `target`.
    pub fn create(target: impl Into<PathBuf>) -> Result<Self, AudioError> {
        Self::create_at(target, SAMPLE_RATE)
    }

    /// As [`create`](Self::create), at `rate_hz` samples a second.
    ///
    /// # Errors
    /// Also [`AudioError::BadSampleRate`] if `rate_hz` is outside
    /// [`SAMPLE_RATES`](super::SAMPLE_RATES).
    pub fn create_at(target: impl Into<PathBuf>, rate_hz: u32) -> Result<Self, AudioError> {
        Self::start(target.into(), rate_hz, STEREO, temporary_beside)
    }

    /// As [`create_at`](Self::create_at), with so many channels: 1, 2, or 4 of first-order
    /// ambisonics.
    ///
    /// # Errors
    /// As [`create_at`](Self::create_at).
    pub fn create_with_channels(
        target: impl Into<PathBuf>,
        rate_hz: u32,
        channels: u16,
    ) -> Result<Self, AudioError> {
        Self::start(target.into(), rate_hz, channels, temporary_beside)
    }

    /// As [`create_at`](Self::create_at), for a sound that comes as it is heard: the temporary
    /// file's name is not hidden, so that it is found if the program is interrupted.
    #[cfg(feature = "audio")]
    pub(super) fn record_at(target: &Path, rate_hz: u32) -> Result<Self, AudioError> {
        Self::start(target.to_owned(), rate_hz, STEREO, visible_part_beside)
    }

    fn start(
        target: PathBuf,
        rate_hz: u32,
        channels: u16,
        beside: Beside,
    ) -> Result<Self, AudioError> {
        super::rate::check_rate(rate_hz)?;
        let target = followed(&target);
        match start(&target, rate_hz, channels, beside) {
            Ok((temporary, wav)) => Ok(Self {
                target,
                rate_hz,
                channels,
                wav: Wav(wav),
                temporary,
                frames: 0,
            }),
            Err(source) => Err(write_error(&target, source)),
        }
    }

    /// Appends interleaved samples (left, right, left …); 1 is full scale, and more is kept.
    ///
    /// # Errors
    /// [`AudioError::WriteWav`] if the disk rejects, [`AudioError::WavTooLong`] past 4 GiB.
    ///
    /// # Panics
    /// If the samples are no whole number of frames.
    pub fn write(&mut self, interleaved: &[f32]) -> Result<(), AudioError> {
        let channels = usize::from(self.channels);
        assert!(
            interleaved.len().is_multiple_of(channels),
            "samples come in frames of {channels}"
        );
        let frames = self.frames + (interleaved.len() / channels) as u64;
        let limit = MAX_BYTES / (SAMPLE_BYTES * u64::from(self.channels));
        if frames > limit {
            return Err(AudioError::WavTooLong {
                path: self.target.clone(),
                limit_s: limit / u64::from(self.rate_hz),
            });
        }
        for &sample in interleaved {
            self.wav
                .0
                .write_sample(sample)
                .map_err(|error| write_error(&self.target, wav_to_io(error)))?;
        }
        self.frames = frames;
        Ok(())
    }

    /// Makes the temporary file playable as far as it is.
    #[cfg(feature = "audio")]
    pub(super) fn flush(&mut self) -> Result<(), AudioError> {
        let flushed = self.wav.0.flush();
        flushed.map_err(|error| write_error(&self.target, wav_to_io(error)))
    }

    /// Completes the file and gives it the target's name, replacing an older one.
    ///
    /// # Errors
    /// [`AudioError::WriteWav`] if the disk rejects; the target is then as it was before.
    pub fn finish(self) -> Result<(), AudioError> {
        let Self {
            target,
            wav,
            temporary,
            ..
        } = self;
        wav.0
            .finalize()
            .map_err(|error| write_error(&target, wav_to_io(error)))?;
        temporary
            .persist(&target)
            .map_err(|error| write_error(&target, error))
    }
}

fn start(
    target: &Path,
    rate_hz: u32,
    channels: u16,
    beside: Beside,
) -> io::Result<(PartFile, hound::WavWriter<BufWriter<File>>)> {
    let temporary = beside(target)?;
    let file = BufWriter::new(temporary.reopen()?);
    let spec = WavSpec {
        channels,
        sample_rate: rate_hz,
        bits_per_sample: 32,
        sample_format: SampleFormat::Float,
    };
    let wav = hound::WavWriter::new(file, spec).map_err(wav_to_io)?;
    Ok((temporary, wav))
}

/// The error of `hound` as an error of the system.
pub(crate) fn wav_to_io(error: hound::Error) -> io::Error {
    match error {
        hound::Error::IoError(error) => error,
        other => io::Error::other(other),
    }
}

fn write_error(target: &Path, source: io::Error) -> AudioError {
    AudioError::WriteWav {
        path: target.into(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects long files: up to the last frame that a header can count all is written, and nothing past it, whether
    /// it is missed by one frame or by more.
    #[test]
    fn a_file_is_full_at_the_last_frame_that_its_header_can_count() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = WavWriter::create(folder.path().join("long.wav")).unwrap();
        let limit = MAX_BYTES / (2 * SAMPLE_BYTES);
        // As if so many had been written.
        writer.frames = limit - 2;
        for too_long in [6, 8] {
            let refused = writer.write(&vec![0.0; too_long]);
            assert!(matches!(refused, Err(AudioError::WavTooLong { .. })));
        }
        writer.write(&[0.0; 4]).unwrap();
        assert_eq!(writer.frames, limit);
        writer.write(&[]).unwrap();
        assert!(writer.write(&[0.0; 2]).is_err());
    }
}
