//! Paths of waves that reach the listener, and the plan that shows these paths.

use crate::common::cli::{argument, command, stderr, succeed};
use crate::common::{builtin, tracer};
use echomarch::{Settings, tracer::Fate};
use serde_json::Value;

/// Protects the search for heard paths: each path found ends at the listener, as the same wave of a frame does, even if
/// few waves of a frame are heard.
#[test]
fn heard_paths_end_at_the_listener() {
    let mut tracer = tracer();
    for (name, settings) in [
        ("corner", Settings::default()),
        ("open-pillars", Settings::default().with_waves(8192)),
        (
            "corner",
            Settings::new(echomarch::Profile::March).with_waves(4096),
        ),
        ("corner", Settings::thesis().with_waves(4096)),
    ] {
        let scene = builtin(name);
        let found = tracer.heard_paths(&scene, &settings, 60, 1 << 20).unwrap();
        assert_eq!(found.count(), 60, "{name}");
        assert_eq!(found.paths.len(), settings.iterations as usize + 1);
        assert!(found.traced >= u64::from(settings.waves));
        for wave in 0..found.count() {
            let mut ends = found.paths.iter().map(|states| states[wave].fate());
            let end = ends.find(|fate| *fate != Fate::Travelling);
            assert_eq!(end, Some(Fate::Listener), "{name}, wave {wave}");
        }
        let (_, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
        let first = waves
            .iter()
            .find(|wave| wave.fate() == Fate::Listener)
            .unwrap();
        let apart = first.start_direction - found.paths[0][0].start_direction;
        assert!(apart.length() < 1e-6, "{name}: {apart}");
    }
    let none = tracer.heard_paths(&builtin("corner"), &Settings::default(), 0, 1 << 20);
    assert_eq!(none.unwrap().traced, 0);
}

/// A listener inside a solid sphere.
const DEAF: &str = r#"Scene(surfaces: [Surface(shape: Sphere(radius: 1), position: (0, 0, 5)), Surface(shape: Plane, position: (0, -2, 0))],
    source: Source(position: (0, 0, -5)), listener: Listener(position: (0, 0, 5), radius: 0.2))"#;

/// Protects users who request heard paths: they get the requested number, or a message that there are fewer.
#[test]
fn a_slice_has_the_heard_paths_asked_for_or_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("deaf.ron");
    std::fs::write(&file, DEAF).unwrap();
    let slice = |scene: &str, paths: &str| {
        let mut program = command();
        program.current_dir(folder.path());
        let arguments = [
            "slice",
            scene,
            "-o",
            "plan.png",
            "--heard-paths",
            paths,
            "--json",
        ];
        let output = program.args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        let picture = image::open(folder.path().join("plan.png"))
            .unwrap()
            .to_rgba8();
        (report, stderr(&output).to_owned(), picture)
    };
    let (report, told, with) = slice("open-pillars", "200");
    assert_eq!(report["heard_paths"], 200);
    // In one frame, only 182 of 65,536 waves are heard, so further frames are needed.
    assert!(report["traced_for_heard_paths"].as_u64() > Some(65_536));
    assert!(!told.contains("heard paths"), "{told}");
    let (_, _, without) = slice("open-pillars", "0");
    assert!(with != without);
    let (report, told, _) = slice(argument(&file), "5");
    assert_eq!(report["heard_paths"], 0);
    assert!(told.contains("only 0 of 5 heard paths"), "{told}");
    succeed(&[
        "slice",
        "corner",
        "-o",
        argument(&folder.path().join("a.png")),
        "--heard-paths",
        "3",
    ]);
}
