//! What is heard in full: a thread with a renderer of its own follows the scene, and tells the sound
//! what comes to the ears.
//!
//! Its pace is its own: pictures do not wait for it, and it does not wait for them. Echoes are those of
//! its last look at the scene and glide to the next; the late part is made anew four times a second at
//! the most.

use crate::acoustics::{ListenerAxes, strength_db};
#[cfg(feature = "audio")]
use crate::audio::{Signal, Sound, SoundSpec, StereoSignal, StereoSource};
#[cfg(feature = "audio")]
use crate::auralisation::{Heard, Player, PlayerRemote, Spec};
use crate::bands;
use crate::error::Error;
use crate::gpu::{Context, ContextOptions};
use crate::response::{Response, ResponseSettings};
use crate::scene::Scene;
use crate::trace::{Profile, Settings, Tracer};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Waves of a response at the most: echoes are exact, and a late part that lasts a quarter of a second
/// needs no more.
const MOST_WAVES: u32 = 16_384;

/// Reflections of exact paths.
const ORDER: u32 = 3;

/// Seconds of a response at the most: a kernel of two seconds takes 4 % of a core to convolve with.
const LONGEST_S: f64 = 2.0;

/// Seconds between two late parts.
const LATE_EVERY_S: f64 = 0.25;

/// How often the length of the responses is foretold anew, in seconds.
const LENGTH_EVERY_S: f64 = 4.0;

/// On a software renderer it rests so long after each look, of the time that this took: the picture
/// wants the cores too.
const REST: f64 = 1.0;

/// How often it asks for something new to hear.
const GLANCE: Duration = Duration::from_millis(4);

/// Seconds in which echoes glide from one look to the next: what one of them took, within these.
const SHORTEST_GLIDE_S: f64 = 0.02;
const LONGEST_GLIDE_S: f64 = 0.5;

/// Chooses the noise of the late parts.
#[cfg(feature = "audio")]
const NOISE_SEED: u64 = 1;

/// The lower end of the curve of energy, in decibels.
pub const QUIETEST_DB: f64 = -80.0;

/// How much louder all is played than its sound would be 1 m off: a source 4 m off is as loud as its
/// sound. What is too loud then is limited.
#[cfg(feature = "audio")]
const GAIN_DB: f32 = 12.0;

/// Points of the curve of energy against time.
const CURVE_POINTS: usize = 120;

/// What is heard of one source.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SourceHeard {
    /// The strength *G*, the mean of the bands, in decibels; none if nothing arrives.
    pub level_db: Option<f64>,
    /// Exact paths.
    pub paths: usize,
    /// Whether the direct sound is one of them.
    pub is_direct: bool,
}

/// How it stands.
#[derive(Clone, Debug, Default)]
pub struct EarsStatus {
    /// What is heard of each source; none before the first look.
    pub sources: Vec<SourceHeard>,
    /// Energy against time of all sources, in decibels against its largest, in equal parts of
    /// `curve_s` seconds.
    pub curve: Vec<f32>,
    pub curve_s: f64,
    /// Milliseconds that the last look took to trace, and to make its late part.
    pub trace_ms: f64,
    pub late_ms: f64,
    /// Looks so far.
    pub looks: u64,
    /// Why nothing is heard in full.
    pub error: Option<String>,
}

/// What there is to be heard.
struct Wanted {
    scene: Scene,
    settings: Settings,
}

/// What both threads hold.
#[derive(Default)]
struct Shared {
    wanted: Mutex<Option<Wanted>>,
    status: Mutex<EarsStatus>,
    #[cfg(feature = "audio")]
    remote: Mutex<Option<PlayerRemote>>,
    /// Whether a player waits to be told what it plays.
    is_waited_for: AtomicBool,
    is_over: AtomicBool,
}

/// The ears: dropping them ends their thread.
pub struct Ears {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// Locks a value; each is whole whatever a thread that panicked did.
fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Ears {
    /// Starts the thread, which opens a renderer of its own.
    pub fn start(options: ContextOptions) -> Ears {
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let run = move || {
            if let Err(error) = Looking::new(&theirs, &options).and_then(Looking::run) {
                lock(&theirs.status).error = Some(error.to_string());
            }
        };
        let thread = thread::Builder::new().name("echomarch-ears".to_owned());
        let thread = thread.spawn(run).map_err(|error| {
            lock(&shared.status).error = Some(format!("cannot start a thread: {error}"));
        });
        Ears {
            thread: thread.ok(),
            shared,
        }
    }

    /// What is to be heard from now on.
    pub fn hear(&self, scene: &Scene, settings: &Settings) {
        *lock(&self.shared.wanted) = Some(Wanted {
            scene: scene.clone(),
            settings: settings.clone(),
        });
    }

    /// How it stands.
    pub fn status(&self) -> EarsStatus {
        lock(&self.shared.status).clone()
    }

    /// The sources of a scene as two channels, each with its own sound: as `spec` where that is a
    /// file or a sine, else each with another voice or noise.
    #[cfg(feature = "audio")]
    pub fn source(&self, scene: &Scene, spec: &SoundSpec) -> StereoSource {
        let shared = Arc::clone(&self.shared);
        let sounds: Vec<SoundSpec> = (0..scene.sources().count())
            .map(|source| own_voice(spec, source as u64))
            .collect();
        let scene = scene.clone();
        StereoSource::new(move |rate_hz| -> Box<dyn StereoSignal> {
            // A file that cannot be had at this rate is silent: that it cannot is told of the one sound.
            let load = |spec: &SoundSpec| {
                Sound::load(spec, rate_hz).unwrap_or_else(|_| Sound::new(Silence))
            };
            let spec = Spec::of(&scene, rate_hz).with_longest(LONGEST_S);
            let gain = 10_f32.powf(GAIN_DB / 20.0);
            let (player, remote) = Player::new(sounds.iter().map(load).collect(), spec, gain);
            *lock(&shared.remote) = Some(remote);
            shared.is_waited_for.store(true, Relaxed);
            Box::new(player)
        })
    }
}

impl Drop for Ears {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            // If it panicked there is nothing left to end.
            let _ = thread.join();
        }
    }
}

/// No sound.
#[cfg(feature = "audio")]
struct Silence;

#[cfg(feature = "audio")]
impl Signal for Silence {
    fn fill(&mut self, out: &mut [f32]) {
        out.fill(0.0);
    }

    fn seek(&mut self, _: u64) {}
}

/// The sound of a source by its number, so that no two speak with one voice.
#[cfg(feature = "audio")]
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

/// The thread's own.
struct Looking<'a> {
    shared: &'a Shared,
    tracer: Tracer,
    is_software: bool,
    /// The last scene that was heard.
    scene: Option<Scene>,
    /// Responses are so long, and when that was found.
    length: Option<(f64, Instant)>,
    last_look: Instant,
    last_late: Option<Instant>,
}

impl<'a> Looking<'a> {
    fn new(shared: &'a Shared, options: &ContextOptions) -> Result<Looking<'a>, Error> {
        let context = Context::headless(options)?;
        Ok(Looking {
            shared,
            is_software: context.is_software(),
            tracer: Tracer::new(&context)?,
            scene: None,
            length: None,
            last_look: Instant::now(),
            last_late: None,
        })
    }

    fn run(mut self) -> Result<(), Error> {
        while !self.shared.is_over.load(Relaxed) {
            let wanted = lock(&self.shared.wanted).take();
            let Some(wanted) = wanted.filter(|wanted| self.is_new(wanted)) else {
                thread::sleep(GLANCE);
                continue;
            };
            let began = Instant::now();
            // What cannot be heard in full is told; the next scene may be.
            if let Err(error) = self.look(&wanted) {
                lock(&self.shared.status).error = Some(error.to_string());
            }
            if self.is_software {
                thread::sleep(began.elapsed().mul_f64(REST));
            }
        }
        Ok(())
    }

    /// Whether something is heard otherwise than at the last look. A late part that was not due then is
    /// made once things have come to rest.
    fn is_new(&self, wanted: &Wanted) -> bool {
        let is_another = self.scene.as_ref() != Some(&wanted.scene);
        let lacks_late = self.last_late < Some(self.last_look) && self.late_is_due();
        wanted.settings.profile() != Profile::Thesis
            && (is_another || lacks_late || self.is_waited_for())
    }

    fn is_waited_for(&self) -> bool {
        self.shared.is_waited_for.load(Relaxed)
    }

    fn late_is_due(&self) -> bool {
        let since = |last: Instant| last.elapsed().as_secs_f64() >= LATE_EVERY_S;
        self.is_waited_for() || self.last_late.is_none_or(since)
    }

    /// Traces what is heard of every source, and tells the player.
    fn look(&mut self, wanted: &Wanted) -> Result<(), Error> {
        let began = Instant::now();
        let glide_s = self
            .last_look
            .elapsed()
            .as_secs_f64()
            .clamp(SHORTEST_GLIDE_S, LONGEST_GLIDE_S);
        let is_late_due = self.late_is_due();
        self.shared.is_waited_for.store(false, Relaxed);
        let seconds = self.length_s(wanted)?;
        let settings = response_settings(&wanted.settings).with_seconds(seconds);
        let axes = ListenerAxes::of(&wanted.scene.listener)?;
        let mut status = EarsStatus {
            curve_s: seconds,
            ..EarsStatus::default()
        };
        let mut curve = vec![0.0; CURVE_POINTS];
        let mut on_late = Duration::ZERO;
        for source in 0..wanted.scene.sources().count() {
            let pair = wanted.scene.heard_by(source, 0);
            let response = Response::trace(&mut self.tracer, &pair, &settings)?;
            status.sources.push(SourceHeard::of(&response));
            add_to_curve(&mut curve, &response, seconds);
            let making = Instant::now();
            self.tell(source, &response, &axes, is_late_due, glide_s)?;
            on_late += making.elapsed();
        }
        status.curve = in_decibels(&curve);
        status.late_ms = 1e3 * on_late.as_secs_f64();
        status.trace_ms = 1e3 * began.elapsed().as_secs_f64() - status.late_ms;
        self.last_look = Instant::now();
        if is_late_due {
            self.last_late = Some(self.last_look);
        }
        self.scene = Some(wanted.scene.clone());
        let mut told = lock(&self.shared.status);
        status.looks = told.looks + 1;
        *told = status;
        Ok(())
    }

    /// Tells the player what is heard of a source, if there is one.
    #[cfg(feature = "audio")]
    fn tell(
        &self,
        source: usize,
        response: &Response,
        axes: &ListenerAxes,
        is_late_due: bool,
        glide_s: f64,
    ) -> Result<(), Error> {
        let Some(spec) = lock(&self.shared.remote).as_ref().map(PlayerRemote::spec) else {
            return Ok(());
        };
        let heard = match is_late_due {
            true => Heard::new(response, axes, spec, NOISE_SEED)?,
            false => Heard::of_paths(&response.paths, axes, spec),
        };
        // Another player may have come meanwhile: it asks for what it plays.
        if let Some(remote) = lock(&self.shared.remote).as_mut()
            && remote.spec() == spec
        {
            remote.hear(source, heard, glide_s);
        }
        Ok(())
    }

    #[cfg(not(feature = "audio"))]
    fn tell(&self, _: usize, _: &Response, _: &ListenerAxes, _: bool, _: f64) -> Result<(), Error> {
        Ok(())
    }

    /// How long responses are: as foretold some seconds ago.
    fn length_s(&mut self, wanted: &Wanted) -> Result<f64, Error> {
        let is_another = self
            .scene
            .as_ref()
            .is_none_or(|last| last.name != wanted.scene.name);
        if let Some((seconds, found)) = self.length
            && !is_another
            && found.elapsed().as_secs_f64() < LENGTH_EVERY_S
        {
            return Ok(seconds);
        }
        let settings = response_settings(&wanted.settings);
        let mut longest: f64 = 0.0;
        for source in 0..wanted.scene.sources().count() {
            let pair = wanted.scene.heard_by(source, 0);
            longest = longest.max(settings.seconds_needed(&mut self.tracer, &pair)?);
        }
        let seconds = longest.min(LONGEST_S);
        self.length = Some((seconds, Instant::now()));
        Ok(seconds)
    }
}

fn response_settings(chosen: &Settings) -> ResponseSettings {
    let waves = chosen.waves.min(MOST_WAVES);
    let settings = ResponseSettings::default().with_trace(chosen.clone().with_waves(waves));
    settings.with_order(ORDER)
}

impl SourceHeard {
    fn of(response: &Response) -> SourceHeard {
        SourceHeard {
            level_db: strength_db(bands::mean(&response.energy())),
            paths: response.paths.len(),
            is_direct: response.direct().is_some(),
        }
    }
}

/// Adds the energies of a response to their parts of the time.
fn add_to_curve(curve: &mut [f64], response: &Response, seconds: f64) {
    let mut add = |at_s: f64, energy: f64| {
        let part = (at_s / seconds * CURVE_POINTS as f64) as usize;
        if let Some(sum) = curve.get_mut(part) {
            *sum += energy;
        }
    };
    for path in &response.paths {
        add(path.delay_s, bands::mean(&path.energy));
    }
    let echogram = &response.echogram;
    for bin in 0..echogram.bins() {
        let at_s = echogram.first_s() + (bin as f64 + 0.5) * echogram.bin_s();
        add(at_s, bands::mean(&echogram.energy(bin)));
    }
}

/// Against the largest; −80 dB and less are −80 dB.
fn in_decibels(curve: &[f64]) -> Vec<f32> {
    let largest = curve.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let decibels = |energy: &f64| (10.0 * (energy / largest).log10()).max(QUIETEST_DB) as f32;
    curve.iter().map(decibels).collect()
}
