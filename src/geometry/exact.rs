//! Traces waves in closed form, so that every flight ends exactly on the surface that it hits.
//!
//! Rules for cases that floating-point arithmetic cannot decide:
//! - A wave that was reflected by a convex surface cannot hit this surface next, and is not tested against it. In a
//!   room, a wave is not tested against the face that it has just left.
//! - In an edge of a room, a wave hits both faces in succession, the second after 0 m: two reflections, two iterations.
//! - Faces of a box that lie on or behind a plane or a wall of a room have no air in front of them and cannot be hit.
//!   No wave can enter between the box and the wall.
//! - At equal distances, the listener takes precedence over a surface.

use super::closed_form::Placed;
#[cfg(any(test, feature = "reference"))]
use super::ear::Ear;
use super::hierarchy::Hierarchy;
use super::intersection::{Face, Intersection};
use crate::scene::{IntoPair, Pair, SceneError};
use glam::DVec3;

/// Error bound of positions, as a share of the scene's extent: a few hundred units in the last place.
const ROUNDING: f64 = 1e-13;

/// Margin of the bounding boxes of surfaces, as a share of the scene's extent: a millimetre in a hundred metres. All
/// intersection tests decide at much smaller distances from a surface.
const SPARE: f64 = 1e-5;

/// A scene for exact tracing, in its current state. [`Scene::at`](crate::Scene::at) gives the state of moving sources
/// and listeners at a certain time.
#[derive(Clone, Debug)]
pub struct ExactScene {
    pub(super) surfaces: Vec<Placed>,
    /// The surfaces with a closed form, followed by the marched surfaces. A march does not continue beyond a hit of a
    /// surface with a closed form.
    pub(super) hierarchies: [Hierarchy; 2],
    /// Indices of the surfaces whose distance can be less than that to their bounding box.
    pub(super) with_bounds_of_distance: Vec<u32>,
    #[cfg(any(test, feature = "reference"))]
    pub(super) ear: Ear,
    /// Error bound of positions in metres.
    pub(super) error_bound: f64,
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
            #[cfg(any(test, feature = "reference"))]
            ear: Ear::of(listener),
            error_bound,
        })
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

    /// The largest coordinate of the scene in metres.
    pub(crate) fn extent_m(&self) -> f64 {
        self.error_bound / ROUNDING
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
