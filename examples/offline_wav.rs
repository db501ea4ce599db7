//! Renders a moving source to a WAV file, without a sound card:
//!
//! ```sh
//! cargo run --release --features audio --example offline_wav [FILE.wav]
//! ```

use echomarch::audio::{Mixer, PanningLaw, Sound, WavWriter};
use echomarch::gl::{Context, ContextOptions};
use echomarch::offline::{self, Timing};
use echomarch::{Error, Scene, Settings, Tracer};
use std::path::PathBuf;

fn main() -> Result<(), Error> {
    let file = match std::env::args_os().nth(1) {
        Some(path) => PathBuf::from(path),
        None => std::env::temp_dir().join("echomarch-offline.wav"),
    };
    let context = Context::headless(&ContextOptions::default())?;
    println!("renderer: {}", context.renderer());

    // The source of this scene passes the listener from left to right in 4 s.
    let scene = Scene::builtin("open-field")?;
    // Few iterations are sufficient outdoors: after a reflection by the ground, a wave hits no further surface.
    let settings = Settings::default().with_waves(16_384).with_iterations(4);
    let timing = Timing::new(scene.duration(), 30.0);
    let mut tracer = Tracer::new(&context)?;
    let mut sound = Sound::parse("sine:440", Sound::SAMPLE_RATE)?;
    let mut mixer = Mixer::new(PanningLaw::ConstantPower);

    // Every frame delivers its samples, with left and right interleaved. This example collects the samples; a program
    // with a sound device would queue them instead.
    let mut samples: Vec<f32> = Vec::new();
    offline::render(
        &mut tracer,
        &scene,
        &settings,
        &mut sound,
        &mut mixer,
        timing,
        |block| {
            samples.extend_from_slice(block.samples);
            if block.index % 30 == 0 {
                println!(
                    "{:4.1} s: {:4} waves heard, pan {:+.3}",
                    block.time,
                    block.heard.counts.listener_hits,
                    block.heard.panning.pan(),
                );
            }
            Ok::<(), Error>(())
        },
    )?;

    let mut writer = WavWriter::create(&file)?;
    writer.write(&samples)?;
    writer.finish()?;
    let seconds = samples.len() as f64 / 2.0 / f64::from(Sound::SAMPLE_RATE);
    println!(
        "{}: {seconds} s, {} Hz, stereo",
        file.display(),
        Sound::SAMPLE_RATE
    );
    Ok(())
}
