//! Errors of the window.

/// A window that cannot be shown, or must be closed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DemoError {
    /// There is no display to show a window on.
    #[error("no display: {reason}; all commands but demo run without one")]
    NoDisplay {
        /// The missing part.
        reason: String,
    },
    /// The display exists, but cannot show a window.
    #[error("cannot open a window: {reason}")]
    NoWindow {
        /// The display's error.
        reason: String,
    },
    /// The display server ended while the window was open.
    #[error("the display server has gone, and the window with it")]
    DisplayGone {
        /// The measurements until then.
        report: Box<super::Report>,
    },
    /// A scene, settings or a renderer that do not work.
    #[error("{}", sentence(.0))]
    Failed(#[from] echomarch::Error),
    /// A recording that could not be ended whole.
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

/// Formats an error in one line: only the first line of a driver's log is included.
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

    /// Protects the terminal and the window from a driver's log.
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
