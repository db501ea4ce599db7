//! Encodes the data of a page (16-bit WAV, base64, data URLs), and computes the fingerprint of a form.

use super::Trial;
use base64::prelude::{BASE64_STANDARD, Engine};
use echomarch::audio::{Sound, wav_to_io};
use echomarch::internals::sampling::fnv_of_bytes;
use hound::{SampleFormat, WavSpec, WavWriter};
use std::io::{self, Cursor};

/// Encodes interleaved samples as a 16-bit stereo WAV file. Samples beyond full scale are clipped.
///
/// # Errors
/// An error occurs if a left sample has no right sample.
pub fn wav_16(interleaved: &[f32]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_wav_16(&mut bytes, interleaved).map_err(wav_to_io)?;
    Ok(bytes)
}

fn write_wav_16(bytes: &mut Vec<u8>, interleaved: &[f32]) -> hound::Result<()> {
    let spec = WavSpec {
        channels: 2,
        sample_rate: Sound::SAMPLE_RATE,
        bits_per_sample: 16,
        sample_format: SampleFormat::Int,
    };
    let mut wav = WavWriter::new(Cursor::new(bytes), spec)?;
    for sample in interleaved {
        let scaled = (sample.clamp(-1.0, 1.0) * f32::from(i16::MAX)).round();
        wav.write_sample(scaled as i16)?;
    }
    wav.finalize()
}

/// A data URL of the bytes: base64 with padding (RFC 4648, section 4).
pub fn data_url(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", BASE64_STANDARD.encode(bytes))
}

/// A fingerprint of 16 hexadecimal digits (FNV-1a over the trials as JSON). The fingerprint differs between forms with
/// different trials or a different order of trials.
pub fn fingerprint(trials: &[Trial]) -> String {
    // The trials are plain data, so their conversion to JSON cannot fail.
    let text = serde_json::to_vec(trials).unwrap_or_default();
    format!("{:016x}", fnv_of_bytes(&text))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects every picture and sound of the page. The examples are from RFC 4648.
    #[test]
    fn base64_is_that_of_the_standard() {
        let examples = [
            "", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy",
        ];
        for (length, expected) in examples.iter().enumerate() {
            let url = data_url("text/plain", &b"foobar"[..length]);
            assert_eq!(url, format!("data:text/plain;base64,{expected}"));
        }
    }

    /// Protects the page's sounds: an independent reader reads the same samples.
    #[test]
    fn a_16_bit_wav_is_read_again() {
        let wav = wav_16(&[0.5, -0.5, 1.0, -2.0]).unwrap();
        let reader = hound::WavReader::new(wav.as_slice()).unwrap();
        assert_eq!(reader.spec().sample_rate, Sound::SAMPLE_RATE);
        let samples: Result<Vec<i16>, _> = reader.into_samples().collect();
        assert_eq!(samples.unwrap(), [16_384, -16_384, 32_767, -32_767]);
    }

    /// Protects forms that were distributed: the same sounds give the same bytes.
    #[test]
    fn a_wav_has_the_shortest_header() {
        let mut expected = b"RIFF\x2c\0\0\0WAVEfmt \x10\0\0\0\x01\0\x02\0".to_vec();
        expected.extend(Sound::SAMPLE_RATE.to_le_bytes());
        expected.extend((4 * Sound::SAMPLE_RATE).to_le_bytes());
        expected.extend(b"\x04\0\x10\0data\x08\0\0\0\0\x40\0\xc0\xff\x7f\x01\x80");
        assert_eq!(wav_16(&[0.5, -0.5, 1.0, -2.0]).unwrap(), expected);
        assert!(wav_16(&[0.5]).is_err());
    }
}
