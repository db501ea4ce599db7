//! Plays several sources as the listener hears them, on the real-time audio thread, and limits loud output to full
//! scale.

use super::{Auralisation, Heard, Spec};
use crate::audio::{Sound, StereoSignal};
use crate::response::ResponseError;
use rtrb::{Consumer, Producer, RingBuffer};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Maximum number of frames played in one step.
const BLOCK: usize = 256;

/// Maximum queued updates.
const UPDATES: usize = 32;

/// Duration in seconds of the fade between late parts.
const LATE_FADE_S: f64 = 0.2;

/// Time in seconds from the first response to [`PlayerRemote::is_heard`]. It is longer than the fade of live output to a
/// new signal.
const BEGUN_S: f64 = 0.05;

/// Values that a player and its remote share, as single atomics. A number is stored as the bits of an `f32`.
struct Shared {
    /// The gain to glide to.
    gain: AtomicU32,
    /// The smallest factor of the limiter since the remote read it.
    limited: AtomicU32,
    /// Frames played since the first response, at most [`u32::MAX`].
    played: AtomicU32,
}

/// The new state of a source.
struct Update {
    source: usize,
    heard: Box<Heard>,
    /// Number of samples in which the echoes glide to the new state.
    glide: u32,
}

/// Plays sources, adds them up and limits the sum to full scale. Create it with [`Player::new`] and pass it to live
/// output as its stereo signal.
pub struct Player {
    spec: Spec,
    sources: Vec<Playing>,
    gain: f32,
    shared: Arc<Shared>,
    /// Whether a response has arrived.
    has_begun: bool,
    limiter: Limiter,
    inbox: Consumer<Update>,
    outbox: Producer<Box<Heard>>,
    mono: [f32; BLOCK],
}

/// The control side of a [`Player`], usable from any thread.
pub struct PlayerRemote {
    spec: Spec,
    sources: usize,
    shared: Arc<Shared>,
    inbox: Producer<Update>,
    outbox: Consumer<Box<Heard>>,
}

struct Playing {
    sound: Sound,
    ears: Auralisation,
    /// A late part that waits until the previous fade has ended.
    late: Option<Box<Heard>>,
}

impl Player {
    /// Creates a player for these sounds, one for each source, at the rate of `spec`; `gain` is an amplitude factor.
    ///
    /// # Errors
    /// The errors of [`Auralisation::new`]; [`ResponseError::BadNumber`] for a gain that is not finite.
    pub fn new(
        sounds: Vec<Sound>,
        spec: Spec,
        gain: f32,
    ) -> Result<(Player, PlayerRemote), ResponseError> {
        spec.validate()?;
        check_gain(gain)?;
        let shared = Arc::new(Shared {
            gain: AtomicU32::new(gain.to_bits()),
            limited: AtomicU32::new(1_f32.to_bits()),
            played: AtomicU32::new(0),
        });
        let (to_inbox, inbox) = RingBuffer::new(UPDATES);
        // Room for all objects in use: queued updates, and a late part for each source.
        let (outbox, from_outbox) = RingBuffer::new(UPDATES + sounds.len());
        let remote = PlayerRemote {
            spec,
            sources: sounds.len(),
            shared: Arc::clone(&shared),
            inbox: to_inbox,
            outbox: from_outbox,
        };
        let playing = |sound| {
            Ok::<_, ResponseError>(Playing {
                sound,
                ears: Auralisation::new(spec)?,
                late: None,
            })
        };
        let player = Player {
            spec,
            sources: sounds.into_iter().map(playing).collect::<Result<_, _>>()?,
            gain,
            shared,
            has_begun: false,
            limiter: Limiter::new(spec.rate_hz),
            inbox,
            outbox,
            mono: [0.0; BLOCK],
        };
        Ok((player, remote))
    }

    fn take_updates(&mut self) {
        while let Ok(update) = self.inbox.pop() {
            self.begin();
            let Some(source) = self.sources.get_mut(update.source) else {
                hand_out(&mut self.outbox, update.heard);
                continue;
            };
            // `PlayerRemote::hear` has already rejected a different rate or length.
            let _ = source.ears.glide_echoes(&update.heard, update.glide);
            if update.heard.late.is_none() {
                hand_out(&mut self.outbox, update.heard);
            } else if let Some(before) = source.late.replace(update.heard) {
                hand_out(&mut self.outbox, before);
            }
        }
        let fade = (LATE_FADE_S * f64::from(self.spec.rate_hz)) as u32;
        for source in &mut self.sources {
            if let Some(mut heard) = source.late.take() {
                match source.ears.glide_late(&mut heard, fade) {
                    Ok(false) => source.late = Some(heard),
                    _ => hand_out(&mut self.outbox, heard),
                }
            }
        }
    }

    /// Notes the first response, which has the gain set before it, without a glide.
    fn begin(&mut self) {
        if !self.has_begun {
            self.has_begun = true;
            self.gain = f32::from_bits(self.shared.gain.load(Relaxed));
        }
    }

    fn play(&mut self, stereo: &mut [f32]) {
        // An incomplete last frame stays unchanged.
        let whole = stereo.len() / 2 * 2;
        let stereo = &mut stereo[..whole];
        let mono = &mut self.mono[..whole / 2];
        let (start, end) = (self.gain, f32::from_bits(self.shared.gain.load(Relaxed)));
        let step = (end - start) / mono.len().max(1) as f32;
        self.gain = end;
        for source in &mut self.sources {
            source.sound.fill(mono);
            for (index, sample) in mono.iter_mut().enumerate() {
                *sample *= if start == end {
                    end
                } else {
                    start + step * (index + 1) as f32
                };
            }
            let added = source.ears.add(mono, stereo);
            debug_assert!(added.is_ok(), "there are two samples for each one");
        }
    }
}

/// Returns a late part to the remote, which frees it.
fn hand_out(outbox: &mut Producer<Box<Heard>>, heard: Box<Heard>) {
    // The queue always has room: see `Player::new`.
    let _ = outbox.push(heard);
}

impl StereoSignal for Player {
    fn add(&mut self, stereo: &mut [f32]) {
        self.take_updates();
        for block in stereo.chunks_mut(2 * BLOCK) {
            self.play(block);
            self.limiter.apply(block);
            // The bits of positive floats have the order of the floats.
            let limited = self.limiter.gain.to_bits();
            self.shared.limited.fetch_min(limited, Relaxed);
            if self.has_begun {
                let played = self.shared.played.load(Relaxed);
                let played = played.saturating_add(block.len() as u32 / 2);
                self.shared.played.store(played, Relaxed);
            }
        }
    }
}

fn check_gain(gain: f32) -> Result<(), ResponseError> {
    if gain.is_finite() {
        return Ok(());
    }
    Err(ResponseError::BadNumber {
        what: "the gain of a player",
        must: "finite",
        value: gain.into(),
    })
}

impl PlayerRemote {
    /// The required format of each [`Heard`].
    pub fn spec(&self) -> Spec {
        self.spec
    }

    /// Number of sources.
    pub fn source_count(&self) -> usize {
        self.sources
    }

    /// Sets the gain of all sources, an amplitude factor. The player glides to it within 256 samples, or begins with it
    /// if it is set before the first response. Sound that is on its way keeps its gain.
    ///
    /// # Errors
    /// [`ResponseError::BadNumber`] for a gain that is not finite.
    pub fn set_gain(&self, gain: f32) -> Result<(), ResponseError> {
        check_gain(gain)?;
        self.shared.gain.store(gain.to_bits(), Relaxed);
        Ok(())
    }

    /// The largest attenuation by the limiter since the last call, in decibels, 0 or more. It is 0 while the sum of all
    /// sources stays within full scale.
    pub fn limited_db(&self) -> f32 {
        let least = self.shared.limited.swap(1_f32.to_bits(), Relaxed);
        (-20.0 * f32::from_bits(least).log10()).max(0.0)
    }

    /// Whether the player has played for at least 50 ms since its first response. Before that it is silent, or live
    /// output still fades to it.
    pub fn is_heard(&self) -> bool {
        let played = f64::from(self.shared.played.load(Relaxed));
        played >= BEGUN_S * f64::from(self.spec.rate_hz)
    }

    /// Glides to a new state of a source (counted from 0) within the given seconds, and frees objects that the player
    /// has returned. Returns false and changes nothing if the queue is full because the player does not run.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchSource`], [`ResponseError::OtherSpec`] if `heard` was made for another player, and
    /// [`ResponseError::BadNumber`] for seconds that are negative or NaN. An error changes nothing.
    pub fn hear(
        &mut self,
        source: usize,
        heard: Heard,
        seconds: f64,
    ) -> Result<bool, ResponseError> {
        self.check(source, &heard, seconds)?;
        self.collect();
        let update = Update {
            source,
            heard: Box::new(heard),
            glide: (seconds * f64::from(self.spec.rate_hz)) as u32,
        };
        Ok(self.inbox.push(update).is_ok())
    }

    fn check(&self, source: usize, heard: &Heard, seconds: f64) -> Result<(), ResponseError> {
        if source >= self.sources {
            return Err(ResponseError::NoSuchSource {
                source_number: source,
                sources: self.sources,
            });
        }
        if seconds.is_nan() || seconds < 0.0 {
            return Err(ResponseError::BadNumber {
                what: "the time of a glide in seconds",
                must: "0 or more",
                value: seconds,
            });
        }
        self.spec.check(heard)
    }

    fn collect(&mut self) {
        while self.outbox.pop().is_ok() {}
    }
}

impl fmt::Debug for Player {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Player")
            .field("sources", &self.sources.len())
            .finish_non_exhaustive()
    }
}

impl fmt::Debug for PlayerRemote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PlayerRemote")
            .field("sources", &self.sources)
            .finish_non_exhaustive()
    }
}

/// The largest sample that is not reduced, relative to full scale 1.
const CEILING: f32 = 0.98;

/// Number of samples over which the gain falls: 0.7 ms at 48 kHz. Samples that are still too loud during this time are
/// clipped at full scale.
const ATTACK: usize = 32;

/// Time in seconds in which the gain rises again by a factor of e.
const RELEASE_S: f32 = 0.4;

/// A gain that falls immediately when a block is too loud, and recovers slowly.
#[derive(Debug)]
pub(super) struct Limiter {
    gain: f32,
    /// Samples per second.
    rate_hz: f32,
}

impl Limiter {
    pub(super) fn new(rate_hz: u32) -> Limiter {
        Limiter {
            gain: 1.0,
            rate_hz: rate_hz as f32,
        }
    }

    /// Limits a block of interleaved samples.
    pub(super) fn apply(&mut self, stereo: &mut [f32]) {
        let frames = stereo.len() / 2;
        let peak = stereo.iter().fold(0.0_f32, |peak, s| peak.max(s.abs()));
        let released = (frames as f32 / (RELEASE_S * self.rate_hz)).min(1.0);
        let risen = self.gain + (1.0 - self.gain) * released;
        let target = risen.min(CEILING / peak.max(CEILING));
        if self.gain == 1.0 && target == 1.0 {
            return;
        }
        let ramp = match target < self.gain {
            true => ATTACK.min(frames),
            false => frames,
        };
        for (index, pair) in stereo.chunks_exact_mut(2).enumerate() {
            let share = (index + 1).min(ramp) as f32 / ramp as f32;
            let gain = self.gain + (target - self.gain) * share;
            pair[0] = (pair[0] * gain).clamp(-1.0, 1.0);
            pair[1] = (pair[1] * gain).clamp(-1.0, 1.0);
        }
        self.gain = target;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects full scale, and protects soft sounds from changes.
    #[test]
    fn loud_is_limited_and_soft_is_not_touched() {
        let mut limiter = Limiter::new(48_000);
        let soft: Vec<f32> = (0..512).map(|i| (i as f32 * 0.1).sin() * 0.9).collect();
        let mut block = soft.clone();
        limiter.apply(&mut block);
        assert_eq!(block, soft);
        let mut loud: Vec<f32> = soft.iter().map(|sample| sample * 20.0).collect();
        limiter.apply(&mut loud);
        assert!(loud.iter().all(|sample| sample.abs() <= 1.0));
        let cut = loud.iter().filter(|sample| sample.abs() == 1.0).count();
        assert!(cut < 2 * ATTACK, "{cut} samples were cut");
        for _ in 0..400 {
            block.clone_from(&soft);
            limiter.apply(&mut block);
        }
        assert!(block.iter().zip(&soft).all(|(a, b)| (a - b).abs() < 0.01));
    }

    /// Protects the level of the first sound: the gain set before the first response applies to all sound that leaves its
    /// source from then on, the player is silent before, and the remote states when the limiter works.
    #[test]
    fn a_player_begins_with_its_gain_and_states_when_it_limits() {
        use crate::audio::SoundSpec;
        use crate::auralisation::prepared_sound::Echo;
        use crate::bands::BAND_COUNT;
        use crate::response::{ListenerAxes, Tap};
        let spec = Spec {
            rate_hz: 48_000,
            has_bands: false,
            longest_s: 0.1,
        };
        let axes = ListenerAxes::new(glam::DVec3::NEG_Z, glam::DVec3::Y).unwrap();
        // A source to the left whose sound has an eighth of its amplitude.
        let tap = Tap {
            seconds: 0.01,
            energy: [1.0 / (64.0 * 4.0 * std::f64::consts::PI); BAND_COUNT],
            direction: glam::DVec3::X,
        };
        let play = |gain: f32| {
            let sound = Sound::load(&SoundSpec::Noise { seed: 1 }, spec.rate_hz).unwrap();
            let (mut player, mut remote) = Player::new(vec![sound], spec, 1.0).unwrap();
            let mut before = vec![0.0; 9600];
            player.add(&mut before);
            assert!(before.iter().all(|sample| *sample == 0.0));
            assert!(!remote.is_heard());
            remote.set_gain(gain).unwrap();
            let heard = Heard {
                echoes: vec![Echo::new(&tap, 1, &axes, spec)],
                late: None,
                spec: Some(spec),
            };
            assert!(remote.hear(0, heard, 0.02).unwrap());
            let mut after = vec![0.0; 9600];
            player.add(&mut after);
            assert!(remote.is_heard());
            // The sound of the first 10 ms left its source before, and the output is delayed by less than 15 ms.
            let squares = after[2 * 1200..].iter().map(|s| f64::from(*s).powi(2));
            let squares = squares.sum::<f64>();
            (squares, remote.limited_db(), remote.limited_db())
        };
        let (soft, rests, _) = play(1.0);
        let (loud, still_rests, _) = play(2.0);
        assert!((loud / soft - 4.0).abs() < 1e-3, "{loud} {soft}");
        assert_eq!((rests, still_rests), (0.0, 0.0));
        let (_, limited, later) = play(64.0);
        assert!(limited > 3.0, "{limited} dB");
        // The attenuation is reported once; the player has not played since.
        assert_eq!(later, 0.0);
    }
}
