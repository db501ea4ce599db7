//! Abilities of the platform: a native program has files and may wait, a page in a browser can do neither.
//!
//! These names determine everything that differs in a browser (`wasm32-unknown-unknown`), together with the modules
//! that `gpu` leaves out there. `rayon` runs on the only thread.

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use std::time::Instant;
/// In a browser the standard library's clock panics; this one uses the browser's.
#[cfg(target_arch = "wasm32")]
pub(crate) use web_time::Instant;

/// Whether files exist.
pub(crate) const HAS_FILES: bool = !cfg!(target_arch = "wasm32");

/// Whether OpenGL can be waited for, by a fence or `glFinish`: WebGL signals fences only between two turns of the
/// browser's event loop, and treats `finish` like a flush.
pub(crate) const CAN_WAIT_FOR_GL: bool = !cfg!(target_arch = "wasm32");

/// Usage hint of the buffers for reading texels back. Chromium keeps a second copy of buffers with a read hint, and
/// warns in its console if one is read without waiting for a fence.
pub(crate) const READ_BACK_USAGE: u32 = match CAN_WAIT_FOR_GL {
    true => glow::STREAM_READ,
    false => glow::STREAM_COPY,
};

/// Whether OpenGL's buffers can be mapped into memory: those of WebGL are copied.
pub(crate) const CAN_MAP_BUFFERS: bool = !cfg!(target_arch = "wasm32");
