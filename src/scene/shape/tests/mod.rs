//! Tests of all shapes and operators: their `properties`, compared with values sampled on the CPU, and the messages
//! about invalid shapes. The tests in `shader/tests` evaluate the same table in shaders, and those in `tracer/tests`
//! trace waves in it.

pub mod table;

use super::{
    Bend, CappedCylinder, Capsule, Complement, Cone, Cuboid, Cylinder, Difference, Ellipsoid,
    GeneralQuadric, HalfSpace, HeightField, Hyperboloid, Morph, Paraboloid, Plane, Prism, Room,
    RoundedBox, Sphere, Torus, Twist, User,
};
use crate::scene::{Exactness, HeightImage, Shape, UserField};
use crate::test_common::Random;
use glam::{DVec3, UVec2, Vec2, Vec3};
use proptest::prelude::*;
use std::sync::Arc;
use table::{Entry, cuboid, on_cpu, operators, shapes, sphere};

fn anywhere(random: &mut Random, reach: f64) -> DVec3 {
    reach * DVec3::new(random.signed(), random.signed(), random.signed())
}

/// Points of the surface, which are sign changes along random lines, found by bisection. Only the sign of the value is
/// used.
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

/// Whether a step against the gradient, with the value as its length, ends on the surface. Because the distance is
/// never less than the value, both are equal in this case.
fn leads_to_surface(entry: &Entry, p: DVec3) -> bool {
    let (value, step) = (entry.distance(p), 1e-6 * entry.reach());
    let along = |axis: DVec3| {
        (entry.distance(p + axis * step) - entry.distance(p - axis * step)) / (2.0 * step)
    };
    let gradient = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
    let foot = entry.distance(p - value * gradient);
    foot.abs() <= 1e-4 * value.abs() + 1e-6 * entry.reach()
}

/// Protects safe steps: a value divided by the Lipschitz constant never exceeds the distance to the surface. On the
/// sides that are stated to be exact, it equals the distance.
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

/// Finds a pair of points between which the value grows faster than its Lipschitz constant.
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

/// Finds a contradiction to the stated bounds, convexity or symmetry of the solid.
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

/// Protects bounds, convexity and symmetry. Repetitions and waves that start on a surface rely on them.
#[test]
fn solids_have_the_form_that_is_promised() {
    let found = on_cpu()
        .into_iter()
        .filter_map(|entry| breaks_its_form(&entry.field, entry.reach(), 5));
    let failures: Vec<String> = found.collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Random trees of the shapes and operators in the table.
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

    /// Protects the rules by which operators derive their properties from those of their children.
    #[test]
    fn random_trees_keep_their_promises(field in trees(), seed in any::<u64>()) {
        let entry = Entry { name: String::new(), field, truth: None };
        prop_assert_eq!(grows_too_fast(&entry.field, entry.reach(), seed), None);
        prop_assert_eq!(breaks_its_form(&entry.field, entry.reach(), seed), None);
    }
}

fn refusals() -> Vec<(Shape, &'static str)> {
    let v = Vec3::new;
    let mut list = vec![
        (
            Shape::from(HalfSpace {
                normal: Vec3::ZERO,
                offset: 0.0,
            }),
            "normal must have a length",
        ),
        (
            Shape::from(HalfSpace {
                normal: Vec3::X,
                offset: f32::NAN,
            }),
            "offset",
        ),
        (
            Shape::from(Cuboid {
                size: v(1.0, 0.0, 1.0),
            }),
            "size",
        ),
        (
            Shape::from(Room {
                size: v(1.0, 1.0, -1.0),
            }),
            "size",
        ),
        (
            Shape::from(RoundedBox {
                size: v(1.0, 2.0, 3.0),
                rounding: 0.6,
            }),
            "at most half",
        ),
        (
            Shape::from(Sphere {
                radius: f32::INFINITY,
            }),
            "radius",
        ),
        (Shape::from(Cylinder { radius: -1.0 }), "radius"),
        (
            Shape::from(CappedCylinder {
                radius: 1.0,
                height: 0.0,
            }),
            "height",
        ),
        (
            Shape::from(Capsule {
                radius: 0.0,
                height: 1.0,
            }),
            "radius",
        ),
        (
            Shape::from(Torus {
                ring: 1.0,
                tube: -0.1,
            }),
            "tube",
        ),
        (
            Shape::from(Cone {
                radius: 1.0,
                height: f32::NAN,
            }),
            "height",
        ),
        (
            Shape::from(Prism {
                corners: [Vec2::ZERO, Vec2::X, Vec2::X * 2.0],
                depth: 1.0,
            }),
            "one line",
        ),
        (
            Shape::from(Ellipsoid {
                radii: v(1.0, 1.0, 0.0),
            }),
            "radii",
        ),
        (
            Shape::from(Paraboloid { focal_length: 0.0 }),
            "focal length",
        ),
        (
            Shape::from(Hyperboloid {
                waist: 1.0,
                rise: 0.0,
                two_sheets: true,
            }),
            "rise",
        ),
        (
            Shape::from(GeneralQuadric {
                coefficients: [0.0; 10],
            }),
            "first six",
        ),
        (
            Shape::from(GeneralQuadric {
                coefficients: [f32::NAN; 10],
            }),
            "coefficients.0",
        ),
        (sphere(1.0).shell(0.0), "thickness"),
        (
            Shape::smooth_union(0.0, [sphere(1.0), sphere(2.0)]),
            "radius",
        ),
        (sphere(1.0).offset(f32::NAN), "its by"),
        (sphere(1.0).scale(-1.0), "its by"),
        (
            sphere(1.0).translate(v(0.0, f32::INFINITY, 0.0)),
            "its by.y",
        ),
        (sphere(1.0).rotate(v(f32::NAN, 0.0, 0.0)), "its by.x"),
        (sphere(1.0).repeat(Vec3::ZERO, [1; 3]), "period"),
        (sphere(1.0).repeat(v(1.0, -1.0, 0.0), [1; 3]), "period"),
        (
            sphere(1.0).repeat(v(3.0, 0.0, 0.0), [1 << 24, 0, 0]),
            "counts",
        ),
        (sphere(1.0).elongate(v(-1.0, 0.0, 0.0)), "negative"),
        (sphere(1.0).morph(sphere(2.0), 1.5), "amount"),
        (cuboid(1.0, 1.0, 1.0).twist(f32::NAN), "rate"),
        // Repetitions, twists and bends of unbounded children.
        (
            Shape::from(Plane).repeat(v(1.0, 0.0, 0.0), [0; 3]),
            "unbounded",
        ),
        (
            sphere(1.0).complement().repeat(v(9.0, 0.0, 0.0), [0; 3]),
            "unbounded",
        ),
        (sphere(5.0).repeat(v(0.5, 0.5, 0.5), [0; 3]), "more than 64"),
        (Shape::from(Plane).twist(1.0), "unbounded"),
        (Shape::from(Cylinder { radius: 1.0 }).bend(1.0), "unbounded"),
        (
            Shape::over(
                Twist {
                    rate: 3.0,
                    lipschitz: 1.1,
                },
                [cuboid(3.0, 1.0, 3.0)],
            ),
            "lipschitz",
        ),
        (
            Shape::over(
                Bend {
                    rate: 2.0,
                    lipschitz: 1.05,
                },
                [cuboid(3.0, 1.0, 1.0)],
            ),
            "lipschitz",
        ),
        (
            Shape::over(
                Twist {
                    rate: 1.0,
                    lipschitz: 0.5,
                },
                [cuboid(1.0, 1.0, 1.0)],
            ),
            "lipschitz",
        ),
        // The number of operands.
        (Shape::union([]), "at least 1"),
        (Shape::over(Difference, [sphere(1.0)]), "at least 2"),
        (Shape::over(Morph { amount: 0.5 }, [sphere(1.0)]), "takes 2"),
        (
            Shape::over(Complement, [sphere(1.0), sphere(2.0)]),
            "takes 1",
        ),
        (
            Shape::over(Sphere { radius: 1.0 }, [sphere(1.0)]),
            "takes no fields",
        ),
    ];
    let image = HeightImage::new("flat", UVec2::splat(2), vec![0.5; 4]).unwrap();
    let (image, size) = (Arc::new(image), v(1.0, 0.0, 1.0));
    list.push((Shape::from(HeightField { image, size }), "size"));
    let user = |size, lipschitz| {
        let text = "float field(vec3 p) { return 1.0; }".to_owned();
        let field = Arc::new(UserField::new("own.glsl", text, size, lipschitz));
        Shape::from(User { field })
    };
    list.push((user(Vec3::ZERO, 1.0), "size"));
    list.push((user(Vec3::ONE, 0.0), "lipschitz"));
    list
}

/// Each invalid number of a field is reported with the name of its node, for a single node and within a tree.
#[test]
fn bad_fields_are_refused_by_name() {
    for (field, says) in refusals() {
        let name = field.node.name();
        let within = Shape::union([sphere(1.0), field.clone()]).complement();
        for tree in [field, within] {
            let why = tree.check().expect_err(name);
            assert!(why.starts_with(name), "{why}: {name}");
            assert!(why.contains(says), "{why}: {says}");
        }
    }
}

/// Protects from trees that take minutes to compile.
#[test]
fn a_field_has_an_end() {
    let many = Shape::union((0..5000).map(|_| sphere(1.0)));
    assert!(many.validate().is_err_and(|why| why.contains("too large")));
}

/// Protects the validation of height images.
#[test]
fn height_images_are_checked() {
    let new = |size, count, height| HeightImage::new("x", size, vec![height; count]);
    assert!(new(UVec2::new(1, 2), 2, 0.5).is_err());
    assert!(new(UVec2::new(2, 2), 3, 0.5).is_err());
    assert!(new(UVec2::new(2, 2), 4, 1.5).is_err());
    assert!(new(UVec2::new(2, 2), 4, f32::NAN).is_err());
    assert!(new(UVec2::new(2, 2), 4, 0.5).is_ok());
}
