//! Benchmarks of the operations that a caller waits for: a frame, the programs of a scene, a response.
//!
//! ```sh
//! cargo bench                                            # all
//! cargo bench -- frame                                   # those with this word in their names
//! MESA_SHADER_CACHE_DISABLE=true cargo bench -- programs # without Mesa's cache of compiled shaders
//! ```
//!
//! Run them on an otherwise idle machine, and quote results with the renderer's name, which is printed first.
//! `echomarch figures`, `accuracy` and `cost` make larger measurements.

use divan::{Bencher, black_box};
use echomarch::gl::{Context, ContextOptions};
use echomarch::glam::Vec3;
use echomarch::response::{Response, ResponseSettings, diffracted};
use echomarch::scene::Material;
use echomarch::scene::shape::{Cuboid, Plane, Room};
use echomarch::{Error, Listener, Scene, Settings, Source, Surface, Tracer};

/// Waves per frame, as in README's table.
const WAVES: u32 = 65_536;
/// Waves per frame in the benchmark of programs. With this number tracing takes almost no time.
const FEW_WAVES: u32 = 64;
/// Waves per response: a quarter of the default, so that a sample takes less than a second in software.
const RESPONSE_WAVES: u32 = 16_384;

fn main() -> Result<(), Error> {
    println!("renderer: {}", tracer()?.context().renderer());
    divan::main();
    Ok(())
}

fn tracer() -> Result<Tracer, Error> {
    Tracer::new(&Context::headless(&ContextOptions::default())?)
}

/// A frame with programs already compiled, in a scene of closed forms and in one of marched fields.
#[divan::bench(args = ["corner", "cave"], sample_size = 1)]
fn frame(bencher: Bencher, name: &str) {
    let scene = Scene::builtin(name).expect("a built-in scene");
    let settings = Settings::default().with_waves(WAVES);
    let mut tracer = tracer().expect("a renderer");
    tracer.frame(&scene, &settings).expect("a first frame");
    bencher.bench_local(|| tracer.frame(black_box(&scene), &settings));
}

/// The programs of a scene: compiled, linked, and used once, because some drivers compile at the first use.
#[divan::bench(args = ["corner", "cave"], sample_size = 1, sample_count = 20)]
fn programs(bencher: Bencher, name: &str) {
    let scene = Scene::builtin(name).expect("a built-in scene");
    let settings = Settings::default().with_waves(FEW_WAVES);
    let context = Context::headless(&ContextOptions::default()).expect("a renderer");
    bencher
        .with_inputs(|| Tracer::new(&context).expect("a tracer"))
        .bench_local_values(|mut tracer| {
            tracer.frame(black_box(&scene), &settings).expect("a frame");
            tracer
        });
}

/// A shoebox's response with early paths and late part.
#[divan::bench(sample_size = 1, sample_count = 20)]
fn response_of_a_shoebox(bencher: Bencher) {
    let scene = shoebox();
    let trace = Settings::default().with_waves(RESPONSE_WAVES);
    let settings = ResponseSettings::default().with_trace(trace);
    let mut tracer = tracer().expect("a renderer");
    Response::trace(&mut tracer, &scene, &settings).expect("a first response");
    bencher.bench_local(|| Response::trace(&mut tracer, black_box(&scene), &settings));
}

/// A source 3 m before a body and a listener 3 m behind it, hidden or in sight, and a hidden pair of the cave.
#[divan::bench(args = [
    "Box(size: (1, 2, 3))",
    "Sphere(radius: 1)",
    "Cone(radius: 1, height: 2)",
    "Torus(ring: 1, tube: 0.4)",
    "Ellipsoid(radii: (1, 1, 1))",
    "SmoothUnion(of: [Box(size: (1, 2, 3)), Translate(of: Box(size: (1, 1, 1)), by: (0.5, 0.8, 0.3))], radius: 0.3)",
    "cave",
])]
fn diffraction_of_a_hidden_pair(bencher: Bencher, shape: &str) {
    let mut scene = match shape {
        "cave" => Scene::builtin(shape).expect("a built-in scene"),
        _ => behind(shape, Vec3::new(3.0, -0.1, 0.3)),
    };
    if shape == "cave" {
        scene.listeners[0].position = Vec3::new(7.73, 0.66, -2.7);
    }
    bencher.bench_local(|| diffracted(black_box(&scene)));
}

#[divan::bench(args = ["Box(size: (1, 2, 3))", "Sphere(radius: 1)", "Torus(ring: 1, tube: 0.4)"])]
fn diffraction_of_a_pair_in_sight(bencher: Bencher, shape: &str) {
    let scene = behind(shape, Vec3::new(-2.5, 2.6, 1.0));
    bencher.bench_local(|| diffracted(black_box(&scene)));
}

/// A hidden pair among many boxes on a plane.
#[divan::bench(args = [100, 10_000], sample_size = 1, sample_count = 20)]
fn diffraction_among_boxes(bencher: Bencher, count: u16) {
    let scene = among_boxes(count);
    bencher.bench_local(|| diffracted(black_box(&scene)));
}

/// Boxes of 0.8 m on a square grid of 2 m, as high as 1 to 3 m. The source and the listener are between their rows.
fn among_boxes(count: u16) -> Scene {
    let rows = f32::from(count).sqrt().round() as u16;
    let mut surfaces = vec![Surface::new(Plane)];
    for row in 0..rows {
        for column in 0..rows {
            let height = 1.0 + f32::from((row * 7 + column * 3) % 11) * 0.2;
            let [x, z] = [row, column].map(|at| 2.0 * f32::from(at) - f32::from(rows) + 1.0);
            let size = Vec3::new(0.8, height, 0.8);
            surfaces.push(Surface::new(Cuboid { size }).at(Vec3::new(x, 0.5 * height, z)));
        }
    }
    let source = Source::at(Vec3::new(-6.0, 0.5, -6.0));
    let listener = Listener::at(Vec3::new(5.9, 0.6, 4.1), 0.3);
    Scene::new("boxes", surfaces, source, listener)
}

/// A body at the origin, with a source beside it.
fn behind(shape: &str, listener: Vec3) -> Scene {
    let text = format!(
        "Scene(surfaces: [Surface(shape: {shape})], source: Source(position: (-3, 0.2, 0.1)), \
         listener: Listener(position: (0, 0, 0), radius: 0.1))"
    );
    let mut scene = Scene::from_ron(&text, "body").expect("a scene");
    scene.listeners[0].position = listener;
    scene
}

/// The room of docs/acoustics.md: 8 × 3 × 5 m, absorption 0.2.
fn shoebox() -> Scene {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let room = Surface::new(Room { size }).with_material("wall");
    let source = Source::at(Vec3::new(-2.0, 0.0, -1.5));
    let listener = Listener::at(Vec3::new(2.0, -0.3, 1.5), 0.3);
    let mut scene = Scene::new("shoebox", vec![room], source, listener);
    let wall = Material::absorbing(0.2);
    scene.materials.insert("wall".to_owned(), wall);
    scene
}
