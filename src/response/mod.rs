//! The sound of a source at a listener: exact early paths, an echogram of all other arrivals, and figures.
//!
//! Waves are traced through the scene on the GPU, and every crossing of the listener's sphere is an [`Arrival`]. An
//! arrival after a few specular reflections and no scattering gives a sequence of surfaces. For each sequence the exact
//! path from point to point is computed ([`SpecularPath`]), and becomes a [`Tap`]. All other arrivals are added up in
//! an [`Echogram`]. Taps and echogram together give the [`Figures`] of ISO 3382-1 and the sampled [`ImpulseResponse`].
//! `docs/acoustics.md` describes the model, its sources and its limits.
//!
//! ```text
//!  crossings of the listener ─▶ Echogram ─┬─▶ Figures (ISO 3382-1), with their errors
//!  exact paths ───────────────▶ Tap … ────┴─▶ ImpulseResponse: mono, stereo, AmbiX, binaural
//!  SOFA files ────────────────▶ HrirSet ────────────────────────────────────────────┘
//! ```
//!
//! # Units
//! The source has power 1. Energies are energy densities at the listener times the speed of sound, in 1/m²: 1 / (4π r²)
//! for the direct sound at r metres. Times are seconds from the source's impulse, except in figures, whose times count
//! from the direct sound. Directions are directions of flight in world axes: they point away from the origin of the
//! sound.
//!
//! ```
//! use echomarch::response::{Echogram, Figures, Tap};
//! use echomarch::glam::DVec3;
//!
//! // The direct sound at 5 m, and a diffuse decay whose reverberation time is 1 s.
//! let direct_s = 5.0 / 343.0;
//! let direct = 1.0 / (4.0 * std::f64::consts::PI * 25.0);
//! let taps = [Tap { seconds: direct_s, energy: [direct; 8], direction: DVec3::X }];
//! let mut echogram = Echogram::with_edge_at(direct_s, 1e-3, 1)?;
//! for bin in 0..1000 {
//!     let late_s = (f64::from(bin) + 0.5) * 1e-3;
//!     let energy = 1e-4 * 10_f64.powf(-6.0 * late_s);
//!     echogram.add(0, direct_s + late_s, &[energy; 8], DVec3::ZERO)?;
//! }
//! let figures = Figures::new(&taps, &echogram, Some(direct_s), 1.0);
//! assert!((figures.bands[4].t30_s.unwrap() - 1.0).abs() < 1e-3);
//! # Ok::<(), echomarch::response::ResponseError>(())
//! ```

mod accuracy;
mod diagnosis;
mod diffraction;
mod duration;
mod early_part;
mod early_sound;
mod echogram;
mod effort;
mod error;
mod exact_paths;
mod figures;
mod from_arrivals;
mod hidden;
mod impulse_response;
#[cfg(any(feature = "audio", feature = "simulator"))]
mod keys;
mod late;
mod least_level;
mod notes;
mod omnidirectional_path;
#[cfg(feature = "sofa")]
mod room_sofa;
mod rounds;
mod settings;
mod shared;
mod source_sound;
#[cfg(test)]
mod tests;
mod transmission;

pub use crate::arrival::{Arrival, Tap};
pub use accuracy::Accuracy;
#[doc(hidden)]
pub use diagnosis::Gap;
pub use echogram::{Echogram, EchogramRow};
pub use error::ResponseError;
pub(crate) use error::check_taps;
#[doc(hidden)]
pub use figures::Precision;
pub use figures::{BandFigures, Figures};
pub(crate) use figures::{CommonErrors, Differences, Record, uncertain_energy};
#[cfg(feature = "simulator")]
pub(crate) use hidden::DirectWays;
#[doc(hidden)]
pub use hidden::diffracted;
#[cfg(feature = "audio")]
pub(crate) use impulse_response::tap_filter_gain;
pub use impulse_response::{
    AmbisonicOrder, Format, ImpulseResponse, ImpulseSettings, ListenerAxes,
};
#[cfg(any(feature = "audio", feature = "simulator"))]
pub(crate) use impulse_response::{Encoding, amplitude};
#[cfg(any(feature = "audio", feature = "simulator"))]
pub(crate) use keys::keys;
pub use notes::Note;
#[cfg(feature = "sofa")]
pub use room_sofa::RoomMeasurement;
#[doc(hidden)]
pub use rounds::Round;
pub use settings::ResponseSettings;
pub use source_sound::{HeardPath, Level, PathKind};

use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::scene::{IntoPair, Pair};
use crate::serialised::finite;
use crate::tracer::{ArrivalCounts, TraceError, Tracer};
use accuracy::Ended;
use early_sound::EarlySound;
pub use exact_paths::{Missed, SpecularPath};
use late::{Heard, LateSphere};
use serde::{Deserialize, Serialize};
use shared::Listeners;
use source_sound::Medium;

/// The sound of one source at one listener.
///
/// ```
/// use echomarch::gl::Context;
/// use echomarch::response::{Response, ResponseSettings};
/// use echomarch::{Scene, Tracer};
///
/// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
/// let mut scene = Scene::builtin("shoebox")?;
/// scene.surfaces[0].material = Some("brick".to_owned());
/// let settings = ResponseSettings::default().with_seconds(0.5);
/// let response = Response::trace(&mut tracer, &scene, &settings)?;
/// let direct = response.direct().expect("nothing is in the way");
/// assert!((direct.delay_s - direct.path.length_m / 343.0).abs() < 1e-9);
/// # Ok::<(), echomarch::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct Response {
    /// The exact early paths with energy, by length.
    pub paths: Vec<HeardPath>,
    /// The estimated early energy that the waves have missed.
    pub missed: Missed,
    /// Number of arrivals with few reflections whose paths were not searched for, because curved surfaces give too many
    /// paths, or the scene has too many surfaces. The echogram contains these arrivals.
    pub left_out: u64,
    /// The share of all energy in the `left_out` arrivals, 0 … 1, averaged over the bands.
    pub left_out_share: f64,
    /// The share, 0 … 1, of the 16,384 directions that the search for paths over planes left out, because the scene has
    /// too many surfaces in these directions. A path over planes in these directions is known only if waves find it.
    pub search_left_out_share: f64,
    /// Everything outside the exact paths: energy densities in 1/m² for a source of power 1, by
    /// time and band, including the source's level and the loss in the air.
    pub echogram: Echogram,
    /// Room acoustic figures by band.
    pub figures: Figures,
    /// End of the record, in seconds after the source's impulse.
    pub seconds: f64,
    /// Time in seconds until which the waves were followed. Present if more than one in a thousand waves was given up
    /// before the record's end: the figures are then valid until this time.
    #[serde(serialize_with = "finite")]
    pub followed_s: Option<f64>,
    /// Fates of the waves. If late arrivals are counted in a sphere larger than the listener, or with fewer waves,
    /// these are the fates of the waves for late arrivals. Pilot waves of importance sampling, and waves behind solids,
    /// are not counted. Waves that end after the onset are counted only at
    /// the step limit.
    pub counts: ArrivalCounts,
    /// Number of waves for late arrivals, including pilot waves.
    #[serde(default)]
    pub waves: u32,
    /// Number of waves of the onset: a sixth of the record, at least 80 ms, after the direct sound. With a requested accuracy it may exceed
    /// `waves` where surfaces scatter, because the early figures take more waves than the late decay. Otherwise it is
    /// `waves`.
    #[serde(default)]
    pub onset_waves: u32,
    /// The requested accuracy ([`Accuracy::share`]); `None` without one.
    #[serde(default)]
    pub accuracy: Option<f64>,
    /// Why no further round followed; `None` without a requested accuracy.
    #[serde(default)]
    pub(crate) ended: Option<Ended>,
    /// Whether diffraction was asked for. `false` with [`Profile::Thesis`](crate::tracer::Profile::Thesis), which has none.
    #[serde(default)]
    pub diffraction: bool,
    /// Time in milliseconds, including the compilation of new shaders. Listeners that share waves share their time in equal
    /// parts.
    pub milliseconds: f64,
    /// Time in milliseconds that diffraction took for this listener, in the last search of its paths. It hardly depends on
    /// the number of waves, and is not shared with other listeners. 0 without diffraction.
    pub diffraction_milliseconds: f64,
}

impl Response {
    /// Traces the sound of a pair, or of a scene with exactly one source and one listener, in the scene's current
    /// state.
    ///
    /// # Errors
    /// The errors of [`Tracer::arrivals`], and [`Error::Acoustics`] for bins out of range.
    pub fn trace<'a>(
        tracer: &mut Tracer,
        pair: impl IntoPair<'a>,
        settings: &ResponseSettings,
    ) -> Result<Response, Error> {
        Response::trace_observed(tracer, pair, settings, &mut |_| ())
    }

    /// Like [`Response::trace`]; `observe` receives each round of a response with a requested accuracy.
    ///
    /// # Errors
    /// The errors of [`Response::trace`].
    #[doc(hidden)]
    pub fn trace_observed<'a>(
        tracer: &mut Tracer,
        pair: impl IntoPair<'a>,
        settings: &ResponseSettings,
        observe: &mut dyn FnMut(Round),
    ) -> Result<Response, Error> {
        let pair = pair.chosen()?;
        let mut responses = Response::trace_pairs_observed(tracer, &[pair], settings, observe)?;
        Ok(responses.remove(0))
    }

    /// Traces the sound of several pairs. The listeners of one source share its waves, which takes less time
    /// than a trace for each. Each response has the accuracy that it would have alone, but other random numbers.
    /// `milliseconds` is the time of all pairs with the same source.
    ///
    /// ```
    /// use echomarch::gl::Context;
    /// use echomarch::response::{Response, ResponseSettings};
    /// use echomarch::{Listener, Scene, Tracer};
    ///
    /// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let mut scene = Scene::builtin("shoebox")?;
    /// scene.listeners.push(Listener::at([0.0, 0.2, 1.0], 0.3));
    /// let pairs = [scene.pair(0, 0)?, scene.pair(0, 1)?];
    /// let settings = ResponseSettings::default().with_seconds(0.3);
    /// let responses = Response::trace_pairs(&mut tracer, &pairs, &settings)?;
    /// assert_eq!(responses.len(), 2);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Response::trace`].
    pub fn trace_pairs(
        tracer: &mut Tracer,
        pairs: &[Pair],
        settings: &ResponseSettings,
    ) -> Result<Vec<Response>, Error> {
        Response::trace_pairs_observed(tracer, pairs, settings, &mut |_| ())
    }

    /// Like [`Response::trace_pairs`]; `observe` receives each round of responses with a requested accuracy.
    ///
    /// # Errors
    /// The errors of [`Response::trace`].
    #[doc(hidden)]
    pub fn trace_pairs_observed(
        tracer: &mut Tracer,
        pairs: &[Pair],
        settings: &ResponseSettings,
        observe: &mut dyn FnMut(Round),
    ) -> Result<Vec<Response>, Error> {
        settings.validate()?;
        let mut responses: Vec<Option<Response>> = vec![None; pairs.len()];
        for indices in shared::groups(pairs, tracer.most_detectors()) {
            let mut of = |indices: &[usize]| {
                let listeners = Listeners::new(indices.iter().map(|index| pairs[*index]), settings);
                match &settings.accuracy {
                    Some(accuracy) => rounds::trace(tracer, listeners, settings, accuracy, observe),
                    None => listeners.trace_once(tracer, settings),
                }
            };
            let traced = match of(&indices) {
                // The detectors of several listeners take more uniforms than those of one.
                Err(Error::Trace(TraceError::TooManySurfaces { .. })) if indices.len() > 1 => {
                    let alone = indices.iter().map(|index| of(&[*index]));
                    alone.collect::<Result<Vec<_>, Error>>()?.concat()
                }
                traced => traced?,
            };
            for (index, response) in indices.into_iter().zip(traced) {
                responses[index] = Some(response);
            }
        }
        // Each pair is in one of the groups.
        Ok(responses.into_iter().flatten().collect())
    }

    /// The paths of a pair that are found without waves, and therefore without a renderer: the direct sound, reflections at
    /// planes, paths around and through obstacles, and the path that the least level adds. The settings need a length.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`](crate::Scene::validate), and [`Error::Acoustics`] for bins out of range.
    #[doc(hidden)]
    pub fn without_waves<'a>(
        pair: impl IntoPair<'a>,
        settings: &ResponseSettings,
    ) -> Result<Response, Error> {
        let pair = pair.chosen()?;
        settings.validate()?;
        let medium = &Medium::of(pair);
        let late = LateSphere::own(pair.listener);
        let heard = Heard { pair, medium, late };
        let seconds = settings.seconds.unwrap_or(settings.longest_s);
        let early = EarlySound::find(&heard, settings, seconds, (Vec::new(), Vec::new()))?;
        let mut response = early.alone(medium, settings, seconds)?;
        least_level::raise(&mut response, pair, medium, settings);
        Ok(response)
    }

    /// The direct sound; `None` if it is obstructed.
    pub fn direct(&self) -> Option<&HeardPath> {
        direct(&self.paths)
    }

    /// The exact paths as taps of an impulse response.
    pub fn taps(&self) -> Vec<Tap> {
        self.paths.iter().map(HeardPath::tap).collect()
    }

    /// Reasons for missing figures, by band. `pair` is the pair whose sound was traced.
    #[doc(hidden)]
    pub fn gaps(&self, pair: Pair) -> [Option<Gap>; BAND_COUNT] {
        let energy = self.energy();
        let in_solid = notes::silence::end_in_solid(pair).map(|_| Gap::InSolid);
        std::array::from_fn(|band| {
            let gap = Gap::of(&self.figures, band, energy[band] > 0.0);
            match gap {
                Some(Gap::Silence) => in_solid.or(gap),
                _ => gap,
            }
        })
    }

    /// The energy density of all arrivals, by band, in 1/m².
    pub fn energy(&self) -> Bands {
        energy(&self.echogram, &self.paths)
    }
}

/// The energy density of all arrivals, by band, in 1/m².
fn energy(echogram: &Echogram, paths: &[HeardPath]) -> Bands {
    let mut energy = echogram.total();
    for path in paths {
        bands::add(&mut energy, &path.energy);
    }
    energy
}

fn direct(paths: &[HeardPath]) -> Option<&HeardPath> {
    paths.iter().find(|path| path.is_direct())
}

/// The exact paths as taps of an echogram, for figures.
fn taps_of_energy(paths: &[HeardPath]) -> Vec<Tap> {
    paths.iter().map(HeardPath::tap_of_energy).collect()
}
