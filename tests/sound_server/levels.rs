//! How loud what was heard is, beside the noise that was played.

use echomarch::audio::NOISE_AMPLITUDE;

pub fn rms(samples: impl Iterator<Item = f32>) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for sample in samples {
        squares += f64::from(sample).powi(2);
        count += 1.0;
    }
    (squares / count).sqrt()
}

/// Left and right gains over so many frames each: levels, divided by that of the noise.
pub fn gains(stereo: &[f32], frames: usize) -> Vec<[f64; 2]> {
    let full = f64::from(NOISE_AMPLITUDE) / 3f64.sqrt();
    let gain = |piece: &[f32], which| rms(piece.iter().skip(which).step_by(2).copied()) / full;
    stereo
        .chunks_exact(2 * frames)
        .map(|piece| [gain(piece, 0), gain(piece, 1)])
        .collect()
}

pub fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// How far the louder and the quieter channel are from what is wanted, in decibels; a channel
/// that is to be silent counts as right below −60 dB.
pub fn error_db(gains: [f64; 2], wanted: [f64; 2]) -> f64 {
    let of = |gain: f64, wanted: f64| {
        if wanted < 1e-3 {
            if gain < 1e-3 { 0.0 } else { f64::INFINITY }
        } else {
            db(gain / wanted).abs()
        }
    };
    of(gains[0], wanted[0]).max(of(gains[1], wanted[1]))
}
