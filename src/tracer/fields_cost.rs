//! The cost of marched surfaces: their share of a frame's time, and the number of evaluations in a flight of a wave.
//!
//! The share is measured with pairs of frames. One frame of a pair has the whole scene, and the other frame has no
//! marched surfaces. The two kinds of frames alternate, so that other work on the machine slows both.

use super::{Fate, Profile, Settings, Tracer, Wave};
use crate::error::Error;
use crate::sampling::{median, quantiles};
use crate::scene::shape::Room;
use crate::scene::{IntoPair, Node, Pair, Scene, Surface};
use crate::shader::is_marched;
use glam::Vec3;
use serde::Serialize;
use std::fmt;

/// Maximum number of states of waves that are read back to count flights: 64 MB.
const MOST_STATES: u32 = 1 << 20;

/// Maximum number of waves whose flights and evaluations are counted. The mean over these waves differs by about a
/// percent from the mean over all waves.
const MOST_COUNTED: u32 = 16_384;

/// Side in metres of the empty room with which a scene of only marched surfaces is compared. The size of the room has
/// no effect on the cost.
const EMPTY_ROOM_M: f32 = 10.0;

/// The cost of the marched surfaces of a scene. In `hybrid` these are the surfaces without a closed form, in the other
/// profiles all surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldsCost {
    /// Number of marched surfaces.
    pub surfaces: usize,
    /// Evaluations of the distance in a flight of a wave. The evaluations for normals are included only in `thesis`.
    pub evaluations_per_flight: f64,
    /// Percent of a frame's time that is saved without these surfaces: the median over the pairs.
    pub percent_of_frame: f64,
    /// Half the distance between the quartiles over the pairs, in percent of a frame.
    pub spread_percent: f64,
    /// Milliseconds of a frame with the whole scene: the median.
    pub frame_ms: f64,
    /// Number of waves in these frames.
    pub waves: u32,
}

impl fmt::Display for FieldsCost {
    /// Example: "fields 62 % of the frame, 4.1 evaluations a flight".
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "fields {:.0} % of the frame, {:.1} evaluations a flight",
            self.shown_percent(),
            self.evaluations_per_flight
        )
    }
}

impl FieldsCost {
    /// The percent of a frame to show, limited to 0 … 100, because noise may make the frame without fields the slower
    /// one.
    pub fn shown_percent(&self) -> f64 {
        self.percent_of_frame.clamp(0.0, 100.0)
    }

    /// Measures `runs` pairs of frames (at least 1), each pair with a different seed. Returns `None` for a scene
    /// without marched surfaces, or if `goes_on` returns false.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn measure<'a>(
        tracer: &mut Tracer,
        pair: impl IntoPair<'a>,
        settings: &Settings,
        runs: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<FieldsCost>, Error> {
        let pair = pair.chosen()?;
        let profile = settings.profile();
        let surfaces = pair.scene().surfaces.iter();
        let surfaces = surfaces.filter(|of| takes_steps(of, profile)).count();
        if surfaces == 0 || !goes_on() {
            return Ok(None);
        }
        let evaluations_per_flight = evaluations_per_flight(tracer, pair, settings)?;
        let Some(saved) = saved(tracer, pair, settings, runs, goes_on)? else {
            return Ok(None);
        };
        let frame_ms = median(saved.iter().map(|(whole, _)| *whole));
        let percent = |saved_ms: f64| 100.0 * saved_ms / frame_ms.max(f64::MIN_POSITIVE);
        let differences = || saved.iter().map(|(whole, rest)| whole - rest);
        let [low, high] = quantiles(differences(), [0.25, 0.75]);
        Ok(Some(FieldsCost {
            surfaces,
            evaluations_per_flight,
            percent_of_frame: percent(median(differences())),
            spread_percent: percent(0.5 * (high - low)),
            frame_ms,
            waves: settings.waves,
        }))
    }
}

/// Whether waves are marched to a surface in this profile.
fn takes_steps(surface: &Surface, profile: Profile) -> bool {
    profile != Profile::Hybrid || is_marched(surface)
}

/// Milliseconds of frames with and without the marched surfaces, pair by pair; `None` if `goes_on` returned false.
fn saved(
    tracer: &mut Tracer,
    pair: Pair,
    settings: &Settings,
    runs: u32,
    goes_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<(f64, f64)>>, Error> {
    let rest = without_marched(pair, settings.profile());
    let mut times = Vec::new();
    // The first pair compiles the programs, and its times are discarded.
    for run in 0..=runs.max(1) {
        if !goes_on() {
            return Ok(None);
        }
        let seed = settings.seed.wrapping_add(run);
        let settings = settings.clone().with_count_evaluations(false);
        let settings = settings.with_seed(seed);
        let whole = tracer.frame(pair, &settings)?.milliseconds.total;
        times.push((whole, tracer.frame(&rest, &settings)?.milliseconds.total));
    }
    Ok(Some(times.split_off(1)))
}

/// The pair's scene without its marched surfaces, or an empty room around the source if no surface is left.
fn without_marched(pair: Pair, profile: Profile) -> Scene {
    let source = pair.source().clone();
    let mut rest = pair.scene().clone();
    rest.surfaces.retain(|of| !takes_steps(of, profile));
    if rest.surfaces.is_empty() {
        let room = Node::Room(Room {
            size: Vec3::splat(EMPTY_ROOM_M),
        });
        rest.surfaces = vec![Surface::new(room).at(source.position)];
    }
    rest.listeners = vec![pair.listener().clone()];
    rest.sources = vec![source];
    rest
}

/// Mean number of evaluations of the distance in a flight of a wave, from at most 16,384 of the settings' waves.
///
/// # Errors
/// The errors of [`Tracer::frame`].
pub fn evaluations_per_flight<'a>(
    tracer: &mut Tracer,
    pair: impl IntoPair<'a>,
    settings: &Settings,
) -> Result<f64, Error> {
    let pair = pair.chosen()?;
    let most = MOST_COUNTED.min(MOST_STATES / (settings.iterations + 1));
    let few = settings.clone().with_count_evaluations(false);
    let few = few.with_waves(settings.waves.min(most.max(1)));
    let states = tracer.paths(pair, &few)?;
    let flights = flights(&states, settings.profile());
    Ok(evaluations(tracer, pair, &few)? as f64 / flights.max(1) as f64)
}

/// Counts the evaluations of the distance in a frame.
///
/// # Errors
/// The errors of [`Tracer::frame`].
pub fn evaluations<'a>(
    tracer: &mut Tracer,
    pair: impl IntoPair<'a>,
    settings: &Settings,
) -> Result<u64, Error> {
    let counting = settings.clone().with_count_evaluations(true);
    let counting = counting.with_sum_on_gpu(false);
    Ok(tracer.frame(pair, &counting)?.counts.evaluations)
}

/// The number of flights of waves, from their states as [`Tracer::paths`] returns them. A wave makes one flight per
/// iteration until it is heard or dead. `thesis` continues to march dead waves, and these flights count.
pub fn flights(states: &[Vec<Wave>], profile: Profile) -> u64 {
    let starts = states.iter().rev().skip(1).flatten();
    let flies = |wave: &&Wave| match wave.fate() {
        Fate::Listener => false,
        Fate::Dead => profile == Profile::Thesis,
        Fate::Travelling | Fate::NotFinite => true,
    };
    starts.filter(flies).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gl::{Context, ContextOptions};

    fn cost(scene: &str, settings: &Settings) -> Option<FieldsCost> {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut tracer = Tracer::new(&context).unwrap();
        let scene = Scene::builtin(scene).unwrap();
        FieldsCost::measure(&mut tracer, &scene, settings, 1, &|| true).unwrap()
    }

    /// Protects the number of flights: a heard wave makes no more flights, and a dead wave makes more flights only in
    /// `thesis`.
    #[test]
    fn flights_end_with_their_wave() {
        let wave = |status| Wave {
            start_direction: Vec3::X,
            direction: Vec3::X,
            status,
            ..Wave::default()
        };
        let states = [[0.5, 0.5], [0.0, -1.0], [0.0, -1.0]].map(|states| states.map(wave).to_vec());
        assert_eq!(flights(&states, Profile::Hybrid), 2);
        assert_eq!(flights(&states, Profile::March), 2);
        assert_eq!(flights(&states, Profile::Thesis), 3);
    }

    /// Protects the surfaces that count as fields: in `hybrid` the surfaces without a closed form, in the other
    /// profiles all.
    #[test]
    fn only_marched_surfaces_cost_evaluations() {
        let few = Settings::hybrid().with_waves(256).with_iterations(2);
        assert_eq!(cost("corner", &few), None);
        let cave = cost("cave", &few).unwrap();
        assert!(
            cave.evaluations_per_flight > 0.0 && cave.frame_ms > 0.0,
            "{cave:?}"
        );
        assert_eq!((cave.surfaces, cave.waves), (1, 256));
        let march = few.with_profile(Profile::March);
        let corner = cost("corner", &march).unwrap();
        assert_eq!(
            corner.surfaces,
            Scene::builtin("corner").unwrap().surfaces.len()
        );
    }

    /// Protects the comparison: the scene without marched surfaces keeps all other surfaces, and becomes an empty room
    /// if no surface is left.
    #[test]
    fn what_is_not_marched_stays() {
        let scene = Scene::builtin("cave").unwrap();
        let rest = without_marched(scene.only_pair().unwrap(), Profile::Hybrid);
        assert_eq!(rest.surfaces, scene.surfaces[1..], "all but the rock");
        let scene = Scene::builtin("morphing-room").unwrap();
        let rest = without_marched(scene.only_pair().unwrap(), Profile::Hybrid);
        assert_eq!(rest.surfaces.len(), 1);
        assert!(rest.surface_distance(rest.sources[0].position).distance > 0.0);
        let scene = Scene::builtin("corner").unwrap();
        let pair = scene.only_pair().unwrap();
        assert_eq!(
            without_marched(pair, Profile::Hybrid).surfaces,
            scene.surfaces
        );
    }

    /// Protects the sentence that the command line and the window show.
    #[test]
    fn the_cost_is_one_phrase() {
        let cost = FieldsCost {
            surfaces: 1,
            evaluations_per_flight: 4.12,
            percent_of_frame: 61.7,
            spread_percent: 2.0,
            frame_ms: 10.0,
            waves: 4096,
        };
        assert_eq!(
            cost.to_string(),
            "fields 62 % of the frame, 4.1 evaluations a flight"
        );
        let noisy = FieldsCost {
            percent_of_frame: -3.0,
            ..cost
        };
        assert!(noisy.to_string().starts_with("fields 0 %"));
    }

    /// Protects a window that is closed during a measurement: the measurement ends at the next frame.
    #[test]
    fn a_measurement_can_be_ended() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut tracer = Tracer::new(&context).unwrap();
        let scene = Scene::builtin("cave").unwrap();
        let settings = Settings::hybrid().with_waves(256);
        let measured = FieldsCost::measure(&mut tracer, &scene, &settings, 1, &|| false);
        assert_eq!(measured.unwrap(), None);
    }
}
