//! The least level of a source in responses.

use crate::common::tracer;
use echomarch::auralisation::HeardSource;
use echomarch::bands::{BAND_COUNT, Bands};
use echomarch::response::{PathKind, Response, ResponseSettings};
use echomarch::{Scene, Settings};

/// The open field, with or without a high wall between source and listener, 7.6 m apart.
fn field(wall: &str) -> Scene {
    let text = format!(
        "Scene(surfaces: [
            Surface(shape: HalfSpace(normal: (0, 1, 0), offset: -50)),
            {wall}
        ],
        air: Air(temperature: 20),
        source: Source(position: (-4, 0.5, 1), level_db: 6, yaw: 50, directivity: Cardioid),
        listener: Listener(position: (3.5, -0.5, 0.4), radius: 0.2))"
    );
    Scene::from_ron(&text, "field").expect("a scene")
}

const WALL: &str = "Surface(shape: Box(size: (0.2, 6, 8)))";

fn response(scene: &Scene, settings: &ResponseSettings) -> Response {
    let trace = Settings::default().with_waves(64);
    let settings = settings.clone().with_seconds(0.06).with_trace(trace);
    Response::trace(&mut tracer(), scene, &settings).expect("a response")
}

/// The level of each band relative to the direct sound, in decibels.
fn relative_db(energy: &Bands, direct: &Bands) -> Bands {
    std::array::from_fn(|band| 10.0 * (energy[band] / direct[band]).log10())
}

/// Protects a silent source: it gets the least level in each band. The level is relative to the direct sound in the open,
/// which includes the source's level, its directivity and the loss in the air. The figures do not contain the added
/// energy.
#[test]
fn a_silent_source_gets_the_least_level() {
    let direct = response(&field(""), &ResponseSettings::default()).energy();
    let hidden = field(WALL);
    let silent = response(&hidden, &ResponseSettings::default());
    assert_eq!(HeardSource::of(&silent).level_db, None);
    let raised = response(
        &hidden,
        &ResponseSettings::default().with_least_level(-30.0),
    );
    let [added] = &raised.paths[..] else {
        panic!("one path, not {:?}", raised.paths);
    };
    assert_eq!(added.kind, PathKind::Added);
    for level_db in relative_db(&added.energy, &direct) {
        assert!((level_db + 30.0).abs() < 1e-3, "{level_db} dB");
    }
    let (source, listener) = (hidden.sources[0].position, hidden.listeners[0].position);
    let towards = (listener.as_dvec3() - source.as_dvec3()).normalize();
    assert!((added.path.arrival_direction - towards).length() < 1e-9);
    assert_eq!(raised.figures, silent.figures);
    let heard = HeardSource::of(&raised);
    assert_eq!(
        heard.to_string(),
        format!("1 added {}", text_db(heard.level_db))
    );
}

/// A level as in the text form of a summary.
fn text_db(level_db: Option<f64>) -> String {
    format!("{:.1} dB", level_db.expect("a level")).replace('-', "−")
}

/// Protects bands that are loud enough: behind a wall, diffracted sound of low frequencies stays as it is, and high
/// frequencies are raised to the least level, along the strongest path around the wall.
#[test]
fn only_what_is_missing_is_added() {
    const LEAST_DB: f64 = -20.0;
    let direct = response(&field(""), &ResponseSettings::default()).energy();
    let bent = ResponseSettings::default().with_diffraction(true);
    let plain = response(&field(WALL), &bent);
    let raised = response(&field(WALL), &bent.with_least_level(LEAST_DB));
    let is_added = |kind: PathKind| kind == PathKind::Added;
    let (added, others): (Vec<_>, Vec<_>) = raised
        .paths
        .iter()
        .cloned()
        .partition(|path| is_added(path.kind));
    assert_eq!(others, plain.paths);
    assert!(added.len() == 1 && plain.paths.iter().any(|path| path.path == added[0].path));
    let before = relative_db(&plain.energy(), &direct);
    let after = relative_db(&raised.energy(), &direct);
    let (quiet, loud): (Vec<_>, Vec<_>) =
        (0..BAND_COUNT).partition(|&band| before[band] < LEAST_DB);
    assert!(!quiet.is_empty() && !loud.is_empty(), "{before:?}");
    assert!(
        quiet
            .iter()
            .all(|&band| (after[band] - LEAST_DB).abs() < 1e-6)
    );
    assert!(loud.iter().all(|&band| after[band] == before[band]));
    assert!(raised.paths.is_sorted_by(|a, b| a.delay_s <= b.delay_s));
    assert_eq!(raised.figures, plain.figures);
}

/// Protects sources in sight: their direct sound is louder than any least level, so their response stays the same.
#[test]
fn nothing_is_added_to_direct_sound() {
    let settings = ResponseSettings::default();
    let plain = response(&field(""), &settings);
    let raised = response(&field(""), &settings.with_least_level(-1.0));
    assert_eq!(plain.paths, raised.paths);
}
