//! The air inside a box.

use super::part::{arguments, part, surface_kind};
use super::{Bounds3, Exactness, Part, Properties, Shape};
use crate::scene::material::WALL_NAMES;
use glam::{DVec3, Vec3};

part! {
    /// The inside of a box, with air inside and solid outside.
    Room {
        /// Full width, height and depth of the air in metres.
        size: Vec3 as Side,
    }
}

impl Room {
    /// The names of the walls in scene files, in the order of [`Surface::walls`](crate::Surface::walls): the walls at
    /// −x, +x, −y, +y, −z and +z of the room's own axes. A listener without a rotation faces the wall `front`.
    pub const WALL_NAMES: [&str; Room::WALL_COUNT] = WALL_NAMES;

    /// Number of walls of a room.
    pub const WALL_COUNT: usize = WALL_NAMES.len();
}

impl Part for Room {
    surface_kind!(FLAT);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            in_air: Exactness::Exact,
            convex: false,
            ..Properties::bound(Bounds3::EVERYWHERE)
        }
    }

    fn own_length(&self) -> f64 {
        f64::from(0.5 * self.size.max_element())
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        (0.5 * self.size.as_dvec3() - p.abs()).min_element()
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        (0.5 * self.size.as_dvec3()).to_array().to_vec()
    }

    arguments!(3);
}
