//! Localisation: the error of the observer model in the open and in rooms, its report, and the contents of the form for
//! people.

use crate::common::cli::{argument, json, refuse, stdout, succeed};
use crate::common::{Random, builtin, mirrored, tracer};
use echomarch::audio::PanningLaw;
use echomarch::geometry::ExactScene;
use echomarch::{Profile, Scene, Settings};
use echomarch_lab::experiment::localise::statistics::ErrorFigures;
use echomarch_lab::experiment::localise::{
    LoadedSound, LocaliseOptions, LocaliseReport, converge, facings, observe, observer, run,
    source_at, without_ground,
};
use echomarch_lab::experiment::median;
use echomarch_lab::report::Report;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn sound(name: &str) -> LoadedSound {
    LoadedSound::new(&name.parse().unwrap(), 0.5).unwrap()
}

/// Azimuths of the source in the open, in degrees.
const AZIMUTHS: [f64; 7] = [-80.0, -50.0, -20.0, 0.0, 30.0, 60.0, 80.0];

/// The median error of three frames in the open, for each azimuth and over all azimuths, in degrees.
fn errors_in(
    field: &Scene,
    settings: &Settings,
    sound: &LoadedSound,
    law: PanningLaw,
) -> (Vec<f64>, f64) {
    let mut tracer = tracer();
    let (mut medians, mut all) = (Vec::new(), Vec::new());
    for azimuth in AZIMUTHS {
        let scene = source_at(field, azimuth, 5.0);
        let mut here = Vec::new();
        for seed in 1..=3 {
            let settings = settings.clone().with_seed(seed);
            let answer = observe(&mut tracer, &scene, &settings, sound, law).unwrap();
            here.push((answer - azimuth).abs());
        }
        medians.push(median(here.iter().copied()));
        all.extend(here);
    }
    (medians, median(all))
}

/// Protects the acceptance criterion of the observer model. With 65,536 waves of the default profile and only the
/// direct path (1 iteration), the median error in the open is below 5° for every sound. The error is also below 5° for
/// each single azimuth.
#[test]
fn by_the_straight_way_a_source_in_the_open_is_found_to_less_than_5_degrees() {
    let field = builtin("open-field");
    let settings = Settings::default().with_iterations(1);
    for (name, law) in [
        ("sine:500", PanningLaw::Linear),
        ("speech", PanningLaw::ConstantPower),
    ] {
        let (medians, all) = errors_in(&field, &settings, &sound(name), law);
        for (azimuth, error) in AZIMUTHS.iter().zip(medians) {
            assert!(error < 5.0, "{name}, {azimuth}: {error}");
        }
        assert!(all < 1.5, "{name}: {all}");
    }
}

/// Protects the same criterion with the default 8 iterations, in a field without a ground. This result shows that the
/// ground causes the failure of the criterion, and not the iterations.
#[test]
fn without_a_ground_the_defaults_find_a_source_to_less_than_5_degrees() {
    let field = without_ground(&builtin("open-field"));
    let sound = sound("sine:500");
    let (medians, all) = errors_in(&field, &Settings::default(), &sound, PanningLaw::Linear);
    for (azimuth, error) in AZIMUTHS.iter().zip(medians) {
        assert!(error < 5.0, "{azimuth}: {error}");
    }
    assert!(all < 1.5, "{all}");
}

/// Protects the documented effect of the ground: with the default 8 iterations, reflections from the ground pull the
/// answers to the middle, so that the criterion of 5° is *not* met. The median over these azimuths is 6.7°, and 19° at
/// ±80°. The seeds scatter by 0.6°, so bounds one and two degrees above these values are not exceeded by chance.
#[test]
fn with_the_ground_heard_the_error_in_the_open_is_bounded() {
    let field = builtin("open-field");
    let sound = sound("sine:500");
    let (medians, all) = errors_in(&field, &Settings::default(), &sound, PanningLaw::Linear);
    assert!(5.0 < all && all < 8.0, "{all}");
    for (azimuth, error) in AZIMUTHS.iter().zip(medians) {
        assert!(error < 21.0, "{azimuth}: {error}");
    }
}

/// A source behind the listener has the levels of a source in front. The observer model cannot tell them apart, and
/// answers in front.
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

/// True directions and answers have the same handedness. The start directions are not mirrored with the scene, but
/// 262,144 waves give the same answer to about a degree.
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

/// Protects the meaning of `limit`: the converged panning of `hybrid` equals that of exact waves in double precision
/// with other start directions. The tolerance is four standard errors of the exact waves' mean side, about 0.6 ÷
/// √(heard waves).
#[test]
fn the_converged_panning_is_that_of_exact_waves() {
    const ITERATIONS: u32 = 8;
    let mut tracer = tracer();
    for (name, waves) in [("corner", 1 << 16), ("obstacles", 1 << 20)] {
        let scene = builtin(name);
        let found = converge(&mut tracer, &scene, ITERATIONS, (1 << 20, 2)).unwrap();
        let exact = ExactScene::new(&scene).unwrap();
        let mut random = Random(1958);
        let directions = random.directions(waves);
        let start = scene.sources[0].position.as_dvec3();
        let waves = exact.trace_all(start, &directions, ITERATIONS);
        let sides = waves.iter().filter_map(|wave| exact.arrival_side(wave));
        let sides: Vec<f64> = sides.collect();
        let mean = sides.iter().sum::<f64>() / sides.len() as f64;
        let allowed = 4.0 * 0.6 / (sides.len() as f64).sqrt();
        assert!(allowed < 0.1, "{name}: {} waves are too few", sides.len());
        assert!(
            (mean - found.pan).abs() < allowed,
            "{name}: {mean}, {found:?}"
        );
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
    assert_eq!(steps.0, steps.1, "exactly all steps are reported");
    report.unwrap()
}

/// Checks one run and all of its output: sums, confidence intervals, plateaus, files.
#[test]
fn a_report_adds_up_and_becomes_csv_markdown_and_svg() {
    let report = report();
    assert_eq!((report.open.len(), report.scenes.len()), (5, 2));
    for scene in &report.scenes {
        assert_eq!((scene.facings.len(), scene.cells.len()), (3, 2 * 3 * 3 * 2));
        for cell in &scene.cells {
            let rows = cell.confusion.map(|row| row.iter().sum::<u32>());
            assert_eq!(rows, [2, 2, 2], "each facing has two trials");
            assert_eq!(cell.trials, 6);
            let silent: u32 = cell.confusion.iter().map(|row| row[3]).sum();
            assert_eq!(silent, (6.0 * cell.unheard).round() as u32);
            assert_eq!(cell.source.is_none(), silent == 6);
            for error in [cell.source, cell.limit].into_iter().flatten() {
                assert_eq!(error.answers, 6 - silent as usize);
                check_figures(&error);
            }
        }
    }
    check_open(&report);
    // The gains are the same at every frequency.
    assert!(report.largest_difference_of_sounds_deg < 1e-3);
    let deaf = report.scenes[1]
        .cells
        .iter()
        .find(|cell| cell.profile == "thesis" && cell.iterations == 4 && cell.waves == 4096);
    let deaf = deaf.unwrap();
    assert_eq!((deaf.unheard, deaf.hits), (1.0, 0.0));
    assert_eq!(deaf.confusion, [[0, 0, 0, 2]; 3], "silence is no answer");
    assert_eq!(
        (deaf.source, deaf.limit, deaf.side_right),
        (None, None, None)
    );

    // There are two scenes, two sounds and three profiles, each with two numbers of iterations. For each of these there
    // are three plateaus over the number of waves: two of medians and one of a spread.
    assert_eq!(report.plateaus.len(), 2 * 2 * 3 * 2 * 3);
    let nothing = report.plateaus.iter().find(|plateau| {
        plateau.scene == "obstacles" && plateau.profile == "thesis" && plateau.fixed == 4
    });
    assert_eq!(nothing.unwrap().count, None);
    check_files(&report);
}

/// The texts and the plot contain the report's data.
fn check_files(report: &LocaliseReport) {
    let mut csv = Vec::new();
    report.table().write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 1 + 5 * (3 + 3) + 2 * 36);
    let columns = report.table().names();
    assert_eq!(lines[0], columns.join(","));
    for end in ["", "_low", "_high"] {
        for figure in ["median_abs", "bias", "outward_bias", "spread"] {
            let wanted = format!("source_{figure}{end}");
            assert!(columns.contains(&wanted), "{wanted}");
        }
    }
    let text = report.document().markdown();
    for heading in [
        "## In the open",
        "## corner",
        "## What is heard at all",
        "rough: fewer than 5 seeds",
    ] {
        assert!(text.contains(heading), "{text}");
    }
    let svg = report.plot_svg().unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("obstacles, 8 iterations"));
    assert!(svg.contains("rough interval"));
}

/// Confidence intervals contain their figures, and the interval of two seeds is marked as rough.
fn check_figures(error: &ErrorFigures) {
    assert!(error.rough);
    for figure in [error.median_abs, error.bias] {
        if let Some([low, high]) = figure.interval_deg {
            assert!(low <= figure.deg && figure.deg <= high, "{error:?}");
        }
    }
}

/// In the open, a known distance reduces the error. Sources in front, behind and above get the same answer if only the
/// direct path is heard.
fn check_open(report: &LocaliseReport) {
    for open in &report.open {
        let (told, blind) = (open.all.unwrap(), open.blind.unwrap());
        let straight = open.iterations == 1 || !open.ground;
        if !straight {
            continue;
        }
        assert!(told.median_abs.deg < 2.0);
        assert!(blind.median_abs.deg > 5.0 + told.median_abs.deg);
        assert!(blind.outward_bias.unwrap().deg > 5.0, "too far beside");
        let directions: Vec<(f64, f64)> = open
            .alike
            .iter()
            .map(|at| (at.azimuth_deg, at.elevation_deg))
            .collect();
        assert_eq!(directions, [(30.0, 0.0), (150.0, 0.0), (45.0, 45.0)]);
        for at in &open.alike {
            assert!((at.lateral_deg - 30.0).abs() < 1e-3);
            let answer = at.answer_deg.unwrap();
            assert!((answer - 30.0).abs() < 2.0, "{at:?}");
        }
    }
}

/// The profile `thesis` hears no wave in the cases in which the thesis' own tables have none. The default profile does
/// hear waves.
#[test]
fn in_obstacles_the_thesis_hears_next_to_nothing() {
    let mut tracer = tracer();
    let scene = builtin("obstacles");
    let mut hits = |profile, iterations| {
        let settings = Settings::new(profile).with_waves(262_144);
        let frame = tracer.frame(&scene, &settings.with_iterations(iterations));
        frame.unwrap().counts.listener_hits
    };
    assert_eq!(hits(Profile::Thesis, 4), 0);
    let (thesis, hybrid) = (hits(Profile::Thesis, 8), hits(Profile::Hybrid, 8));
    assert!(thesis > 0 && hybrid > 5 * thesis, "{thesis}, {hybrid}");
}

/// The subcommand `run` writes the files that it prints, and refuses impossible requests before it begins.
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
    assert!(stdout(&output).contains("localise.csv, .json, .md, .svg"));
    let file = |ending: &str| {
        fs::read_to_string(folder.path().join(format!("localise.{ending}"))).unwrap()
    };
    // The rows are three cases in the open, each with 17 azimuths and 3 directions with equal levels, then one row for
    // each of the two numbers of waves.
    assert_eq!(file("csv").lines().count(), 1 + 3 * (17 + 3) + 2);
    let report: Value = serde_json::from_str(&file("json")).unwrap();
    let cells = report["scenes"][0]["cells"].as_array().unwrap();
    let waves: Vec<&Value> = cells.iter().map(|cell| &cell["waves"]).collect();
    assert_eq!(waves, [256, 1024]);
    assert!(file("md").contains("| hybrid | 1024 | 4 |"));
    assert!(file("md").contains("(localise.svg)"), "the plot is shown");
    let svg = file("svg");
    assert!(svg.contains("corner, 4 iterations"), "named in the plot");
    assert!(svg.contains("corner, 1024 waves"), "named in the plot");
    let cases: [(&[&str], &str); 8] = [
        (&["run", "--scenes", "nowhere"], "nowhere"),
        (&["run", "--sounds", "bark"], "bark"),
        (&["run", "--waves", "0"], "waves"),
        (&["run", "--seeds", "1"], "--seeds"),
        (
            &["run", "--waves", "1048576", "--iterations", "8,16"],
            "too large",
        ),
        (&["run", "--waves", "16777216"], "too large"),
        (&["run", "-o", "/dev/null/out"], "/dev/null/out"),
        (&["form", "-o", "/dev/null/out"], "/dev/null/out"),
    ];
    for (arguments, told) in cases {
        refuse(&[&["localise"], arguments].concat(), told);
    }
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

/// Returns the order of the stimuli, independent of the seed's effect on the waves.
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

/// The order depends only on the seed, all files exist, and no file is ever replaced.
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
    // The only URL is the SVG namespace, which is never fetched.
    let addresses = text.replace("http://www.w3.org/2000/svg", "");
    for scheme in ["http:", "https:", "src=\"//", "href=\"//"] {
        assert!(!addresses.contains(scheme), "no network, but {scheme}");
    }
    let folder = argument(&at("first")).to_owned();
    refuse(&["localise", "form", "-o", &folder], "is not empty");
    assert_eq!(fs::read(at("first").join("form.html")).unwrap(), page);
}
