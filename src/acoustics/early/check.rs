//! Checks whether sound takes a stationary path.
//!
//! Rules for cases that arithmetic cannot decide, with *touch* = 10⁴ roundings of the scene, about
//! 10⁻⁹ of its extent:
//! - A point up to *touch* beyond the edge of a face is on the face.
//! - A reflection with a cosine below [`GRAZING`] does not count: the path cannot be distinguished from the
//!   one that goes straight on. But a source on a surface has an image there, also for a listener on it.
//! - A segment is free if it is shorter than 20 *touches*, or if it meets no surface until *touch* before its end; the
//!   surface at its end may be met earlier by *touch* ÷ cosine, as its distance is measured along the segment.
//! - Two points closer than *touch* lie in an edge, or are an end on a surface: between them the wave has the
//!   direction that mirroring gives (`flight.rs`). At an end that direction must come from the solid, or lead into
//!   it: otherwise, as before an edge of a box, the wave flies on in the air. In an edge that points into the air a
//!   wave that reaches several faces is mirrored by one of them, and the choice is ambiguous: there is no exact
//!   path, and its waves remain statistical.

use super::NoPath;
use super::surfaces::{Surfaces, Vertex};
use crate::reference::ExactScene;
use glam::DVec3;

/// Least cosine between a wave and a surface's normal: there rounding along the wave is 10⁹ times
/// that across the surface, 10⁻⁶ of the scene's extent.
const GRAZING: f64 = 1e-9;

/// Distance from an end at which the solid is probed, in *touches*: more than an end may be off its surface, for
/// directions that do not graze it.
pub(super) const PROBE_IN_TOUCHES: f64 = 1e3;

/// Shorter segments, in *touches*, lie next to an edge and count as free: twice the distance at which fields are
/// probed ahead of a point (`reference::marched`).
const SHORTEST_IN_TOUCHES: f64 = 20.0;

/// A path to check: `points` from source to listener, and for each reflection between them the
/// surface's number and its unit normal into the air.
pub(super) struct Checked<'a> {
    pub points: &'a [DVec3],
    pub surfaces: &'a [u32],
    pub normals: &'a [DVec3],
    /// The unit vectors of flight, one for each segment.
    pub directions: &'a [DVec3],
}

impl Checked<'_> {
    /// # Errors
    /// Checks the path; the error states why sound does not take it.
    pub fn is_taken(&self, exact: &ExactScene, surfaces: &Surfaces) -> Result<(), NoPath> {
        let inner = self.surfaces.iter().zip(&self.points[1..]);
        for (surface, point) in inner {
            if !surfaces.has(*surface, *point) {
                return Err(NoPath::OffSurface);
            }
        }
        let at_source = short(self.points.windows(2), surfaces.touch);
        for (i, normal) in self.normals.iter().enumerate() {
            let (to, from) = (self.directions[i], self.directions[i + 1]);
            let (to, from) = (to.dot(*normal), from.dot(*normal));
            // A source on a surface has an image there, also for directions along it.
            let least = if i < at_source { -GRAZING } else { GRAZING };
            if to > -least || from < least {
                return Err(NoPath::NotFromTheAir);
            }
        }
        self.edges_mirror(exact, surfaces)?;
        self.ends_mirror(exact, surfaces, at_source)?;
        let is_free = |(i, d): (usize, &DVec3)| self.is_free(exact, surfaces.touch, i, *d);
        match self.directions.iter().enumerate().all(is_free) {
            true => Ok(()),
            false => Err(NoPath::Blocked),
        }
    }

    /// Checks that each reflection in an edge, where two reflections away from the ends are at one point, comes from
    /// the air, at an edge that points into the solid: at one that points into the air a wave meets only one of the
    /// faces, and a face inside another solid does not reflect.
    fn edges_mirror(&self, exact: &ExactScene, surfaces: &Surfaces) -> Result<(), NoPath> {
        let end = EndOnSurface { exact, surfaces };
        for (i, pair) in self.normals.windows(2).enumerate() {
            let point = self.points[i + 1];
            if point.distance(self.points[i + 2]) > surfaces.touch {
                continue;
            }
            let in_solid = |normal: &DVec3| end.value(point, *normal) < -surfaces.touch;
            let across = pair[1] - pair[0];
            let is_one_face = across.length() <= SAME_NORMAL;
            if pair.iter().any(in_solid) || is_one_face {
                return Err(NoPath::NotFromTheAir);
            }
            if end.value(point, across.normalize()) > -surfaces.touch {
                return Err(NoPath::NotFromTheAir);
            }
        }
        Ok(())
    }

    /// Checks that each segment of length 0 at an end (`at_source` of them at the source) is mirrored
    /// there.
    fn ends_mirror(
        &self,
        exact: &ExactScene,
        surfaces: &Surfaces,
        at_source: usize,
    ) -> Result<(), NoPath> {
        if self.normals.is_empty() {
            return Ok(());
        }
        let end = EndOnSurface { exact, surfaces };
        let segments = self.directions.len();
        let at_listener = short(self.points.windows(2).rev(), surfaces.touch);
        if at_source == segments {
            return Ok(());
        }
        let leaves = self.directions[at_source];
        for i in 0..at_source {
            let mirror = (self.surfaces[i], self.normals[i]);
            end.mirrors(self.points[i], self.directions[i], mirror, leaves)?;
        }
        let comes_from = -self.directions[segments - at_listener - 1];
        for i in segments - at_listener..segments {
            let mirror = (self.surfaces[i - 1], self.normals[i - 1]);
            end.mirrors(self.points[i + 1], -self.directions[i], mirror, comes_from)?;
        }
        Ok(())
    }

    fn is_free(&self, exact: &ExactScene, touch: f64, segment: usize, direction: DVec3) -> bool {
        let (from, to) = (self.points[segment], self.points[segment + 1]);
        let length = from.distance(to);
        if length <= SHORTEST_IN_TOUCHES * touch {
            return true;
        }
        let left = segment.checked_sub(1);
        let leaving = left.map(|i| (self.surfaces[i], self.normals[i]));
        let Some(hit) = exact.first_surface(from, direction, leaving, length) else {
            return true;
        };
        let is_end = self.surfaces.get(segment) == Some(&hit.object);
        let tolerance = match is_end {
            true => touch / direction.dot(self.normals[segment]).abs(),
            false => touch,
        };
        hit.t >= length - tolerance
    }
}

/// Normals with a smaller difference belong to one face.
const SAME_NORMAL: f64 = 1e-6;

/// The surroundings of a source or a listener on a surface.
struct EndOnSurface<'a> {
    exact: &'a ExactScene,
    surfaces: &'a Surfaces,
}

impl EndOnSurface<'_> {
    /// Checks that a wave from a point on a surface along `direction` is mirrored there, by the surface with this
    /// number and normal, so that it finally leaves the point along `leaves`.
    fn mirrors(
        &self,
        point: DVec3,
        direction: DVec3,
        (surface, normal): (u32, DVec3),
        leaves: DVec3,
    ) -> Result<(), NoPath> {
        // A face that ends at the point mirrors waves that leave over it, but not those that leave
        // next to it.
        let over = point
            + leaves.reject_from_normalized(normal) * (PROBE_IN_TOUCHES * self.surfaces.touch);
        // A wave along a surface is on it.
        let touch = self.surfaces.touch;
        if self.value(point, direction) > touch || !self.surfaces.has(surface, over) {
            return Err(NoPath::NotFromTheAir);
        }
        let sheets = self.surfaces.sheets_at(surface, point);
        let against = |sheet: &&Vertex| direction.dot(sheet.normal) < -GRAZING;
        // Above one face and behind the other one there is air if the edge points into it.
        let into_air = |other: &Vertex| {
            let across = other.normal - normal;
            across.length() > SAME_NORMAL && self.value(point, across.normalize()) > -touch
        };
        match sheets.iter().filter(against).any(into_air) {
            true => Err(NoPath::AtEdge),
            false => Ok(()),
        }
    }

    /// The signed distance of the nearest surface at a probe next to a point on a surface, in this direction. Only
    /// surfaces near the point itself matter.
    fn value(&self, point: DVec3, direction: DVec3) -> f64 {
        let probe_m = PROBE_IN_TOUCHES * self.surfaces.touch;
        let probe = point + direction * probe_m;
        self.exact.distance_within(probe, 2.0 * probe_m)
    }
}

/// Number of these segments, from the first on, that have length 0.
fn short<'a>(segments: impl Iterator<Item = &'a [DVec3]>, touch: f64) -> usize {
    segments
        .take_while(|pair| pair[0].distance(pair[1]) <= touch)
        .count()
}
