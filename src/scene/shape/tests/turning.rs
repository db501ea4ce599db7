//! The sense in which fields are turned: right-handed, like all angles of a scene.

use crate::scene::shape::Cuboid;
use crate::scene::{Node, Shape};
use glam::{DVec3, Vec3};

/// A bar along x, thin along the other two axes.
fn bar() -> Shape {
    let size = Vec3::new(4.0, 0.1, 0.1);
    Node::Cuboid(Cuboid { size }).into()
}

/// Protects the documented sense: with a positive rate a twist turns the upper part from z towards
/// x, and a bend the right part from x towards y.
#[test]
fn twist_and_bend_are_right_handed() {
    const RATE: f64 = 0.5;
    let (sin, cos) = RATE.sin_cos();
    let twisted = bar().translate(Vec3::Y).twist(RATE as f32);
    assert!(twisted.value(DVec3::new(cos, 1.0, -sin)) < 0.0);
    assert!(twisted.value(DVec3::new(cos, 1.0, sin)) > 0.0);
    let bent = bar().bend(RATE as f32);
    // At x = 1 the bar is turned by half a radian.
    assert!(bent.value(DVec3::new(1.0, RATE.tan(), 0.0)) < 0.0);
    assert!(bent.value(DVec3::new(1.0, -RATE.tan(), 0.0)) > 0.0);
}
