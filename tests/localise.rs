//! Where is the source? The observer's error in the open and in rooms, its report, and the
//! score of people's answers.
#![cfg(feature = "cli")]

mod common;

use common::cli::{argument, echomarch, json, stderr, stdout, succeed};
use common::{builtin, tracer};
use echomarch::audio::PanningLaw;
use echomarch::experiment::localise::{
    COLUMNS, LoadedSound, LocaliseOptions, LocaliseReport, Observer, facings, markdown, observe,
    observer, plot_svg, run, source_at, write_csv,
};
use echomarch::experiment::median;
use echomarch::{Profile, Scene, Settings};
use glam::{Quat, Vec3};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn sound(name: &str) -> LoadedSound {
    LoadedSound::new(&name.parse().unwrap(), 0.5).unwrap()
}

/// The acceptance of the observer: with 65,536 waves of the default profile it is less than
/// 5° off at the median in the open, whatever the sound, and for most single azimuths too.
#[test]
fn a_source_in_the_open_is_found_to_less_than_5_degrees() {
    let field = builtin("open-field");
    let mut tracer = tracer();
    for (name, law) in [
        ("sine:500", PanningLaw::Linear),
        ("speech", PanningLaw::ConstantPower),
    ] {
        let sound = sound(name);
        let mut errors = Vec::new();
        for azimuth in [-80.0, -50.0, -20.0, 0.0, 30.0, 60.0, 80.0] {
            let scene = source_at(&field, azimuth, 5.0);
            let mut here = Vec::new();
            for seed in 1..=3 {
                let settings = Settings::default().with_iterations(1).with_seed(seed);
                let answer = observe(&mut tracer, &scene, &settings, &sound, law).unwrap();
                here.push((answer - azimuth).abs());
            }
            let worst = median(here.iter().copied());
            assert!(worst < 5.0, "{name}, {azimuth}: {worst}");
            errors.extend(here);
        }
        let all = median(errors);
        assert!(all < 1.5, "{name}: {all}");
    }
}

/// Behind has the levels of ahead: the observer folds to the front, and says so.
#[test]
fn behind_is_answered_as_in_front() {
    let scene = source_at(&builtin("open-field"), 150.0, 5.0);
    assert!((observer::azimuth_deg(&scene) - 150.0).abs() < 1e-3);
    assert!((observer::lateral_deg(&scene) - 30.0).abs() < 1e-3);
    let settings = Settings::default().with_iterations(1);
    let law = PanningLaw::Linear;
    let answer = observe(&mut tracer(), &scene, &settings, &sound("noise"), law).unwrap();
    assert!((answer - 30.0).abs() < 3.0, "{answer}");
}

/// The scene in a mirror: left is right.
fn mirrored(scene: &Scene) -> Scene {
    let mirror = |v: Vec3| v * Vec3::new(-1.0, 1.0, 1.0);
    let mut mirrored = scene.clone();
    mirrored.source.position = mirror(scene.source.position);
    mirrored.listener.position = mirror(scene.listener.position);
    mirrored.listener.yaw = -scene.listener.yaw;
    for surface in &mut mirrored.surfaces {
        surface.position = mirror(surface.position);
        let [x, y, z, w] = surface.rotation.to_array();
        surface.rotation = Quat::from_xyzw(x, -y, -z, w);
    }
    mirrored
}

/// Truths and answers have one handedness. The start directions are not mirrored with the
/// scene: 262,144 waves answer alike to about a degree.
#[test]
fn mirrored_rooms_are_answered_mirrored() {
    let mut tracer = tracer();
    let settings = Settings::default().with_waves(262_144).with_iterations(4);
    for scene in facings(&builtin("corner")) {
        let there = mirrored(&scene);
        let truths = observer::lateral_deg(&scene) + observer::lateral_deg(&there);
        assert!(truths.abs() < 1e-3);
        let mut answer = |scene| {
            let law = PanningLaw::Linear;
            observe(&mut tracer, scene, &settings, &sound("sine:500"), law).unwrap()
        };
        let (here, there) = (answer(&scene), answer(&there));
        assert!((here + there).abs() < 3.0, "{here}, mirrored {there}");
    }
}

fn small() -> LocaliseOptions {
    let sounds = ["sine:500", "speech"].map(|name| name.parse().unwrap());
    let scenes = ["corner", "obstacles"].map(builtin);
    LocaliseOptions {
        waves: vec![256, 1024, 4096],
        iterations: vec![4, 8],
        seeds: 2,
        limit: (65_536, 2),
        azimuths_deg: vec![-60.0, 0.0, 60.0],
        ..LocaliseOptions::new(scenes.to_vec(), sounds.to_vec())
    }
}

fn report() -> LocaliseReport {
    let mut steps = (0, 0);
    let report = run(&mut tracer(), &small(), &mut |done, total| {
        assert_eq!(done, steps.0 + 1);
        steps = (done, total);
    });
    assert_eq!(steps.0, steps.1, "all steps are told, and no more");
    report.unwrap()
}

/// One run, everything that is said of it: sums, intervals, plateaus, files.
#[test]
fn a_report_adds_up_and_becomes_csv_markdown_and_svg() {
    let report = report();
    assert_eq!((report.open.len(), report.scenes.len()), (4, 2));
    for scene in &report.scenes {
        assert_eq!((scene.facings.len(), scene.cells.len()), (3, 2 * 3 * 3 * 2));
        for cell in &scene.cells {
            let rows = cell.confusion.map(|row| row.iter().sum::<u32>());
            assert_eq!(rows, [2, 2, 2], "each facing has two trials");
            assert_eq!(cell.trials, 6);
            for error in [cell.source, cell.limit] {
                let median = error.median_abs_deg;
                assert!(error.low_deg <= median && median <= error.high_deg);
                assert!(error.bias_deg.abs() <= 180.0 && error.spread_deg >= 0.0);
            }
        }
    }
    // The gains are the same at every frequency.
    assert!(report.largest_difference_of_sounds_deg < 1e-3);
    let deaf = report.scenes[1]
        .cells
        .iter()
        .find(|cell| cell.profile == "thesis" && cell.iterations == 4 && cell.waves == 4096);
    let deaf = deaf.unwrap();
    assert_eq!((deaf.unheard, deaf.hits), (1.0, 0.0));
    assert_eq!(deaf.confusion, [[0, 2, 0]; 3], "silence is the middle");

    // Two scenes, two sounds, three profiles; three counts of waves at two of iterations.
    assert_eq!(report.plateaus.len(), 2 * 2 * 3 * 2 * 2);
    let nothing = report.plateaus.iter().find(|plateau| {
        plateau.scene == "obstacles" && plateau.profile == "thesis" && plateau.fixed == 4
    });
    assert_eq!(nothing.unwrap().count, None);

    let mut csv = Vec::new();
    write_csv(&report, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 1 + 4 * 3 + 2 * 36);
    assert_eq!(lines[0], COLUMNS.join(","));
    let text = markdown(&report);
    for heading in ["## In the open", "## corner", "## What is heard at all"] {
        assert!(text.contains(heading), "{text}");
    }
    let svg = plot_svg(&report).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("obstacles, 8 iterations"));
}

/// The thesis' profile is deaf where its own tables say so, and the default is not.
#[test]
fn in_obstacles_the_thesis_hears_next_to_nothing() {
    let mut tracer = tracer();
    let scene = builtin("obstacles");
    let mut hits = |profile, iterations| {
        let settings = Settings::of(profile).with_waves(262_144);
        let frame = tracer.frame(&scene, &settings.with_iterations(iterations));
        frame.unwrap().counts.listener_hits
    };
    assert_eq!(hits(Profile::Thesis, 4), 0);
    assert!(hits(Profile::Hybrid, 8) > 5 * hits(Profile::Thesis, 8));
    assert!(Observer::new(&scene, PanningLaw::Linear).mean_side() > 0.7);
}

/// The program's run writes what it says, and refuses what it cannot do before it begins.
#[test]
fn the_program_runs_the_observer() {
    let folder = tempfile::tempdir().unwrap();
    let out = argument(folder.path());
    let arguments = [
        "localise",
        "run",
        "-o",
        out,
        "--scenes",
        "corner",
        "--sounds",
        "sine:300",
        "--profiles",
        "hybrid",
        "--waves",
        "256,1024,256",
        "--iterations",
        "4",
        "--seeds",
        "2",
    ];
    let output = succeed(&arguments);
    assert!(stdout(&output).contains("localise.md"));
    for ending in ["csv", "json", "svg", "md"] {
        let file = folder.path().join(format!("localise.{ending}"));
        assert!(fs::metadata(file).unwrap().len() > 100);
    }
    let cases: [(&[&str], &str); 6] = [
        (&["run", "--scenes", "nowhere"], "nowhere"),
        (&["run", "--sounds", "bark"], "bark"),
        (&["run", "--waves", "0"], "waves"),
        (&["run", "--seeds", "1"], "--seeds"),
        (&["run", "-o", "/dev/null/out"], "/dev/null/out"),
        (&["form", "-o", "/dev/null/out"], "/dev/null/out"),
    ];
    for (arguments, told) in cases {
        refuse(&[&["localise"], arguments].concat(), told);
    }
}

fn refuse(arguments: &[&str], told: &str) {
    let output = echomarch(arguments);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(said.contains(told), "{arguments:?}: {said}");
    assert_eq!(said.trim_end().lines().count(), 1, "one sentence: {said}");
    assert!(output.stdout.is_empty());
}

fn write_form(folder: &Path, seed: &str, sounds: &str) -> Value {
    json(&[
        "localise",
        "form",
        "-o",
        argument(folder),
        "--seed",
        seed,
        "--scenes",
        "corner",
        "--sounds",
        sounds,
        "--waves",
        "256",
        "--iterations",
        "2,4",
        "--seconds",
        "0.2",
    ])
}

/// What is heard in which order, without what the seed does to the waves.
fn order(form: &Value) -> Vec<(String, String)> {
    let trials = form["trials"].as_array().unwrap().iter();
    let of = |trial: &Value| {
        let stimulus = &trial["stimulus"];
        (
            stimulus["yaw_deg"].to_string(),
            stimulus["iterations"].to_string(),
        )
    };
    trials.map(of).collect()
}

/// The order hangs on the seed alone; the files are all there; nothing is ever replaced.
#[test]
fn a_form_is_shuffled_by_its_seed_and_replaces_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let first = write_form(&at("first"), "7", "sine:500");
    assert_eq!(first["trials"].as_array().unwrap().len(), 6);
    let again = write_form(&at("again"), "7", "sine:300");
    let other = write_form(&at("other"), "8", "sine:500");
    assert_eq!(order(&first), order(&again));
    assert_ne!(order(&first), order(&other));
    assert_ne!(first["experiment"], again["experiment"]);
    let counted = |form: &Value| {
        let mut counts = BTreeMap::new();
        for trial in order(form) {
            *counts.entry(trial).or_insert(0) += 1;
        }
        counts
    };
    assert_eq!(counted(&first), counted(&other));
    for number in 1..=6 {
        let wav = at("first").join(format!("sounds/{number:03}.wav"));
        let reader = hound::WavReader::open(wav).unwrap();
        assert_eq!((reader.spec().channels, reader.duration()), (2, 9600));
    }
    let page = fs::read(at("first").join("form.html")).unwrap();
    let text = String::from_utf8(page.clone()).unwrap();
    assert!(
        !text.contains("http://") || !text.contains("src=\"http"),
        "no network"
    );
    let folder = argument(&at("first")).to_owned();
    refuse(&["localise", "form", "-o", &folder], "is not empty");
    assert_eq!(fs::read(at("first").join("form.html")).unwrap(), page);
}

/// A file of answers as the form saves it: three trials, to the left, ahead and right.
fn answers(session: &str, given: usize) -> Value {
    let trial = |(index, (truth, clicked)): (usize, (f64, f64))| {
        let side = match clicked {
            angle if angle < -15.0 => "left",
            angle if angle > 15.0 => "right",
            _ => "centre",
        };
        let (sin, cos) = f64::to_radians(clicked).sin_cos();
        json!({
            "number": index + 1,
            "stimulus": {
                "scene": "corner", "yaw_deg": 0.0, "sound": "speech", "law": "linear",
                "profile": "hybrid", "waves": 1024, "iterations": 8, "seed": 1, "pan": -0.1,
                "hits": 60, "source_azimuth_deg": truth, "source_lateral_deg": truth,
                "observer_lateral_deg": -8.0,
            },
            "answer": (index < given).then(|| json!({
                "right_m": 4.0 * sin, "ahead_m": 4.0 * cos, "azimuth_deg": clicked, "side": side,
                "confidence": 3, "plays": 2, "seconds": 6.5,
                "answered": "2026-11-20T20:00:00.000Z",
            })),
        })
    };
    let trials = [(-48.0, -40.0), (0.0, 170.0), (48.0, -20.0)];
    json!({
        "format": "echomarch-localise-answers", "version": 1, "experiment": "00c0ffee",
        "session": session, "participant": "p1", "started": "2026-11-20T19:50:00.000Z",
        "saved": "2026-11-20T20:00:00.000Z",
        "trials": trials.into_iter().enumerate().map(trial).collect::<Vec<_>>(),
    })
}

fn write(folder: &Path, name: &str, text: &Value) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, text.to_string()).unwrap();
    path
}

/// The score of answers whose figures can be reckoned by hand.
#[test]
fn answers_are_scored() {
    let folder = tempfile::tempdir().unwrap();
    let whole = write(folder.path(), "whole.json", &answers("a", 3));
    let report = json(&["localise", "score", argument(&whole)]);
    let all = &report["groups"][0];
    // Folded, the clicks are at -40, 10 and -20: 8, 10 and 68 degrees off.
    assert_eq!((&all["answers"], &all["scene"]), (&json!(3), &json!("")));
    let median = all["source"]["median_abs_deg"].as_f64().unwrap();
    assert!((median - 10.0).abs() < 1e-6, "{median}");
    assert_eq!(all["confusion"], json!([[1, 0, 0], [0, 0, 1], [1, 0, 0]]));
    let confused = all["front_back_confused"].as_f64().unwrap();
    assert!((confused - 1.0 / 3.0).abs() < 1e-9);
    assert_eq!(report["groups"][1]["scene"], "corner");

    let text = succeed(&["localise", "score", argument(&whole)]);
    assert!(stdout(&text).contains("corner") && stdout(&text).contains("front-back"));
    let help = succeed(&["localise", "score", "--help"]);
    assert!(stdout(&help).contains("Examples:"));
}

/// A session that was broken off counts for what it holds, files of one session count once,
/// and an empty one is told as such.
#[test]
fn broken_off_sessions_are_scored_and_merged() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name, text| write(folder.path(), name, &text);
    let part = file("part.json", answers("a", 1));
    let whole = file("whole.json", answers("a", 3));
    let other = file("other.json", answers("b", 2));
    let none = file("none.json", answers("c", 0));
    let score = |files: &[&PathBuf]| {
        let files: Vec<&str> = files.iter().map(|file| argument(file)).collect();
        json(&[&["localise", "score"], files.as_slice()].concat())
    };
    let report = score(&[&part]);
    assert_eq!(report["groups"][0]["answers"], 1);
    assert!(
        report["notes"][0]
            .as_str()
            .unwrap()
            .contains("2 of 3 trials")
    );
    for files in [[&part, &whole, &other], [&other, &whole, &part]] {
        let report = score(&files);
        assert_eq!(report["groups"][0]["answers"], 5);
        assert_eq!(report["sessions"].as_array().unwrap().len(), 2);
        let notes = report["notes"].to_string();
        assert!(
            notes.contains("of one session, a, and count once"),
            "{notes}"
        );
    }
    assert_eq!(score(&[&none])["groups"], json!([]));
    let output = succeed(&["localise", "score", argument(&none)]);
    assert!(stdout(&output).contains("No trial is answered."));
}

/// Whatever is wrong with a file is told in a sentence with its name, and exit code 2.
#[test]
fn bad_answers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let changed = |path: &str, value: Value| {
        let mut text = answers("a", 3);
        *text.pointer_mut(path).unwrap() = value;
        text
    };
    let cases = [
        (changed("/format", json!("shopping-list")), "shopping-list"),
        (changed("/version", json!(2)), "version 2"),
        (changed("/trials", json!([])), "no trial"),
        (changed("/trials/1/number", json!(1)), "trial 1"),
        (changed("/trials/1/answer/azimuth_deg", json!(400.0)), "400"),
        (
            changed("/trials/0/answer/azimuth_deg", json!(40.0)),
            "click",
        ),
        (
            changed("/trials/2/answer/confidence", json!(9)),
            "confidence",
        ),
        (changed("/trials/2/answer/side", json!("above")), "above"),
        (changed("/trials/0/stimulus/pan", json!(-3.0)), "pan"),
        (json!([1, 2]), "no answers"),
    ];
    for (text, told) in &cases {
        let file = write(folder.path(), "bad.json", text);
        refuse(&["localise", "score", argument(&file)], told);
        refuse(&["localise", "score", argument(&file)], "bad.json");
    }
    let absent = folder.path().join("absent.json");
    refuse(&["localise", "score", argument(&absent)], "absent.json");
    let cut = folder.path().join("cut.json");
    let text = answers("a", 3).to_string();
    fs::write(&cut, &text[..text.len() / 2]).unwrap();
    refuse(&["localise", "score", argument(&cut)], "cut.json");
    // Locked answers never change: two files that differ are not both right.
    let one = write(folder.path(), "one.json", &answers("a", 3));
    let other = changed("/trials/0/answer/confidence", json!(5));
    let other = write(folder.path(), "two.json", &other);
    let both = ["localise", "score", argument(&one), argument(&other)];
    refuse(&both, "differ in trial 1");
}
