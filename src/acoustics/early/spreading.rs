//! Spreading of a wave front: its area per solid angle at the start.
//!
//! Ray differentials (Igehy, *Tracing ray differentials*, 1999): two rays next to the path's, at
//! angles of 1 rad per unit along two axes across the departure, are followed to first order. Over
//! a segment p′ grows by t d′. At a surface with unit normal n both are moved to where the
//! neighbouring rays meet it, p′ − d (p′·n)/(d·n), and mirrored with the normals there: d′ − 2
//! ((d·n) n′ + (d′·n + d·n′) n), n′ = S p′ with the shape operator S, which is ∇²f/|∇f| within the
//! surface. In a room of planes the area is the squared length exactly.

use super::sheet::Sheet;
use glam::DVec3;

/// A neighbour of a ray, to first order: offsets of place and direction per radian.
#[derive(Clone, Copy)]
struct Neighbour {
    place: DVec3,
    direction: DVec3,
}

impl Neighbour {
    fn flown(self, metres: f64) -> Neighbour {
        Neighbour {
            place: self.place + self.direction * metres,
            ..self
        }
    }
}

/// The area of the wave front at the listener per solid angle at the source, in m² per steradian,
/// for a path along `points` from source to listener over `sheets`; `None` if a sheet has no
/// normal.
pub(super) fn front_area(points: &[DVec3], sheets: &[Sheet]) -> Option<f64> {
    let legs: Vec<DVec3> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if sheets.iter().all(Sheet::is_flat) {
        let length: f64 = legs.iter().map(|leg| leg.length()).sum();
        return Some(length * length);
    }
    let units: Vec<DVec3> = legs.iter().map(|leg| leg.normalize_or_zero()).collect();
    let (a, b) = units.first()?.any_orthonormal_pair();
    let mut pair = [a, b].map(|direction| Neighbour {
        place: DVec3::ZERO,
        direction,
    });
    for (i, sheet) in sheets.iter().enumerate() {
        let at = sheet.at(points[i + 1])?;
        let mirror =
            |n: Neighbour| mirrored(n.flown(legs[i].length()), units[i], at.normal, at.bend);
        pair = pair.map(mirror);
    }
    let (last, unit) = (legs.last()?.length(), units.last()?);
    let [a, b] = pair.map(|neighbour| neighbour.flown(last).place);
    Some(a.cross(b).dot(*unit).abs())
}

fn mirrored(neighbour: Neighbour, d: DVec3, n: DVec3, bend: glam::DMat3) -> Neighbour {
    let place = neighbour.place - d * (neighbour.place.dot(n) / d.dot(n));
    let turned = bend * place;
    let normal = turned - n * turned.dot(n);
    let direction = neighbour.direction;
    let change = normal * d.dot(n) + n * (direction.dot(n) + d.dot(normal));
    Neighbour {
        place,
        direction: direction - 2.0 * change,
    }
}
