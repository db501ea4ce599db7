//! Converts an error to one sentence and an exit code.

use super::{option_hints, print};
use clap::error::ErrorKind;
use echomarch::Error;
use echomarch::internals::file_output::OutputError;
use echomarch_lab::study::StudyError;
use echomarch_lab::text;
use std::process::ExitCode;

const FAILED: u8 = 1;
const BAD_INPUT: u8 = 2;

/// Input that a subcommand itself rejects.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// Prints the error and returns the exit code.
pub fn report(error: &anyhow::Error) -> ExitCode {
    if is_broken_pipe(error) {
        return ExitCode::SUCCESS;
    }
    // Only the outermost error is printed, because the errors of this program include their causes in their own
    // sentences. If the sentence cannot be written, the exit code still reports the failure.
    print::tell(&format!("echomarch: {error}"));
    ExitCode::from(code(error))
}

/// Prints the error in the arguments, or the requested help. Control characters in typed text are escaped, as in all
/// other messages.
pub fn refuse_arguments(error: &mut clap::Error) -> ExitCode {
    let is_help = matches!(
        error.kind(),
        ErrorKind::DisplayHelp
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
            | ErrorKind::DisplayVersion
    );
    if is_help {
        return print_help(error);
    }
    if let Some(text) = option_hints::hint(error) {
        print::tell(&format!("echomarch: {text}"));
        return ExitCode::from(BAD_INPUT);
    }
    option_hints::drop_misleading(error);
    let text = error.render().to_string();
    if !text::is_showable(&text) {
        print::tell(&text);
        return ExitCode::from(BAD_INPUT);
    }
    error.exit()
}

/// Prints the help or the version. A failure to write (`help > /dev/full`) is an error, as for all other output.
fn print_help(error: &clap::Error) -> ExitCode {
    match error.print() {
        Ok(()) => ExitCode::from(error.exit_code() as u8),
        Err(unwritten) => report(&print::unwritten(unwritten)),
    }
}

fn code(error: &anyhow::Error) -> u8 {
    let bad_input = error.chain().any(|cause| {
        cause
            .downcast_ref::<Error>()
            .is_some_and(Error::is_bad_input)
            || cause.is::<BadInput>()
            || cause
                .downcast_ref::<StudyError>()
                .is_some_and(StudyError::is_bad_input)
            // The user typed the output path, so an invalid path is invalid input.
            || cause
                .downcast_ref::<OutputError>()
                .is_some_and(OutputError::is_bad_input)
    });
    if bad_input { BAD_INPUT } else { FAILED }
}

/// Whether the reader of the output has closed the pipe (`echomarch … | head`).
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
