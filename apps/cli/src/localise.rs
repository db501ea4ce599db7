//! `echomarch localise`: the localisation experiment with an observer model (`run`) and with people (`form`, `score`).

use super::exit::BadInput;
use super::numbers::{count, real};
use super::options::{Common, ProfilesOption, check_range};
use super::print;
use super::report::{self, with_progress};
use clap::{Args, Subcommand};
use echomarch::Error;
use echomarch::audio::{PanningLaw, Sound, SoundSpec};
use echomarch::scene::Scene;
use echomarch::tracer::{Profile, Settings};
use echomarch_lab::experiment::localise::form::{self, Form, FormOptions, WriteError};
use echomarch_lab::experiment::localise::score::{ScoreReport, score};
use echomarch_lab::experiment::localise::{
    self, LocaliseOptions, MOST_TRIALS, MOST_WORK, OpenCase,
};
use echomarch_lab::of_first_pair;
use serde_json::json;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch localise run -o out              an observer that answers from the levels alone
  echomarch localise form -o form --seed 7   sounds and a page for people: open form.html
  echomarch localise score answers-*.json    score of their answers";

const RUN_EXAMPLES: &str = "\
Examples:
  echomarch localise run                     every profile and count: some minutes
  echomarch localise run --quick             some seconds
  echomarch localise run -o out              the same; CSV, JSON, SVG and Markdown in out/
  echomarch localise run --scenes my.ron --sounds sine:300 --profiles hybrid";

const FORM_EXAMPLES: &str = "\
Examples:
  echomarch localise form -o form            48 trials, about ten minutes
  echomarch localise form -o form --seed 7 --scenes corner --sounds sine:500 --waves 65536
  echomarch localise form -o form --profiles hybrid,thesis --iterations 8 --order-seed 7";

const SCORE_EXAMPLES: &str = "\
Examples:
  echomarch localise score answers-*.json
  echomarch localise score --json anna.json bert.json
  echomarch localise score -o out answers-*.json";

/// The default rooms and sounds.
const SCENES: &str = "corner,obstacles";
const ALL_SOUNDS: &str = "speech,sine:500";

/// Arguments of `localise`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Let the observer model answer: errors by scene, sound, profile, waves and iterations
    Run(RunArguments),
    /// Write sounds, and a page on which people answer
    Form(FormArguments),
    /// Score the answers saved by the page
    Score(ScoreArguments),
}

/// The stimuli of the experiment.
#[derive(Args, Debug)]
struct Stimuli {
    /// Built-in scenes or scene files, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "NAMES", default_value = SCENES)]
    scenes: Vec<String>,
    /// Sounds, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "SOUNDS", default_value = ALL_SOUNDS)]
    sounds: Vec<String>,
    /// Panning law for all profiles: linear (the thesis), constant-power
    #[arg(long, default_value_t = PanningLaw::Linear, value_name = "LAW")]
    law: PanningLaw,
}

#[derive(Args, Debug)]
#[command(after_help = RUN_EXAMPLES)]
struct RunArguments {
    #[command(flatten)]
    stimuli: Stimuli,
    #[command(flatten)]
    compared: ProfilesOption,
    /// Numbers of waves, separated by commas [default: 64 to 1048576, in steps of a factor of four]
    #[arg(long, value_delimiter = ',', value_name = "N", value_parser = count::<u32>)]
    waves: Vec<u32>,
    /// Numbers of iterations, separated by commas [default: 1,2,4,8,16]
    #[arg(long, value_delimiter = ',', value_name = "N", value_parser = count::<u32>)]
    iterations: Vec<u32>,
    /// Number of frames per setting and facing direction, each with its own seed [default: 5; with --quick 3]
    #[arg(long, value_name = "N", value_parser = count::<u32>)]
    seeds: Option<u32>,
    /// Use only a few settings and seeds
    #[arg(long)]
    quick: bool,
    /// Write localise.csv, .json, .md and .svg into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

#[derive(Args, Debug)]
#[command(after_help = FORM_EXAMPLES)]
struct FormArguments {
    #[command(flatten)]
    stimuli: Stimuli,
    /// Profiles, separated by commas
    #[arg(
        long,
        visible_alias = "profile",
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "hybrid"
    )]
    profiles: Vec<Profile>,
    /// Numbers of waves, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "N", default_value = "4096,65536", value_parser = count::<u32>)]
    waves: Vec<u32>,
    /// Numbers of iterations, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "N", default_value = "4,8", value_parser = count::<u32>)]
    iterations: Vec<u32>,
    /// Seed of the trial numbers and of the waves' start directions
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = count::<u32>)]
    seed: u32,
    /// Seed of the trial order, used in every session [default: each session has a random order]
    #[arg(long, value_name = "N", value_parser = count::<u32>)]
    order_seed: Option<u32>,
    /// Length of each sound
    #[arg(long, default_value_t = 2.0, value_name = "SECONDS", value_parser = real::<f64>)]
    seconds: f64,
    /// Output folder, which must be empty or must not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

#[derive(Args, Debug)]
#[command(after_help = SCORE_EXAMPLES)]
struct ScoreArguments {
    /// Files saved by the page, including those of interrupted sessions
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Write score.csv, .json and .md into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    match &arguments.command {
        Command::Run(arguments) => observe(arguments, common),
        Command::Form(arguments) => write_form(arguments, common),
        Command::Score(arguments) => score_files(arguments, common),
    }
}

fn observe(arguments: &RunArguments, common: &Common) -> anyhow::Result<()> {
    let options = run_options(arguments, common)?;
    report::run(
        common,
        arguments.output.as_deref(),
        "settings",
        |tracer, progress| localise::run(tracer, &options, progress),
    )
}

fn run_options(arguments: &RunArguments, common: &Common) -> anyhow::Result<LocaliseOptions> {
    let (scenes, sounds) = stimuli(&arguments.stimuli, common)?;
    let mut options = LocaliseOptions::new(scenes, sounds);
    if arguments.quick {
        options = options.quick();
    }
    options.law = arguments.stimuli.law;
    options.profiles = distinct(&arguments.compared.profiles);
    if !arguments.waves.is_empty() {
        options.waves = distinct(&arguments.waves);
    }
    if !arguments.iterations.is_empty() {
        options.iterations = distinct(&arguments.iterations);
    }
    if let Some(seeds) = arguments.seeds {
        check_range("--seeds", f64::from(seeds), 2.0, 1000.0)?;
        options.seeds = seeds;
    }
    check_settings(&options.waves, &options.iterations)?;
    check_work(arguments, &options)?;
    let open = |case: &OpenCase| options.profiles.contains(&case.settings.profile());
    options.open.retain(open);
    Ok(options)
}

/// Rejects settings that are too large if the user requested them. Default settings that are too large are listed in
/// the report instead.
fn check_work(arguments: &RunArguments, options: &LocaliseOptions) -> anyhow::Result<()> {
    let left_out = options.left_out();
    let Some((waves, iterations)) = left_out.first() else {
        return Ok(());
    };
    let is_asked = !arguments.waves.is_empty() && !arguments.iterations.is_empty();
    if is_asked || left_out.len() == options.waves.len() * options.iterations.len() {
        return Err(BadInput(format!(
            "{waves} waves with {iterations} iterations are too large: waves × iterations must \
             be up to {MOST_WORK}"
        ))
        .into());
    }
    Ok(())
}

fn stimuli(from: &Stimuli, common: &Common) -> anyhow::Result<(Vec<Scene>, Vec<SoundSpec>)> {
    let scenes = distinct(&from.scenes);
    let scene = |name: &String| common.scene(name).map(of_first_pair);
    let scenes: Result<Vec<Scene>, Error> = scenes.iter().map(scene).collect();
    let mut sounds = Vec::new();
    for name in distinct(&from.sounds) {
        let spec: SoundSpec = name.parse().map_err(Error::from)?;
        // Loads each sound before any work begins, because the file may not exist.
        Sound::load(&spec, Sound::SAMPLE_RATE).map_err(Error::from)?;
        sounds.push(spec);
    }
    Ok((scenes?, sounds))
}

/// Returns the items without duplicates, in their original order.
fn distinct<T: Clone + PartialEq>(items: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    for item in items {
        if !once.contains(item) {
            once.push(item.clone());
        }
    }
    once
}

fn check_settings(waves: &[u32], iterations: &[u32]) -> anyhow::Result<()> {
    for &waves in waves {
        for &iterations in iterations {
            let settings = Settings::default();
            let settings = settings.with_waves(waves).with_iterations(iterations);
            settings.validate().map_err(Error::from)?;
        }
    }
    Ok(())
}

fn write_form(arguments: &FormArguments, common: &Common) -> anyhow::Result<()> {
    let options = arguments.options(common)?;
    form::prepare(&arguments.output).map_err(refused)?;
    let form = build(&options, common)?;
    form.write(&arguments.output).map_err(refused)?;
    tell_form(arguments, common, &form)
}

impl FormArguments {
    /// The contents of the form.
    fn options(&self, common: &Common) -> anyhow::Result<FormOptions> {
        check_range("--seconds", self.seconds, 0.1, 60.0)?;
        let (waves, iterations) = (distinct(&self.waves), distinct(&self.iterations));
        check_settings(&waves, &iterations)?;
        let (scenes, sounds) = stimuli(&self.stimuli, common)?;
        let options = FormOptions {
            scenes,
            sounds,
            profiles: distinct(&self.profiles),
            waves,
            iterations,
            seed: self.seed,
            order_seed: self.order_seed,
            seconds: self.seconds,
            law: self.stimuli.law,
        };
        check_range(
            "the number of trials",
            options.trials() as f64,
            1.0,
            MOST_TRIALS as f64,
        )?;
        Ok(options)
    }
}

/// Traces the trials and draws their plans.
fn build(options: &FormOptions, common: &Common) -> anyhow::Result<Form> {
    let mut tracer = common.tracer()?;
    let form = with_progress(common, "settings", |progress| {
        form::build(&mut tracer, options, progress)
    })?;
    Ok(form)
}

fn refused(error: WriteError) -> anyhow::Error {
    match error {
        WriteError::NotEmpty { .. } => BadInput(error.to_string()).into(),
        WriteError::Output(error) => error.into(),
    }
}

fn tell_form(arguments: &FormArguments, common: &Common, form: &Form) -> anyhow::Result<()> {
    let page = arguments.output.join("form.html").display().to_string();
    let unheard = form.trials.iter().filter(|trial| trial.stimulus.hits == 0);
    let unheard = unheard.count();
    if common.json {
        return print::json(&json!({
            "output": page, "experiment": form.experiment, "seed": form.seed,
            "order_seed": form.order_seed,
            "embedded": form.embedded, "unheard": unheard, "trials": form.trials,
        }));
    }
    let sounds = match form.embedded {
        true => "with all sounds in it",
        false => "with its sounds in the folder sounds/",
    };
    let trials = form.trials.len();
    print::line(&format!(
        "{page}: {trials} trials, {sounds}; open it in a browser"
    ))?;
    if unheard > 0 {
        print::line(&format!(
            "  in {unheard} of them no wave arrived: their sound is in the middle"
        ))?;
    }
    Ok(())
}

fn score_files(arguments: &ScoreArguments, common: &Common) -> anyhow::Result<()> {
    let report = score(&arguments.files).map_err(|error| BadInput(error.to_string()))?;
    let folder = arguments.output.as_deref();
    if let Some(folder) = folder {
        report::check::<ScoreReport>(folder)?;
    }
    if !common.json {
        for note in &report.notes {
            common.note(&format!("note: {note}"));
        }
    }
    report::write_and_print(common, folder, &report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch_lab::experiment::localise::{ROOMS, SOUNDS};

    /// Protects the help: it lists the scenes and sounds of the experiment in the form in which users type them.
    #[test]
    fn the_defaults_are_those_of_the_experiment() {
        assert_eq!(SCENES, ROOMS.join(","));
        assert_eq!(ALL_SOUNDS, SOUNDS.join(","));
    }
}
