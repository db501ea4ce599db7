//! The region of the world that a slice shows, and the mapping from the world to the picture.

use super::PictureError;
use crate::scene::shape::{AirBox, Cuboid, Cylinder, Room, Rooms, Sphere};
use crate::scene::{Listener, Node, Path, Scene, Surface};
use glam::{BVec3, DMat3, Vec2, Vec3};
use std::f32::consts::TAU;

/// Margin around the contents, as a share of the longer side.
const MARGIN: f32 = 0.05;

/// Minimum ratio of the shorter side to the longer side.
const SLIMMEST: f32 = 0.4;

/// Range of the listener's sight for the plan of an infinite field, in radii of the listener's sphere. The radius is
/// the only length that gives such a scene a scale.
const SIGHT: f32 = 60.0;
/// Number of viewing directions of the listener.
const SIGHTS: u32 = 48;
/// Maximum number of steps along one viewing direction.
const SIGHT_STEPS: u32 = 200;
/// Distance from a surface at which the march ends, as a share of [`SIGHT`]: a fraction of a pixel.
const NEAR_ENOUGH: f32 = 1e-4;

/// A region of the plan: world x and z in metres, as x and y of the vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The upper left of the picture: the lowest x and z.
    pub min: Vec2,
    /// The lower right of the picture: the highest x and z.
    pub max: Vec2,
}

impl Bounds {
    /// The part that contains all bounded surfaces in a cut at `height` (world y, metres), the sources, the listeners
    /// and their paths, with a margin. For an infinite field, such as rock around a cave, it also contains the walls
    /// that the listeners see around them. A square metre about the origin if the scene has none of these.
    pub fn of(scene: &Scene, height: f32) -> Bounds {
        Bounds::with_listeners(scene, &scene.listeners, height)
    }

    /// Like [`of`](Self::of), for listeners that may differ from the scene's listeners.
    pub(super) fn with_listeners(scene: &Scene, listeners: &[Listener], height: f32) -> Bounds {
        let mut bounds = Bounds::NOTHING;
        let radii = listeners.iter().map(|listener| listener.radius);
        let room_for_a_mark = 0.5 * radii.fold(0.0, f32::max);
        for source in &scene.sources {
            bounds.add_moving(source.position, &source.path, room_for_a_mark);
        }
        for listener in listeners {
            bounds.add_moving(listener.position, &listener.path, listener.radius);
        }
        for surface in &scene.surfaces {
            if let Some(extent) = extent(surface, height) {
                bounds.add(extent);
            }
        }
        if scene.surfaces.iter().any(is_endless_field) {
            let walls = listeners
                .iter()
                .flat_map(|of| walls_about(scene, of, height));
            for wall in walls {
                bounds.add(Bounds::around(wall, 0.0));
            }
        }
        if bounds == Bounds::NOTHING {
            bounds = Bounds::around(Vec3::ZERO, 0.5);
        }
        bounds.with_margin()
    }

    /// An empty region: adding a part to it gives this part.
    const NOTHING: Bounds = Bounds {
        min: Vec2::INFINITY,
        max: Vec2::NEG_INFINITY,
    };

    fn around(point: Vec3, radius: f32) -> Bounds {
        let centre = flat(point);
        Bounds {
            min: centre - radius,
            max: centre + radius,
        }
    }

    /// Adds an object and its path, with a margin of `room` metres.
    fn add_moving(&mut self, position: Vec3, path: &Path, room: f32) {
        let keys = path.keys().iter().map(|key| key.position);
        for point in keys.chain([position]) {
            self.add(Bounds::around(point, room));
        }
    }

    fn add(&mut self, other: Bounds) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    fn with_margin(self) -> Bounds {
        let size = self.max - self.min;
        let longer = size.max_element().max(1e-3);
        let half = (0.5 * size).max(Vec2::splat(0.5 * SLIMMEST * longer)) + MARGIN * longer;
        let centre = 0.5 * (self.min + self.max);
        Bounds {
            min: centre - half,
            max: centre + half,
        }
    }

    fn has_area(self) -> bool {
        let size = self.max - self.min;
        self.min.is_finite() && self.max.is_finite() && size.is_finite() && size.min_element() > 0.0
    }
}

/// World x and z of a point.
pub(super) fn flat(point: Vec3) -> Vec2 {
    Vec2::new(point.x, point.z)
}

/// The extent of a surface in a cut at `height`. `None` if the cut misses the surface or the extent is infinite.
fn extent(surface: &Surface, height: f32) -> Option<Bounds> {
    match surface.shape.node {
        Node::Plane(_) => None,
        Node::Rooms(ref rooms) => rooms_extent(surface, rooms),
        Node::Cuboid(Cuboid { size }) | Node::Room(Room { size }) => {
            let corners = corners(surface, -0.5 * size, 0.5 * size);
            let heights = corners.map(|corner| corner.y);
            let is_room = matches!(surface.shape.node, Node::Room(_));
            let misses = heights.iter().all(|&y| y < height) || heights.iter().all(|&y| y > height);
            if misses && !is_room {
                return None;
            }
            Some(about(corners))
        }
        Node::Sphere(Sphere { radius }) => {
            let off = height - surface.position.y;
            let cut = radius * radius - off * off;
            (cut > 0.0).then(|| Bounds::around(surface.position, cut.sqrt()))
        }
        Node::Cylinder(Cylinder { radius }) => {
            let axis = surface.rotation * Vec3::Y;
            // The cut intersects a lying cylinder along its infinite axis.
            if axis.y.abs() < 0.3 {
                return Some(Bounds::around(surface.position, radius));
            }
            let centre = surface.position + axis * ((height - surface.position.y) / axis.y);
            Some(Bounds::around(centre, radius / axis.y.abs()))
        }
        _ => field_extent(surface, height),
    }
}

/// The extent of all boxes of `Rooms`, at any height. `None` without boxes.
fn rooms_extent(surface: &Surface, rooms: &Rooms) -> Option<Bounds> {
    let of_box = |of: &AirBox| corners(surface, of.from, of.to);
    let corners: Vec<Vec3> = rooms.boxes().iter().flat_map(of_box).collect();
    (!corners.is_empty()).then(|| about(corners))
}

/// The part that contains these points.
fn about(points: impl IntoIterator<Item = Vec3>) -> Bounds {
    let mut bounds = Bounds::NOTHING;
    for point in points {
        bounds.add(Bounds::around(point, 0.0));
    }
    bounds
}

/// The bounded extent of a field along x and z, if the cut intersects its bounds.
fn field_extent(surface: &Surface, height: f32) -> Option<Bounds> {
    let rotation = DMat3::from_quat(surface.rotation.as_dquat());
    let bounds = surface.shape.properties().bounds.turned(rotation);
    let world = bounds.moved(surface.position.as_dvec3());
    let meets = world.min.y <= f64::from(height) && f64::from(height) <= world.max.y;
    let ends = [world.min.x, world.max.x, world.min.z, world.max.z];
    let is_finite = ends.iter().all(|end| end.is_finite());
    (meets && is_finite && !bounds.is_empty()).then(|| Bounds {
        min: Vec2::new(world.min.x as f32, world.min.z as f32),
        max: Vec2::new(world.max.x as f32, world.max.z as f32),
    })
}

/// Whether a surface is a field whose solid has no bounds.
fn is_endless_field(surface: &Surface) -> bool {
    let Some(field) = surface.shape.field() else {
        return false;
    };
    let bounds = field.properties().bounds;
    !(bounds.min.is_finite() && bounds.max.is_finite())
}

/// The points where a listener's sight meets surfaces, all around at `height`.
fn walls_about(scene: &Scene, listener: &Listener, height: f32) -> Vec<Vec3> {
    let eye = listener.position.with_y(height);
    let far = SIGHT * listener.radius;
    let sight = |index: u32| {
        let (sin, cos) = (index as f32 / SIGHTS as f32 * TAU).sin_cos();
        let ray = Vec3::new(cos, 0.0, sin);
        let mut gone = 0.0;
        for _ in 0..SIGHT_STEPS {
            let clear = scene.surface_distance(eye + gone * ray).distance;
            if clear < NEAR_ENOUGH * far {
                return Some(eye + gone * ray);
            }
            gone += clear;
            if gone > far {
                return None;
            }
        }
        None
    };
    (0..SIGHTS).filter_map(sight).collect()
}

/// The corners of a box, which is given by two opposite corners in the surface's axes.
fn corners(surface: &Surface, from: Vec3, to: Vec3) -> [Vec3; 8] {
    std::array::from_fn(|index| {
        let is_upper = BVec3::new(index & 1 != 0, index & 2 != 0, index & 4 != 0);
        surface.position + surface.rotation * Vec3::select(is_upper, to, from)
    })
}

/// The mapping from the world to the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// World x and z of the picture's upper left.
    pub corner: Vec2,
    /// Metres per pixel.
    pub metres: f32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

impl Plan {
    /// The plan of `bounds`, `width` pixels wide; the height follows from the bounds.
    pub fn new(bounds: Bounds, width: u32) -> Result<Plan, PictureError> {
        if !bounds.has_area() {
            let what = format!("{} to {}", bounds.min, bounds.max);
            return Err(PictureError::Bounds { what });
        }
        let size = bounds.max - bounds.min;
        let height = (width as f32 * size.y / size.x).round().max(1.0) as u32;
        Ok(Plan {
            corner: bounds.min,
            metres: size.x / width as f32,
            width,
            height,
        })
    }

    /// The position of a world point, in pixels from the upper left.
    pub fn pixel(&self, point: Vec3) -> Vec2 {
        (flat(point) - self.corner) / self.metres
    }

    /// Converts a length to pixels.
    pub fn pixels(&self, metres: f32) -> f32 {
        metres / self.metres
    }

    /// The unit of line widths in pixels: one pixel in a picture 800 pixels wide, scaled to this picture's width.
    pub fn stroke(&self) -> f32 {
        (self.width as f32 / 800.0).max(0.4)
    }

    /// The size of a letter's dot in whole pixels.
    pub fn dot(&self) -> f32 {
        (1.6 * self.stroke()).round().max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Source;
    use glam::Quat;
    use std::f32::consts::FRAC_PI_4;

    fn scene(surface: Surface) -> Scene {
        Scene::new(
            "one",
            vec![surface],
            Source::at(Vec3::ZERO),
            Listener::at(Vec3::X, 0.5),
        )
    }

    /// Protects rotated rooms from being cut off.
    #[test]
    fn a_turned_room_fits() {
        let size = Vec3::new(10.0, 4.0, 10.0);
        let room = Surface::new(Node::Room(Room { size })).turned(Quat::from_rotation_y(FRAC_PI_4));
        let bounds = Bounds::of(&scene(room), 0.0);
        assert!(
            bounds.max.x > 50f32.sqrt() && bounds.max.x < 9.0,
            "{bounds:?}"
        );
        assert!((bounds.min.x + bounds.max.x).abs() < 1e-4, "{bounds:?}");
    }

    /// Protects the rooms of `Rooms` that the listener does not see from being cut off.
    #[test]
    fn all_boxes_of_rooms_fit() {
        let air = |from: [f32; 3], to: [f32; 3]| AirBox {
            name: String::new(),
            from: from.into(),
            to: to.into(),
        };
        let hall = air([-4.0, -1.5, -3.0], [4.0, 3.0, 3.0]);
        let corridor = air([4.0, -1.5, -5.0], [6.0, 1.0, 5.0]);
        let rooms = Rooms::new([hall, corridor]).unwrap();
        let surface = Surface::new(rooms).at(Vec3::new(1.0, 0.0, 2.0));
        let bounds = Bounds::of(&scene(surface.clone()), 0.0);
        assert!(bounds.min.cmplt(Vec2::new(-3.0, -3.0)).all(), "{bounds:?}");
        assert!(bounds.max.cmpgt(Vec2::new(7.0, 7.0)).all(), "{bounds:?}");
        assert!(bounds.max.cmplt(Vec2::splat(9.0)).all(), "{bounds:?}");
        // A box below a listener who flies above it counts too.
        assert_eq!(Bounds::of(&scene(surface), 2.0), bounds);
    }

    /// Protects the scale of the plan from a floor slab that the cut does not intersect.
    #[test]
    fn what_the_cut_misses_does_not_count() {
        let size = Vec3::new(1000.0, 1.0, 1000.0);
        let slab = Surface::new(Node::Cuboid(Cuboid { size })).at(Vec3::Y * -3.0);
        assert!(Bounds::of(&scene(slab), 0.0).max.x < 5.0);
    }

    /// Protects rooms that are hollows in infinite rock: the plan shows the walls in the listener's horizontal sight.
    #[test]
    fn the_walls_of_a_hollow_are_shown() {
        for name in ["cave", "whispering-gallery", "morphing-room"] {
            let scene = Scene::builtin(name).unwrap();
            let eye = scene.listeners[0].position;
            let bounds = Bounds::of(&scene, eye.y);
            for ahead in [Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z] {
                let at = |step: i32| eye + 0.02 * step as f32 * ahead;
                let is_wall = |point: &Vec3| scene.surface_distance(*point).distance < 0.0;
                let Some(wall) = (0..2000).map(at).find(is_wall) else {
                    continue;
                };
                let wall = flat(wall);
                assert!(
                    wall.cmpge(bounds.min).all() && wall.cmple(bounds.max).all(),
                    "{name}: {wall}"
                );
            }
        }
    }

    /// Protects the renderer from invalid bounds.
    #[test]
    fn bounds_without_an_area_are_refused() {
        for max in [Vec2::ZERO, Vec2::new(1.0, -1.0), Vec2::splat(f32::NAN)] {
            let min = Vec2::ZERO;
            assert!(Plan::new(Bounds { min, max }, 100).is_err());
        }
    }
}
