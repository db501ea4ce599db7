//! Traces waves in closed form, so that every flight ends exactly on the surface that it hits.
//!
//! Rules for cases that floating-point arithmetic cannot decide:
//! - A wave that was reflected by a convex surface cannot hit this surface next, and is not tested against it. In a
//!   room, a wave is not tested against the face that it has just left.
//! - In an edge of a room, a wave hits both faces in succession, the second after 0 m: two reflections, two iterations.
//! - Faces of a box that lie on or behind a plane or a wall of a room have no air in front of them and cannot be hit.
//!   No wave can enter between the box and the wall.
//! - At equal distances, the listener takes precedence over a surface.

use super::closed_form::{Placed, intersect_sphere};
use super::hierarchy::Hierarchy;
use super::intersection::{Face, Intersection};
use crate::sampling::{FNV_EMPTY, fnv_with};
use crate::scene::{IntoPair, Pair, SceneError};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Error bound of positions, as a share of the scene's extent: a few hundred units in the last place.
pub(super) const ROUNDING: f64 = 1e-13;

/// Margin of the bounding boxes of surfaces, as a share of the scene's extent: a millimetre in a hundred metres. All
/// intersection tests decide at much smaller distances from a surface.
const SPARE: f64 = 1e-5;

/// Minimum number of waves per thread. For fewer waves, the start of a thread costs more than it saves.
const WAVES_WORTH_A_THREAD: usize = 4096;

/// A scene for exact tracing, in its current state. [`Scene::at`](crate::Scene::at) gives the state of moving sources
/// and listeners at a certain time.
///
/// ```
/// use echomarch::{Scene, geometry::ExactScene};
/// use glam::DVec3;
/// let scene = Scene::builtin("shoebox")?;
/// let exact = ExactScene::new(&scene)?;
/// let start = scene.sources[0].position.as_dvec3();
/// let wave = exact.trace(start, DVec3::NEG_X, 1);
/// assert_eq!((wave.status, wave.length), (1, 2.5)); // the wall at x = -6
/// # Ok::<(), echomarch::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ExactScene {
    pub(super) surfaces: Vec<Placed>,
    /// The surfaces with a closed form, followed by the marched surfaces. A march does not continue beyond a hit of a
    /// surface with a closed form.
    pub(super) hierarchies: [Hierarchy; 2],
    /// Indices of the surfaces whose distance can be less than that to their bounding box.
    pub(super) with_bounds_of_distance: Vec<u32>,
    ear: Ear,
    /// Error bound of positions in metres.
    pub(super) error_bound: f64,
}

/// The listener, in `f64`.
#[derive(Clone, Copy, Debug)]
struct Ear {
    centre: DVec3,
    radius: f64,
    right: DVec3,
}

/// The hit at the end of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Hit {
    /// Length of the flight in metres.
    pub t: f64,
    /// Number of the hit object: 0 for the listener, n for surface n, counted from 1.
    pub object: u32,
    /// World position in metres, on the surface of the object.
    pub point: DVec3,
    /// Unit vector in world axes, from the solid into the air.
    pub normal: DVec3,
}

/// The state of a wave after its last iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExactWave {
    /// 0 = heard, −1 = dead, n = last reflected by surface n, counted from 1.
    pub status: i32,
    /// Number of reflections. For a heard wave this is its order.
    pub order: u32,
    /// Number of reflections by curved surfaces, which multiply errors.
    pub curved_hits: u32,
    /// World position of the last hit in metres, or of the start if the wave has no hits.
    pub point: DVec3,
    /// Unit vector in world axes after the last hit: reflected at a surface, unchanged at the listener and for a dead
    /// wave.
    pub direction: DVec3,
    /// Unit vector in world axes of the flight to `point`.
    pub incoming_direction: DVec3,
    /// Length of the path from the start to `point` in metres.
    pub length: f64,
    /// Hash of the numbers of the hit objects in order, including the listener (0). Waves with the same hash have hit
    /// the same objects.
    pub sequence_hash: u64,
}

/// A hit of a wave. The hits of a path are in the order of the flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathVertex {
    /// World position in metres.
    pub point: DVec3,
    /// Number of the hit object: 0 for the listener, n for surface n, counted from 1.
    pub object: u32,
    /// Unit vector in world axes, from the solid (or the listener) into the air.
    pub normal: DVec3,
}

/// Hash of the numbers of the objects that a wave hit, in order (0 = listener). Waves with the same hash have hit the
/// same objects.
///
/// The hash is FNV-1a over whole object numbers instead of bytes.
pub fn sequence_hash(objects: &[u32]) -> u64 {
    objects
        .iter()
        .fold(FNV_EMPTY, |hash, object| fnv_with(hash, u64::from(*object)))
}

/// The index of the surface that a wave has just left, and the face, if the surface has faces.
pub(super) type Left = Option<(usize, Option<Face>)>;

/// A hit of a surface, with the index of the surface and the face, if the surface has faces.
pub(super) type Met = (Hit, (usize, Option<Face>));

impl ExactScene {
    /// Copies the surfaces and the listener of a pair, or of a scene with exactly one source and one listener.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`](crate::Scene::validate), and [`SceneError::NotOnePair`] for a scene that does
    /// not have exactly one source and one listener (see [`Scene::pair`](crate::Scene::pair)).
    pub fn new<'a>(pair: impl IntoPair<'a>) -> Result<ExactScene, SceneError> {
        ExactScene::of_pair(pair.chosen()?)
    }

    fn of_pair(pair: Pair) -> Result<ExactScene, SceneError> {
        let Pair {
            scene,
            source,
            listener,
            ..
        } = pair;
        scene.validate()?;
        let mut surfaces: Vec<Placed> = scene.surfaces.iter().map(Placed::new).collect();
        let (sin_yaw, cos_yaw) = f64::from(listener.yaw).sin_cos();
        let ear = Ear {
            centre: listener.position.as_dvec3(),
            radius: listener.radius.into(),
            right: DVec3::new(cos_yaw, 0.0, sin_yaw),
        };
        let places = [source.position, listener.position];
        let extent = surfaces
            .iter()
            .map(Placed::extent)
            .chain(places.map(|place| place.as_dvec3().abs().max_element()))
            .fold(0.0, f64::max);
        let error_bound = extent * ROUNDING;
        let walls: Vec<_> = surfaces.iter().flat_map(Placed::walls).collect();
        for surface in &mut surfaces {
            surface.mark_covered_faces(&walls, error_bound);
        }
        let spare = DVec3::splat(extent * SPARE);
        let hierarchies = [false, true].map(|is_marched| {
            let all = (0..).zip(&surfaces);
            let of_kind = all.filter(|(_, surface)| surface.is_marched() == is_marched);
            let boxes = of_kind.map(|(index, surface)| (index, surface.bounds().grown(spare)));
            Hierarchy::new(boxes.collect())
        });
        let all = (0..).zip(&surfaces);
        let with_bounds = all.filter(|(_, surface)| !surface.has_exact_distance());
        Ok(ExactScene {
            with_bounds_of_distance: with_bounds.map(|(index, _)| index).collect(),
            surfaces,
            hierarchies,
            ear,
            error_bound,
        })
    }

    /// The first hit of a wave that starts in the air at `origin` (world metres) along `direction` (any length except
    /// 0); `None` if the wave hits neither a surface nor the listener.
    ///
    /// If the start is inside the listener's sphere, the wave hits the listener after 0 m.
    pub fn closest_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let direction = direction.try_normalize()?;
        self.next(origin, direction, None).map(|(hit, _)| hit)
    }

    /// Traces one wave for at most `iterations` flights from `start` (world metres) along `direction` (any length).
    ///
    /// A wave without a direction or iterations remains at its start with status −1. So does a wave that starts in a
    /// solid, because it carries no sound.
    pub fn trace(&self, start: DVec3, direction: DVec3, iterations: u32) -> ExactWave {
        self.walk(start, direction, iterations, |_| ())
    }

    /// All hits of the wave that [`ExactScene::trace`] traces, without its start.
    #[doc(hidden)]
    pub fn trace_path(&self, start: DVec3, direction: DVec3, iterations: u32) -> Vec<PathVertex> {
        let mut path = Vec::new();
        self.walk(start, direction, iterations, |hit| {
            path.push(PathVertex {
                point: hit.point,
                object: hit.object,
                normal: hit.normal,
            });
        });
        path
    }

    /// Traces many directions from one start like [`ExactScene::trace`], on the threads of rayon's pool. The results
    /// are in the order of the directions, and do not depend on the number of threads.
    pub fn trace_all(&self, start: DVec3, directions: &[Vec3], iterations: u32) -> Vec<ExactWave> {
        let trace = |direction: &Vec3| self.trace(start, direction.as_dvec3(), iterations);
        let shares = directions.par_iter().with_min_len(WAVES_WORTH_A_THREAD);
        shares.map(trace).collect()
    }

    /// Lateral position on the listener's sphere at which a wave arrived: −1 at the left ear, 0 in the plane midway
    /// between the ears, 1 at the right ear. `None` if the wave is not heard.
    pub fn arrival_side(&self, wave: &ExactWave) -> Option<f64> {
        let outwards = (wave.point - self.ear.centre).normalize_or_zero();
        (wave.status == 0).then(|| outwards.dot(self.ear.right))
    }

    fn walk(
        &self,
        start: DVec3,
        direction: DVec3,
        iterations: u32,
        mut visit: impl FnMut(&Hit),
    ) -> ExactWave {
        let Some(direction) = direction.try_normalize().filter(|_| iterations > 0) else {
            return ExactWave::at(start, DVec3::ZERO);
        };
        let mut wave = ExactWave::at(start, direction);
        if self.is_in_solid(start, self.error_bound) {
            return wave;
        }
        let mut left = None;
        for _ in 0..iterations {
            wave.incoming_direction = wave.direction;
            let Some((hit, now_left)) = self.next(wave.point, wave.direction, left) else {
                wave.status = -1;
                break;
            };
            visit(&hit);
            wave.point = hit.point;
            wave.length += hit.t;
            wave.status = hit.object as i32;
            wave.sequence_hash = fnv_with(wave.sequence_hash, u64::from(hit.object));
            let Some((index, _)) = now_left else {
                break;
            };
            wave.direction = mirror(wave.direction, hit.normal);
            wave.order += 1;
            wave.curved_hits += u32::from(self.surfaces[index].is_curved());
            left = now_left;
        }
        wave
    }

    /// The next hit. If the wave is reflected, also returns the surface and face that the wave leaves; `None` for the
    /// listener.
    fn next(&self, origin: DVec3, direction: DVec3, left: Left) -> Option<(Hit, Left)> {
        let heard = self.ear.intersect(origin, direction);
        let until = heard.unwrap_or(f64::INFINITY);
        let (met, _) = self.next_surface(origin, direction, left, until);
        match (met, heard) {
            (Some((hit, left)), _) => Some((hit, Some(left))),
            (None, Some(t)) => Some((self.ear.hit(origin, direction, t), None)),
            (None, None) => None,
        }
    }

    /// The next hit of a surface nearer than `until` metres, with the surface and face that the reflected wave leaves.
    /// The listener is ignored. Also returns the number of surfaces and bounding boxes that were tested.
    pub(super) fn next_surface(
        &self,
        origin: DVec3,
        direction: DVec3,
        left: Left,
        until: f64,
    ) -> (Option<Met>, u64) {
        let mut met: Option<(usize, Intersection)> = None;
        let mut ask = |index: usize, nearest: f64| {
            let surface = &self.surfaces[index];
            let left_face = match left {
                Some((last, face)) if last == index && surface.is_room() => face,
                Some((last, _)) if last == index && surface.is_convex() => return nearest,
                _ => None,
            };
            let found = surface.intersect(origin, direction, left_face, self.error_bound, nearest);
            let Some(found) = found else {
                return nearest;
            };
            // At equal distances, the first surface in the scene is hit.
            let is_before = met.is_some_and(|(other, _)| index < other);
            if found.t < nearest || (found.t == nearest && is_before) {
                met = Some((index, found));
                return found.t;
            }
            nearest
        };
        let mut nearest = until;
        let mut asked = 0;
        for hierarchy in &self.hierarchies {
            asked += hierarchy.along(origin, direction, nearest, |index, until| {
                nearest = ask(index, until);
                nearest
            });
        }
        let hit = met.map(|(index, met)| {
            let (point, normal) = self.surfaces[index].project(origin, direction, met);
            let hit = Hit {
                t: met.t,
                object: index as u32 + 1,
                point,
                normal,
            };
            (hit, (index, met.face))
        });
        (hit, asked)
    }
}

impl Ear {
    fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let offset = origin - self.centre;
        if offset.length_squared() <= self.radius * self.radius {
            return Some(0.0);
        }
        intersect_sphere(self.radius, offset, direction)
    }

    fn hit(&self, origin: DVec3, direction: DVec3, t: f64) -> Hit {
        let arrived = origin + direction * t;
        let normal = (arrived - self.centre).normalize_or(-direction);
        let point = if t > 0.0 {
            self.centre + normal * self.radius
        } else {
            arrived
        };
        Hit {
            t,
            object: 0,
            point,
            normal,
        }
    }
}

impl ExactWave {
    /// A wave without hits.
    fn at(start: DVec3, direction: DVec3) -> ExactWave {
        ExactWave {
            status: -1,
            order: 0,
            curved_hits: 0,
            point: start,
            direction,
            incoming_direction: direction,
            length: 0.0,
            sequence_hash: FNV_EMPTY,
        }
    }
}

pub(super) fn mirror(direction: DVec3, normal: DVec3) -> DVec3 {
    let mirrored = direction - normal * (2.0 * direction.dot(normal));
    // One Newton step towards length 1, because the errors of the normals would otherwise accumulate.
    mirrored * (1.5 - 0.5 * mirrored.length_squared())
}

/// The flight of a wave after its last reflection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LastFlight {
    /// Start in world metres.
    pub origin: DVec3,
    /// Unit vector in world axes.
    pub direction: DVec3,
    /// Whether the flight is known to hit no surface.
    pub is_free: bool,
    /// Number of surfaces and bounding boxes that were tested for the whole path.
    pub asked: u64,
}

impl ExactScene {
    /// Error bound of positions in this scene, in metres.
    pub(crate) fn rounding(&self) -> f64 {
        self.error_bound
    }

    /// Traces one wave from `start` (world metres) along the unit vector `direction`, for at most `reflections`
    /// reflections. The wave passes through the listener. Calls `visit` with every hit in order.
    ///
    /// Returns the flight after the last hit, or `None` if the wave starts in a solid.
    pub(crate) fn follow(
        &self,
        start: DVec3,
        direction: DVec3,
        reflections: u32,
        mut visit: impl FnMut(&Hit),
    ) -> Option<LastFlight> {
        if self.is_in_solid(start, self.error_bound) {
            return None;
        }
        let mut flight = LastFlight {
            origin: start,
            direction,
            is_free: false,
            asked: 0,
        };
        let mut left = None;
        for _ in 0..reflections {
            let (next, asked) =
                self.next_surface(flight.origin, flight.direction, left, f64::INFINITY);
            flight.asked += asked;
            let Some((hit, now_left)) = next else {
                flight.is_free = true;
                break;
            };
            visit(&hit);
            flight.origin = hit.point;
            flight.direction = mirror(flight.direction, hit.normal);
            left = Some(now_left);
        }
        Some(flight)
    }

    /// The first hit of a surface nearer than `until` metres on the line from `origin` along the unit vector
    /// `direction`.
    ///
    /// For a line that starts on a surface, `leaving` contains the number of this surface, counted from 1, and the unit
    /// normal at the start.
    pub(crate) fn first_surface(
        &self,
        origin: DVec3,
        direction: DVec3,
        leaving: Option<(u32, DVec3)>,
        until: f64,
    ) -> Option<Hit> {
        let left = leaving.and_then(|(surface, normal)| self.left(surface, normal));
        let (met, _) = self.next_surface(origin, direction, left, until);
        met.map(|(hit, _)| hit)
    }

    fn left(&self, surface: u32, normal: DVec3) -> Left {
        let index = (surface as usize).checked_sub(1)?;
        let placed = self.surfaces.get(index)?;
        Some((index, placed.is_room().then(|| placed.wall(normal))))
    }
}
