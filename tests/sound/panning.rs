//! Panning laws, the mixer's glide, and frames, without a device and without a graphics card.

use crate::measures::{largest_step, rms};
use echomarch::audio::{AudioError, FrameBlocks, Gains, Mixer, PanningLaw, Sound};
use proptest::prelude::*;

const LAWS: [PanningLaw; 2] = [PanningLaw::Linear, PanningLaw::ConstantPower];

fn any_law() -> impl Strategy<Value = PanningLaw> {
    prop::sample::select(&LAWS[..])
}

proptest! {
    #[test]
    fn linear_gains_sum_to_one(pan in -1.0f32..=1.0) {
        let gains = PanningLaw::Linear.gains(pan);
        prop_assert!((gains.left + gains.right - 1.0).abs() < 1e-6);
        prop_assert!((gains.right - gains.left - pan).abs() < 1e-6);
    }

    #[test]
    fn constant_power_squares_sum_to_one(pan in -1.0f32..=1.0) {
        let Gains { left, right } = PanningLaw::ConstantPower.gains(pan);
        prop_assert!((left * left + right * right - 1.0).abs() < 1e-6);
    }

    #[test]
    fn mirrored_pans_give_mirrored_gains(law in any_law(), pan in any::<f32>()) {
        let (here, there) = (law.gains(pan), law.gains(-pan));
        prop_assert_eq!((here.left, here.right), (there.right, there.left));
    }

    #[test]
    fn any_pan_gives_gains_between_zero_and_one(law in any_law(), bits in any::<u32>()) {
        let Gains { left, right } = law.gains(f32::from_bits(bits));
        prop_assert!((0.0..=1.0).contains(&left) && (0.0..=1.0).contains(&right));
    }

    /// A constant sound makes the gains visible: no step may exceed the slope of the block.
    #[test]
    fn gains_glide_without_a_step(
        law in any_law(),
        blocks in prop::collection::vec((1usize..300, -1.0f32..=1.0), 1..12),
    ) {
        let mut mixer = Mixer::new(law);
        let mut last = law.gains(blocks[0].1);
        for (length, pan) in blocks {
            let target = law.gains(pan);
            let slope = (target.left - last.left, target.right - last.right);
            let mut out = vec![0.0; 2 * length];
            mixer.mix(&vec![1.0; length], pan, &mut out).unwrap();
            let mut before = last;
            for pair in out.chunks_exact(2) {
                let step = (pair[0] - before.left, pair[1] - before.right);
                prop_assert!((step.0 - slope.0 / length as f32).abs() < 1e-6);
                prop_assert!((step.1 - slope.1 / length as f32).abs() < 1e-6);
                before = Gains { left: pair[0], right: pair[1] };
            }
            prop_assert!((before.left - target.left).abs() < 1e-6);
            prop_assert_eq!(mixer.current(), Some(target));
            last = target;
        }
    }

    #[test]
    fn frames_tile_at_any_rate(fps in 0.5f64..1000.0, i in 0u64..10_000_000) {
        let frames = FrameBlocks::new(fps, Sound::SAMPLE_RATE).unwrap();
        let (now, next) = (frames.samples(i), frames.samples(i + 1));
        prop_assert_eq!(now.end, next.start);
        let exact = i as f64 * f64::from(Sound::SAMPLE_RATE) / fps;
        prop_assert!((now.start as f64 - exact).abs() <= 0.5);
    }
}

#[test]
fn the_ends_and_the_centre_have_the_documented_levels() {
    let half_power = std::f32::consts::FRAC_1_SQRT_2;
    for (law, centre) in [
        (PanningLaw::Linear, 0.5),
        (PanningLaw::ConstantPower, half_power),
    ] {
        let left = law.gains(-1.0);
        let right = law.gains(1.0);
        assert_eq!((left.left, left.right), (1.0, 0.0), "{law}");
        assert_eq!((right.left, right.right), (0.0, 1.0), "{law}");
        for pan in [0.0, f32::NAN] {
            let gains = law.gains(pan);
            assert!((gains.left - centre).abs() < 1e-7, "{law}");
            assert_eq!(gains.left, gains.right, "{law}");
        }
        assert_eq!(law.gains(-7.0), left);
        assert_eq!(law.gains(f32::INFINITY), right);
    }
}

#[test]
fn laws_are_named() {
    for law in LAWS {
        assert_eq!(law.to_string().parse::<PanningLaw>().unwrap(), law);
    }
    let error = "Linear-ish".parse::<PanningLaw>().unwrap_err();
    assert!(matches!(error, AudioError::UnknownPanningLaw { .. }));
    assert!(error.is_bad_input());
    assert!(error.to_string().contains("Linear-ish"), "{error}");
}

#[test]
fn a_sweep_changes_the_levels_steadily_and_never_clicks() {
    for law in LAWS {
        sweep(law);
    }
}

fn sweep(law: PanningLaw) {
    const FRAMES: u64 = 60;
    let frames = FrameBlocks::new(30.0, Sound::SAMPLE_RATE).unwrap();
    let mut sound = Sound::parse("sine:440", Sound::SAMPLE_RATE).unwrap();
    let mut mixer = Mixer::new(law);
    let (mut source, mut stereo) = (Vec::new(), Vec::new());
    let mut steepest = 0.0f32;
    for i in 0..FRAMES {
        let mut mono = vec![0.0; frames.len(i)];
        let mut out = vec![0.0; 2 * mono.len()];
        sound.fill(&mut mono);
        let pan = -1.0 + 2.0 * i as f32 / (FRAMES - 1) as f32;
        let before = mixer.current().unwrap_or(law.gains(pan));
        mixer.mix(&mono, pan, &mut out).unwrap();
        let change = law.gains(pan);
        let change = (change.left - before.left)
            .abs()
            .max((change.right - before.right).abs());
        steepest = steepest.max(change / mono.len() as f32);
        source.extend(mono);
        stereo.extend(out);
    }
    let peak = source.iter().fold(0.0f32, |peak, s| peak.max(s.abs()));
    let allowed = largest_step(&source) + steepest * peak + 1e-6;
    let channel = |c: usize| -> Vec<f32> { stereo.iter().skip(c).step_by(2).copied().collect() };
    let (left, right) = (channel(0), channel(1));
    assert!(largest_step(&left) <= allowed, "{law}");
    assert!(largest_step(&right) <= allowed, "{law}");
    // Levels over tenths of a second, each with 44 whole periods.
    let levels = |samples: &[f32]| -> Vec<f64> { samples.chunks_exact(4800).map(rms).collect() };
    assert!(levels(&left).is_sorted_by(|a, b| a > b), "{law}");
    assert!(levels(&right).is_sorted_by(|a, b| a < b), "{law}");
}

#[test]
fn the_first_block_starts_at_its_own_gains() {
    let mut mixer = Mixer::new(PanningLaw::Linear);
    mixer.mix(&[], 0.3, &mut []).unwrap();
    assert_eq!(mixer.current(), None);
    let mut out = [0.0; 6];
    mixer.mix(&[1.0; 3], -1.0, &mut out).unwrap();
    assert_eq!(out, [1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    mixer.reset();
    mixer.mix(&[1.0; 3], 1.0, &mut out).unwrap();
    assert_eq!(out, [0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
}

#[test]
fn silence_is_glided_to_and_odd_gains_do_no_harm() {
    let mut mixer = Mixer::new(PanningLaw::Linear);
    let mut out = [0.0; 8];
    mixer.mix(&[1.0; 4], -1.0, &mut out).unwrap();
    mixer.mix_to(&[1.0; 4], Gains::SILENT, &mut out).unwrap();
    assert_eq!(out, [0.75, 0.0, 0.5, 0.0, 0.25, 0.0, 0.0, 0.0]);
    let odd = Gains {
        left: f32::NAN,
        right: f32::INFINITY,
    };
    mixer.mix_to(&[1.0; 4], odd, &mut out).unwrap();
    assert_eq!(out, [0.0; 8]);
}

/// Protects players from slices of the wrong length: they get an error, and the mixer stays silent.
#[test]
fn a_stereo_slice_of_the_wrong_length_is_refused() {
    let mut mixer = Mixer::new(PanningLaw::Linear);
    for stereo in [0, 4, 7, 9] {
        let refused = mixer.mix(&[0.5; 4], 0.0, &mut vec![0.0; stereo]);
        let error = refused.unwrap_err().to_string();
        assert!(
            error.contains("two stereo samples for each mono sample"),
            "{error}"
        );
        assert_eq!(mixer.current(), None);
    }
}

#[test]
fn frames_tile_without_gap_or_drift() {
    for fps in [24.0, 30.0, 29.97, 30_000.0 / 1001.0, 60.0] {
        let frames = FrameBlocks::new(fps, Sound::SAMPLE_RATE).unwrap();
        let mut next = 0;
        let mut lengths = (usize::MAX, 0);
        for i in 0..200_000 {
            let samples = frames.samples(i);
            assert_eq!(samples.start, next, "{fps}");
            next = samples.end;
            lengths = (lengths.0.min(frames.len(i)), lengths.1.max(frames.len(i)));
        }
        let exact = 200_000.0 * 48_000.0 / fps;
        assert!((next as f64 - exact).abs() <= 0.5, "{fps}");
        assert!(lengths.1 - lengths.0 <= 1, "{fps}: {lengths:?}");
        assert!(lengths.1 <= frames.longest(), "{fps}");
    }
    let frames = FrameBlocks::new(24.0, 48_000).unwrap();
    assert_eq!(frames.samples(2), 4000..6000);
}

#[test]
fn bad_rates_are_refused() {
    for fps in [0.0, -30.0, f64::NAN, f64::INFINITY] {
        let error = FrameBlocks::new(fps, Sound::SAMPLE_RATE).unwrap_err();
        assert!(matches!(error, AudioError::BadFrameRate { .. }), "{error}");
        assert!(error.is_bad_input());
    }
    let error = FrameBlocks::new(30.0, 0).unwrap_err();
    assert!(matches!(error, AudioError::BadSampleRate { .. }), "{error}");
}
