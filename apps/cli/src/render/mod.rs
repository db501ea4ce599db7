//! `echomarch render`: writes a WAV file of the sound at the listener.

mod balance;
mod full_listening;
mod sounds;

use super::exit::BadInput;
use super::numbers::real;
use super::options::{Common, FrameRateOption, LawOption, TraceOptions, check_ending, check_range};
use super::print;
use super::scene::SceneArguments;
use clap::Args;
use echomarch::Error;
use echomarch::audio::SoundSpec;
use echomarch::auralisation::Listen;
use echomarch::internals::file_output::check_file;
use echomarch::offline::Timing;
use echomarch::scene::Scene;
use echomarch::tracer::{Profile, Settings, Tracer};
use serde::Serialize;
use sounds::SourceSound;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch render open-field -o pass.wav
  echomarch render hall.ron -o hall.wav --sound flute=flute.wav --sound voice=voice.wav
  echomarch render open-pillars -o walk.wav --diffraction
  echomarch render corner -o corner.wav --sound noise --seconds 3 --gain 12
  echomarch render my.ron -o walk.wav --sound voice.wav --law linear";

/// Default length in seconds for a scene without motion.
const STANDING_SECONDS: f64 = 5.0;

/// Maximum length in seconds: a WAV file of this format can hold slightly more.
const LONGEST_SECONDS: f64 = 3.0 * 3600.0;

/// Minimum predicted time of all frames, in minutes, for which a note is printed.
const DEAR_MINUTES: f64 = 2.0;

/// Arguments of `render`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The WAV file to write: 48 kHz, 32-bit float, stereo
    #[arg(short, long, value_name = "FILE.wav")]
    output: PathBuf,
    /// Listening mode: full (loudness, delays, echoes, reverberation), or balance (only left against right, as in the
    /// thesis) [default: full; balance with --profile thesis, and with the options --law and --iterations, which full
    /// does not have]
    #[arg(long, value_name = "WHAT")]
    listen: Option<Listen>,
    /// Sounds of the sources: sine:HERTZ, noise, noise:SEED, speech, speech:SEED, or a WAV file (looped). NAME=SOUND
    /// sets the sound of one source, given by its name or number; repeatable [default: speech, with another voice for
    /// each source]
    #[arg(long = "sound", value_name = "SOUND")]
    sounds: Vec<SourceSound>,
    /// Length of the output [default: duration of the scene's longest path, or 5]
    #[arg(long, allow_negative_numbers = true, value_name = "SECONDS", value_parser = real::<f64>)]
    seconds: Option<f64>,
    #[command(flatten)]
    frame_rate: FrameRateOption,
    #[command(flatten)]
    full: full_listening::FullOptions,
    #[command(flatten, next_help_heading = "With --listen balance")]
    law: LawOption,
    #[command(flatten)]
    options: TraceOptions,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let listen = arguments.listen()?;
    arguments.note_balance(common, listen);
    check_ending(&arguments.output, "wav")?;
    let scene = common.scene_with_values(&arguments.scene)?;
    let job = Job {
        arguments,
        common,
        timing: timing(arguments, scene.duration())?,
        sounds: sounds::of_sources(&scene, &arguments.sounds)?,
        scene,
    };
    match listen {
        Listen::Balance => balance::run(job),
        Listen::Full => full_listening::run(job),
    }
}

/// A rendering job.
struct Job<'a> {
    arguments: &'a Arguments,
    common: &'a Common,
    scene: Scene,
    timing: Timing,
    /// The sounds, one per source.
    sounds: Vec<SoundSpec>,
}

/// The first fields of the report of a rendered scene.
#[derive(Serialize)]
struct ReportHead<'a> {
    scene: &'a str,
    listen: &'static str,
    profile: String,
    renderer: &'a str,
    waves: u32,
}

impl Arguments {
    /// Returns the listening mode. The profile `thesis` supports only the balance.
    fn listen(&self) -> Result<Listen, BadInput> {
        let thesis = (self.options.profile == Profile::Thesis).then_some("--profile thesis");
        let of_balance = thesis.or_else(|| self.balance_option());
        match (self.listen, of_balance, self.full.given()) {
            (Some(Listen::Full), Some(option), _) => Err(no_effect_in_full(option)),
            (Some(Listen::Balance), _, Some(option)) | (None, Some(_), Some(option)) => {
                Err(BadInput(format!(
                    "{option} needs --listen full: the balance has no loudness and no echoes"
                )))
            }
            (Some(listen), ..) => Ok(listen),
            (None, Some(_), None) => Ok(Listen::Balance),
            (None, None, _) => Ok(Listen::Full),
        }
    }

    /// Prints a note if an option other than `--listen` has selected the balance.
    fn note_balance(&self, common: &Common, listen: Listen) {
        if self.listen.is_some()
            || listen == Listen::Full
            || self.options.profile == Profile::Thesis
        {
            return;
        }
        if let Some(option) = self.balance_option() {
            common.note(&format!(
                "note: {option} belongs to --listen balance, so only the balance of left and right is rendered"
            ));
        }
    }

    /// Returns the first typed option that applies only to the balance.
    fn balance_option(&self) -> Option<&'static str> {
        let options = &self.options;
        let typed = [
            (self.law.law.is_some(), "--law"),
            (options.iterations.is_some(), "--iterations"),
            (
                options.iterations_per_pass.is_some(),
                "--iterations-per-pass",
            ),
            (options.sum_on_gpu, "--sum-on-gpu"),
        ];
        let found = typed.into_iter().find(|(is_typed, _)| *is_typed);
        found.map(|(_, name)| name)
    }
}

/// Returns the error for an option of the balance that has no effect in full listening, with the reason.
pub(super) fn no_effect_in_full(option: &str) -> BadInput {
    let why = match option {
        "--law" => "which pans each arrival with constant power",
        "--profile thesis" => "because the thesis' waves end at the listener and carry no energy",
        "--iterations" => "which traces waves for as long as they are audible",
        _ => "which does not trace frames for the balance",
    };
    BadInput(format!(
        "{option} has no effect on --listen full, {why}: use --listen balance"
    ))
}

impl Job<'_> {
    /// Checks, before tracing, for errors that would otherwise occur later.
    fn check(&self) -> anyhow::Result<()> {
        check_file(&self.arguments.output)?;
        check_on_the_way(&self.scene, self.timing)?;
        Ok(())
    }

    fn warn(&self) {
        self.common.warn_checked(&self.scene);
        warn_on_the_way(&self.scene, self.timing, self.common);
    }

    fn report_head<'a>(
        &'a self,
        listen: &'static str,
        settings: &Settings,
        tracer: &'a Tracer,
    ) -> ReportHead<'a> {
        ReportHead {
            scene: &self.scene.name,
            listen,
            profile: settings.profile().to_string(),
            renderer: tracer.context().renderer(),
            waves: settings.waves,
        }
    }

    /// Prints a note after the first part, which took `seconds`, if the remaining parts will take long.
    fn note_dear(&self, parts: Parts, waves: u32, seconds: f64, bar: &indicatif::ProgressBar) {
        if let Some(note) = dear_note(parts, waves, seconds) {
            bar.suspend(|| self.common.note(&note));
        }
    }

    fn bar(&self) -> indicatif::ProgressBar {
        print::progress(self.common.quiet, self.timing.frames(), "frames")
    }
}

/// The traced parts of a sound.
#[derive(Clone, Copy)]
struct Parts {
    /// One of them.
    name: &'static str,
    count: u64,
    /// The option that reduces their number.
    option: &'static str,
}

/// Returns a note on the predicted time of all parts if one of them took `seconds`. Returns `None` if the time is short
/// or there is only one part.
fn dear_note(parts: Parts, waves: u32, seconds: f64) -> Option<String> {
    let Parts {
        name,
        count,
        option,
    } = parts;
    let minutes = seconds * count as f64 / 60.0;
    if minutes < DEAR_MINUTES || count < 2 {
        return None;
    }
    Some(format!(
        "note: a {name} of {waves} waves takes {seconds:.1} s, so that {count} {name}s take about {minutes:.0} min: \
         fewer --waves or a lower {option} take less"
    ))
}

/// Rejects, before tracing, a scene that becomes invalid during its motion.
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

/// Prints the warnings that arise during the motion. Each kind of warning is printed once, with its time.
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
    check_range("--fps", arguments.frame_rate.fps, 1.0, 1000.0)?;
    Ok(Timing::new(seconds, arguments.frame_rate.fps))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the user of an expensive field from a long wait of unknown duration.
    #[test]
    fn the_time_of_all_frames_is_told_after_the_first() {
        let parts = |count: u64| Parts {
            name: "frame",
            count,
            option: "--fps",
        };
        assert_eq!(dear_note(parts(150), 65_536, 0.7), None);
        assert_eq!(dear_note(parts(1), 65_536, 400.0), None);
        let note = dear_note(parts(150), 65_536, 40.0).unwrap();
        assert!(note.starts_with(
            "note: a frame of 65536 waves takes 40.0 s, so that 150 frames take about 100 min"
        ));
    }
}
