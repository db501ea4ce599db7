//! Scene files that would take long to read or compile, or that become invalid during their motion.

use super::{folder_with, refusal};
use crate::common::cli::{run_in, stderr};

/// Protects users from scenes that are valid at their key frames but invalid between them: each subcommand refuses
/// them, and the message contains the time.
#[test]
fn what_is_impossible_between_keys_is_refused_with_its_time() {
    let prism = "Prism(corners: [(0, 0), (1, 0), (0.5, Keys([(0, 1), (2, -1)]))], depth: 1)";
    let normal = "Complement(of: HalfSpace(normal: (Keys([(0, 1), (3, -2)]), 0, 0), offset: -9))";
    for shape in [prism, normal] {
        let folder = folder_with(shape);
        for arguments in [
            &["trace", "scene.ron"][..],
            &["trace", "scene.ron", "--time", "1"],
            &["render", "scene.ron", "-o", "o.wav"],
            &["slice", "scene.ron", "-o", "o.png"],
        ] {
            let said = refusal(folder.path(), arguments);
            let told = said.strip_prefix("echomarch: at ").expect(&said);
            assert!(told.starts_with("1 s, "), "{said}");
        }
    }
}

/// Protects the program from files with very many key frames: each key frame is read a constant number of times, not
/// once for each other key frame.
#[test]
fn a_hundred_thousand_key_frames_are_read() {
    let keys: Vec<String> = (0..100_000).map(|n| format!("({n},1.{})", n % 7)).collect();
    let folder = folder_with(&format!("Sphere(radius: Keys([{}]))", keys.join(",")));
    let output = run_in(folder.path(), &["trace", "scene.ron", "--waves", "64"]);
    assert!(output.status.success(), "{}", stderr(&output));
}

/// Protects users from scenes whose shader would crash the driver or compile for minutes.
#[test]
fn what_compiles_for_minutes_is_refused() {
    let planes = "Plane), Surface(shape: ".repeat(600) + "Plane";
    let balls = format!("Union(of: [{}])", "Sphere(radius: 1),".repeat(600));
    let kinds: Vec<String> = (1..40)
        .map(|n| format!("Union(of: [{}])", "Torus(ring: 2, tube: 1),".repeat(n)))
        .collect();
    let kinds = kinds.join("), Surface(shape: ");
    for shapes in [planes, balls, kinds] {
        let folder = folder_with(&shapes);
        let said = refusal(folder.path(), &["trace", "scene.ron", "--waves", "64"]);
        assert!(said.contains("512"), "{said}");
    }
}
