//! Every kind of sheet, by reflections at random points.

use super::{area, assert_specular, by_way_of, directions, scene, traced_area};
use crate::acoustics::early::{EarlyPaths, Ends, SpecularPath};
use crate::reference::ExactScene;
use crate::scene::HeightImage;
use crate::scene::shape::{
    Capsule, Cone, Cuboid, Cylinder, Ellipsoid, GeneralQuadric, HalfSpace, HeightField,
    Hyperboloid, Paraboloid, Prism, RoundedBox, Sphere, Torus,
};
use crate::test_common::Random;
use crate::{Scene, Shape, Surface};
use glam::{DVec3, EulerRot, Quat, UVec2, Vec2, Vec3};
use std::sync::Arc;

fn torus() -> Shape {
    Shape::from(Torus {
        ring: 1.2,
        tube: 0.4,
    })
}

fn cuboid(x: f32, y: f32, z: f32) -> Shape {
    Shape::from(Cuboid {
        size: Vec3::new(x, y, z),
    })
}

fn ball(radius: f32) -> Shape {
    Shape::from(Sphere { radius })
}

fn hills() -> Shape {
    let size = UVec2::new(6, 6);
    let height = |i: u32| 0.5 + 0.3 * ((i % 6) as f32 * 0.9).sin() * ((i / 6) as f32 * 0.7).cos();
    let heights = (0..36).map(height).collect();
    let image = HeightImage::new("hills", size, heights).expect("a grid");
    Shape::from(HeightField {
        image: Arc::new(image),
        size: Vec3::new(4.0, 1.5, 4.0),
    })
}

/// Finite shapes about the origin.
fn shapes() -> Vec<Shape> {
    let corners = [
        Vec2::new(-1.0, -1.0),
        Vec2::new(1.5, -0.5),
        Vec2::new(0.0, 1.2),
    ];
    let size = Vec3::new(2.0, 1.0, 1.5);
    let coefficients = [1.0, 2.0, 0.7, 0.3, -0.2, 0.1, 0.2, 0.1, 0.0, -1.5];
    vec![
        ball(1.3),
        torus(),
        Shape::from(Capsule {
            radius: 0.6,
            height: 1.0,
        }),
        Shape::from(Cone {
            radius: 1.0,
            height: 2.0,
        }),
        Shape::from(Prism {
            corners,
            depth: 1.5,
        }),
        Shape::from(RoundedBox {
            size,
            rounding: 0.3,
        }),
        Shape::from(Ellipsoid {
            radii: Vec3::new(1.5, 1.0, 0.7),
        }),
        Shape::from(GeneralQuadric { coefficients }),
        hills(),
        Shape::intersection([Shape::from(Paraboloid { focal_length: 0.4 }), ball(2.0)]),
        Shape::intersection([
            Shape::from(Hyperboloid {
                waist: 0.7,
                rise: 0.9,
                two_sheets: false,
            }),
            ball(2.0),
        ]),
    ]
}

/// Finite trees about the origin.
fn trees() -> Vec<Shape> {
    vec![
        cuboid(1.0, 1.0, 1.0).offset(0.3),
        Shape::from(Cylinder { radius: 0.5 }).rotate(Vec3::new(0.4, 0.2, 1.0)),
        Shape::union([ball(0.8), cuboid(2.5, 0.5, 0.5)]),
        cuboid(2.0, 2.0, 2.0).minus([ball(1.2)]),
        cuboid(2.0, 2.0, 2.0)
            .minus([ball(1.2).translate(Vec3::Y)])
            .scale(0.8),
        ball(0.5).repeat(Vec3::new(1.5, 0.0, 1.5), [3, 0, 2]),
        torus()
            .translate(Vec3::X * 0.7)
            .mirror([true, false, false]),
        ball(0.7).elongate(Vec3::new(0.6, 0.0, 0.2)),
        Shape::smooth_union(0.8, [ball(0.9).translate(Vec3::X), cuboid(1.5, 1.0, 1.0)]),
        cuboid(1.0, 2.0, 0.7).twist(0.5),
        cuboid(2.0, 1.0, 0.7).bend(0.3),
        ball(1.2).morph(cuboid(1.5, 1.5, 1.5), 0.4),
        torus().offset(0.1),
        Shape::intersection([
            ball(1.5),
            Shape::from(HalfSpace {
                normal: Vec3::new(1.0, 2.0, 0.5),
                offset: 0.4,
            }),
        ])
        .shell(0.1),
    ]
}

/// Number of waves that hit a shape in the test below.
const TRIED: usize = 40;

/// Protects every kind of sheet with its derivatives, moved and turned: to any listener that a
/// reflected wave passes there is a path, it is specular, and its front has the area found by
/// traced rays. The listener is put 3 m along a reflected wave, and the path is solved for from
/// another wave 0.01 rad away; next to edges, seams and outlines that wave may miss.
#[test]
fn shapes_mirror_as_rays_do() {
    let turn = Quat::from_euler(EulerRot::YXZ, 0.5, -0.8, 0.3);
    for shape in shapes().into_iter().chain(trees()) {
        let name = shape.name();
        let surface = Surface::new(shape)
            .at(Vec3::new(0.2, -0.1, 0.3))
            .turned(turn);
        let mut scene = scene(vec![surface], Vec3::new(3.0, 2.5, 2.0), Vec3::ONE * 9.0);
        let mut random = Random(7);
        let mut met = 0;
        for unit in mirrored(&scene) {
            let Some(path) = path_along(&mut scene, unit, unit + 0.01 * random.direction()) else {
                continue;
            };
            // Within 1e-8 m of the border of a blend, points have the sheet on one side of it;
            // normals turn by the root of that.
            assert_specular(&scene, &path, 1e-4);
            // A bundle over the seam of two sheets gives a different area for each width.
            let [traced, wider] = [1e-4, 2e-4].map(|angle| traced_area(&scene, &path, angle));
            if (wider / traced - 1.0).abs() > 1e-4 {
                continue;
            }
            met += 1;
            let error = area(&path) / traced - 1.0;
            // Normals of marched fields are accurate to 1e-9, and so differences to 1e-5; 1e-3 is
            // 0.004 dB.
            assert!(error.abs() < 1e-3, "{name}: {error} at {path:?}");
        }
        assert!(met >= TRIED * 4 / 5, "{name}: {met} paths");
    }
}

/// Directions from the source that are mirrored once and are then free for 3 m.
fn mirrored(scene: &Scene) -> Vec<DVec3> {
    let exact = ExactScene::new(scene).expect("a valid scene");
    let start = scene.source.position.as_dvec3();
    let is_mirrored = |unit: &DVec3| {
        let mut hits = 0;
        let flight = exact.follow(start, *unit, 2, |hit| {
            hits += u32::from(hit.t > 0.0);
        });
        hits == 1 && flight.is_some_and(|flight| flight.is_free)
    };
    let units = directions(6000).into_iter();
    let units = units.map(|direction| direction.as_dvec3().normalize());
    units.filter(is_mirrored).take(TRIED).collect()
}

/// The path that departs along `unit` to a listener on that wave, solved for from a wave at
/// `beside`.
fn path_along(scene: &mut Scene, unit: DVec3, beside: DVec3) -> Option<SpecularPath> {
    let exact = ExactScene::new(scene).expect("a valid scene");
    let flight = exact.follow(Ends::of(scene).source, unit, 1, |_| ())?;
    scene.listener.position = (flight.origin + 3.0 * flight.direction).as_vec3();
    let early = EarlyPaths::new(scene).expect("a valid scene");
    let ends = Ends::of(scene);
    let candidates = early.candidates(&ends, &[beside.as_vec3()], 1, f64::INFINITY);
    let found = early.find(&ends, &candidates);
    let echoes = by_way_of(&found, &[1]).into_iter();
    // The listener's position is rounded to f32.
    let mut near = echoes.filter(|path| path.departure.distance(unit) < 1e-5);
    near.next().cloned()
}
