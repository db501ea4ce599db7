//! The window's scenes, files and named values, its mouse look, and its end.

use crate::common::cli::{argument, command, stderr, succeed};
use crate::common::drop::drop_file;
use crate::common::window::{Demo, Display};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A room with a door that a named value rotates, and a wall whose width is another named value.
const HALL: &str = r#"Scene(
    name: "hall",
    surfaces: [
        Surface(name: "room", shape: Room(size: (20, 6, 20))),
        Surface(name: "door", shape: Box(size: (4, 6, 0.2)), rotation: (0, Value("door", 30), 0)),
        Surface(name: "wall", shape: Box(size: (Value("width", 2), 6, 0.5)), position: (-6, 0, 0)),
    ],
    source: Source(position: (0, 0, -6)),
    listener: Listener(position: (0, 0, 6), radius: 1),
)"#;

/// A folder with the hall scene, and a scene with one ball.
fn folder() -> (TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (hall, ball) = (
        folder.path().join("hall.ron"),
        folder.path().join("ball.ron"),
    );
    std::fs::write(&hall, HALL).unwrap();
    let other = r#"Scene(name: "ball",
        surfaces: [Surface(shape: Sphere(radius: Value("size", 1)), rotation: (Value("door", 10), 0, 0))],
        source: Source(position: (0, 0, -6)), listener: Listener(position: (0, 0, 6), radius: 1))"#;
    std::fs::write(&ball, other).unwrap();
    (folder, hall, ball)
}

fn wait_for_scene(demo: &Demo, name: &str) -> Value {
    demo.wait_until(name, |frame| frame["scene"] == name)
}

/// Protects access to a scene file after another scene was chosen.
#[test]
fn a_scene_file_can_be_reached_again() {
    let (_folder, hall, _) = folder();
    let display = Display::new();
    let demo = display.demo(&[argument(&hall)]);
    demo.key("n");
    wait_for_scene(&demo, "corner");
    demo.key("b");
    wait_for_scene(&demo, argument(&hall));
    // The window watches the file again: a change is read.
    std::fs::write(&hall, HALL.replace("radius: 1,", "radius: 1.5,")).unwrap();
    demo.wait_for("is read again");
    let (report, _, _) = demo.quit();
    assert_eq!(report["scene"], "hall");
}

/// Protects files dropped on the window: a scene is opened and watched, and a sound is played. Any other file and an
/// invalid scene have no effect.
#[test]
fn files_dropped_on_the_window_are_opened() {
    let (folder, hall, ball) = folder();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let broken = write("broken.ron", "Scene(");
    let notes = write("notes.txt", "");
    let no_field = write(
        "no-field.ron",
        &HALL.replace(
            "Box(size: (4, 6, 0.2))",
            r#"Field(file: "f.glsl", lipschitz: 1, size: (4, 4, 4))"#,
        ),
    );
    write("f.glsl", "float field(vec3 p) { return lngth(p) - 1.0; }");
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    let window = demo.window();
    let drop = |file: &Path| drop_file(&display.name, &window, file);
    drop(&hall);
    wait_for_scene(&demo, argument(&hall));
    drop(&broken);
    demo.wait_for("broken.ron:1:");
    drop(&no_field);
    demo.wait_for("f.glsl:1: ");
    drop(&notes);
    demo.wait_for("notes.txt");
    // The refused scene is not shown, and the hall's file is still watched.
    demo.wait_frames();
    wait_for_scene(&demo, argument(&hall));
    std::fs::write(&hall, HALL.replace("radius: 1,", "radius: 1.5,")).unwrap();
    demo.wait_for("is read again");
    drop(&ball);
    wait_for_scene(&demo, argument(&ball));
    let (report, _, _) = demo.quit();
    assert_eq!(report["scene"], "ball");
    let call = report["trace_call"].as_str().unwrap();
    assert!(call.contains(argument(&ball)), "{call}");
}

/// Protects named values: `--set` and sliders use the unit of the file. Values stay when the file changes, apply to
/// scenes opened later, and appear in printed calls and saved files.
#[test]
fn named_values_are_set_by_option_and_slider() {
    let (_folder, hall, ball) = folder();
    let display = Display::new();
    let demo = display.demo(&[argument(&hall), "--set", "door=60"]);
    let value = |frame: &Value, name: &str| {
        let values = frame["values"].as_array().unwrap();
        let set = values.iter().find(|pair| pair[0] == name);
        set.and_then(|pair| pair[1].as_f64())
    };
    demo.wait_until("60°", |frame| value(frame, "door") == Some(60.0));
    // The slider of "width" is below that of "door". The slider ranges from a quarter of 2 m to four times 2 m.
    let window = demo.window();
    display.xdotool(&["mousemove", "--window", &window, "870", "110"]);
    demo.wait_frames();
    display.xdotool(&["mousedown", "1"]);
    demo.wait_frames();
    display.xdotool(&["mouseup", "1"]);
    let set = demo.wait_until("a wider wall", |frame| value(frame, "width").is_some());
    let width = value(&set, "width").unwrap();
    assert!((4.0..=8.0).contains(&width), "{width}");
    std::fs::write(&hall, HALL.replace("radius: 1,", "radius: 1.5,")).unwrap();
    demo.wait_for("is read again");
    demo.key("F5");
    demo.wait_for("saved");
    let frame = demo.wait_until("a frame", |_| true);
    assert_eq!(
        (value(&frame, "door"), value(&frame, "width")),
        (Some(60.0), Some(width))
    );
    drop_file(&display.name, &window, &ball);
    wait_for_scene(&demo, argument(&ball));
    demo.wait_until("60°", |frame| value(frame, "door") == Some(60.0));
    // The saved file is in the list, after the hall.
    demo.key("b");
    wait_for_scene(&demo, argument(&hall.with_file_name("hall-1.ron")));
    demo.key("b");
    wait_for_scene(&demo, argument(&hall));
    let (report, _, _) = demo.quit();
    assert_eq!(report["values"], serde_json::json!({ "door": 60.0 }));
    let call = report["trace_call"].as_str().unwrap();
    assert!(call.contains(" --set "), "{call}");
    assert_eq!(report["trace_call_is_exact"], true);

    // The saved file contains the values as they were played, so no value is left to set.
    let saved = std::fs::read_to_string(hall.with_file_name("hall-1.ron")).unwrap();
    assert!(saved.contains(r#"Value("door", 60)"#), "{saved}");
    let trace = |arguments: &[&str]| {
        let arguments = [&["trace"], arguments, &["--waves", "4096", "--json"]].concat();
        let traced: Value = serde_json::from_slice(&succeed(&arguments).stdout).unwrap();
        traced["pan"].clone()
    };
    let width = format!("width={width}");
    let set = ["--set", "door=60", "--set", &width];
    let hall_set = trace(&[&[argument(&hall)], &set[..]].concat());
    assert_eq!(
        trace(&[argument(&hall.with_file_name("hall-1.ron"))]),
        hall_set
    );
    assert_ne!(trace(&[argument(&hall)]), hall_set);
}

/// Protects users who set an unknown value, or one that the scene rejects: no window opens.
#[test]
fn values_that_cannot_be_set_open_no_window() {
    let (_folder, hall, _) = folder();
    for (set, told) in [
        ("dor=1", "no value named"),
        ("width=-1", "greater than 0"),
        ("door=x", "finite number"),
    ] {
        let mut demo = command();
        demo.args(["demo", argument(&hall), "--set", set])
            .env("DISPLAY", "");
        let output = demo.output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{set}");
        assert!(stderr(&output).contains(told), "{}", stderr(&output));
    }
}

/// Protects panels from clicks that are faster than a frame: a click on a panel goes to the panel, wherever the pointer
/// was before. A click on the picture captures the mouse.
#[test]
fn a_quick_click_on_a_panel_captures_no_mouse() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    let window = demo.window();
    let click = |x: &str, y: &str| {
        display.xdotool(&["mousemove", "--window", &window, x, y, "click", "1"]);
    };
    // Headings and the plan do not respond to clicks.
    for (x, y) in [
        ("800", "20"),
        ("120", "120"),
        ("850", "100"),
        ("130", "300"),
        ("760", "460"),
    ] {
        display.xdotool(&["mousemove", "--window", &window, "480", "270"]);
        demo.wait_frames();
        click(x, y);
        demo.wait_frames();
        let frame = demo.wait_until("a frame", |_| true);
        assert_eq!(frame["mouse_looks"], false, "{x} {y}");
    }
    click("480", "200");
    demo.wait_until("captured", |frame| frame["mouse_looks"] == true);
    demo.key("Escape");
    let (report, _, _) = demo.quit();
    assert_eq!(report["mouse_looks"], false);
}

/// Protects users who never choose a number of waves: the number adapts to the frame time, down to a minimum, until the
/// user chooses one. After T, the number adapts again.
#[test]
fn the_number_of_waves_follows_the_time_until_it_is_chosen() {
    let display = Display::new();
    let mut program = command();
    // No processor reaches this frame rate with the slowest algorithm.
    program
        .args([
            "demo",
            "corner",
            "--json",
            "--profile",
            "thesis",
            "--fps",
            "240",
        ])
        .args(["--screenshot", "last.png", "--no-help"]);
    let demo = display.open(program);
    let fewer = demo.wait_until("fewer waves", |frame| {
        let waves = frame["waves"].as_u64().unwrap();
        assert!(frame["adapts_waves"] == true && waves >= 4096, "{frame}");
        waves < 65_536
    });
    assert!(fewer["waves"].as_u64().unwrap() >= 4096);
    demo.key("bracketright");
    let chosen = demo.wait_until("chosen", |frame| frame["adapts_waves"] == false)["waves"].clone();
    let mut frames = 0;
    demo.wait_until("a while", |frame| {
        assert_eq!(
            (&frame["waves"], &frame["adapts_waves"]),
            (&chosen, &false.into())
        );
        frames += 1;
        frames > 40
    });
    demo.key("t");
    demo.wait_until("followed again", |frame| frame["adapts_waves"] == true);
    let (report, _, _) = demo.quit();
    assert_eq!(report["adapts_waves"], true);

    // The option --waves counts as a choice by the user.
    let (report, _, _) = display.demo(&["corner"]).quit();
    assert_eq!(
        (&report["waves"], &report["adapts_waves"]),
        (&4096.into(), &false.into())
    );
}

/// Protects the plan from showing only waves that do not reach the listener: it searches until it has some heard paths.
#[test]
fn the_plan_shows_heard_paths() {
    let display = Display::new();
    for scene in ["corner", "shoebox"] {
        let demo = display.demo(&[scene]);
        demo.wait_until("heard paths", |frame| {
            frame["paths_heard"].as_u64() == Some(16)
        });
        demo.quit();
    }
}

/// Protects new users from a blank wall: without a scene argument, the window opens a scene with visible objects.
#[test]
fn without_a_scene_there_is_something_to_see() {
    let display = Display::new();
    let (report, first, _) = display.demo(&[]).quit();
    assert_eq!(report["scene"], "open-pillars");
    let (_, wall, _) = display.demo(&["corner"]).quit();
    // The picture shows sand and sky; in the other scene it shows a wall of one colour.
    let (first, wall) = (first.warm(270..700), wall.warm(270..700));
    assert!((0.2..0.8).contains(&first), "{first}");
    assert!(!(0.2..0.8).contains(&wall), "{wall}");
}

/// Protects users whose display server disappears: the window ends with its report, one sentence and exit code 1.
#[test]
fn the_display_may_go_away() {
    // Three situations: no input, a captured mouse, and held keys.
    for what in [
        &["mousemove", "5", "5"][..],
        &["click", "1"],
        &["keydown", "w"],
    ] {
        let display = Display::new();
        let demo = display.demo(&["corner"]);
        let window = demo.window();
        display.xdotool(&["mousemove", "--window", &window, "480", "270"]);
        demo.wait_frames();
        display.xdotool(what);
        demo.wait_frames();
        display.end();
        let (code, printed, told) = demo.ended();
        assert_eq!(code, Some(1), "{what:?}: {told:?}");
        let report: Value = serde_json::from_str(&printed).unwrap();
        assert!(report["frames"].as_u64().unwrap() > 3);
        let last = told.last().unwrap();
        assert!(last.contains("the display server has gone"), "{told:?}");
        let noise = |line: &&String| line.contains("panicked") || line.contains("XIO");
        assert!(!told.iter().any(|line| noise(&line)), "{told:?}");
    }
}
