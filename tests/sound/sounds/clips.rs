//! Playback of sounds from WAV files: loops, ends and resampling.

use super::{amplitude_at, float, load, pull, write};
use echomarch::audio::Sound;
use std::f64::consts::TAU;
use tempfile::TempDir;

#[test]
fn a_clip_loops_or_ends_in_silence() {
    let dir = TempDir::new().unwrap();
    let path = write(&dir, float(1, Sound::SAMPLE_RATE), &[0.1f32, 0.2, 0.3]);
    let mut clip = load(&path).unwrap();
    assert_eq!(clip.length(), Some(3));
    assert_eq!(pull(&mut clip, 7), [0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 0.1]);
    clip.rewind();
    clip.set_looping(false);
    assert!(!clip.is_finished());
    assert_eq!(pull(&mut clip, 5), [0.1, 0.2, 0.3, 0.0, 0.0]);
    assert!(clip.is_finished());
}

/// Protects a loop whose end does not match its start from a click in each round: no step is larger than the steps of
/// the sound and of the cross-fade. The first round is unchanged, and a clip that does not loop is unchanged as well.
#[test]
fn a_clip_that_loops_does_not_click() {
    let dir = TempDir::new().unwrap();
    // The clip starts with a zero and ends with a peak after 5003 samples, so that blocks end at different positions in
    // it.
    let count = 5003;
    let hertz = 10.25 * 48_000.0 / f64::from(count - 1);
    let tone = |i: u32| 0.5 * (TAU * hertz * f64::from(i) / 48_000.0).sin() as f32;
    let samples: Vec<f32> = (0..count).map(tone).collect();
    let path = write(&dir, float(1, Sound::SAMPLE_RATE), &samples);
    let mut clip = load(&path).unwrap();
    let mut looped = Vec::new();
    for _ in 0..30 {
        looped.extend(pull(&mut clip, 777));
    }
    assert_eq!(looped[..5003], samples);
    // After the cross-fade of 5 ms the samples equal the samples of the clip again, up to its end.
    assert_eq!(looped[5003 + 240..2 * 5003], samples[240..]);
    let largest = looped
        .windows(2)
        .fold(0.0f32, |most, pair| most.max((pair[1] - pair[0]).abs()));
    let own = (0.5 * TAU * hertz / 48_000.0) as f32;
    let fade = 2.0 * 0.5 / 240.0;
    println!("largest step {largest:.5}, allowed {:.5}", own + fade);
    assert!(largest <= own + fade + 1e-6);
    // Seeking into the second round gives the same samples.
    clip.seek(5003 + 100);
    assert_eq!(pull(&mut clip, 500), looped[5103..5603]);
    clip.rewind();
    clip.set_looping(false);
    assert_eq!(pull(&mut clip, 5003), samples);
}

/// Protects a clip made to loop: its end matches its start, and it is played unchanged.
#[test]
fn a_clip_that_fits_itself_is_looped_as_it_is() {
    let dir = TempDir::new().unwrap();
    let tone = |i: u32| 0.5 * (TAU * f64::from(i) / 100.0).sin() as f32;
    let samples: Vec<f32> = (0..4800).map(tone).collect();
    let path = write(&dir, float(1, Sound::SAMPLE_RATE), &samples);
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
        // Away from the ends the samples must equal the tone itself, in phase, within −74 dB of it.
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

/// A short pulse without high frequencies has known values at all times, including its beginning.
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
