//! Checks whether sound travels along a stationary path.
//!
//! Rules for cases that rounded arithmetic cannot decide. *Touch* is 10⁴ times the rounding error of the scene's
//! coordinates, about 10⁻⁹ of the scene's extent.
//! - A point up to *touch* beyond the edge of a face is on the face.
//! - A reflection with a cosine below [`GRAZING`] does not count: the path cannot be distinguished from a straight
//!   path. A source on a surface is an exception: its image in that surface counts, also for a listener on the same
//!   surface.
//! - A segment is free if it is shorter than 20 *touches*, or if it hits no surface until *touch* before its end. The
//!   surface at its end may be hit earlier by *touch* ÷ cosine, because the distance is measured along the segment.
//! - Two points closer than *touch* lie in an edge, or one of them is an end on a surface. The direction of the wave
//!   between the two points follows from mirroring ([`flight_directions`]). At an end on a surface that direction must
//!   come from the solid or lead into it. Otherwise the wave flies on in the air, as before an edge of a box. In an
//!   edge that points into the air, one of several faces mirrors a wave that reaches all of them, and the choice of the
//!   face is ambiguous: there is no exact path, and the waves remain statistical.

use super::NoPath;
use super::paths::Draft;
use super::surfaces::{Surfaces, Vertex};
use crate::geometry::{ExactScene, SAME_NORMAL};
use glam::DVec3;

/// Least cosine between a wave and a surface's normal. At this angle the rounding along the wave is 10⁹ times the
/// rounding across the surface, which is 10⁻⁶ of the scene's extent.
const GRAZING: f64 = 1e-9;

/// Distance from an end at which the solid is probed, in *touches*: more than the distance of an end from its surface,
/// for directions that do not graze the surface.
const PROBE_IN_TOUCHES: f64 = 1e3;

/// Length in *touches* below which a segment lies next to an edge and counts as free: twice the distance at which
/// fields are probed ahead of a point (`geometry::marched`).
const SHORTEST_IN_TOUCHES: f64 = 20.0;

/// A path to check, with the surfaces that may obstruct it.
pub(super) struct Checked<'a> {
    pub exact: &'a ExactScene,
    pub surfaces: &'a Surfaces,
    pub path: &'a Draft,
}

impl Checked<'_> {
    /// Checks that sound travels along the path.
    ///
    /// # Errors
    /// The reason why sound does not travel along the path.
    pub fn is_taken(&self) -> Result<(), NoPath> {
        let Draft {
            points,
            surfaces,
            normals,
            directions,
            ..
        } = self.path;
        let inner = surfaces.iter().zip(&points[1..]);
        for (surface, point) in inner {
            if !self.surfaces.has(*surface, *point) {
                return Err(NoPath::OffSurface);
            }
        }
        let at_source = short(points.windows(2), self.surfaces.touch);
        for (i, normal) in normals.iter().enumerate() {
            let (to, from) = (directions[i].dot(*normal), directions[i + 1].dot(*normal));
            // A source on a surface has an image in this surface, also for directions along the surface.
            let least = if i < at_source { -GRAZING } else { GRAZING };
            if to > -least || from < least {
                return Err(NoPath::NotFromTheAir);
            }
        }
        self.edges_mirror()?;
        self.ends_mirror(at_source)?;
        match (0..directions.len()).all(|segment| self.is_free(segment)) {
            true => Ok(()),
            false => Err(NoPath::Blocked),
        }
    }

    /// Checks each reflection in an edge, where two reflections away from the ends are at one point: the wave must come
    /// from the air, and the edge must point into the solid. At an edge that points into the air a wave hits only one
    /// of the faces. A face inside another solid does not reflect.
    fn edges_mirror(&self) -> Result<(), NoPath> {
        let touch = self.surfaces.touch;
        for (i, pair) in self.path.normals.windows(2).enumerate() {
            let point = self.path.points[i + 1];
            if point.distance(self.path.points[i + 2]) > touch {
                continue;
            }
            let in_solid = |normal: &DVec3| self.value(point, *normal) < -touch;
            let across = pair[1] - pair[0];
            let is_one_face = across.length() <= SAME_NORMAL;
            if pair.iter().any(in_solid)
                || is_one_face
                || self.value(point, across.normalize()) > -touch
            {
                return Err(NoPath::NotFromTheAir);
            }
        }
        Ok(())
    }

    /// Checks that each segment of length 0 at an end (`at_source` of them at the source) is mirrored
    /// there.
    fn ends_mirror(&self, at_source: usize) -> Result<(), NoPath> {
        let Draft {
            points, directions, ..
        } = self.path;
        let segments = directions.len();
        let at_listener = short(points.windows(2).rev(), self.surfaces.touch);
        if self.path.normals.is_empty() || at_source == segments {
            return Ok(());
        }
        let leaves = directions[at_source];
        for i in 0..at_source {
            self.mirrors(points[i], directions[i], i, leaves)?;
        }
        let comes_from = -directions[segments - at_listener - 1];
        for i in segments - at_listener..segments {
            self.mirrors(points[i + 1], -directions[i], i - 1, comes_from)?;
        }
        Ok(())
    }

    fn is_free(&self, segment: usize) -> bool {
        let (path, touch) = (self.path, self.surfaces.touch);
        let (from, to) = (path.points[segment], path.points[segment + 1]);
        let (direction, length) = (path.directions[segment], from.distance(to));
        if length <= SHORTEST_IN_TOUCHES * touch {
            return true;
        }
        let left = segment.checked_sub(1);
        let leaving = left.map(|i| (path.surfaces[i], path.normals[i]));
        let hit = self.exact.first_surface(from, direction, leaving, length);
        let Some(hit) = hit else {
            return true;
        };
        let is_end = path.surfaces.get(segment) == Some(&hit.object);
        let tolerance = match is_end {
            true => touch / direction.dot(path.normals[segment]).abs(),
            false => touch,
        };
        hit.t >= length - tolerance
    }

    /// Checks that a wave from a point on a surface along `direction` is mirrored at this point by the reflection with
    /// this index, so that it finally leaves the point along `leaves`.
    fn mirrors(
        &self,
        point: DVec3,
        direction: DVec3,
        reflection: usize,
        leaves: DVec3,
    ) -> Result<(), NoPath> {
        let (touch, surface) = (self.surfaces.touch, self.path.surfaces[reflection]);
        let normal = self.path.normals[reflection];
        // A face that ends at the point mirrors waves that leave over the face. It does not mirror waves that leave
        // beyond its border.
        let over = point + leaves.reject_from_normalized(normal) * (PROBE_IN_TOUCHES * touch);
        // A wave along a surface counts as a wave on the surface.
        if self.value(point, direction) > touch || !self.surfaces.has(surface, over) {
            return Err(NoPath::NotFromTheAir);
        }
        let sheets = self.surfaces.sheets_at(surface, point);
        let against = |sheet: &&Vertex| direction.dot(sheet.normal) < -GRAZING;
        // `across` points to the air side of `other` and to the solid side of this face. If the edge points into the
        // air, a probe in this direction is in the air.
        let into_air = |other: &Vertex| {
            let across = other.normal - normal;
            across.length() > SAME_NORMAL && self.value(point, across.normalize()) > -touch
        };
        match sheets.iter().filter(against).any(into_air) {
            true => Err(NoPath::AtEdge),
            false => Ok(()),
        }
    }

    /// The signed distance from the nearest surface to a probe point, which lies in this direction next to a point on a
    /// surface. Only surfaces near the point on the surface are tested.
    fn value(&self, point: DVec3, direction: DVec3) -> f64 {
        let probe_m = PROBE_IN_TOUCHES * self.surfaces.touch;
        let probe = point + direction * probe_m;
        self.exact.distance_within(probe, 2.0 * probe_m)
    }
}

/// Number of leading segments with length 0.
fn short<'a>(segments: impl Iterator<Item = &'a [DVec3]>, touch: f64) -> usize {
    segments
        .take_while(|pair| pair[0].distance(pair[1]) <= touch)
        .count()
}

/// The unit vectors of flight along `points`, one for each segment, with mirroring at surfaces with these normals. Two
/// points closer than `touch` metres lie in an edge, or an end lies on a surface: the direction between them follows
/// from mirroring. All vectors are 0 if the points coincide.
pub(super) fn flight_directions(points: &[DVec3], normals: &[DVec3], touch: f64) -> Vec<DVec3> {
    let unit = |pair: &[DVec3]| {
        let offset = pair[1] - pair[0];
        (offset.length() > touch).then(|| offset.normalize())
    };
    let long: Vec<Option<DVec3>> = points.windows(2).map(unit).collect();
    let mut all = vec![DVec3::ZERO; long.len()];
    let Some(first) = long.iter().position(Option::is_some) else {
        return all;
    };
    for segment in first..all.len() {
        all[segment] = match long[segment] {
            Some(direction) => direction,
            None => all[segment - 1].reflect(normals[segment - 1]),
        };
    }
    for segment in (0..first).rev() {
        all[segment] = all[segment + 1].reflect(normals[segment]);
    }
    all
}

/// The edges of fields on which a source lies.
pub(super) struct EdgeStart<'a> {
    surfaces: &'a Surfaces,
    /// The sheets at the source, as reflections.
    sheets: Vec<Vertex>,
}

impl EdgeStart<'_> {
    pub fn at(source: DVec3, surfaces: &Surfaces) -> EdgeStart<'_> {
        let of = |field| surfaces.sheets_at(field, source);
        let edges = surfaces.fields().map(of).filter(|sheets| sheets.len() > 1);
        EdgeStart {
            sheets: edges.flatten().collect(),
            surfaces,
        }
    }

    /// The reflection at the source of a wave that starts along the unit vector `direction`; `None` if the wave leaves
    /// freely. If the wave flies against several sheets, it hits the first sheet whose surface lies
    /// below its flight.
    pub fn reflection(&self, direction: DVec3) -> Option<&Vertex> {
        let ahead = direction * (PROBE_IN_TOUCHES * self.surfaces.touch);
        let meets = |sheet: &&Vertex| {
            let value = self.surfaces.value(sheet.surface, sheet.point + ahead);
            direction.dot(sheet.normal) < 0.0 && value.is_some_and(|value| value < 0.0)
        };
        let is_over = |sheet: &&Vertex| {
            let over = sheet.point + ahead.reject_from_normalized(sheet.normal);
            self.surfaces.has(sheet.surface, over)
        };
        let mut met = self.sheets.iter().filter(meets);
        met.clone().find(is_over).or_else(|| met.next())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the direction of sound from a source or to a listener on a wall or in an edge: the direction is that of
    /// a source or listener next to the surface.
    #[test]
    fn short_segments_are_flown_as_mirrors_say() {
        let (wall, floor) = (DVec3::X, DVec3::Y);
        let (corner, away) = (DVec3::ZERO, DVec3::new(3.0, 4.0, 0.0));
        let out = DVec3::new(0.6, 0.8, 0.0);
        let expected = [-out, DVec3::new(0.6, -0.8, 0.0), out];
        for points in [
            [corner, corner, corner, away],
            [away, corner, corner, corner],
        ] {
            let found = flight_directions(&points, &[wall, floor], 1e-9);
            assert_eq!(found.len(), expected.len());
            let off = found.iter().zip(expected).map(|(a, b)| a.distance(b));
            assert!(off.fold(0.0, f64::max) < 1e-15, "{found:?}");
        }
        assert_eq!(flight_directions(&[away, away], &[], 1e-9), [DVec3::ZERO]);
    }
}
