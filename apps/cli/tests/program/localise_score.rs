//! The score of people's answers: figures that can be checked by hand, several files of one session, and files that are
//! refused.

use crate::answers::{answer_file, trial};
use crate::common::cli::{argument, json, refuse, stdout, succeed};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// An answer file in the format of the form. The first `given` of three trials are answered; the sources are at the
/// left, ahead and at the right.
fn answers(session: &str, given: usize) -> Value {
    let trials = [(-48.0, -40.0), (0.0, 170.0), (48.0, -20.0)];
    let of = |(index, (truth, clicked)): (usize, (f64, f64))| {
        let mut trial = trial(index + 1, truth, clicked);
        if index >= given {
            trial["answer"] = Value::Null;
        }
        trial
    };
    answer_file(session, &[2, 3, 1], trials.into_iter().enumerate().map(of))
}

fn write(folder: &Path, name: &str, text: &Value) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, text.to_string()).unwrap();
    path
}

/// Checks the score of answers whose figures can be computed by hand.
#[test]
fn answers_are_scored() {
    let folder = tempfile::tempdir().unwrap();
    let whole = write(folder.path(), "whole.json", &answers("a", 3));
    let report = json(&["localise", "score", argument(&whole)]);
    let all = &report["groups"][0];
    // After folding to the front, the clicks are at -40, 10 and -20 degrees: their errors are 8, 10 and 68 degrees.
    assert_eq!((&all["answers"], &all["scene"]), (&json!(3), &json!("")));
    let median = all["source"]["median_abs"]["deg"].as_f64().unwrap();
    assert!((median - 10.0).abs() < 1e-6, "{median}");
    assert_eq!(all["confusion"], json!([[1, 0, 0], [0, 0, 1], [1, 0, 0]]));
    let behind = all["clicked_behind"].as_f64().unwrap();
    assert!((behind - 1.0 / 3.0).abs() < 1e-9);
    // One person gives no confidence interval, for any number of answers.
    assert_eq!(all["people"], 1);
    assert_eq!(all["source"]["median_abs"]["interval_deg"], Value::Null);
    assert_eq!(report["groups"][1]["scene"], "corner");

    let text = succeed(&["localise", "score", argument(&whole)]);
    assert!(stdout(&text).contains("corner") && stdout(&text).contains("clicked behind"));
    assert!(stdout(&text).contains('—'), "no interval of one person");
    let out = folder.path().join("out");
    succeed(&["localise", "score", argument(&whole), "-o", argument(&out)]);
    let csv = fs::read_to_string(out.join("score.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 1 + 2, "all, and one kind");
    assert!(lines[1].starts_with(",,,,,,true,3,1,3,"), "{csv}");
    let told = lines[1].split(',').nth(10).unwrap();
    assert!((told.parse::<f64>().unwrap() - median).abs() < 1e-9);
    assert!(lines[2].starts_with("corner,speech,linear,hybrid,1024,8,true,3,1,"));
    let saved = fs::read_to_string(out.join("score.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&saved).unwrap(), report);
    let help = succeed(&["localise", "score", "--help"]);
    assert!(stdout(&help).contains("Examples:"));
}

/// Protects confidence intervals: they are based on people, not on answers. Five people give an interval, however few
/// answers each has. One person in five sessions gives no interval.
#[test]
fn intervals_are_those_of_people() {
    let folder = tempfile::tempdir().unwrap();
    let score = |code: fn(usize) -> String| {
        let of = |person: usize| {
            let mut file = answers(&format!("s{person}"), 1);
            let clicked = -48.0 + 4.0 * person as f64;
            file["trials"][0] = trial(1, -48.0, clicked);
            file["participant"] = json!(code(person));
            write(folder.path(), &format!("{person}.json"), &file)
        };
        let files: Vec<PathBuf> = (0..5).map(of).collect();
        let files: Vec<&str> = files.iter().map(|file| argument(file)).collect();
        json(&[&["localise", "score", "-q"], files.as_slice()].concat())["groups"][0].clone()
    };
    for code in [|person| format!("p{person}"), |_| String::new()] {
        let group = score(code);
        assert_eq!(
            (&group["answers"], &group["people"]),
            (&json!(5), &json!(5))
        );
        let median = &group["source"]["median_abs"];
        assert!((median["deg"].as_f64().unwrap() - 8.0).abs() < 1e-6);
        let end = |index: usize| median["interval_deg"][index].as_f64().unwrap();
        assert!(end(0) < 8.0 && end(1) > 8.0, "{median}");
    }
    let one = score(|_| "p".to_owned());
    assert_eq!(one["people"], 1);
    assert_eq!(one["source"]["bias"]["interval_deg"], Value::Null);
}

/// Protects figures from silent sounds and from pooling different kinds of trials: another panning law is a separate
/// group, and another form causes a note.
#[test]
fn silence_laws_and_forms_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = answers("a", 3);
    first["trials"][1]["stimulus"]["hits"] = json!(0);
    let mut other = answers("b", 3);
    other["experiment"] = json!("0ddba11");
    for trial in other["trials"].as_array_mut().unwrap() {
        trial["stimulus"]["law"] = json!("constant-power");
    }
    let files = [("a", first), ("b", other)]
        .map(|(name, text)| write(folder.path(), &format!("{name}.json"), &text));
    let report = json(&[
        "localise",
        "score",
        argument(&files[0]),
        argument(&files[1]),
    ]);
    let groups = report["groups"].as_array().unwrap().iter();
    let told: Vec<Value> = groups
        .map(|group| json!([group["law"], group["heard"], group["answers"]]))
        .collect();
    let wanted = [
        json!(["", true, 5]),
        json!(["constant-power", true, 3]),
        json!(["linear", true, 2]),
        json!(["", false, 1]),
    ];
    assert_eq!(told, wanted);
    let notes = report["notes"].to_string();
    assert!(notes.contains("2 different forms"), "{notes}");
}

/// An interrupted session counts with its existing answers, several files of one session count once, and an empty
/// session is reported.
#[test]
fn broken_off_sessions_are_scored_and_merged() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name, text| write(folder.path(), name, &text);
    let part = file("part.json", answers("a", 1));
    let whole = file("whole.json", answers("a", 3));
    let other = file("other.json", answers("b", 2));
    let none = file("none.json", answers("c", 0));
    let score = |files: &[&PathBuf]| {
        let files: Vec<&str> = files.iter().map(|file| argument(file)).collect();
        json(&[&["localise", "score"], files.as_slice()].concat())
    };
    let report = score(&[&part]);
    assert_eq!(report["groups"][0]["answers"], 1);
    assert!(
        report["notes"][0]
            .as_str()
            .unwrap()
            .contains("2 of 3 trials")
    );
    for files in [[&part, &whole, &other], [&other, &whole, &part]] {
        let report = score(&files);
        assert_eq!(report["groups"][0]["answers"], 5);
        assert_eq!(report["sessions"].as_array().unwrap().len(), 2);
        let notes = report["notes"].to_string();
        assert!(
            notes.contains("of one session, a, and count once"),
            "{notes}"
        );
    }
    assert_eq!(score(&[&none])["groups"], json!([]));
    let output = succeed(&["localise", "score", argument(&none)]);
    assert!(stdout(&output).contains("No trial is answered."));
}

/// A click without a direction.
fn at_the_listener() -> Value {
    let mut text = answers("a", 3);
    for axis in ["right_m", "ahead_m", "azimuth_deg"] {
        text["trials"][0]["answer"][axis] = json!(0.0);
    }
    text
}

/// A complete file with one value changed.
fn changed(path: &str, value: Value) -> Value {
    let mut text = answers("a", 3);
    *text.pointer_mut(path).unwrap() = value;
    text
}

/// Invalid answer files, each with a part of the error message.
fn wrong() -> Vec<(Value, &'static str)> {
    vec![
        (changed("/format", json!("shopping-list")), "shopping-list"),
        (changed("/version", json!(1)), "version 1"),
        (changed("/order", json!([1, 2, 2])), "order"),
        (changed("/order", json!([1, 2])), "order"),
        (changed("/session", json!("")), "session"),
        (changed("/trials", json!([])), "no trial"),
        (changed("/trials/1/number", json!(1)), "trial 1"),
        (changed("/trials/1/answer/azimuth_deg", json!(400.0)), "400"),
        (
            changed("/trials/0/answer/azimuth_deg", json!(40.0)),
            "click",
        ),
        (
            changed("/trials/2/answer/confidence", json!(9)),
            "confidence",
        ),
        (changed("/trials/2/answer/side", json!("above")), "above"),
        (changed("/trials/0/stimulus/pan", json!(-3.0)), "pan"),
        (
            changed("/trials/1/answer/seconds", json!(-0.5)),
            "seconds must be 0 or more",
        ),
        (changed("/trials/1/answer/plays", json!(0)), "plays"),
        (changed("/trials/0/stimulus/waves", json!(0)), "waves"),
        (
            changed("/trials/0/stimulus/iterations", json!(0)),
            "iterations",
        ),
        (at_the_listener(), "at the listener"),
        (json!([1, 2]), "no answers"),
    ]
}

/// Any error in a file is reported in a sentence that contains the file name. The exit code is 2.
#[test]
fn bad_answers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (text, told) in &wrong() {
        let file = write(folder.path(), "bad.json", text);
        refuse(&["localise", "score", argument(&file)], told);
        refuse(&["localise", "score", argument(&file)], "bad.json");
    }
    let absent = folder.path().join("absent.json");
    refuse(&["localise", "score", argument(&absent)], "absent.json");
    let cut = folder.path().join("cut.json");
    let text = answers("a", 3).to_string();
    fs::write(&cut, &text[..text.len() / 2]).unwrap();
    refuse(&["localise", "score", argument(&cut)], "cut.json");
    // Locked answers never change, so one of two files with different answers is wrong.
    let one = write(folder.path(), "one.json", &answers("a", 3));
    let other = changed("/trials/0/answer/confidence", json!(5));
    let other = write(folder.path(), "two.json", &other);
    let both = ["localise", "score", argument(&one), argument(&other)];
    refuse(&both, "differ in trial 1");
    let other = changed("/order", json!([2, 1, 3]));
    let other = write(folder.path(), "two.json", &other);
    refuse(
        &[&both[..3], &[argument(&other)]].concat(),
        "differ in trial",
    );
}
