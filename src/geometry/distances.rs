//! Distances from points to the surfaces of a scene, found nearest-first in the hierarchies.

use super::closed_form::Placed;
use super::exact::ExactScene;
use super::in_front::OpenPlane;
use crate::scene::ROUNDING;
use glam::DVec3;

/// A plane face: the number of its surface, from 1, and a point of the face with the unit normal there.
pub(crate) type MirrorFace = (u32, (DVec3, DVec3));

impl ExactScene {
    /// Signed distance in metres from a world point to the nearest surface, negative inside a solid. The listener is
    /// ignored.
    pub fn surface_distance(&self, point: DVec3) -> f64 {
        self.least_distance(point, |_, surface| surface.distance(point))
    }

    /// Signed distance in metres from a world point in front of a plane face to the nearest surface, as if the plane were
    /// open and the scene were mirrored at it: see [`Placed::distance_in_front`].
    pub(crate) fn distance_in_front(&self, point: DVec3, face: MirrorFace) -> f64 {
        self.least_distance(point, self.in_front(point, face))
    }

    /// The least of the distances from a point that `distance` gives for a surface and its number, from 1. They are at
    /// least [`Placed::distance`].
    fn least_distance(&self, point: DVec3, distance: impl Fn(u32, &Placed) -> f64) -> f64 {
        let mut least = f64::INFINITY;
        self.visit_nearest(point, |number, surface| {
            least = least.min(distance(number, surface));
            least
        });
        least
    }

    /// Calls `visit` with the number, from 1, of each surface that can be nearest to a point. The result of `visit` is
    /// the least distance so far in metres: surfaces whose bounding box is farther away are left out.
    fn visit_nearest(&self, point: DVec3, mut visit: impl FnMut(u32, &Placed) -> f64) {
        let mut least = f64::INFINITY;
        for &index in &self.with_bounds_of_distance {
            least = visit(index + 1, &self.surfaces[index as usize]);
        }
        for hierarchy in &self.hierarchies {
            hierarchy.around(point, least, |index, _| {
                let surface = &self.surfaces[index];
                if surface.has_exact_distance() {
                    least = visit(index as u32 + 1, surface);
                }
                least
            });
        }
    }

    /// Whether a world point is within `error_m` metres of the surface with this number, from 1.
    pub(crate) fn is_on(&self, surface: u32, point: DVec3, error_m: f64) -> bool {
        let index = (surface as usize).wrapping_sub(1);
        let surface = self.surfaces.get(index);
        surface.is_some_and(|surface| surface.distance(point).abs() <= error_m)
    }

    /// The number, from 1, of the surface nearest to a world point; 0 in a scene without surfaces.
    pub(crate) fn nearest(&self, point: DVec3) -> u32 {
        self.nearest_by(point, |_, surface| surface.distance(point))
    }

    /// The number of the nearest surface for [`ExactScene::distance_in_front`].
    pub(crate) fn nearest_in_front(&self, point: DVec3, face: MirrorFace) -> u32 {
        self.nearest_by(point, self.in_front(point, face))
    }

    /// The distances of surfaces from a point in front of a face, by their numbers, if its plane is open.
    pub(super) fn in_front(&self, point: DVec3, face: MirrorFace) -> impl Fn(u32, &Placed) -> f64 {
        let (mirror, (on_face, normal)) = face;
        let plane = OpenPlane {
            point: on_face,
            normal,
            touch: self.placing_error_m(),
        };
        move |number, surface| surface.distance_in_front(point, plane, number == mirror)
    }

    /// Maximum distance in metres between faces that a scene states to lie in one plane: positions and sizes are rounded
    /// to `f32`.
    pub(crate) fn placing_error_m(&self) -> f64 {
        f64::from(ROUNDING) * self.extent_m()
    }

    /// The number of the surface with the least of these distances. They are at least [`Placed::distance`].
    fn nearest_by(&self, point: DVec3, distance: impl Fn(u32, &Placed) -> f64) -> u32 {
        let mut nearest: Option<(f64, u32)> = None;
        self.visit_nearest(point, |number, surface| {
            let found = (distance(number, surface), number);
            // At equal distances, the first surface in the scene is nearest.
            let is_nearer = |(distance, other): (f64, u32)| {
                found
                    .0
                    .total_cmp(&distance)
                    .then(number.cmp(&other))
                    .is_lt()
            };
            if nearest.is_none_or(is_nearer) {
                nearest = Some(found);
            }
            nearest.map_or(f64::INFINITY, |(distance, _)| distance)
        });
        nearest.map_or(0, |(_, number)| number)
    }

    /// The groups of the faces of a mesh, or the walls of rooms, within `reach` metres of a world point; none for other
    /// surfaces. `surface` is the number of the surface, from 1.
    pub(crate) fn groups_near(&self, surface: u32, point: DVec3, reach: f64) -> Vec<usize> {
        let index = (surface as usize).wrapping_sub(1);
        let surface = self.surfaces.get(index);
        surface.map_or(Vec::new(), |surface| surface.groups_near(point, reach))
    }

    /// Whether a world point is more than `depth` metres inside a solid.
    pub(crate) fn is_in_solid(&self, point: DVec3, depth: f64) -> bool {
        let is_in = |index: usize| self.surfaces[index].distance(point) < -depth;
        let mut hierarchies = self.hierarchies.iter();
        hierarchies.any(|hierarchy| hierarchy.any_near(point, 0.0, is_in))
    }

    /// [`ExactScene::surface_distance`] if the bounding box of a surface is within `reach` metres, otherwise at least
    /// `reach`.
    pub(crate) fn distance_within(&self, point: DVec3, reach: f64) -> f64 {
        let mut nearest = reach;
        for hierarchy in &self.hierarchies {
            hierarchy.any_near(point, reach, |index| {
                nearest = nearest.min(self.surfaces[index].distance(point));
                false
            });
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// Protects meshes on a plane of a large scene: their faces lie in the plane within the rounding of the scene's
    /// coordinates, as those of other shapes do. In a small scene the same height is one above the plane.
    #[test]
    fn faces_of_meshes_are_in_a_plane_within_the_rounding_of_the_scene() {
        let distance = |shape: &str, extent_m: f64| {
            let text = format!(
                "Scene(surfaces: [Surface(shape: Plane), Surface(shape: {shape}, position: (0, 0.00002, 0))], \
                 source: Source(position: (0, 1, 0)), listener: Listener(position: ({extent_m}, 1, 0), radius: 0.1))"
            );
            let scene = Scene::from_ron(&text, "test").expect("a scene");
            let exact = ExactScene::new(scene.pair(0, 0).expect("a pair")).expect("a valid scene");
            exact.distance_in_front(DVec3::new(0.0, 0.1, 0.0), (1, (DVec3::ZERO, DVec3::Y)))
        };
        for room in [
            "Rooms(of: [(name: \"hall\", from: (-2, 0, -2), to: (2, 3, 2))])",
            "Translate(of: Room(size: (4, 3, 4)), by: (0, 1.5, 0))",
        ] {
            let (near, far) = (distance(room, 1.5), distance(room, 400.0));
            assert!((near - 0.1).abs() < 1e-3, "{room}: {near}");
            assert!((far - 2.0).abs() < 1e-3, "{room}: {far}");
        }
    }
}
