//! The reference for the waves of the shaders: whole waves from the source to the listener, in closed form.

use crate::geometry::ear::Ear;
use crate::geometry::exact::{ExactScene, Hit, Left, mirror};
use crate::sampling::{FNV_EMPTY, fnv_with};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Minimum number of waves per thread. For fewer waves, the start of a thread costs more than it saves.
const WAVES_WORTH_A_THREAD: usize = 4096;

/// The state of a wave after its last iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExactWave {
    /// 0 = heard, −1 = dead, n = last reflected by surface n, counted from 1.
    pub status: i32,
    /// Number of reflections. For a heard wave this is its order.
    pub order: u32,
    /// Number of reflections by curved surfaces, which multiply errors.
    pub curved_hits: u32,
    /// World position of the last hit in metres, or of the start if the wave has no hits.
    pub point: DVec3,
    /// Unit vector in world axes after the last hit: reflected at a surface, unchanged at the listener and for a dead
    /// wave.
    pub direction: DVec3,
    /// Unit vector in world axes of the flight to `point`.
    pub incoming_direction: DVec3,
    /// Length of the path from the start to `point` in metres.
    pub length: f64,
    /// Hash of the numbers of the hit objects in order, including the listener (0). Waves with the same hash have hit
    /// the same objects.
    pub sequence_hash: u64,
}

/// A hit of a wave. The hits of a path are in the order of the flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathVertex {
    /// World position in metres.
    pub point: DVec3,
    /// Number of the hit object: 0 for the listener, n for surface n, counted from 1.
    pub object: u32,
    /// Unit vector in world axes, from the solid (or the listener) into the air.
    pub normal: DVec3,
}

/// Hash of the numbers of the objects that a wave hit, in order (0 = listener). Waves with the same hash have hit the
/// same objects.
///
/// The hash is FNV-1a over whole object numbers instead of bytes.
pub fn sequence_hash(objects: &[u32]) -> u64 {
    objects
        .iter()
        .fold(FNV_EMPTY, |hash, object| fnv_with(hash, u64::from(*object)))
}

impl ExactScene {
    /// The first hit of a wave that starts in the air at `origin` (world metres) along `direction` (any length except
    /// 0); `None` if the wave hits neither a surface nor the listener.
    ///
    /// If the start is inside the listener's sphere, the wave hits the listener after 0 m.
    pub fn closest_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let direction = direction.try_normalize()?;
        self.next(origin, direction, None).map(|(hit, _)| hit)
    }

    /// Traces one wave for at most `iterations` flights from `start` (world metres) along `direction` (any length).
    ///
    /// A wave without a direction or iterations remains at its start with status −1. So does a wave that starts in a
    /// solid, because it carries no sound.
    ///
    /// ```
    /// use echomarch::{Scene, geometry::ExactScene};
    /// use glam::DVec3;
    /// let scene = Scene::builtin("shoebox")?;
    /// let exact = ExactScene::new(&scene)?;
    /// let start = scene.sources[0].position.as_dvec3();
    /// let wave = exact.trace(start, DVec3::NEG_X, 1);
    /// assert_eq!((wave.status, wave.length), (1, 2.5)); // the wall at x = -6
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    pub fn trace(&self, start: DVec3, direction: DVec3, iterations: u32) -> ExactWave {
        self.walk(start, direction, iterations, |_| ())
    }

    /// All hits of the wave that [`ExactScene::trace`] traces, without its start.
    #[doc(hidden)]
    pub fn trace_path(&self, start: DVec3, direction: DVec3, iterations: u32) -> Vec<PathVertex> {
        let mut path = Vec::new();
        self.walk(start, direction, iterations, |hit| {
            path.push(PathVertex {
                point: hit.point,
                object: hit.object,
                normal: hit.normal,
            });
        });
        path
    }

    /// Traces many directions from one start like [`ExactScene::trace`], on the threads of rayon's pool. The results
    /// are in the order of the directions, and do not depend on the number of threads.
    pub fn trace_all(&self, start: DVec3, directions: &[Vec3], iterations: u32) -> Vec<ExactWave> {
        let trace = |direction: &Vec3| self.trace(start, direction.as_dvec3(), iterations);
        let shares = directions.par_iter().with_min_len(WAVES_WORTH_A_THREAD);
        shares.map(trace).collect()
    }

    /// Lateral position on the listener's sphere at which a wave arrived: −1 at the left ear, 0 in the plane midway
    /// between the ears, 1 at the right ear. `None` if the wave is not heard.
    pub fn arrival_side(&self, wave: &ExactWave) -> Option<f64> {
        let outwards = (wave.point - self.ear.centre).normalize_or_zero();
        (wave.status == 0).then(|| outwards.dot(self.ear.right))
    }

    fn walk(
        &self,
        start: DVec3,
        direction: DVec3,
        iterations: u32,
        mut visit: impl FnMut(&Hit),
    ) -> ExactWave {
        let Some(direction) = direction.try_normalize().filter(|_| iterations > 0) else {
            return ExactWave::at(start, DVec3::ZERO);
        };
        let mut wave = ExactWave::at(start, direction);
        if self.is_in_solid(start, self.error_bound) {
            return wave;
        }
        let mut left = None;
        for _ in 0..iterations {
            wave.incoming_direction = wave.direction;
            let Some((hit, now_left)) = self.next(wave.point, wave.direction, left) else {
                wave.status = -1;
                break;
            };
            visit(&hit);
            wave.point = hit.point;
            wave.length += hit.t;
            wave.status = hit.object as i32;
            wave.sequence_hash = fnv_with(wave.sequence_hash, u64::from(hit.object));
            let Some((index, _)) = now_left else {
                break;
            };
            wave.direction = mirror(wave.direction, hit.normal);
            wave.order += 1;
            wave.curved_hits += u32::from(self.surfaces[index].is_curved());
            left = now_left;
        }
        wave
    }

    /// The next hit. If the wave is reflected, also returns the surface and face that the wave leaves; `None` for the
    /// listener.
    fn next(&self, origin: DVec3, direction: DVec3, left: Left) -> Option<(Hit, Left)> {
        let heard = self.ear.intersect(origin, direction);
        let until = heard.unwrap_or(f64::INFINITY);
        let (met, _) = self.next_surface(origin, direction, left, until);
        match (met, heard) {
            (Some((hit, left)), _) => Some((hit, Some(left))),
            (None, Some(t)) => Some((self.ear.hit(origin, direction, t), None)),
            (None, None) => None,
        }
    }
}

impl Ear {
    fn hit(&self, origin: DVec3, direction: DVec3, t: f64) -> Hit {
        let arrived = origin + direction * t;
        let normal = (arrived - self.centre).normalize_or(-direction);
        let point = if t > 0.0 {
            self.centre + normal * self.radius
        } else {
            arrived
        };
        Hit {
            t,
            object: 0,
            point,
            normal,
        }
    }
}

impl ExactWave {
    /// A wave without hits.
    fn at(start: DVec3, direction: DVec3) -> ExactWave {
        ExactWave {
            status: -1,
            order: 0,
            curved_hits: 0,
            point: start,
            direction,
            incoming_direction: direction,
            length: 0.0,
            sequence_hash: FNV_EMPTY,
        }
    }
}
