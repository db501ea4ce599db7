//! Errors of the window.

/// An error that prevents the window from opening, or closes it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DemoError {
    /// No display is available for the window.
    #[error("no display: {reason}; all commands but demo run without one")]
    NoDisplay {
        /// The missing part of the system.
        reason: String,
    },
    /// The display exists but cannot show the window.
    #[error("cannot open a window: {reason}")]
    NoWindow {
        /// The display's error.
        reason: String,
    },
    /// The display server stopped while the window was open.
    #[error("the display server has gone, and the window with it")]
    DisplayGone {
        /// The measurements up to that time.
        report: Box<super::Report>,
    },
    /// A scene, settings or a renderer that cannot be used.
    #[error("{}", sentence(.0))]
    Failed(#[from] echomarch::Error),
    /// A recording that could not be completed.
    #[error("the recording is incomplete: {reason}")]
    Recording {
        /// The reason.
        reason: String,
    },
    /// An output that cannot be written.
    #[error(transparent)]
    Write(#[from] echomarch::internals::file_output::OutputError),
}

impl From<echomarch::gl::GpuError> for DemoError {
    fn from(error: echomarch::gl::GpuError) -> DemoError {
        DemoError::Failed(error.into())
    }
}

/// Formats an error in one line. Only the first line of a driver's log is included.
pub fn sentence(error: &impl std::fmt::Display) -> String {
    let text = error.to_string();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or_default();
    match lines.next() {
        Some(next) if first.ends_with(':') => format!("{first} {next}"),
        _ => first.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::gl::GpuError;

    /// Protects the terminal and the window from the many lines of a driver's log.
    #[test]
    fn a_log_of_many_lines_becomes_one() {
        let error = GpuError::Compile {
            stage: "fragment",
            label: "march".into(),
            log: "\n0:3(5): error: no such thing\n0:9(1): error: another\n".into(),
        };
        assert_eq!(
            DemoError::from(error).to_string(),
            "the fragment shader \"march\" does not compile: 0:3(5): error: no such thing"
        );
        assert_eq!(sentence(&"a.glsl:2: no"), "a.glsl:2: no");
    }
}
