//! The stages of the renderer: gliding gains, and the program (a mono sound panned to two channels, or a caller's own
//! two channels) with fades between programs.

use std::fmt;

use crate::audio::{Gains, StereoSignal};

/// Runs linearly from the current gains to the target gains.
#[derive(Debug)]
pub(super) struct Glide {
    current: Gains,
    target: Gains,
    /// Number of samples until the target is reached.
    left: usize,
    /// Number of samples that a full glide takes; at least 1.
    length: usize,
}

impl Glide {
    /// Starts in silence; a change takes `length` samples.
    pub(super) fn new(length: usize) -> Self {
        Self {
            current: Gains::SILENT,
            target: Gains::SILENT,
            left: 0,
            length: length.max(1),
        }
    }

    /// Starts to change from the current gains to `target`.
    pub(super) fn aim(&mut self, target: Gains) {
        if target != self.target {
            self.target = target;
            self.left = self.length;
        }
    }

    /// Whether the gains are zero and stay zero.
    pub(super) fn is_silent(&self) -> bool {
        self.left == 0 && self.target == Gains::SILENT
    }

    /// Advances by at most `most` samples. Returns the number of samples and the gains at the last sample.
    pub(super) fn advance(&mut self, most: usize) -> (usize, Gains) {
        if self.left == 0 {
            return (most, self.target);
        }
        let count = self.left.min(most);
        let share = count as f32 / self.left as f32;
        self.left -= count;
        if self.left == 0 {
            self.current = self.target;
        } else {
            self.current.left += (self.target.left - self.current.left) * share;
            self.current.right += (self.target.right - self.current.right) * share;
        }
        (count, self.current)
    }
}

/// The program being played.
#[derive(Default)]
pub(super) enum Program {
    /// The mono sound and its pan.
    #[default]
    Balance,
    /// A caller's own channels, made for this rate in hertz.
    Stereo {
        signal: Box<dyn StereoSignal>,
        rate_hz: u32,
    },
}

impl Program {
    /// Overwrites `out` with the next samples; `balance` holds the samples of the mono sound, with the volume applied.
    fn fill(&mut self, balance: &[f32], volumes: &[f32], out: &mut [f32]) {
        let Program::Stereo { signal, .. } = self else {
            out.copy_from_slice(balance);
            return;
        };
        out.fill(0.0);
        signal.add(out);
        for (pair, volume) in out.chunks_exact_mut(2).zip(volumes) {
            pair[0] *= volume;
            pair[1] *= volume;
        }
    }

    /// Whether the program was made for the rate `at_hz`.
    pub(super) fn fits(&self, at_hz: u32) -> bool {
        match self {
            Program::Balance => true,
            Program::Stereo { rate_hz, .. } => *rate_hz == at_hz,
        }
    }
}

impl fmt::Debug for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Program::Balance => "Balance",
            Program::Stereo { .. } => "Stereo",
        })
    }
}

/// The current program, and the program that it fades to.
#[derive(Debug, Default)]
pub(super) struct Programs {
    current: Program,
    next: Option<(Program, usize)>,
}

impl Programs {
    /// Whether a fade is in progress.
    pub(super) fn is_fading(&self) -> bool {
        self.next.is_some()
    }

    /// Whether the mono sound is the only program, with no fade in progress or pending.
    pub(super) fn is_balance(&self) -> bool {
        matches!(self.current, Program::Balance) && self.next.is_none()
    }

    /// Begins to fade to another program.
    pub(super) fn fade_to(&mut self, program: Program) {
        self.next = Some((program, 0));
    }

    /// Switches to another program at once. Frees the earlier programs, so the callback must not call this function.
    pub(super) fn set(&mut self, program: Program) {
        *self = Self {
            current: program,
            next: None,
        };
    }

    /// Turns the samples of the mono sound in `stereo` into the output; a whole fade takes `length` frames. Returns the
    /// old program when a fade has ended. Each block of `scratch` is at least as long as `stereo`.
    pub(super) fn play<const N: usize>(
        &mut self,
        stereo: &mut [f32],
        volumes: &[f32],
        scratch: &mut [[f32; N]; 2],
        length: usize,
    ) -> Option<Program> {
        if self.is_balance() {
            return None;
        }
        let [balance, other] = scratch.each_mut().map(|block| &mut block[..stereo.len()]);
        balance.copy_from_slice(stereo);
        self.current.fill(balance, volumes, stereo);
        let (next, done) = self.next.as_mut()?;
        next.fill(balance, volumes, other);
        let pairs = stereo.chunks_exact_mut(2).zip(other.chunks_exact(2));
        for (index, (pair, other)) in pairs.enumerate() {
            let share = (*done + index + 1).min(length) as f32 / length as f32;
            pair[0] += (other[0] - pair[0]) * share;
            pair[1] += (other[1] - pair[1]) * share;
        }
        *done += stereo.len() / 2;
        if *done < length {
            return None;
        }
        let (next, _) = self.next.take()?;
        Some(std::mem::replace(&mut self.current, next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the duration of a change: it does not depend on the length of the blocks.
    #[test]
    fn a_change_takes_its_time_in_blocks_of_any_length() {
        let target = Gains {
            left: 1.0,
            right: 0.25,
        };
        for block in [1, 7, 100, 1000] {
            let mut glide = Glide::new(100);
            glide.aim(target);
            let (mut samples, mut gains) = (0, Gains::SILENT);
            while gains != target {
                let (count, next) = glide.advance(block);
                samples += count;
                gains = next;
                let on_the_line = samples as f32 / 100.0;
                assert!((gains.left - on_the_line).abs() < 1e-5);
            }
            assert_eq!(samples, 100, "blocks of {block}");
            assert_eq!(glide.advance(block), (block, target));
        }
    }
}
