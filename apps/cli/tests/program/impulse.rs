//! `echomarch impulse` on the command line: figures, files, sources and listeners, invalid input.

use crate::common::cli::{argument, contents, json, refuse, run_in, stderr, stdout, succeed};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// A room whose walls absorb differently by band, with two sources and two listeners. One listener is behind a wall.
const HALL: &str = r#"Scene(
    surfaces: [
        Surface(shape: Room(size: (12, 5, 9)), material: "plaster", walls: (floor: "carpet")),
        Surface(shape: Box(size: (0.4, 5, 6)), position: (1, 0, -1.5), material: "plaster"),
    ],
    materials: {
        "plaster": Material(absorption: [0.1, 0.1, 0.12, 0.14, 0.16, 0.18, 0.2, 0.22], scattering: 0.2),
        "carpet": Material(absorption: [0.05, 0.08, 0.2, 0.35, 0.5, 0.6, 0.65, 0.65]),
    },
    sources: [
        Source(name: "flute", position: (-4, 0, -2)),
        Source(name: "drum", position: (-4, 0, -2), level_db: 6),
    ],
    listeners: [
        Listener(name: "stalls", position: (-1, 0.2, 2), radius: 0.3),
        Listener(name: "behind", position: (4, -0.3, -2), radius: 0.3),
    ],
)"#;

fn hall(folder: &Path) -> String {
    let file = folder.join("hall.ron");
    std::fs::write(&file, HALL).unwrap();
    argument(&file).to_owned()
}

fn numbers(of: &Value) -> Vec<f64> {
    let all = of.as_array().unwrap().iter();
    all.map(|number| number.as_f64().unwrap()).collect()
}

/// Protects the report: it has a pair for each source and listener, all figures by band, the direct sound if nothing
/// blocks it, and the levels of the sources. A second run gives the same result.
#[test]
fn every_pair_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = hall(folder.path());
    // Behind the wall, late arrivals are counted within half a metre. This number of waves gives a T20 in all bands.
    let call = ["impulse", &file, "--waves", "262144", "--seconds", "1.8"];
    let report: Value = json(&call);
    let pairs = report["pairs"].as_array().unwrap();
    let names: Vec<_> = pairs
        .iter()
        .map(|pair| (&pair["source"], &pair["listener"]))
        .collect();
    let expected = [
        ("flute", "stalls"),
        ("flute", "behind"),
        ("drum", "stalls"),
        ("drum", "behind"),
    ];
    assert!(
        names
            .iter()
            .zip(expected)
            .all(|((from, to), (source, listener))| *from == source && *to == listener)
    );
    let [near, behind, louder, _] = [0, 1, 2, 3].map(|pair: usize| &pairs[pair]);
    assert_eq!(
        numbers(&near["bands_hz"]),
        [63.0, 125.0, 250.0, 500.0, 1e3, 2e3, 4e3, 8e3]
    );
    // Higher bands are absorbed more, so they decay faster.
    let times = numbers(&near["t20_s"]);
    assert!(times[0] > 1.2 * times[7], "{times:?}");
    // The direct path has a length of sqrt(3² + 0.2² + 4²) metres, about 5 m.
    let direct = &near["direct"];
    let metres = (9.0_f64 + 0.04 + 16.0).sqrt();
    assert!((direct["delay_s"].as_f64().unwrap() - metres / 343.0).abs() < 1e-6);
    let level = 20.0 * (10.0 / metres).log10();
    assert!((direct["g_db"].as_f64().unwrap() - level).abs() < 1e-3);
    assert!(
        direct["azimuth_deg"].as_f64() < Some(0.0),
        "the flute is to the left"
    );
    // Behind the wall there are echoes but no direct sound.
    assert!(behind["direct"].is_null());
    assert!(numbers(&behind["g_db"])[0] < numbers(&near["g_db"])[0]);
    assert!(!behind["paths"].as_array().unwrap().is_empty());
    // The level is 6 dB higher, with the same waves.
    for (quiet, loud) in numbers(&near["g_db"])
        .into_iter()
        .zip(numbers(&louder["g_db"]))
    {
        assert!((loud - quiet - 6.0).abs() < 1e-9);
    }
    for error in ["t30_s", "c80_db", "g_db"] {
        assert_eq!(near["error"][error].as_array().unwrap().len(), 8);
    }
    let mut again: Value = json(&call);
    let mut first = report.clone();
    for report in [&mut first, &mut again] {
        report["milliseconds"] = Value::Null;
        for pair in report["pairs"].as_array_mut().unwrap() {
            pair["milliseconds"] = Value::Null;
        }
    }
    assert_eq!(first, again);
}

/// Protects the files: the WAV file has the right channels, rate, and time and level of the direct sound; the echogram
/// has the energy; the plot exists.
#[test]
fn files_hold_what_is_heard() {
    let folder = tempfile::tempdir().unwrap();
    let file = hall(folder.path());
    let [wav, csv, svg] =
        ["ir.wav", "echogram.csv", "decay.svg"].map(|name| folder.path().join(name));
    let call = |format: &str| {
        let files = [
            "-o",
            argument(&wav),
            "--echogram",
            argument(&csv),
            "--plot",
            argument(&svg),
        ];
        let how = [
            "--waves",
            "4096",
            "--seconds",
            "0.4",
            "--source",
            "flute",
            "--listener",
            "1",
        ];
        succeed(
            &[
                &["impulse", &file, "--format", format, "--rate", "44100"][..],
                &how,
                &files,
            ]
            .concat(),
        );
        let mut wav = hound::WavReader::open(&wav).unwrap();
        let spec = wav.spec();
        assert_eq!((spec.sample_rate, spec.bits_per_sample), (44_100, 32));
        let samples: Vec<f32> = wav.samples::<f32>().map(Result::unwrap).collect();
        (usize::from(spec.channels), samples)
    };
    let (channels, mono) = call("mono");
    assert_eq!((channels, mono.len()), (1, 17_640));
    // The direct sound arrives first, as an impulse of amplitude 1/r between two samples.
    let metres = (9.0_f64 + 0.04 + 16.0).sqrt();
    let direct = metres / 343.0 * 44_100.0;
    let before = &mono[..direct as usize - 44];
    assert!(before.iter().all(|sample| sample.abs() < 0.02));
    let near = &mono[direct as usize - 44..direct as usize + 45];
    let energy: f32 = near.iter().map(|sample| sample * sample).sum();
    assert!(
        (f64::from(energy.sqrt()) * metres - 1.0).abs() < 0.1,
        "{energy}"
    );
    let loudest = (0..89).max_by(|a, b| near[*a].abs().total_cmp(&near[*b].abs()));
    assert!((loudest.unwrap() as f64 + direct.floor() - 44.0 - direct).abs() < 1.0);
    let (channels, stereo) = call("stereo");
    assert_eq!((channels, stereo.len()), (2, 2 * 17_640));
    let energy = |ear: usize| -> f32 {
        stereo[ear..]
            .iter()
            .step_by(2)
            .take(1000)
            .map(|s| s * s)
            .sum()
    };
    assert!(energy(0) > 1.5 * energy(1), "the flute is to the left");
    let (channels, ambisonic) = call("ambisonic");
    assert_eq!((channels, ambisonic.len()), (4, 4 * 17_640));
    let mut echogram = csv::Reader::from_path(&csv).unwrap();
    assert_eq!(
        echogram.headers().unwrap(),
        vec!["time_s", "band_hz", "energy", "x", "y", "z"]
    );
    let energies = echogram
        .records()
        .map(|row| row.unwrap()[2].parse::<f64>().unwrap());
    assert!(energies.sum::<f64>() > 0.0);
    assert!(std::fs::read_to_string(&svg).unwrap().contains("<svg"));
}

/// Protects the files of several pairs: each pair has its own file, and the table has a row for each pair and band with
/// the figures of the JSON output. One pair has the file that was given.
#[test]
fn each_pair_has_its_own_files_and_rows() {
    let folder = tempfile::tempdir().unwrap();
    let file = hall(folder.path());
    let base = [
        "impulse",
        &file,
        "--waves",
        "4096",
        "--json",
        "--seconds",
        "1",
    ];
    let run = |more: &[&str]| {
        let output = run_in(folder.path(), &[&base[..], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        serde_json::from_str::<Value>(stdout(&output)).unwrap()
    };
    let files = [
        "-o",
        "ir.wav",
        "--plot",
        "decay.svg",
        "--echogram",
        "e.csv",
        "--csv",
        "figures.csv",
    ];
    let report = run(&files);
    let names: Vec<String> = contents(folder.path())
        .into_keys()
        .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
        .collect();
    let pairs = report["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 4);
    for pair in pairs {
        let [source, listener] = ["source", "listener"].map(|part| {
            let name = pair[part].as_str().unwrap();
            name.replace(' ', "_")
        });
        for (stem, ending) in [("ir", "wav"), ("decay", "svg"), ("e", "csv")] {
            let expected = format!("{stem}-{source}-{listener}.{ending}");
            assert!(names.contains(&expected), "{expected}: {names:?}");
        }
    }
    assert!(!names.contains(&"ir.wav".to_owned()), "{names:?}");
    let mut table = csv::Reader::from_path(folder.path().join("figures.csv")).unwrap();
    let columns: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(
        columns[..5],
        ["source", "listener", "band_hz", "edt_s", "edt_error_s"]
    );
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 4 * 8);
    for (index, row) in rows.iter().enumerate() {
        let (pair, band) = (&pairs[index / 8], index % 8);
        assert_eq!(
            (Some(&row[0]), Some(&row[1])),
            (pair["source"].as_str(), pair["listener"].as_str())
        );
        for (column, of) in [
            ("c80_db", &pair["c80_db"]),
            ("g_error_db", &pair["error"]["g_db"]),
        ] {
            let at = columns.iter().position(|known| known == column).unwrap();
            let said = row[at].parse::<f64>().ok();
            let expected = of[band].as_f64();
            assert_eq!(said.is_some(), expected.is_some(), "{column} {index}");
            // The JSON parser may be off by one unit in the last place.
            let off = said.unwrap_or(0.0) - expected.unwrap_or(0.0);
            assert!(
                off.abs() <= 1e-12 * expected.unwrap_or(0.0).abs(),
                "{column} {index}: {off}"
            );
        }
    }
    run(&["--source", "flute", "--listener", "1", "-o", "one.wav"]);
    assert!(folder.path().join("one.wav").exists());
}

/// Protects users who mistype arguments: the program exits with code 2, prints one sentence, and writes no file.
#[test]
fn what_cannot_be_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = hall(folder.path());
    let wav = folder.path().join("ir.wav");
    let to = argument(&wav);
    refuse(
        &["impulse", &file, "--source", "drums"],
        "no source \"drums\"; it has: flute, drum; did you mean drum?",
    );
    refuse(&["impulse", "shoebox", "--profile", "thesis"], "thesis");
    refuse(
        &["impulse", "shoebox", "--order", "17"],
        "--order must be 0 to 16",
    );
    refuse(
        &["impulse", "shoebox", "--seconds", "0"],
        "--seconds must be 0.001 to 60",
    );
    refuse(&["impulse", "shoebox", "-o", "ir.mp3"], "must end in .wav");
    refuse(
        &["impulse", "shoebox", "--csv", "ir.txt"],
        "must end in .csv",
    );
    refuse(
        &["impulse", &file, "--csv", "no-such-folder/f.csv"],
        "no-such-folder",
    );
    refuse(
        &["impulse", "shoebox", "-o", to, "--rate", "4000"],
        "--rate must be 8000 to 192000",
    );
    refuse(&["impulse", &file, "-o", &file], "must end in .wav");
    refuse(
        &["impulse", "shoebox", "--accuracy", "20%"],
        "0.001 to 0.05 (0.1 % to 5 %)",
    );
    refuse(
        &["impulse", "shoebox", "--waves", "1024", "--time-limit", "1"],
        "--time-limit needs --accuracy",
    );
    assert!(!wav.exists());
}

/// Protects the accuracy: every figure has the requested error, and a limit of waves is kept. A figure that is missing is named with its cause.
#[test]
fn figures_have_the_accuracy_that_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("room.ron");
    let text = "Scene(surfaces: [Surface(shape: Room(size: (8, 3, 5)), material: \"wall\")],
        materials: {\"wall\": Material(absorption: 0.3, scattering: 0.2)},
        source: Source(position: (-2, 0, -1)), listener: Listener(position: (2, 0, 1), radius: 0.3))";
    std::fs::write(&file, text).unwrap();
    let file = argument(&file);
    let report: Value = json(&["impulse", file, "--accuracy", "1%"]);
    let pair = &report["pairs"][0];
    for time in ["edt_s", "t20_s", "t30_s"] {
        let (values, errors) = (numbers(&pair[time]), numbers(&pair["error"][time]));
        for (value, error) in values.iter().zip(errors) {
            assert!(error <= 0.01 * value, "{time}: {value} {error}");
        }
    }
    assert!(
        numbers(&pair["error"]["c80_db"])
            .iter()
            .all(|error| *error <= 0.1)
    );
    let waves = pair["waves"].as_u64().unwrap();
    let late = json(&["impulse", file, "--accuracy", "1%", "--waves", "1024"]);
    assert_eq!(late["pairs"][0]["waves"], 1024);
    let notes = late["pairs"][0]["notes"].to_string();
    assert!(notes.contains("times as many waves"), "{notes}");
    assert!(waves > 1024 && waves < 1 << 20, "{waves}");
}

/// Protects against sound through walls, lost echoes, and empty tables without an explanation. A source inside a solid
/// is not heard. A listener whose centre is in the shadow still receives the sound that reaches its sphere. A missing
/// decay is reported.
#[test]
fn nothing_is_heard_through_walls_or_lost_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |name: &str, surfaces: &str, source: &str| {
        let file = folder.path().join(name);
        let text = format!(
            "Scene(surfaces: [{surfaces}], source: Source(position: {source}), \
             listener: Listener(position: (5, 0, 0), radius: 0.5))"
        );
        std::fs::write(&file, text).unwrap();
        argument(&file).to_owned()
    };
    let inside = scene(
        "in.ron",
        "Surface(shape: Box(size: (2, 2, 2)))",
        "(0, 0, 0)",
    );
    let many = ["--waves", "262144", "--seconds", "0.2"];
    let report: Value = json(&[&["impulse", &inside][..], &many].concat());
    assert!(report["pairs"][0]["direct"].is_null());
    assert_eq!(report["pairs"][0]["paths"], Value::Array(Vec::new()));
    let why = "nothing arrives: the source is inside a solid";
    assert_eq!(report["pairs"][0]["notes"][0], why);
    // A wall without openings.
    let shut = scene(
        "shut.ron",
        "Surface(shape: Room(size: (20, 3, 4))), Surface(shape: Box(size: (1, 3, 4)))",
        "(-5, 0, 0)",
    );
    let report: Value = json(&[&["impulse", &shut][..], &many].concat());
    let note = report["pairs"][0]["notes"][0].to_string();
    assert!(
        note.contains("a closed door between source and listener"),
        "{note}"
    );
    // The upper edge of the box hides the centre of the sphere but not its top.
    let behind = scene(
        "half.ron",
        "Surface(shape: Box(size: (1, 2, 40)), position: (0, -0.9, 0))",
        "(-5, 0, 0)",
    );
    let report: Value = json(&[&["impulse", &behind][..], &many].concat());
    assert!(report["pairs"][0]["direct"].is_null());
    assert!(numbers(&report["pairs"][0]["g_db"])[0] < 6.0);
    let output = succeed(&["impulse", "shoebox", "--waves", "1024", "--seconds", "0.2"]);
    assert!(
        stderr(&output).contains("in all bands")
            && stderr(&output).contains("nothing absorbs in this scene"),
        "{}",
        stderr(&output)
    );
}

/// Protects the list of paths: it contains no paths without energy. Also protects the level of a source inside the
/// listener's sphere, which must not be that of a point.
#[test]
fn paths_that_bring_nothing_are_not_listed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("dead.ron");
    let dead = "Scene(surfaces: [Surface(shape: Room(size: (8, 3, 5)), material: \"all\")], \
                materials: {\"all\": Material(absorption: 1)}, source: Source(position: (0.1, 0, 0)), \
                listener: Listener(position: (0, 0, 0), radius: 0.3))";
    std::fs::write(&file, dead).unwrap();
    let report: Value = json(&[
        "impulse",
        argument(&file),
        "--waves",
        "1024",
        "--seconds",
        "0.2",
    ]);
    let pair = &report["pairs"][0];
    assert_eq!(pair["paths"].as_array().map(Vec::len), Some(1));
    let notes = pair["notes"].to_string();
    assert!(notes.contains("sphere (0.3 m) limits"), "{notes}");
    assert!(!notes.contains("focus"), "{notes}");
}

/// Protects the output of a path through a wall: its kind, no reflection, and the name of the wall.
#[test]
fn paths_through_walls_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("divided.ron");
    let divided = "Scene(surfaces: [Surface(shape: Room(size: (8, 3, 5))), \
                   Surface(name: \"pane\", shape: Box(size: (0.01, 9, 9)), material: \"glass\")], \
                   source: Source(position: (-3, 0, 0)), listener: Listener(position: (3, 0, 0), radius: 0.3))";
    std::fs::write(&file, divided).unwrap();
    let file = argument(&file);
    let call = ["impulse", file, "--waves", "1024", "--seconds", "0.1"];
    let output = succeed(&call);
    let text = stdout(&output);
    assert!(text.contains("transmitted through pane"), "{text}");
    let report: Value = json(&call);
    let path = &report["pairs"][0]["paths"][0];
    assert_eq!(path["kind"], "transmitted");
    assert_eq!(path["order"], 0);
    assert_eq!(path["surfaces"], serde_json::json!([2]));
    assert_eq!(report["pairs"][0]["direct"], Value::Null);
}

/// Protects the text output: a table of bands, and the exact paths in order.
#[test]
fn the_text_names_figures_and_paths() {
    let output = succeed(&["impulse", "shoebox", "--waves", "4096", "--seconds", "0.2"]);
    let text = stdout(&output);
    for word in [
        "band Hz",
        "EDT s",
        "T30 s",
        "C80 dB",
        "G dB",
        "direct",
        "over room/",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
}

/// Protects files for other programs: sox reads the same channels, rate, length and samples that were written, for each
/// format.
#[test]
fn files_open_in_sox() {
    let folder = tempfile::tempdir().unwrap();
    let file = hall(folder.path());
    let formats = [
        ("mono", "1", "1"),
        ("stereo", "1", "2"),
        ("ambisonic", "1", "4"),
        ("ambisonic", "7", "64"),
    ];
    for (format, order, channels) in formats {
        let wav = folder.path().join(format!("{format}-{order}.wav"));
        let pair = ["--source", "flute", "--listener", "stalls"];
        let call = ["impulse", &file, "--waves", "4096", "--seconds", "0.5"];
        let mut out = vec!["--format", format, "-o", argument(&wav), "--quiet"];
        if format == "ambisonic" {
            out.extend(["--ambisonic-order", order]);
        }
        succeed(&[&call[..], &pair, &out[..]].concat());
        let told = |what: &str| {
            let answer = Command::new("soxi").arg(what).arg(&wav).output();
            let answer = answer.expect("sox is missing: install the Debian package sox");
            assert!(answer.status.success(), "{format}, {what}");
            String::from_utf8(answer.stdout).unwrap().trim().to_owned()
        };
        assert_eq!(told("-c"), channels, "{format}");
        assert_eq!(told("-r"), "48000", "{format}");
        assert_eq!(told("-e"), "Floating Point PCM", "{format}");
        let frames = hound::WavReader::open(&wav).unwrap().duration();
        assert_eq!(told("-s"), frames.to_string(), "{format}");
    }
}

/// Protects users from mistaking a flutter echo for the room's reverberation. Sound lasts longer between hard parallel
/// walls, and the note on flutter contains the walls and both times. Surfaces without a material are reported.
#[test]
fn a_flutter_echo_is_told_with_its_walls() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("flutter.ron");
    let room = |scattering: &str| {
        format!(
            "Scene(surfaces: [Surface(shape: Room(size: (6, 3, 5)), material: \"soft\",
            walls: (left: \"hard\", right: \"hard\"))],
            materials: {{\"soft\": Material(absorption: 0.5{scattering}),
            \"hard\": Material(absorption: 0.03{scattering})}},
            source: Source(position: (-1.2, 0.3, 0.4)),
            listener: Listener(position: (1.7, -0.2, -0.6), radius: 0.3))"
        )
    };
    let notes = |text: String| {
        std::fs::write(&file, text).unwrap();
        let report: Value = json(&["impulse", argument(&file), "--waves", "65536"]);
        report["pairs"][0]["notes"].to_string()
    };
    let bare = notes(room(""));
    assert!(
        bare.contains("flutter echo between 1/left and 1/right; nothing scatters: give the scene a scattering, such as 0.1"),
        "{bare}"
    );
    let diffuse = notes(room("").replace("source:", "scattering: 0.6, source:"));
    assert!(!diffuse.contains("flutter"), "{diffuse}");
    let hollow = notes(
        room("")
            .replace(
                "Room(size: (6, 3, 5))",
                "Complement(of: Box(size: (20, 3, 5)))",
            )
            .replace("walls: (left: \"hard\", right: \"hard\")", "")
            .replace("absorption: 0.5", "absorption: 0.03"),
    );
    assert!(
        hollow.contains("nothing scatters: give the scene a scattering, such as 0.1"),
        "{hollow}"
    );
    let rough = notes(room(", scattering: 0.6"));
    assert!(!rough.contains("flutter"), "{rough}");
    let bald = notes(room("").replace("material: \"soft\",", ""));
    assert!(
        bald.contains("1/floor, 1/ceiling, 1/front, 1/back have no material"),
        "{bald}"
    );
}
