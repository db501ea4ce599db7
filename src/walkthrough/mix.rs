//! What is heard while one walks, as samples.

use super::hearing::{Found, LONGEST_S};
use crate::audio::{AudioError, Mixer, PanningLaw, Signal, Sound, SoundSpec, StereoSignal};
use crate::auralisation::{HeardParts, Listen, Player, PlayerRemote, Spec};
use crate::error::Error;
use crate::scene::Scene;
use crate::trace::Profile;

/// Chooses the noise of the late parts.
pub(crate) const NOISE_SEED: u64 = 1;

/// How much louder all is played than its sound would be 1 m off: a source 4 m off is as loud as its
/// sound. What is too loud then is limited.
const GAIN_DB: f32 = 12.0;

/// Samples in which the volume glides: 5 ms at 48 kHz, too long for a click.
const VOLUME_GLIDE: f32 = 240.0;

/// A player of the sources of a scene, each with its own sound: as `spec` where that is a file or a sine, else each
/// with another voice or noise.
pub(crate) fn player(scene: &Scene, spec: &SoundSpec, rate_hz: u32) -> (Player, PlayerRemote) {
    let load = |source: usize| {
        // A file that cannot be had at this rate is silent: that it cannot is told of the one sound.
        let sound = Sound::load(&own_voice(spec, source as u64), rate_hz);
        sound.unwrap_or_else(|_| Sound::new(Silence))
    };
    let sounds = (0..scene.sources().count()).map(load).collect();
    Player::new(sounds, played(scene, rate_hz), 10_f32.powf(GAIN_DB / 20.0))
}

/// What the player of a scene is made for.
fn played(scene: &Scene, rate_hz: u32) -> Spec {
    Spec::of(scene, rate_hz).with_longest(LONGEST_S)
}

/// No sound.
struct Silence;

impl Signal for Silence {
    fn fill(&mut self, out: &mut [f32]) {
        out.fill(0.0);
    }

    fn seek(&mut self, _: u64) {}
}

/// The sound of a source by its number, so that no two speak with one voice.
fn own_voice(spec: &SoundSpec, number: u64) -> SoundSpec {
    match spec {
        SoundSpec::Noise { seed } => SoundSpec::Noise {
            seed: seed.wrapping_add(number),
        },
        SoundSpec::Speech { seed } => SoundSpec::Speech {
            seed: seed.wrapping_add(number),
        },
        other => other.clone(),
    }
}

/// What is heard of a source as plain numbers, to go from who has traced it to who plays it.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardMessage {
    /// The source, from 0.
    pub source: usize,
    /// Its echoes, as [`Mix::hear`] reads them.
    pub echoes: Vec<f64>,
    /// The samples of its late part, one channel after the other; none where it stays as it is.
    pub late: Option<Vec<f32>>,
    /// Seconds in which the echoes glide there.
    pub glide_s: f64,
}

impl HeardMessage {
    /// What was found at a look, for a player of so many samples a second.
    ///
    /// # Errors
    /// [`Error::Acoustics`] for a response of no length.
    pub(crate) fn new(scene: &Scene, found: &Found, rate_hz: u32) -> Result<HeardMessage, Error> {
        let spec = played(scene, rate_hz);
        let seed = found.is_late_due.then_some(NOISE_SEED);
        let parts = HeardParts::new(found.response, found.axes, spec, seed)?;
        Ok(HeardMessage {
            source: found.source,
            echoes: parts.echoes,
            late: parts.late,
            glide_s: found.glide_s,
        })
    }
}

/// Mixes what is heard into slices: in full as [`Ears`](super::Ears) hear it, or the balance of one sound.
pub struct Mix {
    listen: Listen,
    mixer: Mixer,
    pan: f32,
    sound: Sound,
    player: Player,
    remote: PlayerRemote,
    mono: Vec<f32>,
    volume: f32,
    /// What the volume glides to.
    wanted: f32,
}

impl Mix {
    /// The sounds of a scene's sources at so many samples a second; all is silent until something is heard.
    ///
    /// # Errors
    /// As [`Sound::load`].
    pub fn new(scene: &Scene, spec: &SoundSpec, rate_hz: u32) -> Result<Mix, AudioError> {
        let (player, remote) = player(scene, spec, rate_hz);
        Ok(Mix {
            listen: Listen::Full,
            mixer: Mixer::new(PanningLaw::for_profile(Profile::Hybrid)),
            pan: 0.0,
            sound: Sound::load(spec, rate_hz)?,
            player,
            remote,
            mono: Vec::new(),
            volume: 0.0,
            wanted: 0.5,
        })
    }

    /// What is listened to from now on.
    pub fn set_listen(&mut self, listen: Listen) {
        self.listen = listen;
    }

    /// Loudness, 0 to 1.
    pub fn set_volume(&mut self, volume: f32) {
        self.wanted = volume.clamp(0.0, 1.0);
    }

    /// The balance, −1 to 1, as waves of that profile give it.
    pub fn set_pan(&mut self, profile: Profile, pan: f32) {
        let law = PanningLaw::for_profile(profile);
        if law != self.mixer.law() {
            self.mixer = Mixer::new(law);
        }
        self.pan = pan;
    }

    /// Glides to what is heard of a source. False, and nothing changes, if too much is under way.
    pub fn hear(&mut self, message: HeardMessage) -> bool {
        let parts = HeardParts {
            echoes: message.echoes,
            late: message.late,
        };
        let heard = parts.heard(self.remote.spec());
        self.remote.hear(message.source, heard, message.glide_s)
    }

    /// Overwrites the interleaved samples of both channels with the next ones.
    pub fn fill(&mut self, stereo: &mut [f32]) {
        match self.listen {
            Listen::Full => {
                stereo.fill(0.0);
                self.player.add(stereo);
            }
            Listen::Balance => {
                self.mono.resize(stereo.len() / 2, 0.0);
                self.sound.fill(&mut self.mono);
                self.mixer.mix(&self.mono, self.pan, stereo);
            }
        }
        let (pairs, _) = stereo.as_chunks_mut::<2>();
        for pair in pairs {
            self.volume +=
                (self.wanted - self.volume).clamp(-1.0 / VOLUME_GLIDE, 1.0 / VOLUME_GLIDE);
            *pair = pair.map(|sample| sample * self.volume);
        }
    }
}
