//! A recorded sound, held in memory.

use super::Signal;

/// Length of the cross-fade from a loop's end into its start, in seconds: much longer than a click,
/// and too short to be heard as a separate change.
const SEAM_S: f64 = 0.005;

/// A clip shorter than this number of seams starts over at more than 50 Hz: its seam is part of its
/// tone and is not cross-faded.
const SEAMS_AT_LEAST: usize = 4;

/// Mono samples with a read position.
///
/// A looping clip whose end does not fit its start is cross-faded there: as it starts over, the
/// sound comes from the end, played backwards so that it continues without a step, and fades to the
/// start. The first start is played unchanged, and the loop is as long as the clip.
#[derive(Debug, Clone)]
pub(super) struct Clip {
    /// Never empty.
    samples: Vec<f32>,
    next: usize,
    looping: bool,
    /// Whether the clip has started over.
    is_again: bool,
    /// Samples of the cross-fade; 0 if the end fits the start.
    seam: usize,
}

impl Clip {
    /// A looping clip at its start; `samples` must not be empty.
    pub(super) fn new(samples: Vec<f32>, rate_hz: u32) -> Self {
        debug_assert!(!samples.is_empty());
        Self {
            seam: seam(&samples, rate_hz),
            samples,
            next: 0,
            looping: true,
            is_again: false,
        }
    }

    /// Cross-fades the part of `out` that lies in the seam; `out` holds the samples from the next one on.
    fn cross_fade(&self, out: &mut [f32]) {
        let last = self.samples.len() - 1;
        for (i, sample) in (self.next..self.seam).zip(out) {
            let share = i as f64 / self.seam as f64;
            // In `f64`, where the difference of two samples cannot overflow.
            let end = f64::from(self.samples[last - i]);
            *sample = (end + (f64::from(*sample) - end) * share) as f32;
        }
    }
}

impl Signal for Clip {
    fn fill(&mut self, mut out: &mut [f32]) {
        while !out.is_empty() {
            if self.next == self.samples.len() {
                if !self.looping {
                    out.fill(0.0);
                    return;
                }
                self.next = 0;
                self.is_again = true;
            }
            let left = &self.samples[self.next..];
            let count = left.len().min(out.len());
            let (now, later) = out.split_at_mut(count);
            now.copy_from_slice(&left[..count]);
            if self.is_again {
                self.cross_fade(now);
            }
            self.next += count;
            out = later;
        }
    }

    /// Makes the sample with this number the next one; the numbers of a looping clip continue past its end.
    fn seek(&mut self, index: u64) {
        let length = self.samples.len() as u64;
        self.is_again = self.looping && index >= length;
        self.next = if self.looping {
            index % length
        } else {
            index.min(length)
        } as usize;
    }

    fn length(&self) -> Option<usize> {
        Some(self.samples.len())
    }

    fn set_looping(&mut self, looping: bool) {
        self.looping = looping;
    }

    fn is_finished(&self) -> bool {
        !self.looping && self.next == self.samples.len()
    }
}

/// Number of samples to cross-fade where a clip starts over: zero if the step there does not exceed
/// the nearby steps of the sound itself, as in a clip made to loop.
fn seam(samples: &[f32], rate_hz: u32) -> usize {
    let length = (f64::from(rate_hz) * SEAM_S) as usize;
    if length == 0 || samples.len() < SEAMS_AT_LEAST * length {
        return 0;
    }
    let (start, end) = (&samples[..length], &samples[samples.len() - length..]);
    let own = largest_step(start).max(largest_step(end));
    let step = (start[0] - end[length - 1]).abs();
    if step > own { length } else { 0 }
}

fn largest_step(samples: &[f32]) -> f32 {
    let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u32 = 48_000;

    /// Samples of each clip below: 0.1 s.
    const LENGTH: usize = 4800;

    /// Plays a looping clip for three and a half rounds, in blocks of an odd size.
    fn rounds(samples: &[f32]) -> Vec<f32> {
        let mut clip = Clip::new(samples.to_vec(), RATE_HZ);
        let mut played = vec![0.0; samples.len() * 7 / 2];
        played.chunks_mut(331).for_each(|block| clip.fill(block));
        played
    }

    /// Protects loops from clicks: if the end of a clip does not fit its start, no step is larger than that of a fade
    /// over the seam.
    #[test]
    fn a_clip_that_does_not_fit_itself_starts_over_without_a_click() {
        let ramp: Vec<f32> = (0..LENGTH).map(|n| n as f32 / LENGTH as f32).collect();
        let played = rounds(&ramp);
        let seam = (f64::from(RATE_HZ) * SEAM_S) as usize;
        // The step of the fade from end to start in the seam, plus the clip's own rise.
        let most = 1.0 / seam as f32 + 2.0 / LENGTH as f32;
        assert!(largest_step(&played) <= most, "{}", largest_step(&played));
        // Beyond the seam the clip is unchanged, and so is its first start.
        assert_eq!(played[..LENGTH], ramp[..]);
        assert_eq!(played[LENGTH + seam..2 * LENGTH], ramp[seam..]);
        assert_eq!(played[LENGTH..2 * LENGTH], played[2 * LENGTH..3 * LENGTH]);
    }

    /// Protects clips that were made to loop: no sample changes.
    #[test]
    fn a_clip_that_fits_itself_is_played_as_it_is() {
        // Each of the ten turns has the same samples.
        let turn = |n: usize| ((n % 480) as f64 * std::f64::consts::TAU / 480.0).sin() as f32;
        let sine: Vec<f32> = (0..LENGTH).map(turn).collect();
        for (n, sample) in rounds(&sine).into_iter().enumerate() {
            assert_eq!(sample, sine[n % LENGTH]);
        }
    }

    /// Protects seeking in a clip: it plays what it would have played there.
    #[test]
    fn seeking_finds_what_playing_comes_to() {
        let ramp: Vec<f32> = (0..LENGTH).map(|n| n as f32 / LENGTH as f32).collect();
        let played = rounds(&ramp);
        for from in [0, 17, LENGTH - 1, LENGTH, LENGTH + 9, 2 * LENGTH + 4000] {
            let mut clip = Clip::new(ramp.clone(), RATE_HZ);
            clip.seek(from as u64);
            let mut sought = vec![0.0; 1000];
            clip.fill(&mut sought);
            assert_eq!(sought[..], played[from..from + 1000], "from {from}");
        }
    }
}
