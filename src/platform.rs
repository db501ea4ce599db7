//! Abilities of the platform: a native program has files and may wait, a page in a browser can do neither.
//!
//! These names determine everything that differs in a browser (`wasm32-unknown-unknown`), together with the modules
//! that `gl` leaves out there. `rayon` runs on the only thread.

#[cfg(not(target_arch = "wasm32"))]
pub use std::time::Instant;
/// The standard library's clock stops a browser's program; this one uses the browser's.
#[cfg(target_arch = "wasm32")]
pub use web_time::Instant;

/// Whether files exist.
pub const HAS_FILES: bool = !cfg!(target_arch = "wasm32");

/// Whether OpenGL can be waited for, by a fence or `glFinish`: WebGL signals fences only between two turns of the
/// browser's event loop, and its `finish` only flushes.
pub const CAN_WAIT_FOR_GL: bool = !cfg!(target_arch = "wasm32");

/// What the buffers are for by which texels are read back. Chromium keeps a second copy of those that are read, and
/// complains in its console where one is not waited for by a fence.
pub const READ_BACK_USAGE: u32 = match CAN_WAIT_FOR_GL {
    true => glow::STREAM_READ,
    false => glow::STREAM_COPY,
};

/// Whether OpenGL's buffers can be mapped into memory: those of WebGL are copied.
pub const CAN_MAP_BUFFERS: bool = !cfg!(target_arch = "wasm32");
