//! The form for people, filled in by a headless browser: sounds are played, answers given, and sessions interrupted,
//! resumed, saved, and scored.

use crate::common::cli::{argument, json, succeed};
use crate::webdriver::{Browser, Driver};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const TRIALS: usize = 3;

/// The order that order seed 7 gives to the three trials of this form. Order seed 8 gives 2, 1, 3.
const ORDER_OF_7: [u32; 3] = [1, 3, 2];

/// WebDriver's codes for these keys.
const TAB: char = '\u{E004}';
const ENTER: char = '\u{E007}';
const RIGHT: char = '\u{E014}';

/// A form of three trials.
fn form(folder: &Path) -> PathBuf {
    form_with(folder, &[])
}

/// A form of three trials, with additional options.
fn form_with(folder: &Path, more: &[&str]) -> PathBuf {
    let fixed = [
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
    ];
    succeed(&[&fixed, more].concat());
    folder.join("form.html")
}

/// A form in a new folder, and the driver that opens browsers.
fn form_and_driver() -> (TempDir, PathBuf, Driver) {
    let folder = tempfile::tempdir().unwrap();
    let page = form(&folder.path().join("form"));
    (folder, page, Driver::start())
}

/// Clicks at the given offset in pixels from the listener, whose position on the plan depends on its facing direction.
fn click_beside(browser: &Browser, right: i32, down: i32) {
    let from_the_middle = "const plan = document.getElementById('plan');\
         const at = plan.getScreenCTM(), box = plan.getBoundingClientRect();\
         return [at.e - box.left - box.width / 2, at.f - box.top - box.height / 2];";
    let listener = browser.run(from_the_middle);
    let pixels = |axis: usize| listener[axis].as_f64().unwrap().round() as i32;
    browser.click_at("#plan", pixels(0) + right, pixels(1) + down);
}

/// Answers the current trial with a click at the given offset in pixels from the listener.
fn answer(browser: &Browser, right: i32, down: i32, side: &str, confidence: u32) {
    browser.wait_for("#lock", "Lock the answer");
    let disabled = "return document.getElementById('lock').disabled";
    browser.click("#play");
    browser.wait_for("#plays", "played 1 time");
    click_beside(browser, right, down);
    browser.click(&format!("#sides input[value={side}]"));
    assert_eq!(browser.run(disabled), true, "a question is left");
    browser.click(&format!("#confidences input[value='{confidence}']"));
    assert_eq!(browser.run(disabled), false);
    browser.click("#lock");
}

/// Saves the answers and waits for the new file.
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
        let new = saved().into_iter().find(|path| !before.contains(path));
        if let Some(new) = new.filter(|path| is_complete(path)) {
            // Keeps a copy, because a browser deletes a download if it ends before it considers the download complete.
            let kept = new.with_extension("kept");
            fs::copy(&new, &kept).unwrap();
            return kept;
        }
        assert!(
            began.elapsed() < Duration::from_secs(300),
            "nothing was saved"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Whether the browser has written the whole file. The browser first creates an empty file with that name.
fn is_complete(path: &Path) -> bool {
    let text = fs::read_to_string(path).unwrap_or_default();
    serde_json::from_str::<serde_json::Value>(&text).is_ok()
}

fn score(files: &[&Path]) -> serde_json::Value {
    let files: Vec<&str> = files.iter().map(|file| argument(file)).collect();
    json(&[&["localise", "score", "-q"], files.as_slice()].concat())
}

/// Begins a session and answers its first trial.
fn answer_the_first(browser: &Browser) {
    browser.click("#begin");
    answer(browser, 90, 0, "right", 4);
    browser.wait_for("#number", "Sound 2 of 3");
}

/// Answers one trial, goes back to it, and saves.
fn begin(browser: &Browser, page: &Path, downloads: &Path) -> PathBuf {
    browser.go(page);
    assert_eq!(browser.text("#count"), TRIALS.to_string());
    browser.type_into("#participant", "p1");
    browser.click("#begin");
    browser.wait_for("#number", "Sound 1 of 3");
    answer(browser, 90, 0, "right", 4);
    browser.wait_for("#number", "Sound 2 of 3");
    // Going back shows the answer but does not allow changes.
    browser.click("#back");
    browser.wait_for("#missing", "locked");
    click_beside(browser, -90, 0);
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

/// Resumes the session that [`begin`] started, completes it, and saves.
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

/// Protects a session from the first sound to the score, with an interruption: no answer is lost or changed, and the
/// page makes no network request.
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
    assert!(found["notes"][0].as_str().unwrap().contains("interrupted"));

    // The session is resumed in the same browser.
    let whole = go_on(&driver.open(&home, &downloads), &page, &downloads);
    assert_ne!(first, whole);
    assert!(first.exists(), "saving keeps older files");
    let found = score(&[&first, &whole]);
    assert_eq!(found["sessions"].as_array().unwrap().len(), 1);
    assert_eq!(found["sessions"][0]["answered"], 3);
    assert_eq!(found["groups"][0]["answers"], 3);

    // The session is resumed in another browser, with the first file.
    let browser = driver.open(&at("elsewhere"), &downloads);
    browser.go(&page);
    browser.type_into("#load", argument(&first));
    browser.wait_for("#number", "Sound 2 of 3");
    browser.wait_for("#status", "p1, 1 of 3");
    let again = save(&browser, &downloads);
    assert_eq!(file_of(&first)["trials"], file_of(&again)["trials"]);
    assert_eq!(file_of(&first)["order"], file_of(&again)["order"]);
    let number = file_of(&first)["order"][0].as_u64().unwrap() as usize;
    let answer = &file_of(&first)["trials"][number - 1]["answer"];
    let clicked = answer["azimuth_deg"].as_f64().unwrap();
    assert!(clicked > 15.0 && clicked < 165.0, "{clicked}");
    assert!(answer["seconds"].as_f64().unwrap() > 0.0, "{answer}");
}

fn file_of(path: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// Whether the page asks for confirmation before it closes.
fn asks_before_closing(browser: &Browser) -> serde_json::Value {
    browser.run(
        "const event = new Event('beforeunload', { cancelable: true });\
         dispatchEvent(event); return event.defaultPrevented;",
    )
}

/// Protects the entries of a trial that is not locked yet: they survive going back and a reload.
#[test]
fn what_is_not_locked_yet_is_kept() {
    let (folder, page, driver) = form_and_driver();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    browser.go(&page);
    answer_the_first(&browser);
    browser.click("#play");
    browser.wait_for("#plays", "played 1 time");
    click_beside(&browser, -90, 0);
    browser.click("#sides input[value=left]");
    let mark = browser.text("#clicked");
    assert!(mark.contains("to the left"), "{mark}");
    let is_kept = || {
        browser.wait_for("#number", "Sound 2 of 3");
        assert_eq!(browser.text("#clicked"), mark);
        assert_eq!(browser.text("#plays"), "played 1 time");
        let side = "return document.querySelector('#sides input:checked').value";
        assert_eq!(browser.run(side), "left");
        assert!(browser.text("#missing").contains("how sure"));
    };
    browser.click("#back");
    browser.wait_for("#clicked", "to the right");
    browser.click("#forward");
    is_kept();
    browser.go(&page);
    browser.click("#sessions .continue");
    is_kept();
    browser.click("#confidences input[value='2']");
    browser.click("#lock");
    browser.wait_for("#number", "Sound 3 of 3");
    assert_eq!(browser.text("#plays"), "", "plays are reset");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Protects users without a mouse: every trial can be answered with the keyboard alone. The page asks for confirmation
/// before a complete session would be lost.
#[test]
fn the_keyboard_is_enough() {
    let (folder, page, driver) = form_and_driver();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    browser.go(&page);
    browser.click("#begin");
    for number in 1..=TRIALS {
        browser.wait_for("#number", &format!("Sound {number} of 3"));
        let focus = "return document.activeElement.id";
        assert_eq!(browser.run(focus), "play");
        browser.press(" ");
        browser.wait_for("#plays", "played 1 time");
        // Tab moves to the first choice of each group, then to the plan.
        browser.press(&format!("{TAB} {TAB} {TAB}"));
        assert_eq!(browser.run(focus), "plan");
        browser.press(&RIGHT.to_string());
        browser.wait_for("#clicked", "90° to the right");
        browser.press(&'\u{E012}'.to_string());
        let missing = browser.text("#missing");
        assert!(missing.contains("beside yourself"), "{missing}");
        browser.press(&RIGHT.to_string());
        // Tab moves past the controls for going back.
        for _ in 0..3 {
            if browser.run(focus) != "lock" {
                browser.press(&TAB.to_string());
            }
        }
        assert_eq!(browser.run(focus), "lock");
        assert_eq!(asks_before_closing(&browser), false);
        browser.press(&ENTER.to_string());
    }
    browser.wait_for("#end", "Thank you");
    assert_eq!(asks_before_closing(&browser), true);
    assert_eq!(browser.run("return document.activeElement.id"), "save");
    let file = save(&browser, folder.path());
    assert_eq!(asks_before_closing(&browser), false);
    let answers = &file_of(&file)["trials"];
    for trial in answers.as_array().unwrap() {
        let answer = &trial["answer"];
        assert_eq!(
            (&answer["right_m"], &answer["ahead_m"]),
            (&0.5.into(), &0.into())
        );
        assert_eq!(
            (&answer["side"], &answer["confidence"]),
            (&"left".into(), &1.into())
        );
    }
}

/// Protects answers that exist only on the page: if the browser cannot store them, the page shows a warning and asks
/// for confirmation before it closes, until they are saved.
#[test]
fn a_browser_that_keeps_nothing_is_told_of() {
    let (folder, page, driver) = form_and_driver();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    browser.go(&page);
    browser.run("Storage.prototype.setItem = () => { throw new Error('full'); };");
    browser.click("#begin");
    browser.wait_for("#warning", "cannot store answers");
    assert_eq!(asks_before_closing(&browser), false, "no trial is answered");
    answer(&browser, 90, 0, "right", 4);
    browser.wait_for("#number", "Sound 2 of 3");
    assert_eq!(asks_before_closing(&browser), true);
    let file = save(&browser, folder.path());
    assert_eq!(asks_before_closing(&browser), false);
    assert_eq!(score(&[&file])["sessions"][0]["answered"], 1);
}

/// Protects studies from having the same order for all people: every session has its own order and saves it.
#[test]
fn each_person_has_an_order_of_their_own() {
    let (folder, page, driver) = form_and_driver();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    let mut orders = Vec::new();
    for _ in 0..12 {
        let file = begin_and_save(&browser, &page, folder.path());
        let order = file["order"].as_array().unwrap().clone();
        let mut sorted: Vec<u64> = order.iter().map(|n| n.as_u64().unwrap()).collect();
        sorted.sort_unstable();
        assert_eq!(sorted, [1, 2, 3]);
        assert!(file["order_seed"].is_u64(), "{}", file["order_seed"]);
        orders.push(order);
    }
    // Twelve sessions draw from six orders. The probability that all draw the same order is 1 in 300 million.
    assert!(orders.iter().any(|order| *order != orders[0]));
}

/// A session that was started and saved without an answer.
fn begin_and_save(browser: &Browser, page: &Path, downloads: &Path) -> serde_json::Value {
    browser.go(page);
    browser.click("#begin");
    browser.wait_for("#number", "Sound 1 of 3");
    file_of(&save(browser, downloads))
}

/// Protects an order that must be reproduced: a seed gives the same order in every session and on every machine, and is
/// stored in the form's file and in the answers. A file whose order does not match its seed is refused. A file without
/// a seed, as older forms saved it, is resumed.
#[test]
fn an_order_seed_gives_one_order_to_all_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let made = folder.path().join("form");
    let page = form_with(&made, &["--order-seed", "7"]);
    assert_eq!(file_of(&made.join("experiment.json"))["order_seed"], 7);
    let driver = Driver::start();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    let [first, second] = [(); 2].map(|()| begin_and_save(&browser, &page, folder.path()));
    assert_ne!(first["session"], second["session"]);
    for session in [&first, &second] {
        assert_eq!(session["order_seed"], 7);
        assert_eq!(session["order"], serde_json::json!(ORDER_OF_7));
    }
    let load = |file: &serde_json::Value| {
        browser.go(&page);
        let path = folder.path().join("changed.json");
        fs::write(&path, file.to_string()).unwrap();
        browser.type_into("#load", argument(&path));
    };
    let mut other = first.clone();
    other["order_seed"] = 8.into();
    load(&other);
    browser.wait_for("#warning", "order");
    let mut old = first.clone();
    old.as_object_mut().unwrap().remove("order_seed");
    load(&old);
    browser.wait_for("#number", "Sound 1 of 3");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// Protects large forms: their separate sound files are 16-bit WAV files, which every browser can play, and the page
/// plays them.
#[test]
fn a_large_form_plays_the_sounds_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    // Nine trials of one minute are 99 MiB of sound.
    let at = folder.path().join("form");
    succeed(&[
        "localise",
        "form",
        "-o",
        argument(&at),
        "--scenes",
        "corner",
        "--sounds",
        "sine:500",
        "--waves",
        "64,256,1024",
        "--iterations",
        "2",
        "--seconds",
        "60",
    ]);
    let page = at.join("form.html");
    assert!(fs::metadata(&page).unwrap().len() < 8 << 20);
    let reader = hound::WavReader::open(at.join("sounds/001.wav")).unwrap();
    let spec = reader.spec();
    assert_eq!((spec.channels, spec.bits_per_sample), (2, 16));
    assert_eq!(spec.sample_format, hound::SampleFormat::Int);
    assert_eq!(reader.duration(), 60 * 48_000);
    let driver = Driver::start();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    browser.go(&page);
    browser.click("#begin");
    browser.click("#play");
    browser.wait_for("#plays", "played 1 time");
}

/// Invalid files are refused with a message, and no session begins.
#[test]
fn a_file_of_another_kind_is_not_taken_up() {
    let (folder, page, driver) = form_and_driver();
    let browser = driver.open(&folder.path().join("home"), folder.path());
    browser.go(&page);
    // A complete file, and variants of it with one error each.
    answer_the_first(&browser);
    let whole = file_of(&save(&browser, folder.path()));
    let number = whole["order"][0].as_u64().unwrap() - 1;
    let changed = |path: &str, value: serde_json::Value| {
        let mut text = whole.clone();
        *text.pointer_mut(path).unwrap() = value;
        text.to_string()
    };
    let of_answer = |field: &str| format!("/trials/{number}/answer/{field}");
    browser.go(&page);
    for (text, told) in [
        ("{".to_owned(), "JSON"),
        ("{}".to_owned(), "no answers of this kind"),
        ("null".to_owned(), "no answers of this kind"),
        (changed("/order", serde_json::json!([1, 1, 2])), "order"),
        (changed("/session", 7.into()), "session"),
        (changed("/trials", serde_json::json!([])), "trials"),
        (changed(&of_answer("seconds"), (-1).into()), "damaged"),
        (changed(&of_answer("side"), "above".into()), "damaged"),
        (changed(&of_answer("right_m"), (-3).into()), "damaged"),
    ] {
        let file = folder.path().join("wrong.json");
        fs::write(&file, text).unwrap();
        browser.type_into("#load", argument(&file));
        browser.wait_for("#warning", told);
        assert_eq!(browser.text("#status"), "");
    }
}
