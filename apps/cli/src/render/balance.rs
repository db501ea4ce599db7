//! Rendering as in the thesis: only the balance between left and right.

use super::super::impulse::pairs::first;
use super::super::print;
use super::{Job, Parts, ReportHead, sounds};
use echomarch::audio::{Mixer, Sound, WavWriter};
use echomarch::offline::{self, Block};
use echomarch::{Error, Frame};
use echomarch_lab::stats::median;
use serde::Serialize;

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    head: ReportHead<'a>,
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

/// Renders the first source with its pan.
pub fn run(job: Job) -> anyhow::Result<()> {
    let (arguments, common, scene, timing) = (job.arguments, job.common, &job.scene, job.timing);
    let settings = arguments.options.settings()?;
    let law = arguments.law.of(settings.profile());
    let mut sounds = sounds::load(&job.sounds[..1])?;
    job.check()?;
    let mut tracer = common.tracer()?;
    tracer.check(scene, &settings)?;
    arguments.options.note_passes(common, scene, &settings);
    job.warn();
    let mut writer = WavWriter::create(&arguments.output).map_err(Error::from)?;
    let mut mixer = Mixer::new(law);
    let bar = job.bar();
    let (mut lines, mut times) = (Vec::new(), Vec::new());
    let take = |block: Block<Frame>| {
        writer.write(block.samples)?;
        lines.push(FrameLine {
            time: block.time,
            listener_hits: block.heard.counts.listener_hits,
            pan: block.heard.panning.pan(),
        });
        let took_ms = block.heard.milliseconds.total;
        if times.is_empty() {
            let parts = Parts {
                name: "frame",
                count: timing.frames(),
                option: "--fps",
            };
            job.note_dear(parts, settings.waves, 1e-3 * took_ms, &bar);
        }
        times.push(took_ms);
        bar.inc(1);
        Ok::<(), Error>(())
    };
    offline::render(
        &mut tracer,
        first(scene)?,
        &settings,
        &mut sounds[0],
        &mut mixer,
        timing,
        take,
    )?;
    writer.finish().map_err(Error::from)?;
    bar.finish_and_clear();
    let report = Report {
        head: job.report_head("balance", &settings, &tracer),
        iterations: settings.iterations,
        seed: settings.seed,
        output: arguments.output.display().to_string(),
        sound: sounds::names(&job.sounds[..1]),
        law: law.to_string(),
        seconds: timing.seconds,
        sample_rate: Sound::SAMPLE_RATE,
        fps: timing.fps,
        frames: lines,
        median_frame_ms: median(times),
    };
    if common.json {
        return print::json(&report);
    }
    print_text(&report)
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
        report.head.scene,
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
            "  in {unheard} frames no wave arrived: their sound is in the middle"
        ))?;
    }
    Ok(())
}
