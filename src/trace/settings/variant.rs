//! Worsened ways to march, and test distortions. The experiments set each beside the default
//! to show what it is for; the public settings have none of them.

use super::{TraceError, bad, positive};

/// Width of the default shell in metres: everywhere. Newton's steps need a gradient each but are
/// so few that they were faster in every scene measured (docs/accuracy.md).
const EVERYWHERE: f32 = 1e8;

/// How `march` is carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MarchVariant {
    /// Width of the shell about surfaces in which steps are Newton's, in metres. Outside of it
    /// they are Hart's.
    pub shell: f32,
    /// Step of difference normals to either side, in metres, as in the thesis; `None` for the
    /// normal of the surface met.
    pub difference_normals: Option<f32>,
    /// Whether waves are projected onto the surface (`true`), or stop in the shell as in the thesis.
    pub projection: bool,
    /// How much faster than the true distance the distance may grow; every step is divided by it.
    pub lipschitz: f32,
    /// Every distance is multiplied by this, in tests of functions that over-estimate.
    pub distance_factor: f32,
}

impl Default for MarchVariant {
    /// The best known way.
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
    /// Whether the shell ends anywhere.
    #[cfg(feature = "experiment")]
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
