//! A synthetic voice: syllables without words.
//!
//! # Theory
//! A voice is a train of glottal pulses at a gliding pitch, shaped by the resonances of the mouth, the *formants*, and
//! cut into syllables. The pulse train is a sum of harmonics of the pitch. Each harmonic is a cosine. Its complex
//! amplitude is the response of three formants (two-pole low-passes in cascade) at its frequency, times a source
//! spectrum that falls a little with the frequency. Time is divided into slots of one syllable each, and ten slots form
//! a phrase that ends in a pause. The vowel, length, accent and hissed consonant of a slot are hashed from the seed and
//! the slot's number. Formants glide between the vowels.
//!
//! A sample depends only on its number, the rate and the seed. The phase is the pitch's integral in closed form,
//! counted from the start of the phrase, where the voice is silent. The amplitudes are computed every 5 ms and
//! interpolated linearly.

use super::Signal;
use std::f64::consts::TAU;

use crate::sampling::{hash, unit_interval};

/// Peak of the voice, relative to full scale 1: no sample's magnitude is larger.
pub(super) const SPEECH_PEAK: f32 = 0.95;

/// Limit of the sum of all harmonics' amplitudes, without the hiss.
const VOICE_PEAK: f64 = 0.9;
const HISS_PEAK: f64 = 0.05;

/// The level (RMS) of a vowel at its loudest, relative to full scale 1.
const VOWEL_LEVEL: f64 = 0.4;

/// Length of a slot, which holds one syllable, in seconds.
const SLOT_S: f64 = 0.21;
/// Slots of a phrase, including its pause.
const PHRASE_SLOTS: u64 = 10;
/// Duration of the rise and fall of a syllable, in seconds.
const RISE_S: f64 = 0.045;

/// Rate at which the amplitudes are computed, in hertz.
const CONTROL_HZ: u32 = 200;
const MAX_HARMONICS: usize = 24;
/// The lowest pitch, in hertz; the highest is 80 Hz above.
const LOWEST_PITCH_HZ: f64 = 190.0;
/// The harmonics fade out between these frequencies, in hertz.
const FADE_HZ: (f64, f64) = (3000.0, 3800.0);

/// The centre of the hiss and its half width, in hertz.
const HISS_HZ: f64 = 3200.0;
const HISS_KNOTS_HZ: f64 = 2000.0;

/// Frequencies of the first three formants, in hertz, of the vowels a, e, i, o, u and schwa.
const VOWELS: [[f64; 3]; 6] = [
    [760.0, 1250.0, 2600.0],
    [500.0, 1850.0, 2550.0],
    [320.0, 2250.0, 2950.0],
    [480.0, 880.0, 2500.0],
    [340.0, 760.0, 2400.0],
    [540.0, 1500.0, 2500.0],
];
/// The formants' bandwidths, in hertz.
const BANDWIDTHS_HZ: [f64; 3] = [90.0, 130.0, 220.0];

/// Real and imaginary amplitude of each harmonic.
type Harmonics = [[f32; 2]; MAX_HARMONICS];

/// The voice, read forwards.
#[derive(Debug, Clone)]
pub(super) struct Speech {
    seed: u64,
    rate_hz: u32,
    index: u64,
    /// Samples between two computations of the amplitudes.
    hop: u64,
    /// The hop for which the amplitudes were computed; `None` before the first computation.
    at: Option<u64>,
    from: Harmonics,
    to: Harmonics,
    /// The pitch of the most recent slot.
    pitch: SlotPitch,
}

/// The course of the pitch in a slot, hashed once per slot instead of for every sample.
#[derive(Debug, Clone, Copy)]
struct SlotPitch {
    slot: u64,
    /// Pitch in hertz at the slot's start (`here`) and end (`next`).
    here: f64,
    next: f64,
    /// The pitch's integral from the phrase's start to the slot's start, in hertz times slots.
    whole: f64,
}

impl Speech {
    pub(super) fn new(seed: u64, rate_hz: u32) -> Self {
        let mut speech = Self {
            seed: hash(seed),
            rate_hz,
            index: 0,
            hop: u64::from((rate_hz / CONTROL_HZ).max(1)),
            at: None,
            from: [[0.0; 2]; MAX_HARMONICS],
            to: [[0.0; 2]; MAX_HARMONICS],
            pitch: SlotPitch {
                slot: 0,
                here: 0.0,
                next: 0.0,
                whole: 0.0,
            },
        };
        speech.pitch = speech.slot_pitch(0);
        speech
    }

    fn next(&mut self) -> f32 {
        self.prepare(self.index / self.hop);
        let along = (self.index % self.hop) as f32 / self.hop as f32;
        let time = self.index as f64 / f64::from(self.rate_hz);
        let moment = Moment::at(time);
        if self.pitch.slot != moment.slot {
            self.pitch = self.slot_pitch(moment.slot);
        }
        let voice = self.sum(along, self.phase_turns(&moment));
        let hiss = self.hiss(time) * self.hiss_level(&moment);
        self.index = self.index.wrapping_add(1);
        (f64::from(voice) + hiss) as f32
    }

    /// Computes the amplitudes at both ends of a hop.
    fn prepare(&mut self, hop: u64) {
        if self.at == Some(hop) {
            return;
        }
        self.from = match self.at {
            Some(before) if before.checked_add(1) == Some(hop) => self.to,
            _ => self.harmonics(hop),
        };
        self.to = self.harmonics(hop.saturating_add(1));
        self.at = Some(hop);
    }

    /// The sum of the harmonics at a phase of the pitch. Each harmonic is computed from the previous harmonic with the
    /// angle addition formulas.
    fn sum(&self, along: f32, phase_turns: f64) -> f32 {
        let (sin, cos) = (TAU * phase_turns).sin_cos();
        let (step_cos, step_sin) = (cos as f32, sin as f32);
        let (mut cos, mut sin, mut sum) = (step_cos, step_sin, 0.0);
        for (from, to) in self.from.iter().zip(&self.to) {
            let re = from[0] + (to[0] - from[0]) * along;
            let im = from[1] + (to[1] - from[1]) * along;
            sum += re * cos - im * sin;
            (cos, sin) = (
                cos * step_cos - sin * step_sin,
                sin * step_cos + cos * step_sin,
            );
        }
        sum
    }

    /// Computes the amplitudes at the start of a hop.
    fn harmonics(&self, hop: u64) -> Harmonics {
        let time = hop as f64 * self.hop as f64 / f64::from(self.rate_hz);
        let moment = Moment::at(time);
        let mut harmonics = [[0.0; 2]; MAX_HARMONICS];
        let loudness = self.loudness(&moment);
        if loudness <= 0.0 {
            return harmonics;
        }
        let pitch_hz = self.pitch_hz(&moment);
        let formants = self.formants(&moment);
        let mut exact = [[0.0f64; 2]; MAX_HARMONICS];
        let (mut power, mut peak) = (0.0, 0.0);
        for (i, amplitude) in exact.iter_mut().enumerate() {
            *amplitude = response(pitch_hz * (i + 1) as f64, &formants, self.rate_hz);
            let size = amplitude[0].hypot(amplitude[1]);
            power += size * size / 2.0;
            peak += size;
        }
        // Every vowel has the same level, unless its peak would exceed the limit.
        let gain = loudness * (VOWEL_LEVEL / power.sqrt()).min(VOICE_PEAK / peak);
        for (amplitude, exact) in harmonics.iter_mut().zip(exact) {
            if gain.is_finite() {
                *amplitude = [(exact[0] * gain) as f32, (exact[1] * gain) as f32];
            }
        }
        harmonics
    }

    /// A number from 0 to 1, hashed from a slot.
    fn chance(&self, slot: u64, what: u64) -> f64 {
        let bits = hash(self.seed ^ hash(slot.wrapping_mul(8).wrapping_add(what)));
        unit_interval(bits)
    }

    /// Whether a slot is spoken: a phrase has six to eight syllables, then a pause.
    fn is_spoken(&self, slot: u64) -> bool {
        let phrase = slot / PHRASE_SLOTS;
        let syllables = 6 + (self.chance(phrase, 7) * 3.0) as u64;
        slot % PHRASE_SLOTS < syllables
    }

    /// The loudness of the voice, 0 to 1: 0 at both ends of every slot.
    fn loudness(&self, moment: &Moment) -> f64 {
        if !self.is_spoken(moment.slot) {
            return 0.0;
        }
        let start = SLOT_S * 0.25 * self.chance(moment.slot, 0);
        let end = SLOT_S * (1.0 - 0.15 * self.chance(moment.slot, 1));
        let time = moment.along * SLOT_S;
        let rise = smooth((time - start) / RISE_S) * smooth((end - time) / RISE_S);
        rise * (0.75 + 0.25 * self.chance(moment.slot, 2))
    }

    /// The pitch at the start of the slot, in hertz: it falls over the phrase, with accents.
    fn pitch_of(&self, slot: u64) -> f64 {
        let along = (slot % PHRASE_SLOTS) as f64 / PHRASE_SLOTS as f64;
        LOWEST_PITCH_HZ + 35.0 * (1.0 - along) + 45.0 * self.chance(slot, 3)
    }

    fn pitch_hz(&self, moment: &Moment) -> f64 {
        let (here, next) = (self.pitch_of(moment.slot), self.pitch_of(moment.slot + 1));
        here + (next - here) * smooth(moment.along)
    }

    fn slot_pitch(&self, slot: u64) -> SlotPitch {
        let first = slot - slot % PHRASE_SLOTS;
        let whole = (first..slot)
            .map(|slot| (self.pitch_of(slot) + self.pitch_of(slot + 1)) / 2.0)
            .sum();
        SlotPitch {
            slot,
            here: self.pitch_of(slot),
            next: self.pitch_of(slot + 1),
            whole,
        }
    }

    /// The pitch's integral since the start of the phrase, in turns; the slot's pitch must be up to date.
    fn phase_turns(&self, moment: &Moment) -> f64 {
        let SlotPitch {
            here, next, whole, ..
        } = self.pitch;
        // The integral of smooth(x) is x³ − x⁴ / 2.
        let x = moment.along;
        let part = here * x + (next - here) * (x.powi(3) - x.powi(4) / 2.0);
        (SLOT_S * (whole + part)).fract()
    }

    fn vowel(&self, slot: u64) -> &'static [f64; 3] {
        &VOWELS[(self.chance(slot, 4) * VOWELS.len() as f64) as usize % VOWELS.len()]
    }

    /// The formants: they glide from the previous vowel and are constant in the syllable's middle.
    fn formants(&self, moment: &Moment) -> [f64; 3] {
        let before = self.vowel(moment.slot.wrapping_sub(1));
        let (here, next) = (self.vowel(moment.slot), self.vowel(moment.slot + 1));
        let (into, out_of) = (
            0.5 * smooth(1.0 - moment.along / 0.4),
            0.5 * smooth((moment.along - 0.6) / 0.4),
        );
        std::array::from_fn(|i| {
            here[i] + (before[i] - here[i]) * into + (next[i] - here[i]) * out_of
        })
    }

    /// The loudness of the hiss, 0 to 1: two of five syllables begin with a hiss.
    fn hiss_level(&self, moment: &Moment) -> f64 {
        let is_hissed = self.is_spoken(moment.slot) && self.chance(moment.slot, 5) < 0.4;
        let fits = HISS_HZ + HISS_KNOTS_HZ < f64::from(self.rate_hz) / 2.0;
        if !(is_hissed && fits) {
            return 0.0;
        }
        let time = moment.along * SLOT_S;
        smooth(time / 0.02) * smooth((0.07 - time) / 0.03)
    }

    /// Noise around [`HISS_HZ`]: random values, interpolated smoothly, times a carrier.
    fn hiss(&self, time: f64) -> f64 {
        let at = time * HISS_KNOTS_HZ;
        let knot = at.floor();
        let (from, to) = (
            self.chance(knot as u64, 6),
            self.chance((knot as u64).wrapping_add(1), 6),
        );
        let slow = 2.0 * (from + (to - from) * smooth(at - knot)) - 1.0;
        HISS_PEAK * slow * (TAU * (HISS_HZ * time).fract()).sin()
    }
}

impl Signal for Speech {
    fn fill(&mut self, out: &mut [f32]) {
        for sample in out {
            *sample = self.next();
        }
    }

    fn seek(&mut self, index: u64) {
        self.index = index;
    }
}

/// A time as a slot and a position in it, 0 to 1.
struct Moment {
    slot: u64,
    along: f64,
}

impl Moment {
    fn at(time: f64) -> Self {
        let slots = time / SLOT_S;
        Self {
            slot: slots as u64,
            along: slots.fract(),
        }
    }
}

/// A smooth step from 0 to 1: 0 for x below 0 and 1 for x above 1, with a continuous slope.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Source and formants at one frequency, as a complex number.
fn response(frequency_hz: f64, formants: &[f64; 3], rate_hz: u32) -> [f64; 2] {
    let nyquist_hz = f64::from(rate_hz) / 2.0;
    let top = FADE_HZ.1.min(0.95 * nyquist_hz);
    let bottom = FADE_HZ.0.min(0.8 * nyquist_hz);
    let fade = smooth((top - frequency_hz) / (top - bottom));
    if fade == 0.0 {
        return [0.0; 2];
    }
    // A bright voice: −3 dB per octave, including radiation from the lips, and little below 200 Hz.
    let bass = (frequency_hz / 220.0).powi(4);
    let source = fade * (500.0 / frequency_hz).sqrt() * bass / (1.0 + bass);
    let (mut re, mut im) = (source, 0.0);
    for (formant, width) in formants.iter().zip(BANDWIDTHS_HZ) {
        let x = frequency_hz / formant;
        let (a, b) = (1.0 - x * x, x * width / formant);
        let square = a * a + b * b;
        (re, im) = ((re * a + im * b) / square, (im * a - re * b) / square);
    }
    [re, im]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slots of sixty phrases of several voices.
    fn slots() -> impl Iterator<Item = (Speech, u64)> {
        let voices = (0..4).map(|seed| Speech::new(seed, 48_000));
        voices.flat_map(|voice| (0..60 * PHRASE_SLOTS).map(move |slot| (voice.clone(), slot)))
    }

    /// Protects syllables from being cut off: each syllable rises from silence, is audible in its middle, and is silent
    /// again when the next syllable begins.
    #[test]
    fn a_syllable_begins_and_ends_in_silence() {
        for (voice, slot) in slots() {
            let loudness = |along| voice.loudness(&Moment { slot, along });
            assert_eq!([loudness(0.0), loudness(1.0)], [0.0; 2], "slot {slot}");
            let middle = if voice.is_spoken(slot) {
                0.75..=1.0
            } else {
                0.0..=0.0
            };
            assert!(middle.contains(&loudness(0.5)), "slot {slot}");
        }
    }

    /// Protects the consonants: two of five syllables begin with a hiss at full level, which is over after 70 ms.
    /// Pauses have no hiss, and a voice at too low a sample rate has none either.
    #[test]
    fn two_syllables_of_five_begin_with_a_hiss() {
        let (mut spoken, mut hissed) = (0, 0);
        for (mut voice, slot) in slots() {
            let moment = |time: f64| Moment {
                slot,
                along: time / SLOT_S,
            };
            let level = |time| voice.hiss_level(&moment(time));
            assert_eq!([level(0.0), level(0.071), level(0.2)], [0.0; 3]);
            let full = level(0.03);
            assert!(full == 0.0 || (full == 1.0 && voice.is_spoken(slot)));
            spoken += usize::from(voice.is_spoken(slot));
            hissed += usize::from(full == 1.0);
            voice.rate_hz = 8_000;
            assert_eq!(voice.hiss_level(&moment(0.03)), 0.0);
        }
        let share = hissed as f64 / spoken as f64;
        assert!((share - 0.4).abs() < 0.04, "{share}");
    }

    /// Protects the level: every vowel has the intended loudness, or its peak reaches the limit; neither limit is
    /// exceeded.
    #[test]
    fn every_vowel_has_its_level_or_its_peak() {
        let mut vowels = [0; 2];
        for seed in 0..4 {
            let voice = Speech::new(seed, 48_000);
            for hop in 0..4_000 {
                let time = hop as f64 / f64::from(CONTROL_HZ);
                let loudness = voice.loudness(&Moment::at(time));
                let (mut power, mut peak) = (0.0, 0.0);
                for [re, im] in voice.harmonics(hop) {
                    let size = f64::from(re).hypot(f64::from(im));
                    power += size * size / 2.0;
                    peak += size;
                }
                let shares = [power.sqrt() / VOWEL_LEVEL, peak / VOICE_PEAK];
                let largest = shares[0].max(shares[1]);
                assert!((largest - loudness).abs() < 1e-5, "{shares:?}, {loudness}");
                vowels[usize::from(shares[1] > shares[0])] += usize::from(loudness > 0.0);
            }
        }
        assert!(vowels.iter().all(|&count| count > 0), "{vowels:?}");
    }

    /// Protects the melody: the pitch stays within its range and falls over the phrase by the intended amount, apart
    /// from accents.
    #[test]
    fn the_pitch_falls_over_the_phrase() {
        let mut sums = [0.0; PHRASE_SLOTS as usize];
        let mut phrases = 0;
        for (voice, slot) in slots() {
            let pitch_hz = voice.pitch_of(slot);
            assert!((LOWEST_PITCH_HZ..=LOWEST_PITCH_HZ + 80.0).contains(&pitch_hz));
            sums[(slot % PHRASE_SLOTS) as usize] += pitch_hz;
            phrases += usize::from(slot % PHRASE_SLOTS == 0);
        }
        let fall_hz = (sums[0] - sums[9]) / phrases as f64;
        assert!((fall_hz - 0.9 * 35.0).abs() < 5.0, "{fall_hz} Hz");
    }

    /// Protects the timbre: with the formants far above the tested range, the voice falls by 3 dB per octave, has
    /// little bass, and ends where the harmonics have faded out.
    #[test]
    fn the_source_falls_by_3_db_an_octave() {
        let size = |frequency_hz| response(frequency_hz, &[1e9; 3], 48_000)[0];
        for (low_hz, fall_db) in [(800.0, 3.0), (1400.0, 3.0), (55.0, -20.6)] {
            let ratio: f64 = size(low_hz) / size(2.0 * low_hz);
            let found_db = 20.0 * ratio.log10();
            assert!((found_db - fall_db).abs() < 0.6, "{low_hz} Hz: {found_db}");
        }
        assert_eq!(size(FADE_HZ.1), 0.0);
    }

    /// Protects the audible pitch: the phase advances by the pitch within a slot, and from one slot of a phrase to the
    /// next.
    #[test]
    fn the_phase_is_the_integral_of_the_pitch() {
        const STEP: f64 = 1e-4;
        for (mut voice, slot) in slots() {
            let mut phase = |slot, along| {
                voice.pitch = voice.slot_pitch(slot);
                voice.phase_turns(&Moment { slot, along })
            };
            // Whole turns are ignored.
            let turned = |from: f64, to: f64| (to - from + 0.5).rem_euclid(1.0) - 0.5;
            let turns = [0.1, 0.5, 0.9].map(|along| {
                turned(phase(slot, along - STEP), phase(slot, along + STEP)) / (2.0 * STEP)
            });
            if (slot + 1) % PHRASE_SLOTS != 0 {
                assert!(turned(phase(slot, 1.0), phase(slot + 1, 0.0)).abs() < 1e-9);
            }
            for (along, turns) in [0.1, 0.5, 0.9].into_iter().zip(turns) {
                let pitch_hz = voice.pitch_hz(&Moment { slot, along });
                assert!((turns / SLOT_S - pitch_hz).abs() < 1e-3, "slot {slot}");
            }
        }
    }

    /// Protects the vowels: the middle of a syllable has its own vowel, and at the boundary of two syllables both are
    /// halfway between their vowels.
    #[test]
    fn formants_stand_in_the_middle_and_meet_at_the_ends() {
        for (voice, slot) in slots() {
            let formants = |slot, along| voice.formants(&Moment { slot, along });
            for along in [0.41, 0.5, 0.59] {
                assert_eq!(&formants(slot, along), voice.vowel(slot), "{along}");
            }
            let (here, next) = (voice.vowel(slot), voice.vowel(slot + 1));
            for (i, formant_hz) in formants(slot, 1.0).into_iter().enumerate() {
                assert!((formant_hz - (here[i] + next[i]) / 2.0).abs() < 1e-9);
                assert!((formant_hz - formants(slot + 1, 0.0)[i]).abs() < 1e-9);
            }
        }
    }
}
