//! Limits on input files: their kind, their size, and their number of samples and pixels.

use super::{folder_with, refusal, scene};
use crate::common::cli::{run_in, stderr};
use crate::common::wav::{float_wav, wav_header};
use std::fs::File;
use std::os::unix::fs::symlink;
use std::process::Command;

/// A PNG file that consists of these chunks.
fn png(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, data) in chunks {
        file.extend((data.len() as u32).to_be_bytes());
        let summed = [name.as_slice(), data].concat();
        file.extend(&summed);
        let sum = summed.iter().fold(u32::MAX, |sum, byte| {
            (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
                sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 }
            })
        });
        file.extend((!sum).to_be_bytes());
    }
    file
}

fn head(width: u32, height: u32, depth: u8, colour: u8) -> Vec<u8> {
    let mut head = [width.to_be_bytes(), height.to_be_bytes()].concat();
    head.extend([depth, colour, 0, 0, 0]);
    head
}

/// Protects the program from waiting for pipes and from reading endless devices, for every option that takes a file.
#[test]
fn only_regular_files_are_read() {
    let folder = folder_with("Field(file: \"/dev/zero\", lipschitz: 1, size: (1, 1, 1))");
    let folder = folder.path();
    for name in ["pipe", "pipe.wav", "pipe.png"] {
        let made = Command::new("mkfifo").arg(folder.join(name)).status();
        assert!(made.unwrap().success());
    }
    symlink("/dev/zero", folder.join("zero.wav")).unwrap();
    let image = scene("HeightField(image: \"pipe.png\", size: (9, 2, 9))");
    std::fs::write(folder.join("image.ron"), image).unwrap();
    for (arguments, found) in [
        (vec!["trace", "scene.ron"], "a device"),
        (vec!["trace", "image.ron"], "a pipe"),
        (vec!["trace", "pipe"], "a pipe"),
        (vec!["trace", "/dev/zero"], "a device"),
        (
            vec!["render", "corner", "-o", "o.wav", "--sound", "pipe.wav"],
            "a pipe",
        ),
        (
            vec!["render", "corner", "-o", "o.wav", "--sound", "zero.wav"],
            "a device",
        ),
        (vec!["localise", "score", "pipe"], "a pipe"),
        (vec!["localise", "score", "/dev/zero"], "a device"),
    ] {
        let said = refusal(folder, &arguments);
        let told = format!("it is {found}, not a regular file");
        assert!(said.contains(&told), "{arguments:?}: {said}");
    }
}

/// Protects the memory: a file that is too large is refused before it is read or decoded. The message contains the
/// limit.
#[test]
fn large_files_are_refused_with_the_limit() {
    let folder = folder_with("HeightField(image: \"h.png\", size: (9, 2, 9))");
    let folder = folder.path();
    let sparse = |name: &str, head: &[u8], length: u64| {
        std::fs::write(folder.join(name), head).unwrap();
        let file = File::options().write(true).open(folder.join(name));
        file.unwrap().set_len(length).unwrap();
    };
    let render = |sound| {
        refusal(
            folder,
            &["render", "corner", "-o", "o.wav", "--sound", sound],
        )
    };
    sparse("large.wav", &wav_header(1, 48_000, 8, 400 << 20), 400 << 20);
    assert!(render("large.wav").contains("larger than 268435456 bytes"));
    // The file size is within its limit, but the sound is too long.
    sparse(
        "long.wav",
        &wav_header(1, 48_000, 8, 200 << 20),
        (200 << 20) + 44,
    );
    assert!(render("long.wav").contains("at most 33554432 are read"));
    // The file is short, but the sound is too long after resampling.
    sparse(
        "slow.wav",
        &wav_header(1, 1_000, 8, 1 << 20),
        (1 << 20) + 44,
    );
    assert!(render("slow.wav").contains("50331648 at 48000 Hz"));
    // A well compressed picture of 3.6 GB.
    let chunks = [
        (b"IHDR", head(30_000, 30_000, 16, 2)),
        (b"IDAT", vec![0; 9]),
    ];
    let chunks = chunks
        .each_ref()
        .map(|(name, data)| (*name, data.as_slice()));
    std::fs::write(folder.join("h.png"), png(&chunks)).unwrap();
    let said = refusal(folder, &["trace", "scene.ron"]);
    assert!(
        said.contains("30000 x 30000 pixels") && said.contains("1024"),
        "{said}"
    );
    sparse("h.png", b"\x89PNG", 40 << 20);
    let said = refusal(folder, &["trace", "scene.ron"]);
    assert!(said.contains("larger than 33554432 bytes"), "{said}");
    sparse("scene.ron", b"Scene(", 5 << 20);
    let said = refusal(folder, &["trace", "scene.ron"]);
    assert!(said.contains("larger than 4194304 bytes"), "{said}");
    sparse("answers.json", b"{", 20 << 20);
    let said = refusal(folder, &["localise", "score", "answers.json"]);
    assert!(said.contains("larger than 16777216 bytes"), "{said}");
}

/// Protects the program from pictures with an incomplete last palette colour, on which the decoder would panic.
#[test]
fn a_broken_palette_is_refused() {
    let folder = folder_with("HeightField(image: \"h.png\", size: (9, 2, 9))");
    let rows = b"\x78\x01\x01\x06\x00\xf9\xff\x00\x00\x01\x00\x01\x00\x00\x0c\x00\x03";
    for length in [1, 2, 4, 5, 7, 766, 769, 771, 1024] {
        let (head, palette) = (head(2, 2, 8, 3), vec![1; length]);
        let file = png(&[
            (b"IHDR", &head),
            (b"PLTE", &palette),
            (b"IDAT", rows),
            (b"IEND", &[]),
        ]);
        std::fs::write(folder.path().join("h.png"), file).unwrap();
        let said = refusal(folder.path(), &["trace", "scene.ron"]);
        assert!(said.contains("h.png"), "{length}: {said}");
    }
}

/// Protects the resampler, which would panic if its sums overflowed.
#[test]
fn samples_far_beyond_full_scale_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", "corner", "-o", "o.wav", "--sound", "v.wav"];
    for value in [3e38, -1e37, 1e10, f32::INFINITY, f32::NAN] {
        let samples: Vec<f32> = (0..2000)
            .map(|n| if n == 7 { value } else { 0.1 })
            .collect();
        std::fs::write(folder.path().join("v.wav"), float_wav(&samples)).unwrap();
        let said = refusal(folder.path(), &arguments);
        assert!(said.contains("sample 7"), "{value}: {said}");
    }
    // Integer samples in a file of the float format.
    std::fs::write(folder.path().join("v.wav"), float_wav(&[2e9, -2e9, 0.0])).unwrap();
    let few = ["--seconds", "0.05", "--waves", "64"];
    let output = run_in(folder.path(), &[&arguments[..], &few].concat());
    assert!(output.status.success(), "{}", stderr(&output));
}
