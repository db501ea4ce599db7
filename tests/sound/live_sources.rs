//! Sounds that live output can create at any sample rate.

use echomarch::audio::live::SoundSource;
use echomarch::audio::{AudioError, Signal, Sound};

/// Protects a caller's own sound: live output reads it, seeks in it and ends it as its methods define, at the requested
/// rate.
#[test]
fn a_sound_of_ones_own_is_played() {
    /// Counts up by one per sample, up to its length.
    struct Ramp {
        next: usize,
        length: usize,
    }
    impl Signal for Ramp {
        fn fill(&mut self, out: &mut [f32]) {
            for sample in out {
                *sample = if self.is_finished() {
                    0.0
                } else {
                    self.next as f32
                };
                self.next += 1;
            }
        }
        fn seek(&mut self, sample: u64) {
            self.next = sample as usize;
        }
        fn length(&self) -> Option<usize> {
            Some(self.length)
        }
        fn is_finished(&self) -> bool {
            self.next >= self.length
        }
    }
    let source = SoundSource::new("ramp", |rate_hz| {
        let length = rate_hz as usize / 16_000;
        Ok(Sound::new(Ramp { next: 0, length }))
    });
    let mut sound = source.sound(Sound::SAMPLE_RATE).unwrap();
    assert_eq!(sound.length(), Some(3));
    let mut out = [9.0; 2];
    sound.fill(&mut out);
    assert_eq!((out, sound.is_finished()), ([0.0, 1.0], false));
    sound.fill(&mut out);
    assert_eq!((out, sound.is_finished()), ([2.0, 0.0], true));
    sound.rewind();
    sound.fill(&mut out);
    assert_eq!(out, [0.0, 1.0]);
    assert_eq!(source.sound(96_000).unwrap().length(), Some(6));
}

/// Protects live output from a sound that cannot be created: the source returns the reason.
#[test]
fn a_source_says_why_it_makes_no_sound() {
    let missing: SoundSource = "missing.wav".parse().unwrap();
    let error = missing.sound(Sound::SAMPLE_RATE).unwrap_err();
    assert!(matches!(error, AudioError::OpenWav { .. }), "{error}");
    let error = "missing".parse::<SoundSource>().unwrap_err();
    assert!(matches!(error, AudioError::UnknownSound { .. }), "{error}");
}
