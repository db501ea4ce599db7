//! Compares impulse responses with their taps and echograms.

use super::*;
use crate::bands::{BANDS_HZ, Bands};
use glam::DVec3;
use realfft::RealFftPlanner;

pub(super) const RATE_HZ: f64 = 48_000.0;

fn axes() -> ListenerAxes {
    ListenerAxes::new(DVec3::NEG_Z, DVec3::Y).expect("good axes")
}

pub(super) fn response(
    taps: &[Tap],
    echogram: &Echogram,
    format: Format,
    seed: u64,
) -> ImpulseResponse {
    let settings = ImpulseSettings {
        format,
        seed,
        ..ImpulseSettings::new(1.0)
    };
    ImpulseResponse::new(taps, echogram, &axes(), &settings).expect("good settings")
}

pub(super) fn empty() -> Echogram {
    Echogram::new(1e-3, 1).expect("a good bin")
}

pub(super) fn tap(seconds: f64, energy: Bands, from: DVec3) -> Tap {
    Tap {
        seconds,
        energy,
        direction: -from,
    }
}

/// The energy that corresponds to amplitude 1.
pub(super) const ONE: Bands = [1.0 / (4.0 * PI); BAND_COUNT];

/// The band-limited interpolation of the response between its samples.
fn at(samples: &[f32], place: f64) -> f64 {
    let sinc = |offset: f64| {
        if offset == 0.0 {
            1.0
        } else {
            (PI * offset).sin() / (PI * offset)
        }
    };
    let terms = samples.iter().enumerate();
    terms
        .map(|(index, sample)| f64::from(*sample) * sinc(place - index as f64))
        .sum()
}

/// Protects times and amplitudes: a source at 1 m gives amplitude 1 at its exact time, and differences between bands do
/// not move the peak.
#[test]
fn a_tap_is_where_it_belongs() {
    let seconds = 0.010_006_9;
    let place = seconds * RATE_HZ;
    let flat = response(&[tap(seconds, ONE, DVec3::X)], &empty(), Format::Mono, 0);
    let samples = &flat.channels()[0][..1000];
    // A window of 65 samples removes frequencies above 0.45 of the rate: a few per cent of the peak.
    assert!(
        (at(samples, place) - 1.0).abs() < 0.05,
        "{}",
        at(samples, place)
    );
    let mut uneven = ONE;
    for (band, energy) in uneven.iter_mut().enumerate() {
        *energy *= 0.6_f64.powi(band as i32);
    }
    let uneven = response(&[tap(seconds, uneven, DVec3::X)], &empty(), Format::Mono, 0);
    for response in [flat, uneven] {
        let samples = &response.channels()[0][..1000];
        let steps = (-100..=100).map(|step| place + f64::from(step) * 0.002);
        let peak = steps.max_by(|a, b| at(samples, *a).total_cmp(&at(samples, *b)));
        // Frequencies above 0.45 of the rate have a phase error: 0.02 samples are 0.4 µs.
        assert!((peak.expect("a peak") - place).abs() <= 0.02);
    }
}

/// Protects a tap's bands: the spectrum at each band's centre.
#[test]
fn a_tap_has_the_energy_of_its_bands() {
    let energy: Bands = std::array::from_fn(|band| ONE[0] * (1.0 + band as f64) / 8.0);
    let response = response(&[tap(0.3, energy, DVec3::X)], &empty(), Format::Mono, 0);
    for (band, energy) in energy.iter().enumerate() {
        let step = 2.0 * PI * 62.5 * 2_f64.powi(band as i32) / RATE_HZ;
        let samples = response.channels()[0].iter().enumerate();
        let (real, imaginary) = samples.fold((0.0, 0.0), |sum: (f64, f64), (index, sample)| {
            let (sin, cos) = (step * index as f64).sin_cos();
            (
                sum.0 + f64::from(*sample) * cos,
                sum.1 - f64::from(*sample) * sin,
            )
        });
        let found = real.hypot(imaginary);
        // The window has a ripple of 2 in 10,000; samples are f32.
        assert!(
            (found / amplitude(*energy) - 1.0).abs() < 1e-3,
            "{band}: {found}"
        );
    }
}

/// Protects the conventions of AmbiX: order W Y Z X, SN3D, y to the left; left and right are not
/// swapped.
#[test]
fn directions_are_encoded() {
    let diagonal = DVec3::new(1.0, 1.0, -1.0).normalize();
    let third = 1.0 / 3.0_f64.sqrt();
    // −z is ahead, x is right, y is up.
    for (from, gains) in [
        (DVec3::NEG_Z, [1.0, 0.0, 0.0, 1.0]),
        (DVec3::NEG_X, [1.0, 1.0, 0.0, 0.0]),
        (DVec3::Y, [1.0, 0.0, 1.0, 0.0]),
        (diagonal, [1.0, -third, third, third]),
    ] {
        let made = response(
            &[tap(0.01, ONE, from)],
            &empty(),
            Format::AmbiX(AmbisonicOrder::FIRST),
            0,
        );
        for (channel, gain) in made.channels().iter().zip(gains) {
            assert!((f64::from(channel[480]) - gain).abs() < 1e-6, "{from}");
        }
    }
    for (from, gains) in [
        (DVec3::X, [0.0, 1.0]),
        (DVec3::NEG_X, [1.0, 0.0]),
        (DVec3::Y, [0.5_f64.sqrt(); 2]),
    ] {
        let made = response(&[tap(0.01, ONE, from)], &empty(), Format::Stereo, 0);
        for (channel, gain) in made.channels().iter().zip(gains) {
            assert!((f64::from(channel[480]) - gain).abs() < 1e-6, "{from}");
        }
    }
}

/// Decays with a different rate in each band, with equal energy from each direction of `from`.
fn decaying(from: &[DVec3]) -> Echogram {
    let mut echogram = empty();
    for bin in 0..1000 {
        let seconds = (f64::from(bin) + 0.5) * 1e-3;
        let energy = |band: usize| (-seconds / (0.1 + 0.05 * band as f64)).exp() * 1e-3;
        for direction in from {
            let energy = std::array::from_fn(|band| energy(band) / from.len() as f64);
            echogram.add(0, seconds, &energy, -*direction).unwrap();
        }
    }
    echogram
}

/// A channel filtered to the given number of octaves on each side of a band's centre.
pub(super) fn filtered(samples: &[f32], band: usize, octaves: f64) -> Vec<f64> {
    let length = samples.len().next_power_of_two();
    let mut planner = RealFftPlanner::new();
    let (forward, inverse) = (
        planner.plan_fft_forward(length),
        planner.plan_fft_inverse(length),
    );
    let mut signal = vec![0.0; length];
    for (value, sample) in signal.iter_mut().zip(samples) {
        *value = f64::from(*sample);
    }
    let mut spectrum = forward.make_output_vec();
    forward
        .process(&mut signal, &mut spectrum)
        .expect("lengths of the plan");
    let centre_hz = 62.5 * 2_f64.powi(band as i32);
    for (bin, value) in spectrum.iter_mut().enumerate() {
        let distance = (bin as f64 * RATE_HZ / length as f64 / centre_hz)
            .log2()
            .abs();
        if distance > octaves {
            *value *= 0.0;
        }
    }
    inverse
        .process(&mut spectrum, &mut signal)
        .expect("lengths of the plan");
    signal.iter().map(|value| value / length as f64).collect()
}

/// Protects the late part's energy, by band and time. Within a third of an octave about its centre only one band
/// contributes, and noise of that bandwidth B has in T seconds an energy with the relative standard deviation 1/√(B T).
/// The test allows four standard deviations, and 3 % for energy spread across the edges of a window.
#[test]
fn noise_follows_the_echogram() {
    const WINDOWS: usize = 4;
    let echogram = decaying(&[DVec3::X]);
    let response = response(&[], &echogram, Format::Mono, 3);
    for (band, centre_hz) in BANDS_HZ.into_iter().enumerate() {
        let octaves = 1.0 / 3.0;
        let found = filtered(&response.channels()[0], band, octaves);
        let width_hz = centre_hz * (octaves.exp2() - (-octaves).exp2());
        let samples = RATE_HZ as usize / WINDOWS;
        // The first window contains the beginning of the sound.
        for window in 1..WINDOWS - 1 {
            let bins = window * 1000 / WINDOWS..(window + 1) * 1000 / WINDOWS;
            let energy: f64 = bins.map(|bin| echogram.energy(bin)[band]).sum();
            let expected = 4.0 * PI * energy * width_hz / (RATE_HZ / 2.0);
            let part = &found[window * samples..(window + 1) * samples];
            let energy: f64 = part.iter().map(|sample| sample * sample).sum();
            let deviation = (width_hz / WINDOWS as f64).powf(-0.5);
            let ratio = energy / expected;
            assert!(
                (ratio - 1.0).abs() < 4.0 * deviation + 0.03,
                "{band} {window}: {ratio}"
            );
        }
    }
}

/// Protects the late part's time structure: the energy of single bins at high frequencies, where a filter is shorter
/// than a bin. Every tenth bin has sound. A millisecond at 8 kHz has B T = 11 over the octave, so 300 bins together
/// have a deviation of 2 %.
#[test]
fn noise_stays_in_its_bins() {
    let mut echogram = empty();
    for bin in 0..1000 {
        let energy = if bin % 10 == 5 {
            [1e-3; BAND_COUNT]
        } else {
            [0.0; BAND_COUNT]
        };
        echogram
            .add(0, (f64::from(bin) + 0.5) * 1e-3, &energy, DVec3::X)
            .unwrap();
    }
    let made = response(&[], &echogram, Format::Mono, 4);
    let found = filtered(&made.channels()[0], 7, 0.5);
    let energy = |offset: usize| -> f64 {
        let bins = (0..100).map(|tenth| (tenth * 10 + offset) * 48);
        bins.map(|begins| {
            found[begins..begins + 48]
                .iter()
                .map(|x| x * x)
                .sum::<f64>()
        })
        .sum()
    };
    let all: f64 = (0..10).map(energy).sum();
    assert!(energy(5) > 0.9 * all, "{}", energy(5) / all);
    assert!(energy(0) < 0.01 * all, "{}", energy(0) / all);
}

/// The mean product of two channels' samples, relative to the mean square of the first.
fn share(response: &ImpulseResponse, a: usize, b: usize) -> f64 {
    let sum = |a: &[f32], b: &[f32]| -> f64 {
        let products = a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b));
        products.sum()
    };
    let channels = response.channels();
    sum(&channels[a], &channels[b]) / sum(&channels[0], &channels[0])
}

/// Protects the directions of the late part: a single direction, and two opposite directions, which first order cannot
/// distinguish from a diffuse field. The decaying noise has about 2000 independent values. The standard deviation is 2
/// %, and the test allows four standard deviations.
#[test]
fn noise_comes_from_where_the_energy_came() {
    let left = response(
        &[],
        &decaying(&[DVec3::NEG_X]),
        Format::AmbiX(AmbisonicOrder::FIRST),
        5,
    );
    for (channel, expected) in [1.0, 1.0, 0.0, 0.0].into_iter().enumerate() {
        assert!(
            (share(&left, 0, channel) - expected).abs() < 1e-3,
            "{channel}"
        );
    }
    let diffuse = response(
        &[],
        &decaying(&[DVec3::NEG_X, DVec3::X]),
        Format::AmbiX(AmbisonicOrder::FIRST),
        5,
    );
    for channel in 1..4 {
        assert!(share(&diffuse, 0, channel).abs() < 0.08);
        assert!((share(&diffuse, channel, channel) - 1.0 / 3.0).abs() < 0.08);
    }
    // Three quarters of the energy come from ahead, one quarter from behind: half of the energy is directed.
    let ahead = [DVec3::NEG_Z, DVec3::NEG_Z, DVec3::NEG_Z, DVec3::Z];
    let half = response(
        &[],
        &decaying(&ahead),
        Format::AmbiX(AmbisonicOrder::FIRST),
        5,
    );
    assert!((share(&half, 0, 3) - 0.5).abs() < 0.08);
    assert!((share(&half, 3, 3) - (0.5 + 0.5 / 3.0)).abs() < 0.08);
    let right = response(
        &[],
        &decaying(&[DVec3::X, DVec3::X, DVec3::Y]),
        Format::Stereo,
        5,
    );
    let powers = share(&right, 1, 1);
    // A mean of 2/3 to the right: (1 + sin 60°) / (1 − sin 60°).
    assert!((powers / 13.93 - 1.0).abs() < 0.16, "{powers}");
}

/// Protects the reproducibility of a response: the same seed gives the same noise, another seed different noise.
#[test]
fn the_seed_chooses_the_noise() {
    let echogram = decaying(&[DVec3::X]);
    let made = |seed| response(&[], &echogram, Format::Mono, seed);
    assert_eq!(made(1), made(1));
    assert_ne!(made(1), made(2));
}

/// Protects lengths, and the order of samples in a file.
#[test]
fn samples_are_interleaved() {
    let made = response(&[tap(0.0, ONE, DVec3::X)], &empty(), Format::Stereo, 0);
    assert_eq!(
        (made.channels().len(), made.channels()[0].len()),
        (2, 48_000)
    );
    let samples = made.interleaved();
    assert_eq!(samples.len(), 96_000);
    assert!(samples[0].abs() < 1e-6 && (samples[1] - 1.0).abs() < 1e-6);
}

/// Protects the refusal of invalid rates and lengths.
#[test]
fn bad_settings_are_refused() {
    let make = |rate_hz, seconds| {
        let settings = ImpulseSettings {
            rate_hz,
            ..ImpulseSettings::new(seconds)
        };
        ImpulseResponse::new(&[], &empty(), &axes(), &settings)
    };
    assert_eq!(make(100, 1.0), Err(ResponseError::BadRate { rate_hz: 100 }));
    for seconds in [0.0, -1.0, 61.0, f64::NAN] {
        assert!(make(48_000, seconds).is_err());
    }
    assert!(make(44_100, 0.5).is_ok());
}

/// Protects samples from taps out of range: each is rejected with its index and number.
#[test]
fn taps_that_no_sound_has_are_refused() {
    let good = Tap {
        seconds: 0.01,
        energy: [0.1; BAND_COUNT],
        direction: DVec3::X,
    };
    let mut energy = good.energy;
    energy[3] = f64::NAN;
    for bad in [
        Tap {
            seconds: f64::NAN,
            ..good
        },
        Tap {
            seconds: f64::INFINITY,
            ..good
        },
        Tap {
            seconds: -0.01,
            ..good
        },
        Tap { energy, ..good },
        Tap {
            energy: [-1.0; BAND_COUNT],
            ..good
        },
        Tap {
            energy: [1e300; BAND_COUNT],
            ..good
        },
        Tap {
            direction: DVec3::splat(f64::NAN),
            ..good
        },
        Tap {
            direction: DVec3::X * 3.0,
            ..good
        },
    ] {
        let settings = ImpulseSettings::new(0.1);
        let refused = ImpulseResponse::new(&[good, bad], &empty(), &axes(), &settings);
        let is_told = matches!(refused, Err(ResponseError::BadTap { index: 1, .. }));
        assert!(is_told, "{bad:?}: {refused:?}");
    }
    // Samples after the end are dropped, even for very late taps.
    let late = Tap {
        seconds: 1e300,
        ..good
    };
    let settings = ImpulseSettings::new(0.1);
    assert!(ImpulseResponse::new(&[good, late], &empty(), &axes(), &settings).is_ok());
}

/// Protects left and right, and an up vector that is not perpendicular.
#[test]
fn axes_are_right_handed() {
    let axes = ListenerAxes::new(DVec3::NEG_Z * 3.0, DVec3::new(0.0, 2.0, -5.0));
    let axes = axes.expect("good axes");
    assert!(axes.right().distance(DVec3::X) < 1e-15);
    assert!(axes.up().distance(DVec3::Y) < 1e-15);
    let seen = axes.to_listener(DVec3::new(1.0, 2.0, 3.0));
    assert!(seen.distance(DVec3::new(-3.0, -1.0, 2.0)) < 1e-15);
}

/// Protects the refusal of directions that do not define axes.
#[test]
fn one_line_spans_no_axes() {
    assert!(ListenerAxes::new(DVec3::X, DVec3::X * -2.0).is_err());
    assert!(ListenerAxes::new(DVec3::ZERO, DVec3::Y).is_err());
    assert!(ListenerAxes::new(DVec3::X, DVec3::splat(f64::NAN)).is_err());
}
