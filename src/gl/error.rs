//! The supported OpenGL interfaces, and errors of the graphics driver.

use std::fmt;
use std::str::FromStr;

/// An OpenGL interface: the library that makes the context, and the language of the shaders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Api {
    /// OpenGL 3.3 core through EGL.
    #[default]
    Gl,
    /// OpenGL ES 3.0 with `EXT_color_buffer_float` through EGL.
    Gles,
    /// OpenGL 3.3 core through Mesa's off-screen library, on the processor; needs no EGL, device or display.
    OsMesa,
}

impl Api {
    /// All APIs, in order of preference.
    pub const ALL: [Api; 3] = [Api::Gl, Api::Gles, Api::OsMesa];
}

impl fmt::Display for Api {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Api::Gl => "gl",
            Api::Gles => "gles",
            Api::OsMesa => "osmesa",
        })
    }
}

impl FromStr for Api {
    type Err = GpuError;

    fn from_str(name: &str) -> Result<Self, GpuError> {
        let known = Api::ALL.into_iter().find(|api| api.to_string() == name);
        known.ok_or_else(|| GpuError::UnknownApi {
            name: name.to_owned(),
        })
    }
}

/// An error of the graphics driver, or an error in its use. Sizes are in texels unless stated otherwise.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// A name that no [`Api`] has.
    #[error("there is no GL API \"{name}\": use gl, gles or osmesa")]
    UnknownApi {
        /// The given name.
        name: String,
    },
    /// libEGL could not be loaded.
    #[error(
        "libEGL was not found: install it (on Debian the packages libegl1, libegl-mesa0 and libgl1-mesa-dri) or use the API osmesa"
    )]
    NoEglLibrary,
    /// The first libEGL found is incomplete.
    #[error(
        "the first libEGL that is found is incomplete ({reason}): make sure that the right one is found first (LD_LIBRARY_PATH), or use the API osmesa"
    )]
    StrangeEglLibrary {
        /// The missing function, or the reason why it is unusable.
        reason: String,
    },
    /// libEGL is present, but lists no device and opens no display without a device.
    #[error(
        "EGL lists no device ({reason}): install a driver (on Debian the packages libegl-mesa0 and libgl1-mesa-dri) or use the API osmesa"
    )]
    NoEglDevice {
        /// EGL's error.
        reason: String,
    },
    /// The requested device index is out of range.
    #[error("there is no GPU {asked}: {found} found, numbered from 0")]
    NoSuchGpu {
        /// The requested index, from 0.
        asked: usize,
        /// Number of devices.
        found: usize,
    },
    /// No device, or not the requested device, could make a context of this API.
    #[error("no context for the API {api} could be made: {reason}")]
    NoContext {
        /// The requested API.
        api: Api,
        /// The error of each device.
        reason: String,
    },
    /// A context that the caller made has a version below the lowest supported one.
    #[error("the context has version \"{version}\": OpenGL 3.3, or OpenGL ES 3.0, is required")]
    TooOld {
        /// GL_VERSION.
        version: String,
    },
    /// A context that the caller made, or its loader, has no OpenGL functions.
    #[error("there is no OpenGL in the context: {reason}")]
    NoFunctions {
        /// The missing part.
        reason: String,
    },
    /// libOSMesa could not be loaded.
    #[error("libOSMesa was not found ({reason}): install it (on Debian the package libosmesa6)")]
    NoOsMesaLibrary {
        /// The loader's error for the last name tried.
        reason: String,
    },
    /// The driver cannot draw into 32-bit float textures, or lacks another required extension.
    #[error(
        "{renderer} lacks the extension {extension}, which is needed: choose another GPU or the API gl"
    )]
    MissingExtension {
        /// The extension's name.
        extension: &'static str,
        /// GL_RENDERER.
        renderer: String,
    },
    /// The context can no longer be made current, or the driver has lost it.
    #[error("the GL context was lost: {reason}; make a new one")]
    ContextLost {
        /// The error of EGL or OSMesa.
        reason: String,
    },
    /// A shader did not compile.
    #[error("the {stage} shader \"{label}\" does not compile:\n{log}")]
    Compile {
        /// "vertex" or "fragment".
        stage: &'static str,
        /// The program's label.
        label: String,
        /// The driver's log, verbatim; line 1 is the first line of the given text.
        log: String,
    },
    /// A program did not link.
    #[error("the program \"{label}\" does not link:\n{log}")]
    Link {
        /// The program's label.
        label: String,
        /// The driver's log, verbatim.
        log: String,
    },
    /// A framebuffer cannot be drawn into.
    #[error("the framebuffer is incomplete: {reason}")]
    IncompleteFramebuffer {
        /// The GL status or the violated rule.
        reason: String,
    },
    /// A side of the texture is above the driver's limit.
    #[error("a texture of {width} × {height} texels is too large: this GPU allows {limit} a side")]
    TextureTooLarge {
        /// Width requested.
        width: u32,
        /// Height requested.
        height: u32,
        /// Longest side allowed.
        limit: u32,
    },
    /// A side of the texture is zero.
    #[error("a texture of {width} × {height} texels is empty: each side needs at least 1")]
    TextureEmpty {
        /// Width requested.
        width: u32,
        /// Height requested.
        height: u32,
    },
    /// The number of floats does not match the size of the texture.
    #[error("the texture requires {expected} floats, but {found} were given")]
    DataSize {
        /// 4 × width × height.
        expected: usize,
        /// Floats given.
        found: usize,
    },
    /// A read outside the target.
    #[error(
        "cannot read {width} × {rows} texels of attachment {attachment}: the target has {attachments} attachments of {target_width} × {target_height}"
    )]
    ReadOutOfRange {
        /// Attachment requested, from 0.
        attachment: usize,
        /// Columns requested.
        width: u32,
        /// Rows requested.
        rows: u32,
        /// Number of attachments.
        attachments: usize,
        /// Width of the target.
        target_width: u32,
        /// Height of the target.
        target_height: u32,
    },
    /// The driver ran out of memory.
    #[error("the GPU has no memory for {what}: request less at a time")]
    OutOfMemory {
        /// The operation that failed.
        what: String,
    },
    /// Any other error that GL reported.
    #[error("GL reported {code} in {what}: a fault of the program or the driver")]
    Gl {
        /// The operation that failed.
        what: String,
        /// The error's name, such as GL_INVALID_OPERATION.
        code: String,
    },
}

impl GpuError {
    /// Returns the error for a context of this API that cannot be made.
    pub(super) fn no_context(api: Api, reason: impl ToString) -> GpuError {
        let reason = reason.to_string();
        GpuError::NoContext { api, reason }
    }

    /// Returns the error for a lost context.
    pub(super) fn lost(reason: impl Into<String>) -> GpuError {
        let reason = reason.into();
        GpuError::ContextLost { reason }
    }

    /// Returns a function that converts GL's reason into the error for an object that GL cannot create.
    pub(super) fn not_created(what: impl Into<String>) -> impl Fn(String) -> GpuError {
        let what = what.into();
        move |code| GpuError::Gl {
            what: what.clone(),
            code,
        }
    }

    /// Adds to the failed operation that an earlier call may have caused the error.
    pub(super) fn or_earlier(mut self) -> GpuError {
        if let GpuError::OutOfMemory { what } | GpuError::Gl { what, .. } = &mut self {
            what.push_str(" (or an earlier call, whose error is reported here)");
        }
        self
    }

    /// Whether the user's request is the cause, and not the machine or the program: a GPU or an API that does not
    /// exist, or a texture of an impossible size.
    pub fn is_bad_input(&self) -> bool {
        matches!(
            self,
            Self::UnknownApi { .. }
                | Self::NoSuchGpu { .. }
                | Self::TextureTooLarge { .. }
                | Self::TextureEmpty { .. }
        )
    }
}

/// Maximum number of errors read from one context: a lost context may report errors forever.
pub(super) const ERRORS_AT_MOST: usize = 32;

/// The name of an error code of glGetError.
pub(super) fn code_name(code: u32) -> String {
    match code {
        glow::INVALID_ENUM => "GL_INVALID_ENUM".into(),
        glow::INVALID_VALUE => "GL_INVALID_VALUE".into(),
        glow::INVALID_OPERATION => "GL_INVALID_OPERATION".into(),
        glow::INVALID_FRAMEBUFFER_OPERATION => "GL_INVALID_FRAMEBUFFER_OPERATION".into(),
        glow::OUT_OF_MEMORY => "GL_OUT_OF_MEMORY".into(),
        glow::STACK_OVERFLOW => "GL_STACK_OVERFLOW".into(),
        glow::STACK_UNDERFLOW => "GL_STACK_UNDERFLOW".into(),
        glow::CONTEXT_LOST => "GL_CONTEXT_LOST".into(),
        other => format!("GL error 0x{other:04X}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the API names: the command line accepts every name that it prints.
    #[test]
    fn names_read_back() {
        for api in Api::ALL {
            assert_eq!(api.to_string().parse::<Api>().ok(), Some(api));
        }
        let error = "vulkan".parse::<Api>().unwrap_err();
        assert!(error.is_bad_input() && error.to_string().contains("osmesa"));
    }
}
