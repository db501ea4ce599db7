//! Several detectors that share the waves of a source.

use crate::gl::Context;
use crate::response::Arrival;
use crate::scene::Material;
use crate::scene::shape::Sphere;
use crate::test_common::{builtin, for_each_api};
use crate::tracer::{ArrivalSettings, Detector, NO_LIMITS, WavesToFollow};
use crate::{Scene, Settings, Surface, Tracer};
use glam::{Vec3, Vec4};

/// The steps of a recorded chord, as a share of the unit of chords, with 16 detectors: numbers up to 1024 in a float.
const CHORD_STEP: f64 = 1.0 / 16_384.0;

/// Radii of the detectors in metres. The unit of chords is four times the largest.
const RADII: [f32; 3] = [0.3, 0.8, 0.5];

fn scene() -> Scene {
    let mut scene = builtin("shoebox");
    let wall = Material::absorbing(0.2).scattering_by(0.1);
    scene.materials.insert("wall".into(), wall);
    scene.surfaces[0].material = Some("wall".to_owned());
    scene
}

/// Detectors around the listener, the first at its position.
fn detectors(scene: &Scene, count: usize) -> Vec<Detector> {
    let listener = &scene.listeners[0];
    let detector = |index: usize| Detector {
        position: listener.position - Vec3::new(0.11, 0.02, 0.07) * index as f32,
        radius: RADII[index % RADII.len()],
        inner_radius: (index % 2 == 1).then_some(0.2),
        limits: NO_LIMITS,
    };
    (0..count).map(detector).collect()
}

fn traced(tracer: &mut Tracer, scene: &Scene, detectors: &[Detector]) -> Vec<Arrival> {
    let settings = Settings::default().with_waves(20_000);
    let how = ArrivalSettings::new(0.2);
    let waves = WavesToFollow::Numbers(0..settings.waves);
    let mut all = Vec::new();
    let heard = (scene.only_pair().unwrap(), detectors);
    let mut take = |arrival| all.push(arrival);
    tracer
        .arrivals_through(heard, &settings, &how, &waves, &mut take, None)
        .unwrap();
    all.sort_by(|a, b| {
        let by_length = a.length_m.total_cmp(&b.length_m);
        (a.detector, a.wave)
            .cmp(&(b.detector, b.wave))
            .then(by_length)
    });
    all
}

fn share_their_waves(context: &Context) {
    let scene = scene();
    let mut tracer = Tracer::new(context).unwrap();
    for count in [2, 4, 7, 16] {
        let detectors = detectors(&scene, count);
        let together = traced(&mut tracer, &scene, &detectors);
        let unit = 4.0 * f64::from(RADII.into_iter().fold(0.0, f32::max));
        for (index, detector) in detectors.iter().enumerate() {
            let alone = traced(&mut tracer, &scene, &[*detector]);
            let of_detector = together.iter().filter(|a| a.detector == index as u32);
            let shared: Vec<&Arrival> = of_detector.collect();
            assert!(alone.len() > 100, "{}", alone.len());
            // A crossing shorter than a step of the record may be lost.
            assert!(
                shared.len().abs_diff(alone.len()) <= 3,
                "{index} of {count}"
            );
            let energy = |all: &mut dyn Iterator<Item = &Arrival>| -> [f64; 2] {
                all.fold([0.0; 2], |sum, a| {
                    [sum[0] + a.energy[4], sum[1] + a.inner * a.energy[4]]
                })
            };
            let [whole, inner] = energy(&mut shared.iter().copied());
            let [own_whole, own_inner] = energy(&mut alone.iter());
            // Rounding of chords of about a radius, averaged over the arrivals.
            let error = CHORD_STEP * unit / f64::from(detector.radius);
            assert!(
                (whole / own_whole - 1.0).abs() < error,
                "{index} of {count}"
            );
            assert!((inner / own_inner - 1.0).abs() < 0.01, "{index} of {count}");
            let matching = shared.iter().filter(|a| {
                let mut own = alone.iter().filter(|own| own.wave == a.wave);
                own.any(|own| {
                    let is_near = (own.length_m - a.length_m).abs() < 1e-6;
                    is_near && own.reflections == a.reflections && own.is_early == a.is_early
                })
            });
            assert!(matching.count() + 3 >= alone.len(), "{index} of {count}");
        }
    }
}

/// Protects listeners that share waves: each has the crossings, times and energies that it has alone.
#[test]
fn detectors_share_their_waves() {
    for_each_api(share_their_waves);
}

fn split_by_a_plane(context: &Context) {
    let mut scene = scene();
    // Only scenes with obstacles have limits.
    let ball = Surface::new(Sphere { radius: 0.1 }).at(Vec3::new(1.0, -1.0, 1.0));
    scene.surfaces.push(ball);
    let whole = Detector {
        inner_radius: Some(0.4),
        ..detectors(&scene, 2)[1]
    };
    let normal = Vec3::new(2.0, 1.0, -2.0) / 3.0;
    let split = |normal: Vec3, distance: f32| Detector {
        limits: [normal.extend(distance), Vec4::W, Vec4::W, Vec4::W],
        ..whole
    };
    let parts = [split(normal, 0.1), split(-normal, -0.1)];
    let mut tracer = Tracer::new(context).unwrap();
    let detectors = [
        whole,
        parts[0],
        parts[1],
        split(normal, 10.0),
        split(normal, -10.0),
    ];
    for together in [true, false] {
        // The energy of a detector times its volume is a sum over metres of chords.
        let sums = |detector: usize| {
            let all = match together {
                true => traced(&mut tracer, &scene, &detectors),
                false => traced(&mut tracer, &scene, &detectors[detector..=detector]),
            };
            let number = if together { detector as u32 } else { 0 };
            let volumes = detectors[detector].open_volumes(&scene);
            let own = all.iter().filter(|arrival| arrival.detector == number);
            own.fold([0.0; 2], |[whole, inner], arrival| {
                let chords = arrival.energy[4] * volumes.whole;
                let ratio = volumes.inner.map_or(0.0, |inner| inner / volumes.whole);
                [whole + chords, inner + chords * arrival.inner * ratio]
            })
        };
        let [all, one, other, far, none] = [0, 1, 2, 3, 4].map(sums);
        for part in 0..2 {
            let error = (one[part] + other[part]) / all[part] - 1.0;
            assert!(error.abs() < 2e-3, "{part}: {error}");
            assert!(one[part] > 1.1 * other[part] && other[part] > 0.2 * all[part]);
            assert!((far[part] / all[part] - 1.0).abs() < 1e-3);
            assert_eq!(none[part], 0.0);
        }
    }
}

/// Protects the planes that limit a detector: the parts of a sphere on both sides of a plane have together the crossings
/// of the whole, also of the inner sphere; a plane beyond the sphere changes nothing, and one before it leaves nothing.
#[test]
fn planes_split_a_detector() {
    for_each_api(split_by_a_plane);
}
