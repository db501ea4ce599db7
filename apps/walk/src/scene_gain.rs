//! The gain of a scene's sound: it keeps the loudest places within full scale, and stays the same throughout a walk, so
//! that differences of level are heard.

use echomarch::Error;
use echomarch::auralisation::HeardSource;
use echomarch::response::{PathKind, Response, ResponseSettings};
use echomarch::scene::{Pair, Scene};
use glam::Vec3;

/// Level in decibels, relative to a full-scale sound, of the sound at the loudest places. The peaks of white noise that
/// arrives over many paths are 1.2 dB above its own peaks.
const LOUDEST_DB: f64 = -2.0;

/// Limits of the gain in decibels. Above the upper limit a source is far away or nearly silent.
const LEAST_DB: f64 = -40.0;
const MOST_DB: f64 = 24.0;

/// Distance in metres from a source at which it is heard at full scale in the open, if the listener starts within four
/// times this distance.
const NEAR_M: f32 = 1.0;

/// Share of the distance from a source to the listener at which the source is heard at full scale in the open.
const NEAR_SHARE: f32 = 0.25;

/// The strength *G* in decibels of the direct sound at 1 m: it is relative to the direct sound at 10 m.
const STRENGTH_AT_1_M_DB: f64 = 20.0;

/// Length in seconds of the responses for the gain: it contains nearly all energy of a usual room.
const LENGTH_S: f64 = 0.5;

/// Returns the gain of a scene, an amplitude factor. It is computed from a response of each source near it: at a quarter
/// of the way to the listener or 1 m away, whichever is farther, or at half of the clear way if a surface is nearer.
///
/// Without any absorption the responses have the length `longest_s` in seconds, because a room then fills with sound. The
/// loudest place is taken to have the loudest direct sound of one source, and all other sound of all sources.
///
/// # Errors
/// The errors of `trace`, which gives the response of a pair.
pub fn of_scene(
    scene: &Scene,
    listener: usize,
    settings: &ResponseSettings,
    longest_s: f64,
    mut trace: impl FnMut(Pair, &ResponseSettings) -> Result<Response, Error>,
) -> Result<f32, Error> {
    let seconds = match scene.has_materials() || scene.air.is_some() {
        true => LENGTH_S,
        false => longest_s,
    };
    let settings = settings.clone().with_order(1).with_seconds(seconds);
    let settings = settings.with_diffraction(false);
    let (mut direct, mut others) = (0.0_f64, 0.0);
    for source in 0..scene.sources.len() {
        let pair = scene.pair(source, listener)?;
        let mut near = scene.clone();
        if let Some(first) = near.listeners.get_mut(listener) {
            first.position = near_source(scene, pair);
        }
        let pair = near.pair(source, listener)?;
        let heard = HeardSource::of(&trace(pair, &settings)?);
        let of_direct = energy_of(heard.kinds.iter().find_map(|kind| match kind.kind {
            PathKind::Direct => kind.level_db,
            _ => None,
        }));
        direct = direct.max(of_direct);
        others += (energy_of(heard.level_db) - of_direct).max(0.0);
    }
    Ok(gain(direct + others))
}

/// The energy of a strength *G*, relative to the direct sound at 1 m.
fn energy_of(level_db: Option<f64>) -> f64 {
    level_db.map_or(0.0, |level| 10_f64.powf(0.1 * (level - STRENGTH_AT_1_M_DB)))
}

/// The gain for an energy at the loudest place, relative to the direct sound at 1 m.
fn gain(energy: f64) -> f32 {
    let level_db = 10.0 * energy.max(f64::MIN_POSITIVE).log10();
    let gain_db = (LOUDEST_DB - level_db).clamp(LEAST_DB, MOST_DB);
    10_f64.powf(0.05 * gain_db) as f32
}

/// The place near a source at which its level is taken.
fn near_source(scene: &Scene, pair: Pair) -> Vec3 {
    let (source, listener) = (pair.source().position, pair.listener().position);
    let distance = source.distance(listener);
    let wanted = NEAR_M.max(NEAR_SHARE * distance).min(distance);
    let towards = (listener - source).normalize_or_zero();
    // Steps by the distance to the nearest surface cross no surface.
    let mut clear = 0.0;
    for _ in 0..64 {
        let step = scene.surface_distance(source + clear * towards).distance;
        if step.is_nan() || step < 1e-3 || clear >= wanted {
            break;
        }
        clear += step;
    }
    let reach = if clear >= wanted { wanted } else { 0.5 * clear };
    source + reach * towards
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::gl::{Context, ContextOptions};
    use echomarch::tracer::Tracer;

    /// Length in seconds of the responses in a scene without absorption.
    const LONGEST_S: f64 = 2.0;

    fn gain_db(scene: &str) -> f64 {
        let scene = Scene::from_ron(scene, "s").unwrap();
        let mut tracer =
            Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
        let settings = ResponseSettings::default().with_late_waves(1024);
        let trace = |pair: Pair, how: &_| Response::trace(&mut tracer, pair, how);
        let gain = of_scene(&scene, 0, &settings, LONGEST_S, trace).unwrap();
        20.0 * f64::from(gain).log10()
    }

    fn open(distance: f32) -> String {
        format!(
            "Scene(surfaces: [Surface(shape: Sphere(radius: 0.1), position: (0, -500, 0))],
             source: Source(position: (0, 0, -{distance})),
             listener: Listener(position: (0, 0, 0), radius: 0.3))"
        )
    }

    /// Protects the level in the open: a quarter of the way to the source it is that of a full-scale sound, less the
    /// margin for peaks.
    #[test]
    fn in_the_open_the_gain_follows_the_distance() {
        for (distance, near) in [(2.0, 1.0), (8.0, 2.0), (20.0, 5.0)] {
            let expected = 20.0 * f64::log10(near) + LOUDEST_DB;
            let found = gain_db(&open(distance));
            assert!(
                (found - expected).abs() < 0.2,
                "{distance} m: {found} dB, not {expected} dB"
            );
        }
    }

    /// Protects a room without absorption, which fills with sound for the whole length of its responses: a place in it is
    /// at most as loud as the place of the gain, except for noise.
    #[test]
    fn a_room_without_absorption_does_not_exceed_its_gain() {
        let scene = Scene::builtin("corner").unwrap();
        let mut tracer =
            Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
        let settings = ResponseSettings::default().with_late_waves(1024);
        let settings = settings.with_seconds(LONGEST_S);
        let trace = |pair: Pair, how: &_| Response::trace(&mut tracer, pair, how);
        let gain = f64::from(of_scene(&scene, 0, &settings, LONGEST_S, trace).unwrap());
        let pair = scene.pair(0, 0).unwrap();
        let response = Response::trace(&mut tracer, pair, &settings).unwrap();
        let strength_db = HeardSource::of(&response).level_db.unwrap();
        let level_db = strength_db - STRENGTH_AT_1_M_DB + 20.0 * gain.log10();
        assert!(level_db < LOUDEST_DB + 1.0, "{level_db} dB");
    }

    /// Protects a reverberant room from the limiter: its gain is lower than in the open, by the energy of its echoes, and
    /// a listener behind a wall does not raise it.
    #[test]
    fn a_live_room_has_a_lower_gain_also_from_behind_a_wall() {
        let room = |listener: &str| {
            format!(
                "Scene(surfaces: [
                    Surface(shape: Room(size: (8, 3, 5)), material: \"hard\"),
                    Surface(shape: Box(size: (0.2, 3, 4)), position: (0, 0, 0.5), material: \"hard\"),
                 ], materials: {{\"hard\": Material(absorption: 0.05, scattering: 0.3)}},
                 source: Source(position: (-2, 0, 0)), listener: Listener({listener}, radius: 0.3))"
            )
        };
        let beside = gain_db(&room("position: (-1, 0, 0)"));
        let behind = gain_db(&room("position: (2, 0, 1)"));
        assert!(beside < LOUDEST_DB - 2.0, "{beside} dB");
        assert!((beside - behind).abs() < 1.5, "{beside} dB, {behind} dB");
    }
}
