//! A scene with a user's field whose exact function is known.
//!
//! The exact reference knows other users' fields only from samples. The errors measured with them are mostly the errors
//! of the samples, which are thousands of times larger than the errors of the waves.

use echomarch::scene::shape::{Room, User};
use echomarch::scene::{Listener, Scene, Source, Surface, UserField};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The name of the scene.
pub const GYROID: &str = "gyroid";

const TEXT: &str = include_str!("gyroid.glsl");

/// Full size of the field's box, in metres.
const SIZE: Vec3 = Vec3::new(10.0, 6.0, 10.0);

/// Larger than the maximum gradient of the value, which is √3.
const LIPSCHITZ: f32 = 2.0;

/// The function of the GLSL text in `f64`. The numbers in the text are exact in both precisions.
fn value(p: DVec3) -> f64 {
    let (q, walls) = (1.25 * p, 0.25);
    let [x, y, z] = q.to_array().map(f64::sin_cos);
    ((x.0 * y.1 + y.0 * z.1 + z.0 * x.1).abs() - walls) / 1.25
}

/// A gyroid in a room, as a user's field.
pub fn gyroid() -> Scene {
    let field = UserField::new("gyroid.glsl", TEXT.to_owned(), SIZE, LIPSCHITZ);
    let field = Arc::new(field.with_cpu(value));
    let size = Vec3::new(18.0, 9.0, 16.0);
    let room = Surface::new(Room { size });
    let text = Surface::new(User { field }).at([1.0, -1.0, 1.0]);
    let source = Source::at([-7.0, 1.0, -6.0]);
    let listener = Listener::at([7.5, 1.0, 6.5], 1.4);
    Scene::new(GYROID, vec![room, text], source, listener)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the scene: it is valid, its shape is a user's field without a gradient function, and the stated
    /// Lipschitz constant is an upper bound.
    #[test]
    fn the_gyroid_is_a_text_of_stated_growth() {
        let scene = gyroid();
        scene.check().unwrap();
        let field = scene.user_fields().next().unwrap();
        assert!(field.has_cpu() && !field.states_gradient());
        field.check_text().unwrap();
        let step = 1e-5;
        for at in 0..100_000_u32 {
            let share = |prime: f64| (f64::from(at) * prime).fract() - 0.5;
            let p = DVec3::new(share(0.618_034), share(0.754_878), share(0.569_840));
            let p = p * SIZE.as_dvec3();
            let growth =
                |axis: DVec3| (value(p + step * axis) - value(p - step * axis)) / (2.0 * step);
            let gradient = DVec3::new(growth(DVec3::X), growth(DVec3::Y), growth(DVec3::Z));
            assert!(gradient.length() < f64::from(LIPSCHITZ), "at {p}");
        }
    }
}
