//! Sound for worlds made of implicit surfaces.
//!
//! Echomarch traces sound waves through a scene given as a signed distance function, by sphere tracing in fragment
//! shaders. It computes one panning value per frame from the waves that reach a listener. It is a faithful port of P.
//! Sjöberg, *Real-Time Audio Simulation with Implicit Surfaces using Sphere Tracing on the GPU* (University of Skövde,
//! 2011), to OpenGL 3.3 and OpenGL ES 3.0. It needs no window: contexts come from EGL or OSMesa, on a graphics card or
//! on Mesa's software renderer.
//!
//! First make a [`Context`](gl::Context) and a [`Tracer`] on it. Then trace a [`Scene`] with
//! [`Settings`], frame by frame: each [`Frame`] describes the sound that arrives at the listener.
//!
//! ```
//! use echomarch::gl::{Context, ContextOptions};
//! use echomarch::{Scene, Settings, Tracer};
//!
//! let context = Context::headless(&ContextOptions::default())?;
//! println!("renderer: {}", context.renderer());
//! let scene = Scene::builtin("corner")?;
//! let settings = Settings::default().with_waves(4096).with_iterations(4);
//! let frame = Tracer::new(&context)?.frame(&scene, &settings)?;
//!
//! assert!(frame.counts.listener_hits > 0);
//! let pan = frame.panning.pan(); // -1 left, 0 the middle, 1 right
//! assert!((-1.0..=1.0).contains(&pan));
//! # Ok::<(), echomarch::Error>(())
//! ```
//!
//! World axes: x to the right, y up, z towards the viewer (right-handed). World units are
//! metres, angles are radians in code and degrees in scene files.
//!
//! # Modules
//! | module | contents |
//! | --- | --- |
//! | [`scene`] | surfaces, source, listener, paths; RON files; distances |
//! | [`tracer`] | settings, the [`Tracer`], one [`Frame`], [`Panning`] |
//! | [`response`] | the [`Response`](response::Response) of a scene: exact specular paths, echogram, the figures of ISO 3382-1, impulse responses |
//! | [`hrtf`] | head-related impulse responses |
//! | [`gl`] | contexts without a window, and the available renderers |
//! | `audio` | sounds, panning laws, mixer, WAV files (feature `audio`); `audio::live`: live sound (feature `live`) |
//! | `auralisation` | the sound of a source as a listener hears it (feature `audio`) |
//! | `offline` | sound of a moving scene, without a sound card (feature `audio`) |
//! | `simulator` | for games: a world of sources and surfaces, traced on a thread of its own (feature `simulator`, not in browsers) |
//! | `geometry` | reference tracing of waves in `f64` on the CPU (feature `reference`) |
//! | `picture` | the listener's view, and the plan with paths (feature `picture`) |
//! | [`error`] | the error type |
//!
//! # Untrusted scenes
//! A scene may contain its own GLSL. The driver compiles it within this process, where it can end the process, fill its
//! memory or never return. Such scenes are refused until the program chooses where their fields are tested: trusted
//! GLSL in this process, other GLSL in a child process first. See [`tracer::FieldTrial`].
//!
//! # Features
//! No feature is on by default: `cargo add echomarch` gives scenes, the tracer and responses.
//!
//! | feature | adds |
//! | --- | --- |
//! | `audio` | sounds, panning laws, mixer, WAV files; the sound of responses (`auralisation`), and of moving scenes (`offline`) |
//! | `live` | live output through a sound card, and the feature `audio` |
//! | `meshes` | triangle meshes from OBJ and glTF files |
//! | `picture` | pictures and plans of scenes as PNG |
//! | `reference` | exact references: waves in closed form, and the image sources of a rectangular room |
//! | `simulator` | the simulator for games |
//! | `sofa` | head-related impulse responses and directivities from SOFA files, impulse responses as SOFA files |
//! | `window` | contexts of windows on X11 and Wayland, for the program's own window |
//!
//! The program, its experiments and studies, and its window are separate packages, under `apps/`.
//!
//! # Threads
//! Scenes, settings, frames and everything in `audio` may move between threads. A [`gl::Context`], and with it a
//! [`Tracer`], stays on the thread that made it:
//!
//! ```compile_fail,E0277
//! fn may_move<T: Send>() {}
//! may_move::<echomarch::Tracer>();
//! ```

#[macro_use]
mod macros;

mod arrival;
#[cfg(feature = "audio")]
pub mod audio;
#[cfg(feature = "audio")]
pub mod auralisation;
pub mod bands;
pub mod error;
mod file_input;
mod file_output;
#[cfg(not(feature = "reference"))]
mod geometry;
#[cfg(feature = "reference")]
pub mod geometry;
pub mod gl;
pub mod hrtf;
#[doc(hidden)]
pub mod internals;
#[cfg(feature = "audio")]
pub mod offline;
#[cfg(feature = "picture")]
pub mod picture;
mod platform;
mod resample;
pub mod response;
mod ron_error;
mod sampling;
pub mod scene;
mod serialised;
mod shader;
#[cfg(all(feature = "simulator", not(target_arch = "wasm32")))]
pub mod simulator;
mod sphere_cells;
mod text;
pub mod tracer;
mod wave_budget;

/// Code shared with the integration tests refers to the crate by its name.
#[cfg(test)]
extern crate self as echomarch;
#[cfg(test)]
mod test_common;

/// Checks the rules for threads above at compile time.
const _: () = {
    const fn may_move<T: Send>() {}
    may_move::<Scene>();
    may_move::<Settings>();
    may_move::<Frame>();
    may_move::<Error>();
};

pub use error::Error;
pub use glam;
#[doc(hidden)]
pub use scene::Node;
pub use scene::{Listener, Pair, Scene, Shape, Source, Surface};
pub use tracer::{Frame, Panning, Profile, Settings, Tracer};
