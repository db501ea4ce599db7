//! The algorithms, each with its options.

use super::{TraceError, bad, positive};
use crate::shader::MAX_STEPS;
use serde::{Deserialize, Serialize};

/// The name of an algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Profile {
    /// Intersects a wave with each surface in closed form, if the surface has one. Recommended.
    Hybrid,
    /// Accurate sphere tracing, for any distance function with a Lipschitz bound.
    March,
    /// Figures 8 and 9 of the thesis as printed, including their errors.
    Thesis,
}

/// The algorithm that traces a wave, with its options.
///
/// Serialised as the options next to `"profile": NAME`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "profile", rename_all = "lowercase")]
pub enum Algorithm {
    /// Algorithm of [`Profile::Hybrid`].
    Hybrid,
    /// Algorithm of [`Profile::March`].
    March,
    /// Algorithm of [`Profile::Thesis`].
    Thesis(ThesisOptions),
}

/// Options of `thesis`: its constants, in metres. The defaults are the constants of the thesis (section 4.2.3, figure
/// 8). The thesis states no step for its normals. The default of 0.01 m is the step with which the reconstruction of
/// its scenes was fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ThesisOptions {
    /// Distance below which a surface is hit, in metres: 0.1 by default. It must be greater than 0 and less than the
    /// maximum distance.
    pub min_distance: f32,
    /// Offset of the start of each march along the direction, in metres: 0.04 by default. It must not be negative.
    pub start_offset: f32,
    /// Step to either side for normals that are computed from differences, in metres: 0.01 by default. It must be
    /// greater than 0.
    pub normal_step: f32,
}

impl Default for ThesisOptions {
    fn default() -> ThesisOptions {
        ThesisOptions {
            min_distance: 0.1,
            start_offset: 0.04,
            normal_step: 0.01,
        }
    }
}

impl ThesisOptions {
    setters! {
        /// Sets the minimum distance, in metres.
        pub fn with_min_distance(metres: f32) => min_distance;

        /// Sets the start offset, in metres.
        pub fn with_start_offset(metres: f32) => start_offset;

        /// Sets the step of the normals, in metres.
        pub fn with_normal_step(metres: f32) => normal_step;
    }

    /// Maximum evaluations of the distance in a march. The number is derived from the distances, and is at most
    /// [`MAX_STEPS`].
    pub(crate) fn step_limit(&self, max_distance: f32) -> u32 {
        let needed = (max_distance / self.min_distance).ceil() + 1.0;
        (needed as u32).clamp(1, MAX_STEPS)
    }

    fn validate(&self, max_distance: f32) -> Result<(), TraceError> {
        positive("minimum distance in metres", self.min_distance)?;
        positive("step of the normals in metres", self.normal_step)?;
        if self.min_distance >= max_distance {
            let must = format!("less than the maximum distance of {max_distance}");
            return Err(bad("minimum distance in metres", must, self.min_distance));
        }
        if !(self.start_offset.is_finite() && self.start_offset >= 0.0) {
            let must = "finite and not negative".to_owned();
            return Err(bad("start offset in metres", must, self.start_offset));
        }
        Ok(())
    }
}

impl Algorithm {
    /// An algorithm with its default options.
    pub fn of(profile: Profile) -> Algorithm {
        match profile {
            Profile::Hybrid => Algorithm::Hybrid,
            Profile::March => Algorithm::March,
            Profile::Thesis => Algorithm::Thesis(ThesisOptions::default()),
        }
    }

    /// The algorithm's name.
    pub fn profile(&self) -> Profile {
        match self {
            Algorithm::Hybrid => Profile::Hybrid,
            Algorithm::March => Profile::March,
            Algorithm::Thesis(_) => Profile::Thesis,
        }
    }

    /// Checks the algorithm's options.
    pub(super) fn validate(&self, max_distance: f32) -> Result<(), TraceError> {
        match self {
            Algorithm::Hybrid | Algorithm::March => Ok(()),
            Algorithm::Thesis(thesis) => thesis.validate(max_distance),
        }
    }
}

impl From<ThesisOptions> for Algorithm {
    fn from(options: ThesisOptions) -> Algorithm {
        Algorithm::Thesis(options)
    }
}

impl From<Profile> for Algorithm {
    fn from(profile: Profile) -> Algorithm {
        Algorithm::of(profile)
    }
}

impl Profile {
    /// All profiles.
    pub const ALL: [Profile; 3] = [Profile::Hybrid, Profile::March, Profile::Thesis];
}

named_values!(Profile, "profile": Hybrid = "hybrid", March = "march", Thesis = "thesis");
