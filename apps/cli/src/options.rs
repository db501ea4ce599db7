//! Arguments that several subcommands share.

use super::exit::BadInput;
use super::numbers::{count, decibels, real};
use super::print;
use clap::Args;
use echomarch::Error;
use echomarch::audio::PanningLaw;
use echomarch::gl::{Api, Context, ContextOptions};
use echomarch::response::ResponseSettings;
use echomarch::scene::Scene;
use echomarch::tracer::{Algorithm, Budget, Directions, Profile, Settings, Tracer};
use std::path::Path;

/// Options of every subcommand.
#[derive(Args, Debug)]
#[command(next_help_heading = "Renderer and output")]
pub struct Common {
    /// OpenGL interface: gl (EGL, desktop 3.3), gles (EGL, ES 3.0), osmesa
    #[arg(long, global = true, default_value_t = Api::Gl, value_name = "API")]
    pub gl: Api,
    /// EGL device to use, as numbered by `info` [default: the first that works]
    #[arg(long, global = true, allow_negative_numbers = true, value_name = "N", value_parser = count::<usize>)]
    pub gpu: Option<usize>,
    /// Print JSON instead of text
    #[arg(long, global = true)]
    pub json: bool,
    /// Print no progress, notes or warnings
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

impl Common {
    /// The options of the OpenGL context.
    pub fn context_options(&self) -> ContextOptions {
        let mut options = ContextOptions::new(self.gl);
        options.gpu = self.gpu;
        options
    }

    /// Opens the requested renderer, and prints its name to standard error.
    pub fn context(&self) -> Result<Context, Error> {
        let context = Context::headless(&self.context_options())?;
        // A device that exists but cannot be used is reported even with --quiet.
        for reason in context.passed_over() {
            print::tell(&format!("warning: skipped {reason}"));
        }
        self.note(&format!("renderer: {}", context.renderer()));
        Ok(context)
    }

    /// A tracer on the requested renderer.
    pub fn tracer(&self) -> Result<Tracer, Error> {
        Tracer::new(&self.context()?)
    }

    /// Prints a line to standard error, unless `--quiet` is set.
    pub fn note(&self, line: &str) {
        if !self.quiet {
            print::tell(line);
        }
    }
}

/// Frames per second.
#[derive(Args, Clone, Copy, Debug)]
pub struct FrameRateOption {
    /// Number of frames traced per second
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 30.0,
        value_name = "N", value_parser = real::<f64>)]
    pub fps: f64,
}

/// The conversion of the waves' pan to the levels of the two channels.
#[derive(Args, Clone, Copy, Debug)]
pub struct LawOption {
    /// Panning law: constant-power, or linear (the thesis) [default: constant-power; linear with --profile thesis]
    #[arg(long, value_name = "LAW")]
    pub law: Option<PanningLaw>,
}

impl LawOption {
    /// The requested law, or the profile's default.
    pub fn of(self, profile: Profile) -> PanningLaw {
        self.law.unwrap_or(PanningLaw::for_profile(profile))
    }
}

/// Diffraction in responses.
#[derive(Args, Clone, Copy, Debug)]
pub struct DiffractionOption {
    /// Let the direct sound and reflections at plane faces bend around obstacles; late arrivals do not bend
    #[arg(long)]
    pub diffraction: bool,
}

/// Least level of a source.
#[derive(Args, Clone, Copy, Debug)]
pub struct LeastLevelOption {
    /// Least level of a source, −100 to 0: everything heard from it is at least as loud in each band as its direct
    /// sound in the open, plus this level. A floor for games, not physics [default: none]
    #[arg(long = "least-level", allow_hyphen_values = true, value_name = "DB", value_parser = decibels)]
    pub least_level_db: Option<f64>,
}

impl LeastLevelOption {
    /// Returns the requested level, if any.
    pub fn checked(self) -> Result<Option<f64>, BadInput> {
        if let Some(level_db) = self.least_level_db {
            let lowest_db = ResponseSettings::LOWEST_LEAST_LEVEL_DB;
            check_range("--least-level", level_db, lowest_db, 0.0)?;
        }
        Ok(self.least_level_db)
    }
}

/// Algorithms to compare.
#[derive(Args, Debug)]
pub struct ProfilesOption {
    /// Profiles to compare, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "thesis,march,hybrid"
    )]
    pub profiles: Vec<Profile>,
}

/// Default number of segments of each wave.
const USUAL_ITERATIONS: u32 = 8;

/// Settings of the tracer.
#[derive(Args, Debug)]
#[command(next_help_heading = "How to trace")]
pub struct TraceOptions {
    /// The algorithm: hybrid (closed form), march (accurate sphere tracing), thesis
    #[arg(long, default_value_t = Profile::Hybrid, value_name = "NAME")]
    pub profile: Profile,
    /// Number of sound waves, 1 to 16777216 [default: 65536]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = count::<u32>)]
    pub waves: Option<u32>,
    /// Number of iterations (segments of each wave), 1 to 4095 [default: 8]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = count::<u32>)]
    pub iterations: Option<u32>,
    /// Seed of the start directions
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1,
        value_name = "N", value_parser = count::<u32>)]
    pub seed: u32,
    /// Start directions: random (the thesis), fibonacci (an even lattice)
    #[arg(long, default_value_t = Directions::Random, value_name = "NAME")]
    pub directions: Directions,
    /// thesis only: distance below which a wave hits a surface, in metres [0.1]
    #[arg(long, allow_negative_numbers = true, value_name = "METRES", value_parser = real::<f32>)]
    pub min_distance: Option<f32>,
    /// Distance in one iteration beyond which a wave is dead, in metres [thesis: 300, otherwise 1e9]
    #[arg(long, allow_negative_numbers = true, value_name = "METRES", value_parser = real::<f32>)]
    pub max_distance: Option<f32>,
    /// Iterations in one pass over the waves; the scene's loops may limit this number [hybrid: all; march: 8; thesis:
    /// 1]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = count::<u32>)]
    pub iterations_per_pass: Option<u32>,
    /// Sum the panning on the GPU and read back one texel
    #[arg(long)]
    pub sum_on_gpu: bool,
}

impl TraceOptions {
    /// Returns the requested settings after validation.
    pub fn settings(&self) -> anyhow::Result<Settings> {
        let mut settings = Settings::new(self.algorithm()?)
            .with_iterations(self.iterations.unwrap_or(USUAL_ITERATIONS))
            .with_seed(self.seed)
            .with_directions(self.directions)
            .with_sum_on_gpu(self.sum_on_gpu);
        settings.waves = self.waves.unwrap_or(settings.waves);
        settings.max_distance = self.max_distance.unwrap_or(settings.max_distance);
        let per_pass = self.iterations_per_pass;
        settings.iterations_per_pass = per_pass.unwrap_or(settings.iterations_per_pass);
        settings.validate().map_err(Error::from)?;
        Ok(settings)
    }

    /// The requested algorithm with its options.
    fn algorithm(&self) -> Result<Algorithm, BadInput> {
        let mut algorithm = Algorithm::of(self.profile);
        let Some(metres) = self.min_distance else {
            return Ok(algorithm);
        };
        let Algorithm::Thesis(thesis) = &mut algorithm else {
            let text = format!(
                "--min-distance has no effect on --profile {}: only thesis has a minimum distance",
                self.profile
            );
            return Err(BadInput(text));
        };
        thesis.min_distance = metres;
        Ok(algorithm)
    }

    /// Prints a note if a pass computes fewer iterations than requested.
    pub fn note_passes(&self, common: &Common, scene: &Scene, settings: &Settings) {
        let Some(asked) = self.iterations_per_pass else {
            return;
        };
        let most = Budget::of(scene, settings).iterations_per_pass;
        if most < asked.min(settings.iterations) {
            common.note(&format!(
                "note: with --profile {} a pass over this scene computes at most {most} iterations",
                settings.profile()
            ));
        }
    }
}

/// Rejects a file name that lacks the extension of its format.
pub fn check_ending(file: &Path, ending: &str) -> Result<(), BadInput> {
    match file.extension() {
        Some(found) if found.eq_ignore_ascii_case(ending) => Ok(()),
        _ => Err(BadInput(format!(
            "the file {} must end in .{ending}: that is the format written",
            file.display()
        ))),
    }
}

/// Rejects a number outside its range.
pub fn check_range(what: &str, value: f64, least: f64, most: f64) -> Result<(), BadInput> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    let (least, most) = (plain(least), plain(most));
    Err(BadInput(format!(
        "{what} must be {least} to {most}, not {value}"
    )))
}

/// Formats a limit. Very small limits are written as powers of ten.
fn plain(limit: f64) -> String {
    /// Below this value, decimal zeros are hard to count.
    const SMALL: f64 = 1e-4;
    match limit != 0.0 && limit.abs() < SMALL {
        true => format!("{limit:e}"),
        false => limit.to_string(),
    }
}
