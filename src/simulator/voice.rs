//! The direct way and the echoes of one source: a delay line in four bands, and taps whose delays and gains glide.
//!
//! # Method
//! Filters of first order split the sound once for all taps into four bands of two octaves; their sum is the sound. A
//! tap reads the line at a fractional delay for each ear, and has a gain for each band and ear. Delays and gains run
//! linearly to their next values, so that nothing clicks, and a moving source has its Doppler shift. A tap whose delay
//! would change faster than a fifth of real time fades out while another one fades in. In formats without ears, a tap
//! reads the line once, and has a gain for each channel. With a head, the direct way passes the responses of both ears,
//! which glide (`head_filter.rs`).
//!
//! # Deviations
//! [`Auralisation`](crate::auralisation::Auralisation) has eight bands with exact levels and reads with sixteen
//! weights. Here, echoes are read between two samples (−1.2 dB at 8 kHz in the worst
//! case, at 48 kHz), direct ways between four. The bands overlap, so that levels are fitted: they are within 1.5 dB of
//! the eight gains for walls and air.

use super::encoder::{MOST_CHANNELS, Planes};
use super::fit::{BANDS, CHUNK, EARS, Frame, poles};
use super::head_filter::HeadFilter;
use super::taps::{Heard, Hearing, Kind, MOST_BETWEEN_EARS, Tap, Way};
use crate::arrival::MOST_DOPPLER;
use glam::Vec4;

/// Greatest amplitude of a sample, far above every sound. Greater ones would overflow in filters.
const LOUDEST: f32 = 1e6;

/// Amplitude below which sound counts as silence: −300 dB. A processor computes slowly with numbers below 1e-38, into
/// which filters decay after a sound.
const SILENCE: f32 = 1e-15;

/// The state of a filter, without numbers that slow the processor.
pub(super) fn without_denormals(state: f32) -> f32 {
    if state.abs() < SILENCE { 0.0 } else { state }
}

/// Frames that a tap reads around its place.
const REACH: usize = 4;

/// Shortest delay in samples: a tap reads the frame after its place.
const SHORTEST: f64 = 2.0;

/// Units of a gliding delay in a sample: the upper 32 bits are whole samples, without a conversion from `f64` for each sample.
const DELAY_UNITS: f64 = (1_u64 << 32) as f64;

/// Silent frames before a new sound: all that a tap reads in one step together with the sound's first frame.
const SILENT_FRAMES: usize = CHUNK + REACH;

/// Maximum number of taps of a source: echoes, the direct way, the way to the network, and those that fade out.
const MOST_TAPS: usize = 2 * 66;

/// The output of one step.
pub(super) struct Output {
    /// Left and right, by band.
    pub ears: [[Frame; EARS]; CHUNK],
    /// The direct way of one source at both ears without the head, by band.
    direct: [[Frame; EARS]; CHUNK],
    /// The input of the network, by band.
    pub late: [[Frame; 1]; CHUNK],
    /// The channels of formats without ears.
    pub channels: Planes,
}

impl Output {
    pub const SILENT: Output = Output {
        ears: [[[0.0; BANDS]; EARS]; CHUNK],
        direct: [[[0.0; BANDS]; EARS]; CHUNK],
        late: [[[0.0; BANDS]]; CHUNK],
        channels: [[0.0; CHUNK]; MOST_CHANNELS],
    };
}

/// The delay line and the taps of a source.
#[derive(Debug)]
pub(super) struct Voice {
    /// A ring whose length is a power of two, and a copy of its first frames at the end.
    frames: Vec<Frame>,
    length: usize,
    written: usize,
    /// Number of the latest frames that belong to this sound or are silent. Older frames belong to an earlier sound.
    own: usize,
    poles: Frame,
    lows: Frame,
    taps: Vec<Tap>,
    /// The responses of both ears, for headphones.
    head: Option<HeadFilter>,
}

impl Voice {
    /// A silent voice with delays of up to `longest` samples, and responses of both ears of `head` samples; 0 without a
    /// head.
    pub fn new(longest: usize, rate_hz: u32, head: usize) -> Voice {
        let length = (longest + CHUNK + 2 * REACH + MOST_BETWEEN_EARS).next_power_of_two();
        let [a, b, c] = poles(rate_hz.into()).map(|pole| pole as f32);
        Voice {
            frames: vec![[0.0; BANDS]; length + CHUNK + REACH],
            length,
            written: 0,
            own: length,
            poles: [a, b, c, 1.0],
            lows: [0.0; BANDS],
            taps: Vec::with_capacity(MOST_TAPS),
            head: (head > 0).then(|| HeadFilter::new(head)),
        }
    }

    /// Whether the voice is silent.
    pub fn is_silent(&self) -> bool {
        self.taps.is_empty()
    }

    /// Forgets all sound. The ring is long, so only the last frames are overwritten: as many as can be read together
    /// with the first new one.
    pub fn clear(&mut self) {
        self.own = 0;
        for _ in 0..SILENT_FRAMES {
            self.push([0.0; BANDS]);
        }
        self.lows = [0.0; BANDS];
        self.taps.clear();
        if let Some(head) = &mut self.head {
            head.clear();
        }
    }

    fn push(&mut self, frame: Frame) {
        let at = self.written & (self.length - 1);
        self.frames[at] = frame;
        if at < CHUNK + REACH {
            self.frames[self.length + at] = frame;
        }
        self.written = self.written.wrapping_add(1);
        self.own = (self.own + 1).min(self.length);
    }

    /// Glides to other ways within `samples` samples. Does not allocate.
    pub fn glide_to(&mut self, ways: &[Way], samples: u32, hearing: &Hearing) {
        for tap in &mut self.taps {
            tap.end(samples);
        }
        let reach = MOST_DOPPLER * f64::from(samples);
        for way in ways {
            let way = Way {
                delay: way.delay.clamp(SHORTEST, self.longest()),
                ..*way
            };
            let goes_on = |tap: &&mut Tap| {
                let is_near = (tap.delay - way.delay).abs() <= reach;
                (tap.way.key, tap.way.kind) == (way.key, way.kind) && tap.is_ending && is_near
            };
            let has_room = self.taps.len() < MOST_TAPS;
            match self.taps.iter_mut().find(goes_on) {
                Some(tap) => tap.aim(way, samples, hearing),
                None if has_room => self.taps.push(Tap::new(way, samples, hearing)),
                // Updates come faster than fades end: the echo appears with the next one.
                None => (),
            }
        }
        self.aim_head(samples, hearing);
    }

    /// Aims the responses of both ears at the direct way.
    fn aim_head(&mut self, samples: u32, hearing: &Hearing) {
        let is_direct = |tap: &&Tap| tap.way.kind == Kind::Direct && !tap.is_ending;
        let direct = self.taps.iter().find(is_direct);
        if let (Some(head), Some(direct)) = (&mut self.head, direct) {
            head.aim(direct.way.from, samples, hearing);
        }
    }

    /// Turns the head within `samples` samples. Does not allocate.
    pub fn turn(&mut self, samples: u32, hearing: &Hearing) {
        for tap in self.taps.iter_mut().filter(|tap| !tap.is_ending) {
            tap.hear(Heard::of(&tap.way, hearing), samples);
        }
        self.aim_head(samples, hearing);
    }

    /// Maximum delay in samples to the centre of the head.
    fn longest(&self) -> f64 {
        (self.length - CHUNK - 2 * REACH - MOST_BETWEEN_EARS) as f64
    }

    /// Takes the next samples of the sound, and adds what is heard of it, at both ears or in all channels. Does not
    /// allocate. A sample that is not finite counts as 0.
    pub fn add(&mut self, mono: &[f32], has_ears: bool, out: &mut Output) {
        self.write(mono);
        let is_direct = |tap: &Tap| tap.way.kind == Kind::Direct;
        let has_direct = self.taps.iter().any(is_direct);
        let mut taps = std::mem::take(&mut self.taps);
        for tap in &mut taps {
            self.render(tap, mono.len(), has_ears, out);
        }
        taps.retain(|tap| !tap.has_ended());
        self.taps = taps;
        if let Some(head) = &mut self.head {
            let Output { ears, direct, .. } = out;
            let samples = ..mono.len();
            head.add(has_direct, &mut direct[samples], &mut ears[samples]);
        }
    }

    fn write(&mut self, mono: &[f32]) {
        for sample in mono {
            let sample = match sample.is_finite() {
                true => sample.clamp(-LOUDEST, LOUDEST),
                false => 0.0,
            };
            for (low, pole) in self.lows.iter_mut().zip(&self.poles) {
                *low += pole * (sample - *low);
            }
            let [a, b, c, d] = self.lows;
            self.push([a, b - a, c - b, d - c]);
        }
        self.lows = self.lows.map(without_denormals);
    }

    fn render(&self, tap: &mut Tap, samples: usize, has_ears: bool, out: &mut Output) {
        let Output {
            ears,
            direct,
            late,
            channels,
        } = out;
        let ears = match tap.way.kind == Kind::Direct && self.head.is_some() {
            true => &mut direct[..samples],
            false => &mut ears[..samples],
        };
        let are_together = |heard: &Heard| heard.delays[0] == heard.delays[1];
        let are_together = are_together(&tap.heard) && are_together(&tap.to);
        match (tap.way.kind, has_ears && are_together) {
            (Kind::Late, _) => self.render_ears::<2, 1, 1>(tap, 0, &mut late[..samples]),
            (kind, false) if !has_ears => {
                let mut own = [[[0.0; BANDS]]; CHUNK];
                let own = &mut own[..samples];
                match kind {
                    Kind::Direct => self.render_ears::<4, 1, 1>(tap, 0, own),
                    _ => self.render_ears::<2, 1, 1>(tap, 0, own),
                }
                tap.spread(own, channels);
            }
            (Kind::Echo, true) => self.render_ears::<2, 2, 2>(tap, 0, ears),
            (_, true) => self.render_ears::<4, 2, 2>(tap, 0, ears),
            (Kind::Direct, false) => {
                self.render_ears::<4, 1, 2>(tap, 0, ears);
                self.render_ears::<4, 1, 2>(tap, 1, ears);
            }
            (Kind::Echo, false) => {
                self.render_ears::<2, 1, 2>(tap, 0, ears);
                self.render_ears::<2, 1, 2>(tap, 1, ears);
            }
        }
        tap.advance(samples as u32, has_ears);
    }

    /// Adds the sound to `COUNT` of the `ALL` channels, from `first` on, with the delay of the first, read between
    /// `WIDTH` frames.
    fn render_ears<const WIDTH: usize, const COUNT: usize, const ALL: usize>(
        &self,
        tap: &Tap,
        first: usize,
        out: &mut [[Frame; ALL]],
    ) {
        let samples = out.len();
        let mut delay = tap.delay + tap.heard.delays[first];
        let mut gains: [Vec4; COUNT] =
            std::array::from_fn(|ear| tap.heard.gains[first + ear].into());
        let mut done = 0;
        while done < samples {
            let glide = tap.glide(first, done);
            let part = (samples - done).min(glide.samples);
            let steps: [Vec4; COUNT] = std::array::from_fn(|ear| {
                let step = glide.gains.map(|all| all[first + ear]);
                step.map_or(Vec4::ZERO, Vec4::from)
            });
            let (now, back) = (&mut out[done..done + part], samples - done);
            done += part;
            if glide.gains.is_none() && glide.delay == 0.0 {
                // The frames of all samples follow each other.
                let is_heard = gains.iter().any(|gains| *gains != Vec4::ZERO);
                let place = is_heard.then(|| self.place::<WIDTH>(delay, back));
                let Some((frames, weights)) = place.flatten() else {
                    continue;
                };
                for (out, frames) in now.iter_mut().zip(frames.windows(WIDTH)) {
                    add(out, first, &gains, weighted(frames, &weights));
                }
                continue;
            }
            let place = (delay + glide.delay, glide.delay);
            self.add_gliding::<WIDTH, COUNT, ALL>((place, back), (&mut gains, &steps), first, now);
            delay += part as f64 * glide.delay;
        }
    }

    /// Adds the sound of samples for which the delay and the gains change by constant steps. The delay of the first
    /// sample, and its change, are in samples; that sample is `back` frames before the end.
    fn add_gliding<const WIDTH: usize, const COUNT: usize, const ALL: usize>(
        &self,
        ((delay, delay_step), back): ((f64, f64), usize),
        (gains, steps): (&mut [Vec4; COUNT], &[Vec4; COUNT]),
        first: usize,
        out: &mut [[Frame; ALL]],
    ) {
        let [mut delay, delay_step] =
            [delay, delay_step].map(|samples| (samples * DELAY_UNITS) as i64);
        let frames = &self.frames[..self.length + WIDTH];
        for (index, out) in out.iter_mut().enumerate() {
            for (gains, steps) in gains.iter_mut().zip(steps) {
                *gains += *steps;
            }
            let (whole, share) = ((delay >> 32) as usize, delay as u32);
            delay += delay_step;
            let age = back - index + whole + WIDTH / 2;
            if age > self.own {
                continue;
            }
            let oldest = self.written.wrapping_sub(age) & (self.length - 1);
            // The upper 24 bits are exact as `f32`.
            let share = (share >> 8) as f32 / (1 << 24) as f32;
            let frame = weighted(&frames[oldest..oldest + WIDTH], &weights::<WIDTH>(share));
            add(out, first, gains, frame);
        }
    }

    /// The frames around the place `delay` samples before the frame that was written `back` frames before the end, and
    /// their weights. `None` before the sound began.
    fn place<const WIDTH: usize>(
        &self,
        delay: f64,
        back: usize,
    ) -> Option<(&[Frame], [f32; WIDTH])> {
        let whole = delay as usize;
        let share = (delay - whole as f64) as f32;
        // The newest frame that is read is `WIDTH / 2 − 1` frames after the place.
        let age = back + whole + WIDTH / 2;
        if age > self.own {
            return None;
        }
        let first = self.written.wrapping_sub(age) & (self.length - 1);
        let frames = &self.frames[first..first + back + WIDTH - 1];
        Some((frames, weights(share)))
    }
}

/// Weights of frames, from the oldest on, for a place `share` frames before the one after the middle.
fn weights<const WIDTH: usize>(share: f32) -> [f32; WIDTH] {
    let f = share;
    let cubic = [
        f * (f * f - 1.0) / 6.0,
        f * (1.0 + f) * (2.0 - f) / 2.0,
        (f * f - 1.0) * (f - 2.0) / 2.0,
        f * (1.0 - f) * (f - 2.0) / 6.0,
    ];
    std::array::from_fn(|index| match WIDTH {
        4 => cubic[index],
        _ => [f, 1.0 - f][index % 2],
    })
}

fn weighted<const WIDTH: usize>(frames: &[Frame], weights: &[f32; WIDTH]) -> Vec4 {
    let products = frames[..WIDTH].iter().zip(weights);
    products
        .map(|(frame, weight)| Vec4::from(*frame) * *weight)
        .sum()
}

/// Adds a frame with the gains of `COUNT` channels, from `first` on.
fn add<const COUNT: usize, const ALL: usize>(
    out: &mut [Frame; ALL],
    first: usize,
    gains: &[Vec4; COUNT],
    frame: Vec4,
) {
    for (out, gains) in out[first..first + COUNT].iter_mut().zip(gains) {
        *out = (Vec4::from(*out) + *gains * frame).into();
    }
}

#[cfg(test)]
mod tests {
    use super::super::encoder::Encoder;
    use super::super::head::{Heads, response_length};
    use super::*;
    use crate::hrtf::tests::{RATE_HZ, grid, set};
    use glam::{DVec3, Quat};
    use std::f64::consts::PI;
    use std::sync::Arc;

    /// A direct way from the left.
    fn way(key: u64, delay: f64, gain: f32) -> Way {
        Way {
            key,
            kind: Kind::Direct,
            from: DVec3::NEG_X,
            delay,
            gains: [gain; BANDS],
        }
    }

    const STEREO: Hearing = Hearing {
        encoder: &Encoder::Stereo,
        rotation: Quat::IDENTITY,
        rate_hz: RATE_HZ as f64,
    };

    /// The left output for a sound, in chunks of different lengths.
    fn play(voice: &mut Voice, sound: &[f32]) -> Vec<f32> {
        let mut left = Vec::new();
        let mut rest = sound;
        for length in [CHUNK, 1, 77].into_iter().cycle() {
            if rest.is_empty() {
                return left;
            }
            let (chunk, later) = rest.split_at(length.min(rest.len()));
            let mut out = Box::new(Output::SILENT);
            voice.add(chunk, true, &mut out);
            let heard = out.ears.iter().take(chunk.len());
            left.extend(heard.map(|[left, _]| left.iter().sum::<f32>()));
            rest = later;
        }
        left
    }

    /// Protects time and level of taps: a sine is delayed by the stated fraction of a sample, to 0.1 dB at 4 kHz, also
    /// where the ring wraps around.
    #[test]
    fn a_tap_is_delayed_and_scaled() {
        for delay in [2.0, 10.5, 300.25, 999.9] {
            let mut voice = Voice::new(1000, RATE_HZ, 0);
            voice.glide_to(&[way(1, delay, 0.5)], 1, &STEREO);
            let sine = |time: f64| (time * 2.0 * PI * 4000.0 / f64::from(RATE_HZ)).sin();
            let sound: Vec<f32> = (0..6000).map(|time| sine(f64::from(time)) as f32).collect();
            let heard = play(&mut voice, &sound);
            for (time, heard) in heard.iter().enumerate().skip(1500) {
                let expected = 0.5 * sine(time as f64 - delay);
                assert!(
                    (f64::from(*heard) - expected).abs() < 0.006,
                    "{delay} {time}"
                );
            }
        }
    }

    /// The encoder of a rigid sphere.
    fn head() -> Encoder {
        let set = Arc::new(set(grid(30)));
        let encoder = Encoder::Binaural(Heads::default().head(&set, RATE_HZ).expect("a thread"));
        while !encoder.is_ready() {
            std::thread::yield_now();
        }
        encoder
    }

    /// Protects voices that are used again, with and without a head: nothing of the sound before is heard, at any delay,
    /// and the new sound is that of a new voice.
    #[test]
    fn a_cleared_voice_is_like_a_new_one() {
        let head = head();
        let sphere = Hearing {
            encoder: &head,
            ..STEREO
        };
        for (hearing, length) in [(&STEREO, 0), (&sphere, response_length(RATE_HZ))] {
            for delay in [2.0, 90.5, 131.0, 500.25, 900.0] {
                let mut used = Voice::new(1000, RATE_HZ, length);
                used.glide_to(&[way(1, delay, 0.7)], 1, hearing);
                play(&mut used, &[1.0; 5000]);
                used.clear();
                let mut fresh = Voice::new(1000, RATE_HZ, length);
                let sound: Vec<f32> = (0..2500).map(|i| (i as f32 * 0.37).sin()).collect();
                for voice in [&mut used, &mut fresh] {
                    voice.glide_to(&[way(1, delay, 0.5)], 400, hearing);
                }
                let (used, fresh) = (play(&mut used, &sound), play(&mut fresh, &sound));
                assert_eq!(used, fresh, "{delay}");
                assert!(fresh.iter().any(|sample| sample.abs() > 0.1));
            }
        }
    }

    /// Protects listeners from clicks while taps move, appear and vanish: no step is larger than those of the sound and
    /// of the fade.
    #[test]
    fn gliding_taps_do_not_click() {
        let mut voice = Voice::new(4000, RATE_HZ, 0);
        // Whole periods, so that the tone continues from call to call.
        let step = 2.0 * std::f32::consts::PI * 40.0 / 4800.0;
        let tone: Vec<f32> = (0..4800).map(|i| (i as f32 * step).sin()).collect();
        let mut last = 0.0;
        let mut largest: f32 = 0.0;
        for (number, delay) in [500.0, 505.0, 3000.0, 3001.0].into_iter().enumerate() {
            let taps = [way(1, delay, 0.4), way(number as u64 + 2, 900.0, 0.3)];
            voice.glide_to(&taps, 960, &STEREO);
            for sample in play(&mut voice, &tone) {
                largest = largest.max((sample - last).abs());
                last = sample;
            }
        }
        voice.glide_to(&[], 960, &STEREO);
        play(&mut voice, &tone);
        assert!(voice.is_silent());
        // The tone's own steps, of the taps that sound while two others cross-fade.
        assert!(largest < step * (0.4 + 0.4 + 0.3 + 0.3), "{largest}");
    }
}
