//! Errors in scene files, with their line and column.

use super::{SCENE, folder, refusal};

/// Returns the error message for a scene file with the content `text`.
fn scene_refusal(text: &str) -> String {
    let folder = folder();
    let file = folder.path().join("scene.ron");
    std::fs::write(&file, text).unwrap();
    let trace = refusal(folder.path(), &["trace", "scene.ron"]);
    // `render` must refuse the same scene with the same message, before it creates a WAV file.
    let render = refusal(folder.path(), &["render", "scene.ron", "-o", "out.wav"]);
    assert_eq!(trace, render);
    trace
}

/// A change to [`SCENE`], and its expected error.
struct Spoilt {
    /// Text that occurs once in [`SCENE`].
    text: &'static str,
    /// The replacement of that text.
    with: &'static str,
    /// Line of the error, counted from 1.
    line: usize,
    /// Text that the error message must contain.
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

/// Protects the author of a scene: for each of these mistakes, the message contains the file, the line, a column within
/// that line, and the field or the number.
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

/// Protects the line and the column: they are the position at which the syntax breaks. Columns count characters, so
/// that a name in another script does not shift them.
#[test]
fn broken_syntax_is_refused_at_its_line_and_column() {
    let cases = [
        // Two numbers without a comma: the error is at the second number.
        ("(0, 5, 0)", "(0, 5 0)", "scene.ron:5:36: "),
        // A bracket of the wrong kind: the error is just after the preceding colon.
        (
            "position: (0, 5, 0)",
            "position: [0, 5, 0]",
            "scene.ron:5:29: ",
        ),
        // An unknown field: the error is at its name.
        ("position: (0, 0, -9)", "colour: 3", "scene.ron:3:43: "),
        (
            "shape: S",
            "name: \"Kügelchen\", colour: 3, shape: S",
            "scene.ron:3:36: ",
        ),
        // A file that ends too early: the error is just after its last text.
        ("radius: 1),\n)\n", "radius: 1),\n", "scene.ron:6:56: "),
    ];
    for (text, with, start) in cases {
        let sentence = scene_refusal(&SCENE.replace(text, with));
        assert!(sentence.starts_with(start), "{sentence}, not {start}");
    }
    assert!(scene_refusal("").starts_with("scene.ron:1:1: "));
}

/// Protects errors about a scene as a whole: the message contains the name of the scene.
#[test]
fn a_scene_without_surfaces_is_refused() {
    let surface = "\n        Surface(shape: Sphere(radius: 1), position: (0, 0, -9)),\n    ";
    assert!(SCENE.contains(surface));
    let sentence = scene_refusal(&SCENE.replace(surface, ""));
    assert!(sentence.contains("\"scene\" has no surfaces"), "{sentence}");
}

/// Protects users who mistype a scene's name: the message lists the built-in names. For a missing file, it contains the
/// file and the cause.
#[test]
fn scenes_that_are_not_there_are_refused() {
    let folder = folder();
    let unknown = refusal(folder.path(), &["trace", "conrer"]);
    for name in echomarch::Scene::BUILTIN_NAMES {
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

/// Protects scenes that refer to files: the error for a missing file contains the path of that file.
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
            sentence.starts_with("scene.ron:3:") && sentence.contains(": cannot read the "),
            "{sentence}"
        );
        assert!(
            sentence.contains(&format!("{file}: No such file")),
            "{sentence}"
        );
    }
}
