//! Measures the time of arrivals and of a frame without arrivals, alternately: `arrivals_cost SCENE WAVES ITERATIONS
//! RUNS`.

use echomarch::gl::{Context, ContextOptions};
use echomarch::scene::Material;
use echomarch::tracer::ArrivalSettings;
use echomarch::{Scene, Settings, Tracer};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |place: usize, otherwise: u32| {
        let given = arguments.get(place).and_then(|text| text.parse().ok());
        given.unwrap_or(otherwise)
    };
    let name = arguments.get(1).map_or("corner", String::as_str);
    let (waves, iterations, runs) = (number(2, 65_536), number(3, 64), number(4, 9));
    let context = Context::headless(&ContextOptions::default())?;
    let mut tracer = Tracer::new(&context)?;
    let bare = Scene::builtin(name)?;
    let mut banded = bare.clone();
    for (index, surface) in banded.surfaces.iter_mut().enumerate() {
        let of = ["brick", "plasterboard", "wood-floor"][index % 3];
        surface.material = Some(of.to_owned());
    }
    let mut scattering = banded.clone();
    let walls = Material::absorbing(0.1).scattering_by(0.2);
    scattering.materials.insert("brick".into(), walls);
    let settings = Settings::default()
        .with_waves(waves)
        .with_iterations(iterations);
    let how = ArrivalSettings::new(1000.0).with_iterations(iterations);
    let mut times = vec![Vec::new(); 4];
    let mut arrivals = 0;
    for run in 0..=runs {
        let began = Instant::now();
        tracer.frame(&bare, &settings)?;
        let mut took = vec![began.elapsed()];
        for scene in [&bare, &banded, &scattering] {
            let began = Instant::now();
            let mut sum = 0.0;
            let counts = tracer.arrivals(scene, &settings, &how, &mut |arrival| {
                sum += arrival.energy[7];
            })?;
            took.push(began.elapsed());
            arrivals = counts.arrivals;
            assert!(sum > 0.0);
        }
        if run > 0 {
            for (times, took) in times.iter_mut().zip(took) {
                times.push(took.as_secs_f64() * 1e3);
            }
        }
    }
    for times in &mut times {
        times.sort_by(f64::total_cmp);
    }
    let frame = times[0][times[0].len() / 4];
    println!("{name}: {waves} waves, {iterations} iterations, {arrivals} arrivals");
    for (what, times) in ["frame", "no materials", "eight bands", "scattering"]
        .iter()
        .zip(&times)
    {
        let (low, median) = (times[times.len() / 4], times[times.len() / 2]);
        println!(
            "{what:>14}: lower quartile {low:8.2} ms, median {median:8.2} ms, {:.2} of a frame",
            low / frame
        );
    }
    Ok(())
}
