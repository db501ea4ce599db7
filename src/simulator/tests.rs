//! Tests of a simulator with its threads.

use super::*;
use crate::Listener;
use crate::scene::shape::{Cuboid, Room};
use glam::Vec3;
use std::time::{Duration, Instant};

/// Maximum time to wait for the workers, many times what they take on a busy machine.
const LONGEST: Duration = Duration::from_secs(120);

/// Waits until the condition holds.
pub(super) fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_so() {
        assert!(began.elapsed() < LONGEST, "{what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn shoebox(absorption: f64) -> Scene {
    Scene::shoebox(
        [8.0, 3.0, 5.0],
        &[[absorption; 8]; 6],
        Source::at([-2.0, 0.0, -1.5]),
        Listener::at([2.0, -0.3, 1.5], 0.3),
    )
}

fn simulator() -> Simulator {
    let settings = SimulatorSettings::default().with_waves(1024);
    Simulator::new(settings).expect("a renderer")
}

/// The update of a source after `traces` traces of the last commit.
fn heard(simulator: &Simulator, id: SourceId, commit: u64, traces: u64) -> Arc<Update> {
    let mut found = None;
    wait_until("an update", || {
        found = simulator.updates(id);
        (found.as_ref()).is_some_and(|found| found.commit >= commit && found.traces >= traces)
    });
    found.expect("an update")
}

/// Protects the direct way in the open: 1/r, the delay and the direction, in a world without surfaces. A second source
/// and the listener's roll change nothing.
#[test]
fn an_empty_world_has_direct_sound_only() {
    let mut simulator = simulator();
    let near = simulator.add_source(Source::at([0.0, 0.0, -2.0])).unwrap();
    let far = simulator.add_source(Source::at([6.0, 0.0, 0.0])).unwrap();
    let roll = glam::Quat::from_rotation_z(1.0);
    simulator
        .place_listener(Pose::at(Vec3::ZERO).turned(roll))
        .unwrap();
    let commit = simulator.commit();
    for (id, metres, from) in [(near, 2.0, Vec3::NEG_Z), (far, 6.0, Vec3::X)] {
        let found = heard(&simulator, id, commit, 1);
        assert!(found.direct.is_in_sight && found.direct.visibility == 1.0);
        for gain in found.direct.gain {
            assert!((gain * metres - 1.0).abs() < 1e-6, "{gain}");
        }
        assert!((found.delay_s - metres / 343.0).abs() < 1e-9);
        assert!(found.from.distance(from) < 1e-6);
        assert!(found.echoes.is_empty());
        assert_eq!(found.reverb.gain, [0.0; 8]);
    }
    assert!(matches!(simulator.state(), SimulatorState::Ready));
}

/// Protects the keys of echoes: they stay the same when the source moves and when an earlier surface is removed, and
/// moving compiles nothing.
#[test]
fn keys_of_echoes_stay_the_same() {
    let mut simulator = simulator();
    let size = Vec3::splat(0.5);
    let first = simulator
        .add_surface(Surface::new(Cuboid { size }).at([0.0, 0.0, 2.0]))
        .unwrap();
    let ids = simulator.add_scene(&shoebox(0.2)).unwrap();
    let commit = simulator.commit();
    let before = heard(&simulator, ids.sources[0], commit, 1);
    assert!(before.echoes.len() >= 6 && before.reverb.gain[4] > 0.0);
    assert!(!simulator.would_compile());
    let keys = |update: &Update| -> Vec<u64> {
        let mut keys: Vec<u64> = update.echoes.iter().map(|echo| echo.key).collect();
        keys.sort_unstable();
        keys
    };
    simulator.remove_surface(first).unwrap();
    simulator
        .place_source(ids.sources[0], Pose::at([-1.9, 0.0, -1.5]))
        .unwrap();
    assert!(simulator.would_compile());
    let commit = simulator.commit();
    let mut after = before.clone();
    wait_until("echoes without the box", || {
        after = heard(&simulator, ids.sources[0], commit, 1);
        matches!(simulator.state(), SimulatorState::Ready) && after.traces > before.traces + 1
    });
    let (before, after) = (keys(&before), keys(&after));
    let kept = before.iter().filter(|key| after.contains(key)).count();
    assert!(4 * kept >= 3 * before.len(), "{kept} of {}", before.len());
}

/// Protects a game that spawns objects: until the programs of the new surfaces are ready, the sources go on to move
/// among the old ones; then the new surface hides the source.
#[test]
fn the_last_programs_serve_until_the_new_ones_are_ready() {
    let mut simulator = simulator();
    let ids = simulator.add_scene(&shoebox(0.2)).unwrap();
    let commit = simulator.commit();
    assert!(
        heard(&simulator, ids.sources[0], commit, 1)
            .direct
            .is_in_sight
    );
    let wall = Surface::new(Cuboid {
        size: Vec3::new(0.2, 3.0, 5.0),
    });
    let wall = simulator.add_surface(wall).unwrap();
    assert!(simulator.would_compile());
    simulator.commit();
    wait_until("a hidden source", || {
        let update = simulator.updates(ids.sources[0]).expect("an update");
        !update.direct.is_in_sight && update.direct.visibility == 0.0
    });
    simulator.enable_surface(wall, false).unwrap();
    simulator.commit();
    wait_until("a source in sight", || {
        let update = simulator.updates(ids.sources[0]).expect("an update");
        update.direct.is_in_sight
    });
    wait_until("readiness", || {
        matches!(simulator.state(), SimulatorState::Ready)
    });
}

/// Protects games from a field that cannot be used: the error is reported, and the
/// surfaces before stay audible.
#[test]
fn a_field_is_refused_and_the_rest_goes_on() {
    let mut simulator = simulator();
    let ids = simulator.add_scene(&shoebox(0.2)).unwrap();
    let commit = simulator.commit();
    heard(&simulator, ids.sources[0], commit, 1);
    // Refused however fields are tried, which is the choice of the whole process.
    let text = "float field(vec3 p) { return length(p) - radius; }".to_owned();
    let field = crate::scene::UserField::new("ball.glsl", text, Vec3::ONE, 1.0);
    let field = crate::scene::shape::User {
        field: Arc::new(field),
    };
    let id = simulator.add_surface(Surface::new(field)).unwrap();
    simulator.commit();
    wait_until("a refusal", || {
        matches!(simulator.state(), SimulatorState::Failed(_))
    });
    simulator.remove_surface(id).unwrap();
    let commit = simulator.commit();
    heard(&simulator, ids.sources[0], commit, 1);
    wait_until("readiness", || {
        matches!(simulator.state(), SimulatorState::Ready)
    });
}

/// Protects what games play: in a room whose decay fits the trace, decay times are within 10 % and the level within 1 dB
/// of a response of many waves, and their errors hold.
#[test]
fn reverberation_is_that_of_many_waves() {
    let scene = shoebox(0.3);
    let context = crate::gl::Context::headless(&Default::default()).unwrap();
    let mut tracer = crate::Tracer::new(&context).unwrap();
    let trace = crate::Settings::hybrid().with_waves(32_768).with_seed(99);
    let settings = crate::response::ResponseSettings::default().with_trace(trace);
    let settings = settings.with_order(3);
    let reference = crate::response::Response::trace(&mut tracer, &scene, &settings).unwrap();
    let mut simulator = Simulator::new(SimulatorSettings::default()).unwrap();
    let ids = simulator.add_scene(&scene).unwrap();
    let commit = simulator.commit();
    let reverb = heard(&simulator, ids.sources[0], commit, 4).reverb;
    let direct = reference.direct().expect("the source is in sight").energy;
    for (band, direct) in direct.into_iter().enumerate() {
        let t30_s = reference.figures.bands[band].t30_s.expect("a decay");
        let off_s = (reverb.decay_s[band] - t30_s).abs();
        assert!(off_s < 0.1 * t30_s && off_s < 3.0 * reverb.decay_error_s[band]);
        let wet = reference.energy()[band] - direct;
        let found = reverb.gain[band].powi(2) / (4.0 * std::f64::consts::PI);
        let off_db = 10.0 * (found / wet).log10().abs();
        assert!(off_db < 1.0 && off_db < 3.0 * reverb.gain_error_db[band]);
    }
}

/// Protects the ways around obstacles: a source behind a screen in the open is heard more weakly and from the edge, and
/// is found although diffraction has a share of the time only.
#[test]
fn a_hidden_source_is_heard_around_the_edge() {
    let mut simulator = simulator();
    let size = Vec3::new(20.0, 4.0, 0.2);
    simulator
        .add_surface(Surface::new(Cuboid { size }))
        .unwrap();
    let id = simulator.add_source(Source::at([0.0, 1.5, -3.0])).unwrap();
    simulator.place_listener(Pose::at([0.0, 1.5, 3.0])).unwrap();
    simulator.commit();
    let mut found = None;
    wait_until("a way around", || {
        found = simulator.updates(id);
        (found.as_ref()).is_some_and(|found| found.direct.visibility > 0.0)
    });
    let direct = found.expect("an update").direct;
    assert!(!direct.is_in_sight && direct.visibility < 0.5);
    assert!(direct.gain[0] > direct.gain[7], "low sound bends more");
    assert!(direct.from.y > 0.1, "{}", direct.from);
}

/// Protects callers from stale ids and impossible numbers: each is an error that names it, and changes nothing.
#[test]
fn bad_calls_are_refused() {
    let bad = SimulatorSettings::default().with_waves(1);
    assert!(Simulator::new(bad).is_err());
    let mut simulator = simulator();
    let id = simulator.add_source(Source::at([1.0; 3])).unwrap();
    let surface = Surface::new(Room {
        size: Vec3::splat(-1.0),
    });
    assert!(simulator.add_surface(surface).is_err());
    let unknown = Surface::new(Room { size: Vec3::ONE }).with_material("butter");
    assert!(simulator.add_surface(unknown).is_err());
    assert!(simulator.place_source(id, Pose::at([f32::NAN; 3])).is_err());
    let flat = Pose::at([0.0; 3]).turned([0.0; 4]);
    assert!(simulator.place_listener(flat).is_err());
    assert!(simulator.set_priority(id, 0.0).is_err());
    assert!(simulator.set_level(id, f32::NAN).is_err());
    simulator.remove_source(id).unwrap();
    let gone = simulator.place_source(id, Pose::default());
    assert_eq!(gone, Err(SimulatorError::NoSource(id)));
    assert!(gone.unwrap_err().to_string().contains("0v0"));
}
