//! The report of costs is consistent, and agrees with known properties of the scene. Times are not tested, because
//! other work on the machine would make the tests fail.

use crate::common::cli::{argument, command, echomarch, json, stderr, stdout, succeed};
use crate::common::{builtin, tracer};
use echomarch::glam::Vec3;
use echomarch::scene::shape::{Cuboid, Room, Sphere};
use echomarch::{Listener, Node, Profile, Scene, Settings, Source, Surface};
use echomarch_lab::experiment::cost::{
    CostOptions, CostReport, MOST_SURFACES, ShaderReport, Verdict, measure,
};
use echomarch_lab::report::Report;

/// The only function without a caller. The function is in a file that every pass includes as a whole, and compilers
/// remove the function.
const UNCALLED: [&str; 1] = ["reachedListener"];

const RUNS: CostOptions = CostOptions { runs: 2 };

fn report(scene: &Scene, settings: &Settings) -> CostReport {
    measure(&mut tracer(), scene, settings, &RUNS, &mut |_, _| ()).unwrap()
}

/// A room with a source and a listener, and a ball outside its walls.
fn room_and_ball_behind() -> Scene {
    let room = Node::Room(Room {
        size: Vec3::new(10.0, 4.0, 8.0),
    });
    let ball = Surface::new(Node::Sphere(Sphere { radius: 1.0 }));
    Scene::new(
        "behind",
        vec![
            Surface::new(room).named("room"),
            ball.at(Vec3::X * 20.0).named("ball"),
        ],
        Source::at(Vec3::new(-3.0, 0.5, 1.0)),
        Listener::at(Vec3::new(3.0, 0.0, -1.0), 0.5),
    )
}

/// Protects the purpose of the report: a surface that no wave can hit can be removed, and the room cannot.
#[test]
fn a_ball_behind_a_wall_can_be_left_out_and_the_room_not() {
    for profile in [Profile::Hybrid, Profile::March] {
        let settings = Settings::new(profile).with_waves(4096).with_iterations(4);
        let report = report(&room_and_ball_behind(), &settings);
        let [room, ball] = &report.surfaces[..] else {
            panic!("{:?}", report.surfaces);
        };
        assert_eq!(ball.verdict, Verdict::CanBeLeftOut);
        assert_eq!(ball.met, 0);
        // If the ball is in the direction of a wave, the march may approach the wall in other steps. The end of the
        // march then differs by a rounding error.
        let rounding = if profile == Profile::March { 1e-7 } else { 0.0 };
        assert!(ball.change.unwrap().pan.rms <= rounding);
        assert_eq!(room.verdict, Verdict::IsHeard);
        // Every wave that does not reach the listener at once travels to a wall.
        assert!(room.met_percent > 90.0, "{}", room.met_percent);
        assert!(ball.lines.unwrap() > 0);
        let advice = report.advice.join(" ");
        assert!(advice.contains("Surface 2 (ball)"), "{advice}");
        assert!(advice.contains("changes nothing beyond noise"), "{advice}");
    }
}

/// Protects the report of the corner scene: both surfaces are hit and heard, every option has its row, and options that
/// cannot change a bit change none.
#[test]
fn the_report_of_the_corner_agrees_with_itself() {
    let settings = Settings::hybrid().with_waves(8192);
    let scene = builtin("corner");
    let mut steps = Vec::new();
    let mut progress = |done, total| steps.push((done, total));
    let report = measure(&mut tracer(), &scene, &settings, &RUNS, &mut progress).unwrap();
    let rows = (report.surfaces.len() + report.options.len() + 1) as u64;
    assert_eq!(steps.last(), Some(&(rows, rows)));
    assert_eq!(report.followed, 8192);
    for row in &report.surfaces {
        assert!(row.met > 0 && row.met <= report.followed);
        assert_eq!(row.verdict, Verdict::IsHeard, "{}", row.name);
        let march = row.march.unwrap();
        assert!(march.base_ms > 0.0 && march.changed_ms > 0.0 && march.spread_ms >= 0.0);
    }
    let option = |name: &str| {
        let row = report.options.iter().find(|row| row.name == name);
        row.unwrap_or_else(|| panic!("no row {name}"))
    };
    let same = option("--iterations-per-pass 1");
    let change = same.change.unwrap();
    assert_eq!((change.heard_percent.rms, change.pan.rms), (0.0, 0.0));
    assert!(same.within_noise);
    assert!(!option("--profile thesis").within_noise);
    assert!(!option("half the iterations").within_noise);
    assert!(option("half the waves").change.unwrap().heard_percent.rms < 20.0);
    assert!(!report.advice.is_empty());
}

/// Protects the user of a field, whose cost the report must state: it contains the evaluations per flight. A scene of
/// closed forms has no such line.
#[test]
fn the_cost_of_fields_is_told() {
    let settings = Settings::hybrid().with_waves(1024).with_iterations(2);
    let cave = report(&builtin("cave"), &settings);
    let fields = cave.fields.unwrap();
    assert_eq!((fields.surfaces, fields.waves), (1, 1024));
    assert!(fields.evaluations_per_flight > 0.0 && fields.frame_ms > 0.0);
    assert!(fields.percent_of_frame <= 100.0, "{fields:?}");
    let told = cave.document().markdown();
    assert!(told.contains("1 marched surface: fields "), "{told}");
    let corner = report(&builtin("corner"), &settings);
    assert_eq!(corner.fields, None);
    assert!(!corner.document().markdown().contains("marched surface"));
}

/// Protects edge cases: one surface, silence, and more surfaces than rows in the report.
#[test]
fn one_surface_silence_and_many_are_told() {
    let settings = Settings::hybrid().with_waves(1024).with_iterations(2);
    let mut scene = room_and_ball_behind();
    scene.surfaces.truncate(1);
    let alone = report(&scene, &settings);
    assert_eq!(alone.surfaces[0].verdict, Verdict::LeavesNothing);
    assert_eq!(alone.surfaces[0].march, None);

    let wall = Surface::new(Node::Cuboid(Cuboid {
        size: Vec3::new(1.0, 9.0, 9.0),
    }));
    scene.surfaces.push(wall.named("wall"));
    let silent = report(&scene, &settings);
    assert_eq!(silent.surfaces[1].verdict, Verdict::NothingHeard);
    assert!(silent.advice[0].contains("Nothing is heard"));

    scene.surfaces.truncate(1);
    for index in 0..MOST_SURFACES {
        let ball = Surface::new(Node::Sphere(Sphere { radius: 0.05 }));
        let place = Vec3::new(-4.0 + 0.25 * index as f32, -1.5, 3.0);
        scene.surfaces.push(ball.at(place));
    }
    let many = report(&scene, &settings);
    assert!(many.by_kind);
    let kinds: Vec<usize> = many.surfaces.iter().map(|row| row.surfaces.len()).collect();
    assert_eq!(kinds, [1, MOST_SURFACES]);
    assert!(many.surfaces[1].leaves_cells);
}

/// Protects a promise: no scene pays for a feature that it does not use. Each feature with functions in a shader is
/// either in the scene or called by a feature that is. All functions are called, except the known ones.
#[test]
fn no_built_in_scene_has_the_text_of_a_feature_that_it_lacks() {
    for name in Scene::BUILTIN_NAMES {
        let scene = builtin(name);
        for profile in Profile::ALL {
            let settings = Settings::new(profile);
            let shader = ShaderReport::of(&scene, &settings);
            assert_eq!(shader.unneeded(), [""; 0], "{name}, {profile}");
            assert!(!shader.features.is_empty(), "{name}, {profile}");
            let uncalled = shader.unused_functions.iter().map(String::as_str);
            let new: Vec<&str> = uncalled.filter(|f| !UNCALLED.contains(f)).collect();
            assert_eq!(new, [""; 0], "{name}, {profile}");
            assert!(shader.functions >= shader.least_functions.min(10));
        }
    }
}

/// Protects the converse: if a feature is removed from a scene, its text disappears from the shader.
#[test]
fn a_feature_that_leaves_takes_its_text_along() {
    let settings = Settings::hybrid();
    let mut scene = room_and_ball_behind();
    let both = ShaderReport::of(&scene, &settings);
    scene.surfaces.pop();
    let room = ShaderReport::of(&scene, &settings);
    assert!(both.lines > room.lines && both.functions > room.functions);
    assert_eq!(room.unneeded(), [""; 0]);
    let names: Vec<&str> = room.features.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["Room"]);
}

/// Protects the machine-readable output: the JSON fields exist, and the CSV has one line per row.
#[test]
fn the_program_prints_json_and_writes_csv() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cost.csv");
    let arguments = ["cost", "corner", "--waves", "2048", "--runs", "1"];
    let report = json(&[&arguments[..], &["-o", argument(&file)]].concat());
    for field in ["renderer", "clock", "noise", "control", "shader", "advice"] {
        assert!(!report[field].is_null(), "{field}");
    }
    let surfaces = report["surfaces"].as_array().unwrap();
    let options = report["options"].as_array().unwrap();
    assert_eq!(surfaces.len(), 2);
    for field in [
        "name", "met", "march", "total", "change", "verdict", "lines",
    ] {
        assert!(!surfaces[0][field].is_null(), "{field}");
    }
    assert_eq!(surfaces[0]["verdict"], "is_heard");
    for field in ["base_ms", "changed_ms", "saved_percent", "spread_ms"] {
        assert!(options[0]["total"][field].is_number(), "{field}");
    }
    let written = std::fs::read_to_string(&file).unwrap();
    assert_eq!(written.lines().count(), 2 + surfaces.len() + options.len());

    let output = succeed(&arguments);
    assert!(stdout(&output).contains("The shader of the march has"));
    let notes = stderr(&output);
    assert!(notes.starts_with("renderer: ") && notes.lines().count() == 1);
}

/// Protects users who mistype input: the program prints one sentence, exits with code 2, and writes no file.
#[test]
fn bad_input_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let wrong: [&[&str]; 6] = [
        &["cost"],
        &["cost", "nowhere"],
        &["cost", "corner", "--runs", "0"],
        &["cost", "corner", "--waves", "0"],
        &["cost", "corner", "-o", "cost.txt"],
        &[
            "cost",
            "corner",
            "--profile",
            "march",
            "--min-distance",
            "0.1",
        ],
    ];
    for arguments in wrong {
        let output = command()
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert_eq!(stdout(&output), "", "{arguments:?}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let help = echomarch(&["cost", "--help"]);
    assert!(stdout(&help).contains("echomarch cost corner"));
}
