//! Tests of settings and results as JSON: a written value is read back bit for bit, or refused.

use crate::common::tracer;
use echomarch::response::{
    AmbisonicOrder, Echogram, Format, ImpulseSettings, Response, ResponseSettings,
};
use echomarch::{Frame, Scene, Settings};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;

/// Writes a value as JSON, and requires that it is read back unchanged.
fn read_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    let text = serde_json::to_string(value).unwrap();
    let read: T = serde_json::from_str(&text).unwrap();
    assert!(read == *value, "{value:?}\nis read as\n{read:?}");
}

fn refusal<T: DeserializeOwned + Debug>(text: &str) -> String {
    serde_json::from_str::<T>(text).expect_err(text).to_string()
}

/// Protects stored results: the whole response, its figures, its level and a frame are read back unchanged, and so is
/// the infinite distance that is stored if all waves were followed.
#[test]
fn results_round_trip() {
    let mut tracer = tracer();
    let mut scene = Scene::builtin("shoebox").unwrap();
    scene.surfaces[0].material = Some("brick".to_owned());
    let settings = ResponseSettings::default()
        .with_trace(Settings::default().with_waves(4096))
        .with_seconds(0.3);
    let response = Response::trace(&mut tracer, &scene, &settings).unwrap();
    assert!(response.paths.len() > 7 && response.counts.followed_m == f64::INFINITY);
    read_back(&response);
    read_back(&response.figures);
    read_back(&response.level(&scene.listeners[0]).unwrap());
    let frame: Frame = tracer.frame(&scene, &settings.trace).unwrap();
    assert!(frame.counts.listener_hits > 0);
    read_back(&frame);
}

/// Protects results from numbers that JSON cannot hold: such numbers are refused and not lost.
#[test]
fn numbers_that_are_not_finite_are_refused() {
    let mut figures = Response::trace(
        &mut tracer(),
        &Scene::builtin("shoebox").unwrap(),
        &ResponseSettings::default()
            .with_trace(Settings::default().with_waves(64))
            .with_seconds(0.1),
    )
    .unwrap()
    .figures;
    figures.bands[3].t20_s = Some(f64::INFINITY);
    let error = serde_json::to_string(&figures).unwrap_err().to_string();
    assert!(error.contains("not a finite number"), "{error}");
    let mut frame = serde_json::to_value(Frame::default()).unwrap();
    frame["panning"]["left"] = serde_json::Value::Null;
    assert!(serde_json::from_value::<Frame>(frame).is_err());
}

/// Protects files of settings: they are read back as they were written, and mistakes in them are refused as in code.
#[test]
fn settings_of_responses_round_trip_or_are_refused() {
    let settings = ResponseSettings::default();
    read_back(&settings);
    read_back(&settings.with_seconds(1.0 / 3.0).with_order(3));
    let mut settings = ImpulseSettings::new(0.7);
    settings.format = Format::AmbiX(AmbisonicOrder::MOST);
    read_back(&settings);
    assert_eq!(
        serde_json::from_str::<ImpulseSettings>(r#"{"seconds": 2}"#).unwrap(),
        ImpulseSettings::new(2.0)
    );
    for (text, part) in [
        (r#"{"secondss": 1}"#, "secondss"),
        (r#"{"order": 99}"#, "order of exact paths must be 0 to 16"),
        (r#"{"bin_s": null}"#, "null"),
        (r#"{"trace": {"waves": 0}}"#, "waves must be"),
        (r#"{"trace": {"profile": "thesis"}}"#, "thesis"),
    ] {
        let error = refusal::<ResponseSettings>(text);
        assert!(error.contains(part), "{text}: {error}");
    }
    for (text, part) in [
        (r#"{"rate_hz": 48000}"#, "seconds"),
        (r#"{"seconds": 1e9}"#, "no longer than 60 s"),
        (r#"{"seconds": 1, "rate_hz": 1}"#, "1 Hz"),
        (r#"{"seconds": 1, "rate": 48000}"#, "`rate`"),
        (r#"{"seconds": 1, "format": "binaural"}"#, "binaural"),
        (r#"{"seconds": 1, "format": {"ambix": 8}}"#, "1 to 7, not 8"),
    ] {
        let error = refusal::<ImpulseSettings>(text);
        assert!(error.contains(part), "{text}: {error}");
    }
}

/// Protects the echogram from inconsistent files: the numbers of bins, batches and energies must agree.
#[test]
fn echograms_that_do_not_fit_together_are_refused() {
    let mut echogram = Echogram::new(0.001, 2).unwrap();
    echogram.add(1, 0.0042, &[0.1; 8], glam::DVec3::X).unwrap();
    read_back(&echogram);
    let whole = serde_json::to_value(&echogram).unwrap();
    for (field, value) in [
        ("batches", 4.into()),
        ("bin_s", (-1).into()),
        ("first_s", 7.into()),
        ("squares", serde_json::json!([])),
        ("more", 0.into()),
    ] {
        let mut spoilt = whole.clone();
        spoilt[field] = value;
        let read = serde_json::from_value::<Echogram>(spoilt);
        assert!(read.is_err(), "{field}: {read:?}");
    }
}
