//! Full listening for a player that cannot share memory with the tracing code.

use super::drawn_paths::DrawnPath;
use super::hearing::{EarsStatus, Found, Hearing};
use super::mix::HeardMessage;
use super::parts::Parts;
use echomarch::Error;
use echomarch::auralisation::HeardSource;
use echomarch::gl::Context;
use echomarch::scene::Scene;
use echomarch::tracer::Settings;

/// Traces a scene repeatedly with its own tracer, and returns the arrivals at the listener.
pub struct Ears {
    hearing: Hearing,
    status: EarsStatus,
}

impl Ears {
    /// Creates ears that have not traced yet.
    ///
    /// # Errors
    /// [`Error::Gpu`] if OpenGL fails.
    pub fn new(context: &Context) -> Result<Ears, Error> {
        Ok(Ears {
            hearing: Hearing::new(context)?,
            status: EarsStatus::default(),
        })
    }

    /// Returns the response of each source for a [`Mix`](super::Mix) with the sample rate `rate_hz`. Returns an empty
    /// list if the responses have not changed since the last call. `is_new_mix` is true if the mix has received no
    /// response yet.
    ///
    /// # Errors
    /// The errors of [`Response::trace`](echomarch::response::Response::trace).
    pub fn hear(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        parts: &Parts,
        rate_hz: u32,
        is_new_mix: bool,
    ) -> Result<Vec<HeardMessage>, Error> {
        if !self.hearing.is_new(scene, settings, parts, is_new_mix) {
            return Ok(Vec::new());
        }
        let mut messages = Vec::new();
        let tell = collect(&mut messages, scene, rate_hz);
        self.status = self
            .hearing
            .look(scene, settings, parts, is_new_mix, tell)?;
        Ok(messages)
    }

    /// Returns the sound that is found without waves, for a mix that waits for the first trace of a scene. Returns an empty
    /// list if the scene is known, or if waves are needed to hear anything.
    ///
    /// # Errors
    /// The errors of [`hear`](Ears::hear).
    pub fn sketch(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        parts: &Parts,
        rate_hz: u32,
    ) -> Result<Vec<HeardMessage>, Error> {
        let mut messages = Vec::new();
        let tell = collect(&mut messages, scene, rate_hz);
        if let Some(status) = self.hearing.sketch(scene, settings, parts, tell)? {
            self.status = status;
        }
        Ok(messages)
    }

    /// Takes the scene of the next trace as another one, because the scene was edited: its gain, its length and its
    /// numbers of waves are chosen again.
    pub fn forget_scene(&mut self) {
        self.hearing.forget_scene();
    }

    /// The level of each source in the last trace.
    pub fn sources(&self) -> &[HeardSource] {
        &self.status.sources
    }

    /// For each source in the last trace: the likely reason if nothing of it arrives.
    pub fn silences(&self) -> &[Option<String>] {
        &self.status.silences
    }

    /// The paths of the last trace to draw in the plan.
    pub fn paths(&self) -> &[DrawnPath] {
        &self.status.paths
    }

    /// Duration of the last trace, and of its late part, in milliseconds.
    pub fn milliseconds(&self) -> [f64; 2] {
        [self.status.trace_ms, self.status.late_ms]
    }
}

/// Returns a closure that appends the messages of what is found.
fn collect(
    messages: &mut Vec<HeardMessage>,
    scene: &Scene,
    rate_hz: u32,
) -> impl FnMut(Found) -> Result<(), Error> {
    move |found| {
        messages.push(HeardMessage::new(scene, &found, rate_hz)?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Mix;
    use super::*;
    use echomarch::audio::SoundSpec;
    use echomarch::gl::ContextOptions;

    /// Protects against swapped channels: a source at the left is louder at the left, also after the response was
    /// transferred as plain numbers. Protects the mix from repeated responses while the scene is unchanged.
    #[test]
    fn a_source_at_the_left_is_heard_at_the_left() {
        const RATE_HZ: u32 = 48_000;
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let scene = Scene::builtin("open-field").unwrap();
        let left = scene.at(0.0);
        assert!(left.sources[0].position.x < left.listeners[0].position.x);
        let settings = Settings::default().with_waves(4096);
        let mut ears = Ears::new(&context).unwrap();
        let messages = ears
            .hear(&left, &settings, &Parts::default(), RATE_HZ, true)
            .unwrap();
        assert!(messages[0].late.is_some());
        let noise = SoundSpec::Noise { seed: 3 };
        let mut mix = Mix::new(&left, &noise, RATE_HZ).unwrap();
        for message in messages {
            assert!(mix.hear(message).unwrap());
        }
        let mut stereo = vec![0.0; RATE_HZ as usize];
        mix.fill(&mut stereo);
        let level = |channel: usize| {
            let samples = stereo.iter().skip(channel).step_by(2);
            samples.map(|s| f64::from(*s).powi(2)).sum::<f64>()
        };
        assert!(level(0) > 4.0 * level(1), "{} {}", level(0), level(1));
        // On a slow machine another late part may become due, each time with twice the number of waves.
        let mut again = (0..16).map(|_| {
            ears.hear(&left, &settings, &Parts::default(), RATE_HZ, false)
                .unwrap()
        });
        assert!(again.any(|messages| messages.is_empty()));
    }
}
