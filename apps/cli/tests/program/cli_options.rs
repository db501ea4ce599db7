//! Arguments and their effects: numbers, names, options without an effect, tables.

use crate::answers::{answer_file, trial};
use crate::common::cli::{argument, command, json, refuse, stderr, stdout, succeed};
use serde_json::Value;

/// Protects numbers in the forms that people write: grouped digits and powers of ten have their usual meaning.
#[test]
fn counts_may_be_grouped_or_powers_of_ten() {
    let trace = |waves| json(&["trace", "corner", "--waves", waves, "--iterations", "2"]);
    let counted = |waves| {
        let report: Value = trace(waves);
        (report["waves"].clone(), report["listener_hits"].clone())
    };
    assert_eq!(counted("65_536"), counted("65536"));
    assert_eq!(counted("1e4"), counted("10000"));
    assert_eq!(counted("1e4").0, 10_000);
    for waves in ["1.5", "1e-1", "_1", "ten"] {
        let output = crate::common::cli::echomarch(&["trace", "corner", "--waves", waves]);
        assert_eq!(output.status.code(), Some(2), "{waves}");
    }
}

/// Protects measurements: repeated frames do not change the counts, and the report states how many frames the medians
/// are computed from.
#[test]
fn a_frame_can_be_repeated_for_its_time() {
    let trace = ["trace", "corner", "--waves", "256", "--repeat"];
    let once = json(&[&trace[..], &["0"]].concat());
    let repeated = json(&[&trace[..], &["3"]].concat());
    assert_eq!(once["timed_frames"], 1);
    assert_eq!(repeated["timed_frames"], 3);
    assert_eq!(once["listener_hits"], repeated["listener_hits"]);
    assert!(repeated["milliseconds"]["total"].as_f64() > Some(0.0));
    refuse(
        &[&trace[..], &["1001"]].concat(),
        "--repeat must be 0 to 1000",
    );
}

/// Protects users who mistype a scene's name: the error suggests the most similar name.
#[test]
fn a_scene_that_is_nearly_right_is_suggested() {
    refuse(&["trace", "cornr"], "did you mean corner?");
    refuse(
        &["view", "open_field", "-o", "/dev/null.png"],
        "did you mean open-field?",
    );
}

/// Protects users who mistake pixels for metres: the error for the former option --height names the options that
/// replace it.
#[test]
fn heights_in_pixels_and_in_metres_have_names_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("p.png");
    let picture = argument(&picture);
    refuse(
        &["slice", "corner", "-o", picture, "--height", "2"],
        "--cut-height is the height of the cut in metres",
    );
    refuse(
        &["view", "corner", "-o", picture, "--height", "200"],
        "--image-height is the height of the picture in pixels",
    );
    let help = succeed(&["view", "--help"]);
    assert!(!stdout(&help).contains(" --height"));
    let size = ["--image-width", "64", "--image-height", "32"];
    let report = json(&[&["view", "corner", "-o", picture], &size[..]].concat());
    assert_eq!(
        (&report["width"], &report["height"]),
        (&64.into(), &32.into())
    );
    let size = ["--image-width", "64", "--cut-height", "-0.5"];
    let report = json(&[&["slice", "corner", "-o", picture], &size[..]].concat());
    assert_eq!(report["width"], 64);
}

/// Protects users from options that only seem to have an effect: an option without an effect is refused.
#[test]
fn options_that_change_nothing_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("p.png");
    let text = folder.path().join("t.frag");
    let slice = ["slice", "corner", "-o", argument(&picture)];
    let refused: [(&[&str], &str); 16] = [
        (
            &["trace", "corner", "--min-distance", "0.01"],
            "--min-distance has no effect on --profile hybrid",
        ),
        (&["info", "--gpu", "0"], "--gpu has no effect on info"),
        (&["info", "--gl", "gles"], "--gl has no effect on info"),
        (&["shader", "corner", "--gpu", "0"], "--gpu has no effect"),
        (
            &["shader", "corner", "--json", "-o", argument(&text)],
            "--json has no effect",
        ),
        (
            &["shader", "corner", "--pass", "pan", "--profile", "thesis"],
            "--profile changes nothing",
        ),
        (
            &["shader", "corner", "--pass", "view", "--count-evaluations"],
            "--count-evaluations changes nothing",
        ),
        (
            &["shader", "corner", "--directions", "fibonacci"],
            "--directions changes nothing",
        ),
        (&[&slice[..], &["--waves", "9"]].concat(), "--waves has no"),
        (&[&slice[..], &["--sum-on-gpu"]].concat(), "--sum-on-gpu"),
        (&[&slice[..], &["--seed", "7"]].concat(), "without --paths"),
        (
            &[&slice[..], &["--profile", "march"]].concat(),
            "without --paths",
        ),
        (
            &["localise", "score", "a.json", "--gl", "gles"],
            "it traces nothing",
        ),
        (
            &["localise", "score", "a.json", "--gpu", "1"],
            "it traces nothing",
        ),
        (
            &["trace", "corner", "--profile=march", "--min-distance=0.01"],
            "--min-distance has no effect on --profile march",
        ),
        (
            &["cost", "corner", "--min-distance", "0.01"],
            "--min-distance has no effect",
        ),
    ];
    for (arguments, told) in refused {
        refuse(arguments, told);
    }
    assert!(!picture.exists() && !text.exists());
    let followed = ["--paths", "5", "--seed", "7", "--profile", "march"];
    succeed(&[&slice[..], &followed].concat());
    succeed(&[
        "shader",
        "corner",
        "--pass",
        "initialise",
        "--directions",
        "fibonacci",
    ]);
}

/// Protects `--list-devices`: options of the window are refused with it.
#[cfg(feature = "demo")]
#[test]
fn a_list_of_devices_takes_no_other_option() {
    refuse(&["demo", "corner", "--list-devices"], "opens no window");
    refuse(
        &["demo", "--list-devices", "--waves", "9"],
        "--waves has no effect on demo: --list-devices opens no window",
    );
}

/// Protects loudness: a source in front is as loud as a source at the side, unless the thesis' law or algorithm is
/// chosen.
#[test]
fn the_panning_law_follows_the_profile_until_it_is_chosen() {
    let trace = |more: &[&str]| json(&[&["trace", "corner", "--waves", "4096"], more].concat());
    let law = |more: &[&str]| trace(more)["law"].as_str().unwrap().to_owned();
    assert_eq!(law(&[]), "constant-power");
    assert_eq!(law(&["--profile", "march"]), "constant-power");
    assert_eq!(law(&["--profile", "thesis"]), "linear");
    assert_eq!(law(&["--law", "linear"]), "linear");
    let chosen = ["--profile", "thesis", "--law", "constant-power"];
    assert_eq!(law(&chosen), "constant-power");
    let gains = |more: &[&str]| -> [f64; 2] {
        let report = trace(more);
        [0, 1].map(|ear| report["gains"][ear].as_f64().unwrap())
    };
    let [left, right] = gains(&[]);
    assert!(
        (left * left + right * right - 1.0).abs() < 1e-6,
        "{left} {right}"
    );
    let [left, right] = gains(&["--law", "linear"]);
    assert!((left + right - 1.0).abs() < 1e-6, "{left} {right}");
}

/// Protects users who render their first sound: by default it is speech, which can be localised, and the law is
/// printed.
#[test]
fn render_plays_speech_by_the_law_of_the_profile() {
    let folder = tempfile::tempdir().unwrap();
    let wav = folder.path().join("out.wav");
    let render = |more: &[&str]| {
        let short = ["--seconds", "0.2", "--waves", "1024", "-o", argument(&wav)];
        json(&[&["render", "corner"], &short[..], more].concat())
    };
    let report = render(&["--listen", "balance"]);
    assert_eq!(
        (&report["sound"], &report["law"]),
        (&"speech:0".into(), &"constant-power".into())
    );
    assert_eq!(render(&[])["sound"], "speech:0");
    assert_eq!(render(&["--profile", "thesis"])["law"], "linear");
    assert_eq!(render(&["--law", "linear"])["law"], "linear");
}

/// An answer file with one answered trial whose stimulus is long.
fn answered() -> Value {
    let mut trial = trial(1, -48.0, -45.0);
    let stimulus = &mut trial["stimulus"];
    stimulus["scene"] = "whispering-gallery".into();
    stimulus["law"] = "constant-power".into();
    stimulus["waves"] = 1_048_576.into();
    stimulus["iterations"] = 16.into();
    answer_file("0123456789abcdef", &[1], [trial])
}

/// Protects terminals: no sentence of a report is wider than 100 columns. Tables may be wider.
#[test]
fn reports_fit_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let answers = folder.path().join("a.json");
    std::fs::write(&answers, answered().to_string()).unwrap();
    let runs: [&[&str]; 4] = [
        &["figures", "--max-waves", "256", "--runs", "1"],
        &["cost", "corner", "--waves", "1024", "--runs", "1"],
        &["verify", "--case", "grazing"],
        &["localise", "score", argument(&answers)],
    ];
    for arguments in runs {
        let output = succeed(arguments);
        for line in stdout(&output)
            .lines()
            .filter(|line| !line.starts_with('|'))
        {
            assert!(line.chars().count() <= 100, "{arguments:?}: {line}");
        }
    }
}

/// Protects users without a sound server: messages that libraries write about it are not shown.
#[cfg(all(feature = "demo", feature = "audio"))]
#[test]
fn libraries_write_nothing_about_a_missing_sound_server() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("nowhere");
    let output = command()
        .args(["demo", "--list-devices"])
        .env("XDG_RUNTIME_DIR", folder.path())
        .env("HOME", folder.path())
        .env("PULSE_SERVER", format!("unix:{}", nowhere.display()))
        .env("PULSE_RUNTIME_PATH", &nowhere)
        .output()
        .unwrap();
    assert!(output.status.success());
    assert_eq!(stderr(&output), "");
    for line in stdout(&output).lines() {
        assert!(line.starts_with("* ") || line.starts_with("  ") || line == "no sound devices");
        assert!(!line.contains("(null)"), "{line}");
    }
}

/// Protects users who set a value twice, because the first setting would have no effect.
#[test]
fn a_value_that_is_set_twice_is_refused() {
    refuse(
        &["trace", "corner", "--set", "door=0.2", "--set", "door=0.4"],
        "--set door is given twice",
    );
}

/// Protects users who slightly misspell a built-in scene or a named value.
#[test]
fn what_may_be_meant_is_told() {
    refuse(
        &["trace", "corner.ron"],
        "the built-in scene is called corner",
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("door.ron");
    let text = "Scene(surfaces: [Surface(shape: Plane, rotation: (0, Value(\"door\", 30), 0))], \
        source: Source(position: (0, 1, 0)), listener: Listener(position: (3, 1, 0), radius: 1))";
    std::fs::write(&file, text).unwrap();
    let set = ["trace", file.to_str().unwrap(), "--set", "dor=1"];
    refuse(&set, "did you mean door?");
}

/// Protects the help from defaults in a form that cannot be typed: values of a list are separated by commas.
#[test]
fn defaults_of_lists_have_commas() {
    for (arguments, default) in [
        (&["figures", "--help"][..], "[default: thesis,march,hybrid]"),
        (
            &["localise", "run", "--help"],
            "[default: corner,obstacles]",
        ),
        (&["localise", "form", "--help"], "[default: 4096,65536]"),
    ] {
        let output = succeed(arguments);
        // The comparison of words is independent of the terminal's width.
        let words: Vec<&str> = stdout(&output).split_whitespace().collect();
        let said = words.join(" ");
        assert!(said.contains(default), "{arguments:?}: {said}");
    }
}

/// Protects users who record or choose a device on a machine without sound: the error occurs before a window opens, and
/// no empty file remains.
#[cfg(all(feature = "demo", feature = "audio"))]
#[test]
fn without_a_sound_device_nothing_is_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("nowhere");
    let file = folder.path().join("heard.wav");
    for option in [["--record", argument(&file)], ["--device", "Attic"]] {
        let output = command()
            .args(["demo", "corner", option[0], option[1]])
            .env("XDG_RUNTIME_DIR", folder.path())
            .env("HOME", folder.path())
            .env("PULSE_SERVER", format!("unix:{}", nowhere.display()))
            .env("PULSE_RUNTIME_PATH", &nowhere)
            .env("ALSA_CONFIG_PATH", nowhere.join("alsa.conf"))
            .env_remove("DISPLAY")
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(
            stderr(&output).contains("no sound device"),
            "{}",
            stderr(&output)
        );
        assert!(!file.exists());
    }
}

/// Protects the command line of `accuracy`: invalid input is refused at once, with one sentence and exit code 2.
#[test]
fn bad_input_of_accuracy_is_refused_at_once() {
    let cases: [(&[&str], &str); 4] = [
        (&["nowhere"], "nowhere"),
        (&["corner", "-o", "/dev/null/out"], "/dev/null/out"),
        (&["corner", "--seeds", "2"], "--seeds"),
        (&["corner", "--error", "0"], "--error"),
    ];
    for (arguments, told) in cases {
        let output = command().arg("accuracy").args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(told), "{arguments:?}: {said}");
        assert!(output.stdout.is_empty());
    }
}

/// Protects the help of `accuracy`: it shows an example and the default scenes.
#[test]
fn the_help_of_accuracy_has_examples() {
    let output = succeed(&["accuracy", "--help"]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("echomarch accuracy -o out"));
    let scenes = format!(
        "[default: {};",
        echomarch_lab::experiment::accuracy::DEFAULT_SCENES.join(" ")
    );
    assert!(said.contains(&scenes), "{said}");
}
