//! `echomarch localise window`: the questions of the form, in a window with live sound.

use super::exit::BadInput;
use super::localise::{Trials, build};
use super::numbers::{count, real};
use super::options::{Common, check_ending, check_range};
use super::print;
use crate::demo::{DemoOptions, run_sitting};
use crate::experiment::localise::sitting::{Sitting, SittingError};
use crate::output::check_file;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch localise window -o anna.json             48 trials; again to go on where one stopped
  echomarch localise window -o anna.json --scenes corner --sounds speech --iterations 8
  echomarch localise score anna.json

Space plays, a click on the plan or the arrow keys mark, Enter locks; the other keys stand
beside what they do.";

/// Arguments of `localise window`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    trials: Trials,
    /// Where the answers are kept; a file that is there is taken up where it was broken off
    #[arg(short, long, value_name = "FILE.json")]
    output: PathBuf,
    /// A code for the person, not a name
    #[arg(long, default_value = "", value_name = "CODE")]
    participant: String,
    /// Seed of the order of the trials in a sitting that begins [default: another for each]
    #[arg(long, value_name = "N", value_parser = count::<u64>)]
    order_seed: Option<u64>,
    /// Loudness, 0 to 1
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.5, value_parser = real::<f32>)]
    volume: f32,
    /// Sound device by its name, as demo --list-devices has it
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    /// Draw the picture at this share of the window's size; without it the share follows the
    /// frame's time
    #[arg(long, allow_negative_numbers = true, value_name = "SHARE", value_parser = real::<f32>)]
    scale: Option<f32>,
    /// Picture of the window at the end
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<PathBuf>,
    /// Tell every frame as a line of JSON on standard error
    #[arg(long, hide = true)]
    log_frames: bool,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    check_ending(&arguments.output, "json")?;
    check_range("--volume", f64::from(arguments.volume), 0.0, 1.0)?;
    check_range(
        "--scale",
        f64::from(arguments.scale.unwrap_or(1.0)),
        0.05,
        1.0,
    )?;
    if let Some(picture) = &arguments.screenshot {
        check_ending(picture, "png")?;
    }
    let options = arguments.trials.options(common)?;
    if let Some(picture) = &arguments.screenshot {
        check_file(picture)?;
    }
    let form = build(&options, common)?;
    let opened = Sitting::open(
        form,
        arguments.output.clone(),
        &arguments.participant,
        arguments.order_seed,
    );
    let sitting = opened.map_err(|error| match error {
        SittingError::Output(error) => anyhow::Error::from(error),
        other => BadInput(other.to_string()).into(),
    })?;
    let window = DemoOptions {
        volume: arguments.volume,
        device: arguments.device.clone(),
        picture_scale: arguments.scale,
        screenshot: arguments.screenshot.clone(),
        help: false,
        check_gl: common.json,
        is_asked_to_end: super::interrupt::is_asked,
        log_frames: arguments.log_frames,
        ..DemoOptions::default()
    };
    super::interrupt::ask_from_now_on();
    let report = run_sitting(window, sitting, arguments.trials.seconds)?;
    if common.json {
        return print::json(&report);
    }
    print::line(&format!(
        "the answers are in {}",
        arguments.output.display()
    ))
}
