//! Rejects options that have no effect, and options that were renamed.

use super::exit::BadInput;
use clap::ArgMatches;
use clap::parser::ValueSource;

/// A rule for options that a subcommand accepts but does not use.
struct Ignored {
    /// The name of the subcommand, followed by the name of its own subcommand, if any.
    command: &'static [&'static str],
    options: &'static [&'static str],
    /// Whether the rule applies to these arguments.
    when: fn(&ArgMatches) -> bool,
    because: &'static str,
}

const IGNORED: &[Ignored] = &[
    Ignored {
        command: &["info"],
        options: &["gl", "gpu"],
        when: always,
        because: "it lists every renderer",
    },
    Ignored {
        command: &["completions"],
        options: &["gl", "gpu", "json"],
        when: always,
        because: "it prints a file for a shell",
    },
    Ignored {
        command: &["man"],
        options: &["gl", "gpu", "json"],
        when: always,
        because: "it prints a manual",
    },
    Ignored {
        command: &["localise", "score"],
        options: &["gl", "gpu"],
        when: always,
        because: "it traces nothing",
    },
    Ignored {
        command: &["shader"],
        options: &["gpu"],
        when: always,
        because: "it needs no renderer",
    },
    Ignored {
        command: &["shader"],
        options: &["json"],
        when: |given| is_given(given, "output"),
        because: "the text goes to the file of --output",
    },
    Ignored {
        command: &["impulse"],
        options: &["sofa"],
        when: |given| !has_value(given, "format", "binaural"),
        because: "it is for --format binaural",
    },
    Ignored {
        command: &["slice"],
        options: &["waves"],
        when: |given| !is_given(given, "heard_paths"),
        because: "--paths sets the number of traced waves",
    },
    Ignored {
        command: &["slice"],
        options: &["iterations_per_pass", "sum_on_gpu"],
        when: always,
        because: "paths are traced one iteration at a time, and nothing is summed",
    },
    Ignored {
        command: &["slice"],
        options: &[
            "profile",
            "iterations",
            "seed",
            "directions",
            "min_distance",
            "max_distance",
        ],
        when: |given| !is_given(given, "paths") && !is_given(given, "heard_paths"),
        because: "no waves are traced without --paths or --heard-paths",
    },
    Ignored {
        command: &["demo"],
        options: &[],
        when: |given| is_given(given, "list_devices"),
        because: "--list-devices opens no window",
    },
];

/// Renamed options: the subcommand, the old name and the new name.
const RENAMED: &[(&str, &str, &str)] = &[
    (
        "slice",
        "height",
        "--cut-height is the height of the cut in metres, --image-width the width of the picture in pixels",
    ),
    (
        "slice",
        "width",
        "--image-width is the width of the picture in pixels",
    ),
    (
        "view",
        "height",
        "--image-height is the height of the picture in pixels",
    ),
    (
        "view",
        "width",
        "--image-width is the width of the picture in pixels",
    ),
];

fn always(_: &ArgMatches) -> bool {
    true
}

/// Rejects options that would have no effect.
pub fn check(matches: &ArgMatches) -> Result<(), BadInput> {
    let (mut path, mut given) = (Vec::new(), matches);
    while let Some((name, below)) = given.subcommand() {
        path.push(name);
        given = below;
    }
    let name = path.join(" ");
    for (_, option, now) in RENAMED.iter().filter(|(command, ..)| *command == name) {
        if is_given(given, option) {
            let text = format!("{name} no longer has --{option}: {now}");
            return Err(BadInput(text));
        }
    }
    if let Some(twice) = set_twice(given) {
        let text = format!("--set {twice} is given twice: the first has no effect");
        return Err(BadInput(text));
    }
    if let Some(text) = given_twice(given) {
        return Err(BadInput(text));
    }
    let rules = IGNORED.iter().filter(|rule| rule.command == path);
    for rule in rules.filter(|rule| (rule.when)(given)) {
        let wanted = |id: &&str| match rule.options {
            // All options, except those that affect the printed list.
            [] => !["list_devices", "json", "quiet"].contains(id),
            options => options.contains(id),
        };
        let mut ids = given.ids().map(clap::Id::as_str).filter(wanted);
        if let Some(id) = ids.find(|id| is_given(given, id)) {
            let option = match id {
                "scene" => "a scene".to_owned(),
                id => format!("--{}", id.replace('_', "-")),
            };
            let because = rule.because;
            let text = format!("{option} has no effect on {name}: {because}");
            return Err(BadInput(text));
        }
    }
    Ok(())
}

/// Returns the name of a value that is set twice, if there is one.
fn set_twice(given: &ArgMatches) -> Option<&str> {
    let sets = given.try_get_many::<(String, f32)>("set").ok().flatten()?;
    let names: Vec<&str> = sets.map(|(name, _)| name.as_str()).collect();
    let is_again = |at: &usize| names[..*at].contains(&names[*at]);
    (0..names.len()).find(is_again).map(|at| names[at])
}

/// Returns an error if a list contains a value twice, because that value would be computed twice.
fn given_twice(given: &ArgMatches) -> Option<String> {
    let twice = |id: &str| {
        let raw = given.try_get_raw(id).ok().flatten()?;
        let values: Vec<_> = raw.map(|value| value.to_string_lossy()).collect();
        let is_again = |at: &usize| values[..*at].contains(&values[*at]);
        let at = (0..values.len()).find(is_again)?;
        Some(format!("--{id} has {:?} twice: once is enough", values[at]))
    };
    ["profiles", "map"].into_iter().find_map(twice)
}

/// Whether an option has this value, either typed or by default.
fn has_value(given: &ArgMatches, id: &str, value: &str) -> bool {
    let mut raw = given.get_raw(id).into_iter().flatten();
    raw.any(|typed| typed == value)
}

/// Whether an option was typed; false if the subcommand has no option of that name.
fn is_given(given: &ArgMatches, id: &str) -> bool {
    let is_known = given.ids().any(|known| known.as_str() == id);
    is_known && given.value_source(id) == Some(ValueSource::CommandLine)
}
