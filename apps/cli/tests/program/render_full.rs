//! `echomarch render` with full listening on the command line: loudness, echoes, several sources, invalid input.

use crate::common::cli::{argument, json, refuse, stderr, stdout, succeed};
use crate::common::wav::{read_stereo, rms};
use serde_json::Value;
use std::path::Path;

const RATE: usize = 48_000;

/// A source passes behind a wall of 4 m. A larger wall behind it reflects its sound over the first wall, so that the
/// echo stays.
const WALK: &str = r#"Scene(
    surfaces: [
        Surface(shape: Box(size: (4, 3, 0.4)), position: (0, 0, -3)),
        Surface(shape: Plane, position: (0, 6, 0), rotation: (180, 0, 0), material: "ceiling"),
    ],
    materials: {
        "ceiling": Material(absorption: [0.1, 0.1, 0.1, 0.1, 0.3, 0.5, 0.7, 0.8]),
    },
    source: Source(position: (-8, 0, -6), path: [
        (time: 0, position: (-8, 0, -6)),
        (time: 4, position: (8, 0, -6)),
    ]),
    listener: Listener(position: (0, 0, 0), radius: 0.3),
)"#;

fn scene(folder: &Path, text: &str) -> String {
    let file = folder.join("walk.ron");
    std::fs::write(&file, text).unwrap();
    argument(&file).to_owned()
}

/// The strength of the only source in each frame.
fn levels(report: &Value) -> Vec<f64> {
    let frames = report["frames"].as_array().unwrap().iter();
    frames
        .map(|frame| frame["sources"][0]["g_db"].as_f64().unwrap())
        .collect()
}

/// Protects the effect of a wall on a sound: behind the wall the direct sound is absent, the level falls, the echo
/// stays, and nothing clicks at either edge.
#[test]
fn a_source_behind_a_wall_is_heard_by_its_echo() {
    let folder = tempfile::tempdir().unwrap();
    let file = scene(folder.path(), WALK);
    let wav = folder.path().join("walk.wav");
    let report = json(&[
        "render",
        &file,
        "-o",
        argument(&wav),
        "--sound",
        "sine:440",
        "--waves",
        "4096",
        "--tail",
        "0.2",
    ]);
    let direct = |frame: usize| &report["frames"][frame]["sources"][0]["direct"];
    assert_eq!(
        (direct(0), direct(60), direct(119)),
        (&true.into(), &false.into(), &true.into())
    );
    let levels = levels(&report);
    // In sight, there is direct sound over 10 m and an echo over 15.6 m. Behind the wall, there is only an echo over
    // 14.4 m.
    assert!(levels[60] < levels[0] - 2.0, "{} {}", levels[60], levels[0]);
    let [left, right] = read_stereo(&wav);
    let window = |at: usize| at * RATE / 2..(at + 1) * RATE / 2;
    let behind = rms(&left[window(4)]) + rms(&right[window(4)]);
    assert!(behind > 0.01, "the echo is gone: {behind}");
    // The source passes from left to right.
    assert!(rms(&left[window(0)]) > rms(&right[window(0)]));
    assert!(rms(&left[window(7)]) < rms(&right[window(7)]));
    // The maximum step of the sine itself: its amplitude of 0.5, the sum of both gains at the nearest position, 1/6 +
    // 1/12, and a margin for the Doppler shift at 4 m/s.
    let steepest = 2.0 * 0.5 * (std::f64::consts::PI * 440.0 / RATE as f64).sin() * 0.25 * 1.02;
    for samples in [&left, &right] {
        let step = samples.windows(2).map(|s| f64::from((s[1] - s[0]).abs()));
        let step = step.fold(0.0, f64::max);
        assert!(step <= steepest, "a step of {step}, above {steepest}");
        assert!(step > 0.05 * steepest, "{step}: no sound");
    }
}

/// Protects the effect of diffraction on a sound: behind the wall the source is louder than without diffraction, and in
/// sight it is as loud as without. `trace --levels` has the same option. A balance of waves has no diffraction.
#[test]
fn sound_bends_around_a_wall() {
    let folder = tempfile::tempdir().unwrap();
    let file = scene(folder.path(), WALK);
    let wav = folder.path().join("bent.wav");
    let render = |more: &[&str]| {
        let call = [
            "render",
            &file,
            "-o",
            argument(&wav),
            "--waves",
            "1024",
            "--tail",
            "0.1",
            "--fps",
            "5",
        ];
        levels(&json(&[&call, more].concat()))
    };
    let (plain, bent) = (render(&[]), render(&["--diffraction"]));
    let more_db: Vec<f64> = bent
        .iter()
        .zip(&plain)
        .map(|(bent, plain)| bent - plain)
        .collect();
    assert!(more_db[10] > 0.1, "{more_db:?}");
    assert!(more_db[0].abs() < 0.5, "{more_db:?}");
    let trace = |more: &[&str]| {
        let call = ["trace", &file, "--levels", "--time", "2", "--waves", "1024"];
        json(&[&call, more].concat())["levels"][0]["g_db"]
            .as_f64()
            .unwrap()
    };
    assert!(trace(&["--diffraction"]) > trace(&[]) + 0.1);
    refuse(
        &["trace", &file, "--diffraction"],
        "--diffraction needs --levels",
    );
    let balance = [
        "render",
        &file,
        "-o",
        argument(&wav),
        "--listen",
        "balance",
        "--diffraction",
    ];
    refuse(&balance, "--diffraction needs --listen full");
}

/// Protects a hidden source from vanishing: with `--least-level` it has this level relative to its direct sound in the
/// open, and the report names the added path. A level out of range is refused.
#[test]
fn a_hidden_source_keeps_its_least_level() {
    let folder = tempfile::tempdir().unwrap();
    let text = WALK.replace(
        "Surface(shape: Plane, position: (0, 6, 0), rotation: (180, 0, 0), material: \"ceiling\"),",
        "",
    );
    let file = scene(folder.path(), &text);
    let wav = folder.path().join("least.wav");
    let call = [
        "render",
        &file,
        "-o",
        argument(&wav),
        "--waves",
        "1024",
        "--tail",
        "0.1",
        "--fps",
        "5",
    ];
    let report = json(&[&call[..], &["--least-level", "-20"]].concat());
    // The source is 6 m away at 2 s.
    let source = &report["frames"][10]["sources"][0];
    let least_db = 20.0 * (10.0_f64 / 6.0).log10() - 20.0;
    assert!(
        (source["g_db"].as_f64().unwrap() - least_db).abs() < 0.01,
        "{source}"
    );
    assert_eq!(source["kinds"][0]["kind"], "added");
    assert_eq!(
        report["frames"][0]["sources"][0]["kinds"][0]["kind"],
        "direct"
    );
    let [left, _] = read_stereo(&wav);
    assert!(rms(&left[2 * RATE..2 * RATE + RATE / 5]) > 0.0);
    refuse(
        &[&call[..], &["--least-level", "1"]].concat(),
        "--least-level must be -100 to 0",
    );
}

/// Protects loudness and delay: a source of 0 dB at 2 m in the open has half the amplitude of its sound, and arrives 2
/// m / (343 m/s) later. `--gain` makes it louder. A repeated call gives the same bytes.
#[test]
fn distance_makes_soft_and_late() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"Scene(surfaces: [Surface(shape: Sphere(radius: 0.1), position: (0, -500, 0))],
        source: Source(position: (0, 0, -2)), listener: Listener(position: (0, 0, 0), radius: 0.2))"#;
    let file = scene(folder.path(), text);
    let render = |name: &str, more: &[&str]| {
        let wav = folder.path().join(name);
        let call = [
            &[
                "render",
                &file,
                "--sound",
                "noise",
                "--seconds",
                "0.5",
                "--waves",
                "4096",
                "-o",
            ],
            &[argument(&wav)][..],
            more,
        ];
        (json(&call.concat()), wav)
    };
    let (report, wav) = render("a.wav", &[]);
    let (_, again) = render("b.wav", &[]);
    assert_eq!(std::fs::read(&wav).unwrap(), std::fs::read(&again).unwrap());
    // The level of a distance of 2 m relative to 10 m.
    assert!((levels(&report)[0] - 13.979).abs() < 0.01);
    let [left, right] = read_stereo(&wav);
    // A source in front has a gain of √½ in each channel, times ½ for its distance.
    let noise = 0.25 / 3.0_f64.sqrt();
    for samples in [&left, &right] {
        let level = rms(&samples[RATE / 10..]);
        assert!(
            (level / (0.5 * 0.5_f64.sqrt() * 2.0 * noise) - 1.0).abs() < 0.02,
            "{level}"
        );
    }
    // The delay is 279.9 samples. The interpolating sinc function starts 8 samples earlier.
    let silent = left.iter().position(|sample| sample.abs() > 0.02).unwrap();
    assert!((278..=282).contains(&silent), "{silent}");
    let (louder, wav) = render("c.wav", &["--gain", "6dB"]);
    assert!((rms(&read_stereo(&wav)[0]) / rms(&left) - 1.9953).abs() < 1e-3);
    assert_eq!(louder["gain_db"], 6.0);
}

/// Protects several sources: each plays its own sound, and is listed with its name.
#[test]
fn each_source_plays_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"Scene(surfaces: [Surface(shape: Sphere(radius: 0.1), position: (0, -500, 0))], sources: [
            Source(name: "flute", position: (-3, 0, 0)), Source(name: "drum", position: (3, 0, 0)),
        ], listener: Listener(position: (0, 0, 0), radius: 0.2))"#;
    let file = scene(folder.path(), text);
    let wav = folder.path().join("two.wav");
    let call = [
        "render",
        &file,
        "--seconds",
        "0.5",
        "--waves",
        "4096",
        "-o",
        argument(&wav),
        "--sound",
        "flute=sine:440",
        "--sound",
        "drum=sine:1000",
    ];
    let report = json(&call);
    let sources = report["frames"][0]["sources"].as_array().unwrap();
    let names: Vec<_> = sources.iter().map(|source| &source["source"]).collect();
    assert_eq!(names, ["flute", "drum"]);
    assert!(stdout(&succeed(&call)).contains("source drum: G +10.5 dB, in sight"));
    let [left, right] = read_stereo(&wav);
    let crossings = |samples: &[f32]| {
        let rises = samples
            .windows(2)
            .filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0);
        rises.count() as f64 * 5.0
    };
    // A fifth of a second of each channel.
    let middle = 12_000..21_600;
    assert!((crossings(&left[middle.clone()]) - 440.0).abs() <= 5.0);
    assert!((crossings(&right[middle]) - 1000.0).abs() <= 5.0);
}

/// Protects users from options without an effect, and from unknown names.
#[test]
fn what_makes_no_sense_is_refused() {
    let base = ["render", "open-field", "-o", "x.wav"];
    for (more, says) in [
        (
            &["--listen", "full", "--law", "linear"][..],
            "--law has no effect on --listen full, which pans each arrival with constant power: use --listen balance",
        ),
        (&["--listen", "balance", "--gain", "3"], "--listen full"),
        (
            &["--profile", "thesis", "--listen", "full"],
            "--listen balance",
        ),
        (&["--profile", "thesis", "--tail", "1"], "--listen full"),
        (&["--listener", "nobody"], "no listener \"nobody\""),
        (&["--sound", "drum=noise"], "it has: 1"),
        (&["--tail", "99"], "--tail must be 0.001 to 60"),
        (&["--gain", "-500dB"], "--gain must be"),
        (&["--iterations", "9", "--order", "2"], "--listen full"),
    ] {
        refuse(&[&base, more].concat(), says);
    }
}

/// Protects users who type an option of the balance: a note states how it changes the sound.
#[test]
fn a_balance_that_an_option_chose_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.wav");
    let file = file.to_str().unwrap();
    let short = [
        "render",
        "corner",
        "-o",
        file,
        "--seconds",
        "0.05",
        "--waves",
        "1024",
    ];
    let told = "note: --iterations belongs to --listen balance";
    let errors = |more: &[&str]| stderr(&succeed(&[&short, more].concat())).to_owned();
    assert!(errors(&["--iterations", "4"]).contains(told));
    assert!(!errors(&["--iterations", "4", "--listen", "balance"]).contains(told));
}
