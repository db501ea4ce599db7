//! Warnings about scenes that are odd but can be traced.

use crate::scene::{Node, ROUNDING, Scene, WALL_COUNT, WALL_NAMES};
use glam::Vec3;
use std::fmt;

/// Maximum number of surfaces that one message lists.
const MOST_LISTED: usize = 6;

/// The first labels of a list, and the number of further ones.
fn listed(labels: &[String]) -> String {
    let (listed, more) = labels.split_at(labels.len().min(MOST_LISTED));
    match more.len() {
        0 => listed.join(", "),
        count => format!("{} and {count} more", listed.join(", ")),
    }
}

/// An oddity of a scene that can still be traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The source is in a solid: it cannot be heard.
    SourceInsideSurface {
        /// The source, as messages name it: `the source`, `source 2 (flute)`.
        source: String,
        /// The surface, or the solid around a room.
        surface: String,
        /// Depth in metres.
        depth: f32,
    },
    /// The source is within the listener's sphere: each wave of a frame ends where it starts.
    SourceInsideListener {
        /// The source, as messages name it.
        source: String,
        /// The listener, as messages name it.
        listener: String,
        /// Distance of the source from the listener's centre, in metres.
        distance: f32,
        /// Radius of the listener, in metres.
        radius: f32,
    },
    /// The centre of the listener is in a solid.
    ListenerInsideSurface {
        /// The listener, as messages name it.
        listener: String,
        /// The surface, or the solid around a room.
        surface: String,
        /// Depth in metres.
        depth: f32,
    },
    /// Several rooms: each is solid outside, and fills the others except for the space inside all of them.
    RoomsFillEachOther {
        /// Their labels: `1`, `surface 2 (Room)`.
        rooms: Vec<String>,
    },
    /// Surfaces and walls without a material, in a scene where others have one: they reflect all
    /// sound, which makes decays longer.
    NoMaterial {
        /// Labels of the surfaces and walls: `1/floor`, `surface 2 (Sphere)`.
        surfaces: Vec<String>,
    },
    /// A user's field whose samples in its box are all solid or all air.
    OneSided {
        /// The surface.
        surface: String,
        /// The field's file.
        file: String,
        /// Whether it is solid at every sample; otherwise it is air at every sample.
        solid: bool,
    },
}

/// Metres rounded to millimetres.
fn to_millimetres(metres: f32) -> f64 {
    (1e3 * f64::from(metres)).round() / 1e3
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::SourceInsideSurface {
                source,
                surface,
                depth,
            } => {
                write!(
                    f,
                    "{source} is {} m inside {surface}: nothing of it is heard",
                    to_millimetres(*depth)
                )
            }
            Warning::SourceInsideListener {
                source,
                listener,
                distance,
                radius,
            } => write!(
                f,
                "{source} is {distance} m from {listener}'s centre, inside its sphere of {radius} m: a frame's waves end where they start, so it has no balance of left and right"
            ),
            Warning::ListenerInsideSurface {
                listener,
                surface,
                depth,
            } => {
                write!(
                    f,
                    "{listener}'s centre is {} m inside {surface}: few waves reach it, and no exact path",
                    to_millimetres(*depth)
                )
            }
            Warning::RoomsFillEachOther { rooms } => write!(
                f,
                "{} fill each other: all outside of a Room is solid; write rooms that are joined as one surface, Complement(of: Union(of: [Box(…), Box(…)]))",
                listed(rooms)
            ),
            Warning::NoMaterial { surfaces } => {
                let verb = match surfaces.len() {
                    1 => "has no material and reflects",
                    _ => "have no material and reflect",
                };
                write!(
                    f,
                    "{} {verb} all sound, so that decays are too long: give each surface a material",
                    listed(surfaces)
                )
            }
            Warning::OneSided {
                surface,
                file,
                solid,
            } => {
                let (all, sign) = if *solid {
                    ("solid", "negative")
                } else {
                    ("air", "positive")
                };
                write!(
                    f,
                    "{surface}: {file} is all {all}: its value is {sign} at every sample in its box"
                )
            }
        }
    }
}

impl Scene {
    /// Returns warnings about the scene in its current state; it can still be traced.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = self.odd_sources();
        for (index, listener) in self.listeners().enumerate() {
            if let Some((surface, depth)) = self.solid_at(listener.position) {
                let listener = self.listener_label(index);
                warnings.push(Warning::ListenerInsideSurface {
                    listener,
                    surface,
                    depth,
                });
            }
        }
        warnings.extend(self.rooms_that_fill_each_other());
        warnings.extend(self.without_material());
        warnings.extend(self.one_sided_fields());
        warnings
    }

    /// Warns of several rooms.
    fn rooms_that_fill_each_other(&self) -> Option<Warning> {
        let all = self.surfaces.iter().enumerate();
        let rooms = all.filter(|(_, surface)| surface.has_walls());
        let rooms: Vec<String> = rooms.map(|(index, room)| room.label(index)).collect();
        (rooms.len() > 1).then_some(Warning::RoomsFillEachOther { rooms })
    }

    /// Warns of surfaces without a material where others have one.
    fn without_material(&self) -> Option<Warning> {
        if !self.has_materials() {
            return None;
        }
        let mut surfaces = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let lacks = |wall: Option<usize>| self.material(index, wall).is_none();
            let walls: Vec<usize> = match surface.has_walls() {
                true => (0..WALL_COUNT).filter(|wall| lacks(Some(*wall))).collect(),
                false => Vec::new(),
            };
            let is_whole = !surface.has_walls() && lacks(None) || walls.len() == WALL_COUNT;
            match is_whole {
                true => surfaces.push(surface.label(index)),
                false => surfaces.extend(
                    walls
                        .iter()
                        .map(|wall| format!("{}/{}", index + 1, WALL_NAMES[*wall])),
                ),
            }
        }
        (!surfaces.is_empty()).then_some(Warning::NoMaterial { surfaces })
    }

    /// Warns of sources in solids and in listeners.
    fn odd_sources(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (index, from) in self.sources().enumerate() {
            let source = self.source_label(index);
            if let Some((surface, depth)) = self.solid_at(from.position) {
                warnings.push(Warning::SourceInsideSurface {
                    source,
                    surface,
                    depth,
                });
                continue;
            }
            for (index, at) in self.listeners().enumerate() {
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

    /// Warns of users' fields that are all solid or all air.
    fn one_sided_fields(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let nodes = surface.shape.nodes();
            for user in nodes.iter().filter_map(|node| node.node.user()) {
                let Some(samples) = user.samples() else {
                    continue;
                };
                let solid = samples.values.iter().all(|value| *value < 0.0);
                if solid || samples.values.iter().all(|value| *value > 0.0) {
                    warnings.push(Warning::OneSided {
                        surface: surface.label(index),
                        file: user.file.display().to_string(),
                        solid,
                    });
                }
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
            // Waves start there as on the surface itself.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Surface;
    use crate::scene::shape::Sphere;

    /// Protects against rooms without air: the warning names both rooms and what to write instead.
    #[test]
    fn rooms_that_fill_each_other_are_told() {
        let mut scene = super::super::tests::room();
        scene
            .surfaces
            .push(scene.surfaces[0].clone().named("annexe"));
        let warnings = scene.warnings();
        let [warning] = &warnings[..] else {
            panic!("{warnings:?}");
        };
        let said = warning.to_string();
        assert!(said.starts_with("surface 1 (Room), surface 2 (annexe) fill each other"));
        assert!(said.contains("Complement(of: Union(of: [Box(…), Box(…)]))"));
    }

    /// Protects decays from surfaces that reflect everything unnoticed: each is named, walls too; a
    /// scene without any material gets no such warning.
    #[test]
    fn what_has_no_material_is_told() {
        let mut scene = super::super::tests::room();
        assert_eq!(scene.warnings(), vec![]);
        let floored = scene.surfaces[0].clone().with_wall_material(2, "carpet");
        scene.surfaces[0] = floored.expect("a floor");
        let said = scene.warnings()[0].to_string();
        let expected = "1/left, 1/right, 1/ceiling, 1/front, 1/back have no material";
        assert!(said.starts_with(expected), "{said}");
        scene.surfaces[0] = scene.surfaces[0].clone().with_material("plaster");
        assert_eq!(scene.warnings(), vec![]);
        scene
            .surfaces
            .push(Surface::new(Sphere { radius: 0.1 }).at(Vec3::splat(4.0)));
        let said = scene.warnings()[0].to_string();
        assert!(
            said.starts_with("surface 2 (Sphere) has no material"),
            "{said}"
        );
    }

    /// Protects the warnings: they name the surface and do not reject the scene.
    #[test]
    fn odd_places_are_warned_of() {
        let mut scene = super::super::tests::room();
        assert_eq!(scene.warnings(), vec![]);
        scene.source.position.x = 6.0;
        assert!(matches!(&scene.warnings()[..],
            [Warning::SourceInsideSurface { surface, depth, .. }] if surface == "the solid around surface 1 (Room)" && *depth == 1.0));
        // Inside both solids no wave arrives: only the solid is reported.
        scene.listener.position.x = 5.5;
        assert_eq!(scene.warnings().len(), 2);
        scene.listener.position.x = 0.0;
        scene.source.position.x = 0.5;
        assert!(matches!(
            scene.warnings()[..],
            [Warning::SourceInsideListener { .. }]
        ));
        assert!(scene.validate().is_ok());
    }
}
