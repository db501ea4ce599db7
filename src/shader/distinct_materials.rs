//! The distinct materials of the surfaces that waves hit.

use crate::bands::{BAND_COUNT, Bands};
use crate::scene::{Material, Node, Scene};
use std::collections::HashSet;

/// A material, and whether the solids of its surfaces transmit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distinct {
    pub material: Material,
    pub transmits: bool,
}

/// A material as the key of a map: absorption and scattering, bit for bit, and whether its solids transmit.
pub(super) type MaterialBits = ([[u64; BAND_COUNT]; 2], bool);

impl Distinct {
    pub fn bits(&self) -> MaterialBits {
        let Material {
            absorption,
            scattering,
            ..
        } = &self.material;
        // The addition turns −0 into 0.
        let bits = |bands: &Bands| bands.map(|of| (of + 0.0).to_bits());
        ([absorption, scattering].map(bits), self.transmits)
    }
}

/// The distinct materials except perfect mirrors, in the order in which they first occur.
pub(super) fn distinct(all: impl Iterator<Item = Distinct>) -> Vec<Distinct> {
    let mut known = HashSet::new();
    let met = all.filter(|one| !one.material.is_mirror());
    met.filter(|one| known.insert(one.bits())).collect()
}

/// Whether a line that enters the solid of a surface (counted from 0) can leave it again. The solids of rooms, planes
/// and half-spaces have no far side, and those around meshes and `Rooms` only between their parts. Other unbounded solids
/// are treated like bounded ones.
pub(super) fn has_far_side(scene: &Scene, index: usize) -> bool {
    match &scene.surfaces[index].shape.node {
        Node::Room(_) | Node::Plane(_) | Node::HalfSpace(_) => false,
        Node::Rooms(of) => of.mesh().has_far_side(),
        Node::Mesh(of) => of.mesh.has_far_side(),
        _ => true,
    }
}

/// All surfaces by their index, and instead of each room its walls.
pub(super) fn faces(scene: &Scene) -> impl Iterator<Item = (usize, Option<usize>)> {
    let of_surface = |index| walls(scene, index).map(move |wall| (index, wall));
    (0..scene.surfaces.len()).flat_map(of_surface)
}

/// The materials of all surfaces and walls, with repetitions. For a room these are the materials of its walls.
pub(crate) fn materials_met(scene: &Scene) -> impl Iterator<Item = Material> {
    faces(scene).map(|(index, wall)| scene.material(index, wall).unwrap_or(Material::MIRROR))
}

/// The walls of a room, the groups of a mesh, or `None` for any other surface as a whole.
pub(super) fn walls(scene: &Scene, index: usize) -> impl Iterator<Item = Option<usize>> {
    let count = scene.surfaces[index].part_count();
    let whole = std::iter::once(None).filter(move |_| count == 0);
    (0..count).map(Some).chain(whole)
}
