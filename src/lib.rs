//! Sound for worlds made of implicit surfaces.
pub mod audio;
pub mod error;
pub mod gpu;
pub mod reference;
pub mod scene;

pub use error::Error;
pub use scene::{Listener, Scene, Shape, Source, Surface};
