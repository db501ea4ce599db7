//! Levels of the recorded output, relative to the noise that was played.

use crate::measures::rms;
use echomarch::audio::Sound;

/// Returns the left and right gains over intervals of `frames` frames: the level of each channel divided by the level
/// of the noise.
pub fn gains(stereo: &[f32], frames: usize) -> Vec<[f64; 2]> {
    let full = f64::from(Sound::NOISE_AMPLITUDE) / 3f64.sqrt();
    let gain = |piece: &[f32], which| {
        let channel: Vec<f32> = piece.iter().skip(which).step_by(2).copied().collect();
        rms(&channel) / full
    };
    stereo
        .chunks_exact(2 * frames)
        .map(|piece| [gain(piece, 0), gain(piece, 1)])
        .collect()
}

pub fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// Returns the larger deviation of the two channels from the wanted gains, in decibels; a channel
/// that should be silent is correct below −60 dB.
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

/// Maximum accepted deviation of a level, in decibels: noise over 50 ms is known to 0.1 dB.
const TOLERANCE_DB: f64 = 0.5;

/// A comparison of the recorded output with the positions that were set one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Windows compared, and windows left out because the sound server had a gap in or next to
    /// them.
    pub windows: usize,
    pub left_out: usize,
    /// Compared windows in which the gains moved from one position to a later position.
    pub moving: usize,
    /// Compared windows that are neither at the position of the windows before them, nor between that position and a
    /// later position.
    pub wrong: usize,
}

/// Levels of the recorded output.
#[derive(Debug)]
pub struct Heard {
    /// Left and right gain in each window; `None` for windows left out.
    gains: Vec<Option<[f64; 2]>>,
}

impl Heard {
    /// Measures windows of `window_ms` milliseconds at 48 kHz.
    pub fn new(stereo: &[f32], window_ms: usize) -> Self {
        let frames = 48 * window_ms;
        // Noise is never zero for a millisecond in both channels.
        let is_gap = |piece: &[f32]| piece.chunks(96).any(|ms| ms.iter().all(|&s| s == 0.0));
        let gaps: Vec<bool> = stereo.chunks_exact(2 * frames).map(is_gap).collect();
        // Next to a gap a stream may rise from silence or fade to silence.
        let is_beside = |at: usize| gaps[at.saturating_sub(1)..].iter().take(3).any(|gap| *gap);
        let kept = |(at, gains)| (!is_beside(at)).then_some(gains);
        Self {
            gains: gains(stereo, frames)
                .into_iter()
                .enumerate()
                .map(kept)
                .collect(),
        }
    }

    /// Compares with positions, given as shares of the right side (left and right add up to 1) in the order in which
    /// they were set. The time at which a position is applied is not checked, because a busy machine applies it late or
    /// skips it. Each window must have the levels of one position or levels between two positions. No position may
    /// return after a later position was heard.
    pub fn follow(&self, shares: &[f64]) -> Comparison {
        let mut places = shares.to_vec();
        places.dedup();
        let mut compared = Comparison {
            windows: 0,
            left_out: 0,
            moving: 0,
            wrong: 0,
        };
        // For each position: the lowest numbers of wrong and of moving windows with which the sound can now be at this
        // position.
        let mut costs = vec![(0usize, 0usize); places.len()];
        for gains in &self.gains {
            let Some(gains) = gains else {
                compared.left_out += 1;
                let mut best = costs[0];
                for cost in &mut costs {
                    best = best.min(*cost);
                    *cost = best;
                }
                continue;
            };
            compared.windows += 1;
            costs = step(&costs, &places, *gains);
        }
        (compared.wrong, compared.moving) = *costs.iter().min().unwrap();
        compared
    }
}

/// Advances by one window.
fn step(costs: &[(usize, usize)], places: &[f64], gains: [f64; 2]) -> Vec<(usize, usize)> {
    let stay = |at: usize| {
        let (wrong, moving) = *costs[..=at].iter().min().unwrap();
        let is_there = error_db(gains, [1.0 - places[at], places[at]]) <= TOLERANCE_DB;
        (wrong + usize::from(!is_there), moving)
    };
    let mut next: Vec<_> = (0..places.len()).map(stay).collect();
    // The sound moves from one position to a later position, through all positions in between. It may or may not have
    // arrived by the end of the window.
    for from in 0..places.len() {
        let (wrong, moving) = costs[from];
        let on_the_way = (wrong, moving + 1);
        let (mut low, mut high) = (places[from], places[from]);
        for to in from + 1..places.len() {
            (low, high) = (low.min(places[to]), high.max(places[to]));
            if is_between(gains[1], low, high) && is_between(gains[0], 1.0 - high, 1.0 - low) {
                next[from] = next[from].min(on_the_way);
                next[to] = next[to].min(on_the_way);
            }
        }
    }
    next
}

fn is_between(gain: f64, low: f64, high: f64) -> bool {
    // A silent side is correct below −60 dB.
    const SILENT: f64 = 1e-3;
    db(gain.max(SILENT) / low.max(SILENT)) >= -TOLERANCE_DB
        && db(gain.max(SILENT) / high.max(SILENT)) <= TOLERANCE_DB
}
