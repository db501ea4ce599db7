//! Sound for worlds made of implicit surfaces.
pub mod audio;
#[cfg(feature = "cli")]
pub mod cli;
pub mod error;
#[cfg(feature = "experiment")]
pub mod experiment;
pub mod gpu;
pub mod offline;
pub mod output;
#[cfg(feature = "experiment")]
pub mod picture;
pub mod reference;
pub mod scene;
pub mod trace;

pub use error::Error;
pub use scene::{Listener, Scene, Shape, Source, Surface};
pub use trace::{Frame, Panning, Profile, Settings, Tracer};
