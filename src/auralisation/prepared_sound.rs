//! The sound of a source at the listener at one moment, prepared for playback.

use super::convolution::Kernel;
use super::delay_line::REACH;
use super::{CHANNELS, Spec};
use crate::bands::{self, BAND_COUNT};
use crate::response::{
    self, Encoding, Format, HeardPath, ImpulseResponse, ImpulseSettings, ListenerAxes, Response,
    ResponseError, Tap, amplitude, check_taps,
};

/// One of the strongest paths, as an echo.
#[derive(Clone, Copy, Debug)]
pub(super) struct Echo {
    /// The key of the path. It stays the same over time for a path over the same surfaces.
    pub key: u64,
    /// Samples from the source to the ear.
    pub delay: f64,
    gains: [f32; CHANNELS],
    bands: [f32; BAND_COUNT],
    /// The square root of the mean energy of the bands.
    mean: f32,
}

impl Echo {
    pub fn new(tap: &Tap, key: u64, axes: &ListenerAxes, spec: Spec) -> Echo {
        let gains = Encoding::Stereo.gains(axes, -tap.direction);
        Echo {
            key,
            delay: tap.seconds * f64::from(spec.rate_hz),
            gains: std::array::from_fn(|channel| gains[channel] as f32),
            bands: tap.energy.map(|energy| amplitude(energy) as f32),
            mean: amplitude(bands::mean(&tap.energy)) as f32,
        }
    }

    /// Amplitudes by band and channel. If there is a single band, it has the mean amplitude.
    pub fn amplitudes<const BANDS: usize>(&self) -> [[f32; BANDS]; CHANNELS] {
        self.gains.map(|gain| match BANDS {
            BAND_COUNT => std::array::from_fn(|band| gain * self.bands[band]),
            _ => [gain * self.mean; BANDS],
        })
    }
}

/// The sound of a source at the listener, prepared on a different thread from the thread that plays it: the strongest
/// paths as single echoes, everything else as a kernel to convolve with.
#[derive(Debug)]
pub struct Heard {
    pub(super) echoes: Vec<Echo>,
    pub(super) late: Option<Kernel>,
    /// The format of its samples; `None` for silence, which fits every player.
    pub(super) spec: Option<Spec>,
}

impl Heard {
    /// Maximum number of single echoes per source: the strongest paths. All other paths are in the late part, where
    /// their delays do not glide. A room has 63 paths of up to three reflections.
    pub const MOST_ECHOES: usize = 64;

    /// Prepares a response for a listener with these axes. The late part is noise from `seed`. With the same seed, the
    /// noise changes only as much as the echogram does.
    ///
    /// # Errors
    /// [`ResponseError::BadLength`] for a response of length 0 or longer than
    /// [`ImpulseSettings::MAX_SECONDS`](crate::response::ImpulseSettings::MAX_SECONDS), and the errors of
    /// [`of_paths`](Heard::of_paths).
    pub fn new(
        response: &Response,
        axes: &ListenerAxes,
        spec: Spec,
        seed: u64,
    ) -> Result<Heard, ResponseError> {
        let mut heard = Heard::of_paths(&response.paths, axes, spec)?;
        let late = Heard::late_samples(response, axes, spec, seed)?;
        heard.late = Heard::of_late(&late, spec).late;
        Ok(heard)
    }

    /// The samples of all sound except the single echoes, by channel.
    fn late_samples(
        response: &Response,
        axes: &ListenerAxes,
        spec: Spec,
        seed: u64,
    ) -> Result<Vec<Vec<f32>>, ResponseError> {
        let rest: Vec<Tap> = faint(&response.paths, spec).map(HeardPath::tap).collect();
        let settings = ImpulseSettings {
            rate_hz: spec.rate_hz,
            seconds: response.seconds.min(spec.longest_s),
            format: Format::Stereo,
            seed,
        };
        let late = ImpulseResponse::new(&rest, &response.echogram, axes, &settings)?;
        Ok(late.channels().to_vec())
    }

    /// Prepares the paths only, for a player whose late part stays unchanged.
    ///
    /// # Errors
    /// [`ResponseError::BadRate`] and [`ResponseError::BadLength`] for numbers that
    /// [`Auralisation`](super::Auralisation) rejects, [`ResponseError::BadTap`] for a path with an invalid delay,
    /// energy or direction.
    pub fn of_paths(
        paths: &[HeardPath],
        axes: &ListenerAxes,
        spec: Spec,
    ) -> Result<Heard, ResponseError> {
        spec.validate()?;
        let taps: Vec<Tap> = paths.iter().map(HeardPath::tap).collect();
        check_taps(&taps)?;
        let (near, _) = by_energy(paths, spec);
        let keys = response::keys(&near, u64::from);
        let echo = |(path, key): (&&HeardPath, u64)| Echo::new(&path.tap(), key, axes, spec);
        let strongest = near.iter().zip(keys).take(Heard::MOST_ECHOES);
        Ok(Heard {
            echoes: strongest.map(echo).collect(),
            late: None,
            spec: Some(spec),
        })
    }

    /// Prepares a late part without echoes.
    pub(super) fn of_late(channels: &[Vec<f32>], spec: Spec) -> Heard {
        Heard {
            echoes: Vec::new(),
            late: Some(kernel(channels, spec)),
            spec: Some(spec),
        }
    }

    /// Silence: everything fades out.
    pub fn silence() -> Heard {
        Heard {
            echoes: Vec::new(),
            late: Some(Kernel::default()),
            spec: None,
        }
    }

    /// Number of single echoes.
    pub fn echo_count(&self) -> usize {
        self.echoes.len()
    }
}

/// Creates a kernel from samples, delayed like the echoes. Samples that are not finite become 0.
fn kernel(channels: &[Vec<f32>], spec: Spec) -> Kernel {
    let delayed = |samples: &Vec<f32>| {
        let mut delayed = vec![0.0; spec.filter_delay() + REACH];
        let or_silent = |sample: &f32| if sample.is_finite() { *sample } else { 0.0 };
        delayed.extend(samples.iter().map(or_silent));
        delayed
    };
    Kernel::new(&channels.iter().map(delayed).collect::<Vec<_>>())
}

/// The paths in the order of their energy, split into the paths that become single echoes and the remaining paths.
fn by_energy(paths: &[HeardPath], spec: Spec) -> (Vec<&HeardPath>, Vec<&HeardPath>) {
    let (mut near, far): (Vec<_>, Vec<_>) = paths
        .iter()
        .partition(|path| path.delay_s <= spec.longest_s);
    near.sort_by(|a, b| bands::mean(&b.energy).total_cmp(&bands::mean(&a.energy)));
    (near, far)
}

fn faint(paths: &[HeardPath], spec: Spec) -> impl Iterator<Item = &HeardPath> {
    let (near, far) = by_energy(paths, spec);
    near.into_iter().skip(Heard::MOST_ECHOES).chain(far)
}

/// A [`Heard`] as plain numbers, for a player that shares no memory with the tracing thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeardParts {
    /// `HeardParts::ECHO` numbers for each single echo.
    pub echoes: Vec<f64>,
    /// The samples of the late part, one channel after the other; `None` if the late part stays unchanged.
    pub late: Option<Vec<f32>>,
}

impl HeardParts {
    /// Numbers per echo: its key in two halves, its delay, its gains by channel, its amplitudes by band, and their
    /// mean.
    const ECHO: usize = 2 + 1 + CHANNELS + BAND_COUNT + 1;

    /// Bits of half a key, which a float holds exactly.
    const HALF: u32 = 32;

    /// Prepares a response, and its late part only if `seed` is given.
    ///
    /// # Errors
    /// The errors of [`Heard::new`].
    pub fn new(
        response: &Response,
        axes: &ListenerAxes,
        spec: Spec,
        seed: Option<u64>,
    ) -> Result<HeardParts, ResponseError> {
        let heard = Heard::of_paths(&response.paths, axes, spec)?;
        let late = seed.map(|seed| Heard::late_samples(response, axes, spec, seed));
        Ok(HeardParts {
            echoes: heard.echoes.iter().flat_map(Echo::numbers).collect(),
            late: late.transpose()?.map(|channels| channels.concat()),
        })
    }

    /// Converts the numbers back for playback. Ignores an incomplete last echo, and invalid echoes: echoes whose delay
    /// is negative or beyond the player's length, or whose numbers are not finite.
    pub fn heard(&self, spec: Spec) -> Heard {
        let channels = |samples: &Vec<f32>| {
            let length = samples.len() / CHANNELS;
            let channel = |index: usize| samples[index * length..(index + 1) * length].to_vec();
            kernel(&(0..CHANNELS).map(channel).collect::<Vec<_>>(), spec)
        };
        Heard {
            echoes: self
                .echoes
                .chunks_exact(Self::ECHO)
                .map(Echo::of)
                .filter(|echo| echo.is_heard(spec))
                .collect(),
            late: self.late.as_ref().map(channels),
            spec: Some(spec),
        }
    }
}

impl Echo {
    fn numbers(&self) -> Vec<f64> {
        let low = self.key & u64::from(u32::MAX);
        let mut numbers = vec![
            (self.key >> HeardParts::HALF) as f64,
            low as f64,
            self.delay,
        ];
        numbers.extend(self.gains.iter().chain(&self.bands).map(|n| f64::from(*n)));
        numbers.push(f64::from(self.mean));
        numbers
    }

    fn is_heard(&self, spec: Spec) -> bool {
        let numbers = self.gains.iter().chain(&self.bands);
        let are_finite = numbers.chain([&self.mean]).all(|number| number.is_finite());
        are_finite && (0.0..=spec.longest() as f64).contains(&self.delay)
    }

    /// Reads an echo from its `HeardParts::ECHO` numbers.
    fn of(numbers: &[f64]) -> Echo {
        let floats = |first: usize| move |index: usize| numbers[first + index] as f32;
        Echo {
            key: (numbers[0] as u64) << HeardParts::HALF | numbers[1] as u64,
            delay: numbers[2],
            gains: std::array::from_fn(floats(3)),
            bands: std::array::from_fn(floats(3 + CHANNELS)),
            mean: numbers[3 + CHANNELS + BAND_COUNT] as f32,
        }
    }
}
