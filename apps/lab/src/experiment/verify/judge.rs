//! Compares traced waves with the set of right answers.

use super::case::{Bound, Planted};
use super::report::ProfileResult;
use super::rounding::{END_ROUNDING, LENGTH_ROUNDING, START_ROUNDING};
use crate::stats::median;
use echomarch::geometry::{ExactScene, sequence_hash};
use echomarch::scene::Scene;
use echomarch::tracer::{Fate, Profile, Wave};
use glam::{DVec3, Vec3};

/// The exact geometry of a scene, with the lengths to which errors are compared.
pub(super) struct Judge {
    exact: ExactScene,
    start: DVec3,
    iterations: u32,
    /// Largest distance between the listener and a point of the scene, in metres.
    extent: f64,
    /// Half a unit in the last place of a world coordinate, in metres: the error when a position is read back as `f32`.
    world_rounding: f64,
}

/// The result of one wave, traced or exact.
#[derive(Clone, Copy, Debug)]
struct Answer {
    status: i32,
    sequence: u64,
    end: DVec3,
    /// Whether `end` is a valid position. The thesis' algorithm does not keep the position of a dead wave.
    placed: bool,
}

/// The verdict on one wave.
enum Verdict {
    /// A right answer. The distance from the nearest right answer is in metres, and as a share of the extent, or of the
    /// path if the path is longer.
    Right(f64, f64),
    /// A wrong answer. The distance from the exact end is in metres; `None` if one of the waves has no end.
    Off(Option<f64>),
}

impl Judge {
    /// # Errors
    /// Fails for an invalid scene.
    pub fn new(scene: &Scene, iterations: u32) -> Result<Judge, echomarch::Error> {
        let ear = scene.listeners[0].position.as_dvec3();
        let reach = |surface: &echomarch::Surface| {
            let away = (surface.position.as_dvec3() - ear).abs().max_element();
            away + surface.shape.extent()
        };
        let start = scene.sources[0].position.as_dvec3();
        let extent = scene
            .surfaces
            .iter()
            .map(reach)
            .chain([(start - ear).length(), f64::from(scene.listeners[0].radius)])
            .fold(0.0, f64::max);
        let world = ear.abs().max_element() + extent;
        Ok(Judge {
            exact: ExactScene::new(scene)?,
            start,
            iterations,
            extent,
            world_rounding: world * f64::from(f32::EPSILON) * 0.5,
        })
    }

    /// Judges the states of the waves at the start and after each iteration.
    pub fn judge(&self, states: &[Vec<Wave>], bound: &Bound, by: Profile) -> ProfileResult {
        let waves = states[0].len();
        let mut result = ProfileResult {
            waves,
            ..ProfileResult::default()
        };
        let mut offs = Vec::new();
        for index in 0..waves {
            let path: Vec<Wave> = states.iter().map(|state| state[index]).collect();
            self.sanity(&path, &mut result);
            let start = path[0].start_direction.as_dvec3();
            let truth = self.exact.trace(self.start, start, self.iterations);
            let fate = Fate::of(path[path.len() - 1].status);
            result.heard += usize::from(fate == Fate::Listener);
            result.heard_exactly += usize::from(truth.status == 0);
            match self.verdict(&given(&path, by), &path, bound, index) {
                Verdict::Right(error, share) => {
                    result.error = result.error.max(error);
                    result.relative_error = result.relative_error.max(share);
                }
                Verdict::Off(distance) => {
                    result.off += 1;
                    result.lost += usize::from(fate == Fate::Dead && truth.status != -1);
                    offs.extend(distance.filter(|distance| distance.is_finite()));
                }
            }
        }
        result.median_off = median(offs);
        let exceptions = match bound {
            Bound::Spread { exceptions } => (exceptions * waves as f64) as usize,
            Bound::Planted { .. } => 0,
        };
        // If every end counts as right, waves must still not be lost, and the number of heard waves must agree with
        // that of another sample of the same chaotic paths. The standard deviation of the difference between two
        // independent counts is the root of their sum. A difference of more than four standard deviations occurs in one
        // of 16 000 samples.
        let no_ends = matches!(bound, Bound::Spread { exceptions } if *exceptions >= 1.0);
        let heard = result.heard as f64;
        let exactly = result.heard_exactly as f64;
        let as_by_chance = (heard - exactly).powi(2) <= 16.0 * (heard + exactly);
        result.passed = result.off <= exceptions
            && !(no_ends && (result.lost > 0 || !as_by_chance))
            && result.not_finite == 0
            && result.inside == 0
            && result.step_limit_reached == 0
            && result.length_error <= LENGTH_ROUNDING;
        result
    }

    /// Checks the requirements that do not depend on the right answer.
    fn sanity(&self, path: &[Wave], result: &mut ProfileResult) {
        let mut depth = 0.0_f64;
        for wave in path {
            let numbers = wave.position.is_finite() && wave.direction.is_finite();
            if !(numbers && wave.status.is_finite()) {
                result.not_finite += 1;
                continue;
            }
            if Fate::of(wave.status) == Fate::Dead {
                continue;
            }
            let place = wave.position.as_dvec3();
            let tolerance = self.reach(place) * END_ROUNDING + self.world_rounding;
            let deep = -self.exact.surface_distance(place);
            if deep > tolerance {
                depth = depth.max(deep);
            }
            let length = wave.direction.as_dvec3().length();
            result.length_error = result.length_error.max((length - 1.0).abs());
        }
        if depth > 0.0 {
            result.inside += 1;
            result.deepest = result.deepest.max(depth);
        }
        if let Some(end) = path.last() {
            result.step_limit_reached += u64::from(end.step_limit_reached);
            result.zero_length_passes += u64::from(end.zero_length_passes);
        }
    }

    fn verdict(&self, given: &Answer, path: &[Wave], bound: &Bound, index: usize) -> Verdict {
        match bound {
            Bound::Spread { .. } => self.by_spread(given, path[0].start_direction),
            Bound::Planted { share, answers } => {
                let answer = planted(&answers[index]);
                self.against(given, &[answer], share * self.reach(answer.end))
            }
        }
    }

    /// Judges by the spread: the right answers are those of exact waves whose start is displaced by a rounding error.
    fn by_spread(&self, given: &Answer, direction: Vec3) -> Verdict {
        let direction = direction.as_dvec3();
        let answers: Vec<Answer> = self
            .starts(direction)
            .map(|(start, direction)| {
                let wave = self.exact.trace(start, direction, self.iterations);
                Answer {
                    status: wave.status,
                    sequence: wave.sequence_hash,
                    end: wave.point,
                    placed: true,
                }
            })
            .collect();
        let like = |answer: &&Answer| answer.sequence == given.sequence;
        let ends: Vec<DVec3> = answers.iter().filter(like).map(|a| a.end).collect();
        let spread = ends
            .iter()
            .flat_map(|a| ends.iter().map(|b| a.distance(*b)))
            .fold(0.0, f64::max);
        self.against(given, &answers, 2.0 * spread + END_ROUNDING * self.extent)
    }

    fn against(&self, given: &Answer, answers: &[Answer], within: f64) -> Verdict {
        let right = answers
            .iter()
            .filter(|answer| answer.status == given.status && answer.sequence == given.sequence)
            .map(|answer| match given.placed {
                true => answer.end.distance(given.end),
                false => 0.0,
            })
            .fold(f64::INFINITY, f64::min);
        if right <= within + 2.0 * self.world_rounding {
            return Verdict::Right(right, right / self.reach(given.end));
        }
        let both_end = given.status != -1 && answers[0].status != -1;
        Verdict::Off(both_end.then(|| answers[0].end.distance(given.end)))
    }

    /// The start itself, and starts that are displaced by a whole, a half and a quarter of the rounding error in
    /// position and direction. Several displacements are needed, because the result for a tangent line depends on the
    /// root of the displacement.
    fn starts(&self, direction: DVec3) -> impl Iterator<Item = (DVec3, DVec3)> {
        let (start, extent) = (self.start, self.extent);
        let aside = direction.any_orthonormal_vector();
        let across = aside.cross(direction);
        let off = move |share: f64| {
            let moved = DVec3::AXES.map(|axis| (axis * (share * extent), DVec3::ZERO));
            let turned = [aside, across].map(|by| (DVec3::ZERO, by * share));
            let both = moved.into_iter().chain(turned);
            both.map(move |(place, turn)| (start + place, direction + turn))
        };
        let shares = [1.0, -1.0, 0.5, -0.5, 0.25, -0.25].map(|share| share * START_ROUNDING);
        [(start, direction)]
            .into_iter()
            .chain(shares.into_iter().flat_map(off))
    }

    /// The extent in metres, or the distance between the source and this end if it is larger.
    fn reach(&self, end: DVec3) -> f64 {
        self.extent.max(end.distance(self.start))
    }

    /// The maximum distance between the exact waves and the answers known in advance, as a share of the extent, or of
    /// the path if the path is longer. The result is infinite if a wave hits other objects.
    pub fn exact_against(&self, directions: &[Vec3], answers: &[Planted]) -> f64 {
        let off = |(direction, answer): (&Vec3, &Planted)| {
            let direction = direction.as_dvec3();
            let wave = self.exact.trace(self.start, direction, self.iterations);
            if wave.sequence_hash != sequence_hash(&answer.objects) {
                return f64::INFINITY;
            }
            wave.point.distance(answer.end) / self.reach(answer.end)
        };
        directions.iter().zip(answers).map(off).fold(0.0, f64::max)
    }
}

fn planted(answer: &Planted) -> Answer {
    Answer {
        status: answer.objects.last().map_or(-1, |&object| object as i32),
        sequence: sequence_hash(&answer.objects),
        end: answer.end,
        placed: true,
    }
}

/// The answer that the states of a wave contain. The wave hits an object in each iteration until it is heard or dies.
fn given(path: &[Wave], by: Profile) -> Answer {
    let mut objects = Vec::new();
    for pair in path.windows(2) {
        let before = Fate::of(pair[0].status);
        let still_dead = before == Fate::Dead && Fate::of(pair[1].status) == Fate::Dead;
        if before == Fate::Listener || still_dead {
            break;
        }
        if Fate::of(pair[1].status) != Fate::Dead {
            objects.push(pair[1].status.round() as u32);
        }
    }
    let end = path.last().copied();
    let status = end.map_or(-1, |wave| wave.status.round() as i32);
    Answer {
        status,
        sequence: sequence_hash(&objects),
        end: end.map_or(DVec3::NAN, |wave| wave.position.as_dvec3()),
        placed: status != -1 || by != Profile::Thesis,
    }
}
