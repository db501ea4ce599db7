//! Options, sounds and output paths that the program refuses.

use super::{SCENE, folder, refusal};
use crate::common::cli::{argument, json, refused, stderr};
use std::path::Path;

/// Returns the program's message for invalid arguments. The message is one line, followed by the reference to the help.
fn usage_refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = refused(folder, arguments);
    let lines: Vec<&str> = stderr(&output).lines().collect();
    let [line, "", "For more information, try '--help'."] = lines[..] else {
        panic!("{arguments:?}: expected one line and the hint: {lines:?}");
    };
    line.strip_prefix("error: ").unwrap().to_owned()
}

/// Protects the GPU and the user's time: each setting outside its range is refused before tracing. The message contains
/// the range and the value.
#[test]
fn settings_out_of_range_are_refused() {
    let folder = folder();
    let cases = [
        ("--waves", "0", "waves must be 1 to 16777216, not 0"),
        ("--waves", "4000000000", "not 4000000000"),
        ("--waves", "16777217", "not 16777217"),
        ("--iterations", "0", "iterations must be 1 to 4095, not 0"),
        ("--iterations", "4096", "not 4096"),
        ("--min-distance", "0", "minimum distance"),
        ("--min-distance", "NaN", "minimum distance"),
        ("--min-distance", "-0.1", "minimum distance"),
        (
            "--min-distance",
            "300",
            "less than the maximum distance of 300",
        ),
        (
            "--min-distance",
            "301",
            "less than the maximum distance of 300",
        ),
        (
            "--max-distance",
            "0.05",
            "less than the maximum distance of 0.05",
        ),
        ("--max-distance", "inf", "maximum distance"),
        ("--max-distance", "-1", "maximum distance"),
        ("--gpu", "99", "there is no GPU 99"),
    ];
    for (option, value, says) in cases {
        for command in [
            &["trace", "corner", "--profile", "thesis"][..],
            &["render", "corner", "--profile", "thesis", "-o", "x.wav"],
        ] {
            let mut arguments = command.to_vec();
            arguments.extend([option, value]);
            let sentence = refusal(folder.path(), &arguments);
            assert!(sentence.contains(says), "{sentence}");
        }
    }
    for (option, value) in [("--runs", "0"), ("--max-waves", "63"), ("--gpu", "99")] {
        let sentence = refusal(folder.path(), &["figures", option, value]);
        assert!(sentence.contains(value), "{sentence}");
    }
}

/// Protects `render` from lengths and rates that give no sound or an endless sound.
#[test]
fn lengths_and_rates_out_of_range_are_refused() {
    let folder = folder();
    let values = ["0", "-1", "NaN", "inf", "1e9"];
    for option in ["--fps", "--seconds"] {
        for value in values {
            let arguments = ["render", "corner", "-o", "x.wav", option, value];
            let sentence = refusal(folder.path(), &arguments);
            assert!(
                sentence.contains(option) && sentence.contains("must be"),
                "{sentence}"
            );
        }
    }
}

/// Protects options with a fixed list of words: the error contains the unknown word and the list.
#[test]
fn unknown_words_are_refused_with_those_there_are() {
    let folder = folder();
    let corner = ["trace", "corner"];
    let render = ["render", "corner", "-o", "x.wav"];
    let cases: [(&[&str], &str, &str, &str); 6] = [
        (&corner, "--profile", "fast", "thesis"),
        (&corner, "--gl", "vulkan", "gl, gles or osmesa"),
        (&render, "--sound", "drum", "sine:HERTZ"),
        (&render, "--law", "loud", "constant-power"),
        (&render, "--gain", "-6m", "such as -6 or -6dB"),
        (&corner, "--waves", "-5", "-5"),
    ];
    for (command, option, value, says) in cases {
        let sentence = usage_refusal(folder.path(), &[command, &[option, value]].concat());
        assert!(
            sentence.contains(value) && sentence.contains(says),
            "{sentence}"
        );
    }
}

/// Protects named values: the error for an unknown name lists the scene's values, and the error for an invalid value
/// contains the resulting number. The program stops before it draws or traces.
#[test]
fn values_that_cannot_be_set_are_refused() {
    let folder = folder();
    let scene = SCENE.replace("radius: 1), pos", "radius: Value(\"globe\", 1)), pos");
    assert_ne!(scene, SCENE);
    std::fs::write(folder.path().join("moving.ron"), scene).unwrap();
    let commands: [&[&str]; 4] = [
        &["trace", "moving.ron"],
        &["render", "moving.ron", "-o", "x.wav"],
        &["view", "moving.ron", "-o", "x.png", "--time", "1"],
        &["slice", "moving.ron", "-o", "x.png"],
    ];
    for command in commands {
        let unknown = refusal(folder.path(), &[command, &["--set", "glob=2"]].concat());
        assert!(unknown.contains("\"glob\"; it has: globe"), "{unknown}");
        let negative = refusal(folder.path(), &[command, &["--set", "globe=-2"]].concat());
        assert!(negative.contains("greater than 0") && negative.contains("-2"));
        for said in ["globe", "globe=", "globe=two", "globe=inf"] {
            usage_refusal(folder.path(), &[command, &["--set", said]].concat());
        }
    }
    let none = refusal(folder.path(), &["trace", "corner", "--set", "globe=2"]);
    assert!(none.contains("it has none"), "{none}");
    let file = folder.path().join("moving.ron");
    let hits =
        |set: &[&str]| json(&[&["trace", argument(&file)], set].concat())["listener_hits"].clone();
    assert_eq!(hits(&[]), hits(&["--set", "globe=1"]));
    assert_ne!(hits(&[]), hits(&["--set", "globe=6"]));
}

/// Protects `render` from sounds that cannot be played.
#[test]
fn sounds_that_cannot_be_played_are_refused() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes);
    write(
        "text.wav",
        b"this is no sound at all, but long enough for a header",
    )
    .unwrap();
    write("nothing.wav", b"").unwrap();
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 48_000,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let silent = folder.path().join("silent.wav");
    hound::WavWriter::create(silent, spec)
        .unwrap()
        .finalize()
        .unwrap();
    let cases = [
        ("sine:0", "above 0 and below 24000 Hz"),
        ("sine:30000", "above 0 and below 24000 Hz"),
        ("sine:NaN", "above 0 and below 24000 Hz"),
        ("text.wav", "text.wav is not a WAV file"),
        ("nothing.wav", "nothing.wav is not a WAV file"),
        ("silent.wav", "silent.wav holds no samples"),
        ("missing.wav", "missing.wav: No such file"),
    ];
    for (sound, says) in cases {
        let arguments = ["render", "corner", "-o", "x.wav", "--sound", sound];
        let sentence = refusal(folder.path(), &arguments);
        assert!(sentence.contains(says), "{sentence}");
    }
}

/// Protects the user's time and files: an output path that cannot be written is refused before tracing. The test uses a
/// file in place of a folder, because a folder of mode 0 would not stop a test that runs as root.
#[test]
fn places_that_cannot_be_written_are_refused() {
    let folder = folder();
    let commands: [(&[&str], &str); 2] = [
        (&["trace", "corner", "--dump-waves"], "csv"),
        (&["render", "corner", "-o"], "wav"),
    ];
    for (command, ending) in commands {
        for stem in ["scene.ron/x", "absent/x", "/proc/x"] {
            let place = format!("{stem}.{ending}");
            let sentence = refusal(folder.path(), &[command, &[&place]].concat());
            let start = format!("cannot write {place}: ");
            assert!(sentence.starts_with(&start), "{sentence}");
        }
        // A device, a folder and a scene file all lack the required extension.
        for place in ["/dev/null", ".", "scene.ron"] {
            let sentence = refusal(folder.path(), &[command, &[place]].concat());
            assert!(
                sentence.contains(&format!("must end in .{ending}")),
                "{sentence}"
            );
        }
    }
    for place in ["scene.ron", "scene.ron/x", "/proc/x", "/dev/null"] {
        let sentence = refusal(folder.path(), &["figures", "-o", place]);
        assert!(sentence.contains(place), "{sentence}");
    }
    use std::os::unix::fs::FileTypeExt;
    let device = std::fs::metadata("/dev/null").unwrap();
    assert!(
        device.file_type().is_char_device(),
        "/dev/null was replaced"
    );
}

/// Protects an older output file: a run that fails midway leaves it unchanged.
#[test]
fn a_refused_run_leaves_an_older_file() {
    let folder = folder();
    std::fs::write(folder.path().join("old.wav"), b"old").unwrap();
    // The program opens the GPU only after it has checked that the path is writable.
    refusal(
        folder.path(),
        &["render", "corner", "-o", "old.wav", "--gpu", "99"],
    );
    refusal(
        folder.path(),
        &["trace", "corner", "--dump-waves", "old.wav", "--gpu", "99"],
    );
    assert_eq!(
        std::fs::read(folder.path().join("old.wav")).unwrap(),
        b"old"
    );
}

/// Protects users who type an option of another command, or the same option twice: the message states what to do, and
/// clap's misleading tip is absent.
#[test]
fn options_that_are_not_there_are_told_what_helps() {
    let folder = folder();
    for (arguments, told) in [
        (&["trace", "corner", "-o", "x"][..], "--dump-waves FILE.csv"),
        (
            &["impulse", "corner", "--iterations", "4"],
            "traced for --seconds",
        ),
        (
            &["slice", "corner", "--listener", "2"],
            "the first listener",
        ),
        (
            &["scenes"],
            "echomarch help lists the commands and the scenes",
        ),
        (
            &["trace", "corner", "--profile", "thsis"],
            "did you mean thesis?",
        ),
        (
            &["trace", "corner", "--seed", "-1"],
            "a whole number of 0 or more",
        ),
        (
            &["trace", "corner", "--law", "lin"],
            "there are: constant-power, linear",
        ),
        (
            &["accuracy", "corner", "--error", "7"],
            "--error must be 1e-9 to 2, not 7",
        ),
        (
            &["figures", "--profiles", "hybrid,hybrid"],
            "--profiles has \"hybrid\" twice",
        ),
        (&["verify", "--case", ""], "--case needs the name of a case"),
        (
            &["verify", "--case", "Sinai"],
            "the nearest are sinai-billiard",
        ),
    ] {
        let output = refused(folder.path(), arguments);
        let said = stderr(&output);
        assert!(said.contains(told), "{arguments:?}: {said}");
        assert!(!said.contains("as a value"), "{arguments:?}: {said}");
    }
    let said = refused(folder.path(), &["view", "corner", "-v"]);
    assert!(!stderr(&said).contains("as a value"));
}

/// Protects users who request a window without frames, or a panning law that has no effect.
#[cfg(feature = "demo")]
#[test]
fn a_window_of_no_frames_is_refused() {
    let folder = folder();
    for (options, told) in [
        (&["--frames", "0"][..], "--frames must be 1 or more"),
        (&["--seconds", "0"], "--seconds must be 0.001 to"),
        (
            &["--law", "linear", "--listen", "full"],
            "--law has no effect on --listen full",
        ),
    ] {
        let said = refusal(folder.path(), &[&["demo", "corner"], options].concat());
        assert!(said.contains(told), "{said}");
    }
}

/// Protects scripts: a failure to write the help is an error, as for all other output.
#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_told() {
    for arguments in [&["help"][..], &["trace", "corner", "--waves", "1024"]] {
        let full = std::fs::File::create("/dev/full").unwrap();
        let mut program = crate::common::cli::command();
        let output = program.args(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let said = stderr(&output);
        assert!(said.contains("cannot write standard output: "), "{said}");
    }
}
