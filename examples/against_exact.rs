//! Compares the thesis' algorithm with exact tracing of the same waves:
//!
//! ```sh
//! cargo run --release --features reference --example against_exact [WAVES]
//! ```

use echomarch::geometry::ExactScene;
use echomarch::gl::{Context, ContextOptions};
use echomarch::glam::Vec3;
use echomarch::internals::sampling::median;
use echomarch::tracer::Fate;
use echomarch::{Scene, Settings, Tracer};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let waves: u32 = match std::env::args().nth(1) {
        Some(count) => count.parse()?,
        None => 65_536,
    };
    let context = Context::headless(&ContextOptions::default())?;
    println!("renderer: {}, {waves} waves, seed 1", context.renderer());
    let mut tracer = Tracer::new(&context)?;

    println!("scene      iterations  thesis   exact  ends > 1 m off  median of the offs");
    for name in ["corner", "obstacles"] {
        let scene = Scene::builtin(name)?;
        let exact_scene = ExactScene::new(&scene)?;
        for iterations in [4, 8] {
            let settings = Settings::thesis()
                .with_waves(waves)
                .with_iterations(iterations);
            let (frame, marched) = tracer.frame_with_waves(&scene, &settings)?;

            // The initial directions on the GPU, traced in `f64`.
            let starts: Vec<Vec3> = marched.iter().map(|wave| wave.start_direction).collect();
            let source = scene.sources[0].position.as_dvec3();
            let exact = exact_scene.trace_all(source, &starts, iterations);
            let heard = exact.iter().filter(|wave| wave.status == 0).count();

            // The errors of the end points of waves that are not dead (no wave leaves a closed room).
            let offs: Vec<f64> = marched
                .iter()
                .zip(&exact)
                .filter(|(marched, _)| marched.fate() != Fate::Dead)
                .map(|(marched, exact)| marched.position.as_dvec3().distance(exact.point))
                .collect();
            let far = offs.len() - offs.iter().filter(|off| **off <= 1.0).count();
            println!(
                "{name:10} {iterations:10} {:7} {heard:7} {:13.1} % {:17.2} m",
                frame.counts.listener_hits,
                100.0 * far as f64 / offs.len() as f64,
                median(offs),
            );
        }
    }
    Ok(())
}
