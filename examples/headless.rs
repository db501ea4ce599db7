//! Computes a panning value for a built-in scene without a window:
//!
//! ```sh
//! cargo run --release --example headless
//! ```

use echomarch::gl::{Context, ContextOptions};
use echomarch::{Error, Scene, Settings, Tracer};

fn main() -> Result<(), Error> {
    // The first EGL device that works. It may be a software renderer, so the program prints its name.
    let context = Context::headless(&ContextOptions::default())?;
    println!("renderer: {}", context.renderer());

    let scene = Scene::builtin("corner")?;
    let settings = Settings::default().with_waves(65_536).with_iterations(8);
    let mut tracer = Tracer::new(&context)?;
    let frame = tracer.frame(&scene, &settings)?;

    println!(
        "{} of {} waves reached the listener: left {:.1}, right {:.1}, pan {:+.3}",
        frame.counts.listener_hits,
        settings.waves,
        frame.panning.left,
        frame.panning.right,
        frame.panning.pan(),
    );
    // The first frame of a scene compiles its shader, the second frame does not.
    let next = tracer.frame(&scene, &settings)?;
    println!(
        "first frame {:.1} ms, second {:.1} ms",
        frame.milliseconds.total, next.milliseconds.total
    );
    Ok(())
}
