//! Drivers' logs of shaders that do not compile.

/// One error in a driver's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogError {
    /// The text's number, as `#line` gave it; 0 before the first `#line`.
    pub file: u32,
    /// The line, as `#line` counts it.
    pub line: u32,
    /// The driver's message.
    pub message: String,
}

/// The errors in a log, in order; lines of an unknown form are skipped.
///
/// Known forms are Mesa's `2:12(5): error: ...`, NVIDIA's `2(12) : error C1008: ...` and ANGLE's `ERROR: 2:12: ...`.
/// Warnings are skipped.
pub fn log_errors(log: &str) -> Vec<LogError> {
    log.lines().filter_map(log_error).collect()
}

fn log_error(line: &str) -> Option<LogError> {
    let line = line.trim();
    let (file, rest) = number(line.strip_prefix("ERROR:").unwrap_or(line).trim_start())?;
    let (line, rest) = if let Some(rest) = rest.strip_prefix('(') {
        let (line, rest) = number(rest)?;
        (line, rest.strip_prefix(')')?)
    } else {
        let (line, rest) = number(rest.strip_prefix(':')?)?;
        let column = rest.strip_prefix('(').and_then(|r| r.split_once(')'));
        (line, column.map_or(rest, |(_, rest)| rest))
    };
    let mut message = rest.trim_start().strip_prefix(':')?.trim();
    if message.starts_with("warning") {
        return None;
    }
    if let Some(rest) = message.strip_prefix("error") {
        // NVIDIA puts a code there.
        message = rest.split_once(':').map_or(rest, |(_, rest)| rest).trim();
    }
    let message = message.replace('`', "'");
    Some(LogError {
        file,
        line,
        message,
    })
}

/// The number that a text begins with, and the rest.
fn number(text: &str) -> Option<(u32, &str)> {
    let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (number, rest) = text.split_at(digits);
    Some((number.parse().ok()?, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects finding the place of an error in the logs of all drivers.
    #[test]
    fn errors_are_found_in_every_known_form() {
        let log = "2:3(1): warning: 'x' is never used\n2:12(5): error: `foo' undeclared\n\
            2(13) : error C1008: undefined variable \"bar\"\n2(14) : warning C7011: implicit\n\
            ERROR: 4:15: 'baz' : undeclared identifier\nsome more";
        let expected = [
            (2, 12, "'foo' undeclared"),
            (2, 13, "undefined variable \"bar\""),
            (4, 15, "'baz' : undeclared identifier"),
        ];
        let errors = log_errors(log);
        let found: Vec<_> = errors
            .iter()
            .map(|e| (e.file, e.line, e.message.as_str()))
            .collect();
        assert_eq!(found, expected);
    }
}
