//! Sound that passes through a wall on the straight way, in responses.

use crate::common::tracer;
use echomarch::bands::BANDS_HZ;
use echomarch::response::{HeardPath, PathKind, Response, ResponseSettings};
use echomarch::{Scene, Settings};
use std::f64::consts::PI;

/// A room of 10 × 3 × 5 m, divided by a wall of 0.2 m that turns by 30° about the vertical, which blocks all direct and
/// mirrored paths from one part to the other.
fn divided(wall: &str, materials: &str) -> Scene {
    let text = format!(
        "Scene(surfaces: [
            Surface(shape: Room(size: (10, 3, 5))),
            Surface(name: \"wall\", shape: Box(size: (0.2, 9, 19)), rotation: (0, 30, 0), {wall}),
        ],
        materials: {{{materials}}},
        air: Air(temperature: 20),
        source: Source(position: (-3, 0.5, 1), level_db: 6),
        listener: Listener(position: (3, -0.5, 0.4), radius: 0.2))"
    );
    Scene::from_ron(&text, "divided").expect("a scene")
}

fn paths(scene: &Scene, settings: &ResponseSettings) -> Vec<HeardPath> {
    let settings = settings
        .clone()
        .with_seconds(0.06)
        .with_trace(Settings::default().with_waves(16));
    let response = Response::trace(&mut tracer(), scene, &settings).expect("a response");
    assert!(response.direct().is_none(), "the wall hides the source");
    response.paths
}

/// Protects transmitted sound in responses: delay, direction, and level by the mass law, with the spreading, the loss in
/// the air and the level of the source. The thickness is that of the wall, though sound passes it at an angle.
#[test]
fn sound_passes_through_a_wall() {
    let scene = divided(
        "material: \"masonry\"",
        "\"masonry\": Material(absorption: 0.1, density: 1150)",
    );
    let paths = paths(&scene, &ResponseSettings::default());
    let [path] = &paths[..] else {
        panic!("one path, not {paths:?}");
    };
    assert_eq!(path.kind, PathKind::Transmitted);
    assert_eq!(path.path.surfaces, [2]);
    let (source, listener) = (scene.sources[0].position, scene.listeners[0].position);
    let way = listener.as_dvec3() - source.as_dvec3();
    let length = way.length();
    let air = scene.air.expect("there is air");
    assert!((path.delay_s - length / air.speed_of_sound()).abs() < 1e-9);
    assert!((path.path.arrival_direction - way / length).length() < 1e-9);
    for (band, hertz) in BANDS_HZ.into_iter().enumerate() {
        let reduced = 1.0 + (PI * hertz * 230.0 / (1.8 * 415.0)).powi(2);
        let free = 10_f64.powf(0.6) / (4.0 * PI * length * length);
        let expected = free * (-air.attenuation()[band] * length).exp() / reduced;
        let error_db = 10.0 * (path.energy[band] / expected).log10();
        assert!(error_db.abs() < 0.1, "{hertz} Hz: {error_db} dB");
    }
}

/// Protects silence: nothing passes a wall whose material states neither a reduction nor a density, or a response
/// without transmission.
#[test]
fn nothing_passes_a_wall_unasked() {
    let brick = divided("material: \"brick\"", "");
    assert_eq!(paths(&brick, &ResponseSettings::default()), []);
    let glass = divided("material: \"glass\"", "");
    let without = ResponseSettings::default().with_transmission(false);
    assert_eq!(paths(&glass, &without), []);
    let with = paths(&glass, &ResponseSettings::default());
    assert_eq!(with.len(), 1);
    let read = serde_json::from_str::<ResponseSettings>("{\"transmission\": false}");
    assert_eq!(read.expect("settings"), without);
}
