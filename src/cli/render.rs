//! `echomarch render`: a WAV of what the listener hears.

use super::exit::BadInput;
use super::numbers::real;
use super::options::{Common, LawOption, TraceOptions, check_ending, check_range};
use super::print;
use super::scene::SceneArguments;
use crate::audio::{Mixer, SAMPLE_RATE, Sound, SoundSpec, WavWriter};
use crate::error::Error;
use crate::offline::{self, Block, Timing};
use crate::output::check_file;
use crate::scene::Scene;
use crate::stats::median;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch render open-field -o pass.wav
  echomarch render corner -o corner.wav --sound noise --seconds 3
  echomarch render my.ron -o walk.wav --sound voice.wav --law linear";

/// Seconds of sound of a scene in which nothing moves.
const STANDING_SECONDS: f64 = 5.0;

/// About what a WAV of this kind holds.
const LONGEST_SECONDS: f64 = 3.0 * 3600.0;

/// Arguments of `render`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The WAV to write: 48 kHz, 32-bit float, stereo
    #[arg(short, long, value_name = "FILE.wav")]
    output: PathBuf,
    /// What the source plays: sine:HERTZ, noise, noise:SEED, speech, speech:SEED, or a WAV file (looped)
    #[arg(long, default_value = "speech", value_name = "SOUND")]
    sound: SoundSpec,
    /// Length [default: the scene's longest path, or 5]
    #[arg(long, allow_negative_numbers = true, value_name = "SECONDS", value_parser = real::<f64>)]
    seconds: Option<f64>,
    /// Frames traced a second
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 30.0,
        value_name = "N", value_parser = real::<f64>)]
    fps: f64,
    #[command(flatten)]
    law: LawOption,
    #[command(flatten)]
    options: TraceOptions,
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    profile: String,
    renderer: &'a str,
    waves: u32,
    iterations: u32,
    seed: u32,
    output: String,
    sound: String,
    law: String,
    seconds: f64,
    sample_rate: u32,
    fps: f64,
    frames: Vec<FrameLine>,
    median_frame_ms: f64,
}

#[derive(Serialize)]
struct FrameLine {
    time: f64,
    listener_hits: u64,
    pan: f64,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let settings = arguments.options.settings()?;
    let law = arguments.law.of(settings.profile());
    check_ending(&arguments.output, "wav")?;
    let scene = common.scene_with_values(&arguments.scene)?;
    let timing = timing(arguments, scene.duration())?;
    let mut sound = Sound::load(&arguments.sound, SAMPLE_RATE).map_err(Error::from)?;
    check_file(&arguments.output)?;
    let mut tracer = common.tracer()?;
    tracer.check(&scene, &settings)?;
    arguments.options.note_passes(common, &scene, &settings);
    check_on_the_way(&scene, timing)?;
    common.warn_checked(&scene);
    warn_on_the_way(&scene, timing, common);
    let mut writer = WavWriter::create(&arguments.output).map_err(Error::from)?;
    let mut mixer = Mixer::new(law);
    let bar = print::progress(common.quiet, timing.frames(), "frames");
    let (mut lines, mut times) = (Vec::new(), Vec::new());
    let take = |block: Block| {
        writer.write(block.samples)?;
        lines.push(FrameLine {
            time: block.time,
            listener_hits: block.frame.counts.listener_hits,
            pan: block.frame.panning.pan(),
        });
        times.push(block.frame.milliseconds.total);
        bar.inc(1);
        Ok::<(), Error>(())
    };
    offline::render(
        &mut tracer,
        &scene,
        &settings,
        &mut sound,
        &mut mixer,
        timing,
        take,
    )?;
    writer.finish().map_err(Error::from)?;
    bar.finish_and_clear();
    let report = Report {
        scene: &scene.name,
        profile: settings.profile().to_string(),
        renderer: tracer.context().renderer(),
        waves: settings.waves,
        iterations: settings.iterations,
        seed: settings.seed,
        output: arguments.output.display().to_string(),
        sound: arguments.sound.to_string(),
        law: law.to_string(),
        seconds: timing.seconds,
        sample_rate: SAMPLE_RATE,
        fps: timing.fps,
        frames: lines,
        median_frame_ms: median(times),
    };
    if common.json {
        return print::json(&report);
    }
    print_text(&report)
}

/// Refuses what becomes impossible while things move, before anything is traced.
fn check_on_the_way(scene: &Scene, timing: Timing) -> Result<(), Error> {
    if scene.duration() == 0.0 {
        return Ok(());
    }
    for index in 0..timing.frames() {
        let time = index as f64 / timing.fps;
        scene
            .at(time)
            .validate()
            .map_err(|refused| refused.at(time))?;
    }
    Ok(())
}

/// What becomes odd while things move: each kind once, with when.
fn warn_on_the_way(scene: &Scene, timing: Timing, common: &Common) {
    let mut told: Vec<_> = scene
        .warnings()
        .iter()
        .map(std::mem::discriminant)
        .collect();
    if scene.duration() == 0.0 {
        return;
    }
    for index in 0..timing.frames() {
        let time = index as f64 / timing.fps;
        for warning in scene.at(time).warnings() {
            let kind = std::mem::discriminant(&warning);
            if !told.contains(&kind) {
                told.push(kind);
                common.note(&format!(
                    "warning: {}, at {time:.2} s: {warning}",
                    scene.name
                ));
            }
        }
    }
}

fn timing(arguments: &Arguments, duration: f64) -> anyhow::Result<Timing> {
    let standing = if duration > 0.0 {
        duration
    } else {
        STANDING_SECONDS
    };
    if arguments.seconds.is_none() && standing > LONGEST_SECONDS {
        let text = format!("the scene's path lasts {standing} s: give --seconds");
        return Err(BadInput(text).into());
    }
    let seconds = arguments.seconds.unwrap_or(standing);
    check_range("--seconds", seconds, 0.001, LONGEST_SECONDS)?;
    check_range("--fps", arguments.fps, 1.0, 1000.0)?;
    Ok(Timing {
        seconds,
        fps: arguments.fps,
    })
}

fn print_text(report: &Report) -> anyhow::Result<()> {
    let heard = report.frames.iter().filter(|f| f.listener_hits > 0);
    let unheard = report.frames.len() - heard.count();
    let pan = |frame: Option<&FrameLine>| frame.map_or(0.0, |f| f.pan);
    print::line(&format!(
        "{}: {:.2} s of {} in {}, {} frames, {:.1} ms each (median)",
        report.output,
        report.seconds,
        report.sound,
        report.scene,
        report.frames.len(),
        report.median_frame_ms
    ))?;
    print::line(&format!(
        "  pan {:+.3} at the start, {:+.3} at the end",
        pan(report.frames.first()),
        pan(report.frames.last())
    ))?;
    if unheard > 0 {
        print::line(&format!(
            "  in {unheard} frames no wave arrived: they are in the middle"
        ))?;
    }
    Ok(())
}
