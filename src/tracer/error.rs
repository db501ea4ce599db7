//! Errors of tracing.

use crate::scene::UserField;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// The reason why a frame cannot be traced.
#[derive(Clone, Debug, Deserialize, Serialize, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A setting outside its range.
    #[serde(skip)]
    #[error("{what} must be {must}, not {value}")]
    BadSetting {
        /// The setting, with its unit.
        #[serde(skip)]
        what: &'static str,
        /// The range of the setting.
        must: String,
        /// The requested value.
        value: String,
    },
    /// More waves than the renderer's textures hold.
    #[error(
        "{waves} waves need a texture of {side} texels a side, and {renderer} allows {limit}: use at most {most} waves"
    )]
    TooManyWaves {
        /// Waves requested.
        waves: u32,
        /// Side of the texture that the waves need.
        side: u32,
        /// The renderer's limit.
        limit: u32,
        /// Maximum waves that fit.
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
        /// Uniform vectors that the surfaces need.
        needed: usize,
        /// Uniform vectors that the renderer has.
        limit: usize,
        /// The renderer's name.
        renderer: String,
    },
    /// A user's text that does not define a field, or does not compile.
    #[error("{}: {message}", located(file, *line))]
    FieldDoesNotCompile {
        /// The field's file.
        file: String,
        /// The line, counted from 1, if known.
        line: Option<u32>,
        /// The driver's message, or the part that the text lacks.
        message: String,
    },
    /// A user's field whose value is not finite at some point.
    #[error(
        "{file}: the value at ({:.3}, {:.3}, {:.3}) is {value}: it must be finite wherever waves can be, in the air and next to the surface",
        place.x, place.y, place.z
    )]
    FieldNotFinite {
        /// The field's file.
        file: String,
        /// The point, in metres, in the field's own axes.
        place: Vec3,
        /// The value at this point.
        value: f32,
    },
    /// A user's field whose function on the CPU differs from its text.
    #[error(
        "{file}: the function on the CPU is {cpu} at ({:.3}, {:.3}, {:.3}), where the text is {text}",
        place.x, place.y, place.z
    )]
    FieldDiffers {
        /// The field's file.
        file: String,
        /// The point, in metres, in the field's own axes.
        place: Vec3,
        /// The value of the text on the GPU.
        text: f64,
        /// The value of the function on the CPU.
        cpu: f64,
    },
    /// A user's field that grows faster than stated.
    #[error(
        "{file}: the value grows by {growth:.3} a metre at ({:.3}, {:.3}, {:.3}), more than the stated lipschitz of {stated}: {}",
        place.x, place.y, place.z, remedy(*advice, "it seems to jump there, and a field must be continuous")
    )]
    FieldGrows {
        /// The field's file.
        file: String,
        /// The point, in metres, in the field's own axes.
        place: Vec3,
        /// The rate of change of the value found at this point, per metre.
        growth: f32,
        /// The stated Lipschitz constant.
        stated: f32,
        /// The growth to state so that the checks accept the field; `None` if the value seems to jump.
        advice: Option<f32>,
    },
    /// A user's field whose value bends more than stated.
    #[error(
        "{file}: the value bends by {bend:.3} per metre at ({:.3}, {:.3}, {:.3}), more than the stated bend of {stated}: {}",
        place.x, place.y, place.z, remedy(*advice, "it seems to have an edge there, so leave bend out")
    )]
    FieldBends {
        /// The field's file.
        file: String,
        /// The point, in metres, in the field's own axes.
        place: Vec3,
        /// The amount by which the second derivative along a line at this point is below 0, per metre.
        bend: f32,
        /// The stated amount.
        stated: f32,
        /// The amount to state so that the checks accept the field; `None` at an edge.
        advice: Option<f32>,
    },
    /// A user's field whose stated gradient differs from the gradient of its value.
    #[error(
        "{file}: fieldGradient is ({:.4}, {:.4}, {:.4}) at ({:.3}, {:.3}, {:.3}), where the value grows by ({:.4}, {:.4}, {:.4}) a metre along x, y and z",
        stated.x, stated.y, stated.z, place.x, place.y, place.z, found.x, found.y, found.z
    )]
    FieldGradientOff {
        /// The field's file.
        file: String,
        /// The point, in metres, in the field's own axes.
        place: Vec3,
        /// The stated gradient, per metre.
        stated: Vec3,
        /// The gradient computed from differences of the value.
        found: Vec3,
    },
    /// A user's field that is evaluated too slowly.
    #[error(
        "{file}: an evaluation takes {:.1} µs on this renderer, more than {:.0} µs: a frame would take minutes",
        1e6 * seconds, 1e6 * limit
    )]
    FieldTooSlow {
        /// The field's file.
        file: String,
        /// Time per evaluation in seconds, with many evaluations in parallel.
        seconds: f64,
        /// The limit of this time, in seconds.
        limit: f64,
    },
    /// A user's field, although the calling program has not chosen how fields are tried. See
    /// [`FieldTrial`](super::FieldTrial).
    #[error(
        "{file}: users' fields are refused, because they are programs that can end or block this process: choose FieldTrial::InThisProcess for trusted texts, or FieldTrial::InChild for others"
    )]
    FieldRefused {
        /// The field's file.
        file: String,
    },
    /// A user's field that ended the process in which it was tried, or took too long there. See
    /// [`FieldTrial`](super::FieldTrial).
    #[error("{file}: its trial in a child process {how}")]
    FieldDies {
        /// The field's file, or the files of all fields if several were tried.
        file: String,
        /// How the process ended.
        how: String,
    },
    /// The process that tries users' fields could not be started, or gave no answer.
    #[error("the child process that tries fields {why}")]
    NoFieldTrial {
        /// A clause that describes the failure, with the process as its subject.
        why: String,
    },
    /// Arrivals were requested in a profile whose waves stop at the listener.
    #[error(
        "arrivals cannot be traced by the profile {profile}, whose waves stop at the listener: use hybrid or march"
    )]
    NoArrivals {
        /// The name of the profile.
        profile: String,
    },
    /// A scene with a mesh in the profile `thesis`.
    #[error(
        "meshes and Rooms cannot be traced by the profile thesis, which stops at its minimum distance from a surface: use hybrid or march"
    )]
    NoMeshes,
    /// A call to advance a frame, although no frame was begun, or the frame was already collected or dropped.
    #[error("there is no frame to advance: begin one first")]
    NoFrameBegun,
    /// Waves were requested before a frame was traced.
    #[error("no frame was traced yet")]
    NothingTraced,
}

impl TraceError {
    /// Rejects a text that cannot be a field, before it is compiled.
    pub(super) fn check_text(field: &UserField) -> Result<(), TraceError> {
        let refused = |(line, message)| TraceError::FieldDoesNotCompile {
            file: field.file.display().to_string(),
            line,
            message,
        };
        field.check_text().map_err(refused)
    }
}

fn located(file: &str, line: Option<u32>) -> String {
    match line {
        Some(line) => format!("{file}:{line}"),
        None => file.to_owned(),
    }
}

fn remedy(advice: Option<f32>, otherwise: &str) -> String {
    match advice {
        Some(number) => format!("state at least {number}"),
        None => otherwise.to_owned(),
    }
}
