//! Tests of panning: the side on which the listener hears a source.
//!
//! Signs: pan −1 is left, and 1 is right. A listener that is not rotated looks along −z, and +x is at its right ear. A
//! positive yaw rotates it to the right.

use crate::common::{builtin, for_each_api, mirrored, thesis, tracer};
use echomarch::scene::shape::Plane;
use echomarch::{Frame, Listener, Node, Scene, Settings, Source, Surface, Tracer};
use glam::Vec3;
use std::f32::consts::FRAC_PI_2;

const AHEAD: Vec3 = Vec3::new(0.0, 0.0, -5.0);
const TO_THE_LEFT: Vec3 = Vec3::new(-5.0, 0.0, 0.0);
const TO_THE_RIGHT: Vec3 = Vec3::new(5.0, 0.0, 0.0);

/// The listener's position in [`field`]. It is away from the world's origin, see
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

/// The number of waves is large enough: the smallest number of hits in [`field`], about 3,000, has a standard error of
/// 0.5 / √3000 = 0.009, see [`standard_error`].
fn settings() -> Settings {
    thesis(65_536, 4)
}

/// Standard error of the pan of one frame. Waves from one direction arrive evenly distributed over the disc of the
/// listener's sphere. If the direction is perpendicular to the ear axis, the pan of a wave has the variance of one
/// coordinate in the unit disc, 1/4. The standard deviation of a wave's pan is therefore 0.5, and less for all other
/// directions.
fn standard_error(frame: &Frame) -> f64 {
    0.5 / (frame.counts.listener_hits as f64).sqrt()
}

fn pan(tracer: &mut Tracer, scene: &Scene) -> f64 {
    let frame = tracer.frame(scene, &settings()).unwrap();
    assert!(frame.counts.listener_hits > 1000, "{:?}", frame.counts);
    frame.panning.pan()
}

/// Protects the meaning of the panning value on every API: a source ahead is in the middle, and any other source is
/// heard on its own side. The tolerance of ±0.02 ahead is twice the standard error. At the side, waves that are evenly
/// distributed over the disc have a mean pan of 2/3, the mean of √(1 − r²). The limit of 0.5 leaves room for
/// reflections from the ground.
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

/// Protects the sign of yaw: after a turn to the right, a source that was ahead is at the left.
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

/// Protects all steps from a preferred side: a mirrored scene is heard mirrored, also among boxes, pillars and rotated
/// walls. The start directions are not mirrored, so the two results are independent samples. The tolerance is five
/// standard errors of their sum.
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
        // A pan of 0 would equal its mirror image, so the test would prove nothing.
        assert!(pan.abs() > 10.0 * error, "{name}: {pan} ± {error}");
    }
}

/// Protects the panning pass from a division by 0: every wave of a source at the exact centre of the listener is heard
/// in the middle, in equal parts.
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

/// Protects a known fault that the profile `thesis` keeps. Figure 8 puts a dead wave at (0, 0, 0) with direction 0 and
/// marches it again, so that the wave hits any object that is there. A listener there hears every dead wave, in equal
/// parts. This test fails if the profile is repaired, which must not happen.
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
    // The coordinates of the moved scene are rounded differently, so a few waves may deviate.
    assert!(
        here.counts.listener_hits.abs_diff(heard) <= 4,
        "{here:?}, {apart:?}"
    );
    assert!(here.panning.pan().abs() < 0.5 * apart.panning.pan().abs());
}

/// Protects silence: if no wave arrives, the sums are 0, and the pan is the middle and not NaN.
#[test]
fn nothing_arriving_is_the_middle() {
    let frame = tracer().frame(&builtin("obstacles"), &thesis(1000, 1));
    let frame = frame.unwrap();
    assert_eq!(frame.counts.listener_hits, 0);
    assert_eq!((frame.panning.left, frame.panning.right), (0.0, 0.0));
    assert_eq!(frame.panning.pan(), 0.0);
}
