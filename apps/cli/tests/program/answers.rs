//! Answer files in the format that the form saves.

use serde_json::{Value, json};

/// One trial of an answer file.
pub fn trial(number: usize, truth: f64, clicked: f64) -> Value {
    let side = match clicked {
        angle if angle < -15.0 => "left",
        angle if angle > 15.0 => "right",
        _ => "centre",
    };
    let (sin, cos) = f64::to_radians(clicked).sin_cos();
    json!({
        "number": number,
        "stimulus": {
            "scene": "corner", "yaw_deg": 0.0, "sound": "speech", "law": "linear",
            "profile": "hybrid", "waves": 1024, "iterations": 8, "seed": 1, "pan": -0.1,
            "hits": 60, "source_azimuth_deg": truth, "source_lateral_deg": truth,
            "observer_lateral_deg": -8.0,
        },
        "answer": {
            "right_m": 4.0 * sin, "ahead_m": 4.0 * cos, "azimuth_deg": clicked, "side": side,
            "confidence": 3, "plays": 2, "seconds": 6.5,
            "answered": "2026-11-20T20:00:00.000Z",
        },
    })
}

/// An answer file of one session, with the given order of trials.
pub fn answer_file(
    session: &str,
    order: &[usize],
    trials: impl IntoIterator<Item = Value>,
) -> Value {
    json!({
        "format": "echomarch-localise-answers", "version": 2, "experiment": "00c0ffee",
        "session": session, "participant": "p1", "started": "2026-11-20T19:50:00.000Z",
        "saved": "2026-11-20T20:00:00.000Z", "order": order,
        "trials": trials.into_iter().collect::<Vec<_>>(),
    })
}
