//! Measures the cost of a hall with many pillars: the time per wave and iteration for each number of pillars, and the
//! additional time of a frame in which a pillar has moved.
//!
//! ```sh
//! cargo run --release --example many_surfaces
//! ```

use echomarch::gl::{Api, Context, ContextOptions};
use echomarch::internals::sampling::median;
use echomarch::scene::shape::{Cylinder, Room};
use echomarch::{Error, Listener, Node, Scene, Settings, Source, Surface, Tracer};
use glam::Vec3;
use std::time::Instant;

/// Distance between neighbouring pillars in metres.
const SPACING: f32 = 4.0;

/// Number of frames per median with many waves, and with few waves.
const FRAMES: usize = 9;
const SMALL_FRAMES: usize = 101;

fn main() -> Result<(), Error> {
    let context = Context::headless(&ContextOptions::new(Api::Gl))?;
    println!("{}", context.renderer());
    let settings = [
        Settings::hybrid().with_waves(65_536),
        Settings::march().with_waves(16_384),
        Settings::thesis().with_waves(16_384),
    ];
    for settings in &settings {
        println!("\nprofile {}", settings.profile());
        println!(
            "pillars  compile ms  ns a wave and iteration  times 16  frame of 64 waves, ms  one moves: ms more"
        );
        let mut first = None;
        for side in [4, 8, 16, 32] {
            let scene = hall(side);
            let mut tracer = Tracer::new(&context)?;
            let began = Instant::now();
            tracer.frame(&scene, settings)?;
            let compile = began.elapsed().as_secs_f64() * 1e3;
            let march = march(&mut tracer, &scene, settings)?;
            let few = settings.clone().with_waves(64);
            let (still, moving) = still_and_moving(&mut tracer, &scene, &few)?;
            let passes = f64::from(settings.waves) * f64::from(settings.iterations);
            let nanoseconds = march * 1e6 / passes;
            let times = nanoseconds / *first.get_or_insert(nanoseconds);
            println!(
                "{:7}  {compile:10.0}  {nanoseconds:23.1}  {times:8.2}  {still:21.2}  {:18.2}",
                side * side,
                moving - still
            );
        }
    }
    Ok(())
}

/// Time of the march in a frame, in milliseconds.
fn march(tracer: &mut Tracer, scene: &Scene, settings: &Settings) -> Result<f64, Error> {
    let frames = (0..FRAMES).map(|_| Ok(tracer.frame(scene, settings)?.milliseconds.march));
    Ok(median(frames.collect::<Result<Vec<f64>, Error>>()?))
}

/// Times of a whole frame in milliseconds, without a move and after a pillar has moved. The two are measured
/// alternately.
fn still_and_moving(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
) -> Result<(f64, f64), Error> {
    let mut scene = scene.clone();
    let (mut still, mut moving) = (Vec::new(), Vec::new());
    let middle = scene.surfaces.len() / 2;
    for frame in 0..SMALL_FRAMES {
        still.push(whole(tracer, &scene, settings)?);
        scene.surfaces[middle].position.x += if frame % 20 < 10 { 0.05 } else { -0.05 };
        moving.push(whole(tracer, &scene, settings)?);
    }
    Ok((median(still), median(moving)))
}

/// Time in milliseconds that a caller waits for a frame.
fn whole(tracer: &mut Tracer, scene: &Scene, settings: &Settings) -> Result<f64, Error> {
    let began = Instant::now();
    tracer.frame(scene, settings)?;
    Ok(began.elapsed().as_secs_f64() * 1e3)
}

/// A room with pillars from floor to ceiling, in a square grid along x and z.
fn hall(side: usize) -> Scene {
    let width = SPACING * side as f32;
    let mut surfaces = vec![Surface::new(Node::Room(Room {
        size: Vec3::new(width, 6.0, width),
    }))];
    let place = |index: usize| SPACING * (index as f32 + 0.5) - 0.5 * width;
    for row in 0..side {
        for column in 0..side {
            let radius = 0.3 + 0.1 * ((row * 7 + column * 3) % 5) as f32;
            let pillar = Surface::new(Node::Cylinder(Cylinder { radius }));
            surfaces.push(pillar.at(Vec3::new(place(column), 0.0, place(row))));
        }
    }
    Scene::new(
        format!("hall of {} pillars", side * side),
        surfaces,
        Source::at(Vec3::new(0.0, 0.0, 0.0)),
        Listener::at(Vec3::new(SPACING, 0.0, SPACING), 0.5),
    )
}
