//! Stereo sounds that are computed while they are heard.

use std::fmt;
use std::sync::Arc;

/// A caller's own stereo sound, such as the sources heard in a scene: live output plays it instead
/// of a mono sound and its pan.
pub trait StereoSignal: Send {
    /// Adds the next samples of both channels to `stereo` (left, right, …). Called on the thread that must not be late,
    /// so it must not allocate, lock or wait.
    fn add(&mut self, stereo: &mut [f32]);
}

type Make = dyn Fn(u32) -> Box<dyn StereoSignal> + Send + Sync;

/// Makes such a sound at any sample rate: live output calls it again when the device's rate changes.
#[derive(Clone)]
pub struct StereoSource {
    make: Arc<Make>,
}

impl StereoSource {
    /// Creates a source: `make` gets the rate in samples per second and is called on the thread that supervises live
    /// output.
    pub fn new(make: impl Fn(u32) -> Box<dyn StereoSignal> + Send + Sync + 'static) -> Self {
        Self {
            make: Arc::new(make),
        }
    }

    /// Returns the sound at `rate_hz` samples per second, at its start.
    pub fn signal(&self, rate_hz: u32) -> Box<dyn StereoSignal> {
        (self.make)(rate_hz)
    }
}

impl fmt::Debug for StereoSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StereoSource").finish_non_exhaustive()
    }
}
