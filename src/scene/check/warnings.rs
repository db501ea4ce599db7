//! Warnings about scenes that can be traced but are unusual.

use crate::scene::mesh::LARGEST_USUAL_M;
use crate::scene::shape::Asset;
use crate::scene::{Node, ROUNDING, Scene, Surface, Transmission, Warning};
use glam::{DVec3, Vec3};

/// Shortest edge in metres of the box around the air of a room above which the unit is probably not the metre. Hardly any
/// hall is as high; a room of 2.5 m in centimetres has 250.
const LONGEST_USUAL_SHORT_EDGE_M: f64 = 200.0;

/// Density in kg/m³ below which the unit is probably not kg/m³. Nearly all foams are heavier; concrete has 2.4 in g/cm³,
/// and steel 7.8.
const LEAST_USUAL_DENSITY: f64 = 8.0;

impl Scene {
    /// Returns warnings about the scene in its current state. Scenes with warnings can still be traced.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = self.warnings_of_places();
        warnings.extend(self.rooms_that_fill_each_other());
        warnings.extend(self.rooms_without_a_way());
        warnings.extend(self.without_material());
        warnings.extend(self.one_sided_fields());
        warnings.extend(self.odd_meshes());
        warnings.extend(self.large_rooms());
        warnings.extend(self.odd_units());
        warnings
    }

    /// Returns the warnings about the places of sources and listeners, which take little time.
    #[doc(hidden)]
    pub fn warnings_of_places(&self) -> Vec<Warning> {
        let mut warnings = self.odd_sources();
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

    /// Warns about rooms that are so large that their unit is probably not the metre. Meshes have their own warning.
    fn large_rooms(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let size = surface.room_size();
            let is_large = |size: &DVec3| {
                size.max_element() > LARGEST_USUAL_M
                    || size.min_element() > LONGEST_USUAL_SHORT_EDGE_M
            };
            warnings.extend(size.filter(is_large).map(|size| Warning::LargeRoom {
                surface: surface.label(index),
                length: size.max_element(),
            }));
        }
        warnings
    }

    /// Warns about a humidity that is probably a share, and about densities that are probably in g/cm³.
    fn odd_units(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let humidity = self.air.map(|air| air.humidity);
        let share = humidity.filter(|humidity| *humidity > 0.0 && *humidity <= 1.0);
        warnings.extend(share.map(|share| Warning::DryAir { humidity: share }));
        for (material, stated) in &self.materials {
            match stated.transmission {
                Some(Transmission::Mass { density, .. }) if density < LEAST_USUAL_DENSITY => {
                    warnings.push(Warning::LightSolid {
                        material: material.clone(),
                        density,
                    });
                }
                _ => (),
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

    fn solid_at(&self, point: Vec3) -> Option<(String, f32)> {
        let nearest = self.surface_distance(point);
        if nearest.distance >= 0.0 || nearest.object == 0 {
            return None;
        }
        let index = nearest.object as usize - 1;
        let surface = &self.surfaces[index];
        let largest = point.abs().max(surface.position.abs()).max_element();
        if nearest.distance >= -ROUNDING * largest {
            // Rounding error: a wave from this point starts on the surface.
            return None;
        }
        let label = surface.label(index);
        let solid = match surface.shape.node {
            Node::Room(_) => format!("the solid around {label}"),
            _ => label,
        };
        Some((solid, -nearest.distance))
    }
}

impl Surface {
    /// The edges in metres of the box around the air of a room; `None` for another shape.
    fn room_size(&self) -> Option<DVec3> {
        let shape = &self.shape;
        match (&shape.node, &shape.children[..]) {
            (Node::Room(room), _) => Some(room.size.as_dvec3()),
            (Node::Rooms(rooms), _) => Some(rooms.mesh().report().size_m),
            (Node::Complement(_), [air]) => {
                let bounds = air.properties().bounds;
                bounds.is_finite().then(|| 2.0 * bounds.half_size())
            }
            _ => None,
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
