//! Measures the cost of a scene's marched fields, once per scene and profile, on a thread with its own OpenGL context.
//! The drawing thread does not wait for the measurement.

use echomarch::Error;
use echomarch::gl::{Context, ContextOptions};
use echomarch::internals::fields_cost::FieldsCost;
use echomarch::scene::Scene;
use echomarch::tracer::{Settings, Tracer};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::{self, JoinHandle};

/// Number of waves in a measured frame. The number is a small share of a normal frame, but fills the vector units of a
/// software renderer.
const WAVES: u32 = 1024;

/// Number of measured pairs of frames. The median of three pairs is not affected by one pair that other work delayed.
const RUNS: u32 = 3;

/// A measurement in progress. Dropping it ends the thread after its current frame.
struct Measuring {
    thread: Option<JoinHandle<Option<FieldsCost>>>,
    is_over: Arc<AtomicBool>,
}

/// The cost of the current scene's fields, once it is measured.
#[derive(Default)]
pub struct Fields {
    measuring: Option<Measuring>,
    wanted: Option<(Scene, Settings)>,
    cost: Option<FieldsCost>,
}

impl Fields {
    /// Starts to measure the only source and listener of a scene, and discards the previous cost.
    pub fn measure(&mut self, scene: Scene, settings: &Settings) {
        self.forget();
        let settings = settings.clone();
        let waves = settings.waves.min(WAVES);
        self.wanted = Some((scene, settings.with_waves(waves)));
    }

    /// Discards the cost, because another scene is shown.
    pub fn forget(&mut self) {
        (self.cost, self.wanted) = (None, None);
        if let Some(measuring) = &self.measuring {
            measuring.is_over.store(true, Relaxed);
        }
    }

    /// The cost; `None` before the measurement has ended, and for a scene without marched fields.
    pub fn cost(&self) -> Option<&FieldsCost> {
        self.cost.as_ref()
    }

    /// Takes the result of a finished measurement, then starts the waiting measurement, if there is one.
    pub fn poll(&mut self) {
        if let Some(ended) = self.measuring.take_if(|measuring| measuring.has_ended()) {
            let is_of_now = !ended.is_over.load(Relaxed);
            self.cost = ended.result().filter(|_| is_of_now);
        }
        if self.measuring.is_none()
            && let Some((scene, settings)) = self.wanted.take()
        {
            self.measuring = Some(Measuring::start(scene, settings));
        }
    }
}

impl Measuring {
    fn start(scene: Scene, settings: Settings) -> Measuring {
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&is_over);
        // If the cost cannot be measured, the window shows none.
        let run = move || measure(&scene, &settings, &ends).ok().flatten();
        let thread = thread::Builder::new().name("echomarch-fields".to_owned());
        Measuring {
            thread: thread.spawn(run).ok(),
            is_over,
        }
    }

    fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for the thread and returns its result.
    fn result(mut self) -> Option<FieldsCost> {
        self.thread.take()?.join().ok().flatten()
    }
}

impl Drop for Measuring {
    fn drop(&mut self) {
        self.is_over.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has already ended.
            let _ = thread.join();
        }
    }
}

fn measure(
    scene: &Scene,
    settings: &Settings,
    is_over: &AtomicBool,
) -> Result<Option<FieldsCost>, Error> {
    let mut tracer = Tracer::new(&Context::headless(&ContextOptions::default())?)?;
    let goes_on = || !is_over.load(Relaxed);
    FieldsCost::measure(&mut tracer, scene, settings, RUNS, &goes_on)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(fields: &mut Fields) -> Option<FieldsCost> {
        fields.poll();
        while fields.measuring.is_some() {
            thread::yield_now();
            fields.poll();
        }
        fields.cost().copied()
    }

    /// Protects the shown cost from belonging to another scene: a new measurement replaces the one in progress.
    #[test]
    fn the_cost_is_that_of_the_last_scene() {
        let settings = Settings::hybrid().with_waves(64).with_iterations(1);
        let scene = |name| Scene::builtin(name).unwrap();
        let mut fields = Fields::default();
        fields.measure(scene("cave"), &settings);
        let cave = settled(&mut fields).unwrap();
        assert_eq!((cave.surfaces, cave.waves), (1, 64));
        fields.measure(scene("cave"), &settings);
        fields.poll();
        fields.measure(scene("corner"), &settings);
        assert_eq!(settled(&mut fields), None);
        fields.measure(scene("cave"), &settings);
        fields.forget();
        assert_eq!(settled(&mut fields), None);
    }
}
