//! A game loop with two sources and a wall between them. Each source is traced at intervals. Its sound is convolved
//! with its response, and divided into slices for the game's audio engine.
//!
//! ```sh
//! cargo run --release --example game_sources [FILE.wav]
//! ```

use echomarch::audio::{Sound, WavWriter};
use echomarch::auralisation::{Auralisation, Heard, Spec};
use echomarch::gl::{Context, ContextOptions};
use echomarch::response::ListenerAxes;
use echomarch::response::{Response, ResponseSettings};
use echomarch::{Error, Scene, Settings, Tracer};
use std::path::PathBuf;

const RATE_HZ: u32 = 48_000;

/// Number of game ticks per second, and number of samples per tick.
const TICKS_HZ: u32 = 60;
const SAMPLES: usize = (RATE_HZ / TICKS_HZ) as usize;

/// Number of ticks between two traces. During this time the sound fades to the new response.
const TRACE_EVERY: u32 = 4;

const HALL: &str = r#"Scene(
    surfaces: [
        Surface(shape: Room(size: (14, 5, 10)), material: "plaster"),
        Surface(shape: Box(size: (0.4, 5, 6)), position: (1, 0, -2), material: "plaster"),
    ],
    materials: { "plaster": Material(absorption: [0.1, 0.1, 0.12, 0.14, 0.16, 0.18, 0.2, 0.22]) },
    sources: [
        Source(name: "voice", position: (-4, 0, -2)),
        Source(name: "machine", position: (4, -1, -2), level_db: -6),
    ],
    listener: Listener(position: (-3, 0, 3), radius: 0.3),
)"#;

/// The sound of a source, and the auralisation that plays it.
struct Playing {
    sound: Sound,
    ears: Auralisation,
}

fn main() -> Result<(), Error> {
    let file = match std::env::args_os().nth(1) {
        Some(path) => PathBuf::from(path),
        None => std::env::temp_dir().join("echomarch-game.wav"),
    };
    let context = Context::headless(&ContextOptions::default())?;
    let mut tracer = Tracer::new(&context)?;
    let mut scene = Scene::from_ron(HALL, "hall")?;
    let settings = ResponseSettings::default()
        .with_trace(Settings::default().with_waves(4096))
        .with_order(3)
        .with_seconds(0.8);
    let spec = Spec::of(&scene, RATE_HZ).with_longest(0.8);
    let mut sources = Vec::new();
    for text in ["speech", "sine:110"] {
        let sound = Sound::parse(text, RATE_HZ)?;
        let ears = Auralisation::new(spec)?;
        sources.push(Playing { sound, ears });
    }
    let mut writer = WavWriter::create(&file)?;
    let (mut mono, mut stereo) = ([0.0; SAMPLES], [0.0; 2 * SAMPLES]);
    for tick in 0..4 * TICKS_HZ {
        // The player walks around the wall to the machine.
        scene.listeners[0].position.x = -3.0 + 7.0 * tick as f32 / (4 * TICKS_HZ) as f32;
        let is_traced = tick % TRACE_EVERY == 0;
        stereo.fill(0.0);
        for (number, source) in sources.iter_mut().enumerate() {
            if is_traced {
                // A game would do this between pictures, and pass `Heard` to its audio thread.
                let pair = scene.pair(number, 0)?;
                let response = Response::trace(&mut tracer, pair, &settings)?;
                let axes = ListenerAxes::of(pair.listener())?;
                let mut heard = Heard::new(&response, &axes, spec, 1)?;
                let glide = if tick == 0 {
                    0
                } else {
                    TRACE_EVERY * SAMPLES as u32
                };
                source.ears.glide_echoes(&heard, glide)?;
                source.ears.glide_late(&mut heard, 2 * glide)?;
                if tick % TICKS_HZ == 0 {
                    let sight = match response.direct() {
                        Some(_) => "in sight",
                        None => "behind the wall",
                    };
                    println!("{:3.1} s: source {number} {sight}", f64::from(tick) / 60.0);
                }
            }
            source.sound.fill(&mut mono);
            source.ears.add(&mono, &mut stereo)?;
        }
        writer.write(&stereo)?;
    }
    writer.finish()?;
    println!("{}", file.display());
    Ok(())
}
