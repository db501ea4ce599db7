//! The driver's description of a context, the detection of software renderers, the lookup of GL functions, and the
//! errors in shader logs.

use super::backend::Backend;
use super::{Api, GpuError};
use glow::HasContext;
#[cfg(not(target_arch = "wasm32"))]
use std::ffi::{CStr, CString, c_char, c_void};
#[cfg(not(target_arch = "wasm32"))]
use std::ptr;

/// The extension that lets OpenGL ES draw into float textures.
const FLOAT_TARGETS: &str = "GL_EXT_color_buffer_float";

/// The driver's limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Longest side of a texture, in texels.
    pub max_texture_size: u32,
    /// Maximum uniforms of a fragment shader, in vectors of four.
    pub max_fragment_uniform_vectors: u32,
    /// Maximum outputs of a fragment shader.
    pub max_draw_buffers: u32,
    /// Maximum textures of a framebuffer.
    pub max_color_attachments: u32,
}

impl Limits {
    /// Maximum textures that one pass can write to: at least four.
    pub fn most_outputs(&self) -> u32 {
        self.max_draw_buffers.min(self.max_color_attachments)
    }
}

/// glGetGraphicsResetStatus, or the function of the same purpose in an extension.
type ResetStatus = unsafe extern "system" fn() -> u32;

/// A driver's description of one context.
pub(super) struct Driver {
    pub renderer: String,
    pub vendor: String,
    pub version: String,
    pub shading_language: String,
    pub limits: Limits,
    /// The function that reports resets, if the driver has one.
    pub reset_status: Option<ResetStatus>,
}

impl Driver {
    /// Queries the driver; requires that the context is current.
    ///
    /// # Errors
    /// [`GpuError::MissingExtension`].
    pub fn ask(backend: &dyn Backend, gl: &glow::Context, api: Api) -> Result<Driver, GpuError> {
        // SAFETY: the context is current, and the queried strings exist in every version.
        let text = |name| unsafe { gl.get_parameter_string(name) };
        let renderer = text(backend.renderer_parameter(gl));
        if api == Api::Gles && !has_float_targets(gl) {
            return Err(GpuError::MissingExtension {
                extension: FLOAT_TARGETS,
                renderer,
            });
        }
        Ok(Driver {
            renderer,
            vendor: text(glow::VENDOR),
            version: text(glow::VERSION),
            shading_language: text(glow::SHADING_LANGUAGE_VERSION),
            limits: limits(gl, api),
            reset_status: reset_status(backend, gl, api),
        })
    }
}

/// Whether OpenGL ES can draw into float textures; WebGL's extension names lack the prefix `GL_`.
fn has_float_targets(gl: &glow::Context) -> bool {
    let names = [FLOAT_TARGETS, FLOAT_TARGETS.trim_start_matches("GL_")];
    let known = gl.supported_extensions();
    names.iter().any(|name| known.contains(*name))
}

/// The function that reports resets, from one of the context's extensions.
fn reset_status(backend: &dyn Backend, gl: &glow::Context, api: Api) -> Option<ResetStatus> {
    let of_khr = match api {
        Api::Gles => c"glGetGraphicsResetStatusKHR",
        Api::Gl | Api::OsMesa => c"glGetGraphicsResetStatus",
    };
    let names = [
        ("GL_KHR_robustness", of_khr),
        ("GL_ARB_robustness", c"glGetGraphicsResetStatusARB"),
        ("GL_EXT_robustness", c"glGetGraphicsResetStatusEXT"),
    ];
    let has = |extension: &str| gl.supported_extensions().contains(extension);
    let (_, name) = names.into_iter().find(|(extension, _)| has(extension))?;
    let address = backend.proc_address(name);
    // SAFETY: the address is that of the function with this name, which takes no arguments and returns a GLenum, or
    // null.
    (!address.is_null()).then(|| unsafe { std::mem::transmute(address) })
}

fn limits(gl: &glow::Context, api: Api) -> Limits {
    // SAFETY: the context is current; an unknown limit leaves 0.
    let limit = |name: u32| u32::try_from(unsafe { gl.get_parameter_i32(name) }).unwrap_or(0);
    Limits {
        max_texture_size: limit(glow::MAX_TEXTURE_SIZE),
        max_fragment_uniform_vectors: match api {
            Api::Gles => limit(glow::MAX_FRAGMENT_UNIFORM_VECTORS),
            Api::Gl | Api::OsMesa => limit(glow::MAX_FRAGMENT_UNIFORM_COMPONENTS) / 4,
        },
        max_draw_buffers: limit(glow::MAX_DRAW_BUFFERS),
        max_color_attachments: limit(glow::MAX_COLOR_ATTACHMENTS),
    }
}

/// Loads the GL functions; requires that the context is current.
///
/// # Errors
/// [`GpuError::NoFunctions`].
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn load(backend: &dyn Backend) -> Result<glow::Context, GpuError> {
    check_version(backend).map_err(|reason| GpuError::NoFunctions { reason })?;
    let find = |name: &str| match CString::new(name) {
        Ok(name) => backend.proc_address(&name),
        Err(_) => ptr::null(),
    };
    let find_or_core = |name: &str| {
        let address = find(name);
        // On drivers without glGetQueryBufferObjectiv, glow reads timer queries with the function of an extension. The
        // core function without the suffix EXT does the same.
        if address.is_null() && name == "glGetQueryObjectui64vEXT" {
            find("glGetQueryObjectui64v")
        } else {
            address
        }
    };
    // SAFETY: the context is current, and the addresses are those of its library.
    Ok(unsafe { glow::Context::from_loader_function(find_or_core) })
}

/// Checks that the GL version can be parsed: glow panics otherwise.
#[cfg(not(target_arch = "wasm32"))]
fn check_version(backend: &dyn Backend) -> Result<(), String> {
    type GetString = unsafe extern "system" fn(u32) -> *const c_char;
    // SAFETY: the address is that of the function with this name, or null.
    let get = unsafe {
        std::mem::transmute::<*const c_void, Option<GetString>>(
            backend.proc_address(c"glGetString"),
        )
    };
    let get = get.ok_or("there is no glGetString")?;
    // SAFETY: the context is current.
    let version = unsafe { get(glow::VERSION) };
    if version.is_null() {
        return Err("GL_VERSION is null: no context is current".to_owned());
    }
    // SAFETY: GL returns a text that ends in zero.
    let version = unsafe { CStr::from_ptr(version) }.to_string_lossy();
    match has_numbers(&version) {
        true => Ok(()),
        false => Err(format!("GL_VERSION is {version:?}, without a number")),
    }
}

/// Whether the version text has two numbers in the expected position: `4.6 …`, `OpenGL ES 3.2 …`.
#[cfg(not(target_arch = "wasm32"))]
fn has_numbers(version: &str) -> bool {
    let numbers = version.rsplit(" ES ").next().unwrap_or(version);
    let mut parts = numbers.split(' ').next().unwrap_or_default().split('.');
    let is_number = |part: Option<&str>| part.is_some_and(|part| part.parse::<u32>().is_ok());
    is_number(parts.next()) && is_number(parts.next()) && version.is_ascii()
}

/// One error in a driver's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogError {
    /// The source number set by `#line`; 0 before the first `#line`.
    pub file: u32,
    /// The line number set by `#line`.
    pub line: u32,
    /// The driver's message.
    pub message: String,
}

/// The errors in a log, in order; lines of an unknown form are skipped.
///
/// Known forms are Mesa's `2:12(5): error: ...`, NVIDIA's `2(12) : error C1008: ...` and ANGLE's `ERROR: 2:12: ...`.
/// Warnings are skipped.
pub fn log_errors(log: &str) -> Vec<LogError> {
    log.lines().filter_map(log_error).collect()
}

fn log_error(line: &str) -> Option<LogError> {
    let line = line.trim();
    let (file, rest) = number(line.strip_prefix("ERROR:").unwrap_or(line).trim_start())?;
    let (line, rest) = if let Some(rest) = rest.strip_prefix('(') {
        let (line, rest) = number(rest)?;
        (line, rest.strip_prefix(')')?)
    } else {
        let (line, rest) = number(rest.strip_prefix(':')?)?;
        let column = rest.strip_prefix('(').and_then(|r| r.split_once(')'));
        (line, column.map_or(rest, |(_, rest)| rest))
    };
    let mut message = rest.trim_start().strip_prefix(':')?.trim();
    if message.starts_with("warning") {
        return None;
    }
    if let Some(rest) = message.strip_prefix("error") {
        // NVIDIA puts an error code before the message.
        message = rest.split_once(':').map_or(rest, |(_, rest)| rest).trim();
    }
    let message = message.replace('`', "'");
    Some(LogError {
        file,
        line,
        message,
    })
}

/// The number at the beginning of the text, and the rest.
fn number(text: &str) -> Option<(u32, &str)> {
    let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (number, rest) = text.split_at(digits);
    Some((number.parse().ok()?, rest))
}

/// Parts of the names of renderers that run on the processor, in lower case.
const SOFTWARE_RENDERERS: [&str; 12] = [
    // Mesa's; also as "zink (llvmpipe ...)" and "virgl (LLVMPIPE ...)".
    "llvmpipe",
    "lavapipe",
    "softpipe",
    "swrast",
    "software rasterizer",
    "openswr",
    "swr (",
    // ANGLE and Vulkan in browsers.
    "swiftshader",
    "apple software renderer",
    // WARP, through ANGLE or as Mesa's "D3D12 (Microsoft Basic Render Driver)".
    "microsoft basic render driver",
    "warp",
    // Windows without a driver: OpenGL 1.1.
    "gdi generic",
];

/// Whether the renderer of this name runs on the processor.
pub(super) fn is_software(renderer: &str) -> bool {
    let renderer = renderer.to_lowercase();
    SOFTWARE_RENDERERS
        .iter()
        .any(|name| renderer.contains(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects callers that pass functions other than OpenGL's: they get an error, not a panic.
    #[test]
    fn versions_without_numbers_are_known() {
        for version in [
            "4.6 (Core Profile) Mesa",
            "OpenGL ES 3.2 Mesa 22.3.6",
            "3.3.0",
        ] {
            assert!(has_numbers(version), "{version}");
        }
        for version in [
            "",
            "4",
            "4 6",
            "OpenGL ES",
            "four.five",
            "OpenGL ES x.2",
            "4.6 \u{e9}",
        ] {
            assert!(!has_numbers(version), "{version}");
        }
    }

    /// Protects the line numbers of errors in the logs of all drivers.
    #[test]
    fn errors_are_found_in_every_known_form() {
        let log = "2:3(1): warning: 'x' is never used\n2:12(5): error: `foo' undeclared\n\
            2(13) : error C1008: undefined variable \"bar\"\n2(14) : warning C7011: implicit\n\
            ERROR: 4:15: 'baz' : undeclared identifier\nsome more";
        let expected = [
            (2, 12, "'foo' undeclared"),
            (2, 13, "undefined variable \"bar\""),
            (4, 15, "'baz' : undeclared identifier"),
        ];
        let errors = log_errors(log);
        let found: Vec<_> = errors
            .iter()
            .map(|e| (e.file, e.line, e.message.as_str()))
            .collect();
        assert_eq!(found, expected);
    }

    /// Protects the detection of software renderers by name: times on these renderers come from the wall clock instead
    /// of timer queries, and tests compare their results with golden values instead of tolerances.
    #[test]
    fn software_renderers_are_known_by_name() {
        for software in [
            "llvmpipe (LLVM 15.0.6, 256 bits)",
            "zink (llvmpipe (LLVM 15.0.6, 256 bits))",
            "zink Vulkan 1.3(llvmpipe (LLVM 19.1.7, 256 bits) (MESA_LLVMPIPE))",
            "virgl (LLVMPIPE (LLVM 15.0.6, 256 bits))",
            "softpipe",
            "SWR (LLVM 10.0, AVX2)",
            "Software Rasterizer",
            "Google SwiftShader",
            "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)",
            "ANGLE (Microsoft, Microsoft Basic Render Driver Direct3D11 vs_5_0 ps_5_0)",
            "D3D12 (Microsoft Basic Render Driver)",
            "Apple Software Renderer",
            "GDI Generic",
        ] {
            assert!(is_software(software), "{software}");
        }
        for hardware in [
            "NVIDIA H200/PCIe/SSE2",
            "Mesa Intel(R) UHD Graphics 620 (KBL GT2)",
            "AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6, DRM 3.49)",
            "zink Vulkan 1.3(NVIDIA GeForce RTX 4090 (NVIDIA_PROPRIETARY))",
            "virgl (AMD Radeon RX 6800 (radeonsi, navi21))",
            "Apple M2 Pro",
            "ANGLE (Intel, Intel(R) UHD Graphics 620 Direct3D11 vs_5_0 ps_5_0, D3D11)",
        ] {
            assert!(!is_software(hardware), "{hardware}");
        }
    }
}
