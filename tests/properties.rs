//! Properties of waves on the GPU, with planted answers over seven decades of size.
//!
//! Each case is one random surface of random size, place and turn, and hundreds of waves,
//! so that a few dozen cases are tens of thousands of waves.

use echomarch::gpu::{Context, ContextOptions};
use echomarch::reference::ExactScene;
use echomarch::trace::{Fate, Wave};
use echomarch::{Listener, Profile, Scene, Settings, Shape, Source, Surface, Tracer};
use glam::{DQuat, DVec3, Quat, Vec3};
use proptest::prelude::*;
use std::cell::RefCell;
use std::f64::consts::TAU;

/// Right profiles; the thesis' has none of these properties.
const PROFILES: [Profile; 2] = [Profile::Hybrid, Profile::March];

/// Waves of each case.
const WAVES: usize = 256;

/// A rounding as a share of the scene's extent: eight units in the last place.
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// What a direction's length may be off.
const LENGTH_ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

thread_local! {
    /// One tracer for all cases of a test: programs are compiled once a structure.
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

/// SplitMix64 (Steele et al. 2014): the same numbers on every machine.
struct Random(u64);

impl Random {
    /// Uniform in 0 … 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 * (-53f64).exp2()
    }

    fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform over the unit sphere (Archimedes: its height is uniform).
    fn direction(&mut self) -> DVec3 {
        let height = self.signed();
        let (sin, cos) = (TAU * self.unit()).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        DVec3::new(ring * cos, height, ring * sin)
    }

    /// Uniform in the logarithm, from 10⁻³ to 10⁴.
    fn scale(&mut self) -> f64 {
        10f64.powf(7.0 * self.unit() - 3.0)
    }

    /// None for every second case: turned surfaces have a text of their own.
    fn rotation(&mut self) -> Quat {
        if self.unit() < 0.5 {
            return Quat::IDENTITY;
        }
        Quat::from_axis_angle(
            self.direction().as_vec3().normalize(),
            (3.0 * self.unit()) as f32,
        )
    }
}

/// A surface with a point on it.
struct Planted {
    surface: Surface,
    /// On the surface, world metres.
    point: DVec3,
    /// Out of the solid there.
    normal: DVec3,
    /// Its size in metres.
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
        0 => (Shape::Plane, ring * round, DVec3::Y),
        1 => (Shape::Box { size }, on_face, face),
        2 => (Shape::Room { size }, on_face, -face),
        3 => (Shape::Sphere { radius }, around * round, around),
        _ => (
            Shape::Cylinder { radius },
            ring * round + DVec3::Y * (within.y * round),
            ring,
        ),
    };
    let rotation = random.rotation();
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
    /// The surface and nothing else; a listener behind the point, deep in the solid or
    /// (behind a thin one) on its far side, where no line from the point can go first.
    fn scene(&self, source: DVec3) -> Scene {
        let ear = self.point - self.normal * (3.0 * self.size);
        Scene {
            name: "planted".into(),
            surfaces: vec![self.surface.clone()],
            source: Source::at(source.as_vec3()),
            listener: Listener::at(ear.as_vec3(), (1e-3 * self.size) as f32),
        }
    }

    /// Outwards, down to a thousandth of a radian along the surface.
    fn outgoing(&self, random: &mut Random) -> Vec3 {
        let mut away = random.direction();
        if away.dot(self.normal) < 0.0 {
            away = -away;
        }
        (away + self.normal * 1e-3).normalize().as_vec3()
    }

    fn is_room(&self) -> bool {
        matches!(self.surface.shape, Shape::Room { .. })
    }
}

/// Largest distance from the listener that the scene's numbers reach.
fn extent(planted: &Planted, scene: &Scene) -> f64 {
    let ear = scene.listener.position.as_dvec3();
    let place = planted.surface.position.as_dvec3();
    place.distance(ear) + 1.8 * planted.size + scene.source.position.as_dvec3().distance(ear)
}

/// Half a unit in the last place of world coordinates.
fn world_rounding(scene: &Scene, extent: f64) -> f64 {
    let world = scene.listener.position.as_dvec3().abs().max_element() + extent;
    world * f64::from(f32::EPSILON)
}

/// What must hold in every state whatever is met.
fn assert_sane(states: &[Vec<Wave>], scene: &Scene, extent: f64, context: &str) {
    let exact = ExactScene::new(scene).unwrap();
    let ear = scene.listener.position;
    for wave in states.iter().flatten() {
        assert!(
            wave.position.is_finite() && wave.direction.is_finite(),
            "{context}: {wave:?}"
        );
        assert_eq!(wave.guard_hits, 0, "{context}: {wave:?}");
        let length = wave.direction.as_dvec3().length();
        assert!(
            (length - 1.0).abs() < LENGTH_ROUNDING,
            "{context}: {wave:?}"
        );
        // Far out a place is as coarse as its own coordinates.
        let reach = extent.max(wave.position.distance(ear).into());
        let tolerance = 2.0 * ROUNDING * reach + world_rounding(scene, reach);
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

    /// Protects waves that leave a surface from meeting it again on the spot, at any size
    /// and place: first they come down on a planted point, then they leave it.
    #[test]
    fn a_wave_that_leaves_a_surface_does_not_meet_it_at_once(seed: u64) {
        let mut random = Random(seed);
        let planted = plant(&mut random);
        // They start in the air before the point and come down on it and about it.
        let height = planted.size * if planted.is_room() { 0.05 } else { random.unit() };
        let source = planted.point + planted.normal * height;
        let directions: Vec<Vec3> = (0..WAVES).map(|_| -planted.outgoing(&mut random)).collect();
        let scene = planted.scene(source);
        let extent = extent(&planted, &scene);
        for profile in PROFILES {
            let settings = Settings::of(profile).with_iterations(8);
            let states = trace(&scene, &settings, &directions);
            let context = format!("{profile}, {:?}", planted.surface);
            assert_sane(&states, &scene, extent, &context);
            for pair in states.windows(2).skip(1) {
                for (before, after) in pair[0].iter().zip(&pair[1]) {
                    let left = before.status == 1.0;
                    if planted.is_room() {
                        // Two walls may be met at one edge, never one wall twice.
                        let moved = before.position.distance(after.position) > 0.0;
                        let turned = before.direction.dot(after.direction) > -0.999;
                        prop_assert!(moved || turned || !left, "{context}: {before:?}");
                    } else {
                        let met_again = left && Fate::of(after.status) == Fate::Travelling;
                        prop_assert!(!met_again, "{context}: {before:?} {after:?}");
                    }
                }
            }
        }
    }

    /// Protects waves that start on a surface: those that leave it fly off.
    #[test]
    fn a_wave_that_starts_on_a_surface_flies_off(seed: u64) {
        let mut random = Random(seed);
        let planted = plant(&mut random);
        let directions: Vec<Vec3> = (0..WAVES).map(|_| planted.outgoing(&mut random)).collect();
        let scene = planted.scene(planted.point);
        let extent = extent(&planted, &scene);
        for profile in PROFILES {
            let states = trace(&scene, &Settings::of(profile).with_iterations(1), &directions);
            let context = format!("{profile}, {:?}", planted.surface);
            assert_sane(&states, &scene, extent, &context);
            for (before, after) in states[0].iter().zip(&states[1]) {
                // A start that rounding put into the solid by more than it allows is dead.
                if before.status < 0.0 {
                    continue;
                }
                if planted.is_room() {
                    prop_assert!(after.status == 1.0 && after.zero_length_passes == 0, "{context}: {after:?}");
                } else {
                    let met = Fate::of(after.status) == Fate::Travelling;
                    prop_assert!(!met, "{context}: {before:?} {after:?}");
                }
            }
        }
    }

    /// Protects where waves land: on the planted point, within what rounding of the start
    /// does at that slant and that curvature.
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
        let distance = match planted.surface.shape {
            // Within the room: the point is at least this far from its edges.
            Shape::Room { .. } => planted.size * 0.014 * random.unit(),
            _ => planted.size * 10f64.powf(4.0 * random.unit() - 2.0),
        };
        let source = planted.point + away * distance;
        let scene = planted.scene(source);
        let from = scene.source.position.as_dvec3();
        let aim = (planted.point - from).normalize();
        let extent = extent(&planted, &scene);
        let slant = -aim.dot(planted.normal);
        let bound = 4.0 * ROUNDING * extent / slant + world_rounding(&scene, extent);
        for profile in PROFILES {
            let states = trace(&scene, &Settings::of(profile).with_iterations(1), &[aim.as_vec3()]);
            let wave = states[1][0];
            let off = wave.position.as_dvec3().distance(planted.point);
            prop_assert_eq!(wave.status, 1.0, "{}, {:?}", profile, planted.surface);
            prop_assert!(off < bound, "{profile}, {:?}: {off} m of {bound} m, {wave:?}", planted.surface);
        }
    }
}
