//! Distinguishes chaos from error.
//!
//! # Theory
//! Two rays that start close together separate in proportion to the length of their flight. Convex mirrors make them
//! separate exponentially: a flight of length l between mirrors of radius r multiplies the separation by about
//! 1 + 2 l / (r cos θ) (Sinai 1970, dispersing billiards). No arithmetic of finite precision can follow such a ray for
//! long. Past the ray's *horizon*, the error of its end point depends on the precision, not on the algorithm.
//!
//! # Method
//! Pairs of exact waves start with an angle of a billionth of a radian between them, and are traced while both meet the
//! same surfaces. The growth is the factor by which the separation grows from one curved surface to the next, as the
//! geometric mean over all pairs and all such flights. Reflections at flat mirrors count as part of a flight. The
//! horizon is the number of such flights after which one rounding error of a position in `f32` has grown to one
//! centimetre.

use super::report::{Chaos, ChaosStep};
use echomarch::geometry::{ExactScene, PathVertex};
use echomarch::scene::{Node, Scene};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Angle between the two waves of a pair, in radians.
const APART: f64 = 1e-9;

/// Rounding error of a position in `f32` in a room, in metres.
const ROUNDING: f64 = 1e-6;

/// Minimum end-point error that is noticed, in metres.
const NOTICED: f64 = 0.01;

/// Maximum number of curved surfaces that are listed in the report.
const STEPS: usize = 8;

/// Sums of logarithms at the n-th curved surface of a path.
#[derive(Clone, Copy, Default)]
struct Sums {
    pairs: u64,
    separation: f64,
    grown: u64,
    growth: f64,
}

/// Traces a pair of waves from the scene's source for each of `directions`.
pub fn measure(scene: &Scene, exact: &ExactScene, directions: &[Vec3], iterations: u32) -> Chaos {
    let start = scene.sources[0].position.as_dvec3();
    let mut sums = vec![Sums::default(); iterations as usize];
    let mut same_sequence = 0;
    for (index, direction) in directions.iter().enumerate() {
        let direction = direction.as_dvec3();
        let other = direction + APART * across(direction, index);
        let path = exact.trace_path(start, direction, iterations);
        let twin = exact.trace_path(start, other, iterations);
        let same = path
            .iter()
            .zip(&twin)
            .take_while(|(a, b)| a.object == b.object);
        let together: Vec<_> = same.collect();
        same_sequence += u64::from(together.len() == path.len().max(twin.len()));
        add(&mut sums, scene, &together);
    }
    let growth = growth(&sums);
    Chaos {
        pairs: directions.len() as u64,
        iterations,
        same_sequence,
        growth,
        horizon: growth.and_then(horizon),
        steps: steps(&sums),
    }
}

/// The number of curved surfaces after which an error with this growth is noticed.
fn horizon(growth: f64) -> Option<f64> {
    (growth > 1.0).then(|| (NOTICED / ROUNDING).ln() / growth.ln())
}

fn add(sums: &mut [Sums], scene: &Scene, together: &[(&PathVertex, &PathVertex)]) {
    let mut before: Option<f64> = None;
    let curved = together.iter().filter(|(a, _)| is_curved(scene, a.object));
    for ((a, b), sum) in curved.zip(sums) {
        let separation = a.point.distance(b.point);
        if separation.is_nan() || separation <= 0.0 {
            return;
        }
        sum.pairs += 1;
        sum.separation += (separation / APART).ln();
        if let Some(before) = before {
            sum.grown += 1;
            sum.growth += (separation / before).ln();
        }
        before = Some(separation);
    }
}

fn is_curved(scene: &Scene, object: u32) -> bool {
    let index = object.checked_sub(1).map(|index| index as usize);
    index.is_some_and(|index| {
        let shape = &scene.surfaces[index].shape;
        !matches!(shape.node, Node::Plane(_) | Node::Cuboid(_) | Node::Room(_)) || !shape.is_basic()
    })
}

/// Returns a unit vector perpendicular to `direction`. The angle of the vector about `direction` depends on the index.
fn across(direction: DVec3, index: usize) -> DVec3 {
    let (u, v) = direction.any_orthonormal_pair();
    let (sin, cos) = (TAU * (index as f64 * 0.618_033_988_749_895).fract()).sin_cos();
    u * cos + v * sin
}

fn growth(sums: &[Sums]) -> Option<f64> {
    let grown: u64 = sums.iter().map(|sum| sum.grown).sum();
    let growth: f64 = sums.iter().map(|sum| sum.growth).sum();
    (grown > 0).then(|| (growth / grown as f64).exp())
}

fn steps(sums: &[Sums]) -> Vec<ChaosStep> {
    let met = sums.iter().take(STEPS).take_while(|sum| sum.pairs > 0);
    met.enumerate()
        .map(|(index, sum)| ChaosStep {
            curved_hits: index as u32 + 1,
            pairs: sum.pairs,
            separation: (sum.separation / sum.pairs as f64).exp(),
            growth: (sum.grown > 0).then(|| (sum.growth / sum.grown as f64).exp()),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::accuracy::directions::lattice;

    /// Protects the distinction between chaos and error: flat walls cause no chaos, but pillars do.
    #[test]
    fn errors_grow_at_pillars_alone() {
        let of = |name: &str| {
            let scene = Scene::builtin(name).unwrap();
            let exact = ExactScene::new(&scene).unwrap();
            measure(&scene, &exact, &lattice(2000, false), 8)
        };
        let corner = of("corner");
        assert_eq!((corner.growth, corner.steps.len()), (None, 0));
        assert_eq!(corner.same_sequence, corner.pairs);
        let obstacles = of("obstacles");
        assert!(obstacles.growth.unwrap() > 2.0);
        assert!(obstacles.horizon.unwrap() > 0.5);
    }

    /// Protects the arithmetic of the horizon: with a growth of ten per hit, four decades take four hits.
    #[test]
    fn the_horizon_is_where_rounding_shows() {
        assert!((horizon(10.0).unwrap() - 4.0).abs() < 1e-12);
        assert_eq!(horizon(1.0), None);
    }
}
