//! Faces that lie on each other: sheets without thickness, and faces of two materials in one place.
//!
//! The faces of a sheet lie on each other back to back, with air on both sides. A wave that leaves one of them lies within
//! its error bound of the other, whose air side it flies away from. Lines that start so near to a face of a sheet
//! therefore do not meet it (`triangle.rs`).
//!
//! The bottom of a box and the floor on which it stands lie on each other in the same way. There the box and the ground
//! are solid, and no air lies behind either face. A line through the rest of the mesh distinguishes the two.

use super::TriangleMesh;
use super::intersections::LEAST_DEPTH;
use super::report::Defect;
use super::triangle::Triangle;
use glam::DVec3;
use rayon::prelude::*;

/// Maximum number of lines on which air is looked for behind a triangle, so that thousands of faces in one place take no
/// longer than the search for intersections.
const MOST_LINES: usize = 32;

/// For each triangle, whether air lies directly behind it, because another face lies on its back.
pub(super) fn sheets(mesh: &TriangleMesh) -> Vec<bool> {
    let least = LEAST_DEPTH * mesh.extent();
    let all = (0..mesh.triangle_count() as u32).into_par_iter();
    all.map(|index| is_sheet(mesh, index, least)).collect()
}

/// The triangles that lie on a triangle of another group and with the same side towards the air.
pub(super) fn overlays(mesh: &TriangleMesh) -> Defect {
    let least = LEAST_DEPTH * mesh.extent();
    let place = |index: u32| {
        let own = mesh.triangle(index);
        let mut found = None;
        mesh.tree().each_overlap(&own, |number| {
            let other = mesh.triangle(number);
            let is_other = number < index && other.group != own.group;
            if found.is_none() && is_other && own.normal.dot(other.normal) > 0.0 {
                found = common_places(&own, &other, least).first().copied();
            }
        });
        found
    };
    let all = (0..mesh.triangle_count() as u32).into_par_iter().map(place);
    let all: Vec<Option<DVec3>> = all.collect();
    let mut defect = Defect::default();
    for place in all.into_iter().flatten() {
        defect.add(place.as_vec3());
    }
    defect
}

fn is_sheet(mesh: &TriangleMesh, index: u32, least: f64) -> bool {
    let own = mesh.triangle(index);
    let behind = -own.exact_normal();
    let (mut found, mut lines) = (false, 0);
    mesh.tree().each_overlap(&own, |number| {
        let other = mesh.triangle(number);
        if found || lines >= MOST_LINES || own.normal.dot(other.normal) >= 0.0 {
            return;
        }
        let places = common_places(&own, &other, least);
        lines += places.len();
        found = places.into_iter().any(|p| is_air(mesh, p, behind, least));
    });
    found
}

/// Points of two triangles that lie on each other; empty for other triangles.
fn common_places(own: &Triangle, other: &Triangle, least: f64) -> Vec<DVec3> {
    let lies_on = |one: &Triangle, under: &Triangle| {
        let normal = under.exact_normal();
        let height = |corner: DVec3| normal.dot(corner - under.exact_corners()[0]);
        let heights = one.exact_corners().map(height);
        heights.iter().all(|height| height.abs() <= least)
    };
    if !lies_on(own, other) || !lies_on(other, own) {
        return Vec::new();
    }
    let common = clipped(other.exact_corners().to_vec(), own);
    if common.is_empty() {
        return Vec::new();
    }
    let middle = common.iter().sum::<DVec3>() / common.len() as f64;
    let between = common.iter().map(|corner| 0.5 * (middle + *corner));
    std::iter::once(middle)
        .chain(between)
        .filter(|place| own.depth(*place) > least && other.depth(*place) > least)
        .collect()
}

/// The part of a polygon in the plane of a triangle that lies in the triangle (Sutherland and Hodgman 1974).
fn clipped(mut polygon: Vec<DVec3>, by: &Triangle) -> Vec<DVec3> {
    let normal = by.exact_normal();
    let [a, b, c] = by.exact_corners();
    for (from, to) in [(a, b), (b, c), (c, a)] {
        let inward = normal.cross(to - from);
        let depth = |place: DVec3| inward.dot(place - from);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (at, &start) in polygon.iter().enumerate() {
            let end = polygon[(at + 1) % polygon.len()];
            let (first, last) = (depth(start), depth(end));
            if first >= 0.0 {
                kept.push(start);
            }
            if (first >= 0.0) != (last >= 0.0) {
                kept.push(start.lerp(end, first / (first - last)));
            }
        }
        polygon = kept;
    }
    polygon
}

/// Whether air lies directly above a point of a face, in the direction `up`: the next face there shows its air side.
/// Faces that lie on each other cancel out.
fn is_air(mesh: &TriangleMesh, place: DVec3, up: DVec3, least: f64) -> bool {
    let mut met: Vec<(f64, i32)> = Vec::new();
    mesh.tree().each_on_line(place, up, |index| {
        let front = mesh.triangle(index);
        let sides = [(front, 1), (front.reversed(), -1)];
        let hits = sides.map(|(face, side)| face.hit(place, up, 0.0).map(|t| (t, side)));
        met.extend(hits.into_iter().flatten());
    });
    met.retain(|(t, _)| *t > 2.0 * least);
    met.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let together = met.chunk_by(|a, b| b.0 - a.0 <= 2.0 * least);
    let mut sides = together.map(|faces| faces.iter().map(|(_, side)| side).sum::<i32>());
    match sides.find(|sum| *sum != 0) {
        Some(sum) => sum > 0,
        None => !(mesh.report.is_hollow && mesh.report.is_closed),
    }
}
