//! Tests of options that must not change the results, or only by a stated amount: fused passes, the sum on the GPU,
//! other start directions. Also compares the profiles on every API.

use crate::common::{builtin, for_each_api, tracer};
use echomarch::tracer::Directions;
use echomarch::{Profile, Settings};
use std::collections::HashSet;

/// Protects fused passes: for any number of iterations per pass, every wave ends with the same bits. A number of the
/// state between two iterations has 32 bits, in a texture and in a register.
#[test]
fn fused_passes_change_no_bit() {
    let mut tracer = tracer();
    for name in ["corner", "obstacles", "open-pillars"] {
        for profile in Profile::ALL {
            let settings = Settings::new(profile).with_waves(10_000).with_iterations(7);
            let of = |per_pass| settings.clone().with_iterations_per_pass(per_pass);
            let scene = builtin(name);
            let (_, single) = tracer.frame_with_waves(&scene, &of(1)).unwrap();
            for per_pass in [3, 7, 100] {
                let (_, fused) = tracer.frame_with_waves(&scene, &of(per_pass)).unwrap();
                assert!(
                    single == fused,
                    "{name}, {profile}: {per_pass} iterations a pass"
                );
            }
        }
    }
}

/// Protects a whole frame in one pass, on every API: if the waves are not requested, the sums and counts have the same
/// bits as those of a frame with one pass per iteration.
#[test]
fn a_frame_in_one_pass_is_the_frame_of_its_passes() {
    for_each_api(|context| {
        let mut tracer = echomarch::Tracer::new(context).unwrap();
        for name in ["corner", "obstacles", "open-pillars", "glasshouse"] {
            for directions in [Directions::Random, Directions::Fibonacci] {
                for profile in [Profile::Hybrid, Profile::March] {
                    // The last row is not full, so some texels contain no wave.
                    let whole = Settings::new(profile)
                        .with_waves(9_999)
                        .with_directions(directions);
                    let passes = whole.clone().with_iterations_per_pass(1);
                    let scene = builtin(name);
                    let heard = |frame: echomarch::Frame| (frame.panning, frame.counts);
                    let of_passes = heard(tracer.frame(&scene, &passes).unwrap());
                    let of_whole = heard(tracer.frame(&scene, &whole).unwrap());
                    assert_eq!(of_passes, of_whole, "{name}, {profile}, {directions}");
                    let (beside_waves, _) = tracer.frame_with_waves(&scene, &whole).unwrap();
                    assert_eq!(
                        heard(beside_waves),
                        of_whole,
                        "{name}, {profile}, with waves"
                    );
                }
            }
        }
    });
}

/// Protects the sum on the GPU. Counts are whole numbers below 2^24, and therefore exact. Contributions are added in
/// `f32` in blocks of 64. Each level has at most 64 roundings, a relative error of 64 × 2^-24 = 4e-6, and a million
/// waves have four levels.
#[test]
fn the_sum_on_the_gpu_is_that_on_the_cpu() {
    for_each_api(|context| {
        let mut tracer = echomarch::Tracer::new(context).unwrap();
        for waves in [1, 63, 64, 65, 1000, 65_537, 1 << 20] {
            for profile in [Profile::Thesis, Profile::Hybrid] {
                // Waves die only in the second scene.
                for scene in ["corner", "open-pillars"].map(builtin) {
                    let on_cpu = Settings::new(profile).with_waves(waves).with_iterations(4);
                    let on_gpu = on_cpu.clone().with_sum_on_gpu(true);
                    let cpu = tracer.frame(&scene, &on_cpu).unwrap();
                    let gpu = tracer.frame(&scene, &on_gpu).unwrap();
                    assert_eq!(cpu.counts, gpu.counts, "{waves} waves, {profile}");
                    let may_die = scene.name == "open-pillars";
                    assert_eq!(gpu.counts.dead > 0, may_die, "{waves} waves, {profile}");
                    let sums = [
                        (cpu.panning.left, gpu.panning.left),
                        (cpu.panning.right, gpu.panning.right),
                    ];
                    for (cpu, gpu) in sums {
                        assert!((cpu - gpu).abs() <= 1.6e-5 * cpu, "{waves}: {cpu}, {gpu}");
                    }
                }
            }
        }
    });
}

/// Protects the lattice: its directions are evenly distributed unit vectors. The number of directions in a part of the
/// sphere has an error far below √N, the error of N random directions.
#[test]
fn fibonacci_directions_are_even() {
    let mut tracer = tracer();
    let settings = Settings::hybrid()
        .with_waves(65_536)
        .with_iterations(1)
        .with_directions(Directions::Fibonacci);
    let (_, waves) = tracer
        .frame_with_waves(&builtin("shoebox"), &settings)
        .unwrap();
    let directions: Vec<_> = waves.iter().map(|wave| wave.start_direction).collect();
    assert!(directions.iter().all(|d| (d.length() - 1.0).abs() < 5e-7));
    for axis in [
        glam::Vec3::X,
        glam::Vec3::Y,
        glam::Vec3::new(0.6, 0.0, -0.8),
    ] {
        for height in [0.9_f32, 0.5, 0.0, -0.7] {
            // By Archimedes' theorem, the cap above a height has (1 − height) / 2 of the sphere's area.
            let expected = 65_536.0 * 0.5 * (1.0 - height);
            let found = directions.iter().filter(|d| d.dot(axis) > height).count() as f32;
            // Along the rim of a cap the number of lattice points in the cap has an error of the order of N^(1/4) = 16.
            // For random directions the error is √N / 2 = 128.
            assert!((found - expected).abs() < 40.0, "{axis}, {height}: {found}");
        }
    }
}

/// Protects the lattice with many waves: if the phase were computed in floats, the last of four million waves would
/// have only a few azimuths.
#[test]
fn fibonacci_azimuths_do_not_collapse() {
    let mut tracer = tracer();
    let waves = 1 << 22;
    let settings = Settings::hybrid()
        .with_waves(waves)
        .with_iterations(1)
        .with_directions(Directions::Fibonacci);
    let (_, waves) = tracer
        .frame_with_waves(&builtin("shoebox"), &settings)
        .unwrap();
    let last = &waves[waves.len() - 4096..];
    let bits = |d: glam::Vec3| d.to_array().map(f32::to_bits);
    let distinct: HashSet<_> = last.iter().map(|w| bits(w.start_direction)).collect();
    assert_eq!(distinct.len(), last.len());
}

/// Protects seeds: another seed rotates the lattice, and the same seed gives the same bits.
#[test]
fn seeds_turn_the_lattice() {
    let mut tracer = tracer();
    let mut first = |seed| {
        let settings = Settings::hybrid()
            .with_waves(64)
            .with_seed(seed)
            .with_directions(Directions::Fibonacci);
        let frame = tracer.frame_with_waves(&builtin("corner"), &settings);
        frame.unwrap().1[0].start_direction
    };
    assert_eq!(first(1), first(1));
    assert!(first(1).distance(first(2)) > 0.01);
}

/// Protects the profiles on every API: the same waves reach the listener, except for those that drivers round
/// differently (none between APIs of one renderer).
#[test]
fn profiles_agree_on_every_api() {
    let mut first = tracer();
    let renderer = first.context().renderer().to_owned();
    let reference: Vec<u64> = hits(&mut first);
    for_each_api(|context| {
        let mut tracer = echomarch::Tracer::new(context).unwrap();
        let ours = hits(&mut tracer);
        if context.renderer() == renderer {
            assert_eq!(ours, reference);
            return;
        }
        for (ours, reference) in ours.iter().zip(&reference) {
            // Late hits on two renderers are two samples of one experiment. The limit is four standard deviations of
            // their difference.
            let chance = 4.0 * (2.0 * *reference as f64).sqrt();
            assert!(
                ours.abs_diff(*reference) as f64 <= 1.0 + chance,
                "{ours} hits, {reference}"
            );
        }
    });
}

fn hits(tracer: &mut echomarch::Tracer) -> Vec<u64> {
    let mut all = Vec::new();
    for name in echomarch::Scene::BUILTIN_NAMES {
        for profile in [Profile::March, Profile::Hybrid] {
            let settings = Settings::new(profile).with_waves(20_000);
            let frame = tracer.frame(&builtin(name), &settings).unwrap();
            all.push(frame.counts.listener_hits);
        }
    }
    all
}
