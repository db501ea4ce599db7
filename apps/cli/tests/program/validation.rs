//! The script that compares a room with its measurement, run on a made-up room.

use crate::common::cli::argument;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A box of 5 × 3 × 4 m with faces that point out of the air.
const BOX: &str = "v 0 0 0\nv 5 0 0\nv 5 3 0\nv 0 3 0\nv 0 0 4\nv 5 0 4\nv 5 3 4\nv 0 3 4\n\
    usemtl wall\nf 4 3 2 1\nf 5 6 7 8\nf 1 5 8 4\nf 2 3 7 6\nf 4 8 7 3\nusemtl floor\nf 1 2 6 5\n";

/// Its data. The measured T20 is far from any possible one, so that the difference is known to be audible.
const DATA: &str = r#"{
    "bands_hz": [63, 125, 250, 500, 1000, 2000, 4000, 8000],
    "materials": {
        "wall": {"absorption": [0.2, 0.2, 0.2, 0.2, 0.2, 0.2, 0.2, 0.2], "scattering": [0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3]},
        "floor": {"absorption": [0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4], "scattering": [0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3]}
    },
    "air": {"temperature": 20, "humidity": 40},
    "sources": {"S": [1, 1.2, 1]},
    "listeners": {"A": [3.5, 1.5, 2.8], "B": [4, 1.2, 1]},
    "measured": {"t20_s": {"500": 4.0, "1000": 4.0}, "c80_db": {"1000": 10.0}}
}"#;

fn validate(folder: &Path, more: &[&str]) -> Output {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/validate.sh");
    Command::new("bash")
        .arg(script)
        .arg(folder)
        .args(more)
        .env("ECHOMARCH", env!("CARGO_BIN_EXE_echomarch"))
        .output()
        .unwrap()
}

/// Protects the comparison with measurements: the script imports the mesh, uses the materials, places and measured values
/// of the folder, and writes a table and a picture.
#[test]
fn a_measured_room_is_compared() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("box.obj"), BOX).unwrap();
    fs::write(folder.path().join("box.json"), DATA).unwrap();
    let results = folder.path().join("results");
    let options = [
        "-o",
        argument(&results),
        "--accuracy",
        "5%",
        "--time-limit",
        "5",
    ];
    let output = validate(folder.path(), &options);
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaints}");
    let table = fs::read_to_string(results.join("comparison.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    let head = "figure,band_hz,pairs,measured,traced,error,difference,noticeable,in_noticeable";
    assert_eq!(rows[0].join(","), head);
    let of = |row: &[&str]| format!("{} {} {} {}", row[0], row[1], row[2], row[3]);
    let told: Vec<String> = rows[1..].iter().map(|row| of(row)).collect();
    assert_eq!(
        told,
        [
            "t20_s 500.0 2 4.0",
            "t20_s 1000.0 2 4.0",
            "c80_db 1000.0 2 10.0"
        ]
    );
    let number = |row: usize, column: usize| rows[row][column].parse::<f64>().unwrap();
    // Eyring's time of the room with a mean absorption of 0.24 is 0.37 s.
    assert!((0.3..0.5).contains(&number(1, 4)), "{table}");
    assert!(
        (number(1, 6) - (number(1, 4) - 4.0)).abs() < 1e-9,
        "{table}"
    );
    assert!((number(1, 8) - number(1, 6) / 0.2).abs() < 1e-9, "{table}");
    let picture = fs::read_to_string(results.join("comparison.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("T20 in s") && picture.contains("C80"));
}

/// Protects users of a wrong folder: one sentence says what the folder must have.
#[test]
fn a_folder_without_a_room_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = validate(folder.path(), &[]);
    assert!(!output.status.success());
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(complaints.contains("must have one mesh"), "{complaints}");
}
