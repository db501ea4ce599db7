//! Sound for worlds made of implicit surfaces.
pub mod audio;
pub mod error;
pub mod gpu;

pub use error::Error;
