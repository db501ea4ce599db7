//! Paths over planes: mirror images of the source (Allen and Berkley, *Image method for
//! efficiently simulating small-room acoustics*, JASA 65, 1979).

use super::sheet::Sheet;
use glam::DVec3;

/// How far a point may lie beyond the ends of its segment, as a share of it: in an edge two points
/// of a path coincide, and rounding decides which comes first.
const BEYOND: f64 = 1e-12;

/// The image of a point in the plane of unit normal n where n · p is `offset`.
pub(super) fn image(place: DVec3, normal: DVec3, offset: f64) -> DVec3 {
    place - normal * (2.0 * (place.dot(normal) - offset))
}

/// The points at which the line from source to listener is mirrored at all sheets, in order; a line that is closer to a
/// plane than `touch` metres at both ends counts as within it. `None` if one of them is not a plane, or the line to an
/// image does not cross its plane.
pub(super) fn points<'a>(
    source: DVec3,
    listener: DVec3,
    touch: f64,
    sheets: impl Iterator<Item = &'a Sheet<'a>>,
) -> Option<Vec<DVec3>> {
    let planes: Vec<(DVec3, f64)> = sheets.map(Sheet::plane).collect::<Option<_>>()?;
    let mut images = vec![source];
    for (normal, offset) in &planes {
        let last = *images.last()?;
        images.push(image(last, *normal, *offset));
    }
    let mut points = vec![DVec3::ZERO; planes.len()];
    let mut seen_from = listener;
    for (i, (normal, offset)) in planes.iter().enumerate().rev() {
        let image = images[i + 1];
        let here = seen_from.dot(*normal) - offset;
        let there = image.dot(*normal) - offset;
        // The rest of the path is a single point, the source in an edge; or the path lies in the plane, and is
        // mirrored where it comes from.
        let is_point = seen_from.distance(image) <= touch;
        if is_point || here.abs().max(there.abs()) <= touch {
            seen_from = image;
            points[i] = image;
            continue;
        }
        let share = here / (here - there);
        if !(-BEYOND..=1.0 + BEYOND).contains(&share) {
            return None;
        }
        seen_from += (image - seen_from) * share.clamp(0.0, 1.0);
        points[i] = seen_from;
    }
    Some(points)
}
