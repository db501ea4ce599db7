//! The program on the command line.

use crate::common::cli::{argument, command, json, stderr, stdout, succeed};
use crate::common::wav::{read_stereo, rms};
use crate::common::{builtin, thesis, tracer};
use echomarch::audio::Sound;
use std::process::Stdio;

const SUBCOMMANDS: [&str; 4] = ["figures", "trace", "render", "info"];

/// The keys at this depth of indented JSON, in order.
fn keys(text: &str, depth: usize) -> Vec<&str> {
    let indent = format!("{}\"", "  ".repeat(depth));
    let lines = text.lines().filter_map(|line| line.strip_prefix(&indent));
    lines
        .filter_map(|line| line.split_once("\":"))
        .map(|(key, _)| key)
        .collect()
}

/// Protects the help as a starting point: the help of each subcommand has examples that contain its name.
#[test]
fn every_help_has_examples() {
    let whole = succeed(&["--help"]);
    for subcommand in SUBCOMMANDS {
        assert!(stdout(&whole).contains(subcommand), "{subcommand}");
        let help = succeed(&[subcommand, "--help"]);
        let help_text = stdout(&help);
        assert!(help_text.contains("Usage: echomarch"), "{help_text}");
        assert!(stderr(&help).is_empty());
        let examples = help_text.split_once("Examples:").map(|(_, rest)| rest);
        let named = format!("echomarch {subcommand}");
        assert!(examples.is_some_and(|e| e.contains(&named)), "{help_text}");
    }
    assert!(stdout(&whole).contains("Examples:"));
}

/// Protects users who look for a scene: the help and the scene format document list every built-in scene.
#[test]
fn every_built_in_scene_is_named_where_scenes_are_listed() {
    let document = include_str!("../../../../docs/scene-format.md");
    let of = |arguments: &[&str]| stdout(&succeed(arguments)).to_owned();
    let lists = [
        of(&["--help"]),
        of(&["demo", "--help"]),
        document.to_owned(),
    ];
    for list in lists {
        for name in echomarch::Scene::BUILTIN_NAMES {
            let mut words = list.split(|c: char| !(c.is_alphanumeric() || c == '-'));
            assert!(words.any(|word| word == name), "{name}: {list}");
        }
    }
}

/// Protects scripts that read the report: exactly these keys, in this order.
#[test]
fn trace_reports_the_documented_keys() {
    let output = succeed(&[
        "trace",
        "corner",
        "--profile",
        "thesis",
        "--waves",
        "1000",
        "--seed",
        "7",
        "--json",
    ]);
    let text = stdout(&output);
    let expected = [
        "scene",
        "profile",
        "min_distance",
        "start_offset",
        "normal_step",
        "waves",
        "iterations",
        "max_distance",
        "seed",
        "directions",
        "iterations_per_pass",
        "sum_on_gpu",
        "count_evaluations",
        "renderer",
        "clock",
        "listener_hits",
        "dead",
        "travelling",
        "not_finite",
        "zero_length_passes",
        "step_limit_reached",
        "left",
        "right",
        "pan",
        "law",
        "gains",
        "timed_frames",
        "milliseconds",
    ];
    assert_eq!(keys(text, 1), expected);
    let times = ["initialise", "march", "pan", "read_back", "total"];
    assert_eq!(keys(text, 2), times);

    let report: serde_json::Value = serde_json::from_str(text).unwrap();
    assert_eq!(report["scene"], "corner");
    assert_eq!(report["profile"], "thesis");
    assert_eq!(
        (&report["waves"], &report["seed"]),
        (&1000.into(), &7.into())
    );
    let settings = thesis(1000, 8).with_seed(7);
    let frame = tracer().frame(&builtin("corner"), &settings).unwrap();
    assert_eq!(report["listener_hits"], frame.counts.listener_hits);
    assert_eq!(
        report["zero_length_passes"],
        frame.counts.zero_length_passes
    );
    assert_eq!(report["pan"], frame.panning.pan());
}

/// Protects `--dump-waves`: it writes one row per wave, its numbers restore the exact bits that the library returns,
/// and the same seed gives the same bytes.
#[test]
fn dumped_waves_are_those_of_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let dump = |name: &str, seed: &str| {
        let path = folder.path().join(name);
        let trace = ["trace", "corner", "--profile", "thesis", "--waves", "1000"];
        let rest = ["--seed", seed, "--dump-waves", argument(&path)];
        succeed(&[&trace[..], &rest].concat());
        std::fs::read_to_string(path).unwrap()
    };
    let text = dump("first.csv", "3");
    assert_eq!(text, dump("second.csv", "3"));
    assert_ne!(text, dump("other.csv", "4"));

    let settings = thesis(1000, 8).with_seed(3);
    let (_, waves) = tracer()
        .frame_with_waves(&builtin("corner"), &settings)
        .unwrap();
    let mut lines = text.lines();
    let header = "wave,start_dx,start_dy,start_dz,x,y,z,dx,dy,dz,status";
    assert_eq!(lines.next(), Some(header));
    for (index, wave) in waves.iter().enumerate() {
        let fields: Vec<&str> = lines.next().unwrap().split(',').collect();
        assert_eq!(fields[0], index.to_string());
        let read: Vec<u32> = fields[1..]
            .iter()
            .map(|f| f.parse::<f32>().unwrap().to_bits())
            .collect();
        let vectors = [wave.start_direction, wave.position, wave.direction];
        let mut expected: Vec<u32> = vectors
            .iter()
            .flat_map(|v| v.to_array())
            .map(f32::to_bits)
            .collect();
        expected.push(wave.status.to_bits());
        assert_eq!(read, expected, "wave {index}");
    }
    assert_eq!(lines.next(), None);
}

/// Protects the files of `figures`: each has a valid format.
#[test]
fn figures_writes_csv_json_and_svg() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("new/out");
    succeed(&[
        "figures",
        "--max-waves",
        "1024",
        "--runs",
        "1",
        "-o",
        argument(&output),
    ]);
    let read = |name: &str| std::fs::read_to_string(output.join(name)).unwrap();

    // Four tables of three rows, 64, 256 and 1024 waves, each for three profiles.
    let text = read("figures.csv");
    let mut rows = csv_rows(&text);
    let header = rows.remove(0);
    assert_eq!(rows.len(), 36);
    assert!(rows.iter().all(|row| row.len() == header.len()));
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    for (index, row) in rows.iter().enumerate() {
        let waves = [64, 256, 1024][index / 3 % 3];
        assert_eq!(row[column("waves")], waves.to_string());
        assert_eq!(row[column("figure")], format!("11.{}", index / 9 + 1));
        assert_eq!(
            row[column("profile")],
            ["thesis", "march", "hybrid"][index % 3]
        );
        let count = |name| row[column(name)].parse::<u64>().unwrap();
        let fates = count("listener_hits") + count("dead") + count("travelling");
        assert_eq!(fates, waves);
    }

    let report: serde_json::Value = serde_json::from_str(&read("figures.json")).unwrap();
    assert_eq!(report["tables"].as_array().unwrap().len(), 4);
    assert_eq!(report["tables"][3]["rows"][8]["waves"], 1024);

    let text = read("figures.md");
    assert!(text.contains("## Figure 11.4: obstacles, 8 iterations"));
    assert!(text.contains("| thesis | 1024 |") && text.contains("(figures.svg)"));

    let svg = read("figures.svg");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    let opened = svg.matches("<text").count();
    assert!(opened > 8 && opened == svg.matches("</text>").count());
    assert!(!svg.contains("NaN") && !svg.contains("inf\""));
    let files = std::fs::read_dir(&output).unwrap().count();
    assert_eq!(files, 4, "temporary files are left");
}

/// Splits CSV into fields. Quotes occur only around whole fields.
fn csv_rows(text: &str) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for line in text.lines() {
        let (mut row, mut field, mut quoted) = (Vec::new(), String::new(), false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => row.push(std::mem::take(&mut field)),
                c => field.push(c),
            }
        }
        row.push(field);
        rows.push(row);
    }
    rows
}

/// Protects `render` from scene to sound: a source that passes from left to right is heard from left to right without a
/// click, and a second run writes the same bytes.
#[test]
fn a_passing_source_moves_from_left_to_right() {
    let folder = tempfile::tempdir().unwrap();
    let first = folder.path().join("first.wav");
    let second = folder.path().join("second.wav");
    // Only the direct sound is traced. The listener is at the world's origin, to which the thesis' algorithm moves dead
    // waves. In a second iteration, dead waves would count as heard.
    let short = ["--waves", "16384", "--iterations", "1", "--law", "linear"];
    let sine = ["render", "open-field", "--sound", "sine:440", "-o"];
    let render = |path| [&sine[..], &[argument(path)], &short[..]].concat();
    let report = json(&render(&first));
    succeed(&render(&second));
    assert_eq!(
        std::fs::read(&first).unwrap(),
        std::fs::read(&second).unwrap()
    );

    let [left, right] = read_stereo(&first);
    assert_eq!(
        left.len(),
        4 * Sound::SAMPLE_RATE as usize,
        "the path takes 4 s"
    );
    // Half a second is 220 whole periods of 440 Hz. In each half second the source moves 2 m, which changes the pan by
    // at least 0.07. With 340 hits at the far ends, one standard error of a pan is 0.03. All frames have the same seed,
    // so most of their noise is common to them.
    let falling = |levels: &[f64]| levels.windows(2).all(|pair| pair[1] < pair[0]);
    let levels = |samples: &[f32]| samples.chunks(24_000).map(rms).collect::<Vec<f64>>();
    let (left_levels, mut right_levels) = (levels(&left), levels(&right));
    right_levels.reverse();
    assert!(falling(&left_levels), "{left_levels:?}");
    assert!(falling(&right_levels), "{right_levels:?}");
    assert!(left_levels[0] > 2.0 * left_levels[7]);

    let steepest = steepest_step(&report);
    for samples in [&left, &right] {
        let step = samples.windows(2).map(|s| f64::from((s[1] - s[0]).abs()));
        let step = step.fold(0.0, f64::max);
        assert!(step <= steepest, "a jump of {step}, above {steepest}");
        assert!(step > 0.1 * steepest, "{step}: no sound");
    }
}

/// The largest difference between two neighbouring samples that a sine of 440 Hz and the glide of its gain allow. A
/// sample is s·g, so its difference is Δs·g + s·Δg with g ≤ 1, |s| ≤ 0.5 and |Δs| ≤ 2·0.5·sin(π·440/48000). Δg is the
/// change of the gain in a frame divided by its 1600 samples. By the linear law it is half the change of the pan.
/// Rounding of a sample in `f32` adds 2^-24 twice.
fn steepest_step(report: &serde_json::Value) -> f64 {
    let amplitude = f64::from(Sound::SINE_AMPLITUDE);
    let sine = 2.0 * amplitude * (std::f64::consts::PI * 440.0 / 48_000.0).sin();
    let frames = report["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 120);
    let pans: Vec<f64> = frames.iter().map(|f| f["pan"].as_f64().unwrap()).collect();
    let changes = pans.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let glide = 0.5 * changes.fold(0.0, f64::max) / 1600.0;
    sine + amplitude * glide + f64::from(f32::EPSILON)
}

/// Protects `info --json`: the data from which a script chooses a renderer.
#[test]
fn info_names_three_apis() {
    let report = json(&["info"]);
    let apis = report["apis"].as_array().unwrap();
    let names: Vec<_> = apis
        .iter()
        .map(|api| api["api"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["gl", "gles", "osmesa"]);
    for api in apis {
        let gpus = api["gpus"].as_array().unwrap();
        let usable = gpus.iter().filter(|gpu| gpu["renderer"].is_string());
        assert!(usable.count() > 0, "{api}");
    }
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
}

/// Protects pipes: standard output contains only results. Notes go to standard error, name the renderer, show no
/// progress without a terminal, and are absent with --quiet.
#[test]
fn results_and_notes_go_different_ways() {
    let folder = tempfile::tempdir().unwrap();
    let wav = folder.path().join("out.wav");
    let runs: [&[&str]; 3] = [
        &["trace", "shoebox", "--waves", "64"],
        &["figures", "--max-waves", "64", "--runs", "1"],
        &[
            "render",
            "shoebox",
            "--seconds",
            "0.5",
            "-o",
            argument(&wav),
        ],
    ];
    for arguments in runs {
        let chatty = succeed(arguments);
        let lines: Vec<&str> = stderr(&chatty).lines().collect();
        assert!(
            matches!(lines[..], [line] if line.starts_with("renderer: ")),
            "{lines:?}"
        );
        assert!(!stderr(&chatty).contains(['\r', '\u{1b}']), "{lines:?}");
        assert!(!stdout(&chatty).contains("renderer:"));
        assert!(!stdout(&chatty).is_empty());

        let quiet = succeed(&[arguments, &["--quiet"]].concat());
        assert_eq!(stderr(&quiet), "");
        assert!(!stdout(&quiet).is_empty());

        // With --json, standard output is exactly one JSON value.
        let machine = succeed(&[arguments, &["--json"]].concat());
        let parsed = serde_json::from_slice::<serde_json::Value>(&machine.stdout);
        assert!(parsed.is_ok_and(|value| value.is_object()), "{arguments:?}");
    }
    assert_eq!(stderr(&succeed(&["info"])), "");
}

/// Protects the choice of API: each API is actually used. If several APIs use the same renderer, the same waves reach
/// the listener.
#[test]
fn all_apis_give_the_same_hits() {
    let report = |api| json(&["trace", "corner", "--profile", "thesis", "--gl", api]);
    let reports = ["gl", "gles", "osmesa"].map(report);
    let hits = reports
        .each_ref()
        .map(|r| r["listener_hits"].as_u64().unwrap());
    assert!(hits[0] > 500, "{hits:?}");
    for (report, hits_here) in reports.iter().zip(hits) {
        if report["renderer"] == reports[0]["renderer"] {
            assert_eq!(hits_here, hits[0]);
        }
        // On other hardware, rounding may change the result of single waves: 0.5 % are allowed.
        assert!(
            hits_here.abs_diff(hits[0]) as f64 <= 0.005 * hits[0] as f64,
            "{hits:?}"
        );
    }
}

/// Protects `echomarch … | head`: a reader that closes the pipe early causes neither a failure nor a panic.
#[test]
fn a_reader_that_goes_away_is_no_failure() {
    for arguments in [
        &["info"][..],
        &["trace", "corner", "--waves", "64", "--json"],
    ] {
        let mut child = command()
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The pipe is closed before a context can have been created, so that every write fails.
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
        assert!(
            !stderr(&output).contains("echomarch:"),
            "{}",
            stderr(&output)
        );
    }
}

/// Protects `--version`.
#[test]
fn version_is_that_of_the_package() {
    let version = succeed(&["--version"]);
    let expected = format!("echomarch {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(stdout(&version), expected);
}
