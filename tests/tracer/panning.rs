//! Panning: the side on which the listener hears a source.
//!
//! Signs: pan −1 is left, 1 is right; a listener that is not rotated looks along −z, with +x at the
//! right ear; a positive yaw rotates it to the right.

use crate::common::{builtin, for_each_api, mirrored, thesis, tracer};
use echomarch::scene::shape::Plane;
use echomarch::{Frame, Listener, Node, Scene, Settings, Source, Surface, Tracer};
use glam::Vec3;
use std::f32::consts::FRAC_PI_2;

const AHEAD: Vec3 = Vec3::new(0.0, 0.0, -5.0);
const TO_THE_LEFT: Vec3 = Vec3::new(-5.0, 0.0, 0.0);
const TO_THE_RIGHT: Vec3 = Vec3::new(5.0, 0.0, 0.0);

/// The listener's position in [`field`]: away from the world's origin, see
/// [`a_listener_at_the_origin_hears_dead_waves`].
const STAND: Vec3 = Vec3::new(20.0, 0.0, 30.0);

/// A plane far below, and an unobstructed source at `source` relative to the listener.
fn field(source: Vec3) -> Scene {
    Scene::new(
        "field",
        vec![Surface::new(Node::Plane(Plane)).at(Vec3::new(0.0, -10.0, 0.0))],
        Source::at(STAND + source),
        Listener::at(STAND, 2.0),
    )
}

/// Enough waves that the smallest number of hits in the field, some 3,000, leaves a standard error
/// of 0.5 / √3000 = 0.009: see [`standard_error`].
fn settings() -> Settings {
    thesis(65_536, 4)
}

/// Standard error of the pan of one frame. Waves from one side of the listener arrive spread evenly
/// over the disc of its sphere; across it, the side of an arrival has the variance of one
/// coordinate in the unit disc, 1/4. So a wave's standard deviation is at most 0.5, and less along
/// it.
fn standard_error(frame: &Frame) -> f64 {
    0.5 / (frame.counts.listener_hits as f64).sqrt()
}

fn pan(tracer: &mut Tracer, scene: &Scene) -> f64 {
    let frame = tracer.frame(scene, &settings()).unwrap();
    assert!(frame.counts.listener_hits > 1000, "{:?}", frame.counts);
    frame.panning.pan()
}

/// Protects the meaning of the panning value on every API: ahead is the middle, and a source is
/// heard on the side where it is. ±0.02 ahead is twice the standard error of the hits. At the side,
/// waves spread evenly over the disc pan to 2/3 of the way, the mean of √(1 − r²); 0.5 leaves room
/// for reflections off the ground, which come from below.
#[test]
fn a_source_is_heard_where_it_stands() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let ahead = pan(&mut tracer, &field(AHEAD));
        let left = pan(&mut tracer, &field(TO_THE_LEFT));
        let right = pan(&mut tracer, &field(TO_THE_RIGHT));
        assert!(ahead.abs() < 0.02, "{ahead}");
        assert!(left < -0.5, "{left}");
        assert!(right > 0.5, "{right}");
        // Two ears without a head cannot distinguish behind from ahead.
        let behind = pan(&mut tracer, &field(-AHEAD));
        assert!(behind.abs() < 0.02, "{behind}");
    });
}

/// Protects the sign of yaw: what was ahead is at the left after a turn to the right.
#[test]
fn turning_the_listener_turns_what_it_hears() {
    let mut tracer = tracer();
    let mut turned = |yaw: f32, source| {
        let mut scene = field(source);
        scene.listeners[0].yaw = yaw;
        pan(&mut tracer, &scene)
    };
    assert!(turned(FRAC_PI_2, AHEAD) < -0.5);
    assert!(turned(-FRAC_PI_2, AHEAD) > 0.5);
    assert!(turned(FRAC_PI_2, TO_THE_RIGHT).abs() < 0.02);
    assert!(turned(2.0 * FRAC_PI_2, TO_THE_RIGHT) < -0.5);
}

/// Protects the whole chain from a handedness of its own: a mirrored scene is heard mirrored, also
/// among boxes, pillars and rotated walls. The start directions are not mirrored with it, so the
/// two are independent samples: five standard errors of their sum.
#[test]
fn mirrored_scenes_are_heard_mirrored() {
    let mut tracer = tracer();
    let mut turned = builtin("open-pillars");
    turned.listeners[0].yaw = 0.5;
    turned.sources[0].position = Vec3::new(5.0, 2.0, 3.0);
    for scene in [field(Vec3::new(3.0, 1.0, -4.0)), turned, builtin("corner")] {
        let settings = settings().with_waves(262_144);
        let here = tracer.frame(&scene, &settings).unwrap();
        let there = tracer.frame(&mirrored(&scene), &settings).unwrap();
        let (pan, mirror_pan) = (here.panning.pan(), there.panning.pan());
        let error = standard_error(&here).hypot(standard_error(&there));
        let name = &scene.name;
        assert!(
            (pan + mirror_pan).abs() < 5.0 * error,
            "{name}: {pan}, mirrored {mirror_pan}, standard error {error}"
        );
        // A pan of 0 would be its own mirror image and prove nothing.
        assert!(pan.abs() > 10.0 * error, "{name}: {pan} ± {error}");
    }
}

/// Protects the panning pass from a division by 0: a source at the exact centre of the listener is
/// heard in the middle, in equal parts, by every wave.
#[test]
fn a_source_at_the_centre_is_heard_in_the_middle() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let frame = tracer.frame(&field(Vec3::ZERO), &thesis(1000, 2)).unwrap();
        assert_eq!(frame.counts.listener_hits, 1000);
        assert_eq!((frame.panning.left, frame.panning.right), (500.0, 500.0));
        assert_eq!(frame.panning.pan(), 0.0);
    });
}

/// A known fault, kept by the thesis profile: figure 8 puts a dead wave at (0, 0, 0) with direction
/// 0, marches it again, and hits whatever is there. A listener there hears every dead wave, in
/// equal parts. This test fails if the profile is repaired, which must not happen.
#[test]
fn a_listener_at_the_origin_hears_dead_waves() {
    let mut scene = field(TO_THE_LEFT);
    let mut tracer = tracer();
    let apart = tracer.frame(&scene, &thesis(4096, 4)).unwrap();
    assert!(apart.counts.dead > 1000, "{:?}", apart.counts);
    scene.sources[0].position -= STAND;
    scene.listeners[0].position = Vec3::ZERO;
    let here = tracer.frame(&scene, &thesis(4096, 4)).unwrap();
    // Waves that died in the last iteration are not marched again.
    let dead = apart.counts.dead - here.counts.dead;
    let heard = apart.counts.listener_hits + dead;
    // The moved scene's coordinates are rounded differently: a few waves may flip.
    assert!(
        here.counts.listener_hits.abs_diff(heard) <= 4,
        "{here:?}, {apart:?}"
    );
    assert!(here.panning.pan().abs() < 0.5 * apart.panning.pan().abs());
}

/// Protects silence: when no wave arrives, the sums are 0 and the pan is the middle, not NaN.
#[test]
fn nothing_arriving_is_the_middle() {
    let frame = tracer().frame(&builtin("obstacles"), &thesis(1000, 1));
    let frame = frame.unwrap();
    assert_eq!(frame.counts.listener_hits, 0);
    assert_eq!((frame.panning.left, frame.panning.right), (0.0, 0.0));
    assert_eq!(frame.panning.pan(), 0.0);
}
