//! Responses: traced on the thread of the context, kept as plain data.

use crate::errors;
use crate::scene::Scene;
use crate::worker::{self, Observer};
use echomarch::bands::{BAND_COUNT, BANDS_HZ};
use echomarch::hrtf::HrirSet;
use echomarch::response::{
    Accuracy, AmbisonicOrder, BandFigures, Figures, Format, ImpulseResponse, ImpulseSettings,
    ListenerAxes, Response, ResponseError, ResponseSettings, RoomMeasurement, Round,
};
use echomarch::scene::Pair;
use echomarch::tracer::{Algorithm, Directions, Profile, Settings};
use echomarch::{Error, Tracer};
use glam::{DVec3, Vec3};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// The names of the figures, in the order of their columns.
pub fn figure_names() -> Vec<&'static str> {
    BandFigures::NAMES.to_vec()
}

/// A response with the properties of its scene that its results need.
#[pyclass(module = "echomarch._echomarch", frozen)]
#[derive(Clone, Serialize, Deserialize)]
pub struct Heard {
    response: Response,
    scene: String,
    renderer: String,
    source: String,
    listener: String,
    source_position: [f32; 3],
    /// The viewing direction and the upward direction of the source, world axes.
    source_view: [DVec3; 2],
    listener_position: [f32; 3],
    /// The viewing direction and the upward direction of the listener, world axes.
    listener_view: [DVec3; 2],
    speed_of_sound: f64,
    seed: u32,
    /// The names of the surfaces that reflect each path, with the walls of rooms and the groups of meshes.
    surfaces: Vec<Vec<String>>,
    /// Why figures are missing or inexact, and whether each of the texts is a warning.
    notes: Vec<(String, bool)>,
    /// Why figures of each band are missing.
    gaps: Vec<Option<String>>,
}

/// A round of responses with a requested accuracy.
struct Progress {
    /// Number of listeners whose responses are complete after this round.
    finished: usize,
    waves: u32,
    next_waves: Option<u32>,
    /// Number of figures that have the accuracy, and number of figures that are defined.
    accurate: usize,
    defined: usize,
}

impl Progress {
    fn of(round: &Round, accuracy: f64) -> Progress {
        let count = BandFigures::NAMES.len();
        let all = (0..BAND_COUNT).flat_map(|band| (0..count).map(move |figure| (band, figure)));
        let of_response = |response: &Response| {
            let figures = response.figures;
            all.clone()
                .filter_map(move |(band, figure)| figures.is_accurate(accuracy, band, figure))
        };
        let defined: Vec<bool> = round.responses.iter().flat_map(of_response).collect();
        let waves = round.responses.iter().map(|one| one.onset_waves);
        Progress {
            finished: round.finished,
            waves: waves.max().unwrap_or(0),
            next_waves: round.next_waves,
            accurate: defined.iter().filter(|is_accurate| **is_accurate).count(),
            defined: defined.len(),
        }
    }
}

/// The settings that the package passes by name.
fn settings(given: &Bound<PyDict>) -> PyResult<ResponseSettings> {
    let mut settings = ResponseSettings::default();
    let mut trace = Settings::default();
    let (mut accuracy, mut waves, mut limit_s) = (None, None, None);
    for (name, value) in given {
        match name.extract::<String>()?.as_str() {
            "profile" => {
                let profile: Profile = value.extract::<String>()?.parse().map_err(of_text)?;
                let Settings {
                    seed, directions, ..
                } = trace;
                trace = Settings::new(Algorithm::of(profile));
                trace = trace.with_seed(seed).with_directions(directions);
            }
            "seed" => trace.seed = value.extract()?,
            "directions" => {
                trace.directions = value
                    .extract::<String>()?
                    .parse::<Directions>()
                    .map_err(of_text)?;
            }
            "accuracy" => accuracy = value.extract::<Option<f64>>()?,
            "waves" => waves = value.extract::<Option<u32>>()?,
            "time_limit" => limit_s = value.extract::<Option<f64>>()?,
            "order" => settings.order = value.extract()?,
            "seconds" => settings.seconds = value.extract()?,
            "diffraction" => settings.diffraction = value.extract()?,
            "transmission" => settings.transmission = value.extract()?,
            "bin_s" => settings.bin_s = value.extract()?,
            other => return Err(errors::settings(format!("there is no setting {other:?}"))),
        }
    }
    match accuracy {
        Some(share) => {
            let mut wanted = Accuracy::new(share);
            wanted.most_waves = waves;
            wanted.time_limit_s = limit_s;
            settings.accuracy = Some(wanted);
        }
        None => trace.waves = waves.unwrap_or(trace.waves),
    }
    let settings = settings.with_trace(trace);
    settings.validate().map_err(errors::from)?;
    Ok(settings)
}

fn of_text(error: impl Into<Error>) -> PyErr {
    errors::from(error)
}

/// Traces the responses of a source at several listeners, given by their indices. One trace of the source serves all
/// listeners. `progress` receives the number of listeners that each round completes, the number of waves of the round
/// and of the next round, the number of accurate figures, and the number of defined figures.
#[pyfunction]
pub fn responses(
    py: Python,
    scene: &Scene,
    source: usize,
    listeners: Vec<usize>,
    given: &Bound<PyDict>,
    progress: Option<Bound<PyAny>>,
) -> PyResult<Vec<Heard>> {
    let settings = settings(given)?;
    for listener in &listeners {
        scene.pair(source, *listener)?;
    }
    let share = settings.accuracy.map(|accuracy| accuracy.share);
    let scene = scene.inner.clone();
    let job = move |tracer: &mut Tracer, observer: &Observer<Progress>| {
        let pairs = listeners.iter();
        let pairs = pairs.map(|listener| scene.pair(source, *listener));
        let pairs = pairs.collect::<Result<Vec<Pair>, _>>()?;
        let mut observe =
            |round: Round| observer.report(Progress::of(&round, share.unwrap_or_default()));
        let traced = Response::trace_pairs_observed(tracer, &pairs, &settings, &mut observe)?;
        let heard = pairs.into_iter().zip(traced);
        let heard = heard.map(|(pair, response)| Heard::new(pair, response, tracer, &settings));
        Ok(heard.collect())
    };
    worker::run(py, job, |round| match &progress {
        Some(call) => {
            let Progress {
                finished,
                waves,
                next_waves,
                accurate,
                defined,
            } = round;
            let numbers = (finished, waves, next_waves, accurate, defined);
            call.call1(numbers).map(drop)
        }
        None => Ok(()),
    })
}

impl Heard {
    fn new(pair: Pair, response: Response, tracer: &Tracer, settings: &ResponseSettings) -> Heard {
        let (scene, source, listener) = (pair.scene(), pair.source(), pair.listener());
        let (source_index, listener_index) = pair.indices();
        let notes = response.notes(pair).into_iter();
        let gaps = response.gaps(pair).into_iter();
        Heard {
            notes: notes.map(|n| (n.to_string(), n.is_warning)).collect(),
            gaps: gaps
                .map(|gap| gap.map(|gap| gap.words().to_owned()))
                .collect(),
            surfaces: names(scene, &response),
            scene: scene.name.clone(),
            renderer: tracer.context().renderer().to_owned(),
            source: scene.source_labels().swap_remove(source_index),
            listener: scene.listener_labels().swap_remove(listener_index),
            source_position: source.position.to_array(),
            source_view: [source.forward(), source.up()].map(|v| v.as_dvec3()),
            listener_position: listener.position.to_array(),
            listener_view: [listener.forward(), listener.up()].map(|v| v.as_dvec3()),
            speed_of_sound: scene.speed_of_sound(),
            seed: settings.trace.seed,
            response,
        }
    }
}

/// The axes with a viewing direction and an upward direction.
fn axes([forward, up]: [DVec3; 2]) -> PyResult<ListenerAxes> {
    ListenerAxes::new(forward, up).map_err(errors::from)
}

/// The names of the surfaces on each path, with the walls of rooms and the groups of meshes.
fn names(scene: &echomarch::Scene, response: &Response) -> Vec<Vec<String>> {
    let paths = response.paths.iter();
    let of_path = paths.map(|heard| heard.path.surface_labels(scene));
    of_path.collect()
}

/// A missing number as NaN.
fn or_nan(number: Option<f64>) -> f64 {
    number.unwrap_or(f64::NAN)
}

/// A matrix from its rows.
fn matrix<'py>(py: Python<'py>, rows: Vec<Vec<f64>>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray2::from_vec2(py, &rows).map_err(|error| errors::internal(error.to_string()))
}

#[pymethods]
impl Heard {
    /// The figures by band: 8 rows, one column for each figure. NaN where a figure is missing.
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.response.figures.bands.iter();
        matrix(
            py,
            rows.map(|band| band.list().map(or_nan).to_vec()).collect(),
        )
    }

    /// The standard errors of the figures, in the same form.
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.response.figures.errors.iter();
        matrix(
            py,
            rows.map(|band| band.list().map(or_nan).to_vec()).collect(),
        )
    }

    /// The times of the echogram's bins in seconds (their middles).
    fn bin_times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let echogram = &self.response.echogram;
        let middle = |bin: usize| echogram.first_s() + (bin as f64 + 0.5) * echogram.bin_s();
        PyArray1::from_vec(py, (0..echogram.bins()).map(middle).collect())
    }

    /// The energy of each bin and band in 1/m².
    fn bin_energies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let echogram = &self.response.echogram;
        let rows: Vec<Vec<f64>> = (0..echogram.bins())
            .map(|bin| echogram.energy(bin).to_vec())
            .collect();
        match rows.is_empty() {
            true => Ok(PyArray2::zeros(py, [0, BAND_COUNT], false)),
            false => matrix(py, rows),
        }
    }

    /// Energy × direction of flight of each bin and band in 1/m², world axes.
    fn bin_flows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let echogram = &self.response.echogram;
        let bins = 0..echogram.bins();
        let all = bins
            .flat_map(|bin| echogram.flow(bin))
            .flat_map(|flow| flow.to_array());
        let all: Vec<f64> = all.collect();
        PyArray1::from_vec(py, all).reshape([echogram.bins(), BAND_COUNT, 3])
    }

    #[getter]
    fn bin_s(&self) -> f64 {
        self.response.echogram.bin_s()
    }

    /// The exact paths: one tuple for each path. Samples come from `ir`: those of paths around the same obstacle interfere,
    /// and have another energy.
    #[expect(clippy::type_complexity, reason = "the package gives the tuples names")]
    fn paths(
        &self,
    ) -> Vec<(
        &'static str,
        usize,
        f64,
        f64,
        [f64; BAND_COUNT],
        [f64; BAND_COUNT],
        [f64; 3],
        bool,
    )> {
        let paths = self.response.paths.iter();
        paths
            .map(|heard| {
                (
                    heard.kind.name(),
                    heard.reflections.len(),
                    heard.delay_s,
                    heard.path.length_m,
                    heard.energy,
                    heard.errors_db,
                    heard.path.arrival_direction.to_array(),
                    heard.path.is_focus,
                )
            })
            .collect()
    }

    /// Azimuth and elevation of each path in degrees, as seen by the listener.
    fn path_angles(&self) -> Vec<(f64, f64)> {
        let paths = self.response.paths.iter();
        paths
            .map(|heard| (heard.azimuth.to_degrees(), heard.elevation.to_degrees()))
            .collect()
    }

    /// The points at which each path is reflected or bends, in world metres.
    fn path_points(&self) -> Vec<Vec<[f64; 3]>> {
        let points = |heard: &echomarch::response::HeardPath| {
            heard
                .path
                .points
                .iter()
                .map(|point| point.to_array())
                .collect()
        };
        self.response.paths.iter().map(points).collect()
    }

    /// The names of the surfaces on each path.
    fn path_surfaces(&self) -> Vec<Vec<String>> {
        self.surfaces.clone()
    }

    /// The samples of an impulse response: one row for each channel. `sofa` is a file of head-related impulse responses
    /// for the format `binaural`.
    fn impulse_response<'py>(
        &self,
        py: Python<'py>,
        rate_hz: u32,
        format: &str,
        ambisonic_order: Option<i64>,
        sofa: Option<PathBuf>,
        seed: Option<u64>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let made = py.detach(|| self.impulse(rate_hz, format, ambisonic_order, sofa, seed))?;
        let array = PyArray2::from_vec2(py, made.channels());
        array.map_err(|error| errors::internal(error.to_string()))
    }

    /// Writes the impulse responses of several responses as one SOFA file. `head` is a file of head-related impulse
    /// responses for the format `binaural`.
    #[staticmethod]
    #[allow(clippy::too_many_arguments)]
    fn write_sofa(
        py: Python<'_>,
        file: PathBuf,
        responses: Vec<Py<Heard>>,
        rate_hz: u32,
        format: &str,
        ambisonic_order: Option<i64>,
        head: Option<PathBuf>,
        seed: Option<u64>,
    ) -> PyResult<()> {
        let title = responses.first().map_or("", |first| &first.get().scene);
        py.detach(|| {
            let measured = responses.iter().map(|response| {
                let heard = response.get();
                let impulse =
                    heard.impulse(rate_hz, format, ambisonic_order, head.clone(), seed)?;
                heard.measurement(impulse)
            });
            let measured: Vec<RoomMeasurement> = measured.collect::<PyResult<_>>()?;
            RoomMeasurement::write_sofa(&file, title, &measured).map_err(errors::from)
        })
    }

    /// The response as bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        ciborium::into_writer(self, &mut bytes)
            .map_err(|error| errors::internal(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The response of these bytes.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Heard> {
        let read = ciborium::from_reader(bytes);
        read.map_err(|error| errors::settings(format!("the bytes do not hold a response: {error}")))
    }

    /// Strength *G* in decibels of an energy in 1/m²; NaN for silence.
    #[staticmethod]
    fn strength_db(energy: f64) -> f64 {
        or_nan(Figures::strength_db(energy))
    }

    fn __eq__(&self, other: &Heard) -> bool {
        let without_time = |heard: &Heard| {
            let mut response = heard.response.clone();
            (response.milliseconds, response.diffraction_milliseconds) = (0.0, 0.0);
            response
        };
        without_time(self) == without_time(other)
    }

    /// The notes that are warnings.
    fn warnings(&self) -> Vec<&str> {
        let warnings = self.notes.iter().filter(|(_, is_warning)| *is_warning);
        warnings.map(|(text, _)| text.as_str()).collect()
    }

    /// The properties of the response by their names.
    fn about<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let response = &self.response;
        let about = PyDict::new(py);
        about.set_item("scene", &self.scene)?;
        about.set_item("renderer", &self.renderer)?;
        about.set_item("source", &self.source)?;
        about.set_item("listener", &self.listener)?;
        about.set_item("source_position", self.source_position)?;
        about.set_item("listener_position", self.listener_position)?;
        let [forward, up] = self.listener_view;
        about.set_item("listener_view", forward.to_array())?;
        about.set_item("listener_up", up.to_array())?;
        about.set_item("speed_of_sound", self.speed_of_sound)?;
        about.set_item("seed", self.seed)?;
        about.set_item("waves", response.waves)?;
        about.set_item("onset_waves", response.onset_waves)?;
        about.set_item("seconds", response.seconds)?;
        about.set_item("milliseconds", response.milliseconds)?;
        about.set_item("time_origin_s", or_nan(response.figures.begins_s))?;
        about.set_item(
            "time_origin_error_s",
            or_nan(response.figures.begins_error_s),
        )?;
        about.set_item("cut_off", response.figures.cut_off.map(or_nan))?;
        about.set_item("gaps", &self.gaps)?;
        let notes: Vec<&str> = self.notes.iter().map(|(text, _)| text.as_str()).collect();
        about.set_item("notes", notes)?;
        about.set_item("missed_early_share", or_nan(response.missed.energy_share()))?;
        about.set_item("left_out_share", response.left_out_share)?;
        about.set_item("search_left_out_share", response.search_left_out_share)?;
        about.set_item("followed_s", response.followed_s)?;
        about.set_item("bands_hz", BANDS_HZ)?;
        Ok(about)
    }
}

impl Heard {
    fn impulse(
        &self,
        rate_hz: u32,
        format: &str,
        ambisonic_order: Option<i64>,
        sofa: Option<PathBuf>,
        seed: Option<u64>,
    ) -> PyResult<ImpulseResponse> {
        let mut settings = ImpulseSettings::new(self.response.seconds);
        settings.rate_hz = rate_hz;
        settings.seed = seed.unwrap_or(self.seed.into());
        settings.validate().map_err(errors::from)?;
        settings.format = match (format, sofa) {
            ("binaural", Some(file)) => Format::Binaural(Arc::new(hrirs(file, rate_hz)?)),
            ("binaural", None) => {
                let message =
                    "the format binaural needs head-related impulse responses: sofa=\"FILE.sofa\"";
                return Err(errors::settings(message.to_owned()));
            }
            (_, Some(_)) => {
                let message =
                    format!("sofa= has no effect on the format {format}: only binaural uses it");
                return Err(errors::settings(message));
            }
            ("mono" | "stereo", None) if ambisonic_order.is_some() => {
                let message =
                    format!("order= has no effect on the format {format}: only ambisonics uses it");
                return Err(errors::settings(message));
            }
            ("mono", None) => Format::Mono,
            ("stereo", None) => Format::Stereo,
            ("ambisonic" | "ambisonics" | "ambix", None) => {
                // 0 is refused with the range of orders, as are numbers beyond 255.
                let order = u8::try_from(ambisonic_order.unwrap_or(1)).unwrap_or(0);
                Format::AmbiX(AmbisonicOrder::new(order).map_err(errors::from)?)
            }
            _ => {
                let message = format!(
                    "there is no format {format:?}: use mono, stereo, ambisonics or binaural"
                );
                return Err(errors::settings(message));
            }
        };
        let axes = axes(self.listener_view)?;
        let (taps, echogram) = (self.response.taps(), &self.response.echogram);
        let impulse = ImpulseResponse::new(&taps, echogram, &axes, &settings);
        impulse.map_err(errors::from)
    }

    fn measurement(&self, impulse: ImpulseResponse) -> PyResult<RoomMeasurement> {
        Ok(RoomMeasurement {
            name: format!("{} at {}", self.source, self.listener),
            source_position: Vec3::from(self.source_position).as_dvec3(),
            source_axes: axes(self.source_view)?,
            listener_position: Vec3::from(self.listener_position).as_dvec3(),
            listener_axes: axes(self.listener_view)?,
            impulse,
        })
    }
}

/// Reads head-related impulse responses at a sampling rate.
fn hrirs(file: PathBuf, rate_hz: u32) -> PyResult<HrirSet> {
    let hrirs = HrirSet::read_sofa(&file).map_err(errors::from)?;
    hrirs
        .at_rate(rate_hz)
        .map_err(|error| errors::from(ResponseError::from(error)))
}
