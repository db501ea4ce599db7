//! The observer model in the open: directions in which its answers must be right, and directions that levels cannot
//! distinguish.

use super::listen::{source_towards, without_ground};
use super::observer::{Observer, lateral_deg};
use super::report::{OpenDirection, OpenReport};
use super::statistics::{Pair, figures};
use super::sweep::Run;
use super::{OPEN_DISTANCE_M, OpenCase};
use crate::stats::mean;
use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::Settings;

/// Azimuth and elevation, in degrees, of three sources with the same lateral angle, 30°: ahead, behind, and above (sin
/// 45° · cos 45° = sin 30°).
const ALIKE: [(f64, f64); 3] = [(30.0, 0.0), (150.0, 0.0), (45.0, 45.0)];

/// The answers to sources in one or more directions, each paired with the true angle.
#[derive(Default)]
struct Heard {
    told: Vec<Pair>,
    blind: Vec<Pair>,
}

impl Run<'_> {
    pub(super) fn open(&mut self, case: &OpenCase) -> Result<OpenReport, Error> {
        let mut field = Scene::builtin("open-field")?;
        if !case.ground {
            field = without_ground(&field);
        }
        let mut all = Heard::default();
        let mut azimuths = Vec::new();
        for &azimuth in &self.options.azimuths_deg {
            let (at, heard) = self.direction(&field, (azimuth, 0.0), &case.settings)?;
            azimuths.push(at);
            all.told.extend(heard.told);
            all.blind.extend(heard.blind);
        }
        let mut alike = Vec::new();
        for direction in ALIKE {
            alike.push(self.direction(&field, direction, &case.settings)?.0);
        }
        self.step();
        let there = source_towards(&field, (0.0, 0.0), OPEN_DISTANCE_M);
        let law = self.options.law;
        Ok(OpenReport {
            profile: case.settings.profile().to_string(),
            waves: case.settings.waves,
            iterations: case.settings.iterations,
            ground: case.ground,
            distance_m: OPEN_DISTANCE_M,
            mean_side: Observer::new(&there, law).mean_side(),
            blind_mean_side: Observer::blind(law).mean_side(),
            all: figures(&all.told),
            blind: figures(&all.blind),
            azimuths,
            alike,
        })
    }

    fn direction(
        &mut self,
        field: &Scene,
        direction: (f64, f64),
        settings: &Settings,
    ) -> Result<(OpenDirection, Heard), Error> {
        let scene = source_towards(field, direction, OPEN_DISTANCE_M);
        let truth_deg = lateral_deg(&scene);
        let mut heard = Heard::default();
        for seed in 1..=self.options.seeds {
            let answers = self.hear(&scene, &settings.clone().with_seed(seed))?;
            if answers.hits == 0 {
                continue;
            }
            let pair = |answer_deg| Pair {
                truth_deg,
                answer_deg,
            };
            heard.told.extend(answers.told.first().copied().map(pair));
            heard.blind.extend(answers.blind.map(pair));
        }
        let at = OpenDirection {
            azimuth_deg: direction.0,
            elevation_deg: direction.1,
            lateral_deg: truth_deg,
            answer_deg: mean(heard.told.iter().map(|pair| pair.answer_deg)),
            error: figures(&heard.told),
            blind: figures(&heard.blind),
        };
        Ok((at, heard))
    }
}
