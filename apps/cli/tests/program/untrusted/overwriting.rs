//! Outputs that would replace an input file.

use super::{answers, folder_with, refusal};
use crate::common::wav::float_wav;
use std::os::unix::fs::symlink;

/// Protects input files: no output of any subcommand replaces them, whether by the same name, another path, a symbolic
/// link or a hard link.
#[test]
fn outputs_never_replace_inputs() {
    let folder = folder_with("Union(of: [HeightField(image: \"h.png\", size: (9, 2, 9)), Plane])");
    let folder = folder.path();
    let picture = image::GrayImage::from_fn(4, 4, |x, y| image::Luma([(x * y * 9) as u8]));
    picture.save(folder.join("h.png")).unwrap();
    std::fs::write(folder.join("v.wav"), float_wav(&[0.5; 999])).unwrap();
    symlink("scene.ron", folder.join("soft.csv")).unwrap();
    std::fs::hard_link(folder.join("scene.ron"), folder.join("hard.csv")).unwrap();
    std::fs::hard_link(folder.join("v.wav"), folder.join("hard.wav")).unwrap();
    symlink(folder.join("h.png"), folder.join("soft.png")).unwrap();
    std::fs::create_dir(folder.join("out")).unwrap();
    for file in ["accuracy.json", "localise.md", "localise.svg"] {
        symlink("../scene.ron", folder.join("out").join(file)).unwrap();
    }
    let small = "Scene(base: \"scene.ron\")";
    std::fs::write(folder.join("small.ron"), small).unwrap();
    let few = ["--waves", "64", "--iterations", "1"];
    for (arguments, traces) in [
        (vec!["shader", "small.ron", "-o", "scene.ron"], false),
        (vec!["trace", "small.ron", "--dump-waves", "hard.csv"], true),
        (vec!["slice", "small.ron", "-o", "soft.png"], false),
        (vec!["demo", "small.ron", "--save", "scene.ron"], false),
        (vec!["shader", "scene.ron", "-o", "scene.ron"], false),
        (vec!["shader", "scene.ron", "-o", "./out/../h.png"], false),
        (vec!["trace", "scene.ron", "--dump-waves", "soft.csv"], true),
        (vec!["trace", "scene.ron", "--dump-waves", "hard.csv"], true),
        (
            vec!["render", "corner", "--sound", "v.wav", "-o", "v.wav"],
            true,
        ),
        (
            vec!["render", "corner", "--sound", "v.wav", "-o", "hard.wav"],
            true,
        ),
        (
            vec!["render", "corner", "--sound", "hard.wav", "-o", "v.wav"],
            true,
        ),
        (vec!["view", "scene.ron", "-o", "h.png"], false),
        (vec!["slice", "scene.ron", "-o", "soft.png"], false),
        (vec!["cost", "scene.ron", "-o", "soft.csv"], true),
        (vec!["accuracy", "scene.ron", "-o", "out"], false),
        (
            vec![
                "localise",
                "run",
                "--quick",
                "--scenes",
                "scene.ron",
                "-o",
                "out",
            ],
            false,
        ),
        (vec!["demo", "scene.ron", "--screenshot", "h.png"], false),
        (vec!["demo", "scene.ron", "--save", "scene.ron"], false),
        (
            vec!["demo", "--sound", "v.wav", "--record", "hard.wav"],
            false,
        ),
    ] {
        let mut arguments = arguments;
        if traces {
            arguments.extend(few);
        }
        let said = refusal(folder, &arguments);
        assert!(said.contains("input"), "{arguments:?}: {said}");
    }
    assert_eq!(std::fs::read_dir(folder.join("out")).unwrap().count(), 3);
}

/// Protects answer files if the score is written into their own folder.
#[test]
fn a_score_never_replaces_answers() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("score.json");
    std::fs::write(&file, answers("corner", "p1")).unwrap();
    let said = refusal(
        folder.path(),
        &["localise", "score", "score.json", "-o", "."],
    );
    assert!(
        said.contains("score.json") && said.contains("input"),
        "{said}"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
