//! Hints for options that do not exist in a subcommand.

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Words that users type to list the scenes.
const SCENE_LISTS: [&str; 3] = ["scenes", "list", "scene"];

/// Returns a hint for an unknown command or option, if there is one.
pub fn hint(error: &clap::Error) -> Option<String> {
    match error.kind() {
        ErrorKind::UnknownArgument => {
            let typed = word(error, ContextKind::InvalidArg)?;
            let command = std::env::args().skip(1).find(|word| !word.starts_with('-'));
            of_option(&command?, typed).map(str::to_owned)
        }
        ErrorKind::InvalidSubcommand => {
            let typed = word(error, ContextKind::InvalidSubcommand)?;
            SCENE_LISTS.contains(&typed).then(|| {
                format!("there is no command {typed:?}: echomarch help lists the commands and the scenes")
            })
        }
        _ => None,
    }
}

/// Removes clap's suggestion to pass an unknown option as a value, because no subcommand of this program accepts such a
/// value.
pub fn drop_misleading(error: &mut clap::Error) {
    let Some(ContextValue::StyledStrs(tips)) = error.get(ContextKind::Suggested) else {
        return;
    };
    let is_of_use = |tip: &clap::builder::StyledStr| !tip.to_string().contains("as a value");
    let kept = tips.iter().filter(|tip| is_of_use(tip)).cloned().collect();
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(kept));
}

fn word(error: &clap::Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word),
        _ => None,
    }
}

/// Returns a hint for an option that this subcommand lacks.
fn of_option(command: &str, typed: &str) -> Option<&'static str> {
    Some(match (command, typed) {
        ("trace", "-o" | "--output") => {
            "trace writes no file with -o: use --json > FILE.json, or --dump-waves FILE.csv"
        }
        ("trace", "--source" | "--listener") => {
            "trace uses the first source and the first listener; --levels reports every pair, and impulse a chosen pair"
        }
        ("slice", "--source" | "--listener") => {
            "slice uses the first source and the first listener: reorder them in the scene file"
        }
        ("impulse", "--iterations" | "--iterations-per-pass") => {
            "impulse has no number of iterations: waves are traced for --seconds"
        }
        ("view", "--waves" | "--iterations" | "--profile" | "--seed") => {
            "view traces no waves: it draws what the listener sees"
        }
        _ => return None,
    })
}
