//! `echomarch trace`: traces one frame.

mod levels;

use super::exit::BadInput;
use super::impulse::pairs::first;
use super::numbers::{count, real};
use super::options::{
    Common, DiffractionOption, LawOption, TraceOptions, check_ending, check_range,
};
use super::print;
use super::scene::SceneAtTime;
use clap::Args;
use echomarch::audio::PanningLaw;
use echomarch::internals::file_output::{OutputError, check_file, write_whole};
use echomarch::response::ResponseSettings;
use echomarch::scene::Scene;
use echomarch::tracer::{Budget, Counts, Frame, Milliseconds, Reloading, Settings, Tracer, Wave};
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

const EXAMPLES: &str = "\
Examples:
  echomarch trace corner --iterations 4 --waves 1048576
  echomarch trace corner --profile thesis --min-distance 0.001 --json
  echomarch trace corner --repeat 9 --json > times.json
  echomarch trace my.ron --dump-waves waves.csv
  echomarch trace hall.ron --levels
  echomarch trace my.ron --watch";

/// Interval between two checks of a watched scene's files.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Arguments of `trace`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneAtTime,
    #[command(flatten)]
    options: TraceOptions,
    #[command(flatten)]
    law: LawOption,
    /// Write every wave's start, end, direction and status as CSV
    #[arg(long, value_name = "FILE.csv")]
    dump_waves: Option<PathBuf>,
    /// Trace the frame N more times and print the median times; the first frame includes compilation
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 0,
        value_name = "N",
        conflicts_with = "watch", value_parser = count::<u32>)]
    repeat: u32,
    /// Print level, delay and direction for each source and listener. The computation is that of `impulse` with this
    /// number of waves, which takes about a hundred times as long as a frame
    #[arg(long, conflicts_with = "watch")]
    levels: bool,
    #[command(flatten)]
    diffraction: DiffractionOption,
    /// Trace again whenever the scene file or a file that it names changes, until Ctrl-C
    #[arg(long, conflicts_with = "time")]
    watch: bool,
    /// End --watch after this time
    #[arg(long, value_name = "SECONDS", requires = "watch", hide = true, value_parser = real::<f64>)]
    watch_seconds: Option<f64>,
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    #[serde(flatten)]
    settings: &'a Settings,
    renderer: &'a str,
    clock: &'a str,
    #[serde(flatten)]
    counts: Counts,
    left: f64,
    right: f64,
    pan: f64,
    law: String,
    gains: [f32; 2],
    timed_frames: u32,
    milliseconds: Milliseconds,
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<Vec<levels::Heard>>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let settings = arguments.options.settings()?;
    check_range("--repeat", f64::from(arguments.repeat), 0.0, 1000.0)?;
    if let Some(path) = &arguments.dump_waves {
        check_ending(path, "csv")?;
    }
    if arguments.levels {
        arguments.response_settings(&settings).validate()?;
    } else if arguments.diffraction.diffraction {
        let text = "--diffraction needs --levels: a frame of waves has no diffraction";
        return Err(BadInput(text.to_owned()).into());
    }
    if arguments.watch {
        return watch(arguments, common, &settings);
    }
    let scene = common.scene_at_time(&arguments.scene)?;
    check_output(arguments)?;
    let mut tracer = common.tracer()?;
    tracer.check(&scene, &settings)?;
    arguments.options.note_passes(common, &scene, &settings);
    common.warn_checked(&scene);
    trace(arguments, common, &mut tracer, &scene, &settings)
}

impl Arguments {
    /// The settings of the responses of `--levels`.
    fn response_settings(&self, settings: &Settings) -> ResponseSettings {
        ResponseSettings::default()
            .with_trace_of_frames(settings)
            .with_diffraction(self.diffraction.diffraction)
    }
}

/// Checks the output file. This function must be called after the scene was read, because only then are all its files
/// known. An output must not overwrite them.
fn check_output(arguments: &Arguments) -> Result<(), OutputError> {
    arguments.dump_waves.as_deref().map_or(Ok(()), check_file)
}

/// Traces again whenever a file of the scene changes, until the program ends.
fn watch(arguments: &Arguments, common: &Common, settings: &Settings) -> anyhow::Result<()> {
    let watched = arguments.scene.scene.clone();
    let file = watched.name_or_file.clone();
    if Scene::BUILTIN_NAMES.contains(&file.as_str()) {
        let text = format!("{file} is a built-in scene, which has no file for --watch");
        return Err(BadInput(text).into());
    }
    let began = Instant::now();
    let mut tracer = common.tracer()?;
    let load = move || watched.load();
    let mut reloading = Reloading::open_with(&file, load, &mut tracer, settings)?;
    check_output(arguments)?;
    common.warn(reloading.scene());
    trace(arguments, common, &mut tracer, reloading.scene(), settings)?;
    let is_over = || {
        let seconds = arguments.watch_seconds;
        seconds.is_some_and(|most| began.elapsed().as_secs_f64() >= most)
    };
    while !is_over() {
        std::thread::sleep(BETWEEN_LOOKS);
        match reloading.poll(&mut tracer, settings) {
            Ok(false) => (),
            Ok(true) => {
                common.warn(reloading.scene());
                trace(arguments, common, &mut tracer, reloading.scene(), settings)?;
            }
            // Printed even with --quiet, because the result does not include the latest change of the file.
            Err(error) => {
                print::tell(&format!("echomarch: {error} (the last scene stays)"));
            }
        }
    }
    Ok(())
}

/// Traces and prints one frame. With `--repeat` it also prints the median times of the repeated frames.
fn trace(
    arguments: &Arguments,
    common: &Common,
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
) -> anyhow::Result<()> {
    let mut frame = match &arguments.dump_waves {
        None => tracer.frame(first(scene)?, settings)?,
        Some(path) => {
            let (frame, waves) = tracer.frame_with_waves(first(scene)?, settings)?;
            write_whole(path, |out| dump(&waves, out))?;
            frame
        }
    };
    if arguments.repeat > 0 {
        frame.milliseconds = repeated(tracer, scene, settings, arguments.repeat)?;
    }
    if frame.counts.step_limit_reached > 0 {
        let hits = frame.counts.step_limit_reached;
        common.note(&format!(
            "warning: {hits} marches reached the step limit of {}; their waves are dead",
            step_limits(scene, settings)
        ));
    }
    if frame.counts.not_finite > 0 {
        let waves = frame.counts.not_finite;
        common.note(&format!(
            "warning: {waves} waves are not counted, because their position or direction is not finite"
        ));
    }
    let levels = match arguments.levels {
        true => Some(levels::heard(
            tracer,
            scene,
            &arguments.response_settings(settings),
        )?),
        false => None,
    };
    let renderer = tracer.context().renderer();
    let law = arguments.law.of(settings.profile());
    let mut report = report(
        scene,
        settings,
        &frame,
        law,
        [renderer, tracer.clock_name()],
    );
    report.timed_frames = arguments.repeat.max(1);
    report.levels = levels;
    if common.json {
        return print::json(&report);
    }
    print_text(&report)?;
    report.levels.iter().flatten().try_for_each(levels::print)
}

/// The median times of the `--repeat` frames.
fn repeated(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    count: u32,
) -> Result<Milliseconds, echomarch::Error> {
    let frames = (0..count).map(|_| Ok(tracer.frame(first(scene)?, settings)?.milliseconds));
    let frames = frames.collect::<Result<Vec<_>, echomarch::Error>>()?;
    Ok(Milliseconds::medians(&frames))
}

/// The maximum number of steps of a march. Scenes with fields have separate limits.
fn step_limits(scene: &Scene, settings: &Settings) -> String {
    let budget = Budget::of(scene, settings);
    let limits = [
        (budget.steps, ""),
        (budget.field_steps, " among fields"),
        (budget.copy_steps, " past copies"),
    ];
    let counted = limits.into_iter().filter(|(steps, _)| *steps > 0);
    let counted: Vec<(u32, &str)> = counted.collect();
    match counted[..] {
        [(steps, _)] => format!("{steps} steps"),
        [(steps, among), ref more @ ..] => more
            .iter()
            .fold(format!("{steps} steps{among}"), |all, (steps, among)| {
                format!("{all}, or {steps}{among}")
            }),
        [] => "0 steps".to_owned(),
    }
}

fn report<'a>(
    scene: &'a Scene,
    settings: &'a Settings,
    frame: &Frame,
    law: PanningLaw,
    [renderer, clock]: [&'a str; 2],
) -> Report<'a> {
    let gains = law.gains(frame.panning.pan() as f32);
    Report {
        scene: &scene.name,
        settings,
        renderer,
        clock,
        counts: frame.counts,
        left: frame.panning.left,
        right: frame.panning.right,
        pan: frame.panning.pan(),
        law: law.to_string(),
        gains: [gains.left, gains.right],
        timed_frames: 1,
        milliseconds: frame.milliseconds,
        levels: None,
    }
}

fn print_text(report: &Report) -> anyhow::Result<()> {
    let settings = report.settings;
    let iterations = u64::from(settings.waves) * u64::from(settings.iterations);
    let share = 100.0 * report.counts.zero_length_passes as f64 / iterations as f64;
    let time = &report.milliseconds;
    print::line(&format!(
        "{}: {} waves, {} iterations, profile {}, seed {}",
        report.scene,
        settings.waves,
        settings.iterations,
        settings.profile(),
        settings.seed
    ))?;
    print::line(&format!(
        "  listener hits {:>10}\n  dead          {:>10}\n  travelling    {:>10}",
        report.counts.listener_hits, report.counts.dead, report.counts.travelling
    ))?;
    print::line(&format!(
        "  iterations in which the wave did not move {} of {iterations} ({share:.1} %), step limit reached {}",
        report.counts.zero_length_passes, report.counts.step_limit_reached
    ))?;
    print::line(&format!(
        "  left {:.1}, right {:.1}: pan {:+.4}; gains {:.3} and {:.3} ({})",
        report.left, report.right, report.pan, report.gains[0], report.gains[1], report.law
    ))?;
    print::line(&format!(
        "  {:.2} ms: initialise {:.2}, march {:.2}, pan {:.2}, read back {:.2} ({})",
        time.total, time.initialise, time.march, time.pan, time.read_back, report.clock
    ))
}

/// Writes one line per wave. Numbers have the shortest form that restores the same bits.
fn dump(waves: &[Wave], out: &mut dyn Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "wave", "start_dx", "start_dy", "start_dz", "x", "y", "z", "dx", "dy", "dz", "status",
    ])?;
    for (index, wave) in waves.iter().enumerate() {
        let vectors = [wave.start_direction, wave.position, wave.direction];
        csv.write_field(index.to_string())?;
        for number in vectors.iter().flat_map(|vector| vector.to_array()) {
            csv.write_field(number.to_string())?;
        }
        csv.write_record([wave.status.to_string()])?;
    }
    csv.flush()
}
