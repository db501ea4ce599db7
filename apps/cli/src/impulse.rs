//! `echomarch impulse`: impulse responses and room acoustic figures.

mod accuracy;
mod file_names;
mod files;
mod notes;
pub(super) mod pairs;
mod print_out;

use super::exit::BadInput;
use super::numbers::{count, real};
use super::options::{Common, DiffractionOption, check_ending, check_range};
use super::print;
use super::scene::SceneAtTime;
use accuracy::AccuracyOptions;
pub(super) use accuracy::percent;
use clap::{Args, ValueEnum};
use echomarch::Error;
use echomarch::audio::Sound;
use echomarch::hrtf::HrirSet;
use echomarch::internals::file_output::{check_file, write_whole};
use echomarch::response::{AmbisonicOrder, Format, ImpulseSettings, ResponseError};
use echomarch::response::{Response, ResponseSettings, RoomMeasurement, Round};
use echomarch::scene::Pair;
use echomarch::tracer::{Algorithm, Directions, Profile, Settings};
use file_names::FileNames;
use pairs::NamedPair;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const EXAMPLES: &str = "\
Examples:
  echomarch impulse hall.ron                         figures of the room to 2 %, and its early paths
  echomarch impulse hall.ron --accuracy 0.5% --time-limit 60
  echomarch impulse hall.ron -o ir.wav --waves 262144
  echomarch impulse hall.ron -o ir.wav --format ambisonic --ambisonic-order 3
  echomarch impulse hall.ron -o hall.sofa             all pairs in one file (AES69)
  echomarch impulse hall.ron -o ir.wav --format binaural --sofa head.sofa
  echomarch impulse hall.ron --source flute --listener stalls --plot decay.svg
  echomarch impulse hall.ron --csv figures.csv        all figures with their errors, by pair and band
  echomarch impulse hall.ron --echogram echogram.csv --json > hall.json";

/// The minimum length of a response, in seconds. A response shorter than one time bin contains no information.
const SHORTEST_S: f64 = 1e-3;

/// Arguments of `impulse`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneAtTime,
    /// Write the impulse response as a WAV file of 32-bit floats, or as a SOFA file (AES69, convention SingleRoomSRIR).
    /// The first sample is the time of the source's impulse, and amplitude 1 is the direct sound at 1 m. Coincident
    /// echoes add by amplitude in this file, and by energy in the figures. A SOFA file has all pairs; if there are
    /// several, each has a WAV file of its own: FILE-SOURCE-LISTENER.wav
    #[arg(short, long, value_name = "FILE.wav|FILE.sofa")]
    output: Option<PathBuf>,
    /// Channels of the file: mono, stereo, ambisonic (ACN, SN3D), or binaural (two ears, needs --sofa)
    #[arg(long, default_value = "mono", value_name = "NAME", requires = "output")]
    format: FormatOption,
    /// Order of --format ambisonic, 1 to 7: (order + 1)² channels [default: 1]
    #[arg(long, allow_negative_numbers = true, value_name = "N", requires = "output", value_parser = count::<u8>)]
    ambisonic_order: Option<u8>,
    /// Head-related impulse responses for --format binaural: a SOFA file of the convention
    /// SimpleFreeFieldHRIR
    #[arg(long, value_name = "FILE.sofa", requires = "output")]
    sofa: Option<PathBuf>,
    /// Sample rate of the file, in hertz
    #[arg(long, allow_negative_numbers = true, default_value_t = Sound::SAMPLE_RATE, value_name = "HZ",
        requires = "output", value_parser = count::<u32>)]
    rate: u32,
    /// Write the energy of all arrivals except the exact paths as CSV, by time (centre of a bin) and band:
    /// time_s,band_hz,energy,x,y,z. Several pairs have one file each, as with --output
    #[arg(long, value_name = "FILE.csv")]
    echogram: Option<PathBuf>,
    /// Write a plot of the energy and its decay against time. Several pairs have one file each, as with --output
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Write the figures and their standard errors as CSV, one row for each pair and band:
    /// source,listener,band_hz,edt_s,edt_error_s and so on
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Use only this source, given by its name or number
    #[arg(long, value_name = "NAME")]
    source: Option<String>,
    /// Use only this listener, given by its name or number
    #[arg(long, value_name = "NAME")]
    listener: Option<String>,
    /// Length of the response, 0.001 to 60 [default: until all bands have decayed by 60 dB, estimated from waves, at
    /// most 10]
    #[arg(long, allow_negative_numbers = true, value_name = "SECONDS", value_parser = real::<f64>)]
    seconds: Option<f64>,
    /// Maximum number of reflections of exact paths [default: 8 if all surfaces are flat, otherwise 3]
    #[arg(long, allow_negative_numbers = true, value_name = "N", value_parser = count::<u32>)]
    order: Option<u32>,
    #[command(flatten)]
    diffraction: DiffractionOption,
    /// The algorithm: hybrid (closed form), march (accurate sphere tracing)
    #[arg(long, default_value_t = Profile::Hybrid, value_name = "NAME")]
    profile: Profile,
    #[command(flatten)]
    accuracy: AccuracyOptions,
    /// Seed of the start directions, and of the noise of the late part
    #[arg(long, allow_negative_numbers = true, default_value_t = 1, value_name = "N", value_parser = count::<u32>)]
    seed: u32,
    /// Start directions: random (the thesis), fibonacci (an even lattice)
    #[arg(long, default_value_t = Directions::Random, value_name = "NAME")]
    directions: Directions,
}

/// The channels of the file.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum FormatOption {
    Mono,
    Stereo,
    #[value(alias = "ambix")]
    Ambisonic,
    Binaural,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    arguments.check()?;
    let settings = arguments.settings()?;
    let scene = common.scene_at_time(&arguments.scene)?;
    let pairs = pairs::chosen(
        &scene,
        arguments.source.as_deref(),
        arguments.listener.as_deref(),
    )?;
    let names = FileNames::of(&pairs);
    arguments.check_files(&names)?;
    let format = arguments.format()?;
    if let Some(seconds) = arguments.seconds {
        arguments.check_sofa(pairs.len() * format.channels(), seconds)?;
    }
    let mut tracer = common.tracer()?;
    notes::tell_first(common, &scene);
    let bar = print::progress(common.quiet, pairs.len() as u64, "pairs");
    let traced: Vec<Pair> = pairs.iter().map(|pair| pair.pair).collect();
    let mut observe = |round: Round| {
        bar.inc(round.finished as u64);
        bar.set_message(accuracy::of_round(&settings, &round));
    };
    let responses = Response::trace_pairs_observed(&mut tracer, &traced, &settings, &mut observe)?;
    let heard: Vec<(NamedPair, Response)> = pairs.into_iter().zip(responses).collect();
    for (index, (pair, response)) in heard.iter().enumerate() {
        files::write(arguments, pair, response, |given| names.file(given, index))?;
    }
    bar.finish_and_clear();
    if let Some(file) = &arguments.csv {
        write_whole(file, |out| files::write_figures(&heard, out))?;
    }
    common.warn_checked(&scene);
    notes::tell(common, &heard);
    if common.json {
        let renderer = tracer.context().renderer();
        print::json(&print_out::report(&scene, renderer, &settings, &heard))?;
    } else {
        print_out::text(&scene, &settings, &heard)?;
    }
    // The impulse responses come last: if they do not fit into a file, nothing else is lost.
    files::write_impulses(arguments, &format, &heard, &names)
}

impl Arguments {
    fn settings(&self) -> anyhow::Result<ResponseSettings> {
        let mut trace = Settings::new(Algorithm::of(self.profile));
        if let Some(waves) = self.accuracy.exact_waves() {
            trace.waves = waves;
        }
        let trace = trace.with_seed(self.seed).with_directions(self.directions);
        let mut settings = ResponseSettings::default().with_trace(trace);
        settings.accuracy = self.accuracy.accuracy()?;
        settings.order = self.order;
        settings.seconds = self.seconds;
        settings.diffraction = self.diffraction.diffraction;
        settings.validate()?;
        Ok(settings)
    }

    /// The format of the file. For binaural output it includes the responses of the head's SOFA file at the sample rate
    /// of the output.
    fn format(&self) -> anyhow::Result<Format> {
        Ok(match self.format {
            FormatOption::Mono => Format::Mono,
            FormatOption::Stereo => Format::Stereo,
            FormatOption::Ambisonic => Format::AmbiX(self.order_of_channels()?),
            FormatOption::Binaural => Format::Binaural(Arc::new(self.hrirs()?)),
        })
    }

    fn order_of_channels(&self) -> anyhow::Result<AmbisonicOrder> {
        Ok(AmbisonicOrder::new(self.ambisonic_order.unwrap_or(1)).map_err(Error::from)?)
    }

    fn hrirs(&self) -> anyhow::Result<HrirSet> {
        let Some(file) = &self.sofa else {
            return Err(BadInput("--format binaural needs --sofa FILE.sofa".into()).into());
        };
        let hrirs = HrirSet::read_sofa(file).map_err(Error::from)?;
        let at_rate = hrirs.at_rate(self.rate).map_err(ResponseError::from);
        Ok(at_rate.map_err(Error::from)?)
    }

    fn check(&self) -> anyhow::Result<()> {
        if let Some(file) = self.output.as_deref().filter(|file| !is_sofa(file)) {
            check_ending(file, "wav").map_err(|_| {
                let why = format!("{}: the name must end in .wav or .sofa", file.display());
                BadInput(why)
            })?;
        }
        let endings = [
            (&self.echogram, "csv"),
            (&self.csv, "csv"),
            (&self.plot, "svg"),
        ];
        for (file, ending) in endings {
            file.as_deref()
                .map_or(Ok(()), |file| check_ending(file, ending))?;
        }
        if let Some(order) = self.order {
            check_range(
                "--order",
                f64::from(order),
                0.0,
                f64::from(ResponseSettings::MAX_ORDER),
            )?;
        }
        if let Some(seconds) = self.seconds {
            check_range(
                "--seconds",
                seconds,
                SHORTEST_S,
                ImpulseSettings::MAX_SECONDS,
            )?;
        }
        let (least, most) = (
            *ImpulseSettings::RATES_HZ.start(),
            *ImpulseSettings::RATES_HZ.end(),
        );
        if let Some(order) = self.ambisonic_order {
            if self.format != FormatOption::Ambisonic {
                let why = "--ambisonic-order needs --format ambisonic";
                return Err(BadInput(why.into()).into());
            }
            let [least, most] =
                [AmbisonicOrder::FIRST, AmbisonicOrder::MOST].map(|order| order.number().into());
            check_range("--ambisonic-order", f64::from(order), least, most)?;
        }
        check_range(
            "--rate",
            f64::from(self.rate),
            f64::from(least),
            f64::from(most),
        )?;
        Ok(())
    }

    /// Checks the size of a SOFA file with this number of channels of all pairs, and responses of this length.
    fn check_sofa(&self, channels: usize, seconds: f64) -> Result<(), BadInput> {
        if !self.output.as_deref().is_some_and(is_sofa) {
            return Ok(());
        }
        let samples = channels as f64 * (seconds * f64::from(self.rate)).ceil();
        let limit = RoomMeasurement::MOST_SAMPLES;
        if samples <= limit as f64 {
            return Ok(());
        }
        Err(BadInput(format!(
            "a SOFA file has at most {limit} samples, but these responses have {samples}: choose fewer pairs or channels, a lower --rate or a shorter response"
        )))
    }

    /// Checks that all output files can be written.
    fn check_files(&self, names: &FileNames) -> anyhow::Result<()> {
        let is_common = self.output.as_deref().is_some_and(is_sofa);
        let (common, by_pair) = match is_common {
            true => (&self.output, &None),
            false => (&None, &self.output),
        };
        let of_pairs = [by_pair, &self.echogram, &self.plot];
        for given in of_pairs.into_iter().flatten() {
            names.all(given).try_for_each(|file| check_file(&file))?;
        }
        for file in [common, &self.csv].into_iter().flatten() {
            check_file(file)?;
        }
        Ok(())
    }
}

/// Whether a file has the ending of SOFA files.
fn is_sofa(file: &Path) -> bool {
    let ending = file.extension();
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case("sofa"))
}
