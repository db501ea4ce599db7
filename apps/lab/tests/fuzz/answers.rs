//! Answer files in the formats of the form and of the window.

use super::Target;
use super::scratch::with_file;
use echomarch_lab::experiment::localise::score::score;

const TOKENS: &[&str] = &[
    "left", "centre", "right", "null", "true", "corner", "hybrid", "thesis", "linear", "number",
    "trials", "order", "answer", "stimulus", "session", "\\u0000", "\\ud800",
];

const STIMULUS: &str = r#"{"scene": "corner", "yaw_deg": 0.0, "sound": "sine:500",
    "law": "linear", "profile": "hybrid", "waves": 64, "iterations": 2, "seed": 1, "pan": 0.2,
    "hits": 5, "source_azimuth_deg": -48.4, "source_lateral_deg": -48.4,
    "observer_lateral_deg": 0.0}"#;

const ANSWER: &str = r#"{"right_m": 1.0, "ahead_m": 1.0, "azimuth_deg": 45.0, "side": "right",
    "confidence": 3, "plays": 1, "seconds": 2.5, "answered": "2026-01-01T00:00:01.000Z"}"#;

/// The fuzz target of corrupted answer files from the form and the window.
pub fn target() -> Target {
    let whole = format!(
        r#"{{"format": "echomarch-localise-answers", "version": 2, "experiment": "2600acb3",
        "session": "aa", "participant": "p1", "started": "2026-01-01T00:00:00.000Z",
        "saved": "2026-01-01T00:00:00.000Z", "order": [2, 1], "trials": [
        {{"number": 1, "stimulus": {STIMULUS}, "answer": {ANSWER}}},
        {{"number": 2, "stimulus": {STIMULUS}, "answer": null}}]}}"#
    );
    Target {
        name: "answers",
        corpus: vec![whole.into_bytes()],
        tokens: TOKENS,
        one,
    }
}

/// Reads and scores one answer file.
pub fn one(data: &[u8]) {
    with_file("answers.json", data, |path| {
        if let Err(error) = score(&[path.to_owned()]) {
            drop(error.to_string());
        }
    });
}
