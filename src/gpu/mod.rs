//! OpenGL without acoustics: contexts with no window, programs, textures of four floats a texel, full-screen
//! passes, read-back and timers.
//!
//! Computation is done by fragment shaders alone, as on hardware of OpenGL 3.3 core or OpenGL ES 3.0 with
//! `EXT_color_buffer_float`: a pass reads textures, and draws one triangle over a [`RenderTarget`], whose texels
//! are the results. A [`PingPong`] keeps two pairs of textures, so that a pass reads from the one and writes to the
//! other.
//!
//! # Ownership and threads
//! A [`Context`] is a counted reference and belongs to the thread that made it; neither it nor anything made with
//! it can be sent to another thread. Programs, textures and targets hold a reference to their context, so they may
//! be dropped in any order. Several contexts, of different [`Api`]s too, may be used in turns on one thread: every
//! operation makes its own context current first. A reference got from [`Context::gl`] is for use at once; ask
//! for it again after anything that touched (or dropped) another context.
//!
//! # Cost
//! Making a context current that already is costs one comparison of pointers. Switching between contexts flushes
//! the one left. Making a context takes some milliseconds with Mesa's llvmpipe. Reading texels back waits for all the
//! drawing asked for before. glGetError is asked after each pass in debug builds, or where the environment has
//! `ECHOMARCH_GL_CHECK=1`; after creation and read-back always.
//!
//! All unsafe code of the crate that talks to a driver is in this module.
#![deny(clippy::undocumented_unsafe_blocks)]

mod api;
mod async_read;
mod backend;
mod bytes;
mod context;
mod current;
mod data_list;
mod data_texture;
mod egl;
mod error;
mod list;
mod log;
mod osmesa;
mod pass;
mod picture;
mod ping_pong;
mod program;
mod program_cache;
mod render_target;
mod texel_buffer;
mod texture;
mod timer;
#[cfg(feature = "demo")]
mod window;

pub use api::Api;
pub use async_read::AsyncRead;
pub use context::{Context, ContextOptions, Limits};
pub use data_list::DataList;
pub use data_texture::DataTexture;
pub use error::GpuError;
pub use list::{GpuInfo, Renderer, list_gpus};
pub use log::{LogError, log_errors};
pub use pass::{Target, full_screen_pass, full_screen_pass_rows};
pub use picture::Picture;
pub use ping_pong::{PingPong, TexturePair};
pub use program::{Program, header};
pub use program_cache::ProgramCache;
pub use render_target::RenderTarget;
pub use texture::Texture;
pub use timer::GpuTimer;
#[cfg(feature = "demo")]
pub use window::{WindowContext, WindowDisplay};
