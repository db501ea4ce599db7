//! Writes WAV files byte by byte, and reads WAV files.

use std::path::Path;

/// Returns a WAV header for `data_bytes` bytes of samples.
pub fn wav_header(tag: u16, rate: u32, bits: u16, data_bytes: u32) -> Vec<u8> {
    let frame = bits / 8;
    let mut file = b"RIFF".to_vec();
    file.extend((36 + data_bytes).to_le_bytes());
    file.extend(b"WAVEfmt \x10\0\0\0");
    file.extend(tag.to_le_bytes());
    file.extend(1_u16.to_le_bytes());
    file.extend(rate.to_le_bytes());
    file.extend((rate * u32::from(frame)).to_le_bytes());
    file.extend(frame.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend(b"data");
    file.extend(data_bytes.to_le_bytes());
    file
}

/// Returns a mono WAV file of these samples at 44,100 Hz.
pub fn float_wav(samples: &[f32]) -> Vec<u8> {
    let mut file = wav_header(3, 44_100, 32, 4 * samples.len() as u32);
    file.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    file
}

/// Reads the left and right channels of a WAV file written by the program, which has 48 kHz and floats.
pub fn read_stereo(path: &Path) -> [Vec<f32>; 2] {
    let reader = hound::WavReader::open(path).unwrap();
    let spec = reader.spec();
    assert_eq!((spec.channels, spec.sample_rate), (2, 48_000));
    assert_eq!(spec.sample_format, hound::SampleFormat::Float);
    assert_eq!(spec.bits_per_sample, 32);
    let samples: Vec<f32> = reader.into_samples().map(Result::unwrap).collect();
    let channel = |first| samples.iter().copied().skip(first).step_by(2).collect();
    [channel(0), channel(1)]
}

/// The root mean square.
pub fn rms(samples: &[f32]) -> f64 {
    let squares = samples.iter().map(|&s| f64::from(s).powi(2));
    (squares.sum::<f64>() / samples.len() as f64).sqrt()
}
