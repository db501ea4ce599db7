//! Results of the exact geometry, computed once and cached.

use super::directions::lattice;
use super::report::Limit;
use echomarch::Error;
use echomarch::geometry::{ExactScene, ExactWave};
use echomarch::scene::Scene;
use echomarch::tracer::{Directions, Profile, Settings, Tracer};
use glam::Vec3;
use std::collections::HashMap;
use std::rc::Rc;

/// Number of directions that are traced at a time. This number limits the required memory.
const PART: usize = 1 << 20;

/// The parameters of start directions: their set, the number of waves, the seed. The same parameters give the same
/// directions for every profile.
type Start = (Directions, u32, u32);

/// A scene with its exact results.
pub struct Truth<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The scene as exact geometry in `f64`.
    pub exact: ExactScene,
    /// Number of directions for the limits.
    limit_directions: u64,
    /// The limits for each number of iterations, from 0 to the largest requested number.
    limits: Vec<Limit>,
    /// The panning of the twins, by number of iterations.
    twins: HashMap<Start, Vec<f64>>,
    /// The exact waves, by start directions and number of iterations.
    followed: HashMap<(Start, u32), Rc<[ExactWave]>>,
}

/// The sums of the sides of all arrivals, by iteration of arrival.
struct Arrivals {
    sides: Vec<f64>,
    heard: Vec<u64>,
}

impl<'a> Truth<'a> {
    /// Creates an empty cache for `scene`. Limits will be computed with `limit_directions` directions.
    ///
    /// # Errors
    /// [`Error::Scene`] for an invalid scene.
    pub fn new(scene: &'a Scene, limit_directions: u64) -> Result<Truth<'a>, Error> {
        Ok(Truth {
            scene,
            exact: ExactScene::new(scene)?,
            limit_directions,
            limits: Vec::new(),
            twins: HashMap::new(),
            followed: HashMap::new(),
        })
    }

    /// Traces exact waves from the source along `directions`.
    pub fn waves(&self, directions: &[Vec3], iterations: u32) -> Vec<ExactWave> {
        let start = self.scene.sources[0].position.as_dvec3();
        self.exact.trace_all(start, directions, iterations)
    }

    /// Returns the exact waves for the start directions `starts` of these settings. These waves are traced only once,
    /// and are shared by all settings with the same start directions.
    pub fn twins(&mut self, settings: &Settings, starts: &[Vec3]) -> Rc<[ExactWave]> {
        let key = (start(settings), settings.iterations);
        if let Some(known) = self.followed.get(&key) {
            return known.clone();
        }
        let waves: Rc<[ExactWave]> = self.waves(starts, settings.iterations).into();
        self.followed.insert(key, waves.clone());
        waves
    }

    /// Computes the limits of many waves for all numbers of iterations up to `most`, in the time of a single limit. The
    /// results equal those of [`Truth::limit`]. Each of the two lattices has half of the directions.
    pub fn find_limits(&mut self, most: u32) {
        let half = (self.limit_directions / 2).max(1);
        let [upright, turned] = [false, true].map(|t| self.arrivals(&lattice(half, t), most));
        let limit = |iterations| {
            let (a, b) = (upright.pan(iterations), turned.pan(iterations));
            let heard = upright.heard(iterations) + turned.heard(iterations);
            Limit {
                iterations,
                directions: 2 * half,
                pan: 0.5 * (a + b),
                uncertainty: 0.5 * (a - b).abs(),
                heard: heard as f64 / (2 * half) as f64,
            }
        };
        self.limits = (0..=most).map(limit).collect();
    }

    /// Returns the limit of many waves. Traces it if [`Truth::find_limits`] has not computed it.
    pub fn limit(&mut self, iterations: u32) -> Limit {
        if self.limits.len() <= iterations as usize {
            self.find_limits(iterations);
        }
        self.limits[iterations as usize]
    }

    /// Returns the exact panning of the waves that the GPU starts with these settings.
    ///
    /// `most` is the largest number of iterations that will be requested for these waves.
    ///
    /// # Errors
    /// Errors of [`Tracer::frame`].
    pub fn pan_of_twins(
        &mut self,
        tracer: &mut Tracer,
        settings: &Settings,
        most: u32,
    ) -> Result<f64, Error> {
        let key = start(settings);
        let iterations = settings.iterations as usize;
        if self
            .twins
            .get(&key)
            .is_none_or(|pans| pans.len() <= iterations)
        {
            let most = most.max(settings.iterations);
            let starts = start_directions(tracer, self.scene, settings)?;
            let arrivals = self.arrivals(&starts, most);
            let pans = (0..=most).map(|iterations| arrivals.pan(iterations));
            self.twins.insert(key, pans.collect());
        }
        Ok(self.twins[&key][iterations])
    }

    fn arrivals(&self, directions: &[Vec3], iterations: u32) -> Arrivals {
        let mut arrivals = Arrivals {
            sides: vec![0.0; iterations as usize],
            heard: vec![0; iterations as usize],
        };
        for part in directions.chunks(PART) {
            for wave in self.waves(part, iterations) {
                if let Some(side) = self.exact.arrival_side(&wave) {
                    arrivals.sides[wave.order as usize] += side;
                    arrivals.heard[wave.order as usize] += 1;
                }
            }
        }
        arrivals
    }
}

impl Arrivals {
    fn heard(&self, iterations: u32) -> u64 {
        self.heard[..iterations as usize].iter().sum()
    }

    /// The panning after the given number of iterations; 0 without arrivals.
    fn pan(&self, iterations: u32) -> f64 {
        let side: f64 = self.sides[..iterations as usize].iter().sum();
        match self.heard(iterations) {
            0 => 0.0,
            heard => side / heard as f64,
        }
    }
}

fn start(settings: &Settings) -> Start {
    (settings.directions, settings.waves, settings.seed)
}

/// The start directions for these settings, which are the same for every profile.
fn start_directions(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
) -> Result<Vec<Vec3>, Error> {
    let first = settings.clone().with_profile(Profile::Hybrid);
    let first = first.with_iterations(1);
    let (_, waves) = tracer.frame_with_waves(scene, &first)?;
    Ok(waves.iter().map(|wave| wave.start_direction).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::geometry::ShoeboxImages;

    /// Protects the limit: for the same directions, its hits equal those of the image sources.
    #[test]
    fn the_limit_of_the_shoebox_is_that_of_its_images() {
        let scene = Scene::builtin("shoebox").unwrap();
        let directions = [false, true].map(|turned| lattice(50_000, turned)).concat();
        let images = ShoeboxImages::new(&scene).unwrap();
        let hits = images.hits_by_order(&directions, 8).unwrap();
        let mut truth = Truth::new(&scene, 100_000).unwrap();
        truth.find_limits(3);
        for iterations in [0, 1, 3, 8] {
            let heard: u64 = hits[..iterations as usize].iter().sum();
            let limit = truth.limit(iterations);
            assert_eq!((limit.iterations, limit.directions), (iterations, 100_000));
            assert_eq!(limit.heard, heard as f64 / 1e5);
        }
        assert!(truth.limit(8).heard > 0.0);
    }
}
