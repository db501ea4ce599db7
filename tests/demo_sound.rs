//! The window's sound: what `echomarch demo` plays through a real sound server, beside what
//! its report says that it traced.
#![cfg(all(feature = "demo", feature = "audio"))]

mod common;
mod sound_server;

use common::window::{Demo, Display};
use serde_json::Value;
use sound_server::levels::{error_db, gains};
use sound_server::{SINK, Server, wait_for};
use std::thread::sleep;
use std::time::Duration;

/// Frames of a window of sound: 50 ms, over which the noise's level is known to 0.1 dB.
const WINDOW: usize = 2400;
const WINDOW_S: f64 = WINDOW as f64 / 48_000.0;

/// Around a change of the gains nothing is compared: a block waits to be played, and the
/// gains glide for 20 ms.
const GUARD_S: f64 = 0.09;

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

/// The gains that hold from a guard before `from` to a guard after `to`, if they are the same all the while.
fn steady(traced: &[(f64, [f64; 2])], from: f64, to: f64) -> Option<[f64; 2]> {
    let begun = traced.iter().rposition(|(at, _)| *at <= from - GUARD_S)?;
    let over = traced.iter().position(|(at, _)| *at > to + GUARD_S)?;
    let gains = traced[begun].1;
    traced[begun..over]
        .iter()
        .all(|(_, other)| (0..2).all(|ear| (gains[ear] - other[ear]).abs() < 1e-3))
        .then_some(gains)
}

/// Windows of what was heard beside the gains traced for them, if the recording began
/// `offset` seconds after the report's clock.
fn pairs(heard: &[[f64; 2]], traced: &[(f64, [f64; 2])], offset: f64) -> Vec<([f64; 2], [f64; 2])> {
    let windows = heard.iter().enumerate();
    windows
        .filter_map(|(index, &heard)| {
            let from = offset + index as f64 * WINDOW_S;
            Some((heard, steady(traced, from, from + WINDOW_S)?))
        })
        .collect()
}

fn agreeing(pairs: &[([f64; 2], [f64; 2])]) -> usize {
    let agree = pairs
        .iter()
        .filter(|(heard, wanted)| error_db(*heard, *wanted) < 0.5);
    agree.count()
}

/// Protects what it is all about: the source passes from left to right, and both channels of what the sound server
/// plays are as loud as the waves that were traced say. Waves are traced for every twentieth picture, so that the
/// gains stand still in between and the two clocks need not agree to the millisecond.
#[test]
fn a_passing_source_is_heard_from_left_to_right_as_it_is_traced() {
    let display = Display::new();
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let demo = open(&display, &server, &["open-field", "--trace-every", "20"]);
    sleep(Duration::from_secs(15));
    let (report, _, _) = demo.quit();
    let heard = gains(&recorder.stop(), WINDOW);
    assert_eq!(report["sound"]["is_heard"], true, "{}", report["sound"]);
    let traced = traced(&report);

    // Where the recording's beginning lies on the report's clock is all that is not known.
    let offsets = (-1500..100).map(|step| 0.01 * f64::from(step));
    let offset = offsets
        .max_by_key(|&offset| agreeing(&pairs(&heard, &traced, offset)))
        .unwrap();
    let pairs = pairs(&heard, &traced, offset);
    let agreeing = agreeing(&pairs);
    let worst = pairs
        .iter()
        .map(|(heard, wanted)| error_db(*heard, *wanted));
    println!(
        "{agreeing} of {} windows within 0.5 dB, the worst {:.2} dB off, clock {offset:.2} s",
        pairs.len(),
        worst.fold(0.0, f64::max)
    );
    assert!(pairs.len() > 30, "{} windows", pairs.len());
    // A busy machine may leave a gap in what is played.
    assert!(agreeing * 20 >= pairs.len() * 19);
    // Both sides and the middle were among them.
    for range in [0.0..0.35, 0.35..0.65, 0.65..1.0] {
        let there = pairs
            .iter()
            .filter(|(_, wanted)| range.contains(&wanted[1]));
        assert!(there.count() >= 3, "nothing was compared at {range:?}");
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
