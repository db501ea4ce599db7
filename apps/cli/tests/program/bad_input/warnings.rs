//! Unusual scenes, and marches that reach the step limit, cause a warning and a result.

use super::{SCENE, folder};
use crate::common::cli::{argument, json, stderr, stdout, succeed};
use std::path::PathBuf;
use tempfile::TempDir;

/// One iteration of the thesis' algorithm.
const THESIS_ONCE: &[&str] = &["--profile", "thesis", "--iterations", "1"];

/// Writes a scene file with this text, in a folder that is deleted on drop.
fn scene_file(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.ron");
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

/// Traces a scene file with this text, and returns the warnings.
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

/// Protects scenes that are unusual on purpose: they are traced, and a warning names the unusual property.
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
    assert!(in_listener[0].contains("the source is 0.5 m from the centre of the listener"));

    let listener_in_wall = warnings(&scene.replace("(4, 0, 0)", "(0, 0, -9)"));
    assert_eq!(listener_in_wall.len(), 1, "{listener_in_wall:?}");
    assert!(listener_in_wall[0].contains("the centre of the listener is 1 m inside surface 1"));
}

/// Protects the GPU from hanging: a march of more than 4096 steps ends, and is counted and reported. A wave that starts
/// h = 0.01 m above a plane and descends at a slope s multiplies its height by 1 − s with every step. The height is
/// below 1e-6 m after ln(10⁴)/s = 9.2/s steps, which exceeds the limit for slopes below 0.0022. A share of 0.0022/2 of
/// all start directions has such a slope: 74 of 65,536. With the thesis' own minimum distance of 0.1 m, such a wave
/// hits at once.
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
    // The bounds are five standard errors of a count of 74: √74 = 8.6.
    assert!(
        (31..=117).contains(&step_limit_reached),
        "{step_limit_reached}"
    );
    // The dead waves are those that reached the step limit and those that travel into the sky: about half.
    let dead = report["dead"].as_u64().unwrap();
    assert!(dead > 30_000 && dead < 36_000, "{dead}");
    let output = succeed(&grazing);
    let told = format!("warning: {step_limit_reached} marches reached the step limit of 4096");
    assert!(stderr(&output).contains(&told), "{}", stderr(&output));

    assert_eq!(json(&once)["step_limit_reached"], 0);
}

/// Protects the step limit for marched fields: the waves travel far between tori that repeat endlessly.
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

/// Protects against an endless march in a scene without walls: marches end even with the smallest minimum distances.
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
