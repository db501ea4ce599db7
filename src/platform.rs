//! What the platform has: a native program has files and may wait, a page in a browser neither.
//!
//! Everything that differs in a browser (`wasm32-unknown-unknown`) is decided by these names, and by the modules that
//! `gpu` leaves out there. `rayon` runs on the one thread that there is.

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use std::time::Instant;
/// The standard library's clock stops a browser's program; this one uses the browser's.
#[cfg(target_arch = "wasm32")]
pub(crate) use web_time::Instant;

/// Whether a file's path leads to anything.
pub(crate) const HAS_FILES: bool = !cfg!(target_arch = "wasm32");

/// Whether OpenGL can be waited for, by a fence or `glFinish`: WebGL passes fences between two turns of the browser's
/// event loop alone, and takes `finish` for a flush.
pub(crate) const CAN_WAIT_FOR_GL: bool = !cfg!(target_arch = "wasm32");

/// What the buffers are for by which texels are read back. Chromium keeps a second copy of those that are read, and
/// complains in its console where one is not waited for by a fence.
pub(crate) const READ_BACK_USAGE: u32 = match CAN_WAIT_FOR_GL {
    true => glow::STREAM_READ,
    false => glow::STREAM_COPY,
};

/// Whether OpenGL's buffers can be mapped into memory: those of WebGL are copied.
pub(crate) const CAN_MAP_BUFFERS: bool = !cfg!(target_arch = "wasm32");
