//! Warnings about scenes that can be traced but are unusual.

use crate::scene::shape::Asset;
use crate::scene::{ROUNDING, Scene, Warning};
use glam::Vec3;

impl Scene {
    /// Returns warnings about the scene in its current state. Scenes with warnings can still be traced.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = self.warnings_of_places();
        warnings.extend(self.rooms_that_fill_each_other());
        warnings.extend(self.rooms_without_a_way());
        warnings.extend(self.without_material());
        warnings.extend(self.one_sided_fields());
        warnings.extend(self.odd_meshes());
        warnings.extend(self.buried());
        warnings.extend(self.hovering());
        warnings.extend(self.odd_units());
        warnings
    }

    /// Returns the warnings about the places of sources and listeners, which take little time.
    #[doc(hidden)]
    pub fn warnings_of_places(&self) -> Vec<Warning> {
        let mut warnings = self.odd_sources();
        warnings.extend(self.all_in_one_solid());
        for (index, listener) in self.listeners.iter().enumerate() {
            if let Some((surface, depth)) = self.solid_at(listener.position) {
                let listener = self.listener_label(index);
                warnings.push(Warning::ListenerInsideSurface {
                    listener,
                    surface,
                    depth,
                });
            }
        }
        warnings
    }

    /// Warns about defects of meshes.
    fn odd_meshes(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let Some(mesh) = surface.shape.mesh() else {
                continue;
            };
            let surface = surface.label(index);
            let of = |why| Warning::OddMesh {
                surface: surface.clone(),
                why,
            };
            warnings.extend(mesh.report().warnings().into_iter().map(of));
        }
        warnings
    }

    /// Warns about scenes with several rooms.
    fn rooms_that_fill_each_other(&self) -> Option<Warning> {
        let all = self.surfaces.iter().enumerate();
        let rooms = all.filter(|(_, surface)| surface.has_walls());
        let rooms: Vec<String> = rooms.map(|(index, room)| room.label(index)).collect();
        (rooms.len() > 1).then_some(Warning::RoomsFillEachOther { rooms })
    }

    /// Warns about boxes of air that no other box joins to the first one.
    fn rooms_without_a_way(&self) -> Vec<Warning> {
        let all = self.surfaces.iter().enumerate();
        let cut_off = all.filter_map(|(index, surface)| {
            let rooms = surface.rooms()?.cut_off();
            let surface = surface.label(index);
            (!rooms.is_empty()).then_some(Warning::RoomsApart { surface, rooms })
        });
        cut_off.collect()
    }

    /// Warns about surfaces without a material if other surfaces have one.
    fn without_material(&self) -> Option<Warning> {
        if !self.has_materials() {
            return None;
        }
        let mut surfaces = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let lacks = |wall: Option<usize>| self.material(index, wall).is_none();
            let has_faces =
                |part: &usize| surface.rooms().is_none_or(|rooms| rooms.has_faces(*part));
            let parts: Vec<usize> = (0..surface.part_count()).filter(has_faces).collect();
            let walls: Vec<usize> = parts
                .iter()
                .copied()
                .filter(|wall| lacks(Some(*wall)))
                .collect();
            let is_whole =
                parts.is_empty() && lacks(None) || !parts.is_empty() && walls.len() == parts.len();
            match is_whole {
                true => surfaces.push(surface.label(index)),
                false => {
                    let label = |wall: &usize| surface.short_label(index, Some(*wall));
                    surfaces.extend(walls.iter().map(label));
                }
            }
        }
        (!surfaces.is_empty()).then_some(Warning::NoMaterial { surfaces })
    }

    /// Warns about sources inside solids or listeners.
    fn odd_sources(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (index, from) in self.sources.iter().enumerate() {
            let source = self.source_label(index);
            if let Some((surface, depth)) = self.solid_at(from.position) {
                warnings.push(Warning::SourceInsideSurface {
                    source,
                    surface,
                    depth,
                });
                continue;
            }
            for (index, at) in self.listeners.iter().enumerate() {
                let distance = from.position.distance(at.position);
                if distance < at.radius {
                    warnings.push(Warning::SourceInsideListener {
                        source: source.clone(),
                        listener: self.listener_label(index),
                        distance,
                        radius: at.radius,
                    });
                }
            }
        }
        warnings
    }

    /// Warns about users' fields and sampled fields that are all solid or all air.
    fn one_sided_fields(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            for node in surface.shape.nodes() {
                let (file, solid) = match node.node.asset() {
                    Some(Asset::User(user)) => {
                        let samples = user.samples();
                        let solid = samples.and_then(|samples| one_side(&samples.values));
                        (user.file.display().to_string(), solid)
                    }
                    Some(Asset::Samples(field)) => {
                        (field.name().to_owned(), one_side(field.values()))
                    }
                    _ => continue,
                };
                warnings.extend(solid.map(|solid| Warning::OneSided {
                    surface: surface.label(index),
                    file,
                    solid,
                }));
            }
        }
        warnings
    }

    /// The solid in which a point lies, and its depth in metres. The space outside a room is a solid.
    pub(crate) fn solid_at(&self, point: Vec3) -> Option<(String, f32)> {
        let (index, depth) = self.surface_around(point)?;
        Some((self.solid_label(index), depth))
    }

    /// The index of the surface in whose solid a point lies, and its depth in metres.
    pub(super) fn surface_around(&self, point: Vec3) -> Option<(usize, f32)> {
        let nearest = self.surface_distance(point);
        if nearest.distance >= 0.0 || nearest.object == 0 {
            return None;
        }
        let index = nearest.object as usize - 1;
        let largest = point.abs().max(self.surfaces[index].position.abs());
        // Rounding error: a wave from this point starts on the surface.
        let is_on_surface = nearest.distance >= -ROUNDING * largest.max_element();
        (!is_on_surface).then_some((index, -nearest.distance))
    }

    /// The name of a surface's solid in messages.
    pub(super) fn solid_label(&self, index: usize) -> String {
        let label = self.surfaces[index].label(index);
        match self.surfaces[index].takes_walls() {
            true => format!("the solid around {label}"),
            false => label,
        }
    }
}

/// Whether all values are in the solid; `None` if some are in the air and some in the solid. Zeros count as either, and
/// zeros alone as solid.
fn one_side(values: &[f32]) -> Option<bool> {
    let is_solid = values.iter().all(|value| *value <= 0.0);
    let is_air = values.iter().all(|value| *value >= 0.0);
    (is_solid || is_air).then_some(is_solid)
}
