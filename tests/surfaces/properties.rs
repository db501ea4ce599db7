//! Properties of waves on the GPU that are known in advance, over seven decades of size.
//!
//! Each case is one surface with random size, position and rotation, and hundreds of waves. A few dozen cases thus give
//! tens of thousands of waves.

use crate::common::Random;
use echomarch::geometry::ExactScene;
use echomarch::gl::{Context, ContextOptions};
use echomarch::scene::shape::{Cuboid, Cylinder, Plane, Room, Sphere};
use echomarch::tracer::{Fate, Wave};
use echomarch::{Listener, Node, Profile, Scene, Settings, Source, Surface, Tracer};
use glam::{DQuat, DVec3, Quat, Vec3};
use proptest::prelude::*;
use std::cell::RefCell;

/// Rounding error of a start, as a share of the scene's extent: eight units in the last place.
const START_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Additional rounding error of an end point, as a share of the scene's extent.
const END_ROUNDING: f64 = 16.0 * f32::EPSILON as f64;

/// Rounding error of the length of a direction that GLSL allows (GLSL 4.60, section 4.7.1).
const LENGTH_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// The accurate profiles. The thesis' profile has none of these properties.
const PROFILES: [Profile; 2] = [Profile::Hybrid, Profile::March];

/// Number of waves in each case.
const WAVES: usize = 256;

thread_local! {
    /// One tracer for all cases of a test, so that programs are compiled only once per structure.
    static TRACER: RefCell<Option<Tracer>> = const { RefCell::new(None) };
}

fn trace(scene: &Scene, settings: &Settings, directions: &[Vec3]) -> Vec<Vec<Wave>> {
    TRACER.with_borrow_mut(|tracer| {
        let tracer = tracer.get_or_insert_with(|| {
            let context =
                Context::headless(&ContextOptions::default()).unwrap_or_else(|e| panic!("{e}"));
            Tracer::new(&context).unwrap()
        });
        tracer
            .trace_directions(scene, settings, directions)
            .unwrap_or_else(|e| panic!("{e}"))
    })
}

/// Returns a random rotation for half of the cases, and no rotation for the others. Rotated surfaces have a different
/// shader text.
fn rotation(random: &mut Random) -> Quat {
    if random.unit() < 0.5 {
        return Quat::IDENTITY;
    }
    let axis = random.direction().as_vec3().normalize();
    Quat::from_axis_angle(axis, (3.0 * random.unit()) as f32)
}

/// A surface and a point on the surface.
struct Planted {
    surface: Surface,
    /// Position of the point, in world metres.
    point: DVec3,
    /// Normal at the point, which points out of the solid.
    normal: DVec3,
    /// Size of the surface in metres.
    size: f64,
}

fn plant(random: &mut Random) -> Planted {
    let scale = random.scale();
    let mut side = || scale * (0.3 + 0.7 * random.unit());
    let size = DVec3::new(side(), side(), side()).as_vec3();
    let half = size.as_dvec3() * 0.5;
    let radius = size.x;
    let round = f64::from(radius);
    let around = random.direction();
    let ring = around.with_y(0.0).normalize();
    let face = [DVec3::X, DVec3::Y, DVec3::Z][(random.unit() * 3.0) as usize];
    let within: DVec3 = std::array::from_fn(|_| 0.9 * random.signed()).into();
    let on_face = half * (within * (DVec3::ONE - face) + face);
    let (shape, point, normal) = match (random.unit() * 5.0) as usize {
        0 => (Node::Plane(Plane), ring * round, DVec3::Y),
        1 => (Node::Cuboid(Cuboid { size }), on_face, face),
        2 => (Node::Room(Room { size }), on_face, -face),
        3 => (Node::Sphere(Sphere { radius }), around * round, around),
        _ => (
            Node::Cylinder(Cylinder { radius }),
            ring * round + DVec3::Y * (within.y * round),
            ring,
        ),
    };
    let rotation = rotation(random);
    let [x, y, z, w] = rotation.to_array().map(f64::from);
    let turn = DQuat::from_xyzw(x, y, z, w).normalize();
    let position = (random.direction() * scale * 3.0 * random.unit()).as_vec3();
    Planted {
        surface: Surface::new(shape).at(position).turned(rotation),
        point: turn * point + position.as_dvec3(),
        normal: turn * normal,
        size: scale,
    }
}

impl Planted {
    /// Returns a scene with only this surface. The listener is behind the point: deep in the solid, or on the far side
    /// of a thin solid. Lines from the point therefore hit the surface first.
    fn scene(&self, source: DVec3) -> Scene {
        let ear = self.point - self.normal * (3.0 * self.size);
        Scene::new(
            "planted",
            vec![self.surface.clone()],
            Source::at(source.as_vec3()),
            Listener::at(ear.as_vec3(), (1e-3 * self.size) as f32),
        )
    }

    /// Returns a direction out of the solid, at an angle of at least a thousandth of a radian to the surface.
    fn outgoing(&self, random: &mut Random) -> Vec3 {
        let mut away = random.direction();
        if away.dot(self.normal) < 0.0 {
            away = -away;
        }
        (away + self.normal * 1e-3).normalize().as_vec3()
    }

    fn is_room(&self) -> bool {
        matches!(self.surface.shape.node, Node::Room(_))
    }
}

/// Largest distance from the listener to a coordinate of the scene, in metres.
fn extent(planted: &Planted, scene: &Scene) -> f64 {
    let ear = scene.listeners[0].position.as_dvec3();
    let place = planted.surface.position.as_dvec3();
    place.distance(ear) + 1.8 * planted.size + scene.sources[0].position.as_dvec3().distance(ear)
}

/// Returns a unit in the last place of world coordinates. Half of it is lost when a position is converted to `f32`, and
/// half when it is read back.
fn world_rounding(scene: &Scene, extent: f64) -> f64 {
    let world = scene.listeners[0].position.as_dvec3().abs().max_element() + extent;
    world * f64::from(f32::EPSILON)
}

/// Checks the properties that every state of a wave has, whatever the wave hits.
fn assert_sane(states: &[Vec<Wave>], scene: &Scene, extent: f64, context: &str) {
    let exact = ExactScene::new(scene).unwrap();
    let ear = scene.listeners[0].position;
    for wave in states.iter().flatten() {
        assert!(
            wave.position.is_finite() && wave.direction.is_finite(),
            "{context}: {wave:?}"
        );
        assert_eq!(wave.step_limit_reached, 0, "{context}: {wave:?}");
        let length = wave.direction.as_dvec3().length();
        assert!(
            (length - 1.0).abs() < LENGTH_ROUNDING,
            "{context}: {wave:?}"
        );
        // Far from the listener, the resolution of a position is that of its own coordinates.
        let reach = extent.max(wave.position.distance(ear).into());
        let tolerance = END_ROUNDING * reach + world_rounding(scene, reach);
        let depth = -exact.surface_distance(wave.position.as_dvec3());
        assert!(depth < tolerance, "{context}: {depth} m deep, {wave:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Protects waves that leave a surface from hitting it again at once, at any size and position. The waves first hit
    /// a planted point, and then leave it.
    #[test]
    fn a_wave_that_leaves_a_surface_does_not_meet_it_at_once(seed: u64) {
        let mut random = Random(seed);
        let planted = plant(&mut random);
        // The waves start in the air in front of the point, and hit the point or its surroundings.
        let height = planted.size * if planted.is_room() { 0.05 } else { random.unit() };
        let source = planted.point + planted.normal * height;
        let directions: Vec<Vec3> = (0..WAVES).map(|_| -planted.outgoing(&mut random)).collect();
        let scene = planted.scene(source);
        let extent = extent(&planted, &scene);
        for profile in PROFILES {
            let settings = Settings::new(profile).with_iterations(8);
            let states = trace(&scene, &settings, &directions);
            let context = format!("{profile}, {:?}", planted.surface);
            assert_sane(&states, &scene, extent, &context);
            if planted.is_room() {
                // At an edge a wave may hit two walls, but never one wall twice in succession: the change of direction
                // is along the normal of the wall.
                for states in states.windows(3) {
                    for ((a, b), c) in states[0].iter().zip(&states[1]).zip(&states[2]) {
                        let first = b.direction - a.direction;
                        let second = c.direction - b.direction;
                        let met = b.status == 1.0 && c.status == 1.0;
                        if !met || first.length().min(second.length()) < 1e-3 {
                            continue;
                        }
                        let cos = first.normalize().dot(second.normalize());
                        prop_assert!(cos < 0.5, "{context}: {a:?} {b:?} {c:?}");
                    }
                }
                continue;
            }
            for pair in states.windows(2).skip(1) {
                for (before, after) in pair[0].iter().zip(&pair[1]) {
                    let met_again =
                        before.status == 1.0 && after.fate() == Fate::Travelling;
                    prop_assert!(!met_again, "{context}: {before:?} {after:?}");
                }
            }
        }
    }

    /// Protects waves that start on a surface and point away from it: they leave it.
    #[test]
    fn a_wave_that_starts_on_a_surface_flies_off(seed: u64) {
        let mut random = Random(seed);
        let planted = plant(&mut random);
        let directions: Vec<Vec3> = (0..WAVES).map(|_| planted.outgoing(&mut random)).collect();
        let scene = planted.scene(planted.point);
        let extent = extent(&planted, &scene);
        for profile in PROFILES {
            let states = trace(&scene, &Settings::new(profile).with_iterations(1), &directions);
            let context = format!("{profile}, {:?}", planted.surface);
            assert_sane(&states, &scene, extent, &context);
            for (before, after) in states[0].iter().zip(&states[1]) {
                prop_assert!(before.status >= 0.0, "{context}: {before:?}");
                if planted.is_room() {
                    prop_assert!(after.status == 1.0 && after.zero_length_passes == 0, "{context}: {after:?}");
                } else {
                    let met = after.fate() == Fate::Travelling;
                    prop_assert!(!met, "{context}: {before:?} {after:?}");
                }
            }
        }
    }

    /// Protects the positions of hits. The hit is at the planted point, within the effect of the start's rounding error
    /// at this slant. The curvature has an effect of second order, which is small at slants above 0.05.
    #[test]
    fn a_wave_aimed_at_a_surface_lands_there(seed: u64) {
        let mut random = Random(seed);
        let planted = plant(&mut random);
        let away = loop {
            let away = planted.outgoing(&mut random).as_dvec3();
            if away.dot(planted.normal) > 0.05 {
                break away;
            }
        };
        let distance = match planted.surface.shape.node {
            // In the room, the point is at least this far from all edges.
            Node::Room(_) => planted.size * 0.014 * random.unit(),
            _ => planted.size * 10f64.powf(4.0 * random.unit() - 2.0),
        };
        let source = planted.point + away * distance;
        let scene = planted.scene(source);
        let from = scene.sources[0].position.as_dvec3();
        let aim = (planted.point - from).normalize();
        let extent = extent(&planted, &scene);
        let slant = -aim.dot(planted.normal);
        // The bound is twice the effect of a start that is off by one rounding error. The error shifts the position,
        // and changes the direction of a path that is no longer than the extent.
        let start = 2.0 * START_ROUNDING * extent;
        let bound = 2.0 * start / slant + world_rounding(&scene, extent);
        for profile in PROFILES {
            let states = trace(&scene, &Settings::new(profile).with_iterations(1), &[aim.as_vec3()]);
            let wave = states[1][0];
            let off = wave.position.as_dvec3().distance(planted.point);
            prop_assert_eq!(wave.status, 1.0, "{}, {:?}", profile, planted.surface);
            prop_assert!(off < bound, "{profile}, {:?}: {off} m of {bound} m, {wave:?}", planted.surface);
        }
    }
}
