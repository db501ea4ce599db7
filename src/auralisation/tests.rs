use super::prepared_sound::{Echo, Heard};
use super::{Auralisation, BLOCK, Spec};
use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use crate::response::{
    Echogram, Format, ImpulseResponse, ImpulseSettings, ListenerAxes, ResponseError, Tap,
};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const RATE_HZ: u32 = 48_000;

fn spec(has_bands: bool) -> Spec {
    Spec {
        rate_hz: RATE_HZ,
        has_bands,
        longest_s: 0.5,
    }
}

fn axes() -> ListenerAxes {
    ListenerAxes::new(DVec3::NEG_Z, DVec3::Y).expect("good axes")
}

/// Sound from the left. It has amplitude 1 at a band's centre if the band's energy is 1 / 4π.
fn tap(seconds: f64, energy: Bands) -> Tap {
    Tap {
        seconds,
        energy: energy.map(|energy| energy / (4.0 * PI)),
        direction: DVec3::X,
    }
}

fn heard(taps: &[Tap], spec: Spec) -> Heard {
    let echo = |(key, tap): (usize, &Tap)| Echo::new(tap, key as u64, &axes(), spec);
    Heard {
        echoes: taps.iter().enumerate().map(echo).collect(),
        late: None,
        spec: Some(spec),
    }
}

/// The output at the left ear for a sound, without the latency.
fn play(ears: &mut Auralisation, sound: &[f32]) -> Vec<f32> {
    let mut ahead = sound.to_vec();
    ahead.resize(sound.len() + ears.latency(), 0.0);
    let mut stereo = vec![0.0; 2 * ahead.len()];
    // Blocks whose odd length is unrelated to the length of the convolution's blocks.
    for (mono, stereo) in ahead.chunks(333).zip(stereo.chunks_mut(2 * 333)) {
        ears.add(mono, stereo).unwrap();
    }
    let left = stereo.iter().step_by(2).skip(ears.latency());
    left.copied().collect()
}

fn impulse(length: usize) -> Vec<f32> {
    let mut samples = vec![0.0; length];
    samples[0] = 1.0;
    samples
}

/// Amplitude of a sine in these samples.
fn amplitude_at(samples: &[f32], frequency_hz: f64) -> f64 {
    let turn = |index: usize| TAU * frequency_hz * index as f64 / f64::from(RATE_HZ);
    let terms = samples.iter().enumerate();
    let (real, imaginary) = terms.fold((0.0, 0.0), |sum, (index, sample)| {
        let (sin, cos) = turn(index).sin_cos();
        let sample = f64::from(*sample);
        (sum.0 + sample * cos, sum.1 + sample * sin)
    });
    real.hypot(imaginary)
}

/// Protects the delay of an echo, accurate to a sample, and its amplitude, with and without bands.
#[test]
fn an_echo_comes_when_it_shall() {
    for has_bands in [false, true] {
        let spec = spec(has_bands);
        let mut ears = Auralisation::new(spec).expect("a good spec");
        ears.glide_echoes(&heard(&[tap(0.01, [0.25; BAND_COUNT])], spec), 0)
            .unwrap();
        let left = play(&mut ears, &impulse(4096));
        for (index, sample) in left.iter().enumerate() {
            let expected = if index == 480 { 0.5 } else { 0.0 };
            assert!(
                (sample - expected).abs() < 1e-4,
                "{has_bands} {index}: {sample}"
            );
        }
    }
}

/// Protects the timbre: at the centre of each band the amplitude matches the band's energy, except for the error of the
/// truncated filters.
#[test]
fn bands_have_their_energies() {
    let spec = spec(true);
    for energy in [
        [1.0, 0.01, 1.0, 0.1, 0.5, 0.01, 0.3, 1.0],
        [0.01, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        [0.2, 0.4, 0.6, 0.8, 1.0, 1.0, 1.0, 1.0],
    ] {
        let mut ears = Auralisation::new(spec).expect("a good spec");
        ears.glide_echoes(&heard(&[tap(0.1, energy)], spec), 0)
            .unwrap();
        let left = play(&mut ears, &impulse(16_384));
        for (band, energy) in energy.into_iter().enumerate() {
            let found = amplitude_at(&left, 1000.0 * 2_f64.powi(band as i32 - 4));
            let off_db = 20.0 * (found / energy.sqrt()).log10();
            let bound_db = if band < 2 { 0.75 } else { 0.06 };
            assert!(
                off_db.abs() < bound_db,
                "{} Hz: {off_db} dB",
                BANDS_HZ[band]
            );
        }
    }
}

/// Protects the late part: it equals the impulse response of its echogram, at the right time.
#[test]
fn the_late_part_is_the_impulse_response() {
    let spec = spec(true);
    let mut echogram = Echogram::new(1e-3, 2).expect("good bins");
    for bin in 0..200 {
        let energy = (-f64::from(bin) / 40.0).exp() * 1e-3;
        let seconds = f64::from(bin) * 1e-3;
        echogram
            .add(0, seconds, &[energy; BAND_COUNT], DVec3::X)
            .unwrap();
    }
    let settings = ImpulseSettings {
        format: Format::Stereo,
        ..ImpulseSettings::new(0.4)
    };
    let response = ImpulseResponse::new(&[], &echogram, &axes(), &settings).expect("good");
    let mut heard = Heard::of_late(response.channels(), spec);
    let mut ears = Auralisation::new(spec).expect("a good spec");
    assert!(ears.glide_late(&mut heard, 0).unwrap());
    let left = play(&mut ears, &impulse(8 * BLOCK));
    for (left, expected) in left.iter().zip(&response.channels()[0]) {
        assert!((left - expected).abs() < 1e-6);
    }
}

/// The largest step in the sound alone, and the largest step in the output.
fn steps(sound: &[f32], heard: &[f32]) -> (f32, f32) {
    let largest = |samples: &[f32]| {
        let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.fold(0.0, f32::max)
    };
    (largest(sound), largest(heard))
}

fn sine(frequency_hz: f64, length: usize) -> Vec<f32> {
    let turn = |index: usize| TAU * frequency_hz * index as f64 / f64::from(RATE_HZ);
    (0..length).map(|index| turn(index).sin() as f32).collect()
}

/// Protects from clicks and zipper noise: the output has no larger step than the sound while echoes move, start, end
/// and jump, and while late parts change.
#[test]
fn nothing_clicks() {
    for has_bands in [false, true] {
        let spec = spec(has_bands);
        let mut ears = Auralisation::new(spec).expect("a good spec");
        let sound = sine(300.0, 60 * 1600);
        let mut left: Vec<f32> = Vec::new();
        for (frame, mono) in sound.chunks(1600).enumerate() {
            let mut taps = vec![tap(0.02 + 0.0005 * frame as f64, [0.3; BAND_COUNT])];
            // One echo that alternates between on and off, and one echo that jumps.
            taps.push(tap(0.1 + 0.2 * (frame % 2) as f64, [0.05; BAND_COUNT]));
            if frame % 3 == 0 {
                taps.push(tap(0.05, [0.1; BAND_COUNT]));
            }
            ears.glide_echoes(&heard(&taps, spec), 1600).unwrap();
            let gain = if frame % 8 < 4 { 0.0 } else { 0.2 };
            let mut late = Heard::of_late(&[vec![0.0, gain], vec![0.0, gain]], spec);
            ears.glide_late(&mut late, 3000).unwrap();
            let mut stereo = vec![0.0; 2 * mono.len()];
            ears.add(mono, &mut stereo).unwrap();
            left.extend(stereo.iter().step_by(2));
        }
        // Together the echoes have an amplitude of at most √0.3 + 2 √0.05 + √0.1 + 0.2.
        let most = 0.3_f32.sqrt() + 2.0 * 0.05_f32.sqrt() + 0.1_f32.sqrt() + 0.2;
        let (own, found) = steps(&sound, &left);
        assert!(found < own * most * 1.05, "{has_bands}: {found} {own}");
        assert!(left.iter().any(|sample| sample.abs() > 0.5));
    }
}

/// Protects the Doppler shift: the pitch of a source that moves away at a tenth of the speed of sound is a tenth lower.
#[test]
fn a_source_that_goes_away_sounds_lower() {
    let spec = spec(false);
    let mut ears = Auralisation::new(spec).expect("a good spec");
    let sound = sine(1000.0, 40 * 1600);
    let mut left: Vec<f32> = Vec::new();
    for (frame, mono) in sound.chunks(1600).enumerate() {
        let seconds = 0.01 + 0.1 * frame as f64 * 1600.0 / f64::from(RATE_HZ);
        let glide = if frame == 0 { 0 } else { 1600 };
        ears.glide_echoes(&heard(&[tap(seconds, [1.0; BAND_COUNT])], spec), glide)
            .unwrap();
        let mut stereo = vec![0.0; 2 * mono.len()];
        ears.add(mono, &mut stereo).unwrap();
        left.extend(stereo.iter().step_by(2));
    }
    let tail = &left[8_000..56_000];
    let rises = tail
        .windows(2)
        .filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0);
    let count = rises.count() as f64;
    assert!((count - 900.0).abs() <= 2.0, "{count} Hz");
}

/// Protects silence: removed echoes fade out and leave no residue.
#[test]
fn nothing_stays_behind() {
    let spec = spec(true);
    let mut ears = Auralisation::new(spec).expect("a good spec");
    ears.glide_echoes(&heard(&[tap(0.01, [1.0; BAND_COUNT])], spec), 0)
        .unwrap();
    let mut late = Heard::of_late(&[vec![0.5; 900], vec![0.5; 900]], spec);
    ears.glide_late(&mut late, 0).unwrap();
    play(&mut ears, &sine(500.0, 9600));
    let mut silence = Heard::silence();
    ears.glide_echoes(&silence, 960).unwrap();
    assert!(ears.glide_late(&mut silence, 960).unwrap());
    let left = play(&mut ears, &sine(500.0, 9600));
    assert!(left[4 * BLOCK..].iter().all(|sample| *sample == 0.0));
}

/// Protects memory and silence from invalid numbers: each is rejected by name, before any memory is allocated for it.
#[test]
fn bad_specs_are_refused() {
    let good = spec(false);
    let bad = |rate_hz, longest_s| Spec {
        rate_hz,
        longest_s,
        ..good
    };
    for spec in [
        bad(0, 0.5),
        bad(u32::MAX, 0.5),
        bad(RATE_HZ, 1e9),
        bad(RATE_HZ, 0.0),
        bad(RATE_HZ, -1.0),
        bad(RATE_HZ, f64::NAN),
        bad(RATE_HZ, f64::INFINITY),
    ] {
        assert!(Auralisation::new(spec).is_err(), "{spec:?}");
        assert!(Heard::of_paths(&[], &axes(), spec).is_err(), "{spec:?}");
        assert!(
            super::Player::new(Vec::new(), spec, 1.0).is_err(),
            "{spec:?}"
        );
    }
    assert!(super::Player::new(Vec::new(), good, f32::NAN).is_err());
}

/// Protects a player from delays of another rate or length, and from slices of the wrong length: each is rejected, and
/// the current sound continues.
#[test]
fn what_was_made_for_another_player_is_refused() {
    let own = spec(false);
    let mut ears = Auralisation::new(own).expect("a good spec");
    ears.glide_echoes(&heard(&[tap(0.01, [0.25; BAND_COUNT])], own), 0)
        .unwrap();
    for other in [
        spec(true),
        Spec {
            rate_hz: 44_100,
            ..own
        },
        Spec {
            longest_s: 3.0,
            ..own
        },
    ] {
        let mut heard = heard(&[tap(0.02, [1.0; BAND_COUNT])], other);
        assert!(ears.glide_echoes(&heard, 0).is_err(), "{other:?}");
        assert!(ears.glide_late(&mut heard, 0).is_err(), "{other:?}");
    }
    assert!(ears.glide_echoes(&Heard::silence(), u32::MAX).is_ok());
    ears.glide_echoes(&heard(&[tap(0.01, [0.25; BAND_COUNT])], own), 0)
        .unwrap();
    for stereo in [0, 1, 3, 5, 6] {
        let refused = ears.add(&[0.5; 2], &mut vec![0.0; stereo]);
        let mono = 2;
        assert_eq!(
            refused,
            Err(ResponseError::BadStereoLength { mono, stereo })
        );
    }
    let left = play(&mut ears, &impulse(4096));
    assert!((left[480] - 0.5).abs() < 1e-4, "{}", left[480]);
}

/// Protects a player from a NaN sample, whose effect would last as long as the response.
#[test]
fn a_sample_that_is_no_number_is_silent() {
    let spec = spec(true);
    let mut ears = Auralisation::new(spec).expect("a good spec");
    ears.glide_echoes(&heard(&[tap(0.01, [0.25; BAND_COUNT])], spec), 0)
        .unwrap();
    let mut late = Heard::of_late(&[vec![f32::NAN, 0.1], vec![0.1, f32::INFINITY]], spec);
    ears.glide_late(&mut late, 0).unwrap();
    let mut sound = impulse(4096);
    (sound[7], sound[9]) = (f32::NAN, f32::INFINITY);
    let left = play(&mut ears, &sound);
    assert!(left.iter().all(|sample| sample.is_finite()));
    assert!(left.iter().any(|sample| *sample != 0.0));
}
