//! `echomarch study` on the command line: shards, jobs, interruptions, joining, maps, invalid input.

use crate::common::Random;
use crate::common::cli::{argument, command, contents, json, refuse, stderr, stdout, succeed};
use crate::common::shard::with_sums;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

/// A study of 400 small frames over two scenes.
const SMALL: &str = r#"Study(
    scenes: [Scene(of: "corner"), Scene(of: "hall.ron", values: {"width": Range(from: 8, to: 12, count: 3)})],
    listeners: Grid(from: (-3, 0, 2), to: (3, 0, 6), counts: (5, 1, 5)),
    settings: All(waves: [512, 1024], iterations: [3]),
    seeds: Range(from: 1, count: 2),
)"#;

const HALL: &str = r#"Scene(
    surfaces: [
        Surface(shape: Room(size: (30, 6, 20)), material: "carpet"),
        Surface(shape: Box(size: (Value("width", 10), 3, 1))),
    ],
    source: Source(position: (0, 0, -4)),
    listener: Listener(position: (0, 0, 5), radius: 1),
)"#;

/// Writes a study file and its scene to a folder, and returns the file's path.
fn study(folder: &Path, text: &str) -> String {
    std::fs::write(folder.join("hall.ron"), HALL).unwrap();
    let file = folder.join("study.ron");
    std::fs::write(&file, text).unwrap();
    argument(&file).to_owned()
}

/// The tables in a results folder.
fn tables(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = contents(folder).into_iter();
    let names = files.filter_map(|(path, bytes)| {
        let name = path.file_name()?.to_owned();
        Some((PathBuf::from(name), bytes?))
    });
    names.collect()
}

/// Protects the tables from depending on how a study is divided and run: in one process, as shards in any order, with
/// several jobs, and in a second run without remaining work.
#[test]
fn a_study_is_the_same_however_it_was_cut() {
    let folder = tempfile::tempdir().unwrap();
    let file = study(folder.path(), SMALL);
    let place = |name: &str| folder.path().join(name);
    let whole = place("whole");
    let report = json(&["study", &file, "-o", argument(&whole)]);
    assert_eq!(
        (&report["points"], &report["shards"]),
        (&400.into(), &1.into())
    );
    let expected = tables(&whole);
    assert!(expected.contains_key(Path::new("study.csv")));
    let csv = String::from_utf8(expected[Path::new("study.csv")].clone()).unwrap();
    assert_eq!(csv.lines().count(), 401);
    assert!(csv.starts_with("point,scene,value_width,profile"));
    assert!(
        csv.lines()
            .nth(101)
            .unwrap()
            .starts_with("100,hall,8.0,hybrid,random,512,3,")
    );
    let parts = place("parts");
    for number in [3, 1, 5, 2, 4] {
        let shard = format!("{number}/5");
        succeed(&["study", &file, "-o", argument(&parts), "--shard", &shard]);
    }
    succeed(&["study", &file, "-o", argument(&parts), "--join"]);
    assert!(tables(&parts) == expected);
    let jobs = place("jobs");
    succeed(&["study", &file, "-o", argument(&jobs), "--jobs", "3"]);
    assert!(tables(&jobs) == expected);
    let again = succeed(&["study", &file, "-o", argument(&jobs)]);
    assert!(stdout(&again).contains("400 points of 3 shards"));
    assert!(tables(&jobs) == expected);
}

/// Returns the number of lines in a working file, including its header line.
fn lines_of(work: &Path) -> usize {
    let bytes = std::fs::read(work).unwrap_or_default();
    bytes.iter().filter(|byte| **byte == b'\n').count()
}

/// Protects hours of work: a study that is killed at 20 random moments and then continued ends with the same bytes in
/// its tables and its shard.
#[test]
fn a_study_that_is_killed_ends_with_the_same_bytes() {
    const KILLS: usize = 20;
    let folder = tempfile::tempdir().unwrap();
    let file = study(folder.path(), SMALL);
    let [whole, killed] = ["whole", "killed"].map(|name| folder.path().join(name));
    succeed(&["study", &file, "-o", argument(&whole)]);
    let (work, shard) = (
        killed.join("shards/00001-of-00001.work"),
        "shards/00001-of-00001.shard",
    );
    let mut random = Random(15);
    let mut kills = 0;
    while kills < KILLS {
        let mut program = command();
        let arguments = ["study", &file, "-o", argument(&killed), "--quiet"];
        let program = program.args(arguments).stdout(Stdio::null());
        let mut program = program.stderr(Stdio::null()).spawn().unwrap();
        let target = lines_of(&work) + (random.bits() % 24) as usize;
        let has_ended = loop {
            if program.try_wait().unwrap().is_some() {
                break true;
            }
            if lines_of(&work) >= target {
                break false;
            }
            sleep(Duration::from_millis(1));
        };
        program.kill().unwrap();
        program.wait().unwrap();
        match has_ended {
            // The process ended before it could be killed. The bytes of its tables are compared, and the study starts
            // again.
            true => {
                assert!(tables(&killed) == tables(&whole));
                std::fs::remove_dir_all(&killed).unwrap();
            }
            false => kills += 1,
        }
    }
    succeed(&["study", &file, "-o", argument(&killed)]);
    assert!(tables(&killed) == tables(&whole));
    let bytes = |folder: &Path| std::fs::read(folder.join(shard)).unwrap();
    assert!(bytes(&killed) == bytes(&whole));
}

/// Protects against two processes on one shard, and against child processes that outlive their parent.
#[cfg(unix)]
#[test]
fn jobs_end_with_who_started_them() {
    let folder = tempfile::tempdir().unwrap();
    let text = SMALL.replace("count: 2)", "count: 1000000)");
    let file = study(folder.path(), &text);
    let out = folder.path().join("out");
    let arguments = ["study", &file, "-o", argument(&out), "--jobs", "2"];
    let mut program = command();
    let program = program.args(arguments).stderr(Stdio::null());
    let mut program = program.stdout(Stdio::null()).spawn().unwrap();
    let works = [1, 2].map(|number| out.join(format!("shards/0000{number}-of-00002.work")));
    while !works.iter().all(|work| lines_of(work) > 1) {
        assert!(program.try_wait().unwrap().is_none());
        sleep(Duration::from_millis(5));
    }
    let shard = ["study", &file, "-o", argument(&out), "--shard", "1/2"];
    let busy = command().args(shard).output().unwrap();
    assert_eq!(busy.status.code(), Some(1));
    assert!(
        stderr(&busy).contains("shard 1/2 is being worked on"),
        "{}",
        stderr(&busy)
    );
    // The system kills the process, so no signal handler runs.
    program.kill().unwrap();
    program.wait().unwrap();
    for work in works {
        // The lock is released when the process ends.
        let file = std::fs::File::open(&work).unwrap();
        file.lock().unwrap();
    }
}

/// Protects against shards that are damaged or belong to another study: the error names each of them, and no table is
/// written.
#[test]
fn damaged_and_strange_shards_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = SMALL
        .replace("512, ", "")
        .replace("counts: (5, 1, 5)", "counts: (2, 1, 2)");
    let file = study(folder.path(), &text);
    let out = folder.path().join("out");
    let to = argument(&out).to_owned();
    for shard in ["1/2", "2/2"] {
        succeed(&["study", &file, "-o", &to, "--shard", shard]);
    }
    let second = out.join("shards/00002-of-00002.shard");
    let bytes = std::fs::read(&second).unwrap();
    let join = ["study", &file, "-o", &to, "--join"];
    std::fs::write(&second, &bytes[..bytes.len() / 2]).unwrap();
    refuse(&join, "00002-of-00002.shard: it is cut off");
    refuse(
        &["study", &file, "-o", &to, "-q"],
        "remove it to compute it again",
    );
    let mut changed = bytes.clone();
    changed[bytes.len() / 2] ^= 1;
    std::fs::write(&second, changed).unwrap();
    refuse(&join, "00002-of-00002.shard: line ");
    std::fs::remove_file(&second).unwrap();
    refuse(&join, "1 of 2 shards are missing: 2");
    std::fs::write(&second, bytes).unwrap();
    std::fs::write(
        folder.path().join("hall.ron"),
        HALL.replace("carpet", "brick"),
    )
    .unwrap();
    refuse(&join, "2 of 2 shards are missing: 1-2");
    refuse(&join, "00001-of-00002.shard: it is of study");
    assert!(!out.join("study.csv").exists());
}

/// Four points, one for each listener position.
const TINY: &str = r#"Study(
    scenes: [Scene(of: "hall.ron")],
    listeners: Grid(from: (-3, 0, 2), to: (3, 0, 6), counts: (2, 1, 2)),
    settings: All(waves: [64], iterations: [1]),
)"#;

/// Protects tables from shards with valid checksums but impossible numbers: the error contains file, line and column,
/// and no table is written.
#[test]
fn forged_shards_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = study(folder.path(), TINY);
    let out = folder.path().join("out");
    let to = argument(&out).to_owned();
    succeed(&["study", &file, "-o", &to, "--shard", "1/1"]);
    let shard = out.join("shards/00001-of-00001.shard");
    let whole = std::fs::read_to_string(&shard).unwrap();
    let row = whole.lines().nth(2).unwrap().to_owned();
    let zeros = "0".repeat(100_000);
    let join = ["study", &file, "-o", &to, "--join", "-q", "--map", "pan"];
    for (column, name, cell) in [
        (1, "left", "1e400"),
        (2, "right", "nan"),
        (1, "left", zeros.as_str()),
        (3, "pan", "=cmd()"),
        (3, "pan", "1.5"),
        (3, "pan", "0.50"),
        (4, "listener_hits", "65"),
        (4, "listener_hits", "1.0"),
        (6, "travelling", "+1"),
        (9, "step_limit_reached", ""),
    ] {
        let text = row.split('\t').next().unwrap();
        let mut cells: Vec<&str> = text.split(',').collect();
        cells[column] = cell;
        let forged = whole.replace(&row, &format!("{}\t", cells.join(",")));
        std::fs::write(&shard, with_sums(forged.as_bytes())).unwrap();
        let told = format!("00001-of-00001.shard: line 3: {name} is \"");
        refuse(&join, &told);
        refuse(&["study", &file, "-o", &to, "-q"], &told);
        assert_eq!(contents(&out).len(), 1);
        // A working file with the same content is also refused.
        let work = out.join("shards/00001-of-00001.work");
        std::fs::rename(&shard, &work).unwrap();
        refuse(
            &["study", &file, "-o", &to, "-q"],
            &format!("work: line 3: {name} is \""),
        );
        std::fs::remove_file(&work).unwrap();
    }
    for (from, to) in [
        ("llvmpipe", "llvmpipe \u{1b}[2J"),
        ("\"shard\":1", "\"shard\": 1"),
        ("\"of\":1", "\"of\":4000000000"),
    ] {
        std::fs::write(&shard, with_sums(whole.replacen(from, to, 1).as_bytes())).unwrap();
        refuse(&join, "00001-of-00001.shard: it is not a shard of a study");
    }
    std::fs::write(&shard, with_sums(whole.as_bytes())).unwrap();
    succeed(&join);
}

/// Protects files that the program did not create: a file with the name of a working shard stays unchanged, and so does
/// the target of a link.
#[cfg(unix)]
#[test]
fn strange_working_files_are_left_alone() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let file = study(folder.path(), TINY);
    let place = |name: &str| folder.path().join(name);
    std::fs::write(place("victim"), "precious").unwrap();
    let good = place("good");
    succeed(&["study", &file, "-o", argument(&good)]);
    let whole = std::fs::read(good.join("shards/00001-of-00001.shard")).unwrap();
    let head = whole.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    type Put<'a> = &'a dyn Fn(&Path);
    let with = |text: &'static str| move |path: &Path| std::fs::write(path, text).unwrap();
    let behind = |begin: &[u8], more: &[u8]| {
        let bytes = [begin, more].concat();
        move |path: &Path| std::fs::write(path, &bytes).unwrap()
    };
    let puts: [Put; 13] = [
        &|path| symlink("../../hall.ron", path).unwrap(),
        &|path| symlink("../../victim", path).unwrap(),
        &|path| symlink("../../absent", path).unwrap(),
        &|path| symlink("/dev/zero", path).unwrap(),
        &|path| std::fs::hard_link(place("hall.ron"), path).unwrap(),
        &|path| std::fs::hard_link(place("victim"), path).unwrap(),
        &|path| {
            let made = std::process::Command::new("mkfifo").arg(path).status();
            assert!(made.unwrap().success());
        },
        &|path| std::fs::create_dir(path).unwrap(),
        &with("no end of a line"),
        &with("an end of a line\n"),
        &behind(&whole[..head], b"garbage"),
        &behind(&whole, b"garbage"),
        &behind(&whole[..head - 1], b"garbage"),
    ];
    let before = contents(folder.path());
    for (number, put) in puts.iter().enumerate() {
        let out = place("out");
        std::fs::create_dir_all(out.join("shards")).unwrap();
        let work = out.join("shards/00001-of-00001.work");
        put(&work);
        let there = || {
            let about = std::fs::symlink_metadata(&work).unwrap();
            let bytes = about.is_file().then(|| std::fs::read(&work).unwrap());
            (about.file_type(), about.len(), bytes)
        };
        let found = there();
        refuse(
            &["study", &file, "-o", argument(&out), "-q"],
            "00001-of-00001.work",
        );
        refuse(
            &["study", &file, "-o", argument(&out), "-q", "--shard", "1/1"],
            "00001-of-00001.work",
        );
        assert!(there() == found, "{number}");
        assert_eq!(contents(&out).len(), 1, "{number}");
        std::fs::remove_dir_all(&out).unwrap();
        assert!(contents(folder.path()) == before, "{number}");
    }
    // Several processes inspect the working file.
    let out = place("out");
    std::fs::create_dir_all(out.join("shards")).unwrap();
    let pipe = out.join("shards/00002-of-00002.work");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(pipe)
            .status()
            .unwrap()
            .success()
    );
    refuse(
        &["study", &file, "-o", argument(&out), "-q", "--jobs", "2"],
        "00002-of-00002.work",
    );
}

/// Protects files outside the results folder: the program follows no link whose name it chooses itself. The results
/// folder may be a link, because the user names it.
#[cfg(unix)]
#[test]
fn results_stay_in_their_folder() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let file = study(folder.path(), TINY);
    let (out, victim) = (folder.path().join("out"), folder.path().join("victim"));
    std::fs::create_dir(&out).unwrap();
    std::fs::write(&victim, "precious").unwrap();
    let all = ["study", &file, "-o", argument(&out), "-q", "--map", "pan"];
    for name in ["study.csv", "study.json", "study.parquet", "map-pan.png"] {
        for target in ["../victim", "../absent"] {
            let link = out.join(name);
            symlink(target, &link).unwrap();
            refuse(&all, name);
            assert!(link.is_symlink());
            assert_eq!(contents(&out).len(), 1);
            std::fs::remove_file(&link).unwrap();
        }
    }
    std::fs::create_dir(folder.path().join("elsewhere")).unwrap();
    symlink("../elsewhere", out.join("shards")).unwrap();
    refuse(&all, "shards: it is a symbolic link");
    assert!(contents(&folder.path().join("elsewhere")).is_empty());
    std::fs::remove_file(out.join("shards")).unwrap();
    // A file that is hard-linked into the folder keeps its bytes.
    std::fs::hard_link(&victim, out.join("study.csv")).unwrap();
    let link = folder.path().join("link");
    symlink(&out, &link).unwrap();
    succeed(&["study", &file, "-o", argument(&link), "-q", "--map", "pan"]);
    assert!(out.join("map-pan.png").is_file() && out.join("shards/00001-of-00001.shard").is_file());
    assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
    assert!(!folder.path().join("absent").exists());
}

/// Protects studies from places that were meant to be in the room: silence inside a solid and outside the room has a
/// reason of its own, in the table, in study.json and in the printed notes.
#[test]
fn places_in_solids_are_told_apart_from_silence() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"Study(
        scenes: [Scene(of: "hall.ron")],
        listeners: List([(0, 0, 0), (0, 0, 5), (40, 0, 5)]),
        listener_radius: 0.3,
        settings: All(waves: [16384]),
        keep: Keep(pan: false, counts: false, response: Response(figures: [g], bands_hz: [1000])),
    )"#;
    let file = study(folder.path(), text);
    let out = folder.path().join("out");
    let printed = succeed(&["study", &file, "-o", argument(&out)]);
    let note = "note: g_db_1000: 2 of 3 cells are empty: in a solid or outside the room 2";
    assert!(stderr(&printed).contains(note), "{}", stderr(&printed));
    let csv = std::fs::read_to_string(out.join("study.csv")).unwrap();
    let gaps = csv
        .lines()
        .skip(1)
        .map(|row| row.rsplit(',').next().unwrap());
    assert_eq!(gaps.collect::<Vec<_>>(), ["5", "0", "5"]);
}

/// Protects the accuracy of a study: every figure has the requested error, as with `impulse --accuracy`, and the table
/// states the waves that this took, not those of the settings.
#[test]
fn a_study_has_the_accuracy_that_it_asks_for() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"Study(
        scenes: [Scene(of: "hall.ron")],
        settings: All(waves: [64]),
        keep: Keep(pan: false, counts: false, response: Response(
            figures: [t30], bands_hz: [1000], errors: true, accuracy: 0.05,
        )),
    )"#;
    let file = study(folder.path(), text);
    let out = folder.path().join("out");
    succeed(&["study", &file, "-o", argument(&out)]);
    let csv = std::fs::read_to_string(out.join("study.csv")).unwrap();
    let row: Vec<&str> = csv.lines().nth(1).unwrap().rsplit(',').collect();
    let [error_s, t30_s] = [row[1], row[2]].map(|cell| cell.parse::<f64>().expect(&csv));
    assert!(error_s <= 0.05 * t30_s, "{csv}");
    let names = csv.lines().next().unwrap().split(',');
    let at: Vec<usize> = (names
        .enumerate()
        .filter(|(_, name)| *name == "response_waves"))
    .map(|(at, _)| at)
    .collect();
    assert_eq!(at.len(), 1, "{csv}");
    let waves = csv.lines().nth(1).unwrap().split(',').nth(at[0]).unwrap();
    assert!(waves.parse::<u32>().unwrap() > 64, "{csv}");
}

/// Protects maps: the program draws a picture of a column over a grid of listeners, and reports an error without a
/// grid.
#[test]
fn a_grid_of_listeners_is_a_map() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"Study(
        scenes: [Scene(of: "hall.ron")],
        listeners: Grid(from: (-14, 0, -9), to: (14, 0, 9), counts: (6, 1, 4)),
        listener_radius: 0.5,
        settings: All(waves: [32768]),
        keep: Keep(response: Response(figures: [g, c80], bands_hz: [1000], seconds: 1, order: 0, echogram_ms: 50)),
    )"#;
    let file = study(folder.path(), text);
    let out = folder.path().join("out");
    let to = argument(&out).to_owned();
    let maps = ["--map", "pan", "--map", "g_db_1000"];
    let report = json(&[&["study", &file, "-o", &to][..], &maps].concat());
    assert_eq!(report["points"], 24);
    for name in ["map-pan.png", "map-g_db_1000.png"] {
        let picture = image::open(out.join(name)).unwrap().into_rgba8();
        assert!(picture.width() > 900, "{name}");
        let mut colours: Vec<_> = picture.pixels().collect();
        colours.sort_unstable_by_key(|colour| colour.0);
        colours.dedup();
        assert!(colours.len() > 20, "{name}: {} colours", colours.len());
    }
    let csv = std::fs::read_to_string(out.join("study.csv")).unwrap();
    let names: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    assert_eq!(
        names[names.len() - 4..],
        [
            "c80_db_1000",
            "gap_1000",
            "echogram_from_s",
            "echogram_1000"
        ]
    );
    // Each empty cell is counted with its reason, in study.json and in the printed report.
    let note = std::fs::read_to_string(out.join("study.json")).unwrap();
    let note: serde_json::Value = serde_json::from_str(&note).unwrap();
    let mut counted = 0;
    for (at, name) in names.iter().enumerate() {
        let rows = csv.lines().skip(1);
        let empty = rows.filter(|row| row.split(',').nth(at).unwrap().is_empty());
        let empty = empty.count() as u64;
        let reasons = note["empty"][name].as_object();
        let told: u64 = reasons.map_or(0, |reasons| {
            reasons.values().filter_map(serde_json::Value::as_u64).sum()
        });
        assert_eq!(told, empty, "{name}: {}", note["empty"]);
        assert!(reasons.is_none_or(|reasons| !reasons.contains_key("not defined")));
        counted += empty;
    }
    let printed = report["empty"].as_array().unwrap().iter();
    let printed: u64 = printed.filter_map(|of| of["cells"].as_u64()).sum();
    assert_eq!(printed, counted);
    let level = names.iter().position(|name| *name == "g_db_1000").unwrap();
    let levels = csv
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(level).unwrap());
    assert!(levels.filter(|level| level.parse::<f64>().is_ok()).count() > 20);
    let refused = [&["study", &file, "-o", &to][..], &["--map", "panning"]].concat();
    refuse(
        &refused,
        "keeps no numbers called \"panning\"; it keeps: left, right, pan,",
    );
}

/// Protects `--count`: it prints the number of points without computing points or writing files.
#[test]
fn points_and_time_are_told_before() {
    let folder = tempfile::tempdir().unwrap();
    let text = SMALL.replace("count: 2)", "count: 1000000)");
    let file = study(folder.path(), &text);
    let before = contents(folder.path());
    let report = json(&["study", &file, "--count"]);
    assert_eq!(report["sample"]["points"], 200_000_000);
    assert!(report["seconds"].as_f64() > Some(0.0));
    assert!(report["csv_bytes"].as_f64() > report["shard_bytes"].as_f64());
    assert!(contents(folder.path()) == before);
}

/// Protects users who mistype arguments: the program exits with code 2 and prints one sentence.
#[test]
fn what_cannot_be_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = study(folder.path(), SMALL);
    let out = folder.path().join("out");
    let to = argument(&out).to_owned();
    let with = |more: &[&'static str]| {
        let mut all = vec!["study", file.as_str(), "-o", to.as_str()];
        all.extend(more);
        all
    };
    refuse(
        &["study", "absent.ron", "--count"],
        "cannot read the study file absent.ron",
    );
    refuse(&with(&["--join"]), "there is no folder");
    refuse(&with(&["--jobs", "0"]), "--jobs must be 1 to 1024");
    refuse(
        &with(&["-q", "--shard", "1/2", "--require-renderer", "Voodoo"]),
        "\"Voodoo\" is required",
    );
    let output = command().args(with(&["--shard", "3/2"])).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("K from 1 to N"));
    let bad = study(folder.path(), &SMALL.replace("seeds:", "seed:"));
    refuse(&["study", &bad, "--count"], "study.ron:5:");
    // A study file that the study's own table would overwrite.
    let own = folder.path().join("study.csv");
    std::fs::write(&own, SMALL).unwrap();
    refuse(
        &["study", argument(&own), "-o", argument(folder.path())],
        "inputs are never replaced",
    );
    assert_eq!(std::fs::read_to_string(&own).unwrap(), SMALL);
}
