//! Measures the cost and the errors of a response: `response_cost WAVES ORDER SEEDS`. The room (8 × 3 × 5 m, absorption
//! 0.2) is the room of the comparison with pyroomacoustics in docs/acoustics.md. `scripts/peers/compute_rir.py`
//! measures pyroomacoustics.

use echomarch::geometry::ShoeboxEnergies;
use echomarch::gl::{Context, ContextOptions};
use echomarch::glam::Vec3;
use echomarch::response::{BandFigures, Figures};
use echomarch::response::{Response, ResponseSettings};
use echomarch::scene::{Material, shape::Room};
use echomarch::{Listener, Scene, Settings, Source, Surface, Tracer};

const SIZE: Vec3 = Vec3::new(8.0, 3.0, 5.0);
const SOURCE: Vec3 = Vec3::new(-2.0, 0.0, -1.5);
const LISTENER: Vec3 = Vec3::new(2.0, -0.3, 1.5);
const ABSORPTION: f64 = 0.2;
const SPEED: f64 = 343.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |place: usize, otherwise: u32| {
        let given = arguments.get(place).and_then(|text| text.parse().ok());
        given.unwrap_or(otherwise)
    };
    let (waves, order, seeds) = (number(1, 49_152), number(2, 3), number(3, 5));
    let truth = truth().ok_or("the room has no image sources")?;
    let begun = processor_seconds();
    let mut tracer = Tracer::new(&Context::headless(&ContextOptions::default())?)?;
    println!("renderer: {}", tracer.context().renderer());
    println!("context {:.3} s", processor_seconds() - begun);
    for seed in 1..=seeds {
        let trace = Settings::default().with_waves(waves).with_seed(seed);
        let settings = ResponseSettings::default()
            .with_trace(trace)
            .with_order(order);
        let began = processor_seconds();
        let response = Response::trace(&mut tracer, &scene(), &settings)?;
        let took = processor_seconds() - began;
        let [t30, c80, g] = off(&response.figures.bands[0], &truth);
        println!("seed {seed}: {took:.3} s, T30 {t30:+.2} %, C80 {c80:+.3} dB, G {g:+.3} dB off");
    }
    Ok(())
}

fn scene() -> Scene {
    let room = Surface::new(Room { size: SIZE }).with_material("wall");
    let (source, listener) = (Source::at(SOURCE), Listener::at(LISTENER, 0.3));
    let mut scene = Scene::new("peer's room", vec![room], source, listener);
    let wall = Material::absorbing(ABSORPTION);
    scene.materials.insert("wall".to_owned(), wall);
    scene
}

/// The exact figures from image sources, which are equal in all bands.
fn truth() -> Option<BandFigures> {
    const SECONDS: f64 = 1.0;
    let [size, source, listener] = [SIZE, SOURCE, LISTENER].map(|place| place.as_dvec3());
    let exact = ShoeboxEnergies::new(size, source, listener, &[[ABSORPTION; 8]; 6])?;
    let figures = Figures::of_image_sources(&exact, SPEED, SECONDS).ok()?;
    figures.bands.into_iter().next()
}

/// The errors of T30 in per cent, and of C80 and G in decibels; NaN if a figure is missing.
fn off(found: &BandFigures, truth: &BandFigures) -> [f64; 3] {
    let off = |found: Option<f64>, truth: Option<f64>| {
        let both = found.zip(truth);
        both.map_or(f64::NAN, |(found, truth)| found - truth)
    };
    let t30 = off(found.t30_s, truth.t30_s) / truth.t30_s.unwrap_or(f64::NAN);
    [
        100.0 * t30,
        off(found.c80_db, truth.c80_db),
        off(found.g_db, truth.g_db),
    ]
}

/// Processor time of the running threads of this process in seconds, as counted by Linux; NaN on other systems.
fn processor_seconds() -> f64 {
    let of_thread = |thread: std::io::Result<std::fs::DirEntry>| {
        let counts = std::fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
        counts.split(' ').next()?.parse::<f64>().ok()
    };
    let Ok(threads) = std::fs::read_dir("/proc/self/task") else {
        return f64::NAN;
    };
    threads.filter_map(of_thread).sum::<f64>() * 1e-9
}
