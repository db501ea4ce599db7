//! Files that come from somewhere: what they hold is read within limits, shown as text and
//! nothing else, and never overwritten; and a run that is broken off leaves nothing behind.
#![cfg(all(feature = "cli", unix))]

use crate::common::cli::{command, stderr, stdout};
use std::collections::BTreeMap;
use std::fs::File;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;
use tempfile::TempDir;

/// A scene with this shape, and this name where it has one.
fn scene(shape: &str) -> String {
    format!(
        "Scene(surfaces: [Surface(shape: {shape})], source: Source(position: (-3, 5, 1)), \
         listener: Listener(position: (3, 5, 1), radius: 1))"
    )
}

/// A folder to work in, with `scene.ron` in it.
fn folder_with(shape: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.ron"), scene(shape)).unwrap();
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut program = command();
    let program = program.args(arguments).current_dir(folder);
    program.output().unwrap()
}

/// All that is in a folder, with the bytes of regular files.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .map(|path| {
            let is_read = path.is_file() && path.metadata().unwrap().len() < 1 << 20;
            let bytes = is_read.then(|| std::fs::read(&path).unwrap());
            (path, bytes)
        })
        .collect()
}

/// Runs the program in `folder`: it must refuse in one sentence, which comes back, and leave
/// everything as it is.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let before = contents(folder);
    let output = run(folder, arguments);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert_eq!(stdout(&output), "", "{arguments:?}");
    assert!(contents(folder) == before, "{arguments:?}: {said}");
    let lines = said.lines().filter(|line| line.starts_with("echomarch: "));
    let [line] = lines.collect::<Vec<_>>()[..] else {
        panic!("{arguments:?}: not one sentence: {said}");
    };
    line.to_owned()
}

/// A WAV header for `data_bytes` of samples.
fn wav_header(tag: u16, rate: u32, bits: u16, data_bytes: u32) -> Vec<u8> {
    let frame = bits / 8;
    let mut file = b"RIFF".to_vec();
    file.extend((36 + data_bytes).to_le_bytes());
    file.extend(b"WAVEfmt \x10\0\0\0");
    file.extend(tag.to_le_bytes());
    file.extend(1_u16.to_le_bytes());
    file.extend(rate.to_le_bytes());
    file.extend((rate * u32::from(frame)).to_le_bytes());
    file.extend(frame.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend(b"data");
    file.extend(data_bytes.to_le_bytes());
    file
}

fn float_wav(samples: &[f32]) -> Vec<u8> {
    let mut file = wav_header(3, 44_100, 32, 4 * samples.len() as u32);
    file.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    file
}

/// A PNG of these chunks.
fn png(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, data) in chunks {
        file.extend((data.len() as u32).to_be_bytes());
        let summed = [name.as_slice(), data].concat();
        file.extend(&summed);
        let sum = summed.iter().fold(u32::MAX, |sum, byte| {
            (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
                sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 }
            })
        });
        file.extend((!sum).to_be_bytes());
    }
    file
}

fn head(width: u32, height: u32, depth: u8, colour: u8) -> Vec<u8> {
    let mut head = [width.to_be_bytes(), height.to_be_bytes()].concat();
    head.extend([depth, colour, 0, 0, 0]);
    head
}

/// Protects what was read: no output of any subcommand replaces it, by its own name, another
/// path, a symbolic or a hard link.
#[test]
fn outputs_never_replace_inputs() {
    let folder = folder_with("Union([HeightField(image: \"h.png\", size: (9, 2, 9)), Plane])");
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

/// Protects answers that are scored into their own folder.
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

/// Answers to one trial.
fn answers(scene: &str, participant: &str) -> String {
    serde_json::json!({
        "format": "echomarch-localise-answers", "version": 2, "experiment": "2600acb3",
        "session": "aa", "participant": participant, "started": "2026-01-01T00:00:00.000Z",
        "saved": "2026-01-01T00:00:00.000Z", "order": [1], "trials": [{"number": 1,
        "stimulus": {"scene": scene, "yaw_deg": 0.0, "sound": "sine:500", "law": "linear",
        "profile": "hybrid", "waves": 64, "iterations": 2, "seed": 1, "pan": 0.2, "hits": 5,
        "source_azimuth_deg": -48.4, "source_lateral_deg": -48.4, "observer_lateral_deg": 0.0},
        "answer": {"right_m": 1.0, "ahead_m": 1.0, "azimuth_deg": 45.0, "side": "right",
        "confidence": 3, "plays": 1, "seconds": 2.5, "answered": "2026-01-01T00:00:01.000Z"}}]
    })
    .to_string()
}

/// Protects from waiting for pipes and from devices without an end, wherever a file is named.
#[test]
fn only_regular_files_are_read() {
    let folder = folder_with("Field(file: \"/dev/zero\", lipschitz: 1, size: (1, 1, 1))");
    let folder = folder.path();
    for name in ["pipe", "pipe.wav", "pipe.png"] {
        let made = Command::new("mkfifo").arg(folder.join(name)).status();
        assert!(made.unwrap().success());
    }
    symlink("/dev/zero", folder.join("zero.wav")).unwrap();
    let image = scene("HeightField(image: \"pipe.png\", size: (9, 2, 9))");
    std::fs::write(folder.join("image.ron"), image).unwrap();
    for (arguments, found) in [
        (vec!["trace", "scene.ron"], "a device"),
        (vec!["trace", "image.ron"], "a pipe"),
        (vec!["trace", "pipe"], "a pipe"),
        (vec!["trace", "/dev/zero"], "a device"),
        (
            vec!["render", "corner", "-o", "o.wav", "--sound", "pipe.wav"],
            "a pipe",
        ),
        (
            vec!["render", "corner", "-o", "o.wav", "--sound", "zero.wav"],
            "a device",
        ),
        (vec!["localise", "score", "pipe"], "a pipe"),
        (vec!["localise", "score", "/dev/zero"], "a device"),
    ] {
        let said = refusal(folder, &arguments);
        let told = format!("it is {found}, not a regular file");
        assert!(said.contains(&told), "{arguments:?}: {said}");
    }
}

/// Protects the memory: what is too large is refused before it is read or decoded, and the
/// message has the limit.
#[test]
fn large_files_are_refused_with_the_limit() {
    let folder = folder_with("HeightField(image: \"h.png\", size: (9, 2, 9))");
    let folder = folder.path();
    let sparse = |name: &str, head: &[u8], length: u64| {
        std::fs::write(folder.join(name), head).unwrap();
        let file = File::options().write(true).open(folder.join(name));
        file.unwrap().set_len(length).unwrap();
    };
    let render = |sound| {
        refusal(
            folder,
            &["render", "corner", "-o", "o.wav", "--sound", sound],
        )
    };
    sparse("large.wav", &wav_header(1, 48_000, 8, 400 << 20), 400 << 20);
    assert!(render("large.wav").contains("larger than 268435456 bytes"));
    // Within the limit on the file, and too long all the same.
    sparse(
        "long.wav",
        &wav_header(1, 48_000, 8, 200 << 20),
        (200 << 20) + 44,
    );
    assert!(render("long.wav").contains("at most 33554432 are read"));
    // Short as it is, too long once it is resampled.
    sparse(
        "slow.wav",
        &wav_header(1, 1_000, 8, 1 << 20),
        (1 << 20) + 44,
    );
    assert!(render("slow.wav").contains("50331648 at 48000 Hz"));
    // A picture of 3.6 GB that was packed well.
    let chunks = [
        (b"IHDR", head(30_000, 30_000, 16, 2)),
        (b"IDAT", vec![0; 9]),
    ];
    let chunks = chunks
        .each_ref()
        .map(|(name, data)| (*name, data.as_slice()));
    std::fs::write(folder.join("h.png"), png(&chunks)).unwrap();
    let said = refusal(folder, &["trace", "scene.ron"]);
    assert!(
        said.contains("30000 x 30000 pixels") && said.contains("1024"),
        "{said}"
    );
    sparse("h.png", b"\x89PNG", 40 << 20);
    let said = refusal(folder, &["trace", "scene.ron"]);
    assert!(said.contains("larger than 33554432 bytes"), "{said}");
    sparse("scene.ron", b"Scene(", 5 << 20);
    let said = refusal(folder, &["trace", "scene.ron"]);
    assert!(said.contains("larger than 4194304 bytes"), "{said}");
    sparse("answers.json", b"{", 20 << 20);
    let said = refusal(folder, &["localise", "score", "answers.json"]);
    assert!(said.contains("larger than 16777216 bytes"), "{said}");
}

/// Protects from pictures whose palette is not one of whole colours, at which the decoder
/// would panic.
#[test]
fn a_broken_palette_is_refused() {
    let folder = folder_with("HeightField(image: \"h.png\", size: (9, 2, 9))");
    let rows = b"\x78\x01\x01\x06\x00\xf9\xff\x00\x00\x01\x00\x01\x00\x00\x0c\x00\x03";
    for length in [1, 2, 4, 5, 7, 766, 769, 771, 1024] {
        let (head, palette) = (head(2, 2, 8, 3), vec![1; length]);
        let file = png(&[
            (b"IHDR", &head),
            (b"PLTE", &palette),
            (b"IDAT", rows),
            (b"IEND", &[]),
        ]);
        std::fs::write(folder.path().join("h.png"), file).unwrap();
        let said = refusal(folder.path(), &["trace", "scene.ron"]);
        assert!(said.contains("h.png"), "{length}: {said}");
    }
}

/// Protects the resampler, which panics where its sums overflow.
#[test]
fn samples_far_beyond_full_scale_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", "corner", "-o", "o.wav", "--sound", "v.wav"];
    for value in [3e38, -1e37, 1e10, f32::INFINITY, f32::NAN] {
        let samples: Vec<f32> = (0..2000)
            .map(|n| if n == 7 { value } else { 0.1 })
            .collect();
        std::fs::write(folder.path().join("v.wav"), float_wav(&samples)).unwrap();
        let said = refusal(folder.path(), &arguments);
        assert!(said.contains("sample 7"), "{value}: {said}");
    }
    // Integers that were written as floats.
    std::fs::write(folder.path().join("v.wav"), float_wav(&[2e9, -2e9, 0.0])).unwrap();
    let few = ["--seconds", "0.05", "--waves", "64"];
    let output = run(folder.path(), &[&arguments[..], &few].concat());
    assert!(output.status.success(), "{}", stderr(&output));
}

/// Protects terminals from names: of scenes, surfaces, values, files and answers.
#[test]
fn no_name_reaches_a_terminal_as_it_is() {
    let folder = folder_with("Plane");
    let folder = folder.path();
    let nasty = [
        "\u{1b}[31mred",
        "two\nlines",
        "\u{202e}turned",
        "\u{9b}1m",
        "a\rb",
    ];
    for name in nasty
        .map(str::to_owned)
        .into_iter()
        .chain(["x".repeat(1 << 20)])
    {
        let quoted = name.escape_default().to_string();
        let plain = scene("Plane");
        let named = [
            plain.replacen("Scene(", &format!("Scene(name: \"{quoted}\", "), 1),
            plain.replace("Surface(", &format!("Surface(name: \"{quoted}\", ")),
            scene(&format!("Sphere(radius: Value(\"{quoted}\", 1))")),
            scene(&format!(
                "HeightField(image: \"{quoted}\", size: (1, 1, 1))"
            )),
            scene(&format!(
                "Field(file: \"{quoted}\", lipschitz: 1, size: (1, 1, 1))"
            )),
            scene(&format!("r#\"{name}\"#")),
        ];
        for text in named {
            std::fs::write(folder.join("named.ron"), &text).unwrap();
            let said = refusal(folder, &["trace", "named.ron"]);
            check_shown(&said);
        }
        std::fs::write(folder.join("a.json"), answers(&name, "p")).unwrap();
        check_shown(&refusal(folder, &["localise", "score", "a.json"]));
        let said = serde_json::to_string(&name).unwrap();
        let file = answers("s", "p").replace("\"right\"", &said);
        std::fs::write(folder.join("a.json"), file).unwrap();
        check_shown(&refusal(folder, &["localise", "score", "a.json"]));
    }
    // The file's own name stands for the scene's.
    std::fs::write(folder.join("\u{1b}[31m\n.ron"), scene("Plane")).unwrap();
    let output = run(folder, &["trace", "\u{1b}[31m\n.ron", "--waves", "64"]);
    assert!(output.status.success());
    check_shown(&stdout(&output).replace('\n', ""));
    let output = run(
        folder,
        &["trace", "\u{1b}[31m\n.ron", "--waves", "64", "--json"],
    );
    assert!(serde_json::from_slice::<serde_json::Value>(&output.stdout).is_ok());
}

/// Within the limits on messages, and nothing in it but what can be seen.
fn check_shown(said: &str) {
    assert!(said.chars().count() <= 1000, "{} characters", said.len());
    let hidden = |c: char| c.is_control() || c == '\u{202e}';
    assert!(!said.contains(hidden), "{said:?}");
}

/// Protects readers from errors that fill the screen.
#[test]
fn messages_of_many_lines_are_cut() {
    let folder = tempfile::tempdir().unwrap();
    let said = serde_json::to_string(&"\n".repeat(50)).unwrap();
    let file = answers("corner", "p").replace("\"right\"", &said);
    std::fs::write(folder.path().join("a.json"), file).unwrap();
    let output = run(folder.path(), &["localise", "score", "a.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).lines().count() <= 10, "{}", stderr(&output));
}

/// Protects spreadsheets from names that they would take for formulas.
#[test]
fn no_csv_cell_is_a_formula() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["=1+1", "+1", "-1", "@SUM(1)", " =1"] {
        std::fs::write(folder.path().join("a.json"), answers(name, "p")).unwrap();
        let output = run(folder.path(), &["localise", "score", "a.json", "-o", "."]);
        assert!(output.status.success(), "{}", stderr(&output));
        let table = std::fs::read_to_string(folder.path().join("score.csv")).unwrap();
        let first_cells = table.lines().map(|line| line.split(',').next().unwrap());
        assert!(
            first_cells.clone().any(|cell| cell == format!("'{name}")),
            "{table}"
        );
    }
}

/// Protects the form from names that HTML gives a meaning to: a script element that is begun
/// in one never ends.
#[test]
fn a_form_holds_names_as_data() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        scene("Room(size: (30, 20, 30))").replacen("Scene(", "Scene(name: \"<!--<script>&\", ", 1);
    std::fs::write(folder.path().join("y.ron"), text).unwrap();
    let arguments = [
        "localise",
        "form",
        "-o",
        "form",
        "--scenes",
        "y.ron",
        "--sounds",
        "sine:500",
        "--waves",
        "64",
        "--iterations",
        "1",
        "--seconds",
        "0.1",
    ];
    let output = run(folder.path(), &arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = std::fs::read_to_string(folder.path().join("form/form.html")).unwrap();
    let begin = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let data = &page[begin..begin + page[begin..].find("</script>").unwrap()];
    assert!(!data.contains(['<', '>', '&']));
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["trials"][0]["stimulus"]["scene"], "<!--<script>&");
}

/// Protects from scenes that are good at their key frames and impossible between them: each
/// subcommand refuses them, with the time.
#[test]
fn what_is_impossible_between_keys_is_refused_with_its_time() {
    let prism = "Prism(corners: [(0, 0), (1, 0), (0.5, Keys([(0, 1), (2, -1)]))], depth: 1)";
    let normal = "Complement(HalfSpace(normal: (Keys([(0, 1), (3, -2)]), 0, 0), offset: -9))";
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

/// Protects from files with very many key frames: each is looked at a few times, not as often
/// as there are others.
#[test]
fn a_hundred_thousand_key_frames_are_read() {
    let keys: Vec<String> = (0..100_000).map(|n| format!("({n},1.{})", n % 7)).collect();
    let folder = folder_with(&format!("Sphere(radius: Keys([{}]))", keys.join(",")));
    let output = run(folder.path(), &["trace", "scene.ron", "--waves", "64"]);
    assert!(output.status.success(), "{}", stderr(&output));
}

/// Starts the program, waits for a temporary file with something in it, and sends the signal.
fn broken_off(signal: &str, number: i32, arguments: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let mut program = command();
    let program = program.args(arguments).current_dir(folder.path());
    let mut program = program
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let has_begun = || {
        let files = std::fs::read_dir(folder.path()).unwrap().flatten();
        let mut sizes = files.filter_map(|file| file.metadata().ok());
        sizes.any(|about| about.len() > 0)
    };
    while !has_begun() {
        assert!(
            program.try_wait().unwrap().is_none(),
            "{arguments:?} ended too soon"
        );
        sleep(Duration::from_millis(5));
    }
    let id = program.id().to_string();
    let sent = Command::new("kill").args(["-s", signal, &id]).status();
    assert!(sent.unwrap().success());
    let ended = program.wait().unwrap();
    assert_eq!(ended.code(), Some(128 + number), "{signal}: {arguments:?}");
    let left = contents(folder.path());
    assert!(left.is_empty(), "{signal}: {:?}", left.keys());
}

/// Protects folders from what is left of runs that are broken off: from the terminal, by a
/// program, by a terminal that is closed.
#[test]
fn a_run_that_is_broken_off_leaves_nothing() {
    let render = ["render", "corner", "-o", "o.wav", "--seconds", "9000"];
    let dump = [
        "trace",
        "open-field",
        "--waves",
        "8388608",
        "--iterations",
        "1",
        "--dump-waves",
        "w.csv",
    ];
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        broken_off(signal, number, &render);
    }
    broken_off("TERM", 15, &dump);
    // `nohup` says that it is to go on.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    if ignored.unwrap_or(0) & 1 == 0 {
        broken_off("HUP", 1, &render);
    }
}

/// Protects from scenes whose shader the driver would compile for minutes, or die of.
#[test]
fn what_compiles_for_minutes_is_refused() {
    let planes = "Plane), Surface(shape: ".repeat(600) + "Plane";
    let balls = format!("Union([{}])", "Sphere(radius: 1),".repeat(600));
    let kinds: Vec<String> = (1..40)
        .map(|n| format!("Union([{}])", "Torus(ring: 2, tube: 1),".repeat(n)))
        .collect();
    let kinds = kinds.join("), Surface(shape: ");
    for shapes in [planes, balls, kinds] {
        let folder = folder_with(&shapes);
        let said = refusal(folder.path(), &["trace", "scene.ron", "--waves", "64"]);
        assert!(said.contains("512"), "{said}");
    }
}

/// Protects what the window keeps: broken off, it ends as if it had been closed.
#[cfg(feature = "demo")]
#[test]
fn a_window_that_is_broken_off_is_closed() {
    use std::io::{BufRead, BufReader};
    let display = crate::common::window::Display::new();
    let folder = tempfile::tempdir().unwrap();
    let mut program = command();
    let program = program
        .args([
            "demo",
            "--waves",
            "64",
            "--scale",
            "0.1",
            "--screenshot",
            "last.png",
        ])
        .arg("--log-frames")
        .current_dir(folder.path())
        .env("DISPLAY", &display.name);
    let mut program = program
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(program.stderr.take().unwrap()).lines();
    let frame = lines.find(|line| {
        line.as_ref()
            .is_ok_and(|line| line.starts_with("{\"frame\""))
    });
    assert!(frame.is_some(), "no frame was drawn");
    let read_on = std::thread::spawn(move || lines.count());
    let id = program.id().to_string();
    let sent = Command::new("kill").args(["-s", "TERM", &id]).status();
    assert!(sent.unwrap().success());
    assert_eq!(program.wait().unwrap().code(), Some(128 + 15));
    read_on.join().unwrap();
    let left: Vec<PathBuf> = contents(folder.path()).into_keys().collect();
    assert_eq!(left, [folder.path().join("last.png")]);
}
