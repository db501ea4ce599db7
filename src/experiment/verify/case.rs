//! One hard case.

use crate::error::Error;
use crate::scene::Scene;
use crate::trace::{Settings, Tracer};
use glam::{DVec3, Vec3};

/// A hard case: what is traced, and its requirements.
#[derive(Clone, Debug)]
pub struct Case {
    /// What the command line calls it.
    pub name: String,
    /// What is hard.
    pub hard: &'static str,
    /// The exact answer in words.
    pub exact: String,
    /// What is checked.
    pub check: Check,
}

/// What is checked.
#[derive(Clone, Debug)]
pub enum Check {
    /// Waves against their exact end points.
    Waves(Box<WaveCheck>),
    /// Input that must be rejected with a typed error, each with what is wrong with it. A profile
    /// is given what has its settings.
    Refused(Vec<(&'static str, Scene, Settings)>),
    /// Energies of arrivals.
    Energies(EnergyCheck),
}

/// Energies of arrivals, against what is known of them.
#[derive(Clone, Copy, Debug)]
pub struct EnergyCheck {
    /// How far off is right, in words.
    pub(super) bound: &'static str,
    /// Traces and judges them.
    pub(super) judge: fn(&mut Tracer, &Settings) -> Result<Verdict, Error>,
}

/// The result.
#[derive(Clone, Debug)]
pub(super) struct Verdict {
    pub passed: bool,
    pub note: String,
}

/// Waves, and how far from their exact end points they may be.
#[derive(Clone, Debug)]
pub struct WaveCheck {
    /// Where.
    pub scene: Scene,
    /// The same world for the judge, where a tree of the library's states in `f64` what
    /// a user's text in `scene` states, surface by surface.
    pub truth: Option<Box<Scene>>,
    /// In which directions the waves leave the source (world axes).
    pub directions: Vec<Vec3>,
    /// Flights of each wave.
    pub iterations: u32,
    /// How far off the exact answer is right.
    pub bound: Bound,
    /// `march`: every distance is multiplied by this, and the stated Lipschitz
    /// bound is somewhat larger than it.
    pub overestimate: f32,
}

/// How far off the exact answer is right.
#[derive(Clone, Debug)]
pub enum Bound {
    /// Within what roundings of the start do to the exact wave.
    Spread {
        /// Share of the waves that may have another answer: edges met after spread that
        /// the few starts did not show.
        exceptions: f64,
    },
    /// Within a share of the scene's extent, or of the way there if that is longer, of
    /// planted answers, a wave each.
    Planted {
        /// The share.
        share: f64,
        /// In the order of the directions.
        answers: Vec<Planted>,
    },
}

/// An answer that is known beforehand.
#[derive(Clone, Debug)]
pub struct Planted {
    /// The objects met, in order: 0 the listener, n the n-th surface.
    pub objects: Vec<u32>,
    /// Where the wave is after its last flight, world metres.
    pub end: DVec3,
}

impl Case {
    /// A case that is judged by the spread of exact waves, with no exception.
    pub(super) fn spread(
        name: impl Into<String>,
        hard: &'static str,
        exact: impl Into<String>,
        scene: Scene,
        directions: Vec<Vec3>,
        iterations: u32,
    ) -> Case {
        Case {
            name: name.into(),
            hard,
            exact: exact.into(),
            check: Check::Waves(Box::new(WaveCheck {
                scene,
                truth: None,
                directions,
                iterations,
                bound: Bound::Spread { exceptions: 0.0 },
                overestimate: 1.0,
            })),
        }
    }

    /// The same with answers that are known beforehand, met within `share` of the extent.
    pub(super) fn planted(mut self, with_share: f64, with_answers: Vec<Planted>) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.bound = Bound::Planted {
                share: with_share,
                answers: with_answers,
            };
        }
        self
    }

    /// The same with a share of waves that may be off.
    pub(super) fn but_for(mut self, share: f64) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.bound = Bound::Spread { exceptions: share };
        }
        self
    }

    /// The same, judged by another statement of the same world.
    pub(super) fn judged_by(mut self, other: Scene) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.truth = Some(Box::new(other));
        }
        self
    }

    /// The same with a distance function that over-estimates.
    pub(super) fn overestimated(mut self, factor: f32) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.overestimate = factor;
        }
        self
    }
}
