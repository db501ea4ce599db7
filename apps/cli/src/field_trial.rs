//! `echomarch field-trial`: the child process in which users' fields are tried.

use super::options::Common;
use echomarch::tracer::{FieldTrial, TrialCommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// Selects child processes on the requested renderer for the trials of users' fields.
pub fn choose(common: &Common) {
    let mut arguments = vec![
        OsString::from("field-trial"),
        format!("--gl={}", common.gl).into(),
    ];
    arguments.extend(common.gpu.map(|gpu| format!("--gpu={gpu}").into()));
    // If the path of this program is unknown, every trial fails, and every field is refused. No field is compiled
    // without a trial.
    let command = TrialCommand::this_program(arguments.clone()).unwrap_or(TrialCommand {
        program: "echomarch".into(),
        arguments,
    });
    FieldTrial::InChild(command).set();
}

/// Runs the trial and sends the result to the parent process.
pub fn answer(common: &Common) -> ExitCode {
    FieldTrial::answer(&common.context_options())
}
