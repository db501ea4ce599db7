//! A game loop. For each picture, the game begins or continues a frame of waves, and never waits for the frame. The
//! result sets the gains of a voice in the game's audio engine.
//!
//! ```sh
//! cargo run --release --example game_loop
//! ```

use echomarch::audio::{Gains, PanningLaw};
use echomarch::gl::{Context, ContextOptions};
use echomarch::{Error, Scene, Settings, Tracer};
use std::time::{Duration, Instant};

/// Duration of a picture at 60 pictures per second.
const PICTURE: Duration = Duration::from_micros(16_667);

/// Time per picture that is spent on waves, in milliseconds.
const WAVES_MS: f64 = 4.0;

/// Distance in metres that the source moves per picture.
const STEP_M: f32 = 0.05;

/// A placeholder for a voice of an audio engine, which would fade to the given gains.
#[derive(Default)]
struct Voice {
    gains: Gains,
}

impl Voice {
    fn set_gains(&mut self, gains: Gains) {
        self.gains = gains;
    }
}

fn main() -> Result<(), Error> {
    let context = Context::headless(&ContextOptions::default())?;
    println!("renderer: {}", context.renderer());
    let mut tracer = Tracer::new(&context)?;
    let mut scene = Scene::builtin("open-field")?;
    let settings = Settings::default().with_waves(16_384);
    let mut voice = Voice::default();
    let mut heard = 0;

    for picture in 0..120 {
        let began = Instant::now();
        // The game moves its objects.
        scene.sources[0].position.x += STEP_M;
        // A new frame of waves begins if the last frame is complete. Waves get a share of this picture's time.
        if !tracer.is_frame_pending() {
            tracer.frame_begin(&scene, &settings)?;
        }
        tracer.frame_advance(WAVES_MS)?;
        if let Some(frame) = tracer.frame_poll()? {
            heard += 1;
            voice.set_gains(PanningLaw::ConstantPower.gains(frame.panning.pan() as f32));
        }
        // Here the game draws its picture.
        std::thread::sleep(PICTURE.saturating_sub(began.elapsed()));
        if picture % 30 == 29 {
            let Gains { left, right } = voice.gains;
            println!(
                "picture {picture:3}: gains {left:.3} and {right:.3} after {heard} frames of waves"
            );
        }
    }
    Ok(())
}
