//! Full listening: a thread with its own OpenGL context traces the scene, and passes the sound at the listener to the
//! player.
//!
//! This thread and the drawing thread do not wait for each other. Each trace updates the echoes, which glide to their
//! new values. The late part is computed at most four times per second.

use echomarch::Error;
#[cfg(feature = "audio")]
use echomarch::audio::{SoundSpec, StereoSignal, live::StereoSource};
#[cfg(feature = "audio")]
use echomarch::auralisation::{Heard, PlayerRemote};
use echomarch::gl::{Context, ContextOptions};
use echomarch::scene::Scene;
use echomarch::tracer::Settings;
use echomarch_walk::{EarsStatus, Found, Hearing, Parts};
#[cfg(feature = "audio")]
use echomarch_walk::{NOISE_SEED, player};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Pause after each trace on a software renderer, as a multiple of the trace's duration. The pause leaves processor
/// cores to the picture.
const REST: f64 = 1.0;

/// Interval between two checks for a new scene or new settings.
const GLANCE: Duration = Duration::from_millis(4);

/// The scene and the settings to trace, and the parts to hear.
struct Wanted {
    scene: Scene,
    settings: Settings,
    parts: Parts,
}

/// State shared by both threads.
#[derive(Default)]
struct Shared {
    wanted: Mutex<Option<Wanted>>,
    status: Mutex<EarsStatus>,
    #[cfg(feature = "audio")]
    remote: Mutex<Option<PlayerRemote>>,
    /// The action that waits for the player to play a response.
    #[cfg(feature = "audio")]
    when_heard: Mutex<Option<Box<dyn FnOnce() + Send>>>,
    /// Whether a player is waiting for its first response.
    is_waited_for: AtomicBool,
    is_over: AtomicBool,
}

impl Shared {
    /// Calls the action that waits for a response if the player has played one.
    fn act_if_heard(&self) {
        #[cfg(feature = "audio")]
        if lock(&self.remote)
            .as_ref()
            .is_some_and(PlayerRemote::is_heard)
            && let Some(act) = lock(&self.when_heard).take()
        {
            act();
        }
    }
}

/// The handle of the listening thread. Dropping it ends the thread.
pub struct Ears {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// Locks a value, even if a thread panicked while holding the lock. No thread leaves a value incomplete.
fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Ears {
    /// Starts the thread. The thread opens its own OpenGL context.
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

    /// Sets the scene and the settings to trace from now on, and the parts to hear.
    pub fn hear(&self, scene: &Scene, settings: &Settings, parts: Parts) {
        *lock(&self.shared.wanted) = Some(Wanted {
            scene: scene.clone(),
            settings: settings.clone(),
            parts,
        });
    }

    /// The status of the thread.
    pub fn status(&self) -> EarsStatus {
        EarsStatus {
            limited_db: self.limited_db(),
            ..lock(&self.shared.status).clone()
        }
    }

    /// The attenuation by the limiter since the last call, in decibels; 0 without a player.
    fn limited_db(&self) -> f32 {
        #[cfg(feature = "audio")]
        if let Some(remote) = lock(&self.shared.remote).as_ref() {
            return remote.limited_db();
        }
        0.0
    }

    /// Calls `act` once, on the listening thread, when the player has played a response.
    #[cfg(feature = "audio")]
    pub fn when_heard(&self, act: impl FnOnce() + Send + 'static) {
        *lock(&self.shared.when_heard) = Some(Box::new(act));
    }

    /// Plays the sources of a scene in stereo. If `spec` is a file or a sine, every source plays it; otherwise each
    /// source has a separate voice or noise.
    #[cfg(feature = "audio")]
    pub fn source(&self, scene: &Scene, spec: &SoundSpec) -> StereoSource {
        let shared = Arc::clone(&self.shared);
        let (scene, spec) = (scene.clone(), spec.clone());
        StereoSource::new(move |rate_hz| -> Box<dyn StereoSignal> {
            // If responses do not support the device's sample rate, the device stays silent.
            let Ok((player, remote)) = player(&scene, &spec, rate_hz) else {
                return Box::new(Unheard);
            };
            *lock(&shared.remote) = Some(remote);
            shared.is_waited_for.store(true, Relaxed);
            Box::new(player)
        })
    }
}

/// A silent source.
#[cfg(feature = "audio")]
struct Unheard;

#[cfg(feature = "audio")]
impl StereoSignal for Unheard {
    fn add(&mut self, _: &mut [f32]) {}
}

impl Drop for Ears {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has already ended.
            let _ = thread.join();
        }
    }
}

/// The state of the listening thread.
struct Looking<'a> {
    shared: &'a Shared,
    hearing: Hearing,
    is_software: bool,
}

impl<'a> Looking<'a> {
    fn new(shared: &'a Shared, options: &ContextOptions) -> Result<Looking<'a>, Error> {
        let context = Context::headless(options)?;
        Ok(Looking {
            shared,
            is_software: context.is_software(),
            hearing: Hearing::new(&context)?,
        })
    }

    fn run(mut self) -> Result<(), Error> {
        let mut rested = Instant::now();
        while !self.shared.is_over.load(Relaxed) {
            self.shared.act_if_heard();
            if Instant::now() < rested {
                thread::sleep(GLANCE);
                continue;
            }
            let wanted = lock(&self.shared.wanted).take();
            let Some(wanted) = wanted.filter(|wanted| self.is_new(wanted)) else {
                thread::sleep(GLANCE);
                continue;
            };
            let began = Instant::now();
            // The error is shown, and the thread continues, because the next scene may be traceable.
            if let Err(error) = self.look(&wanted) {
                lock(&self.shared.status).error = Some(error.to_string());
            }
            if self.is_software {
                rested = Instant::now() + began.elapsed().mul_f64(REST);
            }
        }
        Ok(())
    }

    fn is_new(&self, wanted: &Wanted) -> bool {
        let is_waited_for = self.shared.is_waited_for.load(Relaxed);
        let Wanted {
            scene,
            settings,
            parts,
        } = wanted;
        self.hearing.is_new(scene, settings, parts, is_waited_for)
    }

    /// Traces every source and passes the responses to the player.
    fn look(&mut self, wanted: &Wanted) -> Result<(), Error> {
        let is_waited_for = self.shared.is_waited_for.swap(false, Relaxed);
        let (scene, settings) = (&wanted.scene, &wanted.settings);
        let shared = self.shared;
        let tell = |found: Found| tell(shared, &found);
        let parts = &wanted.parts;
        let mut status = self
            .hearing
            .look(scene, settings, parts, is_waited_for, tell)?;
        let mut told = lock(&self.shared.status);
        status.looks = told.looks + 1;
        *told = status;
        Ok(())
    }
}

/// Passes the response of a source to the player, if a player exists.
#[cfg(feature = "audio")]
fn tell(shared: &Shared, found: &Found) -> Result<(), Error> {
    let Some(spec) = lock(&shared.remote).as_ref().map(PlayerRemote::spec) else {
        return Ok(());
    };
    let Found { response, axes, .. } = *found;
    let heard = match found.is_late_due {
        true => Heard::new(response, axes, spec, NOISE_SEED)?,
        false => Heard::of_paths(&response.paths, axes, spec)?,
    };
    // If the player was replaced during the trace, the new player requests its own responses.
    if let Some(remote) = lock(&shared.remote).as_mut()
        && remote.spec() == spec
        && found.source < remote.source_count()
    {
        remote.set_gain(found.gain)?;
        remote.hear(found.source, heard, found.glide_s)?;
    }
    Ok(())
}

#[cfg(not(feature = "audio"))]
fn tell(_: &Shared, _: &Found) -> Result<(), Error> {
    Ok(())
}
