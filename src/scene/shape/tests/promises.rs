//! Compares `properties` with values sampled on the CPU.

use super::table::{Entry, on_cpu, operators, shapes};
use crate::scene::{Exactness, Shape};
use crate::test_common::Random;
use glam::{DVec3, Vec3};
use proptest::prelude::*;

fn anywhere(random: &mut Random, reach: f64) -> DVec3 {
    reach * DVec3::new(random.signed(), random.signed(), random.signed())
}

/// Points of the surface: sign changes along random lines, found by bisection. Only the sign of the
/// value is used.
fn surface_points(entry: &Entry, random: &mut Random, lines: usize) -> Vec<DVec3> {
    const PIECES: usize = 48;
    let reach = 1.5 * entry.reach();
    let mut found = Vec::new();
    for _ in 0..lines {
        let (a, b) = (anywhere(random, reach), anywhere(random, reach));
        let at = |share: f64| a + (b - a) * share;
        let mut before = entry.distance(a) > 0.0;
        for piece in 1..=PIECES {
            let (mut low, mut high) = (
                (piece - 1) as f64 / PIECES as f64,
                piece as f64 / PIECES as f64,
            );
            let after = entry.distance(at(high)) > 0.0;
            if after != before {
                for _ in 0..45 {
                    let middle = 0.5 * (low + high);
                    if (entry.distance(at(middle)) > 0.0) == before {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                found.push(at(low));
            }
            before = after;
        }
    }
    found
}

/// Whether a step by the value against the gradient ends on the surface. As the distance is never
/// less than the value, it is then equal to it.
fn leads_to_surface(entry: &Entry, p: DVec3) -> bool {
    let (value, step) = (entry.distance(p), 1e-6 * entry.reach());
    let along = |axis: DVec3| {
        (entry.distance(p + axis * step) - entry.distance(p - axis * step)) / (2.0 * step)
    };
    let gradient = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
    let foot = entry.distance(p - value * gradient);
    foot.abs() <= 1e-4 * value.abs() + 1e-6 * entry.reach()
}

/// Protects safe steps: a value divided by the Lipschitz constant never exceeds the distance to the
/// surface, and equals it on the sides where it is stated to be exact.
#[test]
fn values_are_the_distances_that_they_are_said_to_be() {
    let mut failures = Vec::new();
    for entry in on_cpu() {
        let mut random = Random(7);
        let surface = surface_points(&entry, &mut random, 1500);
        assert!(
            !surface.is_empty() || entry.reach() < 0.05,
            "{}",
            entry.name
        );
        let properties = entry.field.properties();
        let reach = entry.reach();
        for index in 0..120 {
            let p = if index % 2 == 0 || surface.is_empty() {
                anywhere(&mut random, 1.2 * reach)
            } else {
                let near = surface[(random.unit() * surface.len() as f64) as usize];
                near + anywhere(&mut random, 0.1 * reach)
            };
            let value = entry.distance(p);
            let nearest = surface
                .iter()
                .min_by(|a, b| p.distance(**a).total_cmp(&p.distance(**b)));
            let Some(nearest) = nearest else { continue };
            let sampled = p.distance(*nearest);
            if value.abs() > sampled + 1e-9 * reach {
                failures.push(format!("{value} > {sampled} at {p}: {}", entry.name));
                break;
            }
            let exactness = if value > 0.0 {
                properties.in_air
            } else {
                properties.in_solid
            };
            if exactness == Exactness::Exact && !leads_to_surface(&entry, p) {
                failures.push(format!("{value} is not exact at {p}: {}", entry.name));
                break;
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Whether the value grows faster than its Lipschitz constant between two points.
fn grows_too_fast(field: &Shape, reach: f64, seed: u64) -> Option<String> {
    let lipschitz = field.properties().lipschitz;
    let mut random = Random(seed);
    for index in 0..400 {
        let a = anywhere(&mut random, 2.0 * reach);
        let step = reach * 10f64.powi(-(index % 5));
        let b = a + anywhere(&mut random, step);
        let grown = (field.value(a) - field.value(b)).abs();
        if grown > lipschitz * a.distance(b) * (1.0 + 1e-9) + 1e-12 * reach {
            let rate = grown / a.distance(b);
            return Some(format!("{rate} > {lipschitz} from {a} to {b}: {field:?}"));
        }
    }
    None
}

/// Whether the solid has the stated bounds, convexity and symmetry.
fn breaks_its_form(field: &Shape, reach: f64, seed: u64) -> Option<String> {
    let properties = field.properties();
    let mut random = Random(seed);
    let mut solid: Vec<DVec3> = Vec::new();
    let tolerance = 1e-9 * reach;
    for _ in 0..1500 {
        let p = anywhere(&mut random, 2.0 * reach);
        let value = field.value(p);
        for axis in 0..3 {
            let mut image = p;
            image[axis] = -p[axis];
            if properties.symmetric[axis] && (field.value(image) - value).abs() > tolerance {
                return Some(format!("not symmetric along {axis} at {p}: {field:?}"));
            }
        }
        if value < 0.0 {
            if properties.bounds.distance(p) > tolerance {
                return Some(format!("solid out of its bounds at {p}: {field:?}"));
            }
            solid.push(p);
        }
    }
    if properties.convex {
        for pair in solid.windows(2) {
            let p = pair[0].lerp(pair[1], random.unit());
            if field.value(p) > tolerance {
                return Some(format!("not convex at {p}: {field:?}"));
            }
        }
    }
    None
}

/// Protects the Lipschitz constants, by which every step is divided.
#[test]
fn values_grow_no_faster_than_they_may() {
    let found = on_cpu()
        .into_iter()
        .filter_map(|entry| grows_too_fast(&entry.field, entry.reach(), 3));
    let failures: Vec<String> = found.collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Protects bounds, convexity and symmetry, on which repetitions and departing waves rely.
#[test]
fn solids_have_the_form_that_is_promised() {
    let found = on_cpu()
        .into_iter()
        .filter_map(|entry| breaks_its_form(&entry.field, entry.reach(), 5));
    let failures: Vec<String> = found.collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Random trees of the table's shapes and operators.
pub fn trees() -> impl Strategy<Value = Shape> {
    let mut leaves = shapes();
    leaves.extend(operators());
    let leaf = prop::sample::select(leaves);
    let amount = 0.05f32..0.95;
    let place = (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(Vec3::from);
    let tree = leaf.prop_recursive(3, 12, 3, move |inner| {
        let several = prop::collection::vec(inner.clone(), 1..4);
        let one = (inner, place.clone(), amount.clone());
        prop_oneof![
            (several, 0..4, amount.clone()).prop_map(|(of, which, by)| match which {
                0 => Shape::union(of),
                1 => Shape::intersection(of),
                2 => Shape::smooth_union(by, of),
                _ => {
                    let mut of = of.into_iter();
                    let first = of.next().unwrap_or_else(|| shapes().remove(0));
                    let next = of.next().unwrap_or_else(|| first.clone());
                    first.clone().minus([next.clone()]).morph(next, by)
                }
            }),
            (one, 0..10).prop_map(|((of, by, amount), which)| match which {
                0 => of.complement(),
                1 => of.shell(amount),
                2 => of.offset(amount - 0.5),
                3 => of.translate(by),
                4 => of.rotate(by * 3.0),
                5 => of.scale(2.0 * amount),
                6 => of.mirror([by.x > 0.0, by.y > 0.0, by.z > 0.0]),
                7 => of.repeat(Vec3::new(0.0, 6.0 * amount, 8.0), [0, 3, 2]),
                8 => of.elongate(by.abs()),
                _ if amount > 0.5 => of.twist(by.x),
                _ => of.bend(by.x),
            }),
        ]
    });
    tree.prop_filter("sound", |field| field.check().is_ok())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    /// Protects the rules by which operators derive properties from their children's.
    #[test]
    fn random_trees_keep_their_promises(field in trees(), seed in any::<u64>()) {
        let entry = Entry { name: String::new(), field, truth: None };
        prop_assert_eq!(grows_too_fast(&entry.field, entry.reach(), seed), None);
        prop_assert_eq!(breaks_its_form(&entry.field, entry.reach(), seed), None);
    }
}
