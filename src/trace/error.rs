//! What can go wrong between settings and a frame.

use glam::Vec3;

/// A frame that cannot be traced, and why.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A setting outside its range.
    #[error("{what} must be {must}, not {value}")]
    BadSetting {
        /// Which setting, with its unit.
        what: &'static str,
        /// Its range.
        must: String,
        /// What was asked for.
        value: String,
    },
    /// More waves than the renderer's textures hold.
    #[error(
        "{waves} waves need a texture of {side} texels a side, and {renderer} allows {limit}: use at most {most} waves"
    )]
    TooManyWaves {
        /// Waves asked for.
        waves: u32,
        /// Side of the texture that they need.
        side: u32,
        /// The renderer's limit.
        limit: u32,
        /// Waves that fit.
        most: u64,
        /// The renderer's name.
        renderer: String,
    },
    /// More surface parameters than the renderer's uniforms hold.
    #[error(
        "the scene's {surfaces} surfaces need {needed} uniform vectors, and {renderer} has {limit}: use fewer surfaces"
    )]
    TooManySurfaces {
        /// Surfaces in the scene.
        surfaces: usize,
        /// Uniform vectors that they need.
        needed: usize,
        /// Uniform vectors that the renderer has.
        limit: usize,
        /// The renderer's name.
        renderer: String,
    },
    /// A user's field that is none, or does not compile.
    #[error("{}: {message}", located(file, *line))]
    FieldDoesNotCompile {
        /// The field's file.
        file: String,
        /// The line, counted from 1, where there is one.
        line: Option<u32>,
        /// What the driver says, or what is missing.
        message: String,
    },
    /// A user's field whose value is not a number somewhere.
    #[error(
        "{file}: the value at ({:.3}, {:.3}, {:.3}) is {value}: it must be finite everywhere in its box",
        place.x, place.y, place.z
    )]
    FieldNotFinite {
        /// The field's file.
        file: String,
        /// Where, in metres, in the field's own axes.
        place: Vec3,
        /// The value there.
        value: f32,
    },
    /// A user's field that grows faster than it promises.
    #[error(
        "{file}: the value grows by {growth:.3} a metre at ({:.3}, {:.3}, {:.3}), more than the stated lipschitz of {stated}: {}",
        place.x, place.y, place.z, remedy(*growth, *stated)
    )]
    FieldGrows {
        /// The field's file.
        file: String,
        /// Where, in metres, in the field's own axes.
        place: Vec3,
        /// The growth found there, in metres a metre.
        growth: f32,
        /// The growth stated.
        stated: f32,
    },
    /// Waves were asked for before any frame was traced.
    #[error("no frame was traced yet")]
    NothingTraced,
}

fn located(file: &str, line: Option<u32>) -> String {
    match line {
        Some(line) => format!("{file}:{line}"),
        None => file.to_owned(),
    }
}

/// Beyond this growth in multiples of the stated one a jump is likelier than a steep slope.
const JUMP: f32 = 100.0;

fn remedy(growth: f32, stated: f32) -> String {
    if growth > JUMP * stated {
        return "it seems to jump there, and a field must be continuous".to_owned();
    }
    format!("state at least {:.3}", 1.01 * growth)
}
