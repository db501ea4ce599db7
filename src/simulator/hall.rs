//! The scene that a worker traces: the surfaces of a snapshot in their current poses.

use super::world::{Medium, PlacedSource, PlacedSurface, Snapshot, nothing};
use super::{Pose, SourceId, SurfaceId};
use crate::scene::{Listener, Scene, Source, Surface};
use glam::Vec3;
use std::sync::Arc;

/// Bits of a number of geometry that count motions.
pub(super) const MOTION_BITS: u32 = 32;

/// A scene with the ids of its objects.
#[derive(Debug)]
pub(super) struct Hall {
    pub scene: Scene,
    /// The traced surfaces in the order of the scene. Without surfaces, the scene has one ball far away.
    surfaces: Vec<(SurfaceId, PlacedSurface)>,
    /// The sources in the order of the scene.
    pub sources: Vec<(SourceId, PlacedSource)>,
    medium: Arc<Medium>,
    pub listener: Pose,
    /// Number of the commit.
    pub commit: u64,
    /// Counts the changes of surfaces and materials, and in its last [`MOTION_BITS`] their motions.
    pub geometry: u64,
}

impl Hall {
    /// The hall of a snapshot.
    pub fn of(snapshot: &Snapshot) -> Hall {
        let mut scene = Scene::new(
            "world",
            Vec::new(),
            Source::at(Vec3::ZERO),
            Listener::at(snapshot.listener.position, snapshot.radius_m),
        );
        scene.sources.clear();
        scene.materials.clone_from(&snapshot.medium.materials);
        scene.scattering = snapshot.medium.scattering;
        scene.air = snapshot.medium.air;
        scene.surfaces = snapshot
            .surfaces
            .iter()
            .map(|(_, one)| placed(one))
            .collect();
        if scene.surfaces.is_empty() {
            scene.surfaces.push(nothing());
        }
        let mut hall = Hall {
            scene,
            surfaces: snapshot.surfaces.clone(),
            sources: Vec::new(),
            medium: Arc::clone(&snapshot.medium),
            listener: snapshot.listener,
            commit: 0,
            geometry: 0,
        };
        hall.follow_sources(snapshot);
        hall
    }

    /// Whether the snapshot has the same surfaces and materials, maybe in other poses.
    pub fn has_surfaces_of(&self, snapshot: &Snapshot) -> bool {
        let is_same = |((id, one), (other_id, other)): (
            &(SurfaceId, PlacedSurface),
            &(SurfaceId, PlacedSurface),
        )| {
            id == other_id && Arc::ptr_eq(&one.surface, &other.surface) && one.turns == other.turns
        };
        self.surfaces.len() == snapshot.surfaces.len()
            && Arc::ptr_eq(&self.medium, &snapshot.medium)
            && self.surfaces.iter().zip(&snapshot.surfaces).all(is_same)
    }

    /// Moves everything to the poses of the snapshot. Surfaces that it lacks stay; new ones do not appear.
    pub fn follow(&mut self, snapshot: &Snapshot) {
        let mut moved = false;
        let mut next = snapshot.surfaces.iter();
        for (index, (id, one)) in self.surfaces.iter_mut().enumerate() {
            // Both lists are in the order of the places of the ids.
            let is_it = |(other, _): &&(SurfaceId, PlacedSurface)| other == id;
            let Some((_, other)) = next.clone().find(is_it) else {
                continue;
            };
            next.find(is_it);
            let mut pose = other.pose;
            // The first turn needs programs that read a rotation. They are compiled aside.
            if other.turns && !one.turns {
                pose.rotation = one.pose.rotation;
            }
            if one.pose != pose {
                one.pose = pose;
                place(&mut self.scene.surfaces[index], one);
                moved = true;
            }
        }
        self.geometry += u64::from(moved);
        self.follow_sources(snapshot);
    }

    fn follow_sources(&mut self, snapshot: &Snapshot) {
        self.commit = snapshot.number;
        self.listener = snapshot.listener;
        self.scene.listeners[0].position = snapshot.listener.position;
        self.scene.listeners[0].radius = snapshot.radius_m;
        let is_same = |((id, one), (other_id, other)): (
            &(SourceId, PlacedSource),
            &(SourceId, PlacedSource),
        )| id == other_id && Arc::ptr_eq(&one.source, &other.source);
        let are_same = self.sources.len() == snapshot.sources.len()
            && self.sources.iter().zip(&snapshot.sources).all(is_same);
        if !are_same {
            let sources = snapshot.sources.iter();
            self.scene.sources = sources.map(|(_, one)| (*one.source).clone()).collect();
        }
        for (source, (_, placed)) in self.scene.sources.iter_mut().zip(&snapshot.sources) {
            placed.pose.place(source);
            source.position = apart(source.position, &snapshot.listener);
            source.level_db = placed.level_db;
        }
        self.sources.clone_from(&snapshot.sources);
    }

    /// A number for the surface with this number in the scene, from 1, which stays the same while the surface exists.
    pub fn surface_bits(&self, number: u32) -> u64 {
        let index = (number as usize).checked_sub(1);
        let surface = index.and_then(|index| self.surfaces.get(index));
        surface.map_or(u64::from(number), |(id, _)| id.to_bits() + 1)
    }
}

/// Least distance in metres from the listener at which a source is heard: that of the surface of a head. The sound of a
/// nearer source would grow without limit, and a source at the listener has no direction.
const NEAREST_M: f32 = 0.1;

/// The position of a source, at least [`NEAREST_M`] from the listener. A source at the listener is heard ahead.
fn apart(source: Vec3, listener: &Pose) -> Vec3 {
    let way = source - listener.position;
    if way.length() >= NEAREST_M {
        return source;
    }
    let ahead = listener.rotation * Vec3::NEG_Z;
    let direction = way.try_normalize().or(ahead.try_normalize());
    listener.position + NEAREST_M * direction.unwrap_or(Vec3::NEG_Z)
}

/// The surface in its pose.
fn placed(one: &PlacedSurface) -> Surface {
    let mut surface = (*one.surface).clone();
    place(&mut surface, one);
    surface
}

fn place(surface: &mut Surface, one: &PlacedSurface) {
    surface.position = one.pose.position;
    surface.rotation = one.pose.rotation;
    surface.dynamic_rotation |= one.turns;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Cuboid;
    use crate::simulator::world::World;
    use glam::Quat;

    /// Protects the sound from stalls: the first turn of a surface needs other programs, so the hall that is traced keeps
    /// the surface's rotation, and follows its position, until a hall with such programs takes its place.
    #[test]
    fn a_first_turn_does_not_change_the_programs_in_use() {
        let mut world = World::new();
        let size = Vec3::ONE;
        let id = world.add_surface(Surface::new(Cuboid { size })).unwrap();
        let mut hall = Hall::of(&world.snapshot());
        let placed = world.surface(id).unwrap();
        placed.pose = Pose::at([1.0, 0.0, 0.0]).turned(Quat::from_rotation_y(0.5));
        placed.turns = true;
        let snapshot = world.snapshot();
        assert!(!hall.has_surfaces_of(&snapshot));
        hall.follow(&snapshot);
        let surface = &hall.scene.surfaces[0];
        assert_eq!(surface.position, Vec3::X);
        assert_eq!(surface.rotation, Quat::IDENTITY);
        assert!(!surface.dynamic_rotation);
        let next = Hall::of(&snapshot);
        assert!(next.has_surfaces_of(&snapshot));
        assert!(next.scene.surfaces[0].dynamic_rotation);
    }
}
