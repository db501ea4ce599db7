//! Writes WAV files: first to a temporary file in the target's directory, which is then renamed.
//!
//! The header is for 32-bit float samples (Microsoft, *New Multimedia Data Types and Data Techniques*, 1994).
//!
//! Samples other than PCM need a `fmt` chunk with the length of its extension, and a `fact` chunk with the number of
//! frames; without these, other programs report a file as incomplete. `WAVE_FORMAT_EXTENSIBLE` is not used: it would
//! add the loudspeaker positions of the channels, which ambisonic channels lack, and SoX reports such a file with float
//! samples as incomplete.

use super::{AudioError, Sound, check_rate};
#[cfg(feature = "live")]
use crate::file_output::visible_part_beside;
use crate::file_output::{PartFile, followed, temporary_beside};
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A WAV file counts its bytes, including its header, in 32 bits; this limit leaves room for the header.
const MAX_BYTES: u64 = u32::MAX as u64 - 1024;

/// The channels of a panned sound: left and right.
const STEREO: u16 = 2;

/// Maximum channels of a file: first-order ambisonics has four, the most of any format used here.
const MOST_CHANNELS: u16 = 64;

/// Writes a WAV file of 32-bit float samples, in stereo up to 3.1 hours at [`Sound::SAMPLE_RATE`].
///
/// The sound goes to a temporary file in the target's directory, which [`finish`](Self::finish) renames to the target.
/// Until then an older file at the target stays unchanged. If the writer is dropped without `finish`, the temporary
/// file is removed.
#[derive(Debug)]
pub struct WavWriter {
    target: PathBuf,
    rate_hz: u32,
    channels: u16,
    // Field order matters: the file is closed before it is removed.
    wav: BufWriter<File>,
    temporary: PartFile,
    frames: u64,
}

/// Creates a temporary file in the directory of another file.
type Beside = fn(&Path) -> io::Result<PartFile>;

impl WavWriter {
    /// Starts a stereo file at [`Sound::SAMPLE_RATE`] that will replace `target`, whose directory must exist.
    ///
    /// # Errors
    /// [`AudioError::WriteWav`] if the target's directory is not writable.
    pub fn create(target: impl Into<PathBuf>) -> Result<Self, AudioError> {
        Self::create_at(target, Sound::SAMPLE_RATE)
    }

    /// Like [`create`](Self::create), at `rate_hz` samples per second.
    ///
    /// # Errors
    /// The errors of [`create`](Self::create), and [`AudioError::BadSampleRate`] if `rate_hz` is outside
    /// [`Sound::SAMPLE_RATES`].
    pub fn create_at(target: impl Into<PathBuf>, rate_hz: u32) -> Result<Self, AudioError> {
        Self::start(target.into(), rate_hz, STEREO, temporary_beside)
    }

    /// Like [`create_at`](Self::create_at), with `channels` channels: 1, 2, or 4 for first-order ambisonics.
    ///
    /// # Errors
    /// The errors of [`create_at`](Self::create_at); [`AudioError::BadChannels`] for 0 channels, and for more than 64.
    pub fn create_with_channels(
        target: impl Into<PathBuf>,
        rate_hz: u32,
        channels: u16,
    ) -> Result<Self, AudioError> {
        Self::start(target.into(), rate_hz, channels, temporary_beside)
    }

    /// Like [`create_at`](Self::create_at), for a sound written during playback: the temporary file is not hidden, so
    /// that users find it if the program is interrupted.
    #[cfg(feature = "live")]
    pub(super) fn record_at(target: &Path, rate_hz: u32) -> Result<Self, AudioError> {
        Self::start(target.to_owned(), rate_hz, STEREO, visible_part_beside)
    }

    fn start(
        target: PathBuf,
        rate_hz: u32,
        channels: u16,
        beside: Beside,
    ) -> Result<Self, AudioError> {
        check_rate(rate_hz)?;
        if !(1..=MOST_CHANNELS).contains(&channels) {
            let limit = MOST_CHANNELS;
            return Err(AudioError::BadChannels { channels, limit });
        }
        let target = followed(&target);
        let start = || {
            let temporary = beside(&target)?;
            let mut wav = BufWriter::new(temporary.writer()?);
            wav.write_all(&header(channels, rate_hz, 0))?;
            Ok((temporary, wav))
        };
        let (temporary, wav) = start().map_err(|source| write_error(&target, source))?;
        Ok(Self {
            target,
            rate_hz,
            channels,
            wav,
            temporary,
            frames: 0,
        })
    }

    /// Appends interleaved samples (left, right, left …); 1 is full scale, and larger values are kept.
    ///
    /// # Errors
    /// [`AudioError::WriteWav`] if writing to the disk fails, [`AudioError::WavTooLong`] past 4 GiB, and
    /// [`AudioError::CutFrame`] if the samples are not a whole number of frames. In the last two cases nothing is
    /// written.
    pub fn write(&mut self, interleaved: &[f32]) -> Result<(), AudioError> {
        let channels = usize::from(self.channels);
        if !interleaved.len().is_multiple_of(channels) {
            return Err(AudioError::CutFrame {
                path: self.target.clone(),
                samples: interleaved.len(),
                channels: self.channels,
            });
        }
        let frames = self.frames + (interleaved.len() / channels) as u64;
        let limit = MAX_BYTES / u64::from(SAMPLE_BYTES * u32::from(self.channels));
        if frames > limit {
            return Err(AudioError::WavTooLong {
                path: self.target.clone(),
                limit_s: limit / u64::from(self.rate_hz),
            });
        }
        for &sample in interleaved {
            self.wav
                .write_all(&sample.to_le_bytes())
                .map_err(|error| write_error(&self.target, error))?;
        }
        self.frames = frames;
        Ok(())
    }

    /// Makes the temporary file playable up to the last written sample.
    #[cfg(feature = "live")]
    pub(super) fn flush(&mut self) -> Result<(), AudioError> {
        self.complete()
            .map_err(|error| write_error(&self.target, error))
    }

    /// Flushes pending samples and writes the header for the current number of frames.
    fn complete(&mut self) -> io::Result<()> {
        // The number of frames fits into a header: `write` rejects more.
        let head = header(self.channels, self.rate_hz, self.frames as u32);
        self.wav.seek(SeekFrom::Start(0))?;
        self.wav.write_all(&head)?;
        self.wav.seek(SeekFrom::End(0))?;
        self.wav.flush()
    }

    /// Completes the file and renames it to the target, replacing an older file.
    ///
    /// # Errors
    /// [`AudioError::WriteWav`] if writing to the disk fails; the target is then unchanged.
    pub fn finish(mut self) -> Result<(), AudioError> {
        let completed = self.complete();
        let Self {
            target,
            wav,
            temporary,
            ..
        } = self;
        completed.map_err(|error| write_error(&target, error))?;
        drop(wav);
        temporary
            .persist(&target)
            .map_err(|error| write_error(&target, error))
    }
}

/// Converts an error of `hound` to an I/O error.
pub fn wav_to_io(error: hound::Error) -> io::Error {
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

/// Bytes of a sample.
pub(super) const SAMPLE_BYTES: u32 = 4;

/// `WAVE_FORMAT_IEEE_FLOAT`.
const FLOAT: u16 = 3;

/// The bytes before the first sample of a file with `frames` frames.
pub(super) fn header(channels: u16, rate_hz: u32, frames: u32) -> Vec<u8> {
    let frame_bytes = u32::from(channels) * SAMPLE_BYTES;
    let data_bytes = frames * frame_bytes;
    let format = format(channels, rate_hz, frame_bytes);
    let mut chunks = b"WAVE".to_vec();
    chunks.extend(chunk(b"fmt ", &format));
    chunks.extend(chunk(b"fact", &frames.to_le_bytes()));
    chunks.extend(b"data");
    chunks.extend(data_bytes.to_le_bytes());
    let mut header = b"RIFF".to_vec();
    header.extend((chunks.len() as u32 + data_bytes).to_le_bytes());
    header.extend(chunks);
    header
}

fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let length = (content.len() as u32).to_le_bytes();
    [name, &length[..], content].concat()
}

/// `WAVEFORMATEX`, with an empty extension.
fn format(channels: u16, rate_hz: u32, frame_bytes: u32) -> Vec<u8> {
    let bits = (8 * SAMPLE_BYTES) as u16;
    let mut format = FLOAT.to_le_bytes().to_vec();
    format.extend(channels.to_le_bytes());
    format.extend(rate_hz.to_le_bytes());
    format.extend((rate_hz * frame_bytes).to_le_bytes());
    format.extend((frame_bytes as u16).to_le_bytes());
    format.extend(bits.to_le_bytes());
    format.extend(0_u16.to_le_bytes());
    format
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects long files: the file contains every frame up to the last that a header can count, and no frame beyond,
    /// after a write that exceeds the limit by one frame or by more.
    #[test]
    fn a_file_is_full_at_the_last_frame_that_its_header_can_count() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = WavWriter::create(folder.path().join("long.wav")).unwrap();
        let limit = MAX_BYTES / u64::from(2 * SAMPLE_BYTES);
        // Sets the number of frames close to the limit.
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

    /// Protects files from incomplete frames, and callers from a file without channels.
    #[test]
    fn cut_frames_and_no_channels_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cut.wav");
        for channels in [0, 65, u16::MAX] {
            let refused = WavWriter::create_with_channels(&path, 48_000, channels);
            assert!(matches!(refused, Err(AudioError::BadChannels { .. })));
        }
        let mut writer = WavWriter::create_with_channels(&path, 48_000, 4).unwrap();
        for samples in [1, 3, 5] {
            let refused = writer.write(&vec![0.5; samples]);
            assert!(matches!(refused, Err(AudioError::CutFrame { .. })));
        }
        writer.write(&[0.5; 8]).unwrap();
        writer.finish().unwrap();
        let reader = hound::WavReader::open(&path).unwrap();
        assert_eq!((reader.spec().channels, reader.duration()), (4, 2));
    }

    /// The content of the chunk of this name.
    fn content<'a>(header: &'a [u8], name: &[u8; 4]) -> &'a [u8] {
        let mut rest = &header[12..];
        loop {
            let length = u32::from_le_bytes(rest[4..8].try_into().unwrap()) as usize;
            if &rest[..4] == name {
                return &rest[8..8 + length];
            }
            rest = &rest[8 + length..];
        }
    }

    /// Protects other programs from incomplete headers: the extension's length and the number of frames are present.
    #[test]
    fn a_head_is_complete() {
        for channels in [1, 2, 4] {
            let header = header(channels, 48_000, 1000);
            let format = content(&header, b"fmt ");
            assert_eq!(format[..2], FLOAT.to_le_bytes());
            assert_eq!(format[16..], [0, 0], "the extension has no bytes");
            assert_eq!(content(&header, b"fact"), 1000_u32.to_le_bytes());
            let data_bytes = 1000 * u32::from(channels) * SAMPLE_BYTES;
            assert_eq!(header[header.len() - 4..], data_bytes.to_le_bytes());
            let riff = u32::from_le_bytes(header[4..8].try_into().unwrap());
            assert_eq!(riff, header.len() as u32 - 8 + data_bytes);
        }
    }
}
