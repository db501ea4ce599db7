//! The numbers behind the text: where things are, as the shader is told.
//!
//! The thesis' profile gets world coordinates as they are. The others get them relative
//! to an *anchor* (the listener), so that a scene far from the world's origin loses no
//! bits, and with box faces that are covered by another solid *sealed*: pushed into that
//! solid, so that rounding at the seam cannot open a gap between the two.

use super::super::seal::sealed;
use crate::scene::{Scene, Shape, Surface};
use glam::{Quat, Vec3, Vec4};

/// How world coordinates become a shader's.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// World position of the shader's origin in metres.
    pub anchor: Vec3,
    /// Whether covered faces are sealed.
    pub seals: bool,
}

impl Placement {
    /// World coordinates as they are.
    pub fn world() -> Placement {
        Placement {
            anchor: Vec3::ZERO,
            seals: false,
        }
    }

    /// Relative to the scene's listener, with covered faces sealed.
    pub fn anchored(scene: &Scene) -> Placement {
        Placement {
            anchor: scene.listener.position,
            seals: true,
        }
    }

    /// A world point in the shader's coordinates.
    pub fn place(&self, point: Vec3) -> Vec3 {
        (point.as_dvec3() - self.anchor.as_dvec3()).as_vec3()
    }

    /// The surfaces in the shader's coordinates.
    pub fn surfaces(&self, scene: &Scene) -> Vec<Surface> {
        let place = |surface: &Surface| surface.clone().at(self.place(surface.position));
        let surfaces: Vec<Surface> = scene.surfaces.iter().map(place).collect();
        if self.seals {
            return sealed(&surfaces, slack(&surfaces));
        }
        surfaces
    }

    /// What rounding may do to a position among these surfaces, in metres: `uSlack`.
    pub fn slack(&self, scene: &Scene) -> f32 {
        slack(&self.surfaces(scene))
            .max(UNITS_OF_ROUNDING * self.place(scene.source.position).abs().max_element())
    }
}

/// Eight units in the last place, as a share of the largest coordinate: sums of three
/// squares, a root and a product lose about half of that.
const UNITS_OF_ROUNDING: f32 = 8.0 * f32::EPSILON;

fn slack(surfaces: &[Surface]) -> f32 {
    let reach = |surface: &Surface| {
        let size = match surface.shape {
            Shape::Plane => Vec3::ZERO,
            Shape::Box { size } | Shape::Room { size } => 0.5 * size,
            Shape::Sphere { radius } | Shape::Cylinder { radius } => Vec3::splat(radius),
        };
        (surface.position.abs() + size).max_element()
    };
    UNITS_OF_ROUNDING * surfaces.iter().map(reach).fold(0.0, f32::max)
}

/// The values of `uSurfaces`: for each surface its position (and radius), then its
/// half size if it has one, then the inverse of its rotation if it has one.
pub fn uniform_values(scene: &Scene, placement: &Placement) -> Vec<Vec4> {
    let surfaces = placement.surfaces(scene);
    surfaces.iter().flat_map(surface_values).collect()
}

pub(super) fn surface_values(surface: &Surface) -> Vec<Vec4> {
    let place = |w: f32| surface.position.extend(w);
    let half = |size: Vec3| (size * 0.5).extend(0.0);
    let mut values = match surface.shape {
        Shape::Plane => vec![place(0.0)],
        Shape::Box { size } | Shape::Room { size } => vec![place(0.0), half(size)],
        Shape::Sphere { radius } | Shape::Cylinder { radius } => vec![place(radius)],
    };
    if surface.has_rotation() {
        values.push(inverse(surface.rotation));
    }
    values
}

fn inverse(rotation: Quat) -> Vec4 {
    Vec4::from(rotation.conjugate())
}
