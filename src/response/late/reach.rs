//! The reach of the sphere of late arrivals: how far it extends, and the planes that keep it from reaching behind
//! obstacles.
//!
//! The energy is the mean over the part of the sphere that the listener sees. A convex obstacle lies behind the plane
//! through its nearest point: a convex function f is at least its tangent, f(x) ≥ f(c) + ∇f(c)·(x − c), so no point
//! with a positive right side is in the solid f ≤ 0 (S. Boyd and L. Vandenberghe, *Convex Optimization*, 2004, section
//! 3.1.3). The listener sees every point in front of all planes. Other surfaces end the sphere.

use crate::geometry::ExactScene;
use crate::sampling::lattice;
use crate::scene::shape::Shape;
use crate::scene::{Node, Pair, Surface};
use crate::tracer::{Limits, MOST_LIMITS, NO_LIMITS};
use glam::{DVec3, Vec4};

/// Maximum radius of the sphere, in multiples of the distance to a room's wall.
const BEHIND_WALLS: f32 = 2.0;

/// Step in metres of the difference quotients for the direction to an obstacle, and the distance by which a plane is
/// nearer to the listener than the obstacle. An exact distance has a continuous gradient outside the solid, so the
/// quotients are accurate to a share of the step per metre.
const STEP_M: f64 = 1e-3;

/// Number of directions in which distances are measured. In a box their mean is then accurate to some 5 %, and it takes
/// a few milliseconds where surfaces are marched.
const DIRECTIONS: u64 = 32;

/// The mean distance in metres from a listener to the surfaces around it. `None` in the open, where some direction meets
/// no surface, and in scenes with users' fields, whose distances are only known to the GPU.
pub(super) fn mean_distance_m(pair: Pair) -> Option<f64> {
    if pair.scene.user_fields().next().is_some() {
        return None;
    }
    let exact = ExactScene::new(pair).ok()?;
    let centre = pair.listener.position.as_dvec3();
    let distance = |direction| {
        Some(
            exact
                .first_surface(centre, direction, None, f64::INFINITY)?
                .t,
        )
    };
    let distances = lattice(DIRECTIONS).map(distance);
    let sum: Option<f64> = distances.sum();
    Some(sum? / DIRECTIONS as f64)
}

/// The part of a listener's surroundings in which late arrivals may be counted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Radius in metres.
    pub radius_m: f32,
    pub limits: Limits,
}

impl Reach {
    /// The reach of a pair's listener, at most `most_m` metres.
    pub fn of(pair: Pair, most_m: f32) -> Reach {
        let mut radius_m = most_m;
        let mut planes: Vec<Vec4> = Vec::new();
        let centre = pair.listener.position;
        for surface in &pair.scene.surfaces {
            let distance = surface.distance(centre);
            if distance >= radius_m {
                continue;
            }
            match surface.shape.node {
                // Nothing is behind these faces.
                Node::Room(_) | Node::Plane(_) | Node::HalfSpace(_) => {
                    radius_m = radius_m.min(BEHIND_WALLS * distance);
                }
                _ if surface.is_obstacle() => planes.extend(planes_before(surface, centre.into())),
                _ => radius_m = radius_m.min(distance),
            }
        }
        planes.sort_by(|a, b| a.w.total_cmp(&b.w));
        // Behind its plane the listener is in an obstacle.
        if let Some(nearest) = planes.first().filter(|plane| plane.w < 0.0) {
            radius_m = radius_m.min(nearest.w);
        }
        if let Some(next) = planes.get(MOST_LIMITS) {
            radius_m = radius_m.min(next.w);
        }
        let mut limits = NO_LIMITS;
        let near = planes.into_iter().filter(|plane| plane.w < radius_m);
        for (limit, plane) in limits.iter_mut().zip(near) {
            *limit = plane;
        }
        Reach { radius_m, limits }
    }
}

/// The plane before each part of an obstacle, relative to a world point. The distance is negative if the point is in the
/// solid.
fn planes_before(surface: &Surface, point: DVec3) -> impl Iterator<Item = Vec4> {
    let rotation = surface.rotation.as_dquat();
    let local = rotation.conjugate() * (point - surface.position.as_dvec3());
    let plane = move |part: &Shape| {
        let part = outermost(part, local);
        let slope = gradient(part, local);
        let steepness = slope.length();
        let distance = part.value(local) / steepness - STEP_M;
        match steepness > 0.0 {
            true => (rotation * (-slope / steepness))
                .as_vec3()
                .extend(distance as f32),
            // Within the obstacle.
            false => Vec4::new(0.0, 0.0, 0.0, -1.0),
        }
    };
    surface.shape.united().into_iter().map(plane)
}

/// The part of an intersection with the greatest value: the intersection is behind the plane before it. The value of the
/// intersection itself has no gradient where two parts have the same value.
fn outermost(shape: &Shape, point: DVec3) -> &Shape {
    let Node::Intersection(_) = shape.node else {
        return shape;
    };
    let children = shape.children.iter();
    let most = children.max_by(|a, b| a.value(point).total_cmp(&b.value(point)));
    most.map_or(shape, |child| outermost(child, point))
}

/// The gradient of a value by difference quotients.
fn gradient(shape: &Shape, point: DVec3) -> DVec3 {
    let along = |axis: DVec3| {
        let step = STEP_M * axis;
        (shape.value(point + step) - shape.value(point - step)) / (2.0 * STEP_M)
    };
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, Plane, Room, Sphere, Torus};
    use crate::{Listener, Scene, Source};
    use glam::{Quat, Vec3};

    const CENTRE: Vec3 = Vec3::new(1.0, 2.0, 3.0);

    fn reach(surfaces: Vec<Surface>, most_m: f32) -> Reach {
        let (source, listener) = (Source::at(Vec3::Y * 50.0), Listener::at(CENTRE, 0.1));
        let scene = Scene::new("reach", surfaces, source, listener);
        Reach::of(scene.only_pair().unwrap(), most_m)
    }

    fn cube(size: f32, offset: Vec3) -> Surface {
        let cube = Surface::new(Cuboid {
            size: Vec3::splat(size),
        });
        cube.at(CENTRE + offset)
    }

    /// Protects sound behind obstacles from being counted: no point in front of the planes is in an obstacle or hidden
    /// by one, and the planes are as far away as the obstacles.
    #[test]
    fn nothing_in_front_of_the_planes_is_hidden() {
        let turned = cube(1.0, Vec3::new(0.0, -0.9, 0.4)).turned(Quat::from_rotation_x(0.5));
        let ball = Surface::new(Sphere { radius: 0.4 }).at(CENTRE + Vec3::X);
        let both = Shape::union([
            Cuboid {
                size: Vec3::splat(0.2),
            }
            .into(),
            Shape::from(Sphere { radius: 0.3 }),
        ]);
        let both = Surface::new(both).at(CENTRE - Vec3::X);
        let surfaces = vec![turned, ball, both];
        let found = reach(surfaces.clone(), 1.5);
        assert_eq!(found.radius_m, 1.5);
        let hides = |place: Vec3| {
            let on_way = (0..=100).map(|step| CENTRE + step as f32 / 100.0 * place);
            let is_in = |point: Vec3| surfaces.iter().any(|s| s.distance(point) < 0.0);
            on_way.into_iter().any(is_in)
        };
        let is_in_front = |place: Vec3| {
            found
                .limits
                .iter()
                .all(|plane| plane.truncate().dot(place) < plane.w)
        };
        let mut counts = [0; 2];
        for index in 1..4000 {
            let place = 1.5 * (2.0 * crate::scene::shape::halton(index).as_vec3() - Vec3::ONE);
            counts[0] += usize::from(is_in_front(place));
            counts[1] += usize::from(!hides(place));
            assert!(!(is_in_front(place) && hides(place)), "{place}");
        }
        // Four obstacles within reach leave a part of the visible places.
        assert!(4 * counts[0] > counts[1], "{counts:?}");
        for surface in &surfaces {
            let distance = surface.distance(CENTRE);
            let is_near = |plane: &Vec4| (plane.w - distance).abs() < 2e-3;
            assert!(found.limits.iter().any(is_near), "{distance}: {found:?}");
        }
    }

    /// Protects the radius: walls of rooms, surfaces that are not convex, and a fifth obstacle end the sphere.
    #[test]
    fn other_surfaces_end_the_sphere() {
        let room = Surface::new(Room {
            size: Vec3::splat(3.0),
        })
        .at(CENTRE);
        assert_eq!(reach(vec![room.clone()], 5.0).radius_m, 3.0);
        // A floor in any notation: 1 m below the listener, with a normal that is turned.
        let turn = Quat::from_rotation_z(0.4);
        let floor = Surface::new(Plane).at(CENTRE - turn * Vec3::Y).turned(turn);
        let found = reach(vec![floor], 5.0);
        assert!(
            (found.radius_m - 2.0).abs() < 1e-5 && found.limits == NO_LIMITS,
            "{found:?}"
        );
        let ring = Surface::new(Torus {
            ring: 0.8,
            tube: 0.2,
        })
        .at(CENTRE);
        let found = reach(vec![room, ring], 5.0);
        assert!((found.radius_m - 0.6).abs() < 1e-6 && found.limits == NO_LIMITS);
        let cubes = [0.5, 0.6, 0.7, 0.8, 0.9].map(|at| cube(0.4, Vec3::X * at));
        assert_eq!(reach(cubes[..4].to_vec(), 5.0).radius_m, 5.0);
        let found = reach(cubes.to_vec(), 5.0);
        assert!((found.radius_m - 0.7).abs() < 2e-3, "{found:?}");
        // A listener in an obstacle hears nothing.
        assert!(reach(vec![cube(0.4, Vec3::ZERO)], 5.0).radius_m < 0.0);
    }
}
