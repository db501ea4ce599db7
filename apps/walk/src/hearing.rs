//! Full listening during a walk: traces the scene repeatedly.
//!
//! The echoes of one trace glide to the echoes of the next. The late part is computed at most four times per second.

use super::drawn_paths::{self, DrawnPath};
use super::parts::Parts;
use super::scene_gain;
use super::wave_budget::{
    LEAST_LATE_WAVES, LEAST_WAVES, LONGEST_LOOK_S, MOST_WAVES, TraceTime, early_waves, late_waves,
};
use echomarch::auralisation::HeardSource;
use echomarch::gl::Context;
use echomarch::internals::platform::Instant;
use echomarch::internals::shader::is_marched;
use echomarch::response::{ListenerAxes, Response, ResponseSettings};
use echomarch::scene::{Pair, Scene};
use echomarch::tracer::{Profile, Settings, Tracer};
use echomarch::{Error, bands};
use std::sync::Arc;
use std::time::Duration;

/// Length, in seconds, of the first response of a scene with marched fields. The same length is the minimum in an
/// expensive scene. A response of this length contains the first echoes of a room.
const FIRST_LENGTH_S: f64 = 0.25;

/// Maximum number of waves for early arrivals in the first trace of a scene, and in each trace that a new player waits
/// for: the sound begins early, and later traces find the remaining paths.
const FIRST_WAVES: u32 = 2048;

/// Maximum length, in seconds, of a response that a new player waits for. It contains the echoes and the beginning of the
/// reverberation; the next trace has the whole length.
const FIRST_SOUND_S: f64 = 0.5;

/// Typical number of waves in an estimate of the response length.
const ESTIMATE_WAVES: f64 = 4096.0;

/// Maximum predicted duration, in seconds, of an estimate of the response length. In more expensive scenes, the length
/// is the longest that the minimum number of waves can trace in [`LONGEST_LOOK_S`].
const LONGEST_ESTIMATE_S: f64 = 2.0;

/// Maximum number of reflections of exact paths.
const ORDER: u32 = 3;

/// Maximum length of a response, in seconds. Convolution with two seconds takes 4 % of a processor core.
pub(super) const LONGEST_S: f64 = 2.0;

/// Minimum interval between two late parts, in seconds.
const LATE_EVERY_S: f64 = 0.25;

/// Interval between two estimates of the response length, in seconds.
const LENGTH_EVERY_S: f64 = 4.0;

/// Limits of the glide time from one set of echoes to the next, in seconds. Within these limits, the glide takes as
/// long as the time since the last trace.
const SHORTEST_GLIDE_S: f64 = 0.02;
const LONGEST_GLIDE_S: f64 = 0.5;

/// Lower limit of the energy curve, in decibels relative to its maximum.
pub const QUIETEST_DB: f64 = -80.0;

/// Number of points of the energy curve.
const CURVE_POINTS: usize = 120;

/// The results of a trace. The curve, the paths and the error are not serialised.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct EarsStatus {
    /// The level of each source; empty before the first trace.
    pub sources: Vec<HeardSource>,
    /// For each source: the likely reason if nothing of it arrives.
    #[serde(skip)]
    pub silences: Vec<Option<String>>,
    /// Number of traces so far.
    pub looks: u64,
    /// Number of waves for early arrivals in the last trace, and the number requested without the limit of one second.
    pub waves: u32,
    pub waves_asked: u32,
    /// The gain of the scene's sound in decibels: at 0 dB, a source at 1 m in the open is as loud as its sound.
    pub gain_db: f64,
    /// The attenuation by the limiter in decibels, 0 or more.
    pub limited_db: f32,
    /// Duration of the last trace, and of its late part, in milliseconds.
    pub trace_ms: f64,
    pub late_ms: f64,
    /// Energy of all sources in equal intervals over the first `curve_s` seconds, in decibels relative to the maximum
    /// of the curve.
    #[serde(skip)]
    pub curve: Vec<f32>,
    #[serde(skip)]
    pub curve_s: f64,
    /// The paths of all sources to draw in the plan. They are shared, because the status is copied for each picture.
    #[serde(skip)]
    pub paths: Arc<Vec<DrawnPath>>,
    /// The reason why full listening failed.
    #[serde(skip)]
    pub error: Option<String>,
}

impl EarsStatus {
    /// Removes the parts of a source's response that are switched off, and adds the rest to the status.
    fn add(&mut self, pair: Pair, parts: &Parts, response: &mut Response) -> Result<(), Error> {
        let arrives = HeardSource::of(response).level_db.is_some();
        parts.keep(response)?;
        let heard = HeardSource::of(response);
        let is_silent = heard.level_db.is_none();
        let reason = is_silent.then(|| silence(response, pair, arrives));
        self.silences.push(reason);
        self.sources.push(heard);
        Arc::make_mut(&mut self.paths).extend(drawn_paths::of_response(pair, response));
        Ok(())
    }
}

/// The first words of the note on a source of which nothing arrives.
const NOTHING: &str = "nothing arrives";

/// Index of the walker among the scene's listeners.
const LISTENER: usize = 0;

/// Traces a scene for full listening, with its own tracer.
pub struct Hearing {
    tracer: Tracer,
    /// The scene of the last trace, and the parts that were heard.
    scene: Option<(Scene, Parts)>,
    /// Whether the scene was edited or exchanged since the last trace.
    is_forgotten: bool,
    /// The gain of the scene's sound, an amplitude factor; `None` before the first trace of a scene.
    gain: Option<f32>,
    /// Length of the responses in seconds, and the time of its estimate.
    length: Option<(f64, Instant)>,
    /// Whether the last response was shorter than its length, or its length unknown, because a player waited for it. Another
    /// trace follows, whose time contains no compilation.
    is_cut: bool,
    /// The profile of the last trace.
    profile: Option<Profile>,
    /// Whether the scene has marched surfaces, whose tracing time is unknown.
    may_be_dear: bool,
    /// Tracing time per wave and per second of response, in seconds; `None` before the first trace of a scene with
    /// marched surfaces, 0 in a scene without any.
    cost: Option<f64>,
    /// Maximum number of waves for early arrivals that fits [`LONGEST_LOOK_S`].
    early_waves: u32,
    /// Number of waves for early arrivals in the last trace.
    early_waves_heard: u32,
    /// Maximum number of waves for late arrivals that fits [`LOOK_S`].
    late_waves: u32,
    /// Number of waves in the current late part.
    late_waves_heard: u32,
    last_look: Instant,
    last_late: Option<Instant>,
}

/// The result of a trace for one source, to be passed to the player.
#[derive(Clone, Copy, Debug)]
pub struct Found<'a> {
    /// Index of the source, from 0.
    pub source: usize,
    /// Its response.
    pub response: &'a Response,
    /// The listener's coordinate axes.
    pub axes: &'a ListenerAxes,
    /// The gain of the scene's sound, an amplitude factor.
    pub gain: f32,
    /// Whether the late part must be computed.
    pub is_late_due: bool,
    /// Glide time from the previous echoes to the new ones, in seconds.
    pub glide_s: f64,
}

impl Hearing {
    /// Creates a `Hearing` that has not traced yet.
    ///
    /// # Errors
    /// [`Error::Gpu`] if OpenGL fails.
    pub fn new(context: &Context) -> Result<Hearing, Error> {
        Ok(Hearing {
            tracer: Tracer::new(context)?,
            scene: None,
            is_forgotten: false,
            gain: None,
            length: None,
            is_cut: false,
            profile: None,
            may_be_dear: false,
            cost: Some(0.0),
            early_waves: FIRST_WAVES,
            early_waves_heard: 0,
            late_waves: LEAST_LATE_WAVES,
            late_waves_heard: 0,
            last_look: Instant::now(),
            last_late: None,
        })
    }

    /// Whether a new trace is due. A trace is due if the scene or the choice of parts has changed since the last trace, if
    /// a new player waits, if the late part is missing, or if the last trace had far fewer waves than its time limit
    /// allows.
    pub fn is_new(
        &self,
        scene: &Scene,
        settings: &Settings,
        parts: &Parts,
        is_waited_for: bool,
    ) -> bool {
        let is_same = |(last, heard): &(Scene, Parts)| last == scene && heard == parts;
        let is_another = self.is_forgotten || !self.scene.as_ref().is_some_and(is_same);
        let early = self.early_waves.min(settings.waves);
        let is_rough = self.late_waves >= 2 * self.late_waves_heard
            || early >= 2 * self.early_waves_heard.max(1)
            || self.is_cut
            || self.length.is_none() && self.allows_estimate();
        let lacks_late = self.last_late < Some(self.last_look) || is_rough;
        let lacks_late = lacks_late && self.late_is_due();
        settings.profile() != Profile::Thesis && (is_another || lacks_late || is_waited_for)
    }

    fn late_is_due(&self) -> bool {
        let since = |last: Instant| last.elapsed().as_secs_f64() >= LATE_EVERY_S;
        self.last_late.is_none_or(since)
    }

    /// Traces every source at the first listener, and passes each result to the closure.
    ///
    /// # Errors
    /// The errors of [`Response::trace`] and of the closure.
    pub fn look(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        parts: &Parts,
        is_waited_for: bool,
        mut tell: impl FnMut(Found) -> Result<(), Error>,
    ) -> Result<EarsStatus, Error> {
        let began = Instant::now();
        let since = self.last_look.elapsed().as_secs_f64();
        let glide_s = since.clamp(SHORTEST_GLIDE_S, LONGEST_GLIDE_S);
        let is_late_due = is_waited_for || self.late_is_due();
        self.begin_small(scene, settings);
        let (early, seconds) = match is_waited_for {
            true => (self.early_waves.min(FIRST_WAVES), self.first_length_s()),
            false => (self.early_waves, self.length_s(scene, settings)?),
        };
        let how = response_settings(settings, early)
            .with_seconds(seconds)
            .with_late_waves(self.late_waves);
        let how = parts.choose(how);
        let gain = self.gain_of(scene, &how)?;
        let tracing = Instant::now();
        let listener = scene.pair(0, LISTENER)?.listener();
        let axes = ListenerAxes::of(listener)?;
        let mut status = EarsStatus {
            curve_s: seconds,
            waves: how.trace.waves,
            waves_asked: settings.waves.min(MOST_WAVES),
            gain_db: 20.0 * f64::from(gain).log10(),
            ..EarsStatus::default()
        };
        let mut curve = vec![0.0; CURVE_POINTS];
        let (mut on_late, mut diffraction_ms) = (Duration::ZERO, 0.0);
        for source in 0..scene.sources.len() {
            let pair = scene.pair(source, LISTENER)?;
            let mut response = Response::trace(&mut self.tracer, pair, &how)?;
            diffraction_ms += response.diffraction_milliseconds;
            status.add(pair, parts, &mut response)?;
            add_to_curve(&mut curve, &response, seconds);
            let making = Instant::now();
            tell(Found {
                source,
                response: &response,
                axes: &axes,
                gain,
                is_late_due,
                glide_s,
            })?;
            on_late += making.elapsed();
        }
        status.curve = in_decibels(&curve);
        status.late_ms = 1e3 * on_late.as_secs_f64();
        status.trace_ms = 1e3 * began.elapsed().as_secs_f64() - status.late_ms;
        let took = TraceTime::new(tracing.elapsed().saturating_sub(on_late), diffraction_ms);
        self.is_cut = is_waited_for && self.length.is_none_or(|(whole, _)| seconds < whole);
        if is_late_due {
            self.late_waves_heard = self.late_waves;
        }
        // Without marched surfaces a trace is slow only on a busy machine, or while shaders are compiled.
        if self.may_be_dear {
            self.cost = Some(took.waves.as_secs_f64() / (f64::from(self.late_waves) * seconds));
        }
        self.early_waves_heard = status.waves;
        self.early_waves = early_waves(early, took);
        self.late_waves = late_waves(self.late_waves, took);
        self.last_look = Instant::now();
        if is_late_due {
            self.last_late = Some(self.last_look);
        }
        self.scene = Some((scene.clone(), *parts));
        self.is_forgotten = false;
        Ok(status)
    }

    /// Passes the sound that is found without waves to the closure if the next trace is the first one of its scene, which
    /// compiles shaders for seconds: the direct sound, first reflections at planes, and ways around and through obstacles.
    /// The next trace replaces it. Returns `None` if the scene is known, or if waves are needed to hear anything.
    ///
    /// # Errors
    /// The errors of [`Response::without_waves`] and of the closure.
    pub fn sketch(
        &self,
        scene: &Scene,
        settings: &Settings,
        parts: &Parts,
        mut tell: impl FnMut(Found) -> Result<(), Error>,
    ) -> Result<Option<EarsStatus>, Error> {
        if self.knows(scene, settings) || settings.profile() == Profile::Thesis {
            return Ok(None);
        }
        let how = response_settings(settings, FIRST_WAVES)
            .with_order(1)
            .with_seconds(LONGEST_S);
        let how = parts.choose(how);
        let mut status = EarsStatus::default();
        let mut responses = Vec::new();
        for source in 0..scene.sources.len() {
            let pair = scene.pair(source, LISTENER)?;
            let mut response = Response::without_waves(pair, &how)?;
            status.add(pair, parts, &mut response)?;
            responses.push(response);
        }
        if status.silences.iter().all(Option::is_some) {
            return Ok(None);
        }
        let found = |pair: Pair, how: &_| Response::without_waves(pair, how);
        let gain = scene_gain::of_scene(scene, LISTENER, &how, LONGEST_S, found)?;
        // Waves add energy, which lowers the gain. An edited scene mostly keeps the gain that it had before.
        let before = self.gain.filter(|_| self.has_name_of(scene));
        let gain = before.map_or(gain, |before| before.min(gain));
        let axes = ListenerAxes::of(scene.pair(0, LISTENER)?.listener())?;
        for (source, response) in responses.iter().enumerate() {
            tell(Found {
                source,
                response,
                axes: &axes,
                gain,
                is_late_due: false,
                glide_s: SHORTEST_GLIDE_S,
            })?;
        }
        Ok(Some(status))
    }

    /// Whether a scene was traced with this profile before.
    fn knows(&self, scene: &Scene, settings: &Settings) -> bool {
        !self.is_forgotten && self.has_name_of(scene) && self.profile == Some(settings.profile())
    }

    /// Whether the scene of the last trace has the name of this one, which may be an edited version of it.
    fn has_name_of(&self, scene: &Scene) -> bool {
        let last = self.scene.as_ref().map(|(last, _)| &last.name);
        last == Some(&scene.name)
    }

    /// Takes the scene of the next trace as another one, because the scene was edited: its gain, its length and its
    /// numbers of waves are chosen again.
    pub fn forget_scene(&mut self) {
        self.is_forgotten = true;
    }

    /// Starts another scene or profile with few waves if it has marched surfaces, because the tracing time is unknown.
    fn begin_small(&mut self, scene: &Scene, settings: &Settings) {
        if self.knows(scene, settings) {
            return;
        }
        self.profile = Some(settings.profile());
        let takes_steps = settings.profile() != Profile::Hybrid;
        self.may_be_dear = takes_steps || scene.surfaces.iter().any(is_marched);
        self.length = None;
        self.gain = None;
        (self.early_waves, self.late_waves, self.cost) = match self.may_be_dear {
            true => (LEAST_WAVES, LEAST_WAVES, None),
            false => (FIRST_WAVES, LEAST_LATE_WAVES, Some(0.0)),
        };
    }

    /// The gain of the scene's sound. It is computed in the first trace of a scene, and stays until another scene.
    fn gain_of(&mut self, scene: &Scene, how: &ResponseSettings) -> Result<f32, Error> {
        if let Some(gain) = self.gain {
            return Ok(gain);
        }
        let mut how = how.clone();
        how.trace.waves = how.trace.waves.min(LEAST_LATE_WAVES);
        let trace = |pair: Pair, how: &_| Response::trace(&mut self.tracer, pair, how);
        let gain = scene_gain::of_scene(scene, LISTENER, &how, LONGEST_S, trace)?;
        self.gain = Some(gain);
        Ok(gain)
    }

    /// Whether the predicted duration of an estimate of the length is below its limit.
    fn allows_estimate(&self) -> bool {
        let foreseen = |cost: f64| cost * ESTIMATE_WAVES * LONGEST_S;
        self.cost
            .is_some_and(|cost| foreseen(cost) <= LONGEST_ESTIMATE_S)
    }

    /// Length of a response that a new player waits for, in seconds. No estimate delays it.
    fn first_length_s(&self) -> f64 {
        match (self.length, self.cost) {
            (Some((seconds, _)), _) => seconds.min(FIRST_SOUND_S),
            (None, Some(cost)) if self.allows_estimate() => length_of_dear(cost).min(FIRST_SOUND_S),
            (None, Some(cost)) => length_of_dear(cost),
            (None, None) => FIRST_LENGTH_S,
        }
    }

    /// Length of the responses, in seconds. The length is estimated every few seconds, unless the estimate would take
    /// too long. An estimated length stays in this case: the level of the late part does not depend on how long a trace
    /// takes.
    fn length_s(&mut self, scene: &Scene, settings: &Settings) -> Result<f64, Error> {
        if !self.allows_estimate() {
            let dear = || self.cost.map_or(FIRST_LENGTH_S, length_of_dear);
            return Ok(self.length.map_or_else(dear, |(seconds, _)| seconds));
        }
        if let Some((seconds, found)) = self.length
            && found.elapsed().as_secs_f64() < LENGTH_EVERY_S
        {
            return Ok(seconds);
        }
        let waves = settings.waves.min(self.late_waves);
        let few = settings.clone().with_waves(waves);
        let settings = response_settings(&few, MOST_WAVES).with_longest(LONGEST_S);
        let mut longest: f64 = 0.0;
        for source in 0..scene.sources.len() {
            let pair = scene.pair(source, LISTENER)?;
            longest = longest.max(settings.seconds_needed(&mut self.tracer, pair)?);
        }
        let seconds = longest.min(LONGEST_S);
        self.length = Some((seconds, Instant::now()));
        Ok(seconds)
    }
}

/// Why a source is silent. `arrives` is true if only parts arrive that are switched off.
fn silence(response: &Response, pair: Pair, arrives: bool) -> String {
    if arrives {
        return format!("{NOTHING} of the parts that are switched on");
    }
    let notes = response.notes(pair).into_iter();
    let mut texts = notes.map(|note| note.to_string());
    let reason = texts.find(|text| text.starts_with(NOTHING));
    reason.unwrap_or_else(|| NOTHING.to_owned())
}

/// The length of responses in an expensive scene, in seconds. `cost` is the tracing time per wave and per second of
/// response, in seconds.
fn length_of_dear(cost: f64) -> f64 {
    let fit = LONGEST_LOOK_S / (cost * f64::from(LEAST_WAVES));
    fit.clamp(FIRST_LENGTH_S, LONGEST_S)
}

/// The settings of responses with at most `most` waves for early arrivals.
fn response_settings(chosen: &Settings, most: u32) -> ResponseSettings {
    let waves = chosen.waves.min(most);
    let chosen = chosen.clone().with_waves(waves);
    let settings = ResponseSettings::default().with_trace_of_frames(&chosen);
    settings.with_order(ORDER).without_figures()
}

/// Adds the energies of a response to the intervals of the curve.
fn add_to_curve(curve: &mut [f64], response: &Response, seconds: f64) {
    let mut add = |at_s: f64, energy: f64| {
        let part = (at_s / seconds * CURVE_POINTS as f64) as usize;
        if let Some(sum) = curve.get_mut(part) {
            *sum += energy;
        }
    };
    for path in &response.paths {
        add(path.delay_s, bands::mean(&path.energy));
    }
    let echogram = &response.echogram;
    for bin in 0..echogram.bins() {
        let at_s = echogram.first_s() + (bin as f64 + 0.5) * echogram.bin_s();
        add(at_s, bands::mean(&echogram.energy(bin)));
    }
}

/// Decibels relative to the largest value, limited to −80 dB and above.
fn in_decibels(curve: &[f64]) -> Vec<f32> {
    let largest = curve.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let decibels = |energy: &f64| (10.0 * (energy / largest).log10()).max(QUIETEST_DB) as f32;
    curve.iter().map(decibels).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::gl::ContextOptions;
    use echomarch::response::{HeardPath, PathKind};

    /// Protects the user of an expensive field from waiting for an estimate of the length: it is made only if it is
    /// quick.
    #[test]
    fn dear_responses_are_shorter() {
        assert_eq!(length_of_dear(1.0 / 64.0), 1.0);
        assert_eq!(length_of_dear(1e-6), LONGEST_S);
        assert_eq!(length_of_dear(1e3), FIRST_LENGTH_S);
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut hearing = Hearing::new(&context).unwrap();
        for (cost, allowed) in [(None, false), (Some(0.0), true), (Some(1.0), false)] {
            hearing.cost = cost;
            assert_eq!(hearing.allows_estimate(), allowed, "{cost:?}");
        }
        assert!(hearing.length.is_none());
        // Protects the late part from becoming weaker after slow traces: an estimated length stays.
        let scene = Scene::builtin("shoebox").unwrap();
        let settings = Settings::default();
        let dear = hearing.length_s(&scene, &settings).unwrap();
        assert_eq!(dear, FIRST_LENGTH_S);
        hearing.length = Some((1.5, Instant::now()));
        assert_eq!(hearing.length_s(&scene, &settings).unwrap(), 1.5);
    }

    /// Protects a scene with marched surfaces: its first trace has few waves, whatever the previous scene had. A later
    /// trace of the same scene does not start with few waves again, and a scene of closed forms starts with all waves.
    #[test]
    fn a_marched_scene_begins_with_few_waves() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut hearing = Hearing::new(&context).unwrap();
        let scene = Scene::builtin("corner").unwrap();
        let settings = Settings::hybrid().with_waves(2048);
        let look = |hearing: &mut Hearing, settings: &Settings| {
            let looked = hearing.look(&scene, settings, &Parts::default(), true, |_| Ok(()));
            looked.unwrap().waves
        };
        assert_eq!(look(&mut hearing, &settings), 2048);
        let march = Settings::march().with_waves(2048);
        assert_eq!(look(&mut hearing, &march), LEAST_WAVES);
        hearing.early_waves = MOST_WAVES;
        hearing.last_late = None;
        assert!(hearing.is_new(&scene, &march, &Parts::default(), false));
        assert_eq!(look(&mut hearing, &march), 2048);
    }

    /// A scene of this name with a box of this height between a source and a listener.
    fn with_screen(name: &str, height: f32) -> Scene {
        let text = format!(
            "Scene(surfaces: [Surface(shape: Box(size: (0.2, {height}, 20)))], \
             source: Source(position: (-2, 1, 0)), listener: Listener(position: (2, 1, 0), radius: 0.3))"
        );
        let mut scene = Scene::from_ron(&text, "test").unwrap();
        scene.name = name.to_owned();
        scene
    }

    /// Protects the first sound of another scene: its gain does not depend on a louder scene before. An edited scene
    /// keeps a lower gain that it had before, because the waves that follow add energy.
    #[test]
    fn a_sketch_of_another_scene_has_a_gain_of_its_own() {
        const LOUD: f32 = 0.01;
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let settings = Settings::hybrid();
        let gain = |before: Option<&str>, is_edited: bool| {
            let mut hearing = Hearing::new(&context).unwrap();
            if let Some(name) = before {
                hearing.scene = Some((with_screen(name, 1.0), Parts::default()));
                hearing.profile = Some(settings.profile());
                hearing.gain = Some(LOUD);
            }
            if is_edited {
                hearing.forget_scene();
            }
            let mut gains = Vec::new();
            let tell = |found: Found| {
                gains.push(found.gain);
                Ok(())
            };
            let scene = with_screen("quiet", 0.5);
            let sketch = hearing.sketch(&scene, &settings, &Parts::default(), tell);
            sketch.unwrap();
            gains.first().copied()
        };
        let own = gain(None, false).unwrap();
        assert!(own > 2.0 * LOUD, "{own}");
        assert_eq!(gain(Some("loud"), false), Some(own));
        assert_eq!(gain(Some("loud"), true), Some(own));
        assert_eq!(gain(Some("quiet"), true), Some(LOUD));
        assert_eq!(gain(Some("quiet"), false), None);
    }

    /// Protects the first sound of a hidden source: it has the least level that its traced response has.
    #[test]
    fn a_sketch_has_the_least_level() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let hearing = Hearing::new(&context).unwrap();
        let (scene, settings) = (with_screen("wall", 9.0), Settings::hybrid());
        let added = |least_db: Option<f64>| {
            let mut parts = Parts::default().with_least_level(least_db);
            parts.diffraction = false;
            let mut paths = Vec::new();
            let tell = |found: Found| {
                paths.extend_from_slice(&found.response.paths);
                Ok(())
            };
            hearing.sketch(&scene, &settings, &parts, tell).unwrap();
            assert_eq!(paths.is_empty(), least_db.is_none());
            let is_added = |path: &&HeardPath| path.kind == PathKind::Added;
            paths.iter().filter(is_added).count()
        };
        assert_eq!(added(None), 0);
        assert_eq!(added(Some(-20.0)), 1);
    }
}
