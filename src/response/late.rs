//! The sphere in which late arrivals are counted: larger than the listener where that changes little
//! but the noise, which falls with 1/radius.
//!
//! Behind the exact paths the energy at a place hardly differs from that a metre away, if nothing
//! gathers sound and nothing stands between. So where all surfaces are flat or convex, late arrivals are
//! counted in a sphere of [`RADIUS_M`]. It reaches to no surface, as beyond one may be another room, but
//! for walls of a `Room`, beyond which is nothing; of these it reaches as far behind one as that is away,
//! at the most. The energy is the mean over the part of the sphere that is open, and the times are those
//! of paths to its centre, as in the listener itself.
//!
//! Late arrivals may come from fewer waves than exact paths are found by: their noise is heard as noise, while a path
//! that no wave finds is missing.

use super::importance::{self, Importance, Pilot};
use super::{Medium, ResponseSettings};
use crate::acoustics::{Arrival, CommonErrors, Echogram};
use crate::bands::BAND_COUNT;
use crate::error::Error;
use crate::kernel::{self, Materials};
use crate::scene::{Node, Scene, Surface};
use crate::trace::{ArrivalCounts, ArrivalSettings, Followed, Settings, Tracer, WavesToFollow};
use std::ops::Range;

/// Radius in metres. In random rooms (docs/acoustics.md) T30 is 2.5 times as exact with it as with
/// 0.3 m, and what the mean over the sphere is off cannot be told from noise yet; with 1.5 m it can.
const RADIUS_M: f32 = 1.0;

/// What the mean over the sphere leaves figures off, one standard deviation: in a room of 4.4 × 3 × 4.3 m T30
/// was 0.2 to 0.4 % off in all bands, in one of 3.1 × 8.5 × 6.4 m C80 0.02 to 0.03 dB, in one of 24.8 × 2.5 × 3.8 m
/// EDT up to 0.8 % and C80 up to 0.04 dB.
const COMMON_ERRORS: CommonErrors = CommonErrors {
    decay_share: 0.003,
    early_decay_share: 0.005,
    clarity_db: 0.02,
    strength_db: 0.003,
};

/// The same where something stands in the room, and some bands are not scattered: behind it less of the sound that goes to and fro
/// between walls is heard, and the sphere reaches beyond that shadow. In 14 random rooms with a ball or a box this was the
/// difference from the listener's own sphere but for noise, rms of all bands; in one of them T30 was 4.7 % off.
const COMMON_ERRORS_IN_SHADOWS: CommonErrors = CommonErrors {
    decay_share: 0.012,
    early_decay_share: 0.005,
    clarity_db: 0.06,
    strength_db: 0.017,
};

/// What the larger sphere leaves figures off; `None` where the listener's own sphere is used.
pub(super) fn common_errors(scene: &Scene) -> Option<&'static CommonErrors> {
    if radius_m(scene) <= scene.listener.radius {
        return None;
    }
    let stands_free = |surface: &Surface| {
        let node = &surface.shape.node;
        !matches!(node, Node::Room(_) | Node::Plane(_) | Node::HalfSpace(_))
    };
    let is_mirror = |bands| !Materials::of(scene, bands).scatter();
    let mut groups = kernel::band_groups(scene, &(0..BAND_COUNT)).into_iter();
    match scene.surfaces.iter().any(stands_free) && groups.any(is_mirror) {
        true => Some(&COMMON_ERRORS_IN_SHADOWS),
        false => Some(&COMMON_ERRORS),
    }
}

/// How far the sphere reaches in distances of a room's wall.
const BEHIND_WALLS: f32 = 2.0;

/// Crossings that a wave has in a chunk, on average. A chunk costs as much as ten iterations, and a wave that crosses
/// oftener than is recorded (four times) is drawn once more: in a room of 8 × 3 × 5 m a response of 65,536 waves takes
/// 0.39, 0.37, 0.35, 0.33 and 0.33 s with 8, 12, 16, 24 and 32 iterations in a chunk, which are 0.6 to 2.6 crossings.
const CROSSINGS_IN_CHUNK: f64 = 2.0;

/// Iterations of a chunk at the least.
const LEAST_ITERATIONS: u32 = 8;

/// Follows the waves, adds what stays a statistic to the echogram, and tells the early arrivals: these are
/// counted in the listener itself.
pub(super) fn arrivals(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &ResponseSettings,
    how: &ArrivalSettings,
    echogram: &mut Echogram,
) -> Result<(ArrivalCounts, Vec<Arrival>), Error> {
    let mut all = Followed::default();
    let mut early = Vec::new();
    for bands in kernel::band_groups(scene, &how.bands) {
        let how = how.clone().with_bands(bands);
        let followed = arrivals_of_bands(tracer, scene, settings, &how, (echogram, &mut early))?;
        all = all.and(followed);
    }
    // They come by bands, and by chunks of iterations.
    early.sort_by_key(|arrival: &Arrival| arrival.wave);
    Ok((all.counts(), early))
}

/// Those of waves that tell of `how.bands` together: what stays a statistic goes into the echogram, the others into the
/// list.
fn arrivals_of_bands(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &ResponseSettings,
    how: &ArrivalSettings,
    (echogram, early): (&mut Echogram, &mut Vec<Arrival>),
) -> Result<Followed, Error> {
    let medium = Medium::of(scene);
    let all = WavesToFollow::Numbers(0..settings.trace.waves);
    let share = (scene.listener.radius / radius_m(scene)).powi(2);
    let trace = settings.late_trace();
    if share >= 1.0 && trace == settings.trace {
        let mut sort = |arrival: Arrival| match arrival.is_early {
            true => early.push(arrival),
            false => medium.add(echogram, &arrival),
        };
        return tracer.arrivals_of(scene, &settings.trace, how, &all, &mut sort);
    }
    let few = how.clone().with_iterations(how.early_order + 1);
    let mut keep = |arrival: Arrival| {
        if arrival.is_early {
            early.push(arrival);
        }
    };
    let counts = tracer
        .arrivals_of(scene, &settings.trace, &few, &all, &mut keep)?
        .counts;
    let wide = widened(scene);
    let mut how = how.clone();
    let crossings = f64::from(1.0 / share) * crossings_an_iteration(&counts);
    how.iterations_in_chunk = iterations_in_chunk(crossings, how.iterations_in_chunk);
    let late = LateWaves {
        tracer,
        scene: &wide,
        how: &how,
        medium,
        echogram,
    };
    // Where surfaces gather sound, waves of one direction part: it tells little.
    let pilot_waves = match share < 1.0 {
        true => importance::pilot_waves(scene, &how.bands, &trace),
        false => 0,
    };
    late.follow_all(&trace, pilot_waves, settings.batches)
}

/// Waves whose late arrivals are added to an echogram.
struct LateWaves<'a> {
    tracer: &'a mut Tracer,
    scene: &'a Scene,
    how: &'a ArrivalSettings,
    medium: Medium,
    echogram: &'a mut Echogram,
}

impl LateWaves<'_> {
    /// Follows all waves. The first of them, the pilot waves, tell whether the others start evenly.
    fn follow_all(
        mut self,
        trace: &Settings,
        pilot_waves: u32,
        batches: usize,
    ) -> Result<Followed, Error> {
        if pilot_waves == 0 {
            let all = WavesToFollow::Numbers(0..trace.waves);
            return self.follow(trace, &all, None);
        }
        let before = self.echogram.clone();
        let half = pilot_waves / 2;
        let mut pilot = Pilot::new(pilot_waves, self.how.seconds);
        pilot.begin(half);
        let first = self.follow(trace, &WavesToFollow::Numbers(0..half), Some(&mut pilot))?;
        let few = trace.clone().with_waves(half);
        let mut directions = self.tracer.start_directions(&few)?;
        let Some(importance) = Importance::of(&pilot, &directions, trace.waves) else {
            let numbers = WavesToFollow::Numbers(half..trace.waves);
            return Ok(first.and(self.follow(trace, &numbers, None)?));
        };
        // The first half's energies are shares of those of all waves; these are made so too.
        let share = half as f32 / trace.waves as f32;
        let mut starts = importance.starts(0..half, half, batches, !trace.seed);
        starts.iter_mut().for_each(|start| start.weight *= share);
        directions.extend(starts.iter().map(|start| start.direction));
        pilot.begin(half);
        let of =
            |numbers: Range<u32>| starts[numbers.start as usize..numbers.end as usize].to_vec();
        let drawn = WavesToFollow::Starts {
            waves: half,
            of: &of,
        };
        self.follow(trace, &drawn, Some(&mut pilot))?;
        let importance = Importance::refined(&pilot, &directions);
        *self.echogram = before;
        let waves = trace.waves - pilot_waves;
        let of = |numbers| importance.starts(numbers, waves, batches, trace.seed);
        let starts = WavesToFollow::Starts { waves, of: &of };
        self.follow(trace, &starts, None)
    }

    fn follow(
        &mut self,
        trace: &Settings,
        waves: &WavesToFollow,
        mut pilot: Option<&mut Pilot>,
    ) -> Result<Followed, Error> {
        let (medium, echogram) = (&self.medium, &mut *self.echogram);
        let mut take = |arrival: Arrival| {
            if arrival.is_early {
                return;
            }
            medium.add(echogram, &arrival);
            if let Some(pilot) = &mut pilot {
                let seconds = arrival.length_m / medium.speed;
                pilot.add(arrival.wave, seconds, &medium.heard(&arrival));
            }
        };
        self.tracer
            .arrivals_of(self.scene, trace, self.how, waves, &mut take)
    }
}

/// How often a wave has crossed the listener in an iteration, on average.
fn crossings_an_iteration(counts: &ArrivalCounts) -> f64 {
    counts.arrivals as f64 / (counts.waves as f64 * f64::from(counts.iterations)).max(1.0)
}

/// Iterations of a chunk in which a wave has so many crossings an iteration, `most` at the most.
fn iterations_in_chunk(crossings: f64, most: u32) -> u32 {
    let fit = CROSSINGS_IN_CHUNK / crossings;
    (fit as u32).max(LEAST_ITERATIONS).min(most)
}

/// The scene with the sphere as its listener.
pub(super) fn widened(scene: &Scene) -> Scene {
    let mut wide = scene.clone();
    wide.listener.radius = radius_m(scene);
    wide
}

/// Radius of the sphere in metres, at least that of the listener.
fn radius_m(scene: &Scene) -> f32 {
    let listener = &scene.listener;
    let reach = |surface: &Surface| {
        let distance = surface.distance(listener.position);
        match surface.shape.node {
            Node::Room(_) => BEHIND_WALLS * distance,
            _ if surface.shape.properties().convex => distance,
            // What is hollow gathers sound.
            _ => 0.0,
        }
    };
    let reaches = scene.surfaces.iter().map(reach);
    reaches.fold(RADIUS_M, f32::min).max(listener.radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, Room, Sphere};
    use crate::{Listener, Source};
    use glam::Vec3;

    fn radius(surfaces: Vec<Surface>, listener: Vec3) -> f32 {
        let listener = Listener::at(listener, 0.3);
        radius_m(&Scene::new("late", surfaces, Source::at(Vec3::Y), listener))
    }

    /// Protects the sphere from other rooms, from foci, and from being smaller than the listener.
    #[test]
    fn the_sphere_is_large_where_nothing_is_near() {
        let room = Surface::new(Room {
            size: Vec3::new(10.0, 4.0, 6.0),
        });
        let wall = Surface::new(Cuboid {
            size: Vec3::new(0.1, 4.0, 6.0),
        });
        let hollow = Surface::new(crate::Shape::from(Sphere { radius: 9.0 }).complement());
        assert_eq!(radius(vec![room.clone()], Vec3::ZERO), RADIUS_M);
        assert!((radius(vec![room.clone()], Vec3::X * 4.6) - 0.8).abs() < 1e-5);
        assert_eq!(radius(vec![room.clone()], Vec3::X * 4.9), 0.3);
        assert!((radius(vec![room, wall], Vec3::X * 0.65) - 0.6).abs() < 1e-5);
        assert_eq!(radius(vec![hollow], Vec3::ZERO), 0.3);
    }

    /// Protects the errors of figures behind obstacles: they are larger there, and none where the sphere is not.
    #[test]
    fn shadows_make_the_larger_sphere_less_exact() {
        let room = Surface::new(Room {
            size: Vec3::new(10.0, 4.0, 6.0),
        });
        let ball = Surface::new(Sphere { radius: 0.5 }).at(Vec3::X * 3.0);
        let errors = |surfaces: Vec<Surface>, radius: f32| {
            let listener = Listener::at(Vec3::ZERO, radius);
            let scene = Scene::new("late", surfaces, Source::at(Vec3::Y), listener);
            common_errors(&scene).map(|errors| errors.decay_share)
        };
        assert_eq!(errors(vec![room.clone()], 0.3), Some(0.003));
        assert_eq!(errors(vec![room.clone(), ball.clone()], 0.3), Some(0.012));
        assert_eq!(errors(vec![room, ball], 1.5), None);
    }

    /// Protects the time that late arrivals take: a chunk has some crossings, and is neither endless nor empty.
    #[test]
    fn chunks_are_short_where_waves_cross_often() {
        for (crossings, iterations) in [(0.0, 64), (0.01, 64), (0.1, 20), (0.25, 8), (3.0, 8)] {
            assert_eq!(
                iterations_in_chunk(crossings, 64),
                iterations,
                "{crossings}"
            );
        }
        // Where loops allow fewer than it should have.
        assert_eq!(iterations_in_chunk(0.01, 20), 20);
        assert_eq!(iterations_in_chunk(3.0, 5), 5);
    }
}
