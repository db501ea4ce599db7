//! WAV files of every supported kind, and of some unsupported kinds.

use super::Target;
use super::scratch::with_file;
use echomarch::audio::{Sound, SoundSpec};

/// The bytes of an extensible `fmt ` chunk after the first sixteen.
const EXTENSIBLE_FLOAT: [u8; 24] = [
    22, 0, 32, 0, 3, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71,
];

fn wav(tag: u16, channels: u16, rate: u32, bits: u16, frames: u32, more: &[u8]) -> Vec<u8> {
    let frame = channels * bits / 8;
    let data = u32::from(frame) * frames;
    let mut file = b"RIFF".to_vec();
    file.extend((36 + data + more.len() as u32).to_le_bytes());
    file.extend(b"WAVEfmt ");
    file.extend((16 + more.len() as u32).to_le_bytes());
    file.extend(tag.to_le_bytes());
    file.extend(channels.to_le_bytes());
    file.extend(rate.to_le_bytes());
    file.extend((rate * u32::from(frame)).to_le_bytes());
    file.extend(frame.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend(more);
    file.extend(b"data");
    file.extend(data.to_le_bytes());
    let float = |index: u32| ((index % 100) as f32 / 100.0).to_le_bytes();
    match bits {
        32 => file.extend((0..data / 4).flat_map(float)),
        _ => file.extend((0..data).map(|index| (index * 37) as u8)),
    }
    file
}

/// Returns the target for WAV files.
pub fn target() -> Target {
    Target {
        name: "wav",
        corpus: vec![
            wav(1, 1, 48_000, 8, 50, &[]),
            wav(1, 2, 44_100, 16, 40, &[]),
            wav(1, 1, 8_000, 24, 64, &[0, 0]),
            wav(3, 1, 44_100, 32, 100, &[]),
            wav(3, 2, 48_000, 32, 20, &[0, 0]),
            wav(0xfffe, 2, 96_000, 32, 20, &EXTENSIBLE_FLOAT),
        ],
        tokens: &["RIFF", "WAVE", "fmt ", "data", "fact", "LIST"],
        one,
    }
}

/// Loads a sound and plays a part of it.
pub fn one(data: &[u8]) {
    with_file("sound.wav", data, |path| {
        let spec = SoundSpec::Wav { path: path.into() };
        match Sound::load(&spec, Sound::SAMPLE_RATE) {
            Err(error) => drop(error.to_string()),
            Ok(mut sound) => {
                let mut block = [0.0; 256];
                sound.fill(&mut block);
                assert!(block.iter().all(|sample| sample.is_finite()));
            }
        }
    });
}
