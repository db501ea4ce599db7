//! The localisation experiment in the window, as a person does it.
#![cfg(all(feature = "demo", feature = "audio"))]

mod common;
mod sound_server;

use common::cli::{argument, command, echomarch, stderr, succeed};
use common::window::{Demo, Display, Image};
use serde_json::Value;
use sound_server::Server;
use std::path::Path;

/// What the seed 7 makes of three trials.
const ORDER: [u32; 3] = [3, 1, 2];

/// Three trials.
const TRIALS: [&str; 8] = [
    "--scenes",
    "corner",
    "--sounds",
    "speech",
    "--waves",
    "4096",
    "--iterations",
    "8",
];

fn open<'a>(display: &'a Display, server: &Server, answers: &Path) -> Demo<'a> {
    let mut command = server.command(env!("CARGO_BIN_EXE_echomarch"));
    command
        .args(["localise", "window", "-o", argument(answers), "--json"])
        .args(["--participant", "p7", "--screenshot", "last.png"])
        .args(["--order-seed", "7"])
        .args(TRIALS);
    display.open(command)
}

fn read(answers: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(answers).unwrap()).unwrap()
}

/// The trial at a place of the sitting's own order.
fn trial(session: &Value, place: usize) -> &Value {
    let number = session["order"][place].as_u64().unwrap() as usize;
    &session["trials"][number - 1]
}

/// Protects a sitting from its first to its last answer: what is missing locks nothing, what is locked is in the
/// file at once and stays, a sitting broken off goes on where it was, and what was heard was traced as the file says.
#[test]
fn a_person_answers_breaks_off_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let answers = folder.path().join("anna.json");
    let display = Display::new();
    let server = Server::start();

    let demo = open(&display, &server, &answers);
    demo.wait_until("sound", |frame| frame["sound"] == true);
    // Nothing is played yet, and nobody walks here.
    demo.key("a").key("3").key("Return").hold("s", 0.5);
    assert!(!answers.exists());
    let window = demo.window();
    demo.key("space");
    display.xdotool(&["mousemove", "--window", &window, "100", "150"]);
    demo.wait_frames();
    display.xdotool(&["click", "1"]);
    demo.wait_frames();
    demo.key("Return").wait_traced(2);
    let first = trial(&read(&answers), 0).clone();
    let (report, one, _) = demo.quit();
    let given = &first["answer"];
    assert_eq!(
        (&given["side"], &given["confidence"]),
        (&"left".into(), &3.into())
    );
    assert_eq!(given["plays"], 1);
    let of = |name: &str| given[name].as_f64().unwrap();
    let marked = of("right_m").atan2(of("ahead_m")).to_degrees();
    assert!((marked - of("azimuth_deg")).abs() < 1e-6, "{given}");
    let heard = report["pans"].as_array().unwrap();
    let of = |place: usize| trial(&read(&answers), place)["stimulus"]["pan"].clone();
    assert_eq!(
        (&heard[0]["pan"], &heard.last().unwrap()["pan"]),
        (&of(0), &of(1))
    );

    let demo = open(&display, &server, &answers);
    demo.wait_until("sound", |frame| frame["sound"] == true);
    for side in ["w", "d"] {
        demo.key("space")
            .key("Up")
            .key("Left")
            .key(side)
            .key("5")
            .key("Return");
    }
    // All are answered: one more changes nothing.
    demo.key("space").key("Up").key("a").key("1").key("Return");
    let (_, all, _) = demo.quit();
    let kept = read(&answers);
    assert_eq!(
        (trial(&kept, 0), &kept["participant"]),
        (&first, &"p7".into())
    );
    // The order is that of the seed, on every machine.
    assert_eq!(kept["order"], serde_json::json!(ORDER));
    let sides = [0, 1, 2].map(|place| trial(&kept, place)["answer"]["side"].clone());
    assert_eq!(sides, ["left", "centre", "right"]);
    // The plan has gone.
    assert!(one.difference(&all, 20..260) > 0.2);

    let scored = succeed(&["localise", "score", "--json", argument(&answers)]);
    let scored: Value = serde_json::from_slice(&scored.stdout).unwrap();
    assert_eq!(scored["sessions"][0]["answered"], 3);
}

/// Protects the question from its answer: no light and no mark gives the source away, wherever it is.
#[test]
fn the_picture_does_not_show_the_source() {
    let display = Display::new();
    let picture = |source: &str| {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("room.ron");
        let text = format!(
            "Scene(surfaces: [Surface(shape: Room(size: (20, 8, 20)))], \
             source: Source(position: {source}), listener: Listener(position: (0, 0, 8), radius: 1))"
        );
        std::fs::write(&scene, text).unwrap();
        let mut command = command();
        command
            .args([
                "localise",
                "window",
                "-o",
                argument(&folder.path().join("a.json")),
                "--json",
            ])
            .args([
                "--scenes",
                argument(&scene),
                "--sounds",
                "speech",
                "--waves",
                "256",
            ])
            .args([
                "--iterations",
                "1",
                "--order-seed",
                "7",
                "--screenshot",
                "last.png",
                "--scale",
                "0.4",
            ]);
        let demo = display.open(command);
        let (_, picture, _): (_, Image, _) = demo.quit();
        picture
    };
    // Both are straight ahead, so that the listener faces the same way.
    let (near, far) = (picture("(0, 0, 2)"), picture("(0, 0, -8)"));
    // Below stands how the sound fares.
    assert_eq!(near.difference_in(&far, 0..960, 0..480), 0.0);
}

/// Protects answers from a sitting with other trials, and other files from answers.
#[test]
fn a_file_of_something_else_is_refused_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let answers = folder.path().join("anna.json");
    std::fs::write(&answers, "{}").unwrap();
    let ask = |arguments: &[&str]| {
        let fixed = ["localise", "window", "-o", argument(&answers)];
        echomarch(&[&fixed, arguments].concat())
    };
    let output = ask(&TRIALS);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("holds no answers"),
        "{}",
        stderr(&output)
    );
    assert_eq!(std::fs::read_to_string(&answers).unwrap(), "{}");

    let display = Display::new();
    let server = Server::start();
    std::fs::remove_file(&answers).unwrap();
    let demo = open(&display, &server, &answers);
    demo.wait_until("sound", |frame| frame["sound"] == true);
    demo.key("space").key("Up").key("w").key("5").key("Return");
    demo.quit();
    let before = std::fs::read(&answers).unwrap();
    let mut others = TRIALS;
    others[7] = "4";
    let output = ask(&others);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("answers to the trials"),
        "{}",
        stderr(&output)
    );
    assert_eq!(std::fs::read(&answers).unwrap(), before);
}

/// Protects the result from answers to what nobody heard: without a sound device nothing plays, and nothing is locked.
#[test]
fn without_sound_nothing_is_answered() {
    let folder = tempfile::tempdir().unwrap();
    let answers = folder.path().join("deaf.json");
    let display = Display::new();
    let mut server = Server::start();
    server.kill();
    let demo = open(&display, &server, &answers);
    demo.key("space").key("Up").key("w").key("5").key("Return");
    let (report, _, _) = demo.quit();
    assert_eq!(report["sound"]["is_heard"], false);
    assert!(!answers.exists());
}
