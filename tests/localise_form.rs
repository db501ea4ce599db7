//! The form for people, filled in by a headless browser: played, answered, broken off, taken
//! up, saved, and scored.
#![cfg(feature = "cli")]

#[path = "common/browser.rs"]
mod browser;
mod common;

use browser::{Browser, Driver};
use common::cli::{argument, json, succeed};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const TRIALS: usize = 3;

/// A form of three trials.
fn form(folder: &Path) -> PathBuf {
    succeed(&[
        "localise",
        "form",
        "-o",
        argument(folder),
        "--seed",
        "7",
        "--scenes",
        "corner",
        "--sounds",
        "sine:500",
        "--waves",
        "1024",
        "--iterations",
        "4",
        "--seconds",
        "0.3",
    ]);
    folder.join("form.html")
}

/// Answers the trial that is shown: a click so many pixels beside the plan's middle.
fn answer(browser: &Browser, right: i32, down: i32, side: &str, confidence: u32) {
    browser.wait_for("#lock", "Lock the answer");
    let disabled = "return document.getElementById('lock').disabled";
    browser.click("#play");
    browser.wait_for("#plays", "played 1 time");
    browser.click_at("#plan", right, down);
    browser.click(&format!("#sides input[value={side}]"));
    assert_eq!(browser.run(disabled), true, "one question is still open");
    browser.click(&format!("#confidences input[value='{confidence}']"));
    assert_eq!(browser.run(disabled), false);
    browser.click("#lock");
}

/// Saves, and waits for the file: the one that was not there before.
fn save(browser: &Browser, downloads: &Path) -> PathBuf {
    let saved = || -> Vec<PathBuf> {
        let entries = fs::read_dir(downloads).unwrap().map(|e| e.unwrap().path());
        entries
            .filter(|path| path.extension().is_some_and(|e| e == "json"))
            .collect()
    };
    let before = saved();
    browser.click("#save");
    let began = Instant::now();
    loop {
        if let Some(new) = saved().into_iter().find(|path| !before.contains(path)) {
            return new;
        }
        assert!(
            began.elapsed() < Duration::from_secs(30),
            "nothing was saved"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn score(files: &[&Path]) -> serde_json::Value {
    let files: Vec<&str> = files.iter().map(|file| argument(file)).collect();
    json(&[&["localise", "score", "-q"], files.as_slice()].concat())
}

/// Answers one trial, looks back at it, and saves.
fn begin(browser: &Browser, page: &Path, downloads: &Path) -> PathBuf {
    browser.go(page);
    assert_eq!(browser.text("#count"), TRIALS.to_string());
    browser.type_into("#participant", "p1");
    browser.click("#begin");
    browser.wait_for("#number", "Sound 1 of 3");
    answer(browser, 90, 0, "right", 4);
    browser.wait_for("#number", "Sound 2 of 3");
    // Looking back shows the answer and lets nothing be changed.
    browser.click("#back");
    browser.wait_for("#missing", "locked");
    browser.click_at("#plan", -90, 0);
    browser.wait_for("#clicked", "to the right");
    let open = "return document.querySelectorAll('#trial input:not(:disabled)').length";
    assert_eq!(browser.run(open), 0);
    let file = save(browser, downloads);
    let fetched = "return performance.getEntriesByType('resource').map(e => e.name)\
                   .filter(name => !/^(data|blob):/.test(name))";
    assert_eq!(browser.run(fetched), serde_json::json!([]));
    assert_eq!(browser.errors(), Vec::<String>::new());
    file
}

/// Goes on where [`begin`] broke off, to the end, and saves.
fn go_on(browser: &Browser, page: &Path, downloads: &Path) -> PathBuf {
    browser.go(page);
    assert!(browser.text("#sessions").contains("p1, begun"));
    browser.click("#sessions .continue");
    browser.wait_for("#number", "Sound 2 of 3");
    answer(browser, 0, -40, "centre", 1);
    browser.wait_for("#number", "Sound 3 of 3");
    answer(browser, -90, 10, "left", 5);
    browser.wait_for("#end", "Thank you");
    save(browser, downloads)
}

/// From the first sound to the score, with a break: nothing answered is lost or changed, and
/// nothing is asked of a network.
#[test]
fn a_session_is_answered_broken_off_taken_up_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let page = form(&at("form"));
    let (home, downloads) = (at("home"), at("downloads"));
    fs::create_dir(&downloads).unwrap();
    let driver = Driver::start();

    let first = begin(&driver.open(&home, &downloads), &page, &downloads);
    let found = score(&[&first]);
    assert_eq!(found["sessions"][0]["answered"], 1);
    assert_eq!(found["sessions"][0]["trials"], 3);
    assert_eq!(found["sessions"][0]["participant"], "p1");
    assert!(found["notes"][0].as_str().unwrap().contains("broken off"));

    // The same browser, later.
    let whole = go_on(&driver.open(&home, &downloads), &page, &downloads);
    assert_ne!(first, whole);
    assert!(first.exists(), "saving replaces nothing");
    let found = score(&[&first, &whole]);
    assert_eq!(found["sessions"].as_array().unwrap().len(), 1);
    assert_eq!(found["sessions"][0]["answered"], 3);
    assert_eq!(found["groups"][0]["answers"], 3);

    // Another browser, with the first file.
    let browser = driver.open(&at("elsewhere"), &downloads);
    browser.go(&page);
    browser.type_into("#load", argument(&first));
    browser.wait_for("#number", "Sound 2 of 3");
    browser.wait_for("#status", "p1, 1 of 3");
    let again = save(&browser, &downloads);
    let answers = |file: &Path| {
        let text = fs::read_to_string(file).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["trials"].clone()
    };
    assert_eq!(answers(&first), answers(&again));
    let clicked = answers(&first)[0]["answer"]["azimuth_deg"]
        .as_f64()
        .unwrap();
    assert!(clicked > 15.0 && clicked < 165.0, "{clicked}");
}

/// Files that are none are refused with a word, and nothing begins.
#[test]
fn a_file_of_another_kind_is_not_taken_up() {
    let folder = tempfile::tempdir().unwrap();
    let page = form(&folder.path().join("form"));
    let driver = Driver::start();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    browser.go(&page);
    for (text, told) in [("{", "JSON"), ("{}", "no answers of this kind")] {
        let file = folder.path().join("wrong.json");
        fs::write(&file, text).unwrap();
        browser.type_into("#load", argument(&file));
        browser.wait_for("#warning", told);
        assert_eq!(browser.text("#status"), "");
    }
}
