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

/// Seconds that the gains take to glide to others.
const GLIDE_S: f64 = 0.02;

/// Shares of right that were set, each with its time in seconds: left and right add up to 1. Those
/// that follow one another faster than blocks of sound must lie close together: which of them a
/// block took is not known.
pub struct Log(pub Vec<(f64, f64)>);

/// What was heard beside a log.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// Windows that were compared, and those that were not, because the server had nothing to play.
    pub windows: usize,
    pub gaps: usize,
    /// Seconds from the log's clock to what was heard.
    pub offset_s: f64,
    /// How far the worst of all windows that were compared is from what is wanted, in decibels.
    pub worst_db: f64,
    /// Windows more than half a decibel off.
    pub off: usize,
}

impl Log {
    /// Where the gains stand, millisecond by millisecond from the log's start: they glide to each
    /// place from where they are.
    fn glided(&self) -> Vec<f64> {
        let start = self.0[0].0;
        let (mut from, mut set, mut to) = (self.0[0].1, f64::NEG_INFINITY, self.0[0].1);
        let at = |from: f64, set: f64, to: f64, time: f64| {
            from + (to - from) * ((time - set) / GLIDE_S).min(1.0)
        };
        let mut events = self.0.iter().peekable();
        let count = ((self.0.last().unwrap().0 - start) * 1000.0) as usize;
        (0..count)
            .map(|ms| {
                let time = start + ms as f64 / 1000.0;
                while let Some((next, share)) = events.next_if(|event| event.0 <= time) {
                    if *share != to {
                        (from, set, to) = (at(from, set, to, *next), *next, *share);
                    }
                }
                at(from, set, to, time)
            })
            .collect()
    }

    /// Compares each channel in each window of `heard`, which begins at `begin_s` on the log's
    /// clock, with what was set. One offset holds for all windows. It is looked for over the half
    /// second that is plausible: where the recording began is known to some tens of milliseconds
    /// and a server without hardware makes its sound ahead, so that it may be negative. A place is
    /// taken when the next block is made, up to `block_s` seconds after it was set: gains between
    /// those are right.
    pub fn compare(&self, heard: &Heard, begin_s: f64, block_s: f64) -> Comparison {
        let glided = self.glided();
        let squares = |of: fn(f64) -> f64| {
            let mut sums = vec![0.0];
            for &share in &glided {
                sums.push(sums.last().unwrap() + of(share).powi(2));
            }
            sums
        };
        let sums = [squares(|share| 1.0 - share), squares(|share| share)];
        let begin_ms = 1000.0 * (begin_s - self.0[0].0);
        let block_ms = (1000.0 * block_s).ceil() as i64;
        let all = (-100..400i64).map(|offset_ms| {
            let begin_ms = begin_ms.round() as i64 - offset_ms;
            heard.compare(&sums, begin_ms, block_ms, offset_ms as f64 / 1000.0)
        });
        let rank = |c: &Comparison| (c.off, (c.worst_db.min(1e3) * 1e6) as u64);
        // An offset at which nothing is compared is none.
        let fair: Vec<_> = all.collect();
        let most = fair.iter().map(|c| c.windows).max().unwrap();
        let fair = fair.into_iter().filter(|c| c.windows + 12 > most);
        fair.min_by_key(rank).unwrap()
    }
}

/// Levels of what was heard.
pub struct Heard {
    gains: Vec<[f64; 2]>,
    is_gap: Vec<bool>,
    window_ms: i64,
}

impl Heard {
    /// In windows of so many milliseconds, at 48 kHz.
    pub fn new(stereo: &[f32], window_ms: usize) -> Self {
        let frames = 48 * window_ms;
        // Noise is never zero for a millisecond in both channels.
        let is_gap = |piece: &[f32]| piece.chunks(96).any(|ms| ms.iter().all(|&s| s == 0.0));
        Self {
            gains: gains(stereo, frames),
            is_gap: stereo.chunks_exact(2 * frames).map(is_gap).collect(),
            window_ms: window_ms as i64,
        }
    }

    fn compare(
        &self,
        sums: &[Vec<f64>; 2],
        begin_ms: i64,
        block_ms: i64,
        offset_s: f64,
    ) -> Comparison {
        let mut compared = Comparison {
            windows: 0,
            gaps: 0,
            offset_s,
            worst_db: 0.0,
            off: 0,
        };
        let end = sums[0].len() as i64 - self.window_ms;
        for (i, gains) in self.gains.iter().enumerate() {
            let start = begin_ms + i as i64 * self.window_ms;
            if start < block_ms || start >= end {
                continue;
            }
            if self.is_gap[i] {
                compared.gaps += 1;
                continue;
            }
            let off = (0..2).map(|ear| self.error_db(gains[ear], &sums[ear], start, block_ms));
            let off = off.fold(0.0, f64::max);
            compared.windows += 1;
            compared.worst_db = compared.worst_db.max(off);
            compared.off += usize::from(off > 0.5);
        }
        compared
    }

    /// How far a gain is from all that may be wanted in a window, in decibels.
    fn error_db(&self, gain: f64, sums: &[f64], start: i64, block_ms: i64) -> f64 {
        let wanted = (0..=block_ms).map(|late| {
            let from = (start - late) as usize;
            let squares = sums[from + self.window_ms as usize] - sums[from];
            (squares / self.window_ms as f64).max(0.0).sqrt()
        });
        let (low, high) = wanted.fold((f64::INFINITY, 0.0f64), |(low, high), wanted| {
            (low.min(wanted), high.max(wanted))
        });
        // What is to be silent is right below −60 dB.
        if gain < low.max(1e-3) {
            if low < 1e-3 { 0.0 } else { db(low / gain) }
        } else if gain > high.max(1e-3) {
            db(gain / high.max(1e-3))
        } else {
            0.0
        }
    }
}
