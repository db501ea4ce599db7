//! Bytes that a page can hold: 16-bit WAV, base64, data addresses; and a form's fingerprint.

use super::Trial;
use crate::audio::SAMPLE_RATE;

/// A stereo WAV of 16 bits from interleaved samples; what is beyond full scale is clipped.
pub fn wav_16(interleaved: &[f32]) -> Vec<u8> {
    let data = 2 * interleaved.len() as u32;
    let (channels, bytes_a_frame) = (2u16, 4u16);
    let mut wav = Vec::with_capacity(44 + data as usize);
    wav.extend(b"RIFF");
    wav.extend((36 + data).to_le_bytes());
    wav.extend(b"WAVEfmt ");
    wav.extend(16u32.to_le_bytes());
    wav.extend(1u16.to_le_bytes());
    wav.extend(channels.to_le_bytes());
    wav.extend(SAMPLE_RATE.to_le_bytes());
    wav.extend((SAMPLE_RATE * u32::from(bytes_a_frame)).to_le_bytes());
    wav.extend(bytes_a_frame.to_le_bytes());
    wav.extend(16u16.to_le_bytes());
    wav.extend(b"data");
    wav.extend(data.to_le_bytes());
    for sample in interleaved {
        let scaled = (sample.clamp(-1.0, 1.0) * f32::from(i16::MAX)).round();
        wav.extend((scaled as i16).to_le_bytes());
    }
    wav
}

/// A data address of these bytes.
pub fn data_url(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", base64(bytes))
}

/// Base64 with padding (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * place)) as usize & 63];
            let is_padding = place > group.len();
            text.push(if is_padding { '=' } else { char::from(digit) });
        }
    }
    text
}

/// 16 hexadecimal digits that differ for forms that differ in any trial or in their order
/// (FNV-1a over the trials as JSON).
pub fn fingerprint(trials: &[Trial]) -> String {
    // Trials are plain data, which JSON always takes.
    let text = serde_json::to_vec(trials).unwrap_or_default();
    let hash = text.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("{hash:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects every picture and sound of the page; the examples are the standard's.
    #[test]
    fn base64_is_that_of_the_standard() {
        let examples = [
            "", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy",
        ];
        for (length, expected) in examples.iter().enumerate() {
            assert_eq!(base64(&b"foobar"[..length]), *expected);
        }
    }

    /// Protects the page's sounds: another reader finds the samples again.
    #[test]
    fn a_16_bit_wav_is_read_again() {
        let wav = wav_16(&[0.5, -0.5, 1.0, -2.0]);
        let reader = hound::WavReader::new(wav.as_slice()).unwrap();
        assert_eq!(reader.spec().sample_rate, SAMPLE_RATE);
        let samples: Result<Vec<i16>, _> = reader.into_samples().collect();
        assert_eq!(samples.unwrap(), [16_384, -16_384, 32_767, -32_767]);
    }
}
