//! Pairs of triangles that intersect each other: an edge of one crosses the inner part of the other.
//!
//! Triangles that only touch, such as furniture on a floor, do not intersect each other.

use super::TriangleMesh;
use super::report::Defect;
use super::triangle::Triangle;
use glam::Vec3;
use rayon::prelude::*;

/// Least depth of an intersection, as a share of the largest coordinate: some tens of units in the last place of that
/// coordinate in `f32`, in which corners are stored.
pub(super) const LEAST_DEPTH: f64 = 32.0 * f32::EPSILON as f64;

/// The pairs of triangles that intersect each other, each once.
pub(super) fn intersections(mesh: &TriangleMesh) -> Defect {
    let least = LEAST_DEPTH * mesh.extent();
    let tree = mesh.tree();
    let of = |index: u32| {
        let own = mesh.triangle(index);
        let corners = mesh.triangles[index as usize];
        let mut found = (0, None);
        tree.each_overlap(&own, |other| {
            let others = &mesh.triangles[other as usize];
            if other <= index || corners.iter().any(|corner| others.contains(corner)) {
                return;
            }
            if let Some(place) = crossing(&own, &mesh.triangle(other), least) {
                found = (found.0 + 1, found.1.or(Some(place)));
            }
        });
        found
    };
    let all = (0..mesh.triangle_count() as u32).into_par_iter().map(of);
    // The first place is that of the triangle with the smallest index, regardless of the number of threads.
    let (count, first): (usize, Option<Vec3>) = all.reduce(
        || (0, None),
        |before, behind| (before.0 + behind.0, before.1.or(behind.1)),
    );
    Defect {
        count,
        first: first.unwrap_or(Vec3::ZERO),
    }
}

/// A point at which an edge of one triangle crosses the other.
fn crossing(one: &Triangle, other: &Triangle, least: f64) -> Option<Vec3> {
    edge_through(one, other, least).or_else(|| edge_through(other, one, least))
}

/// A point at which an edge of `from` crosses the inner part of `through`, more than `least` metres from its edges.
fn edge_through(from: &Triangle, through: &Triangle, least: f64) -> Option<Vec3> {
    let normal = through.exact_normal();
    let ends = from.exact_corners();
    let heights = ends.map(|end| normal.dot(end - through.exact_corners()[0]));
    for (start, end) in [(0, 1), (1, 2), (2, 0)] {
        let (low, high) = (
            heights[start].min(heights[end]),
            heights[start].max(heights[end]),
        );
        if low > -least || high < least {
            continue;
        }
        let share = heights[start] / (heights[start] - heights[end]);
        let place = ends[start].lerp(ends[end], share);
        if through.depth(place) > least {
            return Some(place.as_vec3());
        }
    }
    None
}
