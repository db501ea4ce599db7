//! Faces at right angles to edges, in which the edges end: floor and ceiling at the corner of a corridor.
//!
//! Behind such a face an edge is continued by its own mirror image. For the sound that the face does not reflect the edge
//! therefore has no end there (Allen and Berkley 1979 for the images).

use super::{Bend, ON_SURFACE, Turn};
use crate::response::diffraction::space::Space;
use glam::DVec3;

/// Distance along an edge within which its end is sought, as a share of the way's length: as high as tents are raised.
const REACH: f64 = 4.0;

/// Cross-sections between the way and the face in which the way must be free and lie on its edges.
const SECTIONS: u32 = 8;

/// Places beside an edge at which the face must be at right angles to it, as shares of the leg from the edge on.
const ON_LEG: [f64; 2] = [0.1, 0.5];

/// Greatest angle in radians between the edges and the normal of the face. Directions of edges have errors of up to 1e-3.
const SKEW: f64 = 2e-3;

/// Maximum number of images of a point between a floor and a ceiling: up to 16 heights of the room.
const MOST_IMAGES: u32 = 16;

/// A face at right angles to the edges of a way, in which all of them end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Abutment {
    /// Unit vector along the edges, into the face.
    inwards: DVec3,
    /// Coordinate of the face along this vector, in metres.
    offset_m: f64,
}

impl Abutment {
    /// The faces in which the edges of a way end, at most one on either side. `height_m` is the distance of the turns from
    /// the solid: 0 at sharp edges.
    pub fn of(space: &impl Space, bend: &Bend, height_m: f64) -> Vec<Abutment> {
        let Some(first) = bend.edges.first().filter(|_| bend.has_parallel_edges()) else {
            return Vec::new();
        };
        let sides = [first.along, -first.along].into_iter();
        sides
            .filter_map(|inwards| Abutment::beyond(space, bend, inwards, height_m))
            .collect()
    }

    /// The face on one side; `None` if there is none, if it is not at right angles to the edges, or if the edges end in front
    /// of it.
    fn beyond(space: &impl Space, bend: &Bend, inwards: DVec3, height_m: f64) -> Option<Abutment> {
        let inner = &bend.points[1..bend.points.len() - 1];
        let from_m = inner.iter().map(|point| point.dot(inwards));
        let from_m = from_m.fold(f64::NEG_INFINITY, f64::max);
        let middle = section(bend, inwards, from_m, 0.0)[0];
        let error_m = ON_SURFACE * bend.length_m;
        // A leg may graze a face.
        let lift = bend.outwards() * error_m;
        let reach_m = REACH * bend.length_m;
        let depth_at = |place: DVec3| Some(space.first(place + lift, inwards, reach_m)?.metres);
        let depth_m = depth_at(section(bend, inwards, from_m, ON_LEG[0])[0])?;
        let is_right_angle = |place: DVec3| {
            let most_m = error_m + SKEW * place.distance(middle);
            depth_at(place).is_some_and(|other| (other - depth_m).abs() <= most_m)
        };
        let beside = ON_LEG
            .into_iter()
            .flat_map(|share| ends_of(&section(bend, inwards, from_m, share)));
        let has_edges = |index: u32| {
            let from_way_m = depth_m * (f64::from(index) + 0.5) / f64::from(SECTIONS);
            let points = section(bend, inwards, from_m + from_way_m, ON_LEG[1]);
            let way = bend.clone().moved_to(points);
            let most_m = error_m + height_m + SKEW * from_way_m;
            let is_on_solid = |turn: &Turn| space.distance(turn.apex).abs() <= most_m;
            way.turns.iter().all(is_on_solid) && way.is_free(space, most_m, &[])
        };
        (beside.into_iter().all(is_right_angle) && (0..SECTIONS).all(has_edges)).then_some(
            Abutment {
                inwards,
                offset_m: from_m + depth_m,
            },
        )
    }

    /// Depth in metres of a point behind the face.
    fn depth_m(&self, point: DVec3) -> f64 {
        point.dot(self.inwards) - self.offset_m
    }

    /// Whether a point lies behind the face.
    pub fn is_behind(&self, point: DVec3) -> bool {
        self.depth_m(point) > 0.0
    }

    /// Whether the straight way between two points is free in front of the face. Behind it lie images.
    pub fn is_free_up_to(&self, space: &impl Space, leg: [DVec3; 2], error_m: f64) -> bool {
        let (front, behind) = match leg.map(|end| self.is_behind(end)) {
            [true, true] => return true,
            [false, false] => return space.is_free(leg[0], leg[1]),
            [false, true] => (leg[0], leg[1]),
            [true, false] => (leg[1], leg[0]),
        };
        let along = (behind - front).normalize_or_zero();
        let is_on_face = |metres: f64| self.depth_m(front + along * metres).abs() <= error_m;
        let met = space.between(front, behind);
        met.is_none_or(|met| is_on_face(met.metres))
    }
}

/// The image, in front of all faces, of a point on an edge, and how far it may lie from the edge's image in metres, because
/// edges are not exactly at right angles to the faces.
pub(super) fn in_front(faces: &[Abutment], point: DVec3) -> (DVec3, f64) {
    let (mut point, mut skew_m) = (point, 0.0);
    for _ in 0..MOST_IMAGES {
        let Some(face) = faces.iter().find(|face| face.is_behind(point)) else {
            break;
        };
        let depth_m = face.depth_m(point);
        point -= face.inwards * (2.0 * depth_m);
        skew_m += SKEW * depth_m;
    }
    (point, skew_m)
}

/// The points of a way in the cross-section with a coordinate of `at_m` metres along its edges, with this share of the outer
/// legs.
fn section(bend: &Bend, along: DVec3, at_m: f64, share: f64) -> Vec<DVec3> {
    let in_plane = |point: &DVec3| *point + along * (at_m - point.dot(along));
    let mut points: Vec<DVec3> = bend.points.iter().map(in_plane).collect();
    let last = points.len() - 1;
    points[0] = points[1].lerp(points[0], share);
    points[last] = points[last - 1].lerp(points[last], share);
    points
}

fn ends_of(points: &[DVec3]) -> [DVec3; 2] {
    [points[0], points[points.len() - 1]]
}
