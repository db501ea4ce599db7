//! Synthetic sounds: a sine, noise, speech.

use super::{amplitude_at, error_of, float, load, pull, write};
use echomarch::audio::{AudioError, Sound, SoundSpec};
use tempfile::TempDir;

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
        let error = error_of(Sound::parse(text, Sound::SAMPLE_RATE));
        assert!(matches!(error, AudioError::UnknownSound { .. }), "{error}");
        assert!(error.to_string().contains(&format!("`{text}`")), "{error}");
    }
}

#[test]
fn bad_sines_and_rates_are_refused() {
    for text in ["sine:0", "sine:-440", "sine:24000", "sine:nan", "sine:inf"] {
        let error = error_of(Sound::parse(text, Sound::SAMPLE_RATE));
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
    let mut sine = Sound::parse("sine:1000", Sound::SAMPLE_RATE).unwrap();
    let samples = pull(&mut sine, 48_000);
    assert_eq!(samples[0], 0.0);
    let amplitude = amplitude_at(1000.0, &samples);
    assert!((amplitude - f64::from(Sound::SINE_AMPLITUDE)).abs() < 1e-6);
    sine.rewind();
    assert_eq!(pull(&mut sine, 480), samples[..480]);
}

#[test]
fn noise_is_repeatable_white_and_in_range() {
    let mut noise = Sound::parse("noise:3", Sound::SAMPLE_RATE).unwrap();
    let whole = pull(&mut noise, 100_000);
    let mut again = Sound::parse("noise:3", Sound::SAMPLE_RATE).unwrap();
    let mut pieces = pull(&mut again, 777);
    pieces.extend(pull(&mut again, 100_000 - 777));
    assert_eq!(whole, pieces);

    let other = pull(
        &mut Sound::parse("noise:4", Sound::SAMPLE_RATE).unwrap(),
        100_000,
    );
    let product = |a: &[f32], b: &[f32]| -> f64 {
        let sum: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum();
        sum / a.len().min(b.len()) as f64
    };
    let power = product(&whole, &whole);
    let uniform = f64::from(Sound::NOISE_AMPLITUDE).powi(2) / 3.0;
    assert!((power / uniform - 1.0).abs() < 0.02);
    assert!(whole.iter().all(|s| s.abs() <= Sound::NOISE_AMPLITUDE));
    // Five standard deviations of a correlation over 100 000 samples.
    for unlike in [product(&whole, &other), product(&whole, &whole[1..])] {
        assert!((unlike / power).abs() < 5.0 / 100_000f64.sqrt());
    }
}

#[test]
fn any_sample_can_be_sought() {
    let dir = TempDir::new().unwrap();
    let ramp: Vec<f32> = (0..500).map(|i| i as f32 / 500.0).collect();
    let path = write(&dir, float(1, Sound::SAMPLE_RATE), &ramp);
    for text in ["sine:997", "noise:2", "speech", path.to_str().unwrap()] {
        let whole = pull(&mut Sound::parse(text, Sound::SAMPLE_RATE).unwrap(), 2000);
        let mut sound = Sound::parse(text, Sound::SAMPLE_RATE).unwrap();
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
