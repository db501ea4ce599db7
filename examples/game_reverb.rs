//! The reverberation that a simulator states, beside a response of 262,144 waves in ten scenes.
//!
//! ```sh
//! cargo run --release --features simulator --example game_reverb [REFERENCE_WAVES]
//! ```

use echomarch::bands::BANDS_HZ;
use echomarch::gl::{Context, ContextOptions};
use echomarch::response::{Response, ResponseSettings};
use echomarch::simulator::{Simulator, SimulatorSettings, Update};
use echomarch::{Error, Listener, Scene, Settings, Source, Tracer};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The scenes: shoeboxes by their absorption, and scene files, with a material for surfaces that have none.
fn scenes() -> Result<Vec<(String, Scene)>, Error> {
    let mut all = Vec::new();
    for absorption in [0.05, 0.08, 0.15, 0.3, 0.5] {
        let scene = Scene::shoebox(
            [8.0, 3.0, 5.0],
            &[[absorption; 8]; 6],
            Source::at([-2.0, 0.0, -1.5]),
            Listener::at([2.0, -0.3, 1.5], 0.3),
        );
        all.push((format!("shoebox {absorption}"), scene));
    }
    for name in ["hall", "corridor", "flat", "two-rooms"] {
        all.push((
            name.to_owned(),
            Scene::load(&format!("examples/scenes/{name}.ron"))?,
        ));
    }
    for (name, material) in [("corner", "plasterboard"), ("cave", "brick")] {
        let mut scene = Scene::builtin(name)?;
        for surface in &mut scene.surfaces {
            surface.material = Some(material.to_owned());
        }
        all.push((name.to_owned(), scene));
    }
    for (_, scene) in &mut all {
        scene.sources.truncate(1);
        scene.listeners.truncate(1);
    }
    Ok(all)
}

/// Time without a further trace after which a source that does not move is known well enough.
const REST: Duration = Duration::from_secs(2);

/// The update of the first source after all of its traces.
fn heard(scene: &Scene, longest_s: f64) -> Result<Arc<Update>, Error> {
    let settings = SimulatorSettings::default()
        .with_milliseconds(1000.0)
        .with_seconds(0.8, longest_s);
    let mut simulator = Simulator::new(settings)?;
    let ids = simulator.add_scene(scene)?;
    simulator.commit();
    let (mut traces, mut since) = (0, Instant::now());
    loop {
        if let Some(heard) = simulator.updates(ids.sources[0]) {
            if heard.traces > traces {
                (traces, since) = (heard.traces, Instant::now());
            }
            if traces > 0 && since.elapsed() > REST {
                return Ok(heard);
            }
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn main() -> Result<(), Error> {
    let waves = std::env::args()
        .nth(1)
        .and_then(|text| text.parse().ok())
        .unwrap_or(262_144);
    let context = Context::headless(&ContextOptions::default())?;
    println!("renderer: {}", context.renderer());
    let mut tracer = Tracer::new(&context)?;
    for (name, scene) in scenes()? {
        let settings = ResponseSettings::default()
            .with_trace(Settings::default().with_waves(waves))
            .with_order(3);
        let reference = Response::trace(&mut tracer, &scene, &settings)?;
        let direct = reference.direct().map_or([0.0; 8], |path| path.energy);
        println!("{name}: record of {:.2} s", reference.seconds);
        for (what, longest_s) in [
            ("traces of 0.8 s", 0.8),
            ("the same, and longer ones of 3 s", 3.0),
        ] {
            let reverb = heard(&scene, longest_s)?;
            println!("  {what}: {} traces", reverb.traces);
            let reverb = reverb.reverb;
            let (mut worst, mut worst_db, mut held, mut held_db, mut count) =
                (0.0_f64, 0.0_f64, 0, 0, 0);
            for band in 0..8 {
                let figures = &reference.figures.bands[band];
                let Some(t30) = figures.t30_s else {
                    println!(
                        "    {:5} Hz: no T30 in the reference; {:.2} ± {:.2} s",
                        BANDS_HZ[band], reverb.decay_s[band], reverb.decay_error_s[band]
                    );
                    continue;
                };
                let own = reference.figures.errors[band].t30_s.unwrap_or(0.0);
                let off = reverb.decay_s[band] / t30 - 1.0;
                let error = reverb.decay_error_s[band];
                let wet = reference.energy()[band] - direct[band];
                let wet_db =
                    10.0 * (reverb.gain[band].powi(2) / (4.0 * std::f64::consts::PI) / wet).log10();
                let error_db = reverb.gain_error_db[band];
                (worst, worst_db) = (worst.max(off.abs()), worst_db.max(wet_db.abs()));
                held += usize::from((reverb.decay_s[band] - t30).abs() <= 2.0 * error.hypot(own));
                held_db += usize::from(wet_db.abs() <= 2.0 * error_db);
                count += 1;
                println!(
                    "    {:5} Hz: T30 {t30:.3} s; {:.3} ± {error:.3} s{}, {:+.1} %; wet {wet_db:+.2} ± {error_db:.2} dB",
                    BANDS_HZ[band],
                    reverb.decay_s[band],
                    if reverb.is_extrapolated[band] {
                        " extrapolated"
                    } else {
                        ""
                    },
                    100.0 * off,
                );
            }
            println!(
                "  = worst {:.1} %, {worst_db:.2} dB; within twice the error {held} and {held_db} of {count}",
                100.0 * worst
            );
        }
    }
    Ok(())
}
