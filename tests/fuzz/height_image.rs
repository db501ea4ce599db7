//! Height images, which are PNG files of every colour type.

use super::Target;
use super::scratch::with_file;
use echomarch::glam::DVec2;
use echomarch::scene::HeightImage;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

fn png(colour: ExtendedColorType, bytes_a_pixel: usize) -> Vec<u8> {
    const SIDE: u32 = 6;
    let count = (SIDE * SIDE) as usize * bytes_a_pixel;
    let pixels: Vec<u8> = (0..count).map(|index| (index * 29) as u8).collect();
    let mut file = Vec::new();
    let encoder = PngEncoder::new(&mut file);
    let written = encoder.write_image(&pixels, SIDE, SIDE, colour);
    written.expect("a small picture is encoded");
    file
}

/// A PNG file of raw chunks. [`with_sums`] computes their checksums.
fn chunks(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, data) in chunks {
        file.extend((data.len() as u32).to_be_bytes());
        file.extend(*name);
        file.extend(*data);
        file.extend([0; 4]);
    }
    file
}

/// An uncompressed image of 2 by 2 pixels with a palette of two colours.
fn with_palette() -> Vec<u8> {
    let rows = [0, 0, 1, 0, 1, 0];
    let mut stored = vec![0x78, 0x01, 0x01, 6, 0, !6, 0xff];
    stored.extend(rows);
    // Adler-32 checksum of the rows.
    let (mut a, mut b) = (1_u32, 0_u32);
    for byte in rows {
        a = (a + byte) % 65_521;
        b = (b + a) % 65_521;
    }
    let mut stored: Vec<u8> = stored.into_iter().map(|byte: u32| byte as u8).collect();
    stored.extend((b << 16 | a).to_be_bytes());
    with_sums(chunks(&[
        (b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 2, 8, 3, 0, 0, 0]),
        (b"PLTE", &[0, 0, 0, 255, 255, 255]),
        (b"tRNS", &[0]),
        (b"IDAT", &stored),
        (b"IEND", &[]),
    ]))
}

/// Corrects the checksums of all chunks, so that their contents are read. Bytes after the last complete chunk are
/// unchanged.
fn with_sums(mut file: Vec<u8>) -> Vec<u8> {
    let mut at = 8;
    while let Some(head) = file.get(at..at + 4) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let end = at.saturating_add(8).saturating_add(length);
        let Some(summed) = file.get(at + 4..end) else {
            break;
        };
        let sum = crc(summed).to_be_bytes();
        let Some(place) = file.get_mut(end..end + 4) else {
            break;
        };
        place.copy_from_slice(&sum);
        at = end + 4;
    }
    file
}

/// CRC-32 checksum as defined by PNG.
fn crc(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for byte in bytes {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            let divisor = if sum & 1 == 1 { 0xedb8_8320 } else { 0 };
            sum = sum >> 1 ^ divisor;
        }
    }
    !sum
}

/// Returns the target for height images.
pub fn target() -> Target {
    Target {
        name: "height_image",
        corpus: vec![
            png(ExtendedColorType::L8, 1),
            png(ExtendedColorType::L16, 2),
            png(ExtendedColorType::La8, 2),
            png(ExtendedColorType::Rgb8, 3),
            png(ExtendedColorType::Rgba16, 8),
            with_palette(),
        ],
        tokens: &[
            "IHDR", "PLTE", "IDAT", "IEND", "tRNS", "tEXt", "zTXt", "iTXt", "iCCP", "acTL", "fcTL",
        ],
        one,
    }
}

/// Reads a height image twice: unchanged, and with corrected checksums.
pub fn one(data: &[u8]) {
    for data in [data.to_vec(), with_sums(data.to_vec())] {
        with_file("heights.png", &data, |path| {
            match HeightImage::from_file(path) {
                Err(why) => drop(why),
                Ok(image) => {
                    assert!((0.0..=1.0).contains(&image.at(DVec2::splat(0.3))));
                    assert!(image.steepest(DVec2::ONE).is_finite());
                }
            }
        });
    }
}
