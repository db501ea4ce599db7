//! The one error type that everything public returns.

/// What can go wrong, by the room it went wrong in.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The graphics driver, or a shader.
    #[error(transparent)]
    Gpu(#[from] crate::gpu::GpuError),
}
