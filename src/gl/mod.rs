//! OpenGL contexts without a window, and the available renderers.
//!
//! A [`Tracer`](crate::Tracer) computes with a [`Context`], by fragment shaders alone: OpenGL 3.3 core or OpenGL ES 3.0
//! with `EXT_color_buffer_float`, on a graphics card or on Mesa's software renderer.
//!
//! ```
//! use echomarch::gl::{Api, Context, ContextOptions, list_gpus};
//!
//! for gpu in list_gpus(Api::Gl)? {
//!     println!("{gpu}");
//! }
//! let context = Context::headless(&ContextOptions::default())?;
//! println!("{}, software: {}", context.renderer(), context.is_software());
//! # Ok::<(), echomarch::gl::GpuError>(())
//! ```
//!
//! # Ownership and threads
//! A [`Context`] is a counted reference and belongs to the thread that made it; neither a context nor anything made
//! with it can be sent to another thread. Everything made with a context holds a reference to it, so drop order does
//! not matter. Several contexts, also of different [`Api`]s, may be used in turn on one thread: every operation makes
//! its own context current first.
//!
//! # Cost
//! Making the current context current again costs one query to its library. Switching between contexts flushes the
//! previous context. Making a context takes some milliseconds with Mesa's llvmpipe. Reading texels back waits for all
//! drawing requested before. glGetError is always called after creation and read-back. It is called after each pass
//! only in debug builds, or if the environment has `ECHOMARCH_GL_CHECK=1`.
//!
//! All unsafe code of the crate that calls a driver is in this module.
//
// Private to the crate: programs, textures of four floats per texel, full-screen passes, read-back and timers. A pass
// reads textures and draws one triangle over a `RenderTarget`, whose texels are the results. A `PingPong` keeps two
// pairs of textures, so that a pass reads from one pair and writes to the other. Use the reference returned by
// `Context::gl` at once; call `Context::gl` again after using or dropping another context.
#![deny(clippy::undocumented_unsafe_blocks)]

mod async_read;
mod backend;
mod caller_context;
mod caller_state;
mod context;
#[cfg(not(target_arch = "wasm32"))]
mod current;
mod data_list;
#[cfg(not(target_arch = "wasm32"))]
mod devices;
mod driver;
#[cfg(all(unix, not(target_os = "macos")))]
mod egl;
mod error;
#[cfg(not(target_arch = "wasm32"))]
mod osmesa;
#[cfg(any(test, feature = "picture"))]
mod picture_target;
mod program;
mod render_target;
mod texture;
mod timer;
#[cfg(target_arch = "wasm32")]
mod web;
#[cfg(feature = "window")]
mod window;

// The system's library for contexts without a window.
#[cfg(target_os = "macos")]
mod cgl;
#[cfg(windows)]
mod wgl;
#[cfg(target_os = "macos")]
use cgl as native;
#[cfg(all(unix, not(target_os = "macos")))]
use egl as native;
#[cfg(target_arch = "wasm32")]
use web as current;
#[cfg(windows)]
use wgl as native;

pub(crate) use async_read::AsyncRead;
pub use caller_context::{MakeCurrent, SwitchContext};
pub use context::{Context, ContextOptions};
pub(crate) use data_list::{DataList, DataTexture};
#[cfg(not(target_arch = "wasm32"))]
pub use devices::{GpuInfo, Renderer, list_gpus};
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use driver::Limits;
pub(crate) use driver::log_errors;
pub use error::{Api, GpuError};
/// The OpenGL bindings, in the version that [`Context::from_glow`] takes.
pub use glow;
#[cfg(any(test, feature = "picture"))]
#[doc(hidden)]
pub use picture_target::Picture;
#[doc(hidden)]
pub use program::{Program, ProgramCache, header};
pub(crate) use render_target::{PingPong, RenderTarget, TexturePair};
#[doc(hidden)]
pub use render_target::{Target, full_screen_pass, full_screen_pass_rows};
pub(crate) use texture::Texture;
#[doc(hidden)]
pub use timer::GpuTimer;
#[cfg(feature = "window")]
#[doc(hidden)]
pub use window::{WindowContext, WindowDisplay};

#[cfg(test)]
pub(crate) mod tests;
