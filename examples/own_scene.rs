//! A scene written in Rust whose parts move between frames. Its three shader programs (start, march, pan) are compiled
//! only once:
//!
//! ```sh
//! cargo run --release --example own_scene
//! ```

use echomarch::gl::{Context, ContextOptions};
use echomarch::glam::{Quat, Vec3};
use echomarch::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use echomarch::{Error, Listener, Node, Scene, Settings, Source, Surface, Tracer};

fn main() -> Result<(), Error> {
    let context = Context::headless(&ContextOptions::default())?;
    println!("renderer: {}", context.renderer());
    let mut tracer = Tracer::new(&context)?;
    let settings = Settings::default().with_waves(16_384).with_iterations(4);

    // Metres; x to the right, y up, z towards the viewer. The listener looks along -z.
    let door = Surface::new(Node::Cuboid(Cuboid {
        size: Vec3::new(4.0, 6.0, 0.3),
    }));
    let mut scene = Scene::new(
        "hall with a door",
        vec![
            Surface::new(Node::Room(Room {
                size: Vec3::new(16.0, 6.0, 16.0),
            })),
            // The door will rotate later, although it has no rotation now.
            door.named("door").turning(),
            Surface::new(Node::Cylinder(Cylinder { radius: 0.6 })).at(Vec3::new(4.0, 0.0, -2.0)),
        ],
        Source::at(Vec3::new(-5.0, 0.0, -5.0)),
        Listener::at(Vec3::new(0.0, 0.0, 5.0), 1.5),
    );

    for step in 0..5_u8 {
        let share = f32::from(step) / 4.0;
        // The source moves from left to right, the door opens, and the pillar shrinks.
        scene.sources[0].position.x = -5.0 + 10.0 * share;
        scene.surfaces[1].rotation = Quat::from_rotation_y(90_f32.to_radians() * share);
        scene.surfaces[2].shape = Node::Cylinder(Cylinder {
            radius: 0.6 - 0.4 * share,
        })
        .into();
        let frame = tracer.frame(&scene, &settings)?;
        println!(
            "source at x = {:+.1} m: {:4} waves heard, pan {:+.3}; {} programs compiled",
            scene.sources[0].position.x,
            frame.counts.listener_hits,
            frame.panning.pan(),
            tracer.programs_compiled(),
        );
    }

    // A new surface changes the structure, so the march is compiled again.
    let stone = Node::Sphere(Sphere { radius: 1.0 });
    scene
        .surfaces
        .push(Surface::new(stone).at(Vec3::new(-4.0, -2.0, 2.0)));
    tracer.frame(&scene, &settings)?;
    println!(
        "with a fourth surface: {} programs compiled",
        tracer.programs_compiled()
    );
    Ok(())
}
