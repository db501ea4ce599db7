//! The window's sound: compares the output of `echomarch demo` at a real sound server with the traced gains in its
//! report.

use crate::common::cli::argument;
use crate::common::window::{Demo, Display};
use crate::sound_server::levels::{Comparison, Heard, error_db, gains};
use crate::sound_server::{SINK, Server, wait_for};
use serde_json::Value;
use std::path::Path;

/// Number of audio frames in an interval whose level is measured: 50 ms, in which the level of noise is accurate to 0.1
/// dB.
const WINDOW: usize = 2400;

fn open<'a>(display: &'a Display, server: &Server, arguments: &[&str]) -> Demo<'a> {
    let program = server.command(env!("CARGO_BIN_EXE_echomarch"));
    let sound = ["--sound", "noise", "--volume", "1"];
    display.start(program, &[arguments, &sound].concat())
}

/// The gains of all traced frames, in order, by the linear law.
fn traced(report: &Value) -> Vec<[f64; 2]> {
    let pans = report["pans"].as_array().unwrap().iter();
    pans.map(|at| {
        let pan = at["pan"].as_f64().unwrap();
        [0.5 * (1.0 - pan), 0.5 * (1.0 + pan)]
    })
    .collect()
}

/// Protects the purpose of the window. The source passes from left to right, and both channels of the sound server's
/// output have the level of the traced waves, in every interval without a gap. Waves are traced for every twentieth
/// picture, so that the gains are constant in between. The sound system decides when the gains are applied.
/// `live_audio.rs` checks without a sound system that the next block applies them.
#[test]
fn a_passing_source_is_heard_from_left_to_right_as_it_is_traced() {
    const LEAST_WINDOWS: usize = 60;
    const ATTEMPTS: u32 = 5;
    let display = Display::new();
    for attempt in 1..=ATTEMPTS {
        let (report, compared) = pass(&display);
        let late = &report["sound"]["underruns"];
        println!("attempt {attempt}: {compared:?}, {late} late blocks");
        assert_eq!(compared.wrong, 0, "{compared:?}");
        if compared.windows < LEAST_WINDOWS {
            continue;
        }
        // The gains are constant most of the time.
        assert!(2 * compared.moving < compared.windows, "{compared:?}");
        // The source was at both sides and in the middle.
        for range in [0.0..0.35, 0.35..0.65, 0.65..1.0] {
            let shares = traced(&report).into_iter().map(|[_, right]| right);
            let there = shares.filter(|share| range.contains(share));
            assert!(there.count() >= 2, "no sound at {range:?}");
        }
        return;
    }
    panic!(
        "the machine is too busy: fewer than {LEAST_WINDOWS} windows of sound without a gap, {ATTEMPTS} times"
    );
}

/// Lets the source pass twice. Returns the report and the comparison with the recorded sound.
fn pass(display: &Display) -> (Value, Comparison) {
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let arguments = ["open-field", "--trace-every", "20", "--law", "linear"];
    let demo = open(display, &server, &arguments);
    demo.wait_until("sound", |frame| frame["sound"] == true);
    let mut begin = None;
    demo.wait_until("two passes", |frame| {
        let now = frame["seconds"].as_f64().unwrap();
        now > *begin.get_or_insert(now) + 10.0
    });
    let (report, _, _) = demo.quit();
    let heard = recorder.stop();
    // The sound is in the middle until the first frame of waves has arrived.
    let shares = [0.5].into_iter();
    let shares = shares.chain(traced(&report).into_iter().map(|[_, right]| right));
    let shares: Vec<f64> = shares.collect();
    let heard = Heard::new(&heard, 50);
    // With swapped channels, almost no interval matches.
    let mirrored: Vec<f64> = shares.iter().map(|share| 1.0 - share).collect();
    let mirrored = heard.follow(&mirrored);
    let astray = mirrored.wrong + mirrored.moving;
    assert!(2 * astray > mirrored.windows, "{mirrored:?}");
    let compared = heard.follow(&shares);
    if compared.wrong > 0 {
        println!("{heard:?} beside {shares:?}");
    }
    (report, compared)
}

/// Protects a window that is open all day: if the sound server dies and is restarted, the picture continues, and the
/// sound returns with the traced gains.
#[test]
fn a_sound_server_that_is_started_again_is_played_to_again() {
    let display = Display::new();
    let mut server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let demo = open(&display, &server, &["corner", "--law", "linear"]);
    let is_loud = |samples: Vec<f32>| {
        let last = samples.len().saturating_sub(9600);
        gains(&samples[last..], WINDOW)
            .iter()
            .any(|g| g[0] + g[1] > 0.5)
    };
    wait_for("sound", || is_loud(recorder.samples()));
    server.kill();
    drop(recorder);
    // Frames continue without a sound server.
    demo.wait_until("silence", |frame| frame["sound"] == false);
    let frame = demo.wait_until("a frame of waves", |_| true);
    let wanted = frame["heard"]["pan"].as_f64().unwrap();
    let wanted = [0.5 * (1.0 - wanted), 0.5 * (1.0 + wanted)];
    demo.wait_traced(20);
    server.restart();
    let recorder = server.record(SINK, 48_000, 2);
    wait_for("sound at the traced level", || {
        let heard = gains(&recorder.samples(), WINDOW);
        let right = heard.iter().filter(|g| error_db(**g, wanted) < 0.5);
        right.count() > 10
    });
    demo.wait_until("sound", |frame| frame["sound"] == true);
    let (report, _, _) = demo.quit();
    let sound = &report["sound"];
    assert_eq!(sound["is_heard"], true, "{sound}");
    assert!(sound["restarts"].as_u64() >= Some(1), "{sound}");
    // Nothing moves in this scene.
    assert_eq!(traced(&report).last(), Some(&wanted));
}

/// Protects `--record`: the recording starts before a device exists, and the file contains the played sound.
#[test]
fn what_is_heard_is_recorded() {
    let display = Display::new();
    let server = Server::start();
    let arguments = ["corner", "--record", "heard.wav", "--law", "linear"];
    let demo = open(&display, &server, &arguments);
    // Three seconds of two channels of 32-bit floats, however long it takes to produce them.
    wait_for("the recording", || {
        recorded_bytes(&demo.path("")) > 3 * 48_000 * 8
    });
    let (report, _, folder) = demo.quit();
    assert_eq!(report["sound"]["is_recording"], true, "{}", report["sound"]);
    let mut reader = hound::WavReader::open(folder.path().join("heard.wav")).unwrap();
    assert_eq!(reader.spec().sample_rate, 48_000);
    assert_eq!(reader.spec().channels, 2);
    let heard: Vec<f32> = reader.samples().map(Result::unwrap).collect();
    let heard = gains(&heard, WINDOW);
    assert!(heard.len() >= 40, "{} windows", heard.len());
    // Nothing moves, so the gains are constant from the first frame of waves to the final fade.
    let wanted = *traced(&report).last().unwrap();
    let is_right = |window: &[f64; 2]| error_db(*window, wanted) < 0.5;
    // The two channels play the same noise, so their balance is exact. The initial balance of 0 dB ends when the
    // balance is closer to the traced one. The interval with the glide is skipped.
    let balance_db = |window: &[f64; 2]| 20.0 * (window[0] / window[1]).log10();
    let has_arrived = |window: &[f64; 2]| balance_db(window) / balance_db(&wanted) > 0.5;
    let arrived = heard.iter().position(has_arrived).unwrap() + 1;
    // The volume rises from the first frame of waves on.
    let risen = heard.iter().position(is_right).unwrap();
    assert!(
        risen <= arrived + 5,
        "the sound rises for {} windows",
        risen - arrived
    );
    let first = arrived.max(risen);
    let (last, compared) = (heard.len() - 2, heard.len() - 2 - first);
    assert!(compared >= 10, "{compared} windows after the middle");
    for window in &heard[first..last] {
        assert!(is_right(window), "{window:?} beside {wanted:?}");
    }
    let names = std::fs::read_dir(folder.path()).unwrap();
    let names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
    let parts = names
        .iter()
        .filter(|n| n.to_string_lossy().contains("part"));
    assert_eq!(parts.count(), 0, "{names:?}");
}

/// The source is in the open, moves behind a wall, and stays there. A ceiling reflects its sound.
const BEHIND: &str = r#"Scene(
    surfaces: [
        Surface(shape: Box(size: (6, 3, 0.4)), position: (0, 0, -3)),
        Surface(shape: Plane, position: (0, 6, 0), rotation: (180, 0, 0)),
    ],
    source: Source(position: (0.5, 0, -6), path: [
        (time: 0, position: (9, 0, -6)),
        (time: 10, position: (9, 0, -6)),
        (time: 12, position: (0.5, 0, -6)),
        (time: 25, position: (0.5, 0, -6)),
    ]),
    listener: Listener(position: (0, 0, 0), radius: 0.3),
)"#;

/// Protects the sound of the window when a source moves behind a wall: its level falls, its echo stays, its direction
/// changes from the right to the middle, and the output of the sound server has no click.
#[test]
fn a_source_that_goes_behind_a_wall_is_heard_by_its_echo() {
    let display = Display::new();
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("behind.ron");
    std::fs::write(&scene, BEHIND).unwrap();
    let program = server.command(env!("CARGO_BIN_EXE_echomarch"));
    let sound = ["--sound", "sine:440", "--volume", "1"];
    let demo = display.start(program, &[&[argument(&scene)], &sound[..]].concat());
    // The path restarts more than a second after its end.
    let stands = |frame: &Value, is_direct: bool, from: f64, to: f64| {
        let now = frame["seconds"].as_f64().unwrap() % 26.0;
        let source = &frame["sources"][0]["is_direct"];
        frame["sound"] == true && *source == is_direct && from < now && now < to
    };
    // A busy machine may have a gap at that moment; the test then measures again.
    let heard = |what: &str, is_direct, from, to| {
        let mut found = [0.0; 2];
        wait_for(what, || {
            demo.wait_until(what, |frame| stands(frame, is_direct, from, to));
            found = level(&recorder.samples());
            found[0] > 0.0 && found[1] > 0.0
        });
        found
    };
    let in_sight = heard("sound", true, 3.0, 8.0);
    let behind = heard("sound from behind the wall", false, 15.0, 24.0);
    let (report, _, _) = demo.quit();
    // In sight, the sound comes from the right, over 10.8 m and 14.7 m. Behind the wall, it comes only over the
    // ceiling, over 13.4 m.
    assert!(in_sight[1] > 1.5 * in_sight[0], "{in_sight:?}");
    assert!((behind[0] / behind[1] - 1.0).abs() < 0.2, "{behind:?}");
    let fall = behind[1] / in_sight[1];
    assert!((0.2..0.9).contains(&fall), "{in_sight:?} {behind:?}");
    let in_full = &report["in_full"];
    assert!(in_full["looks"].as_u64() > Some(3), "{in_full}");
    assert!(
        in_full["sources"][0]["paths"].as_u64() >= Some(1),
        "{in_full}"
    );
}

/// A source to the right of the listener, in the open.
const AT_THE_RIGHT: &str = r#"Scene(
    surfaces: [Surface(shape: Sphere(radius: 0.1), position: (0, -500, 0))],
    source: Source(position: (4, 0, 0)),
    listener: Listener(position: (0, 0, 0), radius: 0.3),
)"#;

/// Protects the first second: the window plays nothing before the first response, and then the source where it is. Any
/// sound before would be in the middle. The sound fades in.
#[test]
fn nothing_is_heard_before_the_first_response() {
    /// Samples of an interval: 5 ms.
    const SHORT: usize = 240;
    let display = Display::new();
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let folder = tempfile::tempdir().unwrap();
    for listen in ["full", "balance"] {
        let scene = folder.path().join("right.ron");
        std::fs::write(&scene, AT_THE_RIGHT).unwrap();
        let begin = recorder.samples().len();
        let demo = open(&display, &server, &[argument(&scene), "--listen", listen]);
        wait_for("sound", || {
            let [left, right] = level(&recorder.samples());
            right > 0.01 && right > 4.0 * left
        });
        demo.quit();
        let samples = recorder.samples();
        let heard = gains(&samples[begin..], SHORT);
        let first = heard.iter().position(|[l, r]| l + r > 0.0);
        let first = first.expect("a sound");
        let loudest = heard
            .iter()
            .fold(0.0_f64, |most, [_, right]| most.max(*right));
        println!("{listen}: silence for {} ms", 5 * first);
        assert!(
            heard[first][1] < 0.7 * loudest,
            "{listen}: {:?}",
            heard[first]
        );
        for [left, right] in &heard[first..] {
            let is_silent = left + right < 0.02 * loudest;
            assert!(is_silent || *right > 3.0 * left, "{listen}: {left} {right}");
        }
    }
}

/// A long room with a source at one end.
const LONG_ROOM: &str = r#"Scene(
    surfaces: [Surface(shape: Room(size: (5, 3, 14)), material: "wall")],
    materials: {"wall": Material(absorption: 0.3, scattering: 0.2)},
    source: Source(position: (0, 0, -5)),
    listener: Listener(position: (0, 0, 6), radius: 0.3),
)"#;

/// Protects differences of level: a walk towards a source changes the recorded level as much as the level on the meter,
/// and the limiter rests.
#[test]
fn a_walk_to_the_source_is_as_loud_as_it_is_traced() {
    /// Samples of two seconds, over which a level is measured.
    const STEADY: usize = 2 * 2 * 48_000;
    let display = Display::new();
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("long.ron");
    std::fs::write(&scene, LONG_ROOM).unwrap();
    let demo = open(&display, &server, &[argument(&scene)]);
    let z = |frame: &Value| frame["listener"][2].as_f64().unwrap_or(0.0);
    // The level after three further traces, and the strength in the report of the same place.
    let heard = |what: &str| {
        wait_for(what, || level(&recorder.samples())[0] > 0.0);
        demo.wait_traced(20);
        let mut found = (0.0, 0.0);
        let mut next = recorder.samples().len() + STEADY;
        wait_for("a steady level", || {
            let samples = recorder.samples();
            if samples.len() < next {
                return false;
            }
            // Levels are compared over different intervals.
            next = samples.len() + STEADY;
            let frame = demo.wait_until(what, |frame| frame["sources"][0]["level_db"].is_f64());
            let Some(recorded) = level_of_noise(&samples[samples.len() - STEADY..]) else {
                return false;
            };
            let before = std::mem::replace(
                &mut found,
                (recorded, frame["sources"][0]["level_db"].as_f64().unwrap()),
            );
            println!("{what}: recorded and traced {found:.2?} dB");
            (before.0 - found.0).abs() < 0.3 && (before.1 - found.1).abs() < 0.3
        });
        found
    };
    let far = heard("sound far away");
    demo.hold_until("w", "a place near the source", |frame| z(frame) < -3.0);
    let near = heard("sound near the source");
    let (report, _, _) = demo.quit();
    let (recorded, traced) = (near.0 - far.0, near.1 - far.1);
    println!("recorded {recorded:.1} dB, traced {traced:.1} dB");
    assert!(traced > 3.0, "{far:?} {near:?}");
    assert!(
        (recorded - traced).abs() < 1.0,
        "recorded {recorded} dB, traced {traced} dB"
    );
    assert_eq!(
        report["in_full"]["limited_db"], 0.0,
        "{}",
        report["in_full"]
    );
}

/// A talker behind a pillar of concrete, which sound passes and bends around.
const PILLAR: &str = "Scene(
    surfaces: [Surface(shape: Cylinder(radius: 1, height: 6), material: \"concrete\")],
    source: Source(position: (0, 0, -3)),
    listener: Listener(position: (0.3, 0, 3), radius: 0.3))";

/// Protects the switches of the parts of full sound: `--diffraction` switches diffraction on, the keys 4 and 5 switch
/// diffraction and transmission off, and the key 8 adds a path with the level of `--least-level`.
#[test]
fn keys_switch_the_parts_of_the_sound() {
    let display = Display::new();
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("pillar.ron");
    std::fs::write(&scene, PILLAR).unwrap();
    let demo = display.demo(&[argument(&scene), "--diffraction", "--least-level", "-40"]);
    let heard = |what: &str, paths: [u64; 5]| {
        demo.wait_until(what, |frame| {
            let kinds = frame["sources"][0]["kinds"].as_array();
            kinds.is_some_and(|kinds| kinds.iter().map(|kind| &kind["paths"]).eq(paths.iter()))
        })
    };
    heard("two ways around and one through", [0, 0, 2, 1, 0]);
    demo.key("4");
    heard(
        "only transmission, raised to the least level",
        [0, 0, 0, 1, 1],
    );
    demo.key("5");
    let frame = heard("only the least level", [0, 0, 0, 0, 1]);
    // The source is 6.007 m away.
    let least_db = 20.0 * (10.0_f64 / 36.09_f64.sqrt()).log10() - 40.0;
    let level_db = frame["sources"][0]["level_db"].as_f64().unwrap();
    assert!((level_db - least_db).abs() < 0.01, "{level_db} {least_db}");
    demo.key("8");
    heard("nothing", [0; 5]);
    demo.quit();
}

/// The level of each channel in the last fifth of a second.
fn level(samples: &[f32]) -> [f64; 2] {
    let last = &samples[samples.len().saturating_sub(2 * 9600)..];
    [0, 1].map(|channel| {
        let squares = last
            .iter()
            .skip(channel)
            .step_by(2)
            .map(|s| f64::from(*s).powi(2));
        (squares.sum::<f64>() / 9600.0).sqrt()
    })
}

/// The level of both channels of noise in decibels, over all frames that are not silent: a busy machine leaves gaps of
/// silence, and noise has none. `None` if less than a quarter of a second remains.
fn level_of_noise(samples: &[f32]) -> Option<f64> {
    const LEAST_FRAMES: usize = 12_000;
    let power = |frame: &[f32]| frame.iter().map(|s| f64::from(*s).powi(2)).sum::<f64>();
    let frames = samples.chunks_exact(2).map(power);
    let heard: Vec<f64> = frames.filter(|power| *power > 0.0).collect();
    let is_enough = heard.len() >= LEAST_FRAMES;
    is_enough.then(|| 10.0 * (heard.iter().sum::<f64>() / heard.len() as f64).log10())
}

/// The size of the WAV files in a folder, in bytes.
fn recorded_bytes(folder: &Path) -> u64 {
    let files = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap());
    let sounds = files.filter(|file| file.file_name().to_string_lossy().ends_with(".wav"));
    sounds.map(|file| file.metadata().unwrap().len()).sum()
}

/// Protects the list of devices for `--device`: devices may have the same name, but not the same id.
#[test]
fn devices_are_listed_with_name_and_id() {
    let server = Server::start();
    let mut program = server.command(env!("CARGO_BIN_EXE_echomarch"));
    let output = program.args(["demo", "--list-devices"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    assert_eq!(text, format!("* Null Output ({SINK})\n"));
}

/// Protects users who mistype a device name: the error lists the devices before a window opens.
#[test]
fn an_unknown_device_is_refused() {
    let server = Server::start();
    let mut program = server.command(env!("CARGO_BIN_EXE_echomarch"));
    let output = program
        .args(["demo", "corner", "--device", "Attic"])
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(
        told.contains("Attic") && told.contains("Null Output"),
        "{told}"
    );
}
