//! Traces waves in closed form: every flight ends exactly on the surface that it hits.
//!
//! Rules for cases that arithmetic cannot decide:
//! - A wave that has just been mirrored at a convex surface cannot hit that surface next and is not tested against it;
//!   in a room it is not tested against the face that it has just left.
//! - In an edge of a room, a wave hits two faces in turn, the second after 0 m: two reflections, two iterations.
//! - The faces of a box that lie on or behind a room's wall or a plane have no air in front of them and cannot be hit;
//!   no wave can get in between box and wall.
//! - At the same distance, the listener comes before a surface.

use super::closed_form::{Face, Intersection, Placed, intersect_sphere};
use super::hierarchy::Hierarchy;
use crate::sampling::{FNV_EMPTY, fnv_with};
use crate::scene::{IntoPair, Pair, SceneError};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Rounding of the scene, as a share of its extent: a few hundred units in the last place.
const ROUNDING: f64 = 1e-13;

/// Margin of the boxes around surfaces, as a share of the scene's extent: a millimetre in a hundred metres. Marching
/// and missing lines are decided at much smaller distances from a surface.
const SPARE: f64 = 1e-5;

/// Minimum number of waves per thread, below which starting the thread does not pay off.
const WAVES_WORTH_A_THREAD: usize = 4096;

/// A scene to trace waves through exactly, in its current state (use [`Scene::at`](crate::Scene::at) to follow moving sources and
/// listeners).
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
    /// The surfaces with a closed form, then the marched surfaces: a march need not go beyond a hit of the former.
    pub(super) hierarchies: [Hierarchy; 2],
    ear: Ear,
    /// Rounding of the scene in metres.
    pub(super) error_bound: f64,
}

/// The listener in `f64`.
#[derive(Clone, Copy, Debug)]
struct Ear {
    centre: DVec3,
    radius: f64,
    right: DVec3,
}

/// The end of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Hit {
    /// Length of the flight in metres.
    pub t: f64,
    /// 0 for the listener, n for surface n, counted from 1.
    pub object: u32,
    /// World position in metres, on the surface.
    pub point: DVec3,
    /// Unit vector in world axes, from the solid into the air.
    pub normal: DVec3,
}

/// The state of a wave after its last iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExactWave {
    /// 0 = heard, −1 = dead, n = last mirrored at surface n, counted from 1.
    pub status: i32,
    /// Number of reflections; for a heard wave, its order.
    pub order: u32,
    /// Number of reflections at spheres and cylinders, which multiply errors.
    pub curved_hits: u32,
    /// World position in metres of its last hit, or its start if it has none.
    pub point: DVec3,
    /// Unit vector in world axes of its further flight: mirrored at a surface, unchanged at the listener and for a dead
    /// wave.
    pub direction: DVec3,
    /// Unit vector in world axes of its flight to `point`.
    pub incoming_direction: DVec3,
    /// Length in metres of the path from the start to `point`.
    pub length: f64,
    /// A hash of the objects hit, in order, including the listener (0): two waves with the same hash have hit the same
    /// objects.
    pub sequence_hash: u64,
}

/// A hit of a wave, in the order of its flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathVertex {
    /// World position in metres.
    pub point: DVec3,
    /// 0 for the listener, n for surface n, counted from 1.
    pub object: u32,
    /// Unit vector in world axes, from the solid (or the listener) into the air.
    pub normal: DVec3,
}

/// A hash of the objects that a wave hit, in order (0 = listener): two waves with the same hash have hit the same
/// objects.
///
/// FNV-1a over whole object numbers instead of bytes.
pub fn sequence_hash(objects: &[u32]) -> u64 {
    objects
        .iter()
        .fold(FNV_EMPTY, |hash, object| fnv_with(hash, u64::from(*object)))
}

/// The index of the surface that a wave has just left, and its face, if it has faces.
pub(super) type Left = Option<(usize, Option<Face>)>;

/// A hit of a surface, with the surface's index and face, if it has faces.
pub(super) type Met = (Hit, (usize, Option<Face>));

impl ExactScene {
    /// Copies the surfaces and the listener of a pair, or of a scene that has one of each.
    ///
    /// # Errors
    /// [`SceneError`] as from [`Scene::validate`](crate::Scene::validate), and for a scene of which no pair was
    /// [chosen](crate::Scene::pair).
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
        Ok(ExactScene {
            surfaces,
            hierarchies,
            ear,
            error_bound,
        })
    }

    /// Signed distance in metres from a world point to the nearest surface, negative in a solid;
    /// ignores the listener.
    pub fn surface_distance(&self, point: DVec3) -> f64 {
        self.surfaces
            .iter()
            .map(|surface| surface.distance(point))
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether a world point lies in a solid by more than `depth` metres.
    pub(crate) fn is_in_solid(&self, point: DVec3, depth: f64) -> bool {
        let is_in = |index: usize| self.surfaces[index].distance(point) < -depth;
        let mut hierarchies = self.hierarchies.iter();
        hierarchies.any(|hierarchy| hierarchy.any_near(point, 0.0, is_in))
    }

    /// [`ExactScene::surface_distance`] if the box of a surface is within `reach` metres; otherwise at least `reach`.
    pub(crate) fn distance_within(&self, point: DVec3, reach: f64) -> f64 {
        let mut nearest = reach;
        for hierarchy in &self.hierarchies {
            hierarchy.any_near(point, reach, |index| {
                nearest = nearest.min(self.surfaces[index].distance(point));
                false
            });
        }
        nearest
    }

    /// The first hit of a wave that starts in the air at `origin` (world metres) and flies along `direction` (any
    /// length except 0); `None` if it hits neither a surface nor the listener.
    ///
    /// A start inside the listener's sphere gives a hit of the listener after 0 m.
    pub fn closest_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let direction = direction.try_normalize()?;
        self.next(origin, direction, None).map(|(hit, _)| hit)
    }

    /// Follows one wave for at most `iterations` flights from `start` (world metres)
    /// along `direction` (any length).
    ///
    /// A wave without a direction or iterations remains at its start with status −1, and so does a wave that starts in
    /// a solid, which carries no sound.
    pub fn trace(&self, start: DVec3, direction: DVec3, iterations: u32) -> ExactWave {
        self.walk(start, direction, iterations, |_| ())
    }

    /// Every hit of the wave of [`ExactScene::trace`], without its start.
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

    /// [`ExactScene::trace`] for many directions from one start, in their order, on the threads of rayon's pool; the
    /// result does not depend on the number of threads.
    pub fn trace_all(&self, start: DVec3, directions: &[Vec3], iterations: u32) -> Vec<ExactWave> {
        let trace = |direction: &Vec3| self.trace(start, direction.as_dvec3(), iterations);
        let shares = directions.par_iter().with_min_len(WAVES_WORTH_A_THREAD);
        shares.map(trace).collect()
    }

    /// Lateral position on the listener's sphere where a wave arrived: −1 at the left ear, 0
    /// anywhere on the plane between the ears, 1 at the right ear; `None` if it is not heard.
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

    /// The next hit, and the surface and face that the wave leaves when it is mirrored there; `None` in place of these
    /// for the listener.
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

    /// The next surface nearer than `until` metres, ignoring the listener, and the surface and face that the wave
    /// leaves when it is mirrored there. Also returns the number of surfaces and bounding boxes that were tested.
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
            // At equal distances the hit is on the surface that comes first in the scene.
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
    /// A wave that has not hit anything yet.
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
    // One Newton step towards length 1; otherwise errors of the normals would add up.
    mirrored * (1.5 - 0.5 * mirrored.length_squared())
}

/// The flight of a wave after its last hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LastFlight {
    /// Start in world metres.
    pub origin: DVec3,
    /// Unit vector in world axes.
    pub direction: DVec3,
    /// Whether the flight is known to hit no further surface.
    pub is_free: bool,
    /// Number of surfaces and bounding boxes tested so far.
    pub asked: u64,
}

impl ExactScene {
    /// Rounding of this scene in metres: see [`super`].
    pub(crate) fn rounding(&self) -> f64 {
        self.error_bound
    }

    /// Follows one wave from `start` (world metres) along the unit vector `direction`, through the listener, for at
    /// most `reflections` reflections; calls `visit` with every hit in order.
    ///
    /// Returns the flight after the last hit; `None` if the wave starts in a solid.
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

    /// The first surface nearer than `until` metres on the line from `origin` along the unit
    /// vector `direction`.
    ///
    /// For a line that starts on a surface, `leaving` holds that surface's number, counted from 1, and the unit normal
    /// at the start.
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
        Some((index, placed.is_room().then(|| wall(placed, normal))))
    }
}

/// The face of a room with this unit normal into the air, in world axes.
fn wall(room: &Placed, normal: DVec3) -> Face {
    let normal = room.local(normal);
    let size = normal.abs();
    let axis = (1..3).fold(
        0,
        |most, axis| if size[axis] > size[most] { axis } else { most },
    );
    Face {
        axis,
        positive: normal[axis] < 0.0,
    }
}
