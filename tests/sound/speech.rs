//! The synthetic voice: its spectrum, its level, its pauses, and its repeatability.

use echomarch::audio::Sound;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;
use std::f64::consts::PI;

fn pull(text: &str, rate: u32, count: usize) -> Vec<f32> {
    let mut out = vec![f32::NAN; count];
    Sound::parse(text, rate).unwrap().fill(&mut out);
    out
}

/// The share of the energy between two frequencies, in hertz.
fn share(samples: &[f32], rate: u32, low_hz: f64, high_hz: f64) -> f64 {
    let mut bins: Vec<Complex<f64>> = samples.iter().map(|&s| f64::from(s).into()).collect();
    let count = bins.len();
    FftPlanner::new().plan_fft_forward(count).process(&mut bins);
    let (mut within, mut all) = (0.0, 0.0);
    for (i, bin) in bins[..count / 2].iter().enumerate() {
        let frequency_hz = i as f64 * f64::from(rate) / count as f64;
        all += bin.norm_sqr();
        if (low_hz..=high_hz).contains(&frequency_hz) {
            within += bin.norm_sqr();
        }
    }
    within / all
}

fn level_db(samples: &[f32]) -> f64 {
    let squares: f64 = samples.iter().map(|&s| f64::from(s).powi(2)).sum();
    10.0 * (squares / samples.len() as f64).log10()
}

#[test]
fn the_energy_lies_where_speech_has_it() {
    for rate in [8_000, 22_050, Sound::SAMPLE_RATE] {
        for seed in 0..4 {
            let voice = pull(&format!("speech:{seed}"), rate, rate as usize * 10);
            let share = share(&voice, rate, 200.0, 1000.0);
            println!("{rate} Hz, seed {seed}: {:.1} %", 100.0 * share);
            assert!(share > 0.7, "{rate} Hz, seed {seed}: {share}");
        }
    }
}

#[test]
fn it_is_as_loud_as_the_other_sounds_and_never_clips() {
    let sine = 20.0 * f64::from(Sound::SINE_AMPLITUDE / 2f32.sqrt()).log10();
    let noise = 20.0 * f64::from(Sound::NOISE_AMPLITUDE / 3f32.sqrt()).log10();
    for rate in [1_000, 4_000, 11_025, Sound::SAMPLE_RATE, 192_000] {
        for seed in 0..4 {
            let voice = pull(&format!("speech:{seed}"), rate, rate as usize * 10);
            let peak = voice.iter().fold(0.0f32, |peak, s| peak.max(s.abs()));
            assert!(peak <= Sound::SPEECH_PEAK, "{rate} Hz: {peak}");
            let level = level_db(&voice);
            println!("{rate} Hz, seed {seed}: {level:.1} dB, peak {peak:.2}");
            if rate >= 4_000 {
                assert!(level > noise.min(sine) - 6.0 && level < noise.max(sine) + 3.0);
            }
        }
    }
}

#[test]
fn it_pauses_between_syllables_and_longer_between_phrases() {
    let voice = pull(
        "speech",
        Sound::SAMPLE_RATE,
        Sound::SAMPLE_RATE as usize * 30,
    );
    let silent: Vec<bool> = voice
        .chunks(480)
        .map(|piece| level_db(piece) < -60.0)
        .collect();
    let pauses: Vec<usize> = silent
        .chunk_by(|a, b| a == b)
        .filter(|run| run[0])
        .map(<[bool]>::len)
        .collect();
    let long = pauses
        .iter()
        .filter(|&&hundredths| hundredths >= 35)
        .count();
    assert!((10..=16).contains(&long), "{pauses:?}");
    assert!(pauses.len() >= 40, "{pauses:?}");
}

/// A click would have energy far above the voice's own frequencies. The voice is first faded in and out, because a cut
/// within a vowel would have more energy there than a click.
#[test]
fn it_does_not_click() {
    for seed in 0..4 {
        let mut voice = pull(&format!("speech:{seed}"), Sound::SAMPLE_RATE, 48_000 * 20);
        let count = voice.len() as f64;
        for (i, sample) in voice.iter_mut().enumerate() {
            *sample *= ((i as f64 + 0.5) / count * PI).sin().powi(2) as f32;
        }
        let above = share(&voice, Sound::SAMPLE_RATE, 6_000.0, 24_000.0);
        assert!(above < 1e-7, "seed {seed}: {above:e}");
    }
}

#[test]
fn it_is_the_same_for_a_seed_and_goes_on_over_blocks() {
    let whole = pull("speech:3", Sound::SAMPLE_RATE, 200_000);
    let mut sound = Sound::parse("speech:3", Sound::SAMPLE_RATE).unwrap();
    let mut pieces = Vec::new();
    for length in [1, 239, 240, 241, 777].iter().cycle() {
        let mut piece = vec![0.0; *length];
        sound.fill(&mut piece);
        pieces.extend(piece);
        if pieces.len() >= whole.len() {
            break;
        }
    }
    assert_eq!(whole, pieces[..whole.len()]);
    let mut later = vec![0.0; 1000];
    sound.seek(123_456);
    sound.fill(&mut later);
    assert_eq!(later, whole[123_456..124_456]);
    assert_ne!(whole, pull("speech:4", Sound::SAMPLE_RATE, 200_000));
}

/// The voice is the same function of time at every rate.
#[test]
fn another_rate_says_the_same() {
    let (slow, fast) = (
        pull("speech", 24_000, 48_000),
        pull("speech", 48_000, 96_000),
    );
    for (i, (a, b)) in slow.iter().zip(fast.iter().step_by(2)).enumerate() {
        assert!((a - b).abs() < 1e-3, "sample {i}: {a} and {b}");
    }
}
