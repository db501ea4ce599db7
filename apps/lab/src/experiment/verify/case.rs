//! A hard case: a scene or an input, and the requirements on its result.

use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Settings, Tracer};
use glam::{DVec3, Vec3};

/// A hard case: a scene or an input, and the requirements on its result.
#[derive(Clone, Debug)]
pub struct Case {
    /// The case's name on the command line.
    pub name: String,
    /// The difficulty, as text.
    pub hard: &'static str,
    /// The exact answer, as text.
    pub exact: String,
    /// The check.
    pub check: Check,
}

/// The check that decides whether a profile passes the case.
#[derive(Clone, Debug)]
pub enum Check {
    /// Waves compared with their exact end points.
    Waves(Box<WaveCheck>),
    /// Input that must be rejected with a typed error. Each entry has a description, a scene and settings. A profile
    /// only gets the entries for its own settings.
    Refused(Vec<(&'static str, Scene, Settings)>),
    /// Energies of arrivals.
    Energies(EnergyCheck),
}

/// Energies of arrivals, compared with known values.
#[derive(Clone, Copy, Debug)]
pub struct EnergyCheck {
    /// The accepted error, as text.
    pub(super) bound: &'static str,
    /// Traces the energies, and compares them with the known values.
    pub(super) judge: fn(&mut Tracer, &Settings) -> Result<Verdict, Error>,
}

/// The result of a comparison of energies.
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
    /// The same scene for the reference. This scene has library shapes, evaluated in `f64`, in place of the users'
    /// fields of `scene`.
    pub truth: Option<Box<Scene>>,
    /// The directions in which the waves leave the source, in world axes.
    pub directions: Vec<Vec3>,
    /// Number of flights of each wave.
    pub iterations: u32,
    /// The accepted error.
    pub bound: Bound,
}

/// The accepted error of an answer.
#[derive(Clone, Debug)]
pub enum Bound {
    /// The accepted error is the effect of a rounding error in the start of the exact wave.
    Spread {
        /// Share of the waves that may have another answer, because they hit edges that none of the few displaced
        /// starts hits.
        exceptions: f64,
    },
    /// The accepted error is a share of the scene's extent, or of the path if the path is longer. The answers are known
    /// in advance, one for each wave.
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
    /// The objects that the wave hits, in order: 0 is the listener, n is the n-th surface.
    pub objects: Vec<u32>,
    /// Position of the wave after its last flight, in world metres.
    pub end: DVec3,
}

impl Case {
    /// Creates a case that accepts the spread of displaced exact waves, without exceptions.
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

    /// Requires answers that are known in advance, within `with_share` of the extent.
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

    /// Gives the reference another description of the same scene.
    pub(super) fn judged_by(mut self, other: Scene) -> Case {
        if let Check::Waves(waves) = &mut self.check {
            waves.truth = Some(Box::new(other));
        }
        self
    }
}
