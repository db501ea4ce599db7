//! The early part of an impulse response, computed exactly: specular paths from point to point.
//!
//! Waves traced from the source give the sequences of surfaces. The path of each sequence is then computed exactly, so
//! that delay and energy do not depend on the number of waves.
//!
//! # Finding a path
//! A sequence of planes has at most one path, found by mirror images of the source (Allen and Berkley 1979), in closed
//! form. All other paths are found by Newton's method on Fermat's condition, starting from the points where the wave
//! was mirrored. Each surface is represented by the smooth *sheet* that the wave hit. Planes, quadrics (balls,
//! cylinders, cones, ellipsoids, patches of a height field …) and rings have derivatives in closed form, also if moved,
//! turned, scaled, repeated, cut or grown. Blends, twists, bends and morphs use finite differences of their value. The
//! CPU knows users' GLSL fields only from samples: candidates mirrored at such fields are reported as
//! [`NoPath::NotExact`], and their waves remain statistical.
//!
//! Sound travels along a stationary path only if three conditions hold: its points lie on the surfaces themselves,
//! within their edges; each reflection comes from the air; and no surface obstructs it (users' fields are tested by
//! their samples). `check.rs` has rules for cases that rounded arithmetic cannot decide.
//!
//! Near a focus every wave passes the listener, so the number of waves from which the search starts is limited (see
//! `find.rs`).
//!
//! Each wave that arrived has an [outcome](Found::outcomes). If it found a path, the path replaces the wave. If its
//! surfaces are not exact, the wave is kept. All other waves passed through the listener's sphere, but no path leads to
//! its centre.
//!
//! # Spreading
//! A source of power 1 gives the listener the energy density 1/(4π A) in 1/m², where A is the area of the wave front
//! per solid angle at the start. A is computed by ray differentials (Igehy 1999) with the curvatures of the surfaces.
//! With planes only, A is the squared length.
//!
//! # Foci
//! Where a mirror focuses a front, A can be 0, and the density at a point infinite. A listener of radius r receives
//! less: if all waves pass through its centre, their chords are 2r, and the density in the sphere is 2r / (4/3 π r³) =
//! 3/(2π r²). A path whose front gives a higher density is marked as a focus, [`SpecularPath::is_focus`]. Its spreading
//! is limited to this bound times the share of all waves that found it. At a perfect focus all points of an area of the
//! mirror give the same length; the area counts as one path, with one of its points. To get the energy of a focus, use
//! the waves that found the path.
//!
//! # What the waves have missed
//! See [`Missed`].

mod candidates;
mod check;
mod fermat;
mod find;
mod paths;
mod sheet;
mod surfaces;
#[cfg(test)]
mod tests;
mod tree;

pub use candidates::{Candidate, Candidates};
pub use find::Found;
pub use paths::{Missed, SpecularPath};
pub use surfaces::Vertex;

use crate::geometry::ExactScene;
use crate::scene::{IntoPair, Pair, SceneError};
use candidates::Follow;
use check::EdgeStart;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use sheet::Sheet;
use std::f64::consts::TAU;
use surfaces::Surfaces;

/// Maximum number of reflections in solids whose faces are searched, those with the shortest paths: four times as many as
/// bend. A mesh may have thousands of faces.
const MOST_IN_SOLIDS: usize = 128;

/// The places on a face that may be seen: numbers of directions and of distances about its vertex, and the factor from one
/// distance to the next.
const SEEN_SIDES: u32 = 16;
const SEEN_STEPS: u32 = 16;
const SEEN_NEARER: f64 = 0.75;

/// Height above a face at which it is seen, in *touches*.
const LIFT_IN_TOUCHES: f64 = 1e3;

/// The surfaces of a scene as mirrors, for the search for paths.
#[derive(Clone, Debug)]
pub struct EarlyPaths {
    exact: ExactScene,
    surfaces: Surfaces,
}

/// The ends of paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// World position of the source in metres.
    pub source: DVec3,
    /// World position of the listener's centre in metres.
    pub listener: DVec3,
    /// Radius of the listener's sphere in metres, greater than 0: it limits the energy from a focus.
    pub radius_m: f64,
}

/// The reason why a candidate has no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoPath {
    /// A surface is known only from samples (a user's field): its waves remain statistical.
    NotExact,
    /// There is no stationary path over these surfaces, or the search from the wave did not find a path.
    NotStationary,
    /// The path would be mirrored beyond the edge of a surface.
    OffSurface,
    /// The path would reach a surface from inside the solid, or graze it.
    NotFromTheAir,
    /// A surface obstructs the path.
    Blocked,
    /// The source or the listener's centre is in a solid.
    EndInSolid,
    /// The path begins or ends in an edge or at a corner that points into the air, and flies against more than one of
    /// the faces there. It is then ambiguous which face mirrors the path.
    AtEdge,
    /// The search did not start from this wave, because there are too many waves at curved surfaces. The wave remains
    /// statistical.
    LeftOut,
}

impl Ends {
    /// The source and the listener of a pair.
    pub fn of(pair: Pair) -> Ends {
        Ends {
            source: pair.source.position.as_dvec3(),
            listener: pair.listener.position.as_dvec3(),
            radius_m: pair.listener.radius.into(),
        }
    }
}

impl EarlyPaths {
    /// Uses the surfaces of the pair's scene in its current state (motion is not followed: see
    /// [`Scene::at`](crate::Scene::at)).
    ///
    /// # Errors
    /// [`SceneError`] as from [`ExactScene::new`].
    pub fn new<'a>(pair: impl IntoPair<'a>) -> Result<EarlyPaths, SceneError> {
        let pair = pair.chosen()?;
        let exact = ExactScene::new(pair)?;
        let surfaces = Surfaces::new(pair, exact.rounding());
        Ok(EarlyPaths { exact, surfaces })
    }

    /// The surfaces in closed form.
    pub(crate) fn exact(&self) -> &ExactScene {
        &self.exact
    }

    /// The ends of paths: the pair's source and listener. An end that lies in a solid only because coordinates are
    /// rounded to `f32` is moved onto the surface.
    pub(crate) fn ends(&self, pair: Pair) -> Ends {
        let ends = Ends::of(pair);
        Ends {
            source: self.surfaces.out_of_rounding(ends.source),
            listener: self.surfaces.out_of_rounding(ends.listener),
            ..ends
        }
    }

    /// All candidates of [`EarlyPaths::candidates_within`].
    #[cfg(test)]
    fn candidates(&self, ends: &Ends, directions: &[Vec3], order: u32, reach_m: f64) -> Candidates {
        self.candidates_within(ends, directions, order, reach_m, u64::MAX)
    }

    /// Follows waves from the source along `directions` (of any length except 0) through the listener, for at most
    /// `order` reflections. Each flight that comes within `reach_m` metres of the listener's centre is a candidate. The
    /// index of a wave is the index of its direction.
    ///
    /// If `reach_m` is the listener's radius, the candidates are the waves that the listener receives, and [`Missed`]
    /// estimates the energy that the waves missed. A greater reach finds more paths with the same waves. In a room of
    /// planes use ∞, because further candidates of a sequence take no time there.
    ///
    /// Once more than `most_asked` surfaces and bounding boxes have been tested, no further waves are followed. A test
    /// takes about ten nanoseconds, and longer for marched fields. The waves left out ([`Candidates::left_out`]) are
    /// spread evenly among all directions, and do not depend on timing.
    ///
    /// Runs on the threads of rayon's pool; the result does not depend on the number of threads. Takes as long as
    /// [`ExactScene::trace_all`]. Marched fields take a thousand times as long as the basic shapes: with fields, follow
    /// only waves that are known to arrive.
    pub(crate) fn candidates_within(
        &self,
        ends: &Ends,
        directions: &[Vec3],
        order: u32,
        reach_m: f64,
        most_asked: u64,
    ) -> Candidates {
        let follow = Follow {
            exact: &self.exact,
            edge: EdgeStart::at(ends.source, &self.surfaces),
            ends,
            order,
            reach_m,
        };
        follow.all(directions, most_asked)
    }

    /// Adds each sequence of at most `order` planes over which sound could travel from the source to the listener if
    /// nothing obstructed it. It considers surfaces made only of shapes with planes
    /// ([`Room`](crate::scene::shape::Room), `Cuboid`, `Plane`, `HalfSpace`, `Prism`), moved, turned, scaled, inverted,
    /// united and cut. The sequences give paths, but they do not count among the waves that found these paths.
    ///
    /// Returns the number of reflections up to which all sequences were tried: `order`, or a smaller number if there
    /// are more than 131,072 images of the source. All sequences of one reflection are always tried.
    pub fn add_planes(&self, ends: &Ends, order: u32, candidates: &mut Candidates) -> u32 {
        candidates::add_plane_sequences(&self.surfaces, ends, order, candidates)
    }

    /// The reflections at planes whose point of reflection lies in a solid beside the face, if the source or the listener sees
    /// the face near this point: paths around the solid may be reflected there. The planes are those of
    /// [`EarlyPaths::add_planes`].
    pub(crate) fn reflections_in_solids(&self, ends: &Ends) -> Vec<Vertex> {
        let planes = self.surfaces.planes();
        let vertex = |(surface, sheet): &(u32, Sheet)| {
            let (normal, offset) = sheet.plane()?;
            let touch = self.surfaces.touch;
            let is_in_front = |end: DVec3| end.dot(normal) - offset > touch;
            if !is_in_front(ends.source) || !is_in_front(ends.listener) {
                return None;
            }
            let image = fermat::image(ends.source, normal, offset);
            let plane = (normal, offset);
            Some(Vertex {
                point: fermat::point_of_image(ends.listener, image, plane, touch)?,
                normal,
                surface: *surface,
            })
        };
        let length_m = |vertex: &Vertex| {
            ends.source.distance(vertex.point) + vertex.point.distance(ends.listener)
        };
        let mut all: Vec<Vertex> = planes.iter().filter_map(vertex).collect();
        all.sort_by(|a, b| length_m(a).total_cmp(&length_m(b)));
        let in_solids = all.into_iter().filter(|vertex| !self.is_open(vertex.point));
        let nearest: Vec<Vertex> = in_solids.take(MOST_IN_SOLIDS).collect();
        let seen = nearest.into_par_iter();
        seen.filter(|vertex| self.is_seen(vertex, ends)).collect()
    }

    /// Whether the source or the listener sees the plane face of a vertex in a solid, within the distance between both.
    fn is_seen(&self, vertex: &Vertex, ends: &Ends) -> bool {
        let touch = self.surfaces.touch;
        let first = vertex.normal.any_orthonormal_vector();
        let second = vertex.normal.cross(first);
        let apart_m = ends.source.distance(ends.listener);
        let mut places = (0..SEEN_SIDES * SEEN_STEPS).map(|index| {
            let angle = TAU * f64::from(index % SEEN_SIDES) / f64::from(SEEN_SIDES);
            let metres = apart_m * SEEN_NEARER.powi((index / SEEN_SIDES) as i32);
            vertex.point + (first * angle.cos() + second * angle.sin()) * metres
        });
        places.any(|place| {
            let lifted = place + vertex.normal * (LIFT_IN_TOUCHES * touch);
            let is_seen_from = |end: DVec3| self.exact.is_in_sight(end, lifted);
            self.surfaces.has(vertex.surface, place)
                && (is_seen_from(ends.source) || is_seen_from(ends.listener))
        })
    }

    /// The image of the source in these planes, mirrored in one plane after the other, in world metres.
    pub(crate) fn image(&self, ends: &Ends, planes: &[Vertex]) -> DVec3 {
        let mirror = |image, plane: &Vertex| {
            fermat::image(image, plane.normal, plane.point.dot(plane.normal))
        };
        planes.iter().fold(ends.source, mirror)
    }

    /// The wall of each of these reflections at a room; `None` at other surfaces.
    pub(crate) fn walls<'a>(
        &'a self,
        vertices: &'a [Vertex],
    ) -> impl Iterator<Item = Option<u8>> + 'a {
        let wall = |vertex| self.surfaces.sheet(vertex)?.wall;
        vertices.iter().map(wall)
    }

    /// Whether all of these reflections are at planes, so that every wave over them gives the same path.
    pub fn are_flat(&self, vertices: &[Vertex]) -> bool {
        vertices.iter().all(|vertex| self.surfaces.is_flat(vertex))
    }

    /// Whether a point is outside all solids.
    pub(crate) fn is_open(&self, place: DVec3) -> bool {
        !self.exact.is_in_solid(place, self.surfaces.touch)
    }

    /// Finds the paths of all candidates, and the direct sound unless it is blocked. There are no paths from or to a
    /// point in a solid.
    ///
    /// Runs on the threads of rayon's pool; the result does not depend on the number of threads.
    pub fn find(&self, ends: &Ends, candidates: &Candidates) -> Found {
        if !self.is_open(ends.source) || !self.is_open(ends.listener) {
            return Found::none(candidates, NoPath::EndInSolid);
        }
        find::find(&self.exact, &self.surfaces, ends, candidates)
    }
}
