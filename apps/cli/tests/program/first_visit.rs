//! The program without arguments, `doctor`, man pages and completions.

use crate::common::cli::{
    argument, command, echomarch, json, refuse, run_in, stderr, stdout, succeed,
};
use std::process::Command;

/// Protects a first visit: the program without arguments names three commands, and each of them works as typed.
#[test]
fn nothing_typed_names_three_commands_that_work() {
    let first = succeed(&[]);
    let indented = stdout(&first)
        .lines()
        .filter_map(|line| line.strip_prefix("  "));
    let typed = |line: &str| {
        // The description follows after two spaces.
        let typed = line.split("  ").next().unwrap_or_default();
        typed.split(' ').map(str::to_owned).collect::<Vec<_>>()
    };
    let commands: Vec<Vec<String>> = indented.map(typed).collect();
    assert_eq!(commands.len(), 3, "{}", stdout(&first));
    let folder = tempfile::tempdir().unwrap();
    for words in commands {
        assert_eq!(words[0], "echomarch");
        let words: Vec<&str> = words[1..].iter().map(String::as_str).collect();
        let output = run_in(folder.path(), &words);
        assert!(output.status.success(), "{words:?}: {}", stderr(&output));
    }
    for file in ["out.wav", "view.png"] {
        assert!(folder.path().join(file).metadata().unwrap().len() > 1000);
    }
    assert!(
        stdout(&first).contains("echomarch doctor") && stdout(&first).contains("echomarch help")
    );
    refuse_unknown();
}

fn refuse_unknown() {
    let unknown = echomarch(&["inpulse"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(stderr(&unknown).contains("impulse"));
}

/// Protects users with a question about their machine: `doctor` reports the renderer that is used, its speed, sound
/// and memory.
#[test]
fn doctor_reports_the_machine() {
    let checks = json(&["doctor"]);
    let checks = checks.as_array().unwrap();
    let names: Vec<&str> = checks
        .iter()
        .map(|check| check["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["OpenGL", "speed", "sound", "memory"]);
    let renderer = json(&["trace", "corner"])["renderer"]
        .as_str()
        .unwrap()
        .to_owned();
    assert!(
        checks[0]["found"].as_str().unwrap().contains(&renderer),
        "{checks:?}"
    );
    for check in checks {
        // Each missing property has advice.
        assert_eq!(
            check["ok"].as_bool().unwrap(),
            check["advice"].is_null(),
            "{check}"
        );
    }
    let text = succeed(&["doctor"]);
    assert_eq!(
        stdout(&text)
            .lines()
            .filter(|line| line.contains(" ok "))
            .count(),
        checks.iter().filter(|check| check["ok"] == true).count()
    );
}

/// Protects users without OpenGL: `doctor` reports the reason and the line to install it, and fails.
#[test]
fn doctor_names_what_is_missing() {
    let output = echomarch(&["doctor", "--gpu", "99"]);
    assert_eq!(output.status.code(), Some(1));
    let text = stdout(&output);
    assert!(
        text.contains("missing") && text.contains("there is no GPU 99"),
        "{text}"
    );
    assert!(text.contains("install "), "{text}");
    assert!(
        text.contains("memory"),
        "the other checks are made too: {text}"
    );
}

/// Protects the completions: bash accepts them, and completes the names of commands and options.
#[test]
#[cfg(unix)]
fn bash_completes_commands_and_options() {
    let completions = succeed(&["completions", "bash"]);
    let script = format!(
        "{}\nCOMP_WORDS=(echomarch imp) COMP_CWORD=1; _echomarch echomarch imp echomarch; echo \"${{COMPREPLY[@]}}\"\n\
         COMP_WORDS=(echomarch impulse --accu) COMP_CWORD=2; _echomarch echomarch --accu impulse; echo \"${{COMPREPLY[@]}}\"",
        stdout(&completions)
    );
    let output = Command::new("bash").args(["-c", &script]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let completed: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(completed.len(), 2, "{completed:?}");
    for command in ["impulse", "import"] {
        assert!(completed[0].contains(command), "{completed:?}");
    }
    assert_eq!(completed[1], "--accuracy");
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        let text = succeed(&["completions", shell]);
        assert!(stdout(&text).contains("impulse"), "{shell}");
    }
    refuse(&["completions", "bash", "--json"], "--json");
}

/// Protects the manuals: one page for each command that the help lists, with its options, and none for hidden ones.
#[test]
fn each_command_has_a_man_page() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("man1");
    succeed(&["man", "-o", argument(&place)]);
    let whole = std::fs::read_to_string(place.join("echomarch.1")).unwrap();
    assert!(
        whole.starts_with(".ie") || whole.contains(".TH echomarch 1"),
        "{whole}"
    );
    let impulse = std::fs::read_to_string(place.join("echomarch-impulse.1")).unwrap();
    assert!(impulse.contains(".TH echomarch-impulse 1"), "{impulse}");
    for word in ["accuracy", "sofa", "gpu"] {
        assert!(impulse.contains(word), "{word}");
    }
    assert!(place.join("echomarch-doctor.1").exists());
    assert!(!place.join("echomarch-field-trial.1").exists());
    let printed = succeed(&["man"]);
    assert!(stdout(&printed).contains(".TH echomarch 1"));
    assert!(!stdout(&succeed(&["help"])).contains("completions"));
    // A folder that cannot be made is refused.
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    assert!(
        !command()
            .args(["man", "-o", argument(&file)])
            .status()
            .unwrap()
            .success()
    );
}
