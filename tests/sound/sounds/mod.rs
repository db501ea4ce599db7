//! Sounds and WAV files: generated, read, resampled, written.

mod clips;
mod made;
mod wav_files;

use echomarch::audio::{AudioError, Sound, SoundSpec};
use hound::{SampleFormat, WavSpec};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn pull(sound: &mut Sound, count: usize) -> Vec<f32> {
    let mut out = vec![f32::NAN; count];
    sound.fill(&mut out);
    out
}

fn load(path: &Path) -> Result<Sound, AudioError> {
    Sound::load(&SoundSpec::Wav { path: path.into() }, Sound::SAMPLE_RATE)
}

fn spec(channels: u16, sample_rate: u32, bits_per_sample: u16) -> WavSpec {
    WavSpec {
        channels,
        sample_rate,
        bits_per_sample,
        sample_format: SampleFormat::Int,
    }
}

fn float(channels: u16, sample_rate: u32) -> WavSpec {
    WavSpec {
        sample_format: SampleFormat::Float,
        ..spec(channels, sample_rate, 32)
    }
}

fn write<S: hound::Sample + Copy>(dir: &TempDir, spec: WavSpec, samples: &[S]) -> PathBuf {
    let path = dir.path().join("in.wav");
    let mut writer = hound::WavWriter::create(&path, spec).unwrap();
    for &sample in samples {
        writer.write_sample(sample).unwrap();
    }
    writer.finalize().unwrap();
    path
}

fn error_of(result: Result<Sound, AudioError>) -> AudioError {
    let error = result.expect_err("the call should fail");
    assert!(error.is_bad_input(), "{error}");
    error
}

/// The amplitude of `frequency_hz` in `samples`, which must contain whole periods of it.
fn amplitude_at(frequency_hz: f64, samples: &[f32]) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (i, &s) in samples.iter().enumerate() {
        let angle = TAU * frequency_hz * i as f64 / f64::from(Sound::SAMPLE_RATE);
        re += f64::from(s) * angle.cos();
        im += f64::from(s) * angle.sin();
    }
    2.0 * re.hypot(im) / samples.len() as f64
}
