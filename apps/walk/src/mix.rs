//! Mixes the sound of a walk into samples.

use super::hearing::{Found, LONGEST_S};
use echomarch::Error;
use echomarch::audio::{Mixer, PanningLaw, Signal, Sound, SoundSpec, StereoSignal};
use echomarch::auralisation::{HeardParts, Listen, Player, PlayerRemote, Spec};
use echomarch::response::ResponseError;
use echomarch::scene::Scene;
use echomarch::tracer::Profile;

/// Seed of the noise in the late parts.
pub const NOISE_SEED: u64 = 1;

/// Gain of a player before its first response, which brings the gain of its scene.
const FIRST_GAIN: f32 = 1.0;

/// Duration of one fade, in seconds. The old sound fades out, then the new sound fades in. Both fades together take as
/// long as the 20 ms cross-fade of the window. The volume glides from 0 to 1 in the time of one fade.
const FADE_S: f32 = 0.01;

/// Creates a player for a scene's sources. If `spec` is a file or a sine, all sources play it; otherwise each source
/// has a different voice or noise.
pub fn player(
    scene: &Scene,
    spec: &SoundSpec,
    rate_hz: u32,
) -> Result<(Player, PlayerRemote), ResponseError> {
    let load = |source: usize| {
        // A file that cannot be loaded at this rate is replaced by silence. The error is reported when the sound of the
        // balance is loaded.
        let sound = Sound::load(&own_voice(spec, source as u64), rate_hz);
        sound.unwrap_or_else(|_| Sound::new(Silence))
    };
    let sounds = (0..scene.sources.len()).map(load).collect();
    Player::new(sounds, played(scene, rate_hz), FIRST_GAIN)
}

/// The specification of a scene's player. The sound is always split into octave bands, because diffraction can be
/// switched on at any time.
fn played(scene: &Scene, rate_hz: u32) -> Spec {
    Spec::of(scene, rate_hz)
        .with_diffraction(true)
        .with_longest(LONGEST_S)
}

/// A silent sound.
struct Silence;

impl Signal for Silence {
    fn fill(&mut self, out: &mut [f32]) {
        out.fill(0.0);
    }

    fn seek(&mut self, _: u64) {}
}

/// The sound of the source with index `number`: each source has a different voice or noise.
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

/// The response of a source as plain numbers, for transfer from the tracing thread to the player.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardMessage {
    /// Index of the source, from 0.
    pub source: usize,
    /// The echoes of the source, in the encoding that [`Mix::hear`] reads.
    pub echoes: Vec<f64>,
    /// The samples of the late part, one channel after the other; `None` if the late part is unchanged.
    pub late: Option<Vec<f32>>,
    /// The gain of the scene's sound, an amplitude factor.
    pub gain: f32,
    /// Glide time from the previous echoes to these, in seconds.
    pub glide_s: f64,
}

impl HeardMessage {
    /// Converts the result of a trace for a player with the sample rate `rate_hz`.
    ///
    /// # Errors
    /// [`Error::Acoustics`] for a response of length 0.
    pub fn new(scene: &Scene, found: &Found, rate_hz: u32) -> Result<HeardMessage, Error> {
        let spec = played(scene, rate_hz);
        let seed = found.is_late_due.then_some(NOISE_SEED);
        let parts = HeardParts::new(found.response, found.axes, spec, seed)?;
        Ok(HeardMessage {
            source: found.source,
            echoes: parts.echoes,
            late: parts.late,
            gain: found.gain,
            glide_s: found.glide_s,
        })
    }
}

/// Mixes sound into blocks of samples: either full listening from the messages of [`Ears`](super::Ears), or the balance
/// of one sound.
///
/// After a change of the scene, the sound, the listening mode or the panning law, the old sound fades out before the
/// new one fades in, which avoids clicks.
#[derive(Debug)]
pub struct Mix {
    rate_hz: u32,
    voices: Voices,
    listen: Listen,
    mixer: Mixer,
    /// The pan of the balance; `None` before the first frame of waves.
    pan: Option<f32>,
    /// The state to switch to once the output is silent.
    wanted: Wanted,
    /// Progress of the fade in samples: 0 is silence, `fade_length` is full level.
    fade: usize,
    fade_length: usize,
    volume: f32,
    /// The volume at the end of the glide.
    wanted_volume: f32,
    mono: Vec<f32>,
}

/// The sounds of a scene.
#[derive(Debug)]
struct Voices {
    /// The sound of the balance.
    sound: Sound,
    player: Player,
    remote: PlayerRemote,
}

/// The requested state.
#[derive(Debug)]
struct Wanted {
    /// The sounds of another scene, or another sound; `None` if they are unchanged.
    voices: Option<Voices>,
    listen: Listen,
    law: PanningLaw,
}

impl Voices {
    fn new(scene: &Scene, spec: &SoundSpec, rate_hz: u32) -> Result<Voices, Error> {
        let sound = Sound::load(spec, rate_hz)?;
        let (player, remote) = player(scene, spec, rate_hz)?;
        Ok(Voices {
            sound,
            player,
            remote,
        })
    }
}

impl Mix {
    /// Creates a mix for a scene's sources with the sample rate `rate_hz`. The mix is silent until it receives a
    /// response.
    ///
    /// # Errors
    /// The errors of [`Sound::load`], and [`ResponseError::BadRate`](echomarch::response::ResponseError::BadRate).
    pub fn new(scene: &Scene, spec: &SoundSpec, rate_hz: u32) -> Result<Mix, Error> {
        let law = PanningLaw::for_profile(Profile::Hybrid);
        let listen = Listen::Full;
        Ok(Mix {
            rate_hz,
            voices: Voices::new(scene, spec, rate_hz)?,
            listen,
            mixer: Mixer::new(law),
            pan: None,
            wanted: Wanted {
                voices: None,
                listen,
                law,
            },
            fade: 0,
            fade_length: ((FADE_S * rate_hz as f32) as usize).max(1),
            volume: 0.0,
            wanted_volume: 0.5,
            mono: Vec::new(),
        })
    }

    /// Changes to another scene or sound, which is silent until its first response. All messages passed to
    /// [`hear`](Mix::hear) after this call must belong to the new scene.
    ///
    /// # Errors
    /// The errors of [`Sound::load`]. After an error the previous sound continues.
    pub fn set_scene(&mut self, scene: &Scene, spec: &SoundSpec) -> Result<(), Error> {
        self.wanted.voices = Some(Voices::new(scene, spec, self.rate_hz)?);
        Ok(())
    }

    /// Sets the listening mode.
    pub fn set_listen(&mut self, listen: Listen) {
        self.wanted.listen = listen;
    }

    /// Sets the volume, 0 to 1. NaN counts as 0.
    pub fn set_volume(&mut self, volume: f32) {
        self.wanted_volume = if volume.is_nan() {
            0.0
        } else {
            volume.clamp(0.0, 1.0)
        };
    }

    /// Sets the pan of the balance, −1 to 1, computed with the given profile. The balance is silent until a pan is known
    /// (NaN means that it is not).
    pub fn set_pan(&mut self, profile: Profile, pan: f32) {
        self.wanted.law = PanningLaw::for_profile(profile);
        if !pan.is_nan() {
            self.pan = Some(pan);
        }
    }

    /// The largest attenuation by the limiter since the last call, in decibels, 0 or more.
    pub fn limited_db(&self) -> f32 {
        self.voices.remote.limited_db()
    }

    /// Whether the mix has played a response of its scene, or a pan of its balance.
    pub fn is_heard(&self) -> bool {
        let is_new = self.wanted.voices.is_none();
        is_new
            && match self.wanted.listen {
                Listen::Full => self.voices.remote.is_heard(),
                Listen::Balance => self.pan.is_some(),
            }
    }

    /// Glides to the response of a source. If too many glides are in progress, returns false and changes nothing.
    ///
    /// # Errors
    /// [`Error::Acoustics`] if the source does not exist or the glide time is 0. The mix is then unchanged.
    pub fn hear(&mut self, message: HeardMessage) -> Result<bool, Error> {
        let parts = HeardParts {
            echoes: message.echoes,
            late: message.late,
        };
        let voices = self.wanted.voices.as_mut().unwrap_or(&mut self.voices);
        let heard = parts.heard(voices.remote.spec());
        voices.remote.set_gain(message.gain)?;
        Ok(voices.remote.hear(message.source, heard, message.glide_s)?)
    }

    /// Overwrites the buffer with the next samples of both channels, interleaved.
    pub fn fill(&mut self, stereo: &mut [f32]) {
        let (mut rest, odd) = stereo.split_at_mut(stereo.len() / 2 * 2);
        odd.fill(0.0);
        while !rest.is_empty() {
            if self.fade == 0 {
                self.change_over();
            }
            if self.listen == Listen::Balance && self.pan.is_none() && self.fade == 0 {
                rest.fill(0.0);
                return;
            }
            let is_ending = self.is_to_change();
            let frames = match is_ending {
                true => self.fade.min(rest.len() / 2),
                false => rest.len() / 2,
            };
            let (block, later) = rest.split_at_mut(2 * frames);
            self.play(block);
            self.apply_volume(block, is_ending);
            rest = later;
        }
    }

    /// Whether the requested state differs from the current state. The panning law is compared only in the balance.
    fn is_to_change(&self) -> bool {
        let is_heard = self.listen == Listen::Balance;
        self.wanted.voices.is_some()
            || self.listen != self.wanted.listen
            || is_heard && self.mixer.law() != self.wanted.law
    }

    /// Switches to the requested state.
    fn change_over(&mut self) {
        if let Some(voices) = self.wanted.voices.take() {
            self.voices = voices;
        }
        self.listen = self.wanted.listen;
        self.mixer = Mixer::new(self.wanted.law);
    }

    /// Overwrites a block with the next samples at full level.
    fn play(&mut self, stereo: &mut [f32]) {
        match self.listen {
            Listen::Full => {
                stereo.fill(0.0);
                self.voices.player.add(stereo);
            }
            Listen::Balance => {
                self.mono.resize(stereo.len() / 2, 0.0);
                self.voices.sound.fill(&mut self.mono);
                let pan = self.pan.unwrap_or_default();
                let mixed = self.mixer.mix(&self.mono, pan, stereo);
                debug_assert!(mixed.is_ok(), "there are two samples for each one");
            }
        }
    }

    fn apply_volume(&mut self, stereo: &mut [f32], is_ending: bool) {
        let step = 1.0 / self.fade_length as f32;
        let (pairs, _) = stereo.as_chunks_mut::<2>();
        for pair in pairs {
            self.fade = match is_ending {
                true => self.fade - 1,
                false => (self.fade + 1).min(self.fade_length),
            };
            self.volume += (self.wanted_volume - self.volume).clamp(-step, step);
            let gain = self.volume * self.fade as f32 * step;
            *pair = pair.map(|sample| sample * gain);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u32 = 48_000;

    /// Returns the largest difference between successive samples in `blocks` blocks. `last` is the sample before the
    /// first block.
    fn largest_step(mix: &mut Mix, blocks: usize, last: &mut [f32; 2]) -> f32 {
        let mut largest: f32 = 0.0;
        let mut stereo = [0.0; 1024];
        for _ in 0..blocks {
            mix.fill(&mut stereo);
            for pair in stereo.as_chunks::<2>().0 {
                largest = largest.max((pair[0] - last[0]).abs().max((pair[1] - last[1]).abs()));
                *last = *pair;
            }
        }
        largest
    }

    /// Protects listeners from clicks: a change of scene, sound, law or listening mode causes no larger step between
    /// samples than the tone and its fade.
    #[test]
    fn no_change_clicks() {
        /// Factor by which a fade of 480 samples increases the largest step of a 220 Hz tone, which is 1/35 of its
        /// amplitude.
        const FADING: f32 = 1.1;
        /// Number of 512-frame blocks that contain a change and both of its fades.
        const BLOCKS: usize = 6;
        let scene = Scene::builtin("corner").unwrap();
        let tone: SoundSpec = "sine:220".parse().unwrap();
        let mut mix = Mix::new(&scene, &tone, RATE_HZ).unwrap();
        mix.set_listen(Listen::Balance);
        mix.set_pan(Profile::Hybrid, 0.3);
        let mut last = [0.0; 2];
        let first = largest_step(&mut mix, BLOCKS, &mut last);
        let steady = largest_step(&mut mix, BLOCKS, &mut last);
        assert!(steady > 0.0 && first <= FADING * steady, "{first} {steady}");
        let mut check = |mix: &mut Mix, what: &str| {
            let step = largest_step(mix, BLOCKS, &mut last);
            assert!(step <= FADING * steady, "{what}: {step}, {steady}");
        };
        mix.set_pan(Profile::Thesis, 0.3);
        check(&mut mix, "another law");
        mix.set_pan(Profile::Hybrid, 0.3);
        check(&mut mix, "and back");
        mix.set_scene(&scene, &tone).unwrap();
        check(&mut mix, "another scene");
        mix.set_listen(Listen::Full);
        check(&mut mix, "full");
        mix.set_listen(Listen::Balance);
        check(&mut mix, "balance");
    }

    /// Protects the timbre of sound that bends around obstacles in scenes whose materials change no timbre.
    #[test]
    fn sound_is_split_into_bands_in_every_scene() {
        let scene = Scene::builtin("corner").unwrap();
        assert!(!scene.has_bands() && played(&scene, RATE_HZ).has_bands);
    }

    /// Protects a new scene: messages that arrive during the fade of the old scene belong to the new scene.
    #[test]
    fn what_is_heard_while_a_scene_fades_is_of_the_next() {
        let scene = Scene::builtin("corner").unwrap();
        let noise = SoundSpec::Noise { seed: 1 };
        let mut mix = Mix::new(&scene, &noise, RATE_HZ).unwrap();
        let mut stereo = vec![0.0; 4096];
        mix.fill(&mut stereo);
        mix.set_scene(&scene, &noise).unwrap();
        let spec = played(&scene, RATE_HZ);
        let late = vec![1.0; 2 * (spec.longest_s * f64::from(RATE_HZ)) as usize];
        let message = HeardMessage {
            source: 0,
            echoes: Vec::new(),
            late: Some(late),
            gain: 1.0,
            glide_s: 0.0,
        };
        assert!(mix.hear(message).unwrap());
        let mut heard = vec![0.0; RATE_HZ as usize];
        mix.fill(&mut heard);
        assert!(heard.iter().any(|sample| *sample != 0.0));
    }

    /// Protects the first second: the balance is silent until the pan of a frame is known, full sound until a response
    /// has arrived, and then both fade in.
    #[test]
    fn nothing_is_played_before_it_is_known_where_it_comes_from() {
        let scene = Scene::builtin("corner").unwrap();
        let noise = SoundSpec::Noise { seed: 1 };
        for listen in [Listen::Full, Listen::Balance] {
            let mut mix = Mix::new(&scene, &noise, RATE_HZ).unwrap();
            mix.set_listen(listen);
            mix.set_volume(1.0);
            mix.set_pan(Profile::Hybrid, f32::NAN);
            let mut stereo = vec![1.0; RATE_HZ as usize];
            mix.fill(&mut stereo);
            assert!(stereo.iter().all(|sample| *sample == 0.0), "{listen}");
            assert!(!mix.is_heard(), "{listen}");
            let spec = played(&scene, RATE_HZ);
            let mut late = vec![0.0; 2 * (spec.longest_s * f64::from(RATE_HZ)) as usize];
            late[0] = 0.3;
            let message = HeardMessage {
                source: 0,
                echoes: Vec::new(),
                late: Some(late),
                gain: 1.0,
                glide_s: 0.02,
            };
            mix.set_pan(Profile::Hybrid, 0.3);
            assert!(mix.hear(message).unwrap());
            mix.fill(&mut stereo);
            let peak = |samples: &[f32]| samples.iter().fold(0.0_f32, |peak, s| peak.max(s.abs()));
            let (first, steady) = (peak(&stereo[..96]), peak(&stereo[40_000..]));
            assert!(mix.is_heard() && steady > 0.1, "{listen}: {steady}");
            assert!(first < 0.2 * steady, "{listen}: {first}, {steady}");
        }
    }
}
