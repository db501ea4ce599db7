//! The window's sound: what `echomarch demo` plays through a real sound server, beside what
//! its report says that it traced.
#![cfg(all(feature = "demo", feature = "audio"))]

mod common;
mod sound_server;

use common::window::{Demo, Display};
use serde_json::Value;
use sound_server::levels::{Heard, Log, error_db, gains};
use sound_server::{SINK, Server, now_s, wait_for};
use std::thread::sleep;
use std::time::Duration;

/// Frames of a window of sound: 50 ms, over which the noise's level is known to 0.1 dB.
const WINDOW: usize = 2400;

fn open<'a>(display: &'a Display, server: &Server, arguments: &[&str]) -> Demo<'a> {
    let program = server.command(env!("CARGO_BIN_EXE_echomarch"));
    let sound = ["--sound", "noise", "--volume", "1"];
    display.start(program, &[arguments, &sound].concat())
}

/// Seconds and gains of all that was traced, by the linear law.
fn traced(report: &Value) -> Vec<(f64, [f64; 2])> {
    let pans = report["pans"].as_array().unwrap().iter();
    pans.map(|at| {
        let pan = at["pan"].as_f64().unwrap();
        let gains = [0.5 * (1.0 - pan), 0.5 * (1.0 + pan)];
        (at["seconds"].as_f64().unwrap(), gains)
    })
    .collect()
}

/// Protects what it is all about: the source passes from left to right, and both channels of what the sound server
/// plays are as loud as the waves that were traced say, in every window. Waves are traced for every twentieth picture,
/// so that the gains stand still in between.
#[test]
fn a_passing_source_is_heard_from_left_to_right_as_it_is_traced() {
    let display = Display::new();
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let demo = open(&display, &server, &["open-field", "--trace-every", "20"]);
    sleep(Duration::from_secs(15));
    let asked_to_quit = now_s();
    let (report, _, _) = demo.quit();
    let begin_s = recorder.began_s;
    let heard = recorder.stop();
    assert_eq!(report["sound"]["is_heard"], true, "{}", report["sound"]);
    // The report's clock ended when the window was asked to close.
    let begin_s = begin_s - (asked_to_quit - report["seconds"].as_f64().unwrap());
    let log = Log(traced(&report)
        .iter()
        .map(|(at, gains)| (*at, gains[1]))
        .collect());
    let buffer = report["sound"]["buffer"].as_f64().unwrap();
    let compared = log.compare(&Heard::new(&heard, 50), begin_s, buffer / 48_000.0);
    println!(
        "{compared:?}, {} traced, sound {}",
        log.0.len(),
        report["sound"]
    );
    assert!(compared.windows > 200, "{compared:?}");
    // A busy machine may leave a gap; whatever was played is right.
    assert!(compared.gaps * 10 <= compared.windows, "{compared:?}");
    assert!(compared.worst_db <= 0.5, "{compared:?}");
    // Both sides and the middle were among them.
    for range in [0.0..0.35, 0.35..0.65, 0.65..1.0] {
        let there = log.0.iter().filter(|(_, share)| range.contains(share));
        assert!(there.count() >= 2, "nothing was heard at {range:?}");
    }
}

/// Protects a window that is open all day: the sound server dies and is started again, the picture goes on, and the
/// sound comes back with the gains that are traced.
#[test]
fn a_sound_server_that_is_started_again_is_played_to_again() {
    let display = Display::new();
    let mut server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let demo = open(&display, &server, &["corner"]);
    let is_loud = |samples: Vec<f32>| {
        let last = samples.len().saturating_sub(9600);
        gains(&samples[last..], WINDOW)
            .iter()
            .any(|g| g[0] + g[1] > 0.5)
    };
    wait_for("sound", || is_loud(recorder.samples()));
    server.kill();
    drop(recorder);
    sleep(Duration::from_secs(2));
    server.restart();
    let recorder = server.record(SINK, 48_000, 2);
    wait_for("sound again", || is_loud(recorder.samples()));
    sleep(Duration::from_secs(1));
    let heard = gains(&recorder.stop(), WINDOW);
    let (report, _, _) = demo.quit();
    let sound = &report["sound"];
    assert_eq!(sound["is_heard"], true, "{sound}");
    assert_eq!(sound["restarts"], 1, "{sound}");
    let wanted = traced(&report).last().unwrap().1;
    let right = heard.iter().filter(|g| error_db(**g, wanted) < 0.5).count();
    assert!(right > 10, "{right} windows as loud as {wanted:?}");
    // Without a sound server frames went on.
    let times: Vec<f64> = traced(&report).iter().map(|(at, _)| *at).collect();
    let longest = times.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    assert!(longest < 1.0, "no frame for {longest} s");
}

/// Protects `--record`: it begins before there is a device, and the file holds what is heard.
#[test]
fn what_is_heard_is_recorded() {
    let display = Display::new();
    let server = Server::start();
    let arguments = ["corner", "--record", "heard.wav"];
    let demo = open(&display, &server, &arguments);
    sleep(Duration::from_secs(4));
    let (report, _, folder) = demo.quit();
    assert_eq!(report["sound"]["is_recording"], true, "{}", report["sound"]);
    let mut reader = hound::WavReader::open(folder.path().join("heard.wav")).unwrap();
    assert_eq!(reader.spec().sample_rate, 48_000);
    assert_eq!(reader.spec().channels, 2);
    let heard: Vec<f32> = reader.samples().map(Result::unwrap).collect();
    let heard = gains(&heard, WINDOW);
    assert!(heard.len() >= 40, "{} windows", heard.len());
    // Nothing moves: after the first second, and before the fade at the end, all is the same.
    let wanted = traced(&report).last().unwrap().1;
    for window in &heard[20..heard.len() - 2] {
        let off = error_db(*window, wanted);
        assert!(off < 0.5, "{window:?} beside {wanted:?}");
    }
    let names = std::fs::read_dir(folder.path()).unwrap();
    let names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
    let parts = names
        .iter()
        .filter(|n| n.to_string_lossy().contains("part"));
    assert_eq!(parts.count(), 0, "{names:?}");
}

/// Protects the list that `--device` is chosen from: devices may share a name, never an id.
#[test]
fn devices_are_listed_with_name_and_id() {
    let server = Server::start();
    let mut program = server.command(env!("CARGO_BIN_EXE_echomarch"));
    let output = program.args(["demo", "--list-devices"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    assert_eq!(text, format!("* Null Output ({SINK})\n"));
}
