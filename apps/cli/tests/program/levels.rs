//! `echomarch trace --levels`, and the scenes made for full listening.

use crate::common::cli::{json, refuse, stdout, succeed};
use serde_json::Value;

fn scene(name: &str) -> String {
    format!(
        "{}/../../examples/scenes/{name}.ron",
        env!("CARGO_MANIFEST_DIR")
    )
}

/// Returns the levels that `trace --levels` prints for each pair.
fn levels(arguments: &[&str]) -> Vec<Value> {
    let call: Vec<&str> = ["trace", "--levels", "--waves", "16384"]
        .into_iter()
        .chain(arguments.iter().copied())
        .collect();
    let report: Value = json(&call);
    report["levels"].as_array().unwrap().clone()
}

/// Protects levels: whether a source is heard, its level, delay and direction. A closed door silences the source behind
/// it. An open door makes the source audible, from the direction of the door.
#[test]
fn doors_open_and_close_what_is_heard() {
    let corridor = scene("corridor");
    let open = levels(&[&corridor]);
    let [between, beyond] = &open[..] else {
        panic!("{open:?}");
    };
    assert_eq!(
        (&between["source"], &between["listener"]),
        (&"talker".into(), &"between".into())
    );
    let g_db = |level: &Value| level["g_db"].as_f64().unwrap();
    assert!(g_db(between) > g_db(beyond) + 3.0);
    // The listeners look along −x, towards the talker.
    let azimuth = between["azimuth_deg"].as_f64().unwrap().abs();
    assert!(azimuth < 30.0, "{azimuth}");
    let one_sided = between["one_sided"].as_f64().unwrap();
    assert!((0.1..=1.0).contains(&one_sided), "{one_sided}");
    // The sound travels 10 m through air at 20 °C.
    let delay_ms = 1e3 * between["delay_s"].as_f64().unwrap();
    assert!((29.0..31.0).contains(&delay_ms), "{delay_ms}");
    let shut = levels(&[&corridor, "--set", "second-door=0"]);
    assert!(shut[0]["heard"] == true && shut[1]["heard"] == false);
    assert!(shut[1]["g_db"].is_null() && shut[1]["delay_s"].is_null());
    let both = levels(&[&corridor, "--set", "first-door=0"]);
    assert!(both.iter().all(|level| level["heard"] == false));
    let ajar = levels(&[&corridor, "--set", "first-door=0.3"]);
    assert!(g_db(&ajar[0]) < g_db(between));
}

/// Protects the text output. Without `--levels`, no levels are printed.
#[test]
fn levels_are_told_where_they_are_asked_for() {
    let output = succeed(&["trace", "corner", "--levels", "--waves", "4096"]);
    let text = stdout(&output);
    assert!(text.contains("source 1, listener 1: G "), "{text}");
    assert!(text.contains(" ms, mean direction "), "{text}");
    let without: Value = json(&["trace", "corner", "--waves", "4096"]);
    assert!(without.get("levels").is_none());
    refuse(
        &["trace", "corner", "--levels", "--profile", "thesis"],
        "thesis",
    );
}

/// Protects the hall scene: every pair is heard, the louder source is louder, and the seats under the balcony hear the
/// sound later than those at the front.
#[test]
fn a_hall_is_heard_in_every_seat() {
    let hall = levels(&[&scene("hall")]);
    assert_eq!(hall.len(), 6);
    let number = |index: usize, what: &str| hall[index][what].as_f64().unwrap();
    assert!(number(0, "g_db") > number(2, "g_db"));
    assert!(number(2, "delay_s") > number(0, "delay_s") + 0.05);
}

/// The strength *G* of the only source of an example scene at a time in seconds, with diffraction.
fn g_db_at(name: &str, seconds: &str) -> f64 {
    let scene = scene(name);
    let levels = levels(&[&scene, "--diffraction", "--time", seconds]);
    levels[0]["g_db"].as_f64().unwrap()
}

/// Protects the scenes for `render --diffraction`: behind the pillar the talker is quieter, and audible. Round the corner
/// the talker becomes louder. The shut door leaves a faint sound.
#[test]
fn scenes_to_hear_fall_and_rise() {
    let pillar = ["0", "2.5", "6"].map(|at| g_db_at("pillar", at));
    assert!(
        pillar[1] < pillar[0] - 5.0 && pillar[1] > pillar[0] - 12.0,
        "{pillar:?}"
    );
    assert!((pillar[2] - pillar[0]).abs() < 1.0, "{pillar:?}");
    let corner = ["0", "5", "10"].map(|at| g_db_at("street-corner", at));
    assert!(
        corner.is_sorted() && corner[2] > corner[0] + 20.0,
        "{corner:?}"
    );
    let door = ["0", "2.5", "5"].map(|at| g_db_at("closing-door", at));
    assert!(door[0] > door[1] && door[1] > door[2] + 6.0, "{door:?}");
    assert!(
        door[2] < door[0] - 15.0 && door[2] > door[0] - 30.0,
        "{door:?}"
    );
}
