//! Sounds and WAV files: made, read, resampled, written.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use echomarch::audio::{
    AudioError, NOISE_AMPLITUDE, SAMPLE_RATE, SINE_AMPLITUDE, Signal, Sound, SoundSource,
    SoundSpec, WavWriter,
};
use hound::{SampleFormat, WavSpec};
use tempfile::TempDir;

fn pull(sound: &mut Sound, count: usize) -> Vec<f32> {
    let mut out = vec![f32::NAN; count];
    sound.fill(&mut out);
    out
}

fn load(path: &Path) -> Result<Sound, AudioError> {
    Sound::load(&SoundSpec::Wav { path: path.into() }, SAMPLE_RATE)
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
    let error = result.expect_err("this must be refused");
    assert!(error.is_bad_input(), "{error}");
    error
}

/// The amplitude of `frequency_hz` in `samples`, of which it must fill whole periods.
fn amplitude_at(frequency_hz: f64, samples: &[f32]) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (i, &s) in samples.iter().enumerate() {
        let angle = TAU * frequency_hz * i as f64 / f64::from(SAMPLE_RATE);
        re += f64::from(s) * angle.cos();
        im += f64::from(s) * angle.sin();
    }
    2.0 * re.hypot(im) / samples.len() as f64
}

#[test]
fn specs_are_read_and_shown() {
    let sine = SoundSpec::Sine {
        frequency_hz: 440.5,
    };
    for (text, wanted) in [
        ("sine:440.5", sine),
        ("noise", SoundSpec::Noise { seed: 0 }),
        ("noise:7", SoundSpec::Noise { seed: 7 }),
        ("speech", SoundSpec::Speech { seed: 0 }),
        ("speech:9", SoundSpec::Speech { seed: 9 }),
        (
            "a b/c.WAV",
            SoundSpec::Wav {
                path: "a b/c.WAV".into(),
            },
        ),
    ] {
        let spec: SoundSpec = text.parse().unwrap();
        assert_eq!(spec, wanted);
        assert_eq!(spec.to_string().parse::<SoundSpec>().unwrap(), wanted);
    }
}

#[test]
fn unknown_sounds_are_refused() {
    for text in [
        "",
        "sine",
        "sine:",
        "sine:a",
        "noise:-1",
        "noise:1.5",
        "speech:",
        "speech:a",
        "x.mp3",
        "tone:3",
    ] {
        let error = error_of(Sound::parse(text, SAMPLE_RATE));
        assert!(matches!(error, AudioError::UnknownSound { .. }), "{error}");
        assert!(error.to_string().contains(&format!("`{text}`")), "{error}");
    }
}

#[test]
fn bad_sines_and_rates_are_refused() {
    for text in ["sine:0", "sine:-440", "sine:24000", "sine:nan", "sine:inf"] {
        let error = error_of(Sound::parse(text, SAMPLE_RATE));
        assert!(
            matches!(error, AudioError::BadSineFrequency { .. }),
            "{error}"
        );
        assert!(error.to_string().contains("24000 Hz"), "{error}");
    }
    let error = error_of(Sound::parse("noise", 0));
    assert!(matches!(error, AudioError::BadSampleRate { .. }), "{error}");
}

#[test]
fn a_sine_has_its_frequency_and_amplitude() {
    let mut sine = Sound::parse("sine:1000", SAMPLE_RATE).unwrap();
    let samples = pull(&mut sine, 48_000);
    assert_eq!(samples[0], 0.0);
    let amplitude = amplitude_at(1000.0, &samples);
    assert!((amplitude - f64::from(SINE_AMPLITUDE)).abs() < 1e-6);
    sine.rewind();
    assert_eq!(pull(&mut sine, 480), samples[..480]);
}

#[test]
fn noise_is_repeatable_white_and_in_range() {
    let mut noise = Sound::parse("noise:3", SAMPLE_RATE).unwrap();
    let whole = pull(&mut noise, 100_000);
    let mut again = Sound::parse("noise:3", SAMPLE_RATE).unwrap();
    let mut pieces = pull(&mut again, 777);
    pieces.extend(pull(&mut again, 100_000 - 777));
    assert_eq!(whole, pieces);

    let other = pull(&mut Sound::parse("noise:4", SAMPLE_RATE).unwrap(), 100_000);
    let product = |a: &[f32], b: &[f32]| -> f64 {
        let sum: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum();
        sum / a.len().min(b.len()) as f64
    };
    let power = product(&whole, &whole);
    let uniform = f64::from(NOISE_AMPLITUDE).powi(2) / 3.0;
    assert!((power / uniform - 1.0).abs() < 0.02);
    assert!(whole.iter().all(|s| s.abs() <= NOISE_AMPLITUDE));
    // Five standard deviations of a correlation over 100 000 samples.
    for unlike in [product(&whole, &other), product(&whole, &whole[1..])] {
        assert!((unlike / power).abs() < 5.0 / 100_000f64.sqrt());
    }
}

#[test]
fn every_integer_width_keeps_its_scale() {
    let dir = TempDir::new().unwrap();
    for bits in [8u16, 16, 24, 32] {
        let full = 1i64 << (bits - 1);
        let samples = [0, full / 2, -full / 2, full - 1, -full].map(|s| s as i32);
        let path = write(&dir, spec(1, SAMPLE_RATE, bits), &samples);
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
        float(2, SAMPLE_RATE),
        &[1.0f32, 0.0, 0.5, -0.5, -1.0, -0.5],
    );
    assert_eq!(pull(&mut load(&path).unwrap(), 3), [0.5, 0.0, -0.75]);
    let path = write(&dir, float(4, SAMPLE_RATE), &[f32::MAX; 4]);
    assert_eq!(pull(&mut load(&path).unwrap(), 1), [f32::MAX]);
}

#[test]
fn a_clip_loops_or_ends_in_silence() {
    let dir = TempDir::new().unwrap();
    let path = write(&dir, float(1, SAMPLE_RATE), &[0.1f32, 0.2, 0.3]);
    let mut clip = load(&path).unwrap();
    assert_eq!(clip.length(), Some(3));
    assert_eq!(pull(&mut clip, 7), [0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 0.1]);
    clip.rewind();
    clip.set_looping(false);
    assert!(!clip.is_finished());
    assert_eq!(pull(&mut clip, 5), [0.1, 0.2, 0.3, 0.0, 0.0]);
    assert!(clip.is_finished());
}

/// Protects a loop whose end does not fit its start from a click each time: no step is larger
/// than the sound's own and the cross-fade's. The first time nothing is changed, nor without
/// looping.
#[test]
fn a_clip_that_loops_does_not_click() {
    let dir = TempDir::new().unwrap();
    // It starts with a zero and ends with a peak, in 5003 samples: blocks end everywhere.
    let count = 5003;
    let hertz = 10.25 * 48_000.0 / f64::from(count - 1);
    let tone = |i: u32| 0.5 * (TAU * hertz * f64::from(i) / 48_000.0).sin() as f32;
    let samples: Vec<f32> = (0..count).map(tone).collect();
    let path = write(&dir, float(1, SAMPLE_RATE), &samples);
    let mut clip = load(&path).unwrap();
    let mut looped = Vec::new();
    for _ in 0..30 {
        looped.extend(pull(&mut clip, 777));
    }
    assert_eq!(looped[..5003], samples);
    // After the cross-fade of 5 ms it is the clip again, as long as it was.
    assert_eq!(looped[5003 + 240..2 * 5003], samples[240..]);
    let largest = looped
        .windows(2)
        .fold(0.0f32, |most, pair| most.max((pair[1] - pair[0]).abs()));
    let own = (0.5 * TAU * hertz / 48_000.0) as f32;
    let fade = 2.0 * 0.5 / 240.0;
    println!("largest step {largest:.5}, allowed {:.5}", own + fade);
    assert!(largest <= own + fade + 1e-6);
    // A place in the second time is the same when it is sought.
    clip.seek(5003 + 100);
    assert_eq!(pull(&mut clip, 500), looped[5103..5603]);
    clip.rewind();
    clip.set_looping(false);
    assert_eq!(pull(&mut clip, 5003), samples);
}

/// Protects a clip that was made to loop: its end fits its start, and nothing is changed.
#[test]
fn a_clip_that_fits_itself_is_looped_as_it_is() {
    let dir = TempDir::new().unwrap();
    let tone = |i: u32| 0.5 * (TAU * f64::from(i) / 100.0).sin() as f32;
    let samples: Vec<f32> = (0..4800).map(tone).collect();
    let path = write(&dir, float(1, SAMPLE_RATE), &samples);
    let looped = pull(&mut load(&path).unwrap(), 9600);
    assert_eq!(looped[4800..], samples);
}

#[test]
fn resampling_keeps_frequency_level_and_length() {
    let dir = TempDir::new().unwrap();
    for rate in [8_000u32, 22_050, 44_100, 44_101, 96_000] {
        let count = rate as usize * 2 + 17;
        let tone = |i: usize| (TAU * 1000.0 * i as f64 / f64::from(rate)).sin() as f32 * 0.5;
        let path = write(
            &dir,
            float(1, rate),
            &(0..count).map(tone).collect::<Vec<_>>(),
        );
        let mut sound = load(&path).unwrap();
        let wanted = (count as f64 * 48_000.0 / f64::from(rate)).round() as usize;
        assert_eq!(sound.length(), Some(wanted), "{rate} Hz");
        let samples = pull(&mut sound, wanted);
        // Away from the ends the tone itself must stand there, in phase, within −74 dB of it.
        for (i, &s) in samples.iter().enumerate().take(72_000).skip(24_000) {
            let exact = 0.5 * (TAU * 1000.0 * i as f64 / 48_000.0).sin();
            assert!(
                (f64::from(s) - exact).abs() < 1e-4,
                "{rate} Hz, sample {i}: {s}"
            );
        }
        let level = amplitude_at(1000.0, &samples[24_000..72_000]);
        assert!((level / 0.5 - 1.0).abs() < 1e-4, "{rate} Hz: {level}");
    }
}

#[test]
fn any_sample_can_be_sought() {
    let dir = TempDir::new().unwrap();
    let ramp: Vec<f32> = (0..500).map(|i| i as f32 / 500.0).collect();
    let path = write(&dir, float(1, SAMPLE_RATE), &ramp);
    for text in ["sine:997", "noise:2", "speech", path.to_str().unwrap()] {
        let whole = pull(&mut Sound::parse(text, SAMPLE_RATE).unwrap(), 2000);
        let mut sound = Sound::parse(text, SAMPLE_RATE).unwrap();
        for start in [1234, 0, 777] {
            sound.seek(start as u64);
            for (a, b) in pull(&mut sound, 700).iter().zip(&whole[start..]) {
                assert!((a - b).abs() < 1e-6, "{text} from {start}");
            }
        }
    }
    let mut clip = load(&path).unwrap();
    clip.set_looping(false);
    clip.seek(1234);
    assert!(clip.is_finished());
}

/// A short pulse without high frequencies is known at every time, its beginning included.
#[test]
fn resampling_keeps_the_onset() {
    let dir = TempDir::new().unwrap();
    let pulse = |t: f64| (-((t - 0.01) / 0.000_5).powi(2)).exp();
    for (rate, seconds) in [
        (44_100u32, 0.02),
        (44_100, 1.0),
        (96_000, 0.5),
        (16_000, 0.1),
    ] {
        let count = (f64::from(rate) * seconds) as usize;
        let samples: Vec<f32> = (0..count)
            .map(|i| pulse(i as f64 / f64::from(rate)) as f32)
            .collect();
        let path = write(&dir, float(1, rate), &samples);
        let mut sound = load(&path).unwrap();
        let count = sound.length().unwrap();
        for (i, s) in pull(&mut sound, count).into_iter().enumerate() {
            let exact = pulse(i as f64 / 48_000.0);
            assert!(
                (f64::from(s) - exact).abs() < 1e-4,
                "{rate} Hz, sample {i}: {s}"
            );
        }
    }
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
    write(&dir, spec(2, SAMPLE_RATE, 16), &[0i16; 0]);
    check(|e| matches!(e, AudioError::EmptyWav { .. }), "empty");
    write(&dir, spec(1, 12, 16), &[0i16; 4]);
    check(|e| matches!(e, AudioError::UnsupportedWav { .. }), "rate");
    for bad in [f32::NAN, f32::INFINITY] {
        write(&dir, float(2, SAMPLE_RATE), &[0.0, 0.0, 0.0, bad]);
        check(
            |e| matches!(e, AudioError::NonFiniteSample { sample: 3, .. }),
            "NaN",
        );
    }
    write(&dir, spec(1, SAMPLE_RATE, 16), &[1i16; 100]);
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

/// A mono WAV file with any format tag and width: 80 bytes of zeros as its sound.
fn raw_wav(tag: u16, bits: u16) -> Vec<u8> {
    let bytes = bits / 8;
    let mut wav = b"RIFF\x74\0\0\0WAVEfmt \x10\0\0\0".to_vec();
    wav.extend(tag.to_le_bytes());
    wav.extend(1u16.to_le_bytes());
    wav.extend(48_000u32.to_le_bytes());
    wav.extend((48_000 * u32::from(bytes)).to_le_bytes());
    wav.extend(bytes.to_le_bytes());
    wav.extend(bits.to_le_bytes());
    wav.extend(b"data\x50\0\0\0");
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
        assert!(error.is_bad_input(), "a place that is not there was typed");
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

/// Protects a caller's own sound: it is read, sought and ended as it says, at the rate that is
/// asked for.
#[test]
fn a_sound_of_ones_own_is_played() {
    /// Counts up by one a sample, to its length.
    struct Ramp {
        next: usize,
        length: usize,
    }
    impl Signal for Ramp {
        fn fill(&mut self, out: &mut [f32]) {
            for sample in out {
                *sample = if self.is_finished() {
                    0.0
                } else {
                    self.next as f32
                };
                self.next += 1;
            }
        }
        fn seek(&mut self, sample: u64) {
            self.next = sample as usize;
        }
        fn length(&self) -> Option<usize> {
            Some(self.length)
        }
        fn is_finished(&self) -> bool {
            self.next >= self.length
        }
    }
    let source = SoundSource::new("ramp", |rate_hz| {
        let length = rate_hz as usize / 16_000;
        Ok(Sound::new(Ramp { next: 0, length }))
    });
    let mut sound = source.sound(SAMPLE_RATE).unwrap();
    assert_eq!(sound.length(), Some(3));
    let mut out = [9.0; 2];
    sound.fill(&mut out);
    assert_eq!((out, sound.is_finished()), ([0.0, 1.0], false));
    sound.fill(&mut out);
    assert_eq!((out, sound.is_finished()), ([2.0, 0.0], true));
    sound.rewind();
    sound.fill(&mut out);
    assert_eq!(out, [0.0, 1.0]);
    assert_eq!(source.sound(96_000).unwrap().length(), Some(6));
}

/// Protects live output from a sound that cannot be made: its source says why.
#[test]
fn a_source_says_why_it_makes_no_sound() {
    let missing: SoundSource = "missing.wav".parse().unwrap();
    let error = missing.sound(SAMPLE_RATE).unwrap_err();
    assert!(matches!(error, AudioError::OpenWav { .. }), "{error}");
    let error = "missing".parse::<SoundSource>().unwrap_err();
    assert!(matches!(error, AudioError::UnknownSound { .. }), "{error}");
}
