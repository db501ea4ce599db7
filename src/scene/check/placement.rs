//! Warnings about surfaces that are probably misplaced, and about a room that is solid.

use crate::scene::shape::{Bounds3, Room};
use crate::scene::{Node, Scene, Shape, Surface, Warning};
use glam::{DVec3, Vec3};

/// Number of times that a box is halved along all axes in the search for a part of it outside a solid.
const MOST_HALVINGS: u32 = 4;

/// Heights in metres at which furniture hovers above the floor, probably by mistake. The rounding of positions gives
/// smaller gaps, and the feet of furniture larger ones.
const HOVERING_M: std::ops::RangeInclusive<f64> = 0.001..=0.03;

/// Least width and depth in metres of furniture that hovers. Door leaves are thinner, and often end above the floor.
const LEAST_HOVERING_M: f64 = 0.2;

impl Scene {
    /// Warns if all sources and listeners are in the solid of one surface: below a ground, or in a solid that is probably
    /// meant to be a room.
    pub(super) fn all_in_one_solid(&self) -> Option<Warning> {
        let sources = self.sources.iter().map(|source| source.position);
        let listeners = self.listeners.iter().map(|listener| listener.position);
        let mut around = sources
            .chain(listeners)
            .map(|place| self.surface_around(place));
        let (first, _) = around.next()??;
        let is_same = |of: Option<(usize, f32)>| of.is_some_and(|(index, _)| index == first);
        let surface = &self.surfaces[first];
        let are_all_in = !surface.takes_walls() && around.all(is_same);
        are_all_in.then(|| Warning::AllInSolid {
            surface: surface.label(first),
            is_half_space: is_half_space(&surface.shape),
        })
    }

    /// Warns about surfaces that lie wholly in the unbounded solid of another one, such as that around a room.
    pub(super) fn buried(&self) -> Vec<Warning> {
        let all = || self.surfaces.iter().enumerate();
        let is_still = |(_, surface): &(usize, &Surface)| surface.drivers.is_empty();
        let unbounded = |(_, surface): &(usize, &Surface)| !surface.bounds().is_finite();
        let solids: Vec<_> = all().filter(is_still).filter(unbounded).collect();
        let mut warnings = Vec::new();
        for (index, surface) in all().filter(is_still) {
            let bounds = surface.bounds();
            if !bounds.is_finite() {
                continue;
            }
            let mut solids = solids.iter();
            let around = solids.find(|(_, solid)| is_in_solid(solid, bounds, MOST_HALVINGS));
            warnings.extend(around.map(|(solid, _)| Warning::Buried {
                surface: surface.label(index),
                solid: self.solid_label(*solid),
            }));
        }
        warnings
    }

    /// Warns about furniture that hovers a little above the floor of a room.
    pub(super) fn hovering(&self) -> Vec<Warning> {
        let floors = self.surfaces.iter().enumerate();
        let floors: Vec<(usize, f64)> = floors
            .filter_map(|(index, room)| Some((index, room.floor_m()?)))
            .collect();
        let mut warnings = Vec::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let bounds = surface.bounds();
            // The box in the axes of the scene is wider than a thin shape that is rotated.
            let own = surface.shape.properties().bounds;
            let size = own.max - own.min;
            let is_furniture = bounds.is_finite() && size.x.min(size.z) >= LEAST_HOVERING_M;
            if !is_furniture || !surface.drivers.is_empty() {
                continue;
            }
            let hovers = |(_, floor): &&(usize, f64)| {
                let gap = bounds.min.y - floor;
                HOVERING_M.contains(&gap) && self.is_open_below(bounds, 0.5 * gap)
            };
            warnings.extend(
                floors
                    .iter()
                    .find(hovers)
                    .map(|(room, floor)| Warning::Hovering {
                        surface: surface.label(index),
                        room: self.surfaces[*room].label(*room),
                        gap: bounds.min.y - floor,
                    }),
            );
        }
        warnings
    }

    /// Whether the middle and the corners of the face below a box, moved down by `depth` metres, are in the air.
    fn is_open_below(&self, bounds: Bounds3, depth: f64) -> bool {
        let (min, max) = (bounds.min, bounds.max);
        let y = min.y - depth;
        let middle = 0.5 * (min + max);
        let xz = [
            (min.x, min.z),
            (min.x, max.z),
            (max.x, min.z),
            (max.x, max.z),
        ];
        let mut places = xz.into_iter().chain([(middle.x, middle.z)]);
        places.all(|(x, z)| {
            self.surface_distance(Vec3::new(x as f32, y as f32, z as f32))
                .distance
                > 0.0
        })
    }
}

impl Surface {
    /// The height of the floor of a room that stands still and upright.
    fn floor_m(&self) -> Option<f64> {
        match self.shape.node {
            Node::Room(Room { size }) if self.drivers.is_empty() && !self.has_rotation() => {
                Some(f64::from(self.position.y - 0.5 * size.y))
            }
            _ => None,
        }
    }
}

/// Whether a shape is a plane or a half space, also if it is moved, rotated or scaled.
fn is_half_space(shape: &Shape) -> bool {
    match shape.node {
        Node::Plane(_) | Node::HalfSpace(_) => true,
        Node::Translate(_) | Node::Rotate(_) | Node::Scale(_) => is_half_space(&shape.children[0]),
        _ => false,
    }
}

/// Whether a box certainly lies in the solid of a surface. The distance is a lower bound, so that a ball of this radius
/// lies in the solid. A box that does not fit the ball is divided.
fn is_in_solid(solid: &Surface, bounds: Bounds3, halvings: u32) -> bool {
    let (middle, half) = (0.5 * (bounds.min + bounds.max), bounds.half_size());
    let depth = -f64::from(solid.distance(middle.as_vec3()));
    if depth >= half.length() {
        return true;
    }
    let corner = |number: u32| {
        let side = |axis: u32| if number >> axis & 1 == 0 { -0.5 } else { 0.5 };
        middle + half * DVec3::new(side(0), side(1), side(2))
    };
    let is_part_in_solid = |number| {
        let part = Bounds3::centred(0.5 * half).moved(corner(number));
        is_in_solid(solid, part, halvings - 1)
    };
    depth > 0.0 && halvings > 0 && (0..8).all(is_part_in_solid)
}
