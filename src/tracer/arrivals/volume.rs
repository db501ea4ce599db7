//! The open volume of a detector's sphere.

use crate::scene::shape::halton;
use crate::scene::{Scene, Surface};
use glam::{DVec3, DVec4, Vec3, Vec4};
use std::f64::consts::PI;

/// Maximum number of planes that limit a detector.
pub(crate) const MOST_LIMITS: usize = 4;

/// Half-spaces n · (x − c) < w about the centre c of a detector, with the unit normal n and the distance w in metres.
pub(crate) type Limits = [Vec4; MOST_LIMITS];

/// No limits: the planes contain every point.
pub(crate) const NO_LIMITS: Limits = [Vec4::W; MOST_LIMITS];

/// Number of points that estimate the volume if a surface reaches into the sphere.
///
/// A sequence of low discrepancy in three dimensions estimates the volume of a body with a smooth surface. The error is
/// about N^(−2/3) of the cube: 1.5e-3 here, or 0.007 dB. The proven bound is N^(−1/3) (L. Kuipers and H. Niederreiter,
/// *Uniform Distribution of Sequences*, 1974, ch. 2.1), but the errors of the cells at the surface partly cancel each
/// other by chance. A test compares spherical caps with their closed form.
const POINTS: usize = 16_384;

/// Cells along each axis of the cube around the sphere. With cells, only a few dozen surfaces are tested for a point
/// even if a thousand surfaces reach into the sphere.
const CELLS: usize = 4;

/// The rounding error of a distance in `f32`, as a share of the largest coordinate: about ten units in the last place.
const SPARE: f32 = 1e-6;

/// Volume in m³ of the part of a sphere that is outside solids and in front of the planes that limit it.
pub fn open_volume(scene: &Scene, (centre, limits): (Vec3, &Limits), radius: f32) -> f64 {
    let sphere = 4.0 / 3.0 * PI * f64::from(radius).powi(3);
    // The value is at most the distance to a surface, so a surface whose value exceeds the radius does not reach into
    // the sphere.
    let reaches = |surface: &&Surface| surface.distance(centre) < radius;
    let near: Vec<&Surface> = scene.surfaces.iter().filter(reaches).collect();
    let limits = limits.map(|plane| plane.as_dvec4());
    let is_limited =
        (limits.iter()).any(|plane| plane.truncate() != DVec3::ZERO && plane.w < radius.into());
    if near.is_empty() && !is_limited {
        return sphere;
    }
    let near = near_cells(&near, centre, radius);
    let is_open = |unit: &DVec3| {
        let offset = f64::from(radius) * *unit;
        let is_in_front = |plane: &DVec4| plane.truncate().dot(offset) < plane.w;
        let place = (centre.as_dvec3() + offset).as_vec3();
        let mut near = near[cell_of(*unit)].iter();
        limits.iter().all(is_in_front) && near.all(|surface| surface.distance(place) > 0.0)
    };
    let open = points_in_ball().filter(is_open).count();
    sphere * open as f64 / POINTS as f64
}

/// The surfaces that may reach into each cell of the cube around the sphere. `near` are the surfaces that reach into
/// the sphere.
fn near_cells<'a>(near: &[&'a Surface], centre: Vec3, radius: f32) -> Vec<Vec<&'a Surface>> {
    let half = radius / CELLS as f32;
    let half_diagonal = 3f32.sqrt() * half;
    let of_cell = |cell: usize| {
        let at = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS];
        let from_middle = at.map(|place| (2 * place + 1) as f32 - CELLS as f32);
        let middle = centre + Vec3::from_array(from_middle) * half;
        let reaches = |surface: &&&Surface| {
            let largest = middle.abs().max(surface.position.abs()).max_element();
            surface.distance(middle) <= half_diagonal + SPARE * largest
        };
        near.iter().filter(reaches).copied().collect()
    };
    (0..CELLS.pow(3)).map(of_cell).collect()
}

/// The cell of a point in the unit ball.
fn cell_of(unit: DVec3) -> usize {
    let place = |at: f64| (((at + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1);
    place(unit.x) + CELLS * (place(unit.y) + CELLS * place(unit.z))
}

/// Points that are evenly distributed in the unit ball: the cube root gives their radii, and Archimedes' theorem their
/// directions.
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
    use glam::Quat;

    fn volume(surfaces: Vec<Surface>, radius: f32) -> f64 {
        let centre = Vec3::new(1.0, 2.0, 3.0);
        let source = Source::at(Vec3::Y * 50.0);
        let scene = Scene::new("volume", surfaces, source, Listener::at(centre, radius));
        open_volume(&scene, (centre, &NO_LIMITS), radius)
    }

    fn floor(below: f32, turn: Quat) -> Surface {
        let normal = turn * Vec3::Y;
        let mut plane = Surface::new(Node::Plane(Plane));
        plane.rotation = turn;
        plane.at(Vec3::new(1.0, 2.0, 3.0) - normal * below)
    }

    /// Protects the exact volume in the open, and the volume that a plane cuts off: a cap of height h has the volume π
    /// h² (r − h/3). The tolerance is the 1.5e-3 derived at [`POINTS`].
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

    /// Protects the volume of a listener that contains a solid, and of a listener inside a solid.
    #[test]
    fn solids_within_count() {
        let ball = Surface::new(Node::Sphere(Sphere { radius: 0.5 })).at(Vec3::new(1.0, 2.0, 3.0));
        let share = volume(vec![ball.clone()], 1.0) / volume(vec![], 1.0);
        assert!((share - 0.875).abs() < 1.5e-3, "{share}");
        assert_eq!(volume(vec![ball], 0.25), 0.0);
    }

    /// Protects the volume among many surfaces from errors of the cells: the share of open points is the same as if
    /// every surface is tested for every point.
    #[test]
    fn cells_leave_no_surface_out() {
        let centre = Vec3::new(1.0, 2.0, 3.0);
        let ball = |index: usize| {
            let at = centre + (1.8 * halton(index + 1) - 0.9).as_vec3();
            let ball = Surface::new(Node::Sphere(Sphere { radius: 0.12 })).at(at);
            ball.turned(Quat::from_rotation_z(index as f32))
        };
        let mut surfaces: Vec<Surface> = (0..60).map(ball).collect();
        surfaces.push(floor(0.3, Quat::from_rotation_x(0.4)));
        let is_open = |unit: &DVec3| {
            let place = (centre.as_dvec3() + *unit).as_vec3();
            surfaces.iter().all(|surface| surface.distance(place) > 0.0)
        };
        let open = points_in_ball().filter(is_open).count();
        let sphere = volume(vec![], 1.0);
        assert_eq!(
            volume(surfaces.clone(), 1.0),
            sphere * open as f64 / POINTS as f64
        );
        assert!(4 * open < 3 * POINTS && 4 * open > POINTS, "{open}");
    }
}
