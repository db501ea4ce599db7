//! Single echoes, including the direct sound, with gliding delays and amplitudes.

use super::convolution::BLOCK;
use super::delay_line::DelayLine;
use super::prepared_sound::Echo;
use super::{CHANNELS, Heard};
use crate::arrival::MOST_DOPPLER;

/// Maximum number of simultaneous echoes: current echoes and echoes that fade out.
const VOICES: usize = 2 * Heard::MOST_ECHOES;

/// An amplitude for each band and channel.
type Amplitudes<const BANDS: usize> = [[f32; BANDS]; CHANNELS];

/// One echo.
#[derive(Clone, Debug)]
struct Voice<const BANDS: usize> {
    key: u64,
    delay: f64,
    amplitudes: Amplitudes<BANDS>,
    delay_target: f64,
    target: Amplitudes<BANDS>,
    /// Number of samples until the targets are reached.
    to_go: u32,
    /// Whether the echo is fading out; its slot is free afterwards.
    is_ending: bool,
}

/// All echoes of one source.
#[derive(Debug)]
pub(super) struct Echoes<const BANDS: usize> {
    line: DelayLine<BANDS>,
    voices: Vec<Voice<BANDS>>,
}

impl<const BANDS: usize> Echoes<BANDS> {
    /// Creates an empty set for delays of up to `longest` samples.
    pub fn new(longest: usize) -> Self {
        Self {
            line: DelayLine::new(longest, BLOCK),
            voices: Vec::with_capacity(VOICES),
        }
    }

    /// Glides to other echoes within `samples` samples; 0 switches at once. Does not allocate.
    pub fn glide_to(&mut self, echoes: &[Echo], samples: u32) {
        for voice in &mut self.voices {
            voice.end(samples);
        }
        for echo in echoes.iter().take(Heard::MOST_ECHOES) {
            let target = echo.amplitudes();
            let reach = MOST_DOPPLER * f64::from(samples);
            let goes_on = |voice: &&mut Voice<BANDS>| {
                voice.key == echo.key && (voice.delay - echo.delay).abs() <= reach
            };
            match self.voices.iter_mut().find(goes_on) {
                Some(voice) => voice.aim(echo.delay, target, samples),
                None => self.begin(echo, target, samples),
            }
        }
    }

    fn begin(&mut self, echo: &Echo, target: Amplitudes<BANDS>, samples: u32) {
        let mut voice = Voice {
            key: echo.key,
            delay: echo.delay,
            amplitudes: [[0.0; BANDS]; CHANNELS],
            delay_target: echo.delay,
            target,
            to_go: 0,
            is_ending: false,
        };
        voice.aim(echo.delay, target, samples);
        if self.voices.len() < VOICES {
            self.voices.push(voice);
            return;
        }
        // If updates come faster than fades end, the faintest fading voice is replaced.
        let fading = self.voices.iter_mut().filter(|voice| voice.is_ending);
        if let Some(faintest) = fading.min_by(|a, b| a.power().total_cmp(&b.power())) {
            *faintest = voice;
        }
    }

    /// Renders the next block: reads it from `bands` and adds the echoes to the channels of `out`. Does not allocate.
    pub fn render(&mut self, bands: &[&[f32]; BANDS], out: &mut [[f32; BLOCK]; CHANNELS]) {
        self.line.write(bands);
        for voice in &mut self.voices {
            voice.render(&self.line, out);
        }
        self.voices.retain(|voice| !voice.is_over());
    }
}

impl<const BANDS: usize> Voice<BANDS> {
    fn aim(&mut self, delay: f64, target: Amplitudes<BANDS>, samples: u32) {
        self.delay_target = delay;
        self.target = target;
        self.to_go = samples;
        self.is_ending = false;
        if samples == 0 {
            self.arrive();
        }
    }

    fn end(&mut self, samples: u32) {
        let delay = self.delay;
        self.aim(delay, [[0.0; BANDS]; CHANNELS], samples);
        self.is_ending = true;
    }

    fn arrive(&mut self) {
        self.delay = self.delay_target;
        self.amplitudes = self.target;
    }

    fn is_over(&self) -> bool {
        self.is_ending && self.to_go == 0
    }

    fn power(&self) -> f32 {
        self.amplitudes.as_flattened().iter().map(|a| a * a).sum()
    }

    fn render(&mut self, line: &DelayLine<BANDS>, out: &mut [[f32; BLOCK]; CHANNELS]) {
        let gliding = (self.to_go as usize).min(BLOCK);
        for index in 0..gliding {
            self.step();
            self.add(line, index, out);
        }
        if self.is_over() {
            return;
        }
        for index in gliding..BLOCK {
            self.add(line, index, out);
        }
    }

    /// Moves one sample closer to the targets.
    fn step(&mut self) {
        self.to_go -= 1;
        if self.to_go == 0 {
            return self.arrive();
        }
        let left = self.to_go + 1;
        self.delay += (self.delay_target - self.delay) / f64::from(left);
        let share = 1.0 / left as f32;
        let amplitudes = self.amplitudes.as_flattened_mut();
        for (amplitude, target) in amplitudes.iter_mut().zip(self.target.as_flattened()) {
            *amplitude += (target - *amplitude) * share;
        }
    }

    fn add(&self, line: &DelayLine<BANDS>, index: usize, out: &mut [[f32; BLOCK]; CHANNELS]) {
        let frame = line.read(BLOCK - 1 - index, self.delay);
        for (out, amplitudes) in out.iter_mut().zip(&self.amplitudes) {
            let sum: f32 = frame.iter().zip(amplitudes).map(|(s, a)| s * a).sum();
            out[index] += sum;
        }
    }
}
