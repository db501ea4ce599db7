//! The profile of a solid in a half-plane, between two points at which a string touches it.

use super::space::Space;
use super::turn::Contact;
use glam::DVec3;
use std::f64::consts::PI;

/// Number of places between two contacts at which the height of the solid is measured.
const SAMPLES: usize = 24;

/// Least number of contacts between two others on a curved surface: a solid with fewer is taken as one with edges.
const LEAST_INNER: usize = 4;

/// Greatest distance between contacts on a curved surface, as a share of the distance between the first and the last:
/// the string is straight over longer ones.
const STRAIGHT: f64 = 0.2;

/// Height below which a point counts as on the line between two others, as a share of the distance between the first and
/// the last contact.
const FLAT: f64 = 1e-6;

/// The upper convex hull of a solid between two contacts.
pub(super) struct Profile {
    /// Points of the hull between the contacts, in world metres.
    points: Vec<DVec3>,
}

impl Profile {
    /// Measures the heights of the solid in the triangle of the first contact, the apex of the tent over both contacts,
    /// and the last contact, from its upper sides along −`up`. `None` if the triangle has no width.
    pub fn cast(space: &impl Space, [first, apex, last]: [DVec3; 3], up: DVec3) -> Option<Profile> {
        let base = last - first;
        let width = base.length();
        let along = base.try_normalize()?;
        let up = up.reject_from_normalized(along).try_normalize()?;
        let height = (apex - first).dot(up);
        let foot = (apex - first).dot(along);
        let mut hull = vec![(0.0, 0.0)];
        for index in 1..SAMPLES {
            // Dense at the contacts, where a rounded edge may be short.
            let x = 0.5 * width * (1.0 - (PI * index as f64 / SAMPLES as f64).cos());
            let top = match x < foot {
                true => height * x / foot,
                false => height * (width - x) / (width - foot),
            };
            let top = top.max(0.0);
            let hit = space.first(first + along * x + up * top, -up, top);
            let y = hit.map_or(0.0, |hit| top - hit.metres);
            extend(&mut hull, (x, y), FLAT * width);
        }
        extend(&mut hull, (width, 0.0), FLAT * width);
        let inner = hull.iter().skip(1).take(hull.len().saturating_sub(2));
        let points = inner.map(|(x, y)| first + along * *x + up * *y);
        Some(Profile {
            points: points.collect(),
        })
    }

    /// The contacts of a string with a curved surface; `None` if the solid has edges only.
    pub fn followed(self, [first, last]: [DVec3; 2]) -> Option<Vec<Contact>> {
        if self.points.len() < LEAST_INNER {
            return None;
        }
        let straight = STRAIGHT * first.distance(last);
        let points = [first].into_iter().chain(self.points).chain([last]);
        let mut contacts: Vec<Contact> = points.map(Contact::at).collect();
        for index in 1..contacts.len() {
            let apart = contacts[index - 1].point.distance(contacts[index].point);
            contacts[index - 1].is_followed = apart < straight;
        }
        Some(contacts)
    }
}

/// Adds a point with a greater x to an upper convex hull, and removes the points that are then below it by `flat` or on
/// it.
fn extend(hull: &mut Vec<(f64, f64)>, (x, y): (f64, f64), flat: f64) {
    while let [.., (ax, ay), (bx, by)] = hull[..] {
        let line = ay + (y - ay) * (bx - ax) / (x - ax);
        if by > line + flat {
            break;
        }
        hull.pop();
    }
    hull.push((x, y));
}
