//! Output of the subcommands: text, JSON, progress.

use echomarch_lab::text;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::io::Write;

/// Prints a line or a table, with control characters escaped. A closed pipe is an error like any other.
pub fn line(text: &str) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{}", text::in_lines(text)).map_err(unwritten)
}

/// Adds the message that standard output cannot be written to an error, and keeps the error as its cause.
pub fn unwritten(error: std::io::Error) -> anyhow::Error {
    let text = format!("cannot write standard output: {error}");
    anyhow::Error::new(error).context(text)
}

/// Prints a message to standard error. Every message of the program passes through this function, which cuts it to 10
/// lines and 1,000 characters.
pub fn tell(message: &str) {
    // A failure to write the message is ignored.
    let _ = writeln!(std::io::stderr(), "{}", text::message(message));
}

/// Prints a JSON record to standard error, for a program that controls this one.
#[cfg(feature = "demo")]
pub fn tell_record(json: &str) {
    // The receiver may have exited.
    let _ = writeln!(std::io::stderr(), "{}", text::json_record(json));
}

/// Prints a value as indented JSON.
pub fn json(value: &impl Serialize) -> anyhow::Result<()> {
    let json = serde_json::to_string_pretty(value)?;
    writeln!(std::io::stdout(), "{}", text::json(&json)).map_err(unwritten)
}

/// A progress bar on standard error. The bar is shown only on a terminal and without `--quiet`.
pub fn progress(quiet: bool, total: u64, unit: &str) -> ProgressBar {
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    let template = format!("{{bar:40}} {{pos}}/{{len}} {unit} {{eta}} left {{msg}}");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    bar
}
