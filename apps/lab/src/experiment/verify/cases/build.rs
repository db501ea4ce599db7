//! Functions shared by the cases.

use echomarch::scene::shape::{Cuboid, Room};
use echomarch::scene::{Listener, Node, Scene, Source, Surface};
use glam::{DVec3, Vec3};

/// A scene with the given surfaces.
pub fn scene(name: &str, surfaces: Vec<Surface>, source: Vec3, listener: Listener) -> Scene {
    Scene::new(name, surfaces, Source::at(source), listener)
}

/// The thesis' room: 30 x 20 x 30 m about the origin.
pub fn hall() -> Surface {
    room(30.0, 20.0, 30.0)
}

pub fn room(x: f32, y: f32, z: f32) -> Surface {
    let size = Vec3::new(x, y, z);
    Surface::new(Node::Room(Room { size }))
}

pub fn block(x: f32, y: f32, z: f32) -> Surface {
    let size = Vec3::new(x, y, z);
    Surface::new(Node::Cuboid(Cuboid { size }))
}

/// A listener that no wave reaches, inside the solid around the hall.
pub fn listener_outside() -> Listener {
    Listener::at(Vec3::new(16.5, 0.0, 0.0), 0.5)
}

/// The built-in scene of this name.
pub fn builtin(name: &str) -> Scene {
    match Scene::builtin(name) {
        Ok(scene) => scene,
        // A test loads every built-in scene, so this call cannot fail.
        Err(error) => unreachable!("{error}"),
    }
}

/// The directions from `from` to each of the points `at`.
pub fn aims(from: Vec3, at: &[Vec3]) -> Vec<Vec3> {
    let aim = |at: &Vec3| (at.as_dvec3() - from.as_dvec3()).normalize().as_vec3();
    at.iter().map(aim).collect()
}

/// An even lattice of directions over the sphere. The heights have equal steps, and the azimuths increase by the golden
/// angle.
pub fn lattice(count: u32) -> Vec<Vec3> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let direction = |index: u32| {
        let height = 1.0 - 2.0 * (f64::from(index) + 0.5) / f64::from(count);
        let ring = (1.0 - height * height).sqrt();
        let (sin, cos) = (GOLDEN_ANGLE * f64::from(index)).sin_cos();
        DVec3::new(ring * cos, height, ring * sin).as_vec3()
    };
    (0..count).map(direction).collect()
}
