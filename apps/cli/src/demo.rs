//! `echomarch demo`: the window.

use super::exit::BadInput;
use super::numbers::{count, real};
use super::options::{
    Common, DiffractionOption, FrameRateOption, LawOption, LeastLevelOption, TraceOptions,
    check_ending, check_range,
};
use super::print;
use super::scene::SceneArguments;
use anyhow::bail;
use clap::Args;
use echomarch::Error;
use echomarch::audio::Sound;
use echomarch::auralisation::Listen;
use echomarch::gl::Api;
use echomarch::internals::file_output::check_file;
use echomarch_lab::text;
use echomarch_window::{DemoError, DemoOptions, OPENING_SCENE, Parts, Report, run as run_demo};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch demo
  echomarch demo open-field --sound drum.wav --profile march
  echomarch demo my.ron --set door=60 --waves 262144
  echomarch demo corner --diffraction --least-level -30
  echomarch demo corner --seconds 10 --screenshot demo.png --json

F1 in the window lists the keys. Scene files and WAV files can be dropped on it.
Scenes: corner, obstacles, open-field, open-pillars, shoebox, whispering-gallery,
parabolic-mirrors, colonnade, cave, morphing-room, menger, glasshouse.";

/// The minimum of `--seconds`.
const SHORTEST_S: f64 = 1e-3;

/// Arguments of `demo`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
#[command(mut_arg("scene", |scene| scene.required(false).default_value(OPENING_SCENE)))]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    trace: TraceOptions,
    #[command(flatten)]
    sound: SoundOptions,
    #[command(flatten)]
    window: WindowOptions,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Sound")]
struct SoundOptions {
    /// Sound of the source: FILE.wav, sine:440, noise, speech
    #[arg(long, default_value = "speech", value_name = "SOUND")]
    sound: String,
    /// Loudness, 0 to 1
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.5, value_parser = real::<f32>)]
    volume: f32,
    /// Listening mode: full (loudness, delays, echoes, reverberation), or balance (only left against right, as in the
    /// thesis) [default: full; balance with --profile thesis and with --law]
    #[arg(long, value_name = "WHAT")]
    listen: Option<Listen>,
    #[command(flatten)]
    diffraction: DiffractionOption,
    #[command(flatten)]
    least_level: LeastLevelOption,
    #[command(flatten)]
    law: LawOption,
    /// Name or id of the sound device, as listed by --list-devices
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    /// List the sound devices, without opening a window
    #[arg(long)]
    list_devices: bool,
    /// Buffer size of the sound device in samples; a smaller buffer gives less latency
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1024,
        value_name = "N", value_parser = count::<u32>)]
    buffer: u32,
    /// Record the sound that is played
    #[arg(long, value_name = "FILE.wav")]
    record: Option<PathBuf>,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Window")]
struct WindowOptions {
    /// Trace the waves only for every Nth picture
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1,
        value_name = "N", value_parser = count::<u32>)]
    trace_every: u32,
    /// Adapt the number of waves (4096 or more) to the frame time even with --waves, which then sets the initial
    /// number; without --waves it always adapts
    #[arg(long)]
    adapt_waves: bool,
    #[command(flatten)]
    frame_rate: FrameRateOption,
    /// Ratio of the picture's size to the window's [default: adapted to the frame time]
    #[arg(long, allow_negative_numbers = true, value_name = "SHARE", value_parser = real::<f32>)]
    scale: Option<f32>,
    /// Size of texts and panels, 0.75 to 2.5; 1 is the size for the screen
    #[arg(long, default_value_t = 1.0, value_name = "FACTOR", value_parser = real::<f32>)]
    text_size: f32,
    /// Width in pixels, before display scaling
    #[arg(long, default_value_t = 960, value_name = "PIXELS", value_parser = count::<u32>)]
    width: u32,
    /// Height in pixels, before display scaling
    #[arg(long, default_value_t = 540, value_name = "PIXELS", value_parser = count::<u32>)]
    height: u32,
    /// File to which F5 saves the scene [default: NAME-1.ron, NAME-2.ron, …]
    #[arg(long, value_name = "FILE.ron")]
    save: Option<PathBuf>,
    /// Write a screenshot of the window before it closes
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<PathBuf>,
    /// Close the window after this number of frames
    #[arg(long, value_name = "N", value_parser = count::<u64>)]
    frames: Option<u64>,
    /// Close the window after this number of seconds
    #[arg(long, allow_negative_numbers = true, value_name = "SECONDS", value_parser = real::<f64>)]
    seconds: Option<f64>,
    /// Do not show the help at the start
    #[arg(long)]
    no_help: bool,
    /// Write a line of JSON for every frame to standard error
    #[arg(long, hide = true)]
    log_frames: bool,
}

impl SoundOptions {
    /// The parts of the sound in full listening.
    fn parts(&self) -> Result<Parts, BadInput> {
        let mut parts = Parts::default().with_least_level(self.least_level.checked()?);
        parts.diffraction = self.diffraction.diffraction;
        Ok(parts)
    }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    if arguments.sound.list_devices {
        return list_devices(common);
    }
    let options = options(arguments, common)?;
    common.scene_with_values(&arguments.scene)?;
    check_outputs(arguments)?;
    check_device(&arguments.sound)?;
    super::interrupt::ask_from_now_on();
    match run_demo(options) {
        Ok(report) => print_report(&report, common),
        Err(DemoError::DisplayGone { report }) => {
            print_report(&report, common)?;
            Err(DemoError::DisplayGone { report }.into())
        }
        Err(error) => Err(error.into()),
    }
}

fn print_report(report: &Report, common: &Common) -> anyhow::Result<()> {
    if common.json {
        return print::json(report);
    }
    print_text(report)
}

#[cfg(not(feature = "audio"))]
fn list_devices(_: &Common) -> anyhow::Result<()> {
    print::line("no sound devices: built without sound")
}

#[cfg(feature = "audio")]
fn list_devices(common: &Common) -> anyhow::Result<()> {
    let devices = echomarch::audio::live::list_devices();
    if common.json {
        let described = devices.iter().map(|device| {
            serde_json::json!({ "name": device.name, "id": device.id, "default": device.default })
        });
        return print::json(&described.collect::<Vec<_>>());
    }
    if devices.is_empty() {
        return print::line("no sound devices");
    }
    for device in &devices {
        let mark = if device.default { "*" } else { " " };
        print::line(&format!("{mark} {} ({})", device.name, device.id))?;
    }
    Ok(())
}

fn options(arguments: &Arguments, common: &Common) -> anyhow::Result<DemoOptions> {
    let (sound, window) = (&arguments.sound, &arguments.window);
    check(sound, window, common)?;
    Ok(DemoOptions {
        scene: arguments.scene.name_or_file.clone(),
        values: arguments.scene.set.clone(),
        settings: arguments.trace.settings()?,
        trace_every: window.trace_every,
        adapt_waves: window.adapt_waves || arguments.trace.waves.is_none(),
        frame_milliseconds: 1000.0 / window.frame_rate.fps,
        picture_scale: window.scale,
        text_size: window.text_size,
        width: window.width,
        height: window.height,
        sound: sound.sound.clone(),
        volume: sound.volume,
        listen: sound.listen.or(sound.law.law.map(|_| Listen::Balance)),
        parts: sound.parts()?,
        law: sound.law.law,
        device: sound.device.clone(),
        buffer: sound.buffer,
        record: sound.record.clone(),
        save: window.save.clone(),
        screenshot: window.screenshot.clone(),
        frames: window.frames,
        seconds: window.seconds,
        help: !window.no_help,
        // The JSON report contains the number of GL errors, so they are checked.
        check_gl: common.json,
        is_asked_to_end: super::interrupt::is_asked,
        log_frames: window.log_frames.then_some(print::tell_record),
        announce: if common.json { to_errors } else { to_output },
    })
}

/// Rejects invalid options before a window is opened.
fn check(sound: &SoundOptions, window: &WindowOptions, common: &Common) -> anyhow::Result<()> {
    if common.gl != Api::Gl || common.gpu.is_some() {
        let text = "--gl and --gpu are for commands without a window: the window is drawn on the display's GPU";
        return Err(BadInput(text.into()).into());
    }
    Sound::parse(&sound.sound, Sound::SAMPLE_RATE).map_err(Error::from)?;
    check_range("--volume", f64::from(sound.volume), 0.0, 1.0)?;
    check_range("--buffer", f64::from(sound.buffer), 16.0, 65_536.0)?;
    check_range("--trace-every", f64::from(window.trace_every), 1.0, 1000.0)?;
    check_range("--fps", window.frame_rate.fps, 1.0, 240.0)?;
    check_range("--width", f64::from(window.width), 320.0, 16_384.0)?;
    check_range("--height", f64::from(window.height), 180.0, 16_384.0)?;
    check_range("--scale", f64::from(window.scale.unwrap_or(1.0)), 0.05, 1.0)?;
    check_range("--text-size", f64::from(window.text_size), 0.75, 2.5)?;
    check_range("--seconds", window.seconds.unwrap_or(1.0), SHORTEST_S, 1e9)?;
    if window.frames == Some(0) {
        let text = "--frames must be 1 or more: the window shows one before it closes";
        return Err(BadInput(text.to_owned()).into());
    }
    check_law(sound)?;
    for (file, ending) in [
        (&sound.record, "wav"),
        (&window.save, "ron"),
        (&window.screenshot, "png"),
    ] {
        if let Some(file) = file {
            check_ending(file, ending)?;
        }
    }
    Ok(())
}

/// Rejects a panning law that would have no effect.
fn check_law(sound: &SoundOptions) -> Result<(), BadInput> {
    if sound.law.law.is_none() || sound.listen != Some(Listen::Full) {
        return Ok(());
    }
    Err(super::render::no_effect_in_full("--law"))
}

/// Checks the output files. This function must be called after the sound and the scene were read, because only then are
/// all input files known. An output must not overwrite an input.
fn check_outputs(arguments: &Arguments) -> anyhow::Result<()> {
    let window = &arguments.window;
    for file in [&arguments.sound.record, &window.save, &window.screenshot] {
        file.as_deref().map_or(Ok(()), check_file)?;
    }
    Ok(())
}

/// Rejects an unknown device, and a recording without a device, before a window is opened.
#[cfg(feature = "audio")]
fn check_device(sound: &SoundOptions) -> anyhow::Result<()> {
    if sound.device.is_none() && sound.record.is_none() {
        return Ok(());
    }
    let devices = echomarch::audio::live::list_devices();
    if devices.is_empty() {
        bail!("there is no sound device: nothing can be played or recorded");
    }
    let Some(wanted) = &sound.device else {
        return Ok(());
    };
    if devices
        .iter()
        .any(|of| of.name == *wanted || of.id == *wanted)
    {
        return Ok(());
    }
    let known: Vec<&str> = devices.iter().map(|device| device.name.as_str()).collect();
    let refused = format!("no sound device is called {wanted:?}");
    let refused = echomarch::internals::text::which_there_are(&refused, wanted, &known);
    Err(BadInput(refused).into())
}

#[cfg(not(feature = "audio"))]
fn check_device(sound: &SoundOptions) -> anyhow::Result<()> {
    if sound.device.is_none() && sound.record.is_none() {
        return Ok(());
    }
    bail!("built without sound: nothing can be played or recorded")
}

/// A count with its noun, in singular or plural.
fn counted(count: u64, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        count => format!("{count} {what}s"),
    }
}

fn to_output(line: &str) {
    // If the line cannot be printed, the window still shows it.
    let _ = print::line(&text::message(line));
}

fn to_errors(line: &str) {
    print::tell(line);
}

/// Prints the number of waves if it is lower than requested, and the cost of the scene's fields.
fn print_waves(report: &Report) -> anyhow::Result<()> {
    if let Some(asked) = report.more_waves_asked {
        print::line(&format!(
            "  {} of {asked} waves: more would not have kept the frame rate",
            report.waves
        ))?;
    }
    match &report.fields {
        Some(fields) => print::line(&format!("  {fields}")),
        None => Ok(()),
    }
}

fn print_text(report: &Report) -> anyhow::Result<()> {
    let times = &report.frame_ms_median;
    print::line(&format!(
        "{} in {:.1} s, {:.1} fps (median), 95 % below {:.1} ms",
        counted(report.frames, "frame"),
        report.seconds,
        report.fps_median,
        report.frame_ms_95
    ))?;
    if let Some(errors) = report.gl_errors.filter(|&errors| errors > 0) {
        print::line(&format!("  GL reported errors after {errors} frames"))?;
    }
    print::line(&format!(
        "  picture {:.1} ms ({} × {}), waves {:.1}, read back {:.1}, panels {:.1}, swap {:.1}",
        times.picture,
        report.picture[0],
        report.picture[1],
        times.waves,
        times.read_back,
        times.overlay,
        times.swap
    ))?;
    print_waves(report)?;
    let latency = &report.latency_ms;
    print::line(&format!(
        "  key to ear {}; {}",
        match latency.total() {
            0.0 => "not measured".to_owned(),
            total if latency.is_whole() => format!("{total:.1} ms at most"),
            total => format!("{total:.1} ms for the measured parts"),
        },
        report.sound.text
    ))?;
    if !report.trace_call_is_exact {
        print::line("# the source or the listener was moved; F5 saves their positions:")?;
    }
    print::line("the same frame without the window:")?;
    print::line(&report.trace_call)
}
