//! Marched fields against the exact reference: no wave passes a solid, none is given up at a
//! glance, and both profiles agree, near the listener and far from it.

mod common;

use common::tracer;
use echomarch::reference::ExactScene;
use echomarch::scene::{Field, HeightImage, Node};
use echomarch::trace::Wave;
use echomarch::{Listener, Profile, Scene, Settings, Shape, Source, Surface};
use glam::{DVec3, EulerRot, Quat, UVec2, Vec2, Vec3};
use std::sync::Arc;

const PROFILES: [Profile; 2] = [Profile::Hybrid, Profile::March];

/// Units in the last place of the largest coordinate by which a ray may be off: what placing
/// surfaces, flying and landing cost.
const ROUNDINGS: f64 = 8.0;

/// Where a wave may end otherwise than its exact twin: the twin of a ray that is this much off.
fn rounding(scene: &Scene) -> f64 {
    let far = |place: Vec3| f64::from((place - scene.listener.position).abs().max_element());
    let places = scene.surfaces.iter().map(|surface| {
        let extent = match &surface.shape {
            Shape::Field(field) => field.properties().bounds.half_size().max_element(),
            _ => 0.0,
        };
        far(surface.position) + if extent.is_finite() { extent } else { 0.0 }
    });
    let largest = places.fold(far(scene.source.position), f64::max);
    ROUNDINGS * f64::from(f32::EPSILON) * largest
}

/// Directions around one another within a cone about an axis, evenly.
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

/// Traces one flight in each profile and compares it with the exact one.
fn compare(scene: &Scene, directions: &[Vec3]) {
    let exact = ExactScene::new(scene).unwrap();
    let start = scene.source.position.as_dvec3();
    let ear = scene.listener.position.as_dvec3();
    let mut tracer = tracer();
    for profile in PROFILES {
        let settings = Settings::of(profile).with_iterations(1);
        let states = tracer
            .trace_directions(scene, &settings, directions)
            .unwrap();
        let waves = &states[1];
        let context = |wave: &Wave| format!("{}, {profile}: {wave:?}", scene.name);
        for wave in waves {
            assert_eq!(wave.step_limit_reached, 0, "{}", context(wave));
            let d = wave.start_direction.as_dvec3();
            let truth = exact.trace(start, d, 1);
            let place = wave.position.as_dvec3();
            if wave.status < 0.0 && truth.status < 0 {
                continue;
            }
            let reach = (truth.point - ear).abs().max_element();
            let off = rounding(scene).max(ROUNDINGS * f64::from(f32::EPSILON) * reach);
            let near = place.distance(truth.point) <= off;
            if wave.status as i32 == truth.status && near {
                assert!(exact.surface_distance(place) > -off, "{}", context(wave));
                continue;
            }
            // It hangs on a rounding, or one is a long way along the surface: then rays beside
            // it end on either side of it, and the place lies on a surface all the same.
            let (one, other) = d.any_orthonormal_pair();
            let aside = [one, -one, other, -other].map(|side| {
                let twin = exact.trace(start + off * side, d, 1);
                (twin.status, twin.point.distance(truth.point))
            });
            let as_twin = aside.iter().any(|twin| twin.0 == wave.status as i32);
            let spread = aside.iter().map(|twin| twin.1).fold(0.0, f64::max);
            let off_surfaces = wave.status <= 0.0;
            let on_surface = off_surfaces || exact.surface_distance(place).abs() <= off;
            let same = wave.status as i32 == truth.status
                && place.distance(truth.point) <= off + 2.0 * spread;
            let other = wave.status as i32 != truth.status && as_twin;
            assert!(
                on_surface && (same || other),
                "{} for {truth:?}",
                context(wave)
            );
        }
    }
}

fn torus() -> Field {
    Node::Torus {
        ring: 2.0,
        tube: 0.8,
    }
    .into()
}

fn turned(surface: Surface, degrees: Vec3) -> Surface {
    let by = degrees * std::f32::consts::PI / 180.0;
    surface.turned(Quat::from_euler(EulerRot::XYZ, by.x, by.y, by.z))
}

/// A field 6 m before a slab of 200 m, and the listener.
fn before_a_slab(name: &str, field: Field, scale: f32, listener: Vec3) -> Scene {
    let slab = Field::from(Node::RoundedBox {
        size: Vec3::new(200.0, 200.0, 0.5) * scale,
        rounding: 0.1 * scale,
    });
    let ahead = Surface::new(field.scale(scale)).at(Vec3::new(0.0, 0.0, -6.0 * scale));
    Scene {
        name: format!("{name} x {scale} heard at {listener}"),
        surfaces: vec![
            turned(ahead, Vec3::new(90.0, 0.0, 0.0)),
            Surface::new(slab).at(Vec3::new(0.0, 0.0, -20.0 * scale)),
        ],
        source: Source::at(Vec3::ZERO),
        listener: Listener::at(listener, scale),
    }
}

fn hills(side: u32) -> Arc<HeightImage> {
    let height = |index: u32| {
        let (x, z) = (index % side, index / side);
        ((x * 7 + z * 13 + x * z * 3) % 17) as f32 / 16.0
    };
    let heights = (0..side * side).map(height).collect();
    Arc::new(HeightImage::new("hills", UVec2::splat(side), heights).unwrap())
}

fn height_field(size: Vec3) -> Field {
    Node::HeightField {
        image: hills(24),
        size,
    }
    .into()
}

/// Every kind of field whose march may be led past a solid: not convex, or blended, cut, thin.
fn kinds() -> Vec<(&'static str, Field)> {
    let cone = || {
        Field::from(Node::Cone {
            radius: 1.5,
            height: 3.0,
        })
    };
    let prism = || {
        let corners = [
            Vec2::new(0.0, 0.0),
            Vec2::new(2.0, 0.4),
            Vec2::new(1.0, 2.0),
        ];
        Field::from(Node::Prism {
            corners,
            depth: 1.5,
        })
    };
    let capsule = || {
        Field::from(Node::Capsule {
            radius: 0.6,
            height: 2.5,
        })
    };
    let ellipsoid = || {
        Field::from(Node::Ellipsoid {
            radii: Vec3::new(2.5, 0.4, 1.0),
        })
    };
    let aside = |field: Field| field.translate(Vec3::new(0.7, 0.2, -0.4));
    vec![
        ("torus", torus()),
        ("shell of a torus", torus().shell(0.02)),
        (
            "union",
            Field::union([torus(), aside(cone()), aside(prism())]),
        ),
        (
            "smooth union",
            Field::smooth_union(0.3, [torus(), aside(capsule())]),
        ),
        ("cut", torus().minus([aside(capsule())])),
        ("common", Field::intersection([torus(), aside(ellipsoid())])),
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
            Field::union([cone(), aside(capsule())]).shell(0.01),
        ),
        ("ground", height_field(Vec3::new(5.0, 3.0, 5.0))),
    ]
}

/// Protects from waves that step through a slab behind a field that they graze, whatever the
/// field, its size, and how far away the listener is.
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

/// Directions that touch a torus from within its hole or from outside, to about `off` metres.
fn grazing(off: f64, count: u32) -> Vec<Vec3> {
    let direction = |index: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(index) / f64::from(count)).sin_cos();
        let side = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
        // From 6 m away the circle of the tube is touched where sin = tube / distance.
        let ring = DVec3::new(2.0, 0.0, -6.0);
        let angle = (2f64 / 6.0).atan() + side * ((0.8 + off) / ring.length()).asin();
        DVec3::new(angle.sin() * cos, angle.sin() * sin, -angle.cos()).as_vec3()
    };
    (0..count).map(direction).collect()
}

/// Protects the finish of a graze: the bounds along the line lead past the surface, or onto it,
/// in a few steps, where steps by the value take thousands.
#[test]
fn waves_that_graze_a_torus_are_not_given_up() {
    for listener in [Vec3::new(0.0, 0.0, 30.0), Vec3::new(300.0, 0.0, 30.0)] {
        let scene = before_a_slab("torus", torus(), 1.0, listener);
        for off in [-1e-3, -1e-5, -1e-6, 0.0, 1e-6, 1e-5, 1e-4, 1e-3] {
            compare(&scene, &grazing(off, 512));
        }
    }
}

/// Protects ground from waves that pass through or past it: wide ground seen from within, and
/// steep ground whose value says little of the distance.
#[test]
fn no_wave_passes_ground() {
    for size in [
        Vec3::new(200.0, 24.0, 200.0),
        Vec3::new(6.0, 50.0, 5.0),
        Vec3::new(0.4, 0.3, 0.4),
    ] {
        for far in [0.0, 100.0 * size.x.min(10.0)] {
            let ground = turned(Surface::new(height_field(size)), Vec3::new(0.0, 40.0, 12.0));
            let scene = Scene {
                name: format!("ground of {size} heard at {far}"),
                surfaces: vec![ground],
                source: Source::at(size * Vec3::new(-0.2, 0.62, -0.15)),
                listener: Listener::at(
                    Vec3::new(far, 0.9 * size.y + 0.1 * far, 0.0),
                    0.02 * size.x,
                ),
            };
            compare(&scene, &aims(Vec3::new(0.4, -0.5, 0.3), 1.5, 6000));
        }
    }
}

/// Protects `march` where a wave is aimed at an edge, and where it runs beside a half space for
/// ever: none is given up, and each meets what the closed form says.
#[test]
fn edges_and_parallel_planes_take_few_steps() {
    let corners = [Vec2::ZERO, Vec2::new(1.0, 0.4), Vec2::new(1.0, -0.4)];
    let room = Surface::new(Shape::Room {
        size: Vec3::new(22.0, 12.0, 18.0),
    });
    let source = Vec3::new(-8.25, 1.125, -6.25);
    let edge = Vec3::new(-6.8, 1.7, -3.8);
    let scene = Scene {
        name: "a prism's edge".into(),
        surfaces: vec![
            room,
            Surface::new(Field::from(Node::Prism {
                corners,
                depth: 0.5,
            }))
            .at(edge),
        ],
        source: Source::at(source),
        listener: Listener::at(Vec3::new(7.0, -1.3, 5.4), 1.7),
    };
    let points = (0..4001u16).map(|n| edge + Vec3::Z * (f32::from(n) / 4000.0 - 0.5) * 0.6);
    let at_edge: Vec<Vec3> = points.map(|p| (p - source).normalize()).collect();
    compare(&scene, &at_edge);

    let half =
        |normal: Vec3, offset: f32| Surface::new(Field::from(Node::HalfSpace { normal, offset }));
    let scene = Scene {
        name: "half spaces".into(),
        surfaces: vec![half(Vec3::Y, -2.0), half(Vec3::new(-1.0, -0.2, 0.3), -12.0)],
        source: Source::at(Vec3::new(-4.0, 1.0, -3.0)),
        listener: Listener::at(Vec3::new(5.0, 1.0, 4.0), 1.1),
    };
    let level: Vec<Vec3> = (0..4000u16)
        .map(|n| {
            let (sin, cos) = (f32::from(n) * 0.01).sin_cos();
            Vec3::new(cos, (f32::from(n % 41) - 20.0) * 1e-3, sin).normalize()
        })
        .collect();
    compare(&scene, &level);
}
