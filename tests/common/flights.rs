//! Compares the flights of waves with the exact reference.

use super::tracer;
use echomarch::geometry::ExactScene;
use echomarch::tracer::Wave;
use echomarch::{Profile, Scene, Settings, Tracer};
use glam::Vec3;

/// Maximum offset of a ray due to rounding, in units in the last place of the largest coordinate. It covers the errors
/// of surface positions, flights and hits.
const ROUNDINGS: f64 = 8.0;

/// Returns the maximum offset of a ray due to rounding, in metres. A wave may end where a ray with this offset ends.
fn rounding(scene: &Scene) -> f64 {
    let far = |place: Vec3| f64::from((place - scene.listeners[0].position).abs().max_element());
    let places = scene.surfaces.iter().map(|surface| {
        let extent = match surface.shape.is_basic() {
            true => 0.0,
            false => surface.shape.properties().bounds.half_size().max_element(),
        };
        far(surface.position) + if extent.is_finite() { extent } else { 0.0 }
    });
    let largest = places.fold(far(scene.sources[0].position), f64::max);
    ROUNDINGS * f64::from(f32::EPSILON) * largest
}

/// Traces one flight of each wave in each profile, and compares its end with the end of the exact flight.
pub fn compare(scene: &Scene, directions: &[Vec3], profiles: &[Profile]) {
    compare_paths(scene, directions, profiles, 1);
}

/// Traces `count` flights of each wave in each profile, and compares their end with the end of the exact flights.
pub fn compare_paths(scene: &Scene, directions: &[Vec3], profiles: &[Profile], count: u32) {
    let exact = ExactScene::new(scene).unwrap();
    let start = scene.sources[0].position.as_dvec3();
    let ear = scene.listeners[0].position.as_dvec3();
    let mut tracer = tracer();
    for &profile in profiles {
        let settings = Settings::new(profile).with_iterations(count);
        let states = tracer
            .trace_directions(scene, &settings, directions)
            .unwrap();
        let waves = &states[count as usize];
        let context = |wave: &Wave| format!("{}, {profile}: {wave:?}", scene.name);
        for wave in waves {
            assert_eq!(wave.step_limit_reached, 0, "{}", context(wave));
            let d = wave.start_direction.as_dvec3();
            let truth = exact.trace(start, d, count);
            let place = wave.position.as_dvec3();
            if wave.status < 0.0 && truth.status < 0 {
                continue;
            }
            let reach = (truth.point - ear).abs().max_element();
            let off = rounding(scene).max(ROUNDINGS * f64::from(f32::EPSILON) * reach);
            let near = place.distance(truth.point) <= off;
            if wave.status as i32 == truth.status && near {
                assert!(exact.surface_distance(place) > -off, "{}", context(wave));
                continue;
            }
            // Either the hit object depends on rounding, or the hit moves far along the surface. In both cases,
            // neighbouring rays end on both sides of the exact hit, and the hit of the wave is still on a surface.
            let (one, other) = d.any_orthonormal_pair();
            let aside = [one, -one, other, -other].map(|side| {
                let twin = exact.trace(start + off * side, d, count);
                (twin.status, twin.point.distance(truth.point))
            });
            let as_twin = aside.iter().any(|twin| twin.0 == wave.status as i32);
            let spread = aside.iter().map(|twin| twin.1).fold(0.0, f64::max);
            let off_surfaces = wave.status <= 0.0;
            let on_surface = off_surfaces || exact.surface_distance(place).abs() <= off;
            let same = wave.status as i32 == truth.status
                && place.distance(truth.point) <= off + 2.0 * spread;
            let other = wave.status as i32 != truth.status && as_twin;
            assert!(
                on_surface && (same || other),
                "{} for {truth:?}",
                context(wave)
            );
        }
    }
}

/// Asserts that no wave leaves a closed scene, and that none is given up, in these profiles. `effort` is the number of
/// iterations and the number of waves.
pub fn assert_no_wave_leaves(
    tracer: &mut Tracer,
    scene: &Scene,
    profiles: &[Profile],
    effort: (u32, u32),
) {
    for profile in profiles {
        let settings = Settings::new(*profile)
            .with_iterations(effort.0)
            .with_waves(effort.1);
        let frame = tracer.frame(scene, &settings).expect("a frame");
        assert_eq!(frame.counts.dead, 0, "{}, {profile}", scene.name);
        assert_eq!(
            frame.counts.step_limit_reached, 0,
            "{}, {profile}",
            scene.name
        );
    }
}
