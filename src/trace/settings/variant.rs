//! Degraded ways to march, and test distortions. Each experiment compares one with the default to
//! show its benefit; the public settings do not include them.

use super::{TraceError, bad, positive};

/// Width of the default shell in metres: everywhere. Newton's steps need a gradient each, but there
/// are few enough of them to be faster in every scene measured (docs/accuracy.md).
const EVERYWHERE: f32 = 1e8;

/// A variant of `march`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarchVariant {
    /// Width of the shell about surfaces in which steps are Newton's, in metres. Outside of it
    /// they are Hart's.
    pub shell: f32,
    /// Step of difference normals to either side, in metres, as in the thesis; `None` for the
    /// normal of the surface met.
    pub difference_normals: Option<f32>,
    /// Whether waves are projected onto the surface (`true`), or stop in the shell as in the thesis.
    pub projection: bool,
    /// Maximum ratio of the distance's growth to that of the true distance; every step is divided by it.
    pub lipschitz: f32,
    /// Factor on every distance, in tests of functions that over-estimate.
    pub distance_factor: f32,
}

impl Default for MarchVariant {
    /// The best known variant.
    fn default() -> MarchVariant {
        MarchVariant {
            shell: EVERYWHERE,
            difference_normals: None,
            projection: true,
            lipschitz: 1.0,
            distance_factor: 1.0,
        }
    }
}

impl MarchVariant {
    /// Whether the shell is bounded.
    pub fn has_shell(&self) -> bool {
        self.shell < EVERYWHERE
    }

    pub(super) fn validate(&self, max_distance: f32) -> Result<(), TraceError> {
        positive("width of the shell in metres", self.shell)?;
        if let Some(step) = self.difference_normals {
            positive("step of the normals in metres", step)?;
        }
        if !self.projection && self.shell >= max_distance {
            let must = format!("less than the maximum distance of {max_distance}");
            return Err(bad("width of the shell in metres", must, self.shell));
        }
        if !(self.lipschitz.is_finite() && self.lipschitz >= 1.0) {
            let must = "finite and at least 1".to_owned();
            return Err(bad("Lipschitz bound", must, self.lipschitz));
        }
        positive("factor of the distance", self.distance_factor)
    }
}
