//! Taps of a delay line: ways of sound to the head, whose delays and gains glide.

use super::encoder::{Encoder, Gains, MOST_CHANNELS, Planes};
use super::fit::{BANDS, CHUNK, EARS, Frame};
use glam::{DVec3, Quat};

/// Maximum delay in samples of an ear after the centre of the head: 2 ms at 192 kHz, more than any head has.
pub(super) const MOST_BETWEEN_EARS: usize = 384;

/// The destination of a tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// To the ears, read between four samples, and through the responses of a head.
    Direct,
    /// To the ears, read between two samples.
    Echo,
    /// To the network.
    Late,
}

/// The way of sound to the head: the next state of a tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    /// A tap with the same key and kind glides.
    pub key: u64,
    pub kind: Kind,
    /// Unit vector of the world towards the origin of the sound.
    pub from: DVec3,
    /// Delay in samples to the centre of the head.
    pub delay: f64,
    pub gains: Frame,
}

/// How the ways are heard.
#[derive(Clone, Copy)]
pub(super) struct Hearing<'a> {
    pub encoder: &'a Encoder,
    /// Rotation from the axes of the head to those of the world.
    pub rotation: Quat,
    pub rate_hz: f64,
}

/// The delays and gains of a way at the ears, or in the channels of a format without ears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heard {
    /// Delay in samples of each ear after the centre of the head.
    pub delays: [f64; EARS],
    pub gains: [Frame; EARS],
    pub channels: Gains,
}

impl Heard {
    pub fn of(way: &Way, hearing: &Hearing) -> Heard {
        let both = Heard {
            delays: [0.0; EARS],
            gains: [way.gains; EARS],
            channels: [0.0; MOST_CHANNELS],
        };
        if way.kind == Kind::Late {
            return both;
        }
        let encoded = hearing.encoder.encode(hearing.rotation, way.from);
        if !hearing.encoder.has_ears() {
            let channels = encoded.channels;
            return Heard { channels, ..both };
        }
        let samples =
            |delay_s: f64| (delay_s * hearing.rate_hz).clamp(0.0, MOST_BETWEEN_EARS as f64);
        // The responses of the ears follow, with their levels.
        if way.kind == Kind::Direct && hearing.encoder.has_responses() {
            let delays = encoded.delays_s.map(samples);
            return Heard { delays, ..both };
        }
        let of_ear = |own: Frame| std::array::from_fn(|band| own[band] * way.gains[band]);
        Heard {
            delays: encoded
                .delays_s
                .map(|delay_s| samples(delay_s + encoded.lead_s)),
            gains: encoded.ears.map(of_ear),
            channels: encoded.channels,
        }
    }

    /// The same without sound.
    fn silent(&self) -> Heard {
        Heard {
            gains: [[0.0; BANDS]; EARS],
            ..*self
        }
    }

    /// Goes a share of the way to another state.
    fn approach(&mut self, to: &Heard, share: f32, has_ears: bool) {
        for (delay, to) in self.delays.iter_mut().zip(&to.delays) {
            *delay += (to - *delay) * f64::from(share);
        }
        let near = |now: &mut f32, to: &f32| *now += (to - *now) * share;
        for (gains, to) in self.gains.iter_mut().zip(&to.gains) {
            gains.iter_mut().zip(to).for_each(|(now, to)| near(now, to));
        }
        if !has_ears {
            let channels = self.channels.iter_mut().zip(&to.channels);
            channels.for_each(|(now, to)| near(now, to));
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Tap {
    pub way: Way,
    /// Delay in samples to the centre of the head, and the number of samples until it is that of the way.
    pub delay: f64,
    pub delay_to_go: u32,
    pub heard: Heard,
    /// The next state, and the number of samples until it is reached.
    pub to: Heard,
    pub to_go: u32,
    pub is_ending: bool,
}

/// The changes of a tap per sample, which are constant for some samples.
pub(super) struct Glide {
    pub samples: usize,
    /// The change of the delay in samples.
    pub delay: f64,
    /// The changes of the gains. `None` if they are constant.
    pub gains: Option<[Frame; EARS]>,
}

impl Tap {
    /// A tap that is silent at first.
    pub fn new(way: Way, samples: u32, hearing: &Hearing) -> Tap {
        let to = Heard::of(&way, hearing);
        let mut tap = Tap {
            way,
            delay: way.delay,
            delay_to_go: 0,
            heard: to.silent(),
            to,
            to_go: 0,
            is_ending: false,
        };
        tap.hear(to, samples);
        tap
    }

    pub fn aim(&mut self, way: Way, samples: u32, hearing: &Hearing) {
        self.way = way;
        self.delay_to_go = match self.delay == way.delay {
            true => 0,
            false => samples.max(1),
        };
        self.hear(Heard::of(&way, hearing), samples);
        self.is_ending = false;
    }

    pub fn hear(&mut self, to: Heard, samples: u32) {
        self.to = to;
        self.to_go = if self.heard == to { 0 } else { samples.max(1) };
    }

    pub fn end(&mut self, samples: u32) {
        if !self.is_ending {
            self.hear(self.heard.silent(), samples);
            (self.way.delay, self.delay_to_go) = (self.delay, 0);
            self.is_ending = true;
        }
    }

    pub fn has_ended(&self) -> bool {
        self.is_ending && self.to_go == 0
    }

    /// The changes after `done` samples, for the delay of an ear.
    pub fn glide(&self, ear: usize, done: usize) -> Glide {
        let left = |to_go: u32| (to_go as usize).saturating_sub(done);
        let (delay_left, left) = (left(self.delay_to_go), left(self.to_go));
        let ends = [delay_left, left].into_iter().filter(|left| *left > 0);
        let mut glide = Glide {
            samples: ends.min().unwrap_or(usize::MAX),
            delay: 0.0,
            gains: None,
        };
        if delay_left > 0 {
            glide.delay += (self.way.delay - self.delay) / f64::from(self.delay_to_go);
        }
        if left > 0 {
            let share = 1.0 / f64::from(self.to_go);
            glide.delay += (self.to.delays[ear] - self.heard.delays[ear]) * share;
            let step = |to: f32, now: f32| (to - now) * share as f32;
            glide.gains = Some(std::array::from_fn(|ear| {
                let (to, now) = (&self.to.gains[ear], &self.heard.gains[ear]);
                std::array::from_fn(|band| step(to[band], now[band]))
            }));
        }
        glide
    }

    /// Adds the sound of the tap to the channels of a format without ears.
    pub fn spread(&self, own: &[[Frame; 1]], channels: &mut Planes) {
        let mut mono = [0.0; CHUNK];
        for (mono, [frame]) in mono.iter_mut().zip(own) {
            *mono = frame.iter().sum::<f32>();
        }
        let mono = &mono[..own.len()];
        let gliding = (self.to_go as usize).min(mono.len());
        let pairs = self.heard.channels.iter().zip(&self.to.channels);
        for (plane, (now, to)) in channels.iter_mut().zip(pairs) {
            if *now == 0.0 && *to == 0.0 {
                continue;
            }
            let step = (to - now) / self.to_go.max(1) as f32;
            for (index, (out, sample)) in plane.iter_mut().zip(mono).enumerate().take(gliding) {
                *out += (now + (index + 1) as f32 * step) * sample;
            }
            for (out, sample) in plane.iter_mut().zip(mono).skip(gliding) {
                *out += to * sample;
            }
        }
    }

    /// Moves on by this number of samples.
    pub fn advance(&mut self, samples: u32, has_ears: bool) {
        match samples < self.delay_to_go {
            true => {
                let share = f64::from(samples) / f64::from(self.delay_to_go);
                self.delay += (self.way.delay - self.delay) * share;
            }
            false => self.delay = self.way.delay,
        }
        if samples < self.to_go {
            let share = samples as f32 / self.to_go as f32;
            self.heard.approach(&self.to, share, has_ears);
        } else if self.to_go > 0 {
            self.heard = self.to;
        }
        self.delay_to_go = self.delay_to_go.saturating_sub(samples);
        self.to_go = self.to_go.saturating_sub(samples);
    }
}
