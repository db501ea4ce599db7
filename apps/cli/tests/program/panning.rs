//! Signs of panning and degrees of rotation, from the scene file to the printed report.

use crate::common::cli::{argument, json};

fn pan(folder: &std::path::Path, source: &str, listener: &str) -> f64 {
    let file = folder.join("field.ron");
    let text = format!(
        "Scene(
            surfaces: [Surface(shape: Plane, position: (0, -10, 0))],
            source: Source(position: {source}),
            listener: Listener(position: (20, 0, 30), radius: 2, {listener}),
        )"
    );
    std::fs::write(&file, text).unwrap();
    let report = json(&[
        "trace",
        argument(&file),
        "--profile",
        "thesis",
        "--iterations",
        "4",
    ]);
    report["pan"].as_f64().unwrap()
}

/// Protects the signs and the degrees from the scene file to the printed report. The bounds are those of
/// `tests/tracer/panning.rs`.
#[test]
fn scene_files_pan_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    let pan = |source, listener| pan(folder.path(), source, listener);
    assert!(pan("(20, 0, 25)", "").abs() < 0.02);
    assert!(pan("(15, 0, 30)", "") < -0.5);
    assert!(pan("(25, 0, 30)", "") > 0.5);
    assert!(pan("(20, 0, 25)", "yaw: 90") < -0.5);
    assert!(pan("(20, 0, 25)", "yaw: -90") > 0.5);
    assert_eq!(pan("(20, 0, 30)", ""), 0.0);
}
