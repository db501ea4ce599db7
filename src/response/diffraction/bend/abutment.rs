//! Faces at right angles to edges and pillars, in which these end: floor and ceiling at the corner of a corridor.
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

/// A face at right angles to the edges of a way, in which all of them end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response::diffraction) struct Abutment {
    /// Unit vector along the edges, into the face.
    inwards: DVec3,
    /// Coordinate of the face along this vector, in metres.
    offset_m: f64,
}

impl Abutment {
    /// Maximum number of images of a point between a floor and a ceiling: up to 16 heights of the room.
    pub const MOST_IMAGES: u32 = 16;

    /// The faces in which the edges of a way, or the round bodies that it follows, end: at most one on either side.
    pub fn of(space: &impl Space, bend: &Bend) -> Vec<Abutment> {
        let Some(first) = bend.edges.first().filter(|_| bend.has_parallel_edges()) else {
            return Vec::new();
        };
        let sides = [first.along, -first.along].into_iter();
        sides
            .filter_map(|inwards| Abutment::beyond(space, bend, inwards))
            .collect()
    }

    /// The face on one side; `None` if there is none, if it is not at right angles to the edges, or if the edges end in front
    /// of it.
    fn beyond(space: &impl Space, bend: &Bend, inwards: DVec3) -> Option<Abutment> {
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
            let at_m = from_m + from_way_m;
            let most_m = error_m + SKEW * from_way_m;
            let is_on_solid = |turn: &Turn| {
                let point = turn.middle + inwards * (at_m - turn.middle.dot(inwards));
                space.distance(point).abs() <= most_m
            };
            let way = bend
                .clone()
                .moved_to(section(bend, inwards, at_m, ON_LEG[1]));
            bend.turns.iter().all(is_on_solid) && way.is_free(space, most_m, &[])
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

    /// Whether a line in this direction enters the face at a point.
    pub fn is_entered(&self, point: DVec3, direction: DVec3, error_m: f64) -> bool {
        direction.dot(self.inwards) > 0.0 && self.depth_m(point).abs() <= error_m
    }

    /// A line after its reflection at a point of the face: a point just in front of it, and the direction.
    pub fn reflected(&self, point: DVec3, direction: DVec3, error_m: f64) -> (DVec3, DVec3) {
        let lifted = point - self.inwards * (self.depth_m(point) + error_m);
        (lifted, direction.reflect(self.inwards))
    }

    /// The image, in front of all faces, of a point and a direction.
    pub fn in_front(faces: &[Abutment], point: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        let (mut point, mut direction) = (point, direction);
        for _ in 0..Abutment::MOST_IMAGES {
            let Some(face) = faces.iter().find(|face| face.is_behind(point)) else {
                break;
            };
            point -= face.inwards * (2.0 * face.depth_m(point));
            direction = direction.reflect(face.inwards);
        }
        (point, direction)
    }

    /// How far the image of a point on an edge may lie from the edge in metres: its direction is not exactly at right angles
    /// to the faces.
    pub fn skew_m(faces: &[Abutment], point: DVec3) -> f64 {
        let depths = faces.iter().map(|face| face.depth_m(point));
        SKEW * depths.fold(0.0, f64::max)
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
