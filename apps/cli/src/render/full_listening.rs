//! Full rendering, with loudness, delays, echoes and reverberation.

use super::super::impulse::pairs;
use super::super::impulse::percent;
use super::super::numbers::{count, decibels, real, tenths};
use super::super::options::{DiffractionOption, LeastLevelOption, check_range};
use super::super::print;
use super::{Job, Parts, ReportHead, sounds};
use clap::Args;
use echomarch::Error;
use echomarch::audio::{Sound, WavWriter};
use echomarch::auralisation::{HeardKind, HeardSource};
use echomarch::offline::{self, Block, FullSettings};
use echomarch::response::ImpulseSettings;
use echomarch::response::{Accuracy, ResponseSettings};
use serde::Serialize;
use std::time::Instant;

/// Limit of the gain in decibels, positive or negative. The range contains every gain that is useful in practice.
const MOST_GAIN_DB: f64 = 120.0;

/// Number of waves of each response in a scene that moves. The level in a quarter of a second differs by 0.1 to 0.3 dB
/// (rms) from that with 65,536 waves (docs/audio.md).
const MOVING_WAVES: u32 = 8192;

/// The minimum length of a response, in seconds.
const SHORTEST_TAIL_S: f64 = 1e-3;

/// Options that have an effect only in full listening.
#[derive(Args, Debug)]
#[command(next_help_heading = "With --listen full")]
pub struct FullOptions {
    /// Gain of all sources in decibels. At 0 dB, a source at 1 m in the open is as loud as its sound
    #[arg(long, allow_hyphen_values = true, value_name = "DB", value_parser = decibels)]
    gain: Option<f64>,
    /// The listener, by name or number [default: the first]
    #[arg(long, value_name = "NAME")]
    listener: Option<String>,
    /// Maximum number of reflections of exact paths [default: 8 if all surfaces are flat, otherwise 3]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = count::<u32>)]
    order: Option<u32>,
    /// Length of the reverberation after a sound has ended, 0.001 to 60 [default: until all bands have decayed by 60
    /// dB, at most 3]
    #[arg(long, allow_negative_numbers = true, value_name = "SECONDS", value_parser = real::<f64>)]
    tail: Option<f64>,
    /// Standard error of the figures of each response, 0.1% to 5%, with the sign %, as in impulse. The number of waves
    /// grows until all figures have this error; --waves limits it [default: a fixed number of waves]
    #[arg(long, allow_negative_numbers = true, value_name = "PERCENT", value_parser = percent)]
    accuracy: Option<f64>,
    /// Maximum number of renewals of a response in a second, 0.1 to 1000. A response is renewed when its source or the
    /// listener has moved by 2 cm or turned by 1°, or a surface has changed
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = real::<f64>)]
    responses: Option<f64>,
    #[command(flatten)]
    diffraction: DiffractionOption,
    #[command(flatten)]
    least_level: LeastLevelOption,
}

impl FullOptions {
    /// Returns the first of these options that the user typed.
    pub fn given(&self) -> Option<&'static str> {
        let typed = [
            (self.gain.is_some(), "--gain"),
            (self.listener.is_some(), "--listener"),
            (self.order.is_some(), "--order"),
            (self.tail.is_some(), "--tail"),
            (self.accuracy.is_some(), "--accuracy"),
            (self.responses.is_some(), "--responses"),
            (self.diffraction.diffraction, "--diffraction"),
            (self.least_level.least_level_db.is_some(), "--least-level"),
        ];
        let found = typed.into_iter().find(|(is_typed, _)| *is_typed);
        found.map(|(_, name)| name)
    }
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    head: ReportHead<'a>,
    seed: u32,
    output: String,
    sound: String,
    gain_db: f64,
    seconds: f64,
    tail_s: f64,
    sample_rate: u32,
    fps: f64,
    /// The largest sample, in decibels relative to full scale; `None` for silence.
    peak_db: Option<f64>,
    frames: Vec<FrameLine>,
}

#[derive(Serialize)]
struct FrameLine {
    time: f64,
    sources: Vec<SourceLine>,
}

/// The level of a source at the listener.
#[derive(Serialize)]
struct SourceLine {
    source: String,
    /// The strength *G* of all arrivals; `None` if nothing arrives.
    g_db: Option<f64>,
    paths: usize,
    direct: bool,
    /// The exact paths by kind, without kinds that are not heard.
    kinds: Vec<HeardKind>,
    /// The strength *G* of everything outside the exact paths; `None` if there is nothing else.
    late_db: Option<f64>,
    #[serde(skip)]
    text: String,
}

/// Renders all sources.
pub fn run(job: Job) -> anyhow::Result<()> {
    let (arguments, common, scene, timing) = (job.arguments, job.common, &job.scene, job.timing);
    let (pairs, settings) = settings(&job)?;
    let mut sounds = sounds::load(&job.sounds)?;
    job.check()?;
    let mut tracer = common.tracer()?;
    job.warn();
    let mut writer = WavWriter::create(&arguments.output).map_err(Error::from)?;
    let bar = job.bar();
    let gain_db = arguments.full.gain.unwrap_or(0.0);
    let gain = 10_f64.powf(gain_db / 20.0) as f32;
    let (mut lines, mut peak) = (Vec::new(), 0.0_f32);
    let mut samples = Vec::new();
    let tail_s = settings.tail_s(&mut tracer, scene)?;
    let began = Instant::now();
    let waves = settings.response.trace.waves;
    let parts = responses(&job, &settings);
    let take = |block: Block<[HeardSource]>| {
        if lines.is_empty() {
            // The first block of a moving scene needs the responses of both ends of a slot.
            let traced = parts.count.min(2) as f64;
            let seconds = began.elapsed().as_secs_f64() / traced;
            job.note_dear(parts, waves, seconds, &bar);
        }
        samples.clear();
        samples.extend(block.samples.iter().map(|sample| sample * gain));
        peak = samples
            .iter()
            .fold(peak, |peak, sample| peak.max(sample.abs()));
        writer.write(&samples)?;
        lines.push(FrameLine {
            time: block.time,
            sources: source_lines(&pairs, block.heard),
        });
        bar.inc(1);
        Ok::<(), Error>(())
    };
    let settings = settings.with_tail(tail_s);
    offline::render_full(&mut tracer, scene, &settings, &mut sounds, timing, take)?;
    writer.finish().map_err(Error::from)?;
    bar.finish_and_clear();
    let report = Report {
        head: job.report_head("full", &settings.response.trace, &tracer),
        seed: settings.response.trace.seed,
        output: arguments.output.display().to_string(),
        sound: sounds::names(&job.sounds),
        gain_db,
        seconds: timing.seconds,
        tail_s,
        sample_rate: Sound::SAMPLE_RATE,
        fps: timing.fps,
        peak_db: (peak > 0.0).then(|| 20.0 * f64::from(peak).log10()),
        frames: lines,
    };
    note_peak(&job, &report);
    if common.json {
        return print::json(&report);
    }
    print_text(&report)
}

/// Returns the responses that are traced at most: one if the scene is at rest.
fn responses(job: &Job, settings: &FullSettings) -> Parts {
    let frames = job.timing.frames();
    let most = (job.timing.seconds * settings.responses_per_second).ceil() as u64;
    let count = match job.scene.duration() > 0.0 {
        true => most.clamp(1, frames.max(1)),
        false => 1,
    };
    Parts {
        name: "response",
        count,
        option: "--responses",
    }
}

/// Returns the names of the sources, and the settings of full listening.
fn settings(job: &Job) -> anyhow::Result<(Vec<String>, FullSettings)> {
    let options = &job.arguments.full;
    if let Some(gain) = options.gain {
        check_range("--gain", gain, -MOST_GAIN_DB, MOST_GAIN_DB)?;
    }
    if let Some(order) = options.order {
        check_range(
            "--order",
            order.into(),
            0.0,
            ResponseSettings::MAX_ORDER.into(),
        )?;
    }
    if let Some(tail) = options.tail {
        check_range(
            "--tail",
            tail,
            SHORTEST_TAIL_S,
            ImpulseSettings::MAX_SECONDS,
        )?;
    }
    if let Some(responses) = options.responses {
        check_range("--responses", responses, 0.1, 1000.0)?;
    }
    let given = job.arguments.options.waves;
    let mut trace = job.arguments.options.settings()?;
    if given.is_none() && job.scene.duration() > 0.0 {
        trace.waves = MOVING_WAVES;
    }
    let seed = trace.seed;
    let mut response = ResponseSettings::default().with_trace_of_frames(&trace);
    response.order = options.order;
    response.seconds = options.tail;
    response.accuracy = options.accuracy.map(|share| {
        let mut accuracy = Accuracy::default();
        (accuracy.share, accuracy.most_waves) = (share, given);
        accuracy
    });
    response.diffraction = options.diffraction.diffraction;
    response.least_level_db = options.least_level.checked()?;
    response.validate()?;
    let listener = pairs::listener(&job.scene, options.listener.as_deref())?;
    let mut settings = FullSettings::new(response, listener);
    settings.seed = seed.into();
    settings.responses_per_second = options.responses.unwrap_or(settings.responses_per_second);
    Ok((job.scene.source_labels(), settings))
}

fn source_lines(names: &[String], sources: &[HeardSource]) -> Vec<SourceLine> {
    let line = |(name, heard): (&String, &HeardSource)| SourceLine {
        source: name.clone(),
        g_db: heard.level_db,
        paths: heard.paths,
        direct: heard.is_direct,
        kinds: heard
            .kinds
            .into_iter()
            .filter(|kind| kind.paths > 0)
            .collect(),
        late_db: heard.late_db,
        text: heard.to_string(),
    };
    names.iter().zip(sources).map(line).collect()
}

/// Prints a note if samples exceed full scale, because other programs may clip them.
fn note_peak(job: &Job, report: &Report) {
    if let Some(peak_db) = report.peak_db.filter(|peak| *peak > 0.0) {
        job.common.note(&format!(
            "note: the largest sample is {peak_db:.1} dB above full scale: use --gain {:.0} or less",
            (report.gain_db - peak_db).floor()
        ));
    }
}

fn print_text(report: &Report) -> anyhow::Result<()> {
    print::line(&format!(
        "{}: {:.2} s of {} in {}, {} frames",
        report.output,
        report.seconds,
        report.sound,
        report.head.scene,
        report.frames.len()
    ))?;
    let (Some(first), Some(last)) = (report.frames.first(), report.frames.last()) else {
        return Ok(());
    };
    for (start, end) in first.sources.iter().zip(&last.sources) {
        print::line(&format!(
            "  source {}: {} at the start, {} at the end",
            start.source,
            level(start),
            level(end)
        ))?;
    }
    let peak = report.peak_db.map_or("silence".to_owned(), |peak| {
        format!("peak {:+.1} dB re full scale", tenths(peak))
    });
    print::line(&format!(
        "  {peak}, with a gain of {:+.1} dB; responses of {:.2} s",
        tenths(report.gain_db),
        report.tail_s
    ))
}

fn level(line: &SourceLine) -> String {
    let direct = if line.direct {
        "in sight"
    } else {
        "out of sight"
    };
    match line.g_db {
        Some(g_db) => format!("G {:+.1} dB, {direct} ({})", tenths(g_db), line.text),
        None => "not heard".to_owned(),
    }
}
