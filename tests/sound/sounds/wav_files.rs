//! WAV files, read and written.

use super::{error_of, float, load, pull, spec, write};
use crate::common::wav::wav_header;
use echomarch::audio::{AudioError, Sound, WavWriter};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

#[test]
fn every_integer_width_keeps_its_scale() {
    let dir = TempDir::new().unwrap();
    for bits in [8u16, 16, 24, 32] {
        let full = 1i64 << (bits - 1);
        let samples = [0, full / 2, -full / 2, full - 1, -full].map(|s| s as i32);
        let path = write(&dir, spec(1, Sound::SAMPLE_RATE, bits), &samples);
        let read = pull(&mut load(&path).unwrap(), 5);
        let top = ((full - 1) as f64 / full as f64) as f32;
        assert_eq!(read, [0.0, 0.5, -0.5, top, -1.0], "{bits} bits");
    }
}

#[test]
fn channels_are_averaged() {
    let dir = TempDir::new().unwrap();
    let path = write(
        &dir,
        float(2, Sound::SAMPLE_RATE),
        &[1.0f32, 0.0, 0.5, -0.5, -1.0, -0.5],
    );
    assert_eq!(pull(&mut load(&path).unwrap(), 3), [0.5, 0.0, -0.75]);
    let path = write(&dir, float(4, Sound::SAMPLE_RATE), &[f32::MAX; 4]);
    assert_eq!(pull(&mut load(&path).unwrap(), 1), [f32::MAX]);
}

#[test]
fn bad_files_are_refused_each_in_its_own_words() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("in.wav");
    let check = |wanted: fn(&AudioError) -> bool, what: &str| {
        let error = error_of(load(&path));
        assert!(wanted(&error), "{what}: {error:?}");
        assert!(error.to_string().contains("in.wav"), "{what}: {error}");
    };
    check(|e| matches!(e, AudioError::OpenWav { .. }), "missing");
    for text in [
        "",
        "RIFF",
        "This is no sound, but it is long enough for a header of 44.",
    ] {
        fs::write(&path, text).unwrap();
        check(|e| matches!(e, AudioError::NotWav { .. }), text);
    }
    write(&dir, spec(2, Sound::SAMPLE_RATE, 16), &[0i16; 0]);
    check(|e| matches!(e, AudioError::EmptyWav { .. }), "empty");
    write(&dir, spec(1, 12, 16), &[0i16; 4]);
    check(|e| matches!(e, AudioError::UnsupportedWav { .. }), "rate");
    for bad in [f32::NAN, f32::INFINITY] {
        write(&dir, float(2, Sound::SAMPLE_RATE), &[0.0, 0.0, 0.0, bad]);
        check(
            |e| matches!(e, AudioError::NonFiniteSample { sample: 3, .. }),
            "NaN",
        );
    }
    write(&dir, spec(1, Sound::SAMPLE_RATE, 16), &[1i16; 100]);
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() - 21]).unwrap();
    check(
        |e| matches!(e, AudioError::DamagedWav { sample: 89, .. }),
        "cut off",
    );
    for (tag, bits) in [(2u16, 16u16), (3, 64), (1, 40), (6, 8)] {
        fs::write(&path, raw_wav(tag, bits)).unwrap();
        check(
            |e| matches!(e, AudioError::UnsupportedWav { .. }),
            &format!("{tag} {bits}"),
        );
    }
    assert!(matches!(
        error_of(load(&dir.path().join("no.wav"))),
        AudioError::OpenWav { .. }
    ));
    fs::create_dir(dir.path().join("dir.wav")).unwrap();
    assert!(matches!(
        error_of(load(&dir.path().join("dir.wav"))),
        AudioError::OpenWav { .. }
    ));
}

/// Returns a mono WAV file with any format tag and width, and 80 zero bytes as its sound.
fn raw_wav(tag: u16, bits: u16) -> Vec<u8> {
    let mut wav = wav_header(tag, 48_000, bits, 80);
    wav.extend([0; 80]);
    wav
}

#[test]
fn what_is_written_can_be_read() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("out.wav");
    fs::write(&path, "older").unwrap();
    let mut writer = WavWriter::create(&path).unwrap();
    writer.write(&[0.1, 0.3, -0.5, -0.5]).unwrap();
    writer.write(&[]).unwrap();
    writer.write(&[1.5, -1.5]).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"older");
    writer.finish().unwrap();

    let mut reader = hound::WavReader::open(&path).unwrap();
    assert_eq!(reader.spec(), float(2, 48_000));
    let samples: Vec<f32> = reader.samples().collect::<Result<_, _>>().unwrap();
    assert_eq!(samples, [0.1, 0.3, -0.5, -0.5, 1.5, -1.5]);
    assert_eq!(pull(&mut load(&path).unwrap(), 3), [0.2, -0.5, 0.0]);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn a_dropped_writer_leaves_nothing() {
    let dir = TempDir::new().unwrap();
    let mut writer = WavWriter::create(dir.path().join("out.wav")).unwrap();
    writer.write(&[0.0; 100_000]).unwrap();
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    drop(writer);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let dir = TempDir::new().unwrap();
    for target in [dir.path().join("missing/out.wav"), dir.path().to_owned()] {
        let error = WavWriter::create(&target).unwrap_err();
        assert!(matches!(error, AudioError::WriteWav { .. }), "{error}");
        assert!(error.is_bad_input(), "a missing folder is bad input");
        assert!(
            error.to_string().contains(target.to_str().unwrap()),
            "{error}"
        );
    }
}

#[cfg(unix)]
#[test]
fn a_written_file_has_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let dir = TempDir::new().unwrap();
    let (path, plain) = (dir.path().join("out.wav"), dir.path().join("plain"));
    WavWriter::create(&path).unwrap().finish().unwrap();
    fs::write(&plain, "").unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&plain));
}
