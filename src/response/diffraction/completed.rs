//! Ways where no string is found: over the lines of edges, around images of round bodies at floors, and up to the end of an
//! edge between two half-planes.

use super::bend::{Abutment, Bend};
use super::edge::ON_SURFACE;
use super::images::Images;
use super::ring::Detours;
use super::samples::{End, Samples};
use super::space::Space;
use super::string::{HALF_PLANES, HalfPlanes, STEP, TautString};
use super::tent::{HIGHEST, bisect};

/// Error of the angle at which an edge ends between two half-planes, as a share of the angle between them: 0.001 of the sum
/// over all half-planes.
const END_ERROR: f64 = 0.03;

/// Detour over an edge, as a share of the distance between source and listener, from which the edge counts as endless: the
/// greatest height of a tent.
const ENDLESS: f64 = HIGHEST;

/// Samples of what hides the source, extended beyond their outer half-planes up to the azimuth at which the edge below the
/// ways ends. Only sharp edges end so.
pub(super) fn up_to_its_ends(
    space: &impl Space,
    planes: &HalfPlanes,
    bend: &Bend,
    (samples, detours): (Samples, &Detours),
) -> Samples {
    if planes.are_beside() || !bend.is_sharp() {
        return samples;
    }
    let over_lines_m =
        |azimuth: f64| Some(bend.length_over_lines(planes, azimuth)? - planes.apart_m());
    let detour_m = |azimuth: f64| match planes.coarse_string(space, azimuth) {
        Some(string) => Some(string.length_m() - planes.apart_m()),
        None => {
            let is_free = bend.are_free_over_lines(space, planes, &[azimuth])[0];
            over_lines_m(azimuth).filter(|_| is_free)
        }
    };
    let end = |side: usize| {
        let (index, outer_m) = samples.outer()[side];
        let (next, towards) = [(HALF_PLANES - 1, -1.0), (1, 1.0)][side];
        let is_open = detours[(index + next) % HALF_PLANES].is_none();
        let grows = (f64::MIN_POSITIVE..STEP).contains(&samples.ends()[side].angle());
        if !is_open || grows {
            return None;
        }
        let azimuth = |angle: f64| index as f64 * STEP + towards * angle;
        let has_way = |angle: f64| detour_m(azimuth(angle)).is_some();
        let (beyond, angle) = bisect(STEP, 0.0, END_ERROR * STEP, has_way);
        // Over an endless edge the search stops at tents of the greatest height.
        over_lines_m(azimuth(beyond)).filter(|detour_m| *detour_m < ENDLESS * planes.apart_m())?;
        Some(End::Until {
            angle,
            detour_m: detour_m(azimuth(angle)).unwrap_or(outer_m),
        })
    };
    let ends = [end(0), end(1)];
    samples.with_ends(ends)
}

/// Adds the ways over the lines of a bend's edges in half-planes without a string, where they are free.
pub(super) fn add_lines(
    space: &impl Space,
    planes: &HalfPlanes,
    bend: &Bend,
    detours: &mut Detours,
) {
    let is_missing = |index: &usize| detours[*index].is_none() && planes.is_sought(*index);
    let missing: Vec<usize> = (0..HALF_PLANES).filter(is_missing).collect();
    if missing.is_empty() {
        return;
    }
    let azimuths: Vec<f64> = missing.iter().map(|index| *index as f64 * STEP).collect();
    let are_free = bend.are_free_over_lines(space, planes, &azimuths);
    for ((index, azimuth), is_free) in missing.into_iter().zip(azimuths).zip(are_free) {
        let length = bend.length_over_lines(planes, azimuth).filter(|_| is_free);
        detours[index] = length.map(|length| length - planes.apart_m());
    }
}

/// Adds the strings around a round body in half-planes where a floor or a ceiling is in the way, in which the body ends.
pub(super) fn add_images(
    space: &impl Space,
    planes: &HalfPlanes,
    bend: &Bend,
    (strings, detours): (&mut [Option<TautString>], &mut Detours),
) {
    let faces = Abutment::of(space, bend);
    if faces.is_empty() {
        return;
    }
    let images = Images {
        space,
        faces: &faces,
        error_m: ON_SURFACE * bend.length_m,
    };
    for (index, (known, detour)) in strings.iter_mut().zip(detours).enumerate() {
        if detour.is_some() || !planes.is_sought(index) {
            continue;
        }
        *known = planes.coarse_string(&images, index as f64 * STEP);
        *detour = known
            .as_ref()
            .map(|string| string.length_m() - planes.apart_m());
    }
}
