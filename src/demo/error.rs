//! What keeps the window from being shown.

/// A window that cannot be shown, or has to be closed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DemoError {
    /// There is no display to show a window on.
    #[error("no display: {reason}; headless commands are trace, view, render")]
    NoDisplay {
        /// What is missing.
        reason: String,
    },
    /// The display is there, but shows no window.
    #[error("the display shows no window: {reason}")]
    NoWindow {
        /// What it answered.
        reason: String,
    },
    /// A scene, settings or a renderer that do not work.
    #[error(transparent)]
    Failed(#[from] crate::Error),
    /// What was to be written cannot be.
    #[error(transparent)]
    Write(#[from] crate::output::OutputError),
}

impl From<crate::gpu::GpuError> for DemoError {
    fn from(error: crate::gpu::GpuError) -> DemoError {
        DemoError::Failed(error.into())
    }
}
