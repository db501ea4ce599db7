//! The window, controlled as by a user.

use crate::common::cli::{argument, command, echomarch, json, stderr, succeed};
use crate::common::window::{Display, Image};
use serde_json::Value;

/// The columns in the middle of the window, where panels do not cover the picture.
const MIDDLE: std::ops::Range<u32> = 270..700;

fn place(value: &Value) -> [f64; 3] {
    std::array::from_fn(|axis| value[axis].as_f64().unwrap())
}

/// Protects walking: held keys move the listener along its gaze, walls stop it, and the picture follows. The picture
/// stays the same while the listener stands still.
#[test]
fn keys_walk_and_walls_stop() {
    let display = Display::new();
    let (still, before, _) = display.demo(&["corner"]).quit();
    assert_eq!(place(&still["listener"]["position"]), [10.0, 0.0, 8.0]);
    let (_, again, _) = display.demo(&["corner"]).quit();
    assert!(before.difference(&again, MIDDLE) < 0.005);

    let demo = display.demo(&["corner"]);
    demo.hold("s", 1.0);
    let (walked, after, _) = demo.quit();
    let [x, _, z] = place(&walked["listener"]["position"]);
    assert!((x - 10.0).abs() < 1e-3 && z > 8.2, "{x} {z}");
    assert!(before.difference(&after, MIDDLE) > 0.05);

    // The face of the block, at z = 0, is the only obstacle straight ahead.
    let demo = display.demo(&["corner"]);
    demo.display.xdotool(&["keydown", "shift"]);
    let (mut before, mut still) = (f64::NAN, 0);
    demo.hold_until("w", "a wall", |frame| {
        let [_, _, z] = place(&frame["listener"]);
        let stands = (z - before).abs() < 1e-4 && z < 7.0;
        still = if stands { still + 1 } else { 0 };
        before = z;
        still > 10
    });
    demo.display.xdotool(&["keyup", "shift"]);
    let (stopped, _, _) = demo.quit();
    let [_, _, z] = place(&stopped["listener"]["position"]);
    assert!((0.3..0.4).contains(&z), "stopped at {z}");
}

/// Protects audible changes: the keys 1, 2 and 3 switch the profile while the window runs, and each profile is heard.
#[test]
fn keys_switch_the_profile() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    demo.wait_until("hybrid", |frame| frame["heard"]["profile"] == "hybrid");
    for (key, profile) in [
        ("1", "thesis"),
        ("2", "march"),
        ("3", "hybrid"),
        ("1", "thesis"),
    ] {
        demo.key(key);
        demo.wait_until(profile, |frame| frame["heard"]["profile"] == profile);
    }
    let (report, _, _) = demo.quit();
    assert_eq!(report["profile"], "thesis");
    let mut heard: Vec<&str> = report["pans"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pan| pan["profile"].as_str().unwrap())
        .collect();
    heard.dedup();
    assert_eq!(heard, ["hybrid", "thesis", "march", "hybrid", "thesis"]);
    // The output of each profile equals the output of `trace` with this profile.
    for profile in ["thesis", "march", "hybrid"] {
        let arguments = ["--profile", profile, "--waves", "4096", "--json"];
        let traced = succeed(&[&["trace", "corner"], &arguments[..]].concat());
        let traced: Value = serde_json::from_slice(&traced.stdout).unwrap();
        for pan in report["pans"].as_array().unwrap() {
            if pan["profile"] == profile {
                assert_eq!(pan["pan"], traced["pan"], "{profile}");
            }
        }
    }
    let call = report["trace_call"].as_str().unwrap();
    assert!(call.contains("--profile thesis --waves 4096"), "{call}");
}

/// Protects first-time users: F1 opens and closes the list of keys. The frame that opens the list already shows it,
/// because the last frame may be the first one after F1.
#[test]
fn f1_opens_and_closes_the_help() {
    let display = Display::new();
    let (closed, without, _) = display.demo(&["corner"]).quit();
    assert_eq!(closed["help"], false);
    for keys in [&["F1"] as &[&str], &["F1", "F1", "F1"]] {
        let mut demo = display.demo(&["corner"]);
        let pressed = [&["key", "--delay", "0"], keys, &["ctrl+q"]].concat();
        display.xdotool(&pressed);
        let open = demo.report();
        assert_eq!(open["help"], true);
        let with = Image::open(&demo.path("last.png"));
        let different = without.difference(&with, 340..620);
        assert!(different > 0.3, "{keys:?}: {different}");
    }
    let demo = display.demo(&["corner"]);
    demo.key("F1").key("h");
    let (closed, again, _) = demo.quit();
    assert_eq!(closed["help"], false);
    assert!(without.difference(&again, MIDDLE) < 0.005);
}

/// A ball as a user's own field.
const BALL: &str = "float field(vec3 p) {\n    return length(p) - 1.0;\n}\n";

const BALL_SCENE: &str = r#"Scene(
    name: "ball",
    surfaces: [
        Surface(name: "room", shape: Room(size: (14, 8, 14))),
        Surface(name: "ball", shape: Field(file: "ball.glsl", lipschitz: 1, size: (4.2, 4.2, 4.2))),
    ],
    source: Source(position: (-5, 1, -4)),
    listener: Listener(position: (4, 0.5, 4), radius: 1, yaw: -45),
)"#;

/// Protects users who edit a field while the window shows it: an invalid field is reported in one sentence and has no
/// effect. A valid field is shown at once and stops the listener.
#[test]
fn a_field_that_changes_is_taken_or_told_while_frames_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, field) = (folder.path().join("s.ron"), folder.path().join("ball.glsl"));
    std::fs::write(&scene, BALL_SCENE).unwrap();
    std::fs::write(&field, BALL).unwrap();
    let display = Display::new();
    let (_, small, _) = display.demo(&[argument(&scene)]).quit();

    let demo = display.demo(&[argument(&scene)]);
    std::fs::write(&field, BALL.replace("1.0", "one")).unwrap();
    let told = demo.wait_for("the last scene stays");
    assert!(
        told.contains("ball.glsl:2: ") && told.contains("one"),
        "{told}"
    );
    demo.wait_frames();
    std::fs::write(&field, BALL.replace("1.0", "1.9")).unwrap();
    demo.wait_for("is read again");
    demo.wait_frames();
    // An error in the scene file itself, which is not corrected: the ball of 1.9 m stays.
    std::fs::write(&scene, BALL_SCENE.replace("Room", "Rome")).unwrap();
    demo.wait_for("the last scene stays");
    // The ball is 6.2 m ahead, and stops the listener at its new size.
    demo.hold("w", 3.0);
    let (report, large, _) = demo.quit();

    let reread = report["reread"].as_array().unwrap();
    let errors: Vec<&Value> = reread.iter().map(|change| &change["error"]).collect();
    assert_eq!(reread.len(), 3, "{errors:?}");
    let sentence = errors[0].as_str().unwrap();
    assert!(
        sentence.contains("ball.glsl:2: ") && !sentence.contains('\n'),
        "{sentence}"
    );
    assert!(errors[1].is_null() && errors[2].is_string(), "{errors:?}");
    let frames: Vec<u64> = reread
        .iter()
        .map(|c| c["frames"].as_u64().unwrap())
        .collect();
    assert!(frames[0] > 0 && frames[1] > frames[0] + 2, "{frames:?}");
    assert!(report["frames"].as_u64().unwrap() > frames[2] + 2);
    let [x, y, z] = place(&report["listener"]["position"]);
    let left = (x * x + y * y + z * z).sqrt() - 1.9;
    assert!((0.3..0.6).contains(&left), "{left} m from the ball");
    assert!(small.difference(&large, MIDDLE) > 0.2);
}

/// Protects users who start with a field that does not compile: the program prints one sentence with file and line, and
/// exits with code 2.
#[test]
fn a_field_that_does_not_compile_opens_no_window() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.ron");
    std::fs::write(&scene, BALL_SCENE).unwrap();
    std::fs::write(folder.path().join("ball.glsl"), BALL.replace("1.0", "one")).unwrap();
    let display = Display::new();
    let mut started = command();
    started.env("DISPLAY", &display.name);
    let output = started.args(["demo", argument(&scene)]).output().unwrap();
    let told = stderr(&output);
    assert!(
        told.contains("ball.glsl:2: ") && told.lines().count() == 1,
        "{told}"
    );
    assert_eq!(output.status.code(), Some(2), "{told}");
}

/// Protects the picture from waves that take long: it continues while the waves are traced in parts. A change of the
/// profile does not wait for these waves, and a frame in parts sounds like a frame in one piece.
#[test]
fn the_picture_goes_on_while_waves_take_long() {
    let display = Display::new();
    let slow = ["obstacles", "--profile", "thesis", "--waves", "262144"];
    let mut window = command();
    window.arg("demo").args(slow).args([
        "--json",
        "--scale",
        "0.2",
        "--screenshot",
        "last.png",
        "--no-help",
    ]);
    let demo = display.open(window);
    demo.wait_traced(2);
    demo.key("3");
    demo.wait_until("hybrid", |frame| frame["heard"]["profile"] == "hybrid");
    demo.wait_traced(4);
    let (report, _, _) = demo.quit();
    let pans = report["pans"].as_array().unwrap();
    let of = |profile| pans.iter().filter(move |pan| pan["profile"] == profile);
    let end = of("thesis").next_back().unwrap()["seconds"]
        .as_f64()
        .unwrap();
    let pictures = report["frames"].as_f64().unwrap() / report["seconds"].as_f64().unwrap();
    let heard = of("thesis").count() as f64 / end;
    assert!(
        pictures > 4.0 * heard,
        "{pictures} pictures and {heard} frames of waves per second"
    );
    let traced = json(&[&["trace"], slow.as_slice()].concat());
    assert!(of("thesis").all(|pan| pan["pan"] == traced["pan"]));
    assert!(of("hybrid").count() > 3);
}

/// Protects windows that are resized while they run: the picture and the panels adapt.
#[test]
fn a_window_may_change_its_size() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    let window = demo.window();
    for [width, height] in [["1200", "700"], ["400", "300"], ["702", "501"]] {
        display.xdotool(&["windowsize", "--sync", &window, width, height]);
        demo.wait_frames();
    }
    let (report, picture, _) = demo.quit();
    assert_eq!(report["window"], serde_json::json!([702, 501]));
    assert_eq!(report["picture"], serde_json::json!([176, 125]));
    assert_eq!(picture.width, 702);
}

/// Protects mouse look: after a click, mouse movement rotates the gaze until Esc ends mouse look.
#[test]
fn the_mouse_looks_about_between_a_click_and_esc() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    let move_by = |x: &str, y: &str| {
        display.xdotool(&["mousemove_relative", "--", x, y]);
        demo.wait_frames();
    };
    let window = demo.window();
    display.xdotool(&["mousemove", "--window", &window, "480", "270"]);
    display.xdotool(&["click", "1"]);
    demo.wait_frames();
    for _ in 0..3 {
        move_by("200", "-30");
    }
    demo.key("Escape");
    move_by("-200", "30");
    let (report, _, _) = demo.quit();
    let turned = |name: &str| report["listener"][name].as_f64().unwrap().to_radians();
    let (yaw, pitch) = (turned("yaw"), turned("pitch"));
    // 0.0025 radians per pixel, to the right and up: 3 × 200 and 3 × 30 pixels, beyond the window's edge.
    let is_right = |angle: f64, wanted: f64| (angle - wanted).abs() < 1e-3;
    assert!(
        is_right(yaw, 1.5) && is_right(pitch, 0.225),
        "{yaw} {pitch}"
    );
}

/// Protects the panels after mouse look: once Esc has ended it, a click on a button goes to the button.
#[test]
fn panels_take_clicks_after_the_mouse_has_looked_about() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    let window = demo.window();
    let click = |[x, y]: [&str; 2]| {
        display.xdotool(&["mousemove", "--window", &window, x, y]);
        demo.wait_frames();
        display.xdotool(&["click", "1"]);
        demo.wait_frames();
    };
    click(["480", "270"]);
    demo.key("Escape");
    // The buttons "2 march" and "save".
    click(["825", "115"]);
    click(["885", "38"]);
    demo.wait_for("saved corner-1.ron");
    display.xdotool(&["mousemove", "--window", &window, "480", "270"]);
    let (report, _, _) = demo.quit();
    assert_eq!(report["profile"], "march");
    assert_eq!(report["saved"][0], "corner-1.ron");
    assert_eq!(report["listener"]["yaw"], 0.0);
}

/// Protects values from the command line: controls with a smaller range do not change them.
#[test]
fn panels_leave_what_they_do_not_reach() {
    let display = Display::new();
    let arguments = "corner --profile thesis --min-distance 0.0005 --trace-every 100 --frames 130";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let report = display.demo(&arguments).report();
    let call = report["trace_call"].as_str().unwrap();
    assert!(call.contains(" --min-distance 0.0005"), "{call}");
    // Waves are traced with the first picture and with picture 101.
    assert_eq!(report["traced"], 2);
}

/// Protects the keys that change scene, waves and position, and the key for a screenshot.
#[test]
fn keys_do_what_the_help_says() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    demo.hold("s", 0.5)
        .key("BackSpace")
        .key("n")
        .key("bracketright");
    demo.key("period").key("F12");
    let (report, _, folder) = demo.quit();
    let next = echomarch::Scene::BUILTIN_NAMES
        .iter()
        .skip_while(|name| **name != "corner")
        .nth(1);
    assert_eq!(report["scene"].as_str(), next.copied());
    assert_eq!(
        (&report["waves"], &report["iterations"]),
        (&8192.into(), &9.into())
    );
    let picture = Image::open(&folder.path().join("echomarch-1.png"));
    assert_eq!(picture.width, 960);

    let demo = display.demo(&["corner", "--fps", "2"]);
    demo.hold("s", 0.5).key("BackSpace").key("t");
    // A frame time of half a second allows more than 4,096 waves.
    demo.wait_until("more waves", |frame| frame["waves"].as_u64() > Some(4096));
    let (report, _, _) = demo.quit();
    assert_eq!(place(&report["listener"]["position"]), [10.0, 0.0, 8.0]);
}

/// Protects manual changes: a source that was picked up moves with the listener and is heard at its new position. The
/// saved file is a scene that traces to the last pan that was played.
#[test]
fn a_source_carried_and_saved_is_heard_alike_from_the_file() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    demo.key("f").hold("Left", 0.5).hold("s", 0.5).key("f");
    demo.key("F5");
    let (report, _, folder) = demo.quit();
    let source = place(&report["source"]);
    assert!((source[0] + 8.0).abs() > 1.0, "{source:?}");
    assert_eq!(report["saved"][0], "corner-1.ron");
    assert_eq!(report["trace_call_is_exact"], true);

    let scene = folder.path().join("corner-1.ron");
    let traced = succeed(&["trace", argument(&scene), "--waves", "4096", "--json"]);
    let traced: Value = serde_json::from_slice(&traced.stdout).unwrap();
    let pans = report["pans"].as_array().unwrap();
    let heard = pans.last().unwrap()["pan"].as_f64().unwrap();
    // Degrees in the file are rounded.
    assert!((traced["pan"].as_f64().unwrap() - heard).abs() < 1e-3);
    assert_eq!(traced["waves"], 4096);
    assert_eq!(
        Value::from(&report["trace_call"].as_str().unwrap()[..29]),
        "echomarch trace corner-1.ron "
    );
}

/// Protects moving scenes: the source moves along its path and is heard from left to right, until P pauses it.
#[test]
fn a_moving_source_is_heard_to_move_until_it_is_held() {
    let display = Display::new();
    let demo = display.demo(&["open-field"]);
    demo.wait_until("right", |frame| frame["heard"]["pan"].as_f64() > Some(0.2));
    demo.key("p");
    demo.wait_traced(4);
    let (report, _, _) = demo.quit();
    let pans: Vec<f64> = report["pans"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pan| pan["pan"].as_f64().unwrap())
        .collect();
    assert!(pans[0] < -0.3, "{}", pans[0]);
    let greatest = pans.iter().copied().fold(f64::MIN, f64::max);
    assert!(greatest > 0.2, "{greatest}");
    let held = &pans[pans.len() - 3..];
    assert!(held.iter().all(|pan| *pan == held[0]), "{held:?}");

    // The printed call contains the time at which the source was paused on its path.
    assert_eq!(report["trace_call_is_exact"], true);
    let call = report["trace_call"].as_str().unwrap();
    assert!(call.contains(" --time "), "{call}");
    let mut arguments: Vec<&str> = call.split(' ').skip(1).collect();
    arguments.push("--json");
    let traced: Value = serde_json::from_slice(&succeed(&arguments).stdout).unwrap();
    assert_eq!(traced["pan"], held[0]);
}

/// Protects the panels from GPU work between the picture and the panels: they are visible in six consecutive frames,
/// one of which traces the paths of waves. The panels show the balance, because full listening changes them at times that
/// depend on the machine.
#[test]
fn panels_stand_in_every_frame() {
    const LEFT: std::ops::Range<u32> = 8..250;
    let display = Display::new();
    let picture = |arguments: &[&str]| {
        let mut demo = display.demo(&[&["corner", "--listen", "balance"], arguments].concat());
        demo.report();
        Image::open(&demo.path("last.png"))
    };
    let pictures = ["60", "61", "62", "63", "64", "65"].map(|n| picture(&["--frames", n]));
    for other in &pictures[1..] {
        let different = pictures[0].difference(other, LEFT);
        assert!(different < 0.1, "{different}");
    }
    let demo = display.demo(&["corner", "--listen", "balance"]);
    demo.key("Tab");
    let (_, bare, _) = demo.quit();
    assert!(pictures[0].difference(&bare, LEFT) > 0.3);
}

/// Protects runs that end by themselves, and windows of any size: the window draws exactly the requested number of
/// frames.
#[test]
fn a_run_ends_after_its_frames() {
    let display = Display::new();
    let mut demo = display.demo(&[
        "shoebox", "--frames", "40", "--width", "640", "--height", "360",
    ]);
    let report = demo.report();
    assert_eq!(report["frames"], 40);
    assert_eq!(report["window"], serde_json::json!([640, 360]));
    assert_eq!(Image::open(&demo.path("last.png")).width, 640);
}

/// Protects machines without a display: the program prints one sentence that states which commands work, and exits with
/// code 1.
#[test]
fn a_missing_display_is_told_in_one_sentence() {
    for (name, reason) in [
        ("", "DISPLAY nor WAYLAND_DISPLAY is set"),
        (":4711", "DISPLAY is :4711"),
    ] {
        let output = command().arg("demo").env("DISPLAY", name).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let told = stderr(&output);
        assert!(told.starts_with("echomarch: no display: "), "{told}");
        assert!(told.contains(reason), "{told}");
        assert!(
            told.contains("all commands but demo run without one"),
            "{told}"
        );
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}

/// Protects users who mistype arguments: the program exits with code 2 before it opens a display.
#[test]
fn bad_input_opens_no_window() {
    for arguments in [
        ["demo", "nowhere"].as_slice(),
        &["demo", "corner", "--volume", "2"],
        &["demo", "corner", "--sound", "trumpet"],
        &["demo", "corner", "--screenshot", "picture.jpg"],
        &["demo", "corner", "--trace-every", "0"],
        &["demo", "corner", "--fps", "0"],
        &["demo", "corner", "--gl", "osmesa"],
    ] {
        let output = echomarch(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let told = stderr(&output);
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}
