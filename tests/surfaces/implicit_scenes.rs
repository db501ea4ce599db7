//! Properties of implicit surfaces: exact curved mirrors, and repetition without additional cost.

use crate::common::{builtin, tracer};
use echomarch::scene::shape::{Cylinder, Plane};
use echomarch::scene::{Node, Shape};
use echomarch::tracer::Wave;
use echomarch::{Listener, Profile, Scene, Settings, Source, Surface};
use glam::{DVec3, Vec3};

/// The two accurate profiles.
const PROFILES: [Profile; 2] = [Profile::Hybrid, Profile::March];

/// Maximum distance in metres of a reflected wave from the second focus.
const FOCUS: f64 = 1e-3;

/// Distance of a point from the line of a wave that is reflected at `position`.
fn miss(wave: &Wave, point: DVec3) -> f64 {
    let (from, along) = (wave.position.as_dvec3(), wave.direction.as_dvec3());
    (point - from).cross(along.normalize()).length()
}

/// Protects the exactness of curved mirrors: waves from one focus of an ellipsoid are reflected to the other focus,
/// both in closed form and by marching.
#[test]
fn waves_from_one_focus_meet_at_the_other() {
    let mut scene = builtin("whispering-gallery");
    let other = scene.listeners[0].position.as_dvec3();
    // The listener is too small to be hit, so that every wave is reflected.
    scene.listeners[0].radius = 1e-4;
    let mut tracer = tracer();
    for profile in PROFILES {
        let settings = Settings::new(profile).with_waves(65_536).with_iterations(1);
        let (frame, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
        let mirrored: Vec<&Wave> = waves.iter().filter(|wave| wave.status == 1.0).collect();
        assert!(mirrored.len() > 65_500, "{profile}: {:?}", frame.counts);
        let worst = mirrored
            .iter()
            .map(|wave| miss(wave, other))
            .fold(0.0, f64::max);
        println!("{profile}: {worst:.2e} m from the focus at most");
        assert!(worst < FOCUS, "{profile}: {worst} m");
    }
}

/// Protects the parabolic dishes: waves from the focus of one dish leave it parallel, and meet at the focus of the
/// other dish.
#[test]
fn dishes_send_waves_from_focus_to_focus() {
    let mut tracer = tracer();
    let scene = builtin("parabolic-mirrors");
    for profile in PROFILES {
        let settings = Settings::new(profile).with_waves(16_384).with_iterations(3);
        let frame = tracer.frame(&scene, &settings).unwrap();
        assert_eq!(frame.counts.step_limit_reached, 0, "{profile}");
        // About a quarter of all directions hit the dish. Almost no waves would reach the listener by chance.
        assert!(
            frame.counts.listener_hits > 4_000,
            "{profile}: {:?}",
            frame.counts
        );
    }
}

/// Number of pillars along x and along z, their spacing, and their radius in metres.
const SIDE: u32 = 100;
const SPACING: f32 = 4.0;
const RADIUS: f32 = 0.6;

fn colonnade(pillars: impl IntoIterator<Item = Surface>) -> Scene {
    let floor = Surface::new(Node::Plane(Plane)).at(Vec3::Y * -2.0);
    Scene::new(
        "colonnade",
        [floor].into_iter().chain(pillars).collect(),
        Source::at(Vec3::new(0.3, 0.0, -0.2)),
        Listener::at(Vec3::new(8.1, 0.0, 3.7), 1.0),
    )
}

fn repeated() -> Scene {
    let pillar = Shape::from(Node::Cylinder(Cylinder { radius: RADIUS }));
    let all = pillar.repeat(Vec3::new(SPACING, 0.0, SPACING), [SIDE, 0, SIDE]);
    colonnade([Surface::new(all)])
}

fn listed() -> Scene {
    let place = |index: u32| SPACING * (index as f32 - 0.5 * (SIDE - 1) as f32);
    let pillar = |index: u32| {
        let at = Vec3::new(place(index % SIDE), 0.0, place(index / SIDE));
        Surface::new(Node::Cylinder(Cylinder { radius: RADIUS })).at(at)
    };
    colonnade((0..SIDE * SIDE).map(pillar))
}

/// Protects repetition and cells: 10,000 pillars by repetition and by a list of surfaces have the same hits for each
/// wave.
///
/// The test uses 4 iterations, the smaller of the two counts in the thesis. Each pillar increases the distance between
/// neighbouring waves by a factor of about forty, so that `f32` rounding dominates at 8 iterations. In that case 0.1 to
/// 0.2 % of the waves differ, the same share as between the waves and the exact reference
/// (docs/benchmarks/surfaces-llvmpipe.md).
#[test]
fn a_repeated_pillar_is_ten_thousand_pillars() {
    const MOST: f64 = 5e-4;
    let (repeated, listed) = (repeated(), listed());
    let mut tracer = tracer();
    for profile in PROFILES {
        let settings = Settings::new(profile).with_waves(65_536).with_iterations(4);
        let (one, by_modulo) = tracer.frame_with_waves(&repeated, &settings).unwrap();
        let (_, one_by_one) = tracer.frame_with_waves(&listed, &settings).unwrap();
        let heard = |wave: &Wave| wave.status == 0.0;
        let pairs = by_modulo.iter().zip(&one_by_one);
        let differ = pairs.filter(|(a, b)| heard(a) != heard(b)).count();
        let share = differ as f64 / by_modulo.len() as f64;
        let heard = one.counts.listener_hits;
        println!("{profile}: {differ} differ, {heard} are heard");
        assert!(heard > 150, "{:?}", one.counts);
        assert!(share <= MOST, "{profile}: {share}");
    }
}
