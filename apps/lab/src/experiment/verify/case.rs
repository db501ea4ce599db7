//! A hard case: a scene or input, and its requirements.

use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Settings, Tracer};
use glam::{DVec3, Vec3};

/// A hard case: the scene or input, and the requirements on its result.
#[derive(Clone, Debug)]
pub struct Case {
    /// The case's name on the command line.
    pub name: String,
    /// The difficulty, in words.
    pub hard: &'static str,
    /// The exact answer in words.
    pub exact: String,
    /// The check.
    pub check: Check,
}

/// The check of a case.
#[derive(Clone, Debug)]
pub enum Check {
    /// Waves compared with their exact end points.
    Waves(Box<WaveCheck>),
    /// Input that must be rejected with a typed error, each with a description of the expected
    /// error. A profile gets only the input that applies to its settings.
    Refused(Vec<(&'static str, Scene, Settings)>),
    /// Energies of arrivals.
    Energies(EnergyCheck),
}

/// Energies of arrivals, compared with known values.
#[derive(Clone, Copy, Debug)]
pub struct EnergyCheck {
    /// The accepted error, in words.
    pub(super) bound: &'static str,
    /// Traces the energies, and judges them.
    pub(super) judge: fn(&mut Tracer, &Settings) -> Result<Verdict, Error>,
}

/// The result of a judgement of energies.
#[derive(Clone, Debug)]
pub(super) struct Verdict {
    pub passed: bool,
    pub note: String,
}

/// Waves to trace, and the accepted distance from their exact end points.
#[derive(Clone, Debug)]
pub struct WaveCheck {
    /// The scene.
    pub scene: Scene,
    /// The same world for the judge: library trees describe in `f64` the surfaces that users' texts
    /// describe in `scene`.
    pub truth: Option<Box<Scene>>,
    /// The directions in which the waves leave the source, along world axes.
    pub directions: Vec<Vec3>,
    /// Number of flights of each wave.
    pub iterations: u32,
    /// The accepted error.
    pub bound: Bound,
}

/// The accepted error of an answer.
#[derive(Clone, Debug)]
pub enum Bound {
    /// The accepted error is the effect that rounding errors of the start have on the exact wave.
    Spread {
        /// Share of the waves that may have another answer, because they hit edges that none of the
        /// few computed starts hits.
        exceptions: f64,
    },
    /// The accepted error is a share of the scene's extent, or of the path if the path is longer,
    /// from planted answers, with one answer per wave.
    Planted {
        /// The share.
        share: f64,
        /// The answers, in the order of the directions.
        answers: Vec<Planted>,
    },
}

/// An answer that is known in advance.
#[derive(Clone, Debug)]
pub struct Planted {
    /// The objects met, in order: 0 the listener, n the n-th surface.
    pub objects: Vec<u32>,
    /// Position of the wave after its last flight, in world metres.
    pub end: DVec3,
}

impl Case {
    /// Creates a case that is judged by the spread of exact waves, without exceptions.
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
            })),
        }
    }

    /// Requires answers known in advance, reached within `share` of the extent.
    pub(super) fn planted(mut self, with_share: f64, with_answers: Vec<Planted>) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.bound = Bound::Planted {
                share: with_share,
                answers: with_answers,
            };
        }
        self
    }

    /// Allows a share of the waves to be wrong.
    pub(super) fn but_for(mut self, share: f64) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.bound = Bound::Spread { exceptions: share };
        }
        self
    }

    /// Lets the judge use another description of the same world.
    pub(super) fn judged_by(mut self, other: Scene) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.truth = Some(Box::new(other));
        }
        self
    }
}
