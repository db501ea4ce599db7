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
mod echogram;
mod error;
mod exact_paths;
mod figures;
mod heard_source;
mod hidden;
mod impulse_response;
mod late;
mod least_level;
mod omnidirectional_path;
mod rounds;
mod settings;
mod source_sound;
#[cfg(test)]
mod tests;
mod transmission;

pub use crate::arrival::{Arrival, Tap};
pub use accuracy::Accuracy;
#[doc(hidden)]
pub use diagnosis::{Flutter, Gap, flutters};
pub use echogram::{Echogram, EchogramRow};
pub use error::ResponseError;
pub(crate) use error::check_taps;
pub use figures::{BandFigures, Figures};
pub(crate) use figures::{CommonErrors, Differences, Record, uncertain_energy};
#[doc(hidden)]
pub use figures::{Precision, Withheld};
pub use heard_source::{HeardKind, HeardSource};
#[doc(hidden)]
pub use hidden::diffracted;
pub(crate) use impulse_response::{Encoding, amplitude, tap_filter_gain};
pub use impulse_response::{Format, ImpulseResponse, ImpulseSettings, ListenerAxes};
#[doc(hidden)]
pub use rounds::Round;
pub use settings::ResponseSettings;
pub use source_sound::{HeardPath, Level, PathKind};

use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::platform::Instant;
use crate::scene::{IntoPair, Pair};
use crate::serialised::finite;
use crate::tracer::{ArrivalCounts, ArrivalSettings, Settings, Tracer};
use early_part::{Caught, EarlyPart, Search};
use exact_paths::EarlyPaths;
pub use exact_paths::{Missed, SpecularPath};
use glam::Vec3;
use hidden::Hidden;
use late::{Arrivals, LateSphere};
use serde::{Deserialize, Serialize};
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
    /// are not counted.
    pub counts: ArrivalCounts,
    /// Number of waves for late arrivals, including pilot waves.
    #[serde(default)]
    pub waves: u32,
    /// Total time in milliseconds, including the compilation of new shaders.
    pub milliseconds: f64,
    /// The part of `milliseconds` that diffraction took. It hardly depends on the number of waves. 0 without
    /// diffraction.
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
        match &settings.accuracy {
            Some(accuracy) => rounds::trace(tracer, pair, settings, accuracy, observe),
            None => Response::of_pair(tracer, pair, settings),
        }
    }

    /// The response of the given number of waves.
    fn of_pair(
        tracer: &mut Tracer,
        pair: Pair,
        settings: &ResponseSettings,
    ) -> Result<Response, Error> {
        let began = Instant::now();
        let seconds = settings.seconds_needed(tracer, pair)?;
        let late = LateSphere::of(pair, settings.order_in(pair.scene));
        let in_sphere = |tracer: &mut Tracer, late: LateSphere| {
            Response::in_sphere(tracer, pair, settings, seconds, late)
        };
        let (mut response, is_biased) = in_sphere(tracer, late)?;
        if is_biased {
            (response, _) = in_sphere(tracer, LateSphere::own(pair.listener))?;
        }
        response.milliseconds = began.elapsed().as_secs_f64() * 1e3;
        Ok(response)
    }

    /// The response with late arrivals counted in this sphere, and whether the figures are biased by its size.
    fn in_sphere(
        tracer: &mut Tracer,
        pair: Pair,
        settings: &ResponseSettings,
        seconds: f64,
        late: LateSphere,
    ) -> Result<(Response, bool), Error> {
        let order = settings.order_in(pair.scene);
        let medium = Medium::of(pair);
        // Bins begin at the earliest possible arrival, so that the times 50 and 80 ms after this arrival lie on edges
        // of bins.
        let first_s = medium.direct_s;
        let echogram = Echogram::with_edge_at(first_s, settings.bin_s, settings.batches)?;
        let how = ArrivalSettings::new(seconds).with_early_order(order);
        let Arrivals {
            mut echogram,
            bias,
            counts,
            early,
            straight,
            inner,
            travel_on,
        } = late::arrivals(tracer, (pair, &medium, late), settings, &how, echogram)?;
        let starts = start_directions(tracer, &settings.trace, &early)?;
        let early_paths = EarlyPaths::new(pair)?;
        let search = Search {
            pair,
            paths: &early_paths,
            waves: settings.trace.waves,
            order,
            diffracts: settings.diffracts(),
        };
        let part = EarlyPart::find(&search, &starts, early);
        let all_paths = part.heard(pair, &medium);
        let is_hidden = direct(&all_paths).is_none();
        let mut paths = all_paths.clone();
        let hidden = Hidden::find(
            (pair, &medium, &early_paths),
            settings,
            part.hidden_reflections(),
            &mut paths,
        );
        // Diffracted paths replace the waves that pass an edge and reach a part of the listener's sphere.
        let is_replaced = |arrival: &Arrival| arrival.reflections == 0 && hidden.is_bent();
        part.left_over(|reflection| hidden.is_reflection_bent(reflection))
            .filter(|arrival| !is_replaced(arrival))
            .for_each(|arrival| medium.add(&mut echogram, arrival));
        // An exact path replaces the waves that pass solids in a straight line.
        if is_hidden && !hidden.replaces_straight_waves() {
            echogram.add_scaled(&straight, &[1.0; BAND_COUNT]);
        }
        let diffraction_milliseconds = hidden.diffraction_milliseconds();
        let further_reflections = hidden.further_reflections();
        paths.extend(hidden.into_paths());
        paths.sort_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
        let is_heard = |path: &HeardPath| path.energy.iter().any(|energy| *energy > 0.0);
        paths.retain(|path| path.delay_s <= seconds && is_heard(path));
        // If waves were given up, only the remaining waves contribute to the later decay.
        let followed_s = Some(counts.followed_m / medium.speed).filter(|until| *until < seconds);
        let ends_s = followed_s.unwrap_or(seconds);
        let taps = taps(&paths);
        let direct_s = direct(&paths).map(|path| path.delay_s);
        let mut figures = Figures::new(&taps, &echogram, direct_s, ends_s);
        if let Some(common) = late.errors {
            figures = figures.with_common_errors(&common);
        }
        let record = Record::new(&taps, &echogram, ends_s);
        let in_inner = inner.map(|inner| inner.of_figures(&record, direct_s));
        if let Some(differences) = &in_inner {
            figures = figures.with_bias(differences);
        }
        if !further_reflections.is_empty() {
            let all = [&taps[..], &further_reflections].concat();
            figures = figures.with_differences(Record::new(&all, &echogram, ends_s), &bands::ALL);
        }
        // The bias is empty without scattering.
        if bias.bins() > 0 {
            let mut biased = echogram.clone();
            biased.add_scaled(&bias, &bands::ALL);
            figures = figures.with_differences(Record::new(&taps, &biased, ends_s), &bands::ALL);
        }
        let caught = Caught {
            pair,
            medium: &medium,
            part: &part,
            paths: &all_paths,
        };
        let figures = caught.in_errors(figures, &echogram, ends_s);
        let heard_in = (pair, &medium);
        let further =
            late::further_arrival(tracer, heard_in, settings, &how, &echogram, travel_on)?;
        let figures = figures.with_further_arrival(Record::new(&taps, &echogram, ends_s), &further);
        let mut response = Response {
            missed: part.missed(),
            left_out: part.left_out().count() as u64,
            left_out_share: left_out_share(&part, &medium, &paths, &echogram),
            search_left_out_share: part.search_left_out_share(),
            paths,
            echogram,
            figures,
            seconds,
            followed_s,
            counts,
            waves: settings.late_trace().waves,
            milliseconds: 0.0,
            diffraction_milliseconds,
        };
        if let Some(least_db) = settings.least_level_db {
            least_level::raise(&mut response, pair, &medium, least_db);
        }
        Ok((
            response,
            in_inner.is_some_and(|in_inner| late::are_biased(&in_inner)),
        ))
    }

    /// The direct sound; `None` if it is obstructed.
    pub fn direct(&self) -> Option<&HeardPath> {
        direct(&self.paths)
    }

    /// The exact paths as taps of an impulse response.
    pub fn taps(&self) -> Vec<Tap> {
        taps(&self.paths)
    }

    /// Reasons for missing figures, by band.
    #[doc(hidden)]
    pub fn gaps(&self) -> [Option<Gap>; BAND_COUNT] {
        let energy = self.energy();
        std::array::from_fn(|band| Gap::of(&self.figures, band, energy[band] > 0.0))
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

/// The energy share of arrivals whose paths were not searched for.
fn left_out_share(
    part: &EarlyPart,
    medium: &Medium,
    paths: &[HeardPath],
    echogram: &Echogram,
) -> f64 {
    let left_out: f64 = part.left_out().map(|a| bands::mean(&medium.heard(a))).sum();
    if left_out > 0.0 {
        left_out / bands::mean(&energy(echogram, paths))
    } else {
        0.0
    }
}

fn taps(paths: &[HeardPath]) -> Vec<Tap> {
    paths.iter().map(HeardPath::tap).collect()
}

/// The waves that arrived early, each once, in order of number, with their start directions.
fn start_directions(
    tracer: &mut Tracer,
    settings: &Settings,
    early: &[Arrival],
) -> Result<Vec<(u32, Vec3)>, Error> {
    if early.is_empty() {
        return Ok(Vec::new());
    }
    let mut waves: Vec<u32> = early.iter().map(|arrival| arrival.wave).collect();
    waves.dedup();
    let all = tracer.start_directions(settings)?;
    let start = |wave: u32| (wave, all[wave as usize]);
    Ok(waves.into_iter().map(start).collect())
}
