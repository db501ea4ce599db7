//! Input that cannot be used: one sentence that says what and where, exit code 2, and no file
//! touched. Input that is merely odd: a warning, and a result.

use crate::common::cli::{argument, command, json, stderr, stdout, succeed};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

const SCENE: &str = "\
Scene(
    surfaces: [
        Surface(shape: Sphere(radius: 1), position: (0, 0, -9)),
    ],
    source: Source(position: (0, 5, 0)),
    listener: Listener(position: (4, 0, 0), radius: 1),
)
";

/// A folder to work in, with `scene.ron` in it.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.ron"), SCENE).unwrap();
    folder
}

/// All that is in a folder: files with their bytes, folders without.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .map(|path| (path.clone(), std::fs::read(path).ok()))
        .collect()
}

/// Runs the program in `folder`; it must refuse, and leave the folder as it is.
fn refused(folder: &Path, arguments: &[&str]) -> Output {
    let before = contents(folder);
    let output = command()
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert_eq!(stdout(&output), "", "{arguments:?}");
    assert!(contents(folder) == before, "{arguments:?}: {message}");
    output
}

/// One iteration of the thesis' algorithm.
const THESIS_ONCE: &[&str] = &["--profile", "thesis", "--iterations", "1"];

/// A scene file of this text, in a folder that lasts as long as it is held.
fn scene_file(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.ron");
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

/// The one line that the program says to arguments that it refuses itself.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = refused(folder, arguments);
    let lines: Vec<&str> = stderr(&output).lines().collect();
    let [line] = lines[..] else {
        panic!("{arguments:?}: not one line: {lines:?}");
    };
    let sentence = line.strip_prefix("echomarch: ");
    let sentence = sentence.unwrap_or_else(|| panic!("{arguments:?}: {line}"));
    // A cause that the sentence names must not follow it once more.
    if let Some((_, cause)) = sentence.rsplit_once(": ") {
        assert_eq!(sentence.matches(cause).count(), 1, "{sentence}");
    }
    sentence.to_owned()
}

/// What the program says to arguments that are no arguments: a line, and the way to the help.
fn usage_refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = refused(folder, arguments);
    let lines: Vec<&str> = stderr(&output).lines().collect();
    let [line, "", "For more information, try '--help'."] = lines[..] else {
        panic!("{arguments:?}: not one line and the hint: {lines:?}");
    };
    line.strip_prefix("error: ").unwrap().to_owned()
}

/// The refusal of a scene file that says `text`.
fn scene_refusal(text: &str) -> String {
    let folder = folder();
    let file = folder.path().join("scene.ron");
    std::fs::write(&file, text).unwrap();
    let trace = refusal(folder.path(), &["trace", "scene.ron"]);
    // The same scene is refused the same way before a WAV is begun.
    let render = refusal(folder.path(), &["render", "scene.ron", "-o", "out.wav"]);
    assert_eq!(trace, render);
    trace
}

/// A change to [`SCENE`], and where and how it is refused.
struct Spoilt {
    /// Text in [`SCENE`], once.
    text: &'static str,
    /// What stands there instead.
    with: &'static str,
    /// Line, counted from 1.
    line: usize,
    /// What the program's sentence must contain.
    says: &'static str,
}

const fn spoilt(text: &'static str, with: &'static str, line: usize, says: &'static str) -> Spoilt {
    Spoilt {
        text,
        with,
        line,
        says,
    }
}

const SPOILT: [Spoilt; 18] = [
    // Fields.
    spoilt("position: (0, 0, -9)", "colour: 3", 3, "`colour`"),
    spoilt("radius: 1),\n)", "\n)", 7, "`radius`"),
    spoilt("shape: Sphere(radius: 1), ", "", 3, "`shape`"),
    spoilt("Sphere(radius: 1)", "Torus(radius: 1)", 3, "`Torus`"),
    spoilt("Sphere(radius: 1)", "Sphere(size: (1, 1, 1))", 3, "`size`"),
    // Numbers.
    spoilt("(0, 5, 0)", "(0, NaN, 0)", 5, "finite, not [0, NaN, 0]"),
    spoilt("(0, 5, 0)", "(inf, 5, 0)", 5, "finite, not [inf, 5, 0]"),
    spoilt("(0, 0, -9)", "(0, 0, -inf)", 3, "finite"),
    // Too large for 32 bits.
    spoilt("(0, 5, 0)", "(0, 1e39, 0)", 5, "finite"),
    spoilt(
        "Sphere(radius: 1)",
        "Box(size: (1, -1, 1))",
        3,
        "greater than 0",
    ),
    spoilt(
        "Sphere(radius: 1)",
        "Box(size: (0, 0, 0))",
        3,
        "greater than 0",
    ),
    spoilt(
        "Sphere(radius: 1)",
        "Room(size: (9, 0, 9))",
        3,
        "greater than 0",
    ),
    spoilt(
        "Sphere(radius: 1)",
        "Cylinder(radius: -2)",
        3,
        "greater than 0",
    ),
    spoilt(
        "radius: 1),\n)",
        "radius: 0),\n)",
        6,
        "greater than 0, not 0",
    ),
    spoilt(
        "radius: 1),\n)",
        "radius: NaN),\n)",
        6,
        "greater than 0, not NaN",
    ),
    spoilt("radius: 1),\n)", "radius: 1, yaw: inf),\n)", 6, "finite"),
    spoilt("Sphere(radius: 1)", "Sphere(radius: one)", 3, ""),
    spoilt("(0, 5, 0)", "(0, 5)", 5, ""),
];

/// Protects the author of a scene: whatever is wrong in the file, the sentence names the file,
/// the line, a column within that line, and the field or the number.
#[test]
fn a_scene_file_is_refused_at_its_line() {
    for Spoilt {
        text,
        with,
        line,
        says,
    } in &SPOILT
    {
        assert_eq!(SCENE.matches(text).count(), 1, "{text}");
        let spoilt = SCENE.replace(text, with);
        let sentence = scene_refusal(&spoilt);
        let mut parts = sentence.splitn(4, ':');
        assert_eq!(parts.next(), Some("scene.ron"), "{sentence}");
        let found: usize = parts.next().unwrap().parse().unwrap();
        let column: usize = parts.next().unwrap().parse().unwrap();
        let reason = parts.next().unwrap().trim();
        assert_eq!(found, *line, "{sentence}");
        let length = spoilt.lines().nth(line - 1).unwrap().chars().count();
        assert!((1..=length + 1).contains(&column), "{sentence}");
        assert!(!reason.is_empty() && reason.contains(says), "{sentence}");
    }
}

/// Protects line and column themselves: broken syntax is pointed at where it breaks. Columns
/// count characters, so that a name in another script does not shift them.
#[test]
fn broken_syntax_is_refused_at_its_line_and_column() {
    let cases = [
        // Two numbers without a comma: at the second one.
        ("(0, 5, 0)", "(0, 5 0)", "scene.ron:5:36: "),
        // A bracket of the wrong kind: right after the colon before it.
        (
            "position: (0, 5, 0)",
            "position: [0, 5, 0]",
            "scene.ron:5:29: ",
        ),
        // An unknown field: at its name.
        ("position: (0, 0, -9)", "colour: 3", "scene.ron:3:43: "),
        (
            "shape: S",
            "name: \"Kügelchen\", colour: 3, shape: S",
            "scene.ron:3:36: ",
        ),
        // A file that breaks off: right after its last text.
        ("radius: 1),\n)\n", "radius: 1),\n", "scene.ron:6:56: "),
    ];
    for (text, with, start) in cases {
        let sentence = scene_refusal(&SCENE.replace(text, with));
        assert!(sentence.starts_with(start), "{sentence}, not {start}");
    }
    assert!(scene_refusal("").starts_with("scene.ron:1:1: "));
}

/// Protects what is refused about a scene as a whole: the sentence names the scene.
#[test]
fn a_scene_without_surfaces_is_refused() {
    let surface = "\n        Surface(shape: Sphere(radius: 1), position: (0, 0, -9)),\n    ";
    assert!(SCENE.contains(surface));
    let sentence = scene_refusal(&SCENE.replace(surface, ""));
    assert!(sentence.contains("\"scene\" has no surfaces"), "{sentence}");
}

/// Protects whoever mistypes a scene: built-in names are listed, files named with the cause.
#[test]
fn scenes_that_are_not_there_are_refused() {
    let folder = folder();
    let unknown = refusal(folder.path(), &["trace", "conrer"]);
    for name in echomarch::scene::BUILTIN_NAMES {
        assert!(unknown.contains(name), "{unknown}");
    }
    assert!(unknown.contains("\"conrer\""), "{unknown}");
    let missing = refusal(folder.path(), &["trace", "missing.ron"]);
    assert!(missing.contains("missing.ron: No such file"), "{missing}");
    let directory = refusal(folder.path(), &["trace", "."]);
    assert!(directory.contains("directory"), "{directory}");
    std::fs::write(folder.path().join("bytes.ron"), [0xFF, 0xFE, 0x00]).unwrap();
    let bytes = refusal(folder.path(), &["trace", "bytes.ron"]);
    assert!(
        bytes.contains("bytes.ron") && bytes.contains("UTF-8"),
        "{bytes}"
    );
}

/// Protects the GPU and the user's time: each setting outside its range is refused before
/// anything is traced, with the range and the value.
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

/// Protects `render` from lengths and rates that give no sound or never end.
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

/// Protects words with a closed list: what is not in it is named, and the list is given.
#[test]
fn unknown_words_are_refused_with_those_there_are() {
    let folder = folder();
    let corner = ["trace", "corner"];
    let render = ["render", "corner", "-o", "x.wav"];
    let cases: [(&[&str], &str, &str, &str); 5] = [
        (&corner, "--profile", "fast", "thesis"),
        (&corner, "--gl", "vulkan", "gl, gles or osmesa"),
        (&render, "--sound", "drum", "sine:HERTZ"),
        (&render, "--law", "loud", "constant-power"),
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

/// Protects named values: one that the scene does not have is refused with those it has, one
/// that cannot be with what it would be, and nothing is drawn or traced.
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
    assert!(none.contains("it has: none"), "{none}");
    let file = folder.path().join("moving.ron");
    let hits =
        |set: &[&str]| json(&[&["trace", argument(&file)], set].concat())["listener_hits"].clone();
    assert_eq!(hits(&[]), hits(&["--set", "globe=1"]));
    assert_ne!(hits(&[]), hits(&["--set", "globe=6"]));
}

/// Protects scenes that name files: a missing one is refused with its path.
#[test]
fn files_of_a_scene_that_are_missing_are_refused() {
    let shapes = [
        (
            "Field(file: \"no.glsl\", lipschitz: 1, size: (1, 1, 1))",
            "no.glsl",
        ),
        ("HeightField(image: \"no.png\", size: (1, 1, 1))", "no.png"),
    ];
    for (shape, file) in shapes {
        let sentence = scene_refusal(&SCENE.replace("Sphere(radius: 1)", shape));
        assert!(
            sentence.starts_with("scene.ron: cannot read the "),
            "{sentence}"
        );
        assert!(
            sentence.contains(&format!("{file}: No such file")),
            "{sentence}"
        );
    }
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

/// Protects the user's time and files: a place that cannot be written is refused before
/// anything is traced. (A folder of mode 0 would stop no test that runs as root; a file in the
/// place of a folder stops everyone.)
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
        // Neither a device nor a folder nor a scene has the ending of what is written.
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

/// Protects a finished file: a run that is refused half way leaves the older one as it was.
#[test]
fn a_refused_run_leaves_an_older_file() {
    let folder = folder();
    std::fs::write(folder.path().join("old.wav"), b"old").unwrap();
    // The GPU is looked for after the place was found writable.
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

/// The warnings that a scene file is traced with.
fn warnings(text: &str) -> Vec<String> {
    let folder = folder();
    let file = folder.path().join("odd.ron");
    std::fs::write(&file, text).unwrap();
    let output = succeed(&["trace", argument(&file), "--waves", "64"]);
    assert!(stdout(&output).contains("listener hits"));
    let lines = stderr(&output).lines();
    let lines = lines.filter_map(|line| line.strip_prefix("warning: "));
    lines.map(str::to_owned).collect()
}

/// Protects scenes that are odd on purpose: they run, and what is odd is named.
#[test]
fn odd_places_are_warned_of() {
    assert_eq!(warnings(SCENE), Vec::<String>::new());
    let named = "Surface(name: \"the globe\", shape";
    let scene = SCENE.replace("Surface(shape", named);

    let in_wall = warnings(&scene.replace("(0, 5, 0)", "(0, 0, -9.25)"));
    assert_eq!(in_wall.len(), 1, "{in_wall:?}");
    assert!(in_wall[0].contains("the source is 0.75 m inside surface 1 (the globe)"));

    let in_listener = warnings(&scene.replace("(0, 5, 0)", "(4, 0.5, 0)"));
    assert_eq!(in_listener.len(), 1, "{in_listener:?}");
    assert!(in_listener[0].contains("the source is 0.5 m from the listener's centre"));

    let listener_in_wall = warnings(&scene.replace("(4, 0, 0)", "(0, 0, -9)"));
    assert_eq!(listener_in_wall.len(), 1, "{listener_in_wall:?}");
    assert!(listener_in_wall[0].contains("listener's centre is 1 m inside surface 1"));
}

/// Protects the GPU from hanging: a march that would take more than 4096 steps ends,
/// counted, and told. A wave that leaves at h = 0.01 m above a plane and sinks at a slope s
/// comes down by the factor 1 − s with every step, and so is below 1e-6 m after
/// ln(10⁴)/s = 9.2/s of them: too many for slopes under 0.0022, and such are 0.0022/2 of all
/// start directions, 74 of 65,536. The thesis' own 0.1 m is met at once.
#[test]
fn marches_without_end_are_given_up_and_counted() {
    let (_folder, file) = scene_file(
        "\
Scene(
    surfaces: [Surface(shape: Plane)],
    source: Source(position: (0, 0.01, 0)),
    listener: Listener(position: (0, 50, 0), radius: 1),
)
",
    );
    let once = [&["trace", argument(&file)], THESIS_ONCE].concat();
    let grazing = [once.as_slice(), &["--min-distance", "1e-6"]].concat();
    let report = json(&grazing);
    let step_limit_reached = report["step_limit_reached"].as_u64().unwrap();
    // Five standard errors of a count about 74: √74 = 8.6.
    assert!(
        (31..=117).contains(&step_limit_reached),
        "{step_limit_reached}"
    );
    // Those that reached the step limit are dead, as are those that went up to the sky: about half.
    let dead = report["dead"].as_u64().unwrap();
    assert!(dead > 30_000 && dead < 36_000, "{dead}");
    let output = succeed(&grazing);
    let told = format!("warning: {step_limit_reached} marches reached the step limit of 4096");
    assert!(stderr(&output).contains(&told), "{}", stderr(&output));

    assert_eq!(json(&once)["step_limit_reached"], 0);
}

/// Protects the step limit's number where fields are marched: tori without end, between which waves
/// fly far.
#[test]
fn the_step_limit_of_fields_is_told() {
    let (_folder, file) = scene_file(
        "\
Scene(
    surfaces: [Surface(shape: Repeat(of: Torus(ring: 0.3, tube: 0.05), period: (4, 4, 4)))],
    source: Source(position: (2, 2, 2)),
    listener: Listener(position: (6, 2, 2), radius: 0.5),
)
",
    );
    let sparse = [
        "trace",
        argument(&file),
        "--iterations",
        "1",
        "--waves",
        "4096",
    ];
    let report = json(&sparse);
    let reached = report["step_limit_reached"].as_u64().unwrap();
    assert!(
        reached > 0 && report["dead"].as_u64().unwrap() >= reached,
        "{reached}"
    );
    let told = format!(
        "warning: {reached} marches reached the step limit of 1024 steps; their waves are dead"
    );
    let output = succeed(&sparse);
    assert!(stderr(&output).contains(&told), "{}", stderr(&output));
}

/// Protects against a hang in a scene without walls: the least minimum distances end too.
#[test]
fn the_least_minimum_distance_ends() {
    for metres in ["1e-6", "1e-30"] {
        let least = ["--waves", "4096", "--min-distance", metres];
        let report = json(&[&["trace", "open-field"], THESIS_ONCE, &least].concat());
        let count = |key: &str| report[key].as_u64().unwrap();
        let sum = count("listener_hits") + count("dead") + count("travelling");
        assert_eq!(sum, 4096);
        assert!(count("dead") > 0, "{report}");
    }
}
