//! Sources with a directivity on the command line.

use crate::common::cli::{argument, json, refuse};
use crate::common::sofa::SofaFile;
use serde_json::Value;
use std::path::Path;

/// A room with sources at the same place, 4 m in front of the listener.
fn scene(folder: &Path, sources: &str) -> String {
    let text = format!(
        "Scene(surfaces: [Surface(shape: Room(size: (12, 5, 9)), material: \"audience\")],
        sources: [{sources}],
        listener: Listener(position: (0, 0, -2), radius: 0.3))"
    );
    let file = folder.join("room.ron");
    std::fs::write(&file, text).unwrap();
    argument(&file).to_owned()
}

fn source(name: &str, yaw: u32, directivity: &str) -> String {
    format!(
        "Source(name: \"{name}\", position: (0, 0, 2), yaw: {yaw}, directivity: {directivity}),"
    )
}

/// A source with four times the energy ahead as aside, and a quarter behind.
fn horn() -> SofaFile {
    let angles = [
        ([0.0, 0.0], 2.0),
        ([90.0, 0.0], 1.0),
        ([180.0, 0.0], 0.5),
        ([270.0, 0.0], 1.0),
        ([0.0, 90.0], 1.0),
        ([0.0, -90.0], 1.0),
    ];
    let measured = angles.map(|(angles, amplitude)| (angles, vec![amplitude; 2]));
    SofaFile::directivity(&[500.0, 1000.0], &measured)
}

fn direct_db(pair: &Value) -> f64 {
    pair["direct"]["g_db"].as_f64().expect("a direct sound")
}

/// Protects sources with a directivity, from the scene file to the report: kind and orientation are stated, the direct
/// sound has the level of its direction, and a silent direction has no direct sound.
#[test]
fn the_report_has_the_directed_level() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("horn.sofa"), horn().bytes()).unwrap();
    let balloon = "Balloon(file: \"horn.sofa\")";
    let sources = [
        source("plain", 0, "Omnidirectional"),
        source("ahead", 0, "Cardioid"),
        source("aside", 90, "FirstOrder(0.5)"),
        source("behind", 180, "Cardioid"),
        source("horn", 0, balloon),
        source("turned horn", 180, balloon),
    ];
    let file = scene(folder.path(), &sources.concat());
    let report = json(&["impulse", &file, "--waves", "4096", "--seconds", "0.2"]);
    let pairs = report["pairs"].as_array().unwrap();
    let [plain, ahead, aside, behind, horn, turned] = &pairs[..] else {
        panic!("six pairs, not {}", pairs.len());
    };
    let kinds = [plain, ahead, horn].map(|pair| pair["directivity"].as_str());
    assert_eq!(
        kinds,
        [Some("Omnidirectional"), Some("FirstOrder"), Some("Balloon")]
    );
    assert_eq!(aside["source_yaw_deg"].as_f64(), Some(90.0));
    let relative = |pair: &Value| direct_db(pair) - direct_db(plain);
    assert!((relative(ahead) - 10.0 * 3_f64.log10()).abs() < 0.01);
    assert!((relative(aside) - 10.0 * 0.75_f64.log10()).abs() < 0.01);
    // Angles are `f32`: the rear of a cardioid is not exactly 0.
    let is_silent = |pair: &Value| pair["direct"].is_null() || relative(pair) < -100.0;
    assert!(is_silent(behind), "{}", behind["direct"]);
    let ratio_db = direct_db(horn) - direct_db(turned);
    assert!((ratio_db - 20.0 * 4_f64.log10()).abs() < 0.01, "{ratio_db}");
}

/// Protects users who mistype a directivity, or name a file that is missing or not a directivity: exit code 2, and one
/// sentence with the place or the file.
#[test]
fn bad_directivities_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("text.sofa"), "no HDF5").unwrap();
    let mut room = SofaFile::simple();
    room.globals.insert("SOFAConventions", "SingleRoomSRIR");
    std::fs::write(folder.path().join("room.sofa"), room.bytes()).unwrap();
    for (directivity, told) in [
        (
            "FirstOrder(1.5)",
            "an omnidirectional share must be 0 to 1, not 1.5",
        ),
        ("Cardoid", "Cardoid"),
        ("Balloon(file: \"none.sofa\")", "none.sofa: No such file"),
        ("Balloon(file: \"text.sofa\")", "it is not a SOFA file"),
        (
            "Balloon(file: \"room.sofa\")",
            "its SOFAConventions is \"SingleRoomSRIR\"",
        ),
    ] {
        let file = scene(folder.path(), &source("a", 0, directivity));
        refuse(&["impulse", &file], told);
    }
}
