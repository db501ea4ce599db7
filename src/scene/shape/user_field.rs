//! A user's field: GLSL text with a `float field(vec3 p)`, and optionally a
//! `vec3 fieldGradient(vec3 p)`.
//!
//! Only a GPU can evaluate it. For its own questions (whether the source is in a solid, where a
//! walker may go) the CPU uses samples, which are taken once on the GPU when the field is checked;
//! see `crate::trace`.

use super::parameter::Numbers;
use super::{Parameter, user_glsl};
use crate::scene::Quantity;
use glam::{DVec3, Vec3};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// A user's field, with its stated properties.
#[derive(Debug)]
pub struct UserField {
    /// The file of the text, or another name for reports.
    pub file: PathBuf,
    /// GLSL with a `float field(vec3 p)`; helpers, constants and macros are allowed. A
    /// `vec3 fieldGradient(vec3 p)` states its gradient, in units of the value per metre.
    pub text: String,
    /// Full size in metres of the box about the origin that it fills: it is cut off there, and
    /// never evaluated outside.
    pub size: Vec3,
    /// Lipschitz constant of its value, in metres per metre.
    pub lipschitz: f32,
    samples: OnceLock<Arc<UserSamples>>,
    read: OnceLock<Read>,
    evaluation_seconds: OnceLock<f64>,
}

/// Properties of the text that every frame needs: it is read only once.
#[derive(Clone, Copy, Debug, Default)]
struct Read {
    has_loops: bool,
    states_gradient: bool,
}

/// The values of a field on a grid over its box, edges included.
#[derive(Clone, Debug, PartialEq)]
pub struct UserSamples {
    /// Samples along each side.
    pub side: usize,
    /// The values: x runs fastest, then y, then z.
    pub values: Vec<f32>,
}

impl UserField {
    /// A field from text; `file` is its name in reports.
    pub fn new(file: impl Into<PathBuf>, text: String, size: Vec3, lipschitz: f32) -> UserField {
        UserField {
            file: file.into(),
            text,
            size,
            lipschitz,
            samples: OnceLock::new(),
            read: OnceLock::new(),
            evaluation_seconds: OnceLock::new(),
        }
    }

    /// Rejects an empty box, and a Lipschitz constant out of range.
    ///
    /// # Errors
    /// A message that states the valid range.
    pub(super) fn check_numbers(&self) -> Result<(), String> {
        let mut size = self.size;
        let mut sides = Vec::new();
        size.add_to("size", Quantity::Length, &mut sides);
        sides.iter().try_for_each(Parameter::check)?;
        if self.lipschitz >= 1e-3 && self.lipschitz <= 1e6 {
            return Ok(());
        }
        let value = self.lipschitz;
        Err(format!("its lipschitz must be 0.001 to 1e6, not {value}"))
    }

    /// Stores the samples from the GPU; later calls change nothing.
    pub(crate) fn set_samples(&self, samples: Arc<UserSamples>) {
        // The same text over the same box has the same samples.
        let _ = self.samples.set(samples);
    }

    /// The samples from the GPU, once they were taken.
    pub(crate) fn samples(&self) -> Option<&Arc<UserSamples>> {
        self.samples.get()
    }

    /// Stores the time of an evaluation; later calls change nothing.
    pub(crate) fn set_evaluation_seconds(&self, seconds: f64) {
        // Another measurement of the same text gives the same time, apart from the load.
        let _ = self.evaluation_seconds.set(seconds);
    }

    /// Seconds per evaluation on the renderer, with many running in parallel, once that was
    /// measured.
    pub(crate) fn evaluation_seconds(&self) -> Option<f64> {
        self.evaluation_seconds.get().copied()
    }

    /// Whether the text is built into the program.
    pub(crate) fn is_own(&self) -> bool {
        crate::scene::builtin::is_own_text(&self.text)
    }

    /// The value interpolated from the samples (trilinear), clamped to the box; 0 before there are
    /// any.
    pub fn value(&self, point: DVec3) -> f64 {
        let Some(samples) = self.samples.get() else {
            return 0.0;
        };
        let share = point / self.size.as_dvec3() + 0.5;
        samples.at(share)
    }

    /// The text for use within a shader, line by line: in ASCII, with macros expanded, and without
    /// directives and `precision` statements, which belong to the whole shader. Empty for a text
    /// that [`UserField::check_text`] rejects.
    pub fn shader_text(&self) -> String {
        user_glsl::read(&self.text).map_or_else(|_| String::new(), |text| text.code)
    }

    /// Checks everything that can be checked without compiling.
    ///
    /// # Errors
    /// The line, if the error is in one, and a message: the text lacks a `float field(vec3 p)`,
    /// needs a value from outside, does something that a function of one point cannot do, or
    /// exceeds the limits that protect compilers.
    pub fn check_text(&self) -> Result<(), (Option<u32>, String)> {
        user_glsl::read(&self.text).map(|_| ())
    }

    /// Whether the text contains loops, as far as it can be read.
    pub fn has_loops(&self) -> bool {
        self.read().has_loops
    }

    /// Whether the text states its gradient: `vec3 fieldGradient(vec3 p)`.
    pub fn states_gradient(&self) -> bool {
        self.read().states_gradient
    }

    fn read(&self) -> Read {
        let read = |text: user_glsl::Text| Read {
            has_loops: text.has_loops,
            states_gradient: text.states_gradient,
        };
        *self
            .read
            .get_or_init(|| user_glsl::read(&self.text).map(read).unwrap_or_default())
    }

    /// All names in the text that are not GLSL's own: they are renamed when it is included in a
    /// shader, so that fields do not clash with each other or with the shader around them. Empty
    /// for a text that [`UserField::check_text`] rejects.
    pub fn names(&self) -> Vec<String> {
        user_glsl::read(&self.text).map_or_else(|_| Vec::new(), |text| text.names)
    }
}

impl PartialEq for UserField {
    fn eq(&self, other: &UserField) -> bool {
        self.has_text_of(other) && self.file == other.file
    }
}

impl UserField {
    /// Whether the two are equal, wherever their files are.
    pub(crate) fn has_text_of(&self, other: &UserField) -> bool {
        self.text == other.text && self.size == other.size && self.lipschitz == other.lipschitz
    }
}

impl UserSamples {
    /// Trilinear value at 0 to 1 along each side, clamped at the edges.
    fn at(&self, share: DVec3) -> f64 {
        let last = (self.side - 1) as f64;
        let place = (share * last).clamp(DVec3::ZERO, DVec3::splat(last));
        let cell = place.floor().min(DVec3::splat(last - 1.0));
        let within = place - cell;
        let [x, y, z] = cell.to_array().map(|c| c as usize);
        let mut value = 0.0;
        for corner in 0..8 {
            let bit = |axis: usize| (corner >> axis) & 1;
            let weight = |axis: usize| {
                if bit(axis) == 1 {
                    within[axis]
                } else {
                    1.0 - within[axis]
                }
            };
            let index = ((z + bit(2)) * self.side + y + bit(1)) * self.side + x + bit(0);
            value += weight(0) * weight(1) * weight(2) * f64::from(self.values[index]);
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the CPU's values of a field: the interpolated samples.
    #[test]
    fn samples_are_interpolated() {
        let size = Vec3::new(2.0, 4.0, 8.0);
        let field = UserField::new("x", String::new(), size, 1.0);
        assert_eq!(field.value(DVec3::ZERO), 0.0);
        let values = (0..8).map(|i| [0.0, 1.0][i & 1]).collect();
        field.set_samples(Arc::new(UserSamples { side: 2, values }));
        assert_eq!(field.value(DVec3::ZERO), 0.5);
        assert_eq!(field.value(DVec3::X * 5.0), 1.0);
        assert_eq!(field.value(DVec3::new(-0.5, 2.0, 1.0)), 0.25);
        let squares = (0..27).map(|i| [0.0, 1.0, 4.0][i % 3]).collect();
        let finer = UserField::new("x", String::new(), size, 1.0);
        finer.set_samples(Arc::new(UserSamples {
            side: 3,
            values: squares,
        }));
        assert_eq!(finer.value(DVec3::ZERO), 1.0);
        assert_eq!(finer.value(DVec3::new(0.5, 0.3, -2.0)), 2.5);
    }
}
