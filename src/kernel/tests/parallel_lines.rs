//! Lines exactly parallel to faces, where a closed form would divide by 0.

use super::field_shaders::Asked;
use super::{has_marched_fields, parts_of};
use crate::Surface;
use crate::gpu::Api;
use crate::kernel::Lists;
use crate::kernel::text::{ListenerText, closed_form_parts};
use crate::reference::ExactScene;
use crate::scene::Shape;
use crate::scene::shape::tests::table::scene_of;
use crate::scene::shape::{CappedCylinder, Capsule, Cone, Cuboid, HalfSpace, Prism};
use crate::test_common::context;
use glam::{DVec3, Vec2, Vec3};

const ASK: &str = "
vec4 answer(int which, vec3 p, vec3 d) {
    float object;
    float t = closestHit(p, d, -1.0, NO_HIT, object);
    return vec4(t, object, 0.0, 0.0);
}
";

/// Maximum distance in metres between a hit and its twin in f64.
const CLOSE: f64 = 1e-5;

/// Shapes of 2 m with faces along the axes, or with an axis.
fn shapes() -> Vec<Shape> {
    let right_angle = [
        Vec2::new(-1.0, -1.0),
        Vec2::new(1.0, -1.0),
        Vec2::new(-1.0, 1.0),
    ];
    vec![
        Shape::from(Prism {
            corners: right_angle,
            depth: 2.0,
        }),
        Shape::union([Shape::from(Cuboid {
            size: Vec3::splat(2.0),
        })]),
        Shape::from(CappedCylinder {
            radius: 1.0,
            height: 2.0,
        }),
        Shape::from(Capsule {
            radius: 0.5,
            height: 1.0,
        }),
        Shape::from(Cone {
            radius: 1.0,
            height: 2.0,
        }),
        Shape::from(HalfSpace {
            normal: Vec3::Y,
            offset: -1.0,
        }),
    ]
}

/// Lines along both directions of every axis, from a grid whose lines neither touch a face nor graze a curved side.
fn lines() -> Vec<(Vec3, Vec3)> {
    const AT: [f32; 6] = [-2.3, -1.1, -0.4, 0.35, 0.9, 1.7];
    let axes = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    let mut all = Vec::new();
    for d in axes {
        for x in AT {
            for y in AT {
                all.extend(AT.map(|z| (Vec3::new(x, y, z), d)));
            }
        }
    }
    all
}

/// Protects misses: a line beside a face and parallel to it passes by, and one within meets the same hit as the
/// reference.
#[test]
fn lines_parallel_to_faces_meet_what_they_should() {
    let context = context(Api::Gl);
    for shape in shapes() {
        let scene = scene_of(vec![Surface::new(shape.clone())]);
        assert!(!has_marched_fields(&scene), "{shape:?}");
        let exact = ExactScene::new(&scene).unwrap();
        let parts = parts_of(&scene, Lists::Lines, |text| {
            closed_form_parts(text, ListenerText::Solid)
        });
        let asked = Asked::new(&context, &scene, parts, ASK.to_owned());
        let in_air = |(p, _): &(Vec3, Vec3)| shape.value(p.as_dvec3()) > 1e-3;
        let (starts, directions): (Vec<Vec3>, Vec<Vec3>) =
            lines().into_iter().filter(in_air).unzip();
        let answers = asked.ask(0, &starts, &directions);
        let mut met = 0;
        for ((from, d), [t, object, ..]) in starts.iter().zip(&directions).zip(answers) {
            let there = (object == 1.0).then_some(f64::from(t));
            let hit = exact.closest_hit(from.as_dvec3(), DVec3::from(*d));
            let here = hit.filter(|hit| hit.object == 1).map(|hit| hit.t);
            let same = match (here, there) {
                (None, None) => true,
                (Some(here), Some(there)) => (here - there).abs() < CLOSE,
                _ => false,
            };
            assert!(
                same,
                "{here:?}, by the shader {there:?}, from {from} along {d}: {shape:?}"
            );
            met += usize::from(here.is_some());
        }
        assert!(
            met > 40 && met < starts.len() - 40,
            "{met} of {}: {shape:?}",
            starts.len()
        );
    }
}
