//! How to trace: the thesis' constants, and the numbers a user may change.

use super::TraceError;
use crate::kernel::Directions;
use std::fmt;
use std::str::FromStr;

/// The most waves in one frame: 2^24, a 4096 x 4096 texture pair.
pub const MAX_WAVES: u32 = 1 << 24;

/// The most iterations. A wave's two counters share one float of 24 bits, 12 each.
pub const MAX_ITERATIONS: u32 = 4095;

/// Evaluations of the distance in one march, at the most.
///
/// Every step of the thesis' march is at least the minimum distance long, so at its
/// own constants no wave takes more than 300 / 0.1 = 3000 of them. The bound lies
/// above that and keeps any other setting from hanging the GPU.
pub const MAX_STEPS: u32 = 4096;

/// Evaluations of the fields in one march, at the most. Relaxed steps and Newton's at the end
/// take some tens of them; what takes more grazes a surface.
pub const MAX_FIELD_STEPS: u32 = 1024;

/// Turns that `hybrid` takes a line past the copies of repetitions without end, or of more than
/// 1,024 cells, in one flight at the most. Two flights of so many turns fit a pass on llvmpipe.
/// Among turned boxes 3 m to 4 m apart 10 of 524,288 waves reach it, and others still meet a box
/// after hundreds of kilometres, where a float tells places to some centimetres.
pub const MAX_COPY_STEPS: u32 = 32_000;

/// Where a wave of `march` and `hybrid` counts as gone, in metres: far beyond what a
/// listener hears of, and well inside what `f32` can square.
const FAR: f32 = 1e9;

/// Iterations in one pass of `march` by default: more save no time that could be measured.
pub const MARCHES_PER_PASS: u32 = 8;

/// The largest distance that may be asked for, in metres: its square and the square of
/// what a wave moves on the way are still finite in `f32`.
const MAX_DISTANCE: f32 = 1e15;

/// Width of the shell of `march` by default, in metres: everywhere. Outside of a shell the
/// steps are Hart's, inside they are Newton's, which need a gradient each but are so few
/// that they were faster in every scene measured (docs/accuracy.md).
const EVERYWHERE: f32 = 1e8;

/// The algorithm that a wave is followed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Profile {
    /// Closed form where a surface has one. What people should use.
    Hybrid,
    /// Sphere tracing done right, for any distance function with a Lipschitz bound.
    March,
    /// Figures 8 and 9 of the thesis as they stand, with all they get wrong.
    Thesis,
}

/// Everything about a frame that is not the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The algorithm.
    pub profile: Profile,
    /// Number of waves, 1 … [`MAX_WAVES`].
    pub waves: u32,
    /// Marches of each wave, 1 … [`MAX_ITERATIONS`].
    pub iterations: u32,
    /// Chooses the random directions.
    pub seed: u32,
    /// How the start directions are chosen.
    pub directions: Directions,
    /// `thesis`: a surface is met below this distance. `march`: width of the shell about
    /// surfaces in which Newton's steps are taken, everywhere by default. `hybrid` has no
    /// use for it. In metres.
    pub min_distance: f32,
    /// A wave is dead beyond this distance in one iteration, in metres.
    pub max_distance: f32,
    /// `thesis`: each march starts this far along the direction, in metres.
    pub start_offset: f32,
    /// Step of difference normals to either side, in metres.
    pub normal_step: f32,
    /// `march`: normals of the surface met (`true`), or differences as in the thesis.
    pub exact_normals: bool,
    /// `march`: waves land on the surface (`true`), or stop in the shell as in the thesis.
    pub landing: bool,
    /// `march`: how much faster than the true distance the distance may grow; every step
    /// is divided by it.
    pub lipschitz: f32,
    /// `march`: every distance is multiplied by this. 1, but in tests of functions that
    /// over-estimate.
    #[doc(hidden)]
    pub distance_factor: f32,
    /// Iterations in one pass at the most; 1 is the thesis' way, more save texture traffic.
    /// A pass has no more than the [`Budget`](super::Budget) of the scene allows.
    pub iterations_per_pass: u32,
    /// Whether the panning texture is summed on the GPU and read back as one texel.
    pub sum_on_gpu: bool,
    /// Whether to count evaluations of the distance, in the place of zero-length passes
    /// and marches that reached the step limit.
    pub count_evaluations: bool,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings::hybrid()
    }
}

impl Settings {
    /// The thesis' constants (sections 3.2.3 and 4.2.3), at 65,536 waves and 8
    /// iterations. The text names no step for its normals; 0.01 m is what the
    /// reconstruction of its scenes was fitted with.
    pub fn thesis() -> Settings {
        Settings {
            profile: Profile::Thesis,
            waves: 65_536,
            iterations: 8,
            seed: 1,
            directions: Directions::Random,
            min_distance: 0.1,
            max_distance: 300.0,
            start_offset: 0.04,
            normal_step: 0.01,
            exact_normals: false,
            landing: false,
            lipschitz: 1.0,
            distance_factor: 1.0,
            iterations_per_pass: 1,
            sum_on_gpu: false,
            count_evaluations: false,
        }
    }

    /// Sphere tracing done right: Newton's steps everywhere, landing, exact normals, no end
    /// at 300 m, [`MARCHES_PER_PASS`] iterations in a pass. Otherwise as
    /// [`Settings::thesis`].
    pub fn march() -> Settings {
        Settings {
            profile: Profile::March,
            iterations_per_pass: MARCHES_PER_PASS,
            min_distance: EVERYWHERE,
            max_distance: FAR,
            exact_normals: true,
            landing: true,
            ..Settings::thesis()
        }
    }

    /// Closed form where a surface has one, all iterations in one pass, otherwise as
    /// [`Settings::march`].
    pub fn hybrid() -> Settings {
        Settings {
            profile: Profile::Hybrid,
            iterations_per_pass: MAX_ITERATIONS,
            ..Settings::march()
        }
    }

    /// The defaults of a profile.
    pub fn of(profile: Profile) -> Settings {
        match profile {
            Profile::Hybrid => Settings::hybrid(),
            Profile::March => Settings::march(),
            Profile::Thesis => Settings::thesis(),
        }
    }

    /// The same with another number of waves.
    pub fn with_waves(mut self, waves: u32) -> Settings {
        self.waves = waves;
        self
    }

    /// The same with another number of iterations.
    pub fn with_iterations(mut self, iterations: u32) -> Settings {
        self.iterations = iterations;
        self
    }

    /// The same with another seed.
    pub fn with_seed(mut self, seed: u32) -> Settings {
        self.seed = seed;
        self
    }

    /// The step limit: evaluations of the distance after which a march ends: as many as the
    /// distances allow, and never more than [`MAX_STEPS`]. In a scene with long lists of
    /// surfaces `march` may be left with fewer: see [`Budget`](super::Budget).
    pub fn step_limit(&self) -> u32 {
        if self.profile != Profile::Thesis {
            return MAX_STEPS;
        }
        let needed = (self.max_distance / self.min_distance).ceil() + 1.0;
        (needed as u32).clamp(1, MAX_STEPS)
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`TraceError::BadSetting`] with the name, the range and the value.
    pub fn validate(&self) -> Result<(), TraceError> {
        in_range("waves", self.waves, MAX_WAVES)?;
        in_range("iterations", self.iterations, MAX_ITERATIONS)?;
        positive("minimum distance in metres", self.min_distance)?;
        positive("maximum distance in metres", self.max_distance)?;
        positive("step of the normals in metres", self.normal_step)?;
        let stops_in_a_shell = match self.profile {
            Profile::Thesis => true,
            Profile::March => !self.landing,
            Profile::Hybrid => false,
        };
        if stops_in_a_shell && self.min_distance >= self.max_distance {
            return Err(bad(
                "minimum distance in metres",
                format!("less than the maximum distance of {}", self.max_distance),
                self.min_distance,
            ));
        }
        if !(self.lipschitz.is_finite() && self.lipschitz >= 1.0) {
            let must = "finite and at least 1".to_owned();
            return Err(bad("Lipschitz bound", must, self.lipschitz));
        }
        if self.max_distance > MAX_DISTANCE {
            let must = format!("{MAX_DISTANCE} at the most");
            return Err(bad("maximum distance in metres", must, self.max_distance));
        }
        positive("factor of the distance", self.distance_factor)?;
        in_range(
            "iterations in a pass",
            self.iterations_per_pass,
            MAX_ITERATIONS,
        )?;
        if !(self.start_offset.is_finite() && self.start_offset >= 0.0) {
            let must = "finite and not negative".to_owned();
            return Err(bad("start offset in metres", must, self.start_offset));
        }
        Ok(())
    }
}

impl Profile {
    /// Every profile there is.
    pub const ALL: [Profile; 3] = [Profile::Hybrid, Profile::March, Profile::Thesis];
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Profile::Hybrid => "hybrid",
            Profile::March => "march",
            Profile::Thesis => "thesis",
        })
    }
}

impl FromStr for Profile {
    type Err = String;
    fn from_str(name: &str) -> Result<Profile, String> {
        let known = Profile::ALL.iter().find(|p| p.to_string() == name);
        known.copied().ok_or_else(|| {
            let names = Profile::ALL.map(|p| p.to_string()).join(", ");
            format!("there is no profile {name:?}; there are: {names}")
        })
    }
}

fn in_range(what: &'static str, value: u32, most: u32) -> Result<(), TraceError> {
    if (1..=most).contains(&value) {
        return Ok(());
    }
    Err(bad(what, format!("1 to {most}"), value))
}

fn positive(what: &'static str, value: f32) -> Result<(), TraceError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(bad(what, "finite and greater than 0".to_owned(), value))
}

fn bad(what: &'static str, must: String, value: impl fmt::Display) -> TraceError {
    TraceError::BadSetting {
        what,
        must,
        value: value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the step limit: no result of the thesis' own constants reaches it.
    #[test]
    fn the_step_limit_leaves_the_thesis_alone() {
        let thesis = Settings::thesis();
        assert!(thesis.step_limit() as f32 > thesis.max_distance / thesis.min_distance);
        let tiny = Settings {
            min_distance: 1e-30,
            ..Settings::thesis()
        };
        assert_eq!(tiny.step_limit(), MAX_STEPS);
    }

    /// Protects the GPU from settings that make no sense.
    #[test]
    fn senseless_settings_are_refused() {
        let spoil: [fn(&mut Settings); 10] = [
            |s| s.waves = 0,
            |s| s.waves = MAX_WAVES + 1,
            |s| s.iterations = 0,
            |s| s.iterations = MAX_ITERATIONS + 1,
            |s| s.min_distance = 0.0,
            |s| s.max_distance = f32::INFINITY,
            |s| s.min_distance = 301.0,
            |s| s.start_offset = f32::NAN,
            |s| s.lipschitz = 0.5,
            // The constants of another profile under the thesis' name.
            |s| {
                *s = Settings {
                    profile: Profile::Thesis,
                    min_distance: 2.0 * FAR,
                    ..Settings::march()
                }
            },
        ];
        assert!(Settings::thesis().validate().is_ok());
        for (index, spoil) in spoil.iter().enumerate() {
            let mut settings = Settings::thesis();
            spoil(&mut settings);
            assert!(settings.validate().is_err(), "case {index}");
        }
    }
}
