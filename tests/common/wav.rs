//! WAV files, byte by byte.

/// A WAV header for `data_bytes` of samples.
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

/// A mono file of these samples, 44,100 of them a second.
pub fn float_wav(samples: &[f32]) -> Vec<u8> {
    let mut file = wav_header(3, 44_100, 32, 4 * samples.len() as u32);
    file.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    file
}
