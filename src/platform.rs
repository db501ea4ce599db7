//! Abilities of the platform: a native program can use files and block; a page in a browser can do neither.
//!
//! All differences in a browser (`wasm32-unknown-unknown`) follow from these constants and from the modules that `gl`
//! omits there. In a browser, `rayon` runs on the only thread.

#[cfg(not(target_arch = "wasm32"))]
pub use std::time::Instant;
/// The standard library's clock panics in a browser; this one uses the browser's clock.
#[cfg(target_arch = "wasm32")]
pub use web_time::Instant;

/// Whether files exist.
pub const HAS_FILES: bool = !cfg!(target_arch = "wasm32");

/// Whether the program can wait for OpenGL, by a fence or `glFinish`: WebGL signals fences only between two turns of
/// the browser's event loop, and its `finish` only flushes.
pub const CAN_WAIT_FOR_GL: bool = !cfg!(target_arch = "wasm32");

/// Whether a query of GL errors returns at once. In a browser it waits for the graphics process, which may draw a picture
/// first; errors are then queried only where texels are read back, which waits too.
pub const HAS_QUICK_ERRORS: bool = !cfg!(target_arch = "wasm32");

/// Whether a window keeps its picture until the next one is drawn. A browser keeps that of a canvas.
pub const KEEPS_PICTURE: bool = cfg!(target_arch = "wasm32");

/// The usage hint of the buffers for reading texels back. Chromium keeps a second copy of buffers that are read, and
/// logs a warning if a read does not wait for a fence.
pub const READ_BACK_USAGE: u32 = match CAN_WAIT_FOR_GL {
    true => glow::STREAM_READ,
    false => glow::STREAM_COPY,
};

/// Whether OpenGL's buffers can be mapped into memory; WebGL's buffers must be copied.
pub const CAN_MAP_BUFFERS: bool = !cfg!(target_arch = "wasm32");
