//! Compares marched fields with the exact reference. No wave passes through a solid, no grazing wave reaches the step
//! limit, and both profiles agree, near the listener and far from it.

use crate::common::{Random, flights};
use echomarch::scene::shape::{
    Capsule, Cone, Ellipsoid, Grid, HalfSpace, HeightField, Prism, Room, RoundedBox, Torus,
};
use echomarch::scene::{HeightImage, Node, SampledField, Shape};
use echomarch::{Listener, Profile, Scene, Source, Surface};
use glam::{DVec3, EulerRot, Quat, UVec2, UVec3, Vec2, Vec3};
use std::sync::Arc;

const PROFILES: [Profile; 2] = [Profile::Hybrid, Profile::March];

/// Returns `count` directions, evenly distributed in a cone about an axis.
fn aims(axis: Vec3, half_angle: f64, count: u32) -> Vec<Vec3> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let axis = axis.as_dvec3().normalize();
    let (one, other) = axis.any_orthonormal_pair();
    let direction = |index: u32| {
        let least = half_angle.cos();
        let along = 1.0 - (1.0 - least) * (f64::from(index) + 0.5) / f64::from(count);
        let aside = (1.0 - along * along).sqrt();
        let (sin, cos) = (GOLDEN_ANGLE * f64::from(index)).sin_cos();
        (along * axis + aside * (cos * one + sin * other)).as_vec3()
    };
    (0..count).map(direction).collect()
}

/// Traces one flight of each wave in each profile, and compares its end with the end of the exact flight.
fn compare(scene: &Scene, directions: &[Vec3]) {
    flights::compare(scene, directions, &PROFILES);
}

fn torus() -> Shape {
    Node::Torus(Torus {
        ring: 2.0,
        tube: 0.8,
    })
    .into()
}

fn turned(surface: Surface, degrees: Vec3) -> Surface {
    let by = degrees * std::f32::consts::PI / 180.0;
    surface.turned(Quat::from_euler(EulerRot::XYZ, by.x, by.y, by.z))
}

/// Returns a scene with a field 6 m in front of a slab with a width of 200 m, and a listener.
fn before_a_slab(name: &str, field: Shape, scale: f32, listener: Vec3) -> Scene {
    let slab = Shape::from(Node::RoundedBox(RoundedBox {
        size: Vec3::new(200.0, 200.0, 0.5) * scale,
        rounding: 0.1 * scale,
    }));
    let ahead = Surface::new(field.scale(scale)).at(Vec3::new(0.0, 0.0, -6.0 * scale));
    Scene::new(
        format!("{name} x {scale} heard at {listener}"),
        vec![
            turned(ahead, Vec3::new(90.0, 0.0, 0.0)),
            Surface::new(slab).at(Vec3::new(0.0, 0.0, -20.0 * scale)),
        ],
        Source::at(Vec3::ZERO),
        Listener::at(listener, scale),
    )
}

fn hills(side: u32) -> Arc<HeightImage> {
    let height = |index: u32| {
        let (x, z) = (index % side, index / side);
        ((x * 7 + z * 13 + x * z * 3) % 17) as f32 / 16.0
    };
    let heights = (0..side * side).map(height).collect();
    Arc::new(HeightImage::new("hills", UVec2::splat(side), heights).unwrap())
}

fn height_field(size: Vec3) -> Shape {
    Node::HeightField(HeightField {
        image: hills(24),
        size,
    })
    .into()
}

/// A ring that another program sampled coarsely: the surface is folded along the faces of the cells.
fn sampled() -> Shape {
    let (side, cell) = (UVec3::new(21, 9, 21), 0.25);
    let at = |index: u32| {
        let (x, y, z) = (index / 189, index / 21 % 9, index % 21);
        let p = (UVec3::new(x, y, z).as_vec3() - 0.5 * (side - 1).as_vec3()) * cell;
        Vec2::new(p.with_y(0.0).length() - 1.5, p.y).length() - 0.5
    };
    let values = (0..side.element_product()).map(at).collect();
    let field = SampledField::new("ring", side, cell, values).unwrap();
    let field = Arc::new(field);
    Node::Grid(Grid { field }).into()
}

/// Returns every kind of field whose march could pass a solid: non-convex, blended, cut or thin fields.
fn kinds() -> Vec<(&'static str, Shape)> {
    let cone = || {
        Shape::from(Node::Cone(Cone {
            radius: 1.5,
            height: 3.0,
        }))
    };
    let prism = || {
        let corners = [
            Vec2::new(0.0, 0.0),
            Vec2::new(2.0, 0.4),
            Vec2::new(1.0, 2.0),
        ];
        Shape::from(Node::Prism(Prism {
            corners,
            depth: 1.5,
        }))
    };
    let capsule = || {
        Shape::from(Node::Capsule(Capsule {
            radius: 0.6,
            height: 2.5,
        }))
    };
    let ellipsoid = || {
        Shape::from(Node::Ellipsoid(Ellipsoid {
            radii: Vec3::new(2.5, 0.4, 1.0),
        }))
    };
    let aside = |field: Shape| field.translate(Vec3::new(0.7, 0.2, -0.4));
    vec![
        ("torus", torus()),
        ("shell of a torus", torus().shell(0.02)),
        (
            "union",
            Shape::union([torus(), aside(cone()), aside(prism())]),
        ),
        (
            "smooth union",
            Shape::smooth_union(0.3, [torus(), aside(capsule())]),
        ),
        ("cut", torus().minus([aside(capsule())])),
        ("common", Shape::intersection([torus(), aside(ellipsoid())])),
        ("sampled", sampled()),
        ("sampled shell", sampled().shell(0.02)),
        ("mirrored", aside(torus()).mirror([true, false, true])),
        ("elongated", torus().elongate(Vec3::new(0.4, 0.0, 0.2))),
        (
            "repeated",
            torus()
                .scale(0.4)
                .repeat(Vec3::new(3.0, 0.0, 2.5), [3, 0, 2]),
        ),
        ("morphed", torus().morph(aside(ellipsoid()), 0.4)),
        ("grown quadric", ellipsoid().offset(0.2)),
        (
            "shell of a union",
            Shape::union([cone(), aside(capsule())]).shell(0.01),
        ),
        ("ground", height_field(Vec3::new(5.0, 3.0, 5.0))),
    ]
}

/// Protects from waves that pass through a slab behind a field that they graze, for every kind of field, several sizes,
/// and several distances of the listener.
#[test]
fn no_wave_passes_a_slab_behind_a_field() {
    for (name, field) in kinds() {
        for (scale, listener) in [
            (1.0, Vec3::new(0.0, 0.0, 30.0)),
            (1.0, Vec3::new(900.0, 0.0, 400.0)),
            (0.1, Vec3::new(0.0, 0.0, 3.0)),
            (100.0, Vec3::new(0.0, 0.0, 3000.0)),
        ] {
            let scene = before_a_slab(name, field.clone(), scale, listener);
            compare(&scene, &aims(Vec3::NEG_Z, 0.6, 2000));
        }
    }
}

/// Directions that graze a torus from inside or outside its hole, at a distance of about `off` metres.
fn grazing(off: f64, count: u32) -> Vec<Vec3> {
    let direction = |index: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(index) / f64::from(count)).sin_cos();
        let side = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
        // From a distance of 6 m, a ray touches the circle of the tube if sin = tube / distance.
        let ring = DVec3::new(2.0, 0.0, -6.0);
        let angle = (2f64 / 6.0).atan() + side * ((0.8 + off) / ring.length()).asin();
        DVec3::new(angle.sin() * cos, angle.sin() * sin, -angle.cos()).as_vec3()
    };
    (0..count).map(direction).collect()
}

/// Protects grazing marches from thousands of steps. The bounds along the line lead past the surface or onto it in a
/// few steps.
#[test]
fn waves_that_graze_a_torus_are_not_given_up() {
    for listener in [Vec3::new(0.0, 0.0, 30.0), Vec3::new(300.0, 0.0, 30.0)] {
        let scene = before_a_slab("torus", torus(), 1.0, listener);
        for off in [-1e-3, -1e-5, -1e-6, 0.0, 1e-6, 1e-5, 1e-4, 1e-3] {
            compare(&scene, &grazing(off, 512));
        }
    }
}

/// Protects terrain from waves that pass through it: wide terrain seen from inside its box, and steep terrain whose
/// value is far below the distance.
#[test]
fn no_wave_passes_ground() {
    for size in [
        Vec3::new(200.0, 24.0, 200.0),
        Vec3::new(6.0, 50.0, 5.0),
        Vec3::new(0.4, 0.3, 0.4),
    ] {
        for far in [0.0, 100.0 * size.x.min(10.0)] {
            let ground = turned(Surface::new(height_field(size)), Vec3::new(0.0, 40.0, 12.0));
            let scene = Scene::new(
                format!("ground of {size} heard at {far}"),
                vec![ground],
                Source::at(size * Vec3::new(-0.2, 0.62, -0.15)),
                Listener::at(Vec3::new(far, 0.9 * size.y + 0.1 * far, 0.0), 0.02 * size.x),
            );
            compare(&scene, &aims(Vec3::new(0.4, -0.5, 0.3), 1.5, 6000));
        }
    }
}

/// Protects the profile `march` for waves that are aimed at an edge, or that stay parallel to a half space. No wave
/// reaches the step limit, and each wave has the hit of the closed form.
#[test]
fn edges_and_parallel_planes_take_few_steps() {
    let corners = [Vec2::ZERO, Vec2::new(1.0, 0.4), Vec2::new(1.0, -0.4)];
    let room = Surface::new(Node::Room(Room {
        size: Vec3::new(22.0, 12.0, 18.0),
    }));
    let source = Vec3::new(-8.25, 1.125, -6.25);
    let edge = Vec3::new(-6.8, 1.7, -3.8);
    let scene = Scene::new(
        "a prism's edge",
        vec![
            room,
            Surface::new(Shape::from(Node::Prism(Prism {
                corners,
                depth: 0.5,
            })))
            .at(edge),
        ],
        Source::at(source),
        Listener::at(Vec3::new(7.0, -1.3, 5.4), 1.7),
    );
    let points = (0..4001u16).map(|n| edge + Vec3::Z * (f32::from(n) / 4000.0 - 0.5) * 0.6);
    let at_edge: Vec<Vec3> = points.map(|p| (p - source).normalize()).collect();
    compare(&scene, &at_edge);

    let half = |normal: Vec3, offset: f32| {
        Surface::new(Shape::from(Node::HalfSpace(HalfSpace { normal, offset })))
    };
    let scene = Scene::new(
        "half spaces",
        vec![half(Vec3::Y, -2.0), half(Vec3::new(-1.0, -0.2, 0.3), -12.0)],
        Source::at(Vec3::new(-4.0, 1.0, -3.0)),
        Listener::at(Vec3::new(5.0, 1.0, 4.0), 1.1),
    );
    let level: Vec<Vec3> = (0..4000u16)
        .map(|n| {
            let (sin, cos) = (f32::from(n) * 0.01).sin_cos();
            Vec3::new(cos, (f32::from(n % 41) - 20.0) * 1e-3, sin).normalize()
        })
        .collect();
    compare(&scene, &level);
}

/// A room with 64 tori and 256 rounded boxes at random positions and angles, some of which overlap.
fn tori_and_boxes() -> Scene {
    let mut random = Random(7);
    let mut surfaces = vec![Surface::new(Room {
        size: Vec3::new(20.0, 10.0, 20.0),
    })];
    for index in 0..320 {
        let mut within = |low: f32, high: f32| low + (high - low) * random.unit() as f32;
        let shape: Shape = match index % 5 {
            0 => Torus {
                ring: within(0.3, 0.8),
                tube: within(0.1, 0.25),
            }
            .into(),
            _ => RoundedBox {
                size: Vec3::new(within(0.4, 1.0), within(0.4, 1.0), within(0.4, 1.0)),
                rounding: within(0.02, 0.15),
            }
            .into(),
        };
        let place = Vec3::new(within(-8.5, 8.5), within(-4.0, 3.5), within(-8.5, 8.5));
        let turn = Quat::from_axis_angle(random.direction().as_vec3(), 3.0 * random.unit() as f32);
        surfaces.push(Surface::new(shape).at(place).turned(turn));
    }
    Scene::new(
        "tori and rounded boxes",
        surfaces,
        Source::at(Vec3::new(-9.6, 4.7, -9.6)),
        Listener::at(Vec3::new(9.6, 4.7, 9.6), 0.2),
    )
}

/// Protects marched surfaces in cells, which are found by their bounding boxes: surfaces that overlap, surfaces in
/// several cells, and waves that leave a torus and hit it again.
#[test]
fn marched_surfaces_in_cells_are_hit_as_the_reference_hits_them() {
    let scene = tori_and_boxes();
    let directions = Random(9).directions(3000);
    for flights in [1, 2] {
        flights::compare_paths(&scene, &directions, &PROFILES, flights);
    }
}

/// Protects a room that has few fields of one kind and many of another. The few fields are marched together, the others
/// are marched one at a time, and the nearest hit counts.
#[test]
fn fields_in_cells_and_others_are_hit_in_their_order() {
    let mut scene = tori_and_boxes();
    let capsule = Shape::from(Node::Capsule(Capsule {
        radius: 0.3,
        height: 4.0,
    }));
    let blended = Shape::smooth_union(0.2, [capsule, torus().scale(0.5)]);
    scene.surfaces.push(Surface::new(blended));
    flights::compare(&scene, &Random(11).directions(2000), &PROFILES);
}

/// Protects surfaces in cells from relaxed steps that end just beyond a cell, where the list of surfaces does not
/// contain the surfaces that the step has passed. The wave is one of 65,536 in the glasshouse, after its first
/// reflection. The profile `march` led it through a trunk with a diameter of 0.26 m.
#[test]
fn a_step_that_leaves_its_cell_passes_nothing() {
    let mut scene = crate::common::builtin("glasshouse");
    let direction = Vec3::new(0.751_490_8, -0.065_449_245, -0.656_489_25);
    scene.sources[0] = Source::at(Vec3::new(0.115_575_79, -0.637_445_1, 8.0) + 0.01 * direction);
    compare(&scene, &aims(direction, 0.02, 8192));
}
