//! The header of a WAV file of 32-bit float samples (Microsoft, *New Multimedia Data Types and Data Techniques*, 1994).
//!
//! Samples other than PCM need a `fmt` chunk with the length of its extension, and a `fact` chunk with the number of
//! frames; readers call a file without them incomplete. `WAVE_FORMAT_EXTENSIBLE` would add the loudspeaker positions of
//! the channels, which ambisonic channels lack, and SoX calls it incomplete with such samples.

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
