//! The volume of the listener's sphere that lies in the open.

use crate::scene::shape::halton;
use crate::scene::{Scene, Surface};
use glam::DVec3;
use std::f64::consts::PI;

/// Points by which the volume is found where a surface reaches into the sphere.
///
/// A sequence of low discrepancy in three dimensions is off by some N^(−2/3) of the cube for what
/// a smooth surface bounds (L. Kuipers and H. Niederreiter, *Uniform Distribution of Sequences*,
/// 1974, ch. 2.1: N^(−1/3) is the bound, and half a face's worth of cells fall either way by
/// chance): 1.5e-3 here, 0.007 dB. A test holds caps against their closed form.
const POINTS: usize = 16_384;

/// Cubic metres of the listener's sphere that are in no solid.
pub fn open_volume(scene: &Scene) -> f64 {
    let (centre, radius) = (scene.listener.position, scene.listener.radius);
    let sphere = 4.0 / 3.0 * PI * f64::from(radius).powi(3);
    // The distance is never more than the way to a surface: what is farther off than the radius
    // does not reach into the sphere.
    let reaches = |surface: &&Surface| surface.distance(centre) < radius;
    let near: Vec<&Surface> = scene.surfaces.iter().filter(reaches).collect();
    if near.is_empty() {
        return sphere;
    }
    let is_open = |unit: &DVec3| {
        let place = (centre.as_dvec3() + f64::from(radius) * *unit).as_vec3();
        near.iter().all(|surface| surface.distance(place) > 0.0)
    };
    let open = points_in_ball().filter(is_open).count();
    sphere * open as f64 / POINTS as f64
}

/// Points of the unit ball, spread evenly: radii by the cube root, directions as Archimedes has
/// them.
fn points_in_ball() -> impl Iterator<Item = DVec3> {
    (1..=POINTS).map(|index| {
        let share = halton(index);
        let height = 1.0 - 2.0 * share.x;
        let (sin, cos) = (2.0 * PI * share.y).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        DVec3::new(ring * cos, height, ring * sin) * share.z.cbrt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Plane, Sphere};
    use crate::{Listener, Node, Source};
    use glam::{Quat, Vec3};

    fn volume(surfaces: Vec<Surface>, radius: f32) -> f64 {
        let listener = Listener::at(Vec3::new(1.0, 2.0, 3.0), radius);
        let source = Source::at(Vec3::Y * 50.0);
        open_volume(&Scene::new("volume", surfaces, source, listener))
    }

    fn floor(below: f32, turn: Quat) -> Surface {
        let normal = turn * Vec3::Y;
        let mut plane = Surface::new(Node::Plane(Plane));
        plane.rotation = turn;
        plane.at(Vec3::new(1.0, 2.0, 3.0) - normal * below)
    }

    /// Protects the exact volume in the open, and what a plane cuts off: a cap of height h has
    /// π h² (r − h/3). Within the 1.5e-3 that [`POINTS`] argues.
    #[test]
    fn planes_cut_off_caps() {
        let sphere = |r: f64| 4.0 / 3.0 * PI * r.powi(3);
        assert_eq!(volume(vec![floor(0.5, Quat::IDENTITY)], 0.5), sphere(0.5));
        let radius = 0.75;
        for (index, share) in [-0.9f32, -0.4, 0.0, 0.3, 0.8].into_iter().enumerate() {
            let turn = Quat::from_rotation_x(0.7 * index as f32) * Quat::from_rotation_z(0.4);
            let below = share * radius as f32;
            let height = radius - f64::from(below);
            let cap = PI * height.powi(2) * (radius - height / 3.0);
            let found = volume(vec![floor(below, turn)], radius as f32);
            let off = (found - (sphere(radius) - cap)) / sphere(radius);
            assert!(off.abs() < 1.5e-3, "{share}: {off}");
        }
    }

    /// Protects a listener with something in its middle, and one within a solid.
    #[test]
    fn solids_within_count() {
        let ball = Surface::new(Node::Sphere(Sphere { radius: 0.5 })).at(Vec3::new(1.0, 2.0, 3.0));
        let share = volume(vec![ball.clone()], 1.0) / volume(vec![], 1.0);
        assert!((share - 0.875).abs() < 1.5e-3, "{share}");
        assert_eq!(volume(vec![ball], 0.25), 0.0);
    }
}
