//! The thesis' algorithm on the CPU in `f32`.
//!
//! This module computes the steps of figures 8 and 9 in the same precision as the shaders, with independent code. Tests
//! with it show whether a shader implements the algorithm. They do not show whether the algorithm is correct (it is
//! not: see [`super::ExactScene`]).
//!
//! Two implementations in `f32` can diverge at a close decision: a distance just below the minimum distance in one
//! implementation is just above it in the other. Each wave therefore has a [`margin`](MarchedWave::margin), the
//! smallest distance of any of its decisions from the opposite outcome.
//!
//! For trees of shapes, this module uses the value of the scene's own CPU code, rounded to `f32`.

use crate::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use crate::scene::{Nearest, Node, Scene, Shape, Surface};
use crate::tracer::{
    Algorithm, STATUS_DEAD, STATUS_LISTENER, STATUS_STARTED, Settings, ThesisOptions,
};
use glam::{DVec3, UVec3, Vec2, Vec3};
use std::f64::consts::TAU;

/// The state of a wave after all iterations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarchedWave {
    /// World position in metres.
    pub position: Vec3,
    /// Direction of flight.
    pub direction: Vec3,
    /// −1 if the wave is dead, 0 at the listener, n at surface n.
    pub status: f32,
    /// Number of marches that ended at distance 0.
    pub zero_length_passes: u32,
    /// Number of marches that reached the step limit.
    pub step_limit_reached: u32,
    /// The smallest difference in metres between two numbers whose comparison decided the path: a distance and the
    /// minimum distance, or the distances to two objects at a hit.
    pub margin: f32,
}

/// The initial direction of a wave: the algorithm of `glsl/direction/random.glsl`, on the CPU in `f64`.
pub fn start_direction(wave: u32, seed: u32) -> Vec3 {
    let bits = mix_bits(UVec3::new(wave, seed, 0));
    let unit_interval = |bits: u32| f64::from(bits >> 8) / 16_777_216.0;
    let height = 1.0 - 2.0 * unit_interval(bits.x);
    let angle = TAU * unit_interval(bits.y);
    let ring = (1.0 - height * height).max(0.0).sqrt();
    DVec3::new(ring * angle.cos(), height, ring * angle.sin()).as_vec3()
}

/// Data shared by all waves.
struct March<'a> {
    scene: &'a Scene,
    options: ThesisOptions,
    /// Maximum length of one iteration in metres.
    max_distance: f32,
}

/// Traces waves that leave the scene's source along `directions` (unit vectors). `None` if the settings select another
/// algorithm than the thesis'.
pub fn march(scene: &Scene, settings: &Settings, directions: &[Vec3]) -> Option<Vec<MarchedWave>> {
    let Algorithm::Thesis(options) = settings.algorithm else {
        return None;
    };
    let march = March {
        scene,
        options,
        max_distance: settings.max_distance,
    };
    let follow = |&direction| march.follow(direction, settings.iterations);
    Some(directions.iter().map(follow).collect())
}

impl March<'_> {
    fn follow(&self, direction: Vec3, iterations: u32) -> MarchedWave {
        let mut wave = MarchedWave {
            position: self.scene.sources[0].position,
            direction,
            status: STATUS_STARTED,
            zero_length_passes: 0,
            step_limit_reached: 0,
            margin: f32::INFINITY,
        };
        for _ in 0..iterations {
            if wave.status == STATUS_LISTENER {
                break;
            }
            self.iterate(&mut wave);
        }
        wave
    }

    /// Computes one iteration (figure 8).
    fn iterate(&self, wave: &mut MarchedWave) {
        let start = wave.position + wave.direction * self.options.start_offset;
        let flight = self.fly(start, wave.direction);
        wave.margin = wave.margin.min(flight.margin);
        let Some((t, object)) = flight.hit else {
            wave.step_limit_reached += u32::from(flight.gave_up);
            die(wave);
            return;
        };
        wave.zero_length_passes += u32::from(t == 0.0);
        wave.position += t * wave.direction;
        wave.status = object as f32;
        match difference_normal(self.scene, wave.position, self.options.normal_step) {
            Some(normal) => wave.direction -= normal * (2.0 * normal.dot(wave.direction)),
            None if wave.status == STATUS_LISTENER => (),
            None => die(wave),
        }
    }

    /// Computes one march (figure 9).
    fn fly(&self, start: Vec3, direction: Vec3) -> Flight {
        let mut t = 0.0;
        let mut margin = f32::INFINITY;
        for _ in 0..self.options.step_limit(self.max_distance) {
            if !f32::lt(&t, &self.max_distance) {
                break;
            }
            let point = start + t * direction;
            let Nearest { distance, object } = distance(self.scene, point);
            margin = margin.min((distance - self.options.min_distance).abs());
            if distance < self.options.min_distance {
                return Flight {
                    hit: Some((t, object)),
                    gave_up: false,
                    margin: margin.min(tie_margin(self.scene, point)),
                };
            }
            t += distance;
        }
        Flight {
            hit: None,
            gave_up: t < self.max_distance,
            margin,
        }
    }
}

/// The result of one march.
struct Flight {
    /// The length of the march and the number of the hit object, if any.
    hit: Option<(f32, u32)>,
    gave_up: bool,
    margin: f32,
}

/// The difference between the two smallest distances at a point, which shows how clearly the point belongs to one
/// object.
fn tie_margin(scene: &Scene, point: Vec3) -> f32 {
    let mut distances: Vec<f32> = {
        let surfaces = scene.surfaces.iter();
        surfaces.map(|s| of_surface(s, point)).collect()
    };
    distances.push(scene.listeners[0].distance(point));
    distances.sort_by(f32::total_cmp);
    distances[1] - distances[0]
}

/// Moves a dead wave to the origin, and sets its direction to 0.
fn die(wave: &mut MarchedWave) {
    wave.position = Vec3::ZERO;
    wave.direction = Vec3::ZERO;
    wave.status = STATUS_DEAD;
}

/// The normal by central differences; `None` if all differences are 0.
fn difference_normal(scene: &Scene, point: Vec3, step: f32) -> Option<Vec3> {
    let slope = |axis: Vec3| {
        let ahead = distance(scene, point + axis * step).distance;
        let behind = distance(scene, point - axis * step).distance;
        ahead - behind
    };
    Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).try_normalize()
}

fn mix_bits(v: UVec3) -> UVec3 {
    let [mut x, mut y, mut z] = v
        .to_array()
        .map(|c| c.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mut round = || {
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        [x, y, z] = [x, y, z].map(|c| c ^ (c >> 16));
    };
    round();
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    UVec3::new(x, y, z)
}

/// Signed distance to the nearest surface or to the listener's sphere, in metres (figure 9).
pub(super) fn distance(scene: &Scene, point: Vec3) -> Nearest {
    let mut nearest = Nearest {
        distance: scene.listeners[0].distance(point),
        object: 0,
    };
    for (surface, object) in scene.surfaces.iter().zip(1..) {
        let distance = of_surface(surface, point);
        if distance < nearest.distance {
            nearest = Nearest { distance, object };
        }
    }
    nearest
}

/// Signed distance to one surface, in metres.
pub(super) fn of_surface(surface: &Surface, point: Vec3) -> f32 {
    let offset = point - surface.position;
    let local = match surface.has_rotation() {
        true => surface.rotation.conjugate() * offset,
        false => offset,
    };
    of_shape(&surface.shape, local)
}

fn of_shape(shape: &Shape, p: Vec3) -> f32 {
    match shape.node {
        Node::Plane(_) => p.y,
        Node::Cuboid(Cuboid { size }) => {
            let beyond = p.abs() - size * 0.5;
            beyond.max(Vec3::ZERO).length() + beyond.max_element().min(0.0)
        }
        Node::Room(Room { size }) => (size * 0.5 - p.abs()).min_element(),
        Node::Sphere(Sphere { radius }) => p.length() - radius,
        Node::Cylinder(Cylinder { radius }) => Vec2::new(p.x, p.z).length() - radius,
        _ => shape.distance(p),
    }
}
