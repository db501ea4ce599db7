//! The callback's program: a mono sound between two channels, or a caller's own two channels; and the fade from one to
//! the other.

use std::fmt;

use crate::audio::StereoSignal;

/// The program that is played.
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
    /// Overwrites `out` with the next samples; `balance` holds those of the mono sound, with the volume applied.
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

    /// Whether it can be played at this rate.
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

/// A program, and the one that it fades to.
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

    /// Whether only the mono sound is heard, now and next.
    pub(super) fn is_balance(&self) -> bool {
        matches!(self.current, Program::Balance) && self.next.is_none()
    }

    /// Begins to fade to another program.
    pub(super) fn fade_to(&mut self, program: Program) {
        self.next = Some((program, 0));
    }

    /// Switches to another program at once; earlier ones are freed: not for the callback.
    pub(super) fn set(&mut self, program: Program) {
        *self = Self {
            current: program,
            next: None,
        };
    }

    /// Turns the samples of the mono sound in `stereo` into the output, where a whole fade takes
    /// `length` frames; returns the program that a fade has ended. Each block of `scratch` is at
    /// least as long as `stereo`.
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
