//! Tests of sorted starts: numbers, directions and sums of the waves do not depend on the texels at which the waves
//! start.

use crate::scene::shape::{Room, Torus};
use crate::test_common::{builtin, context, for_each_api};
use crate::tracer::start_order::Starts;
use crate::tracer::{Directions, Fate, Grid, Pass, Settings, Tracer, Wave, shader_text};
use crate::{Listener, Node, Profile, Scene, Source, Surface};
use glam::Vec3;

/// A torus in a room, and a listener that many waves reach.
fn torus_in_room() -> Scene {
    let size = Vec3::new(14.0, 6.0, 10.0);
    let torus = Node::Torus(Torus {
        ring: 1.5,
        tube: 0.5,
    });
    Scene::new(
        "a torus in a room",
        vec![Surface::new(Node::Room(Room { size })), Surface::new(torus)],
        Source::at(Vec3::new(-5.0, 0.5, 0.3)),
        Listener::at(Vec3::new(4.0, 0.2, -1.0), 1.5),
    )
}

/// The contributions of the last frame to the left and the right, as they are on the GPU.
fn contributions(tracer: &Tracer, waves: u32) -> Vec<[f32; 2]> {
    let texels = tracer.targets.as_ref().unwrap().pan.read(0).unwrap();
    let texels = texels.as_chunks::<4>().0[..waves as usize].iter();
    texels.map(|[left, right, ..]| [*left, *right]).collect()
}

/// The contribution of a wave to the left and the right, computed in `f64`.
fn contribution(scene: &Scene, wave: &Wave) -> [f64; 2] {
    if wave.fate() != Fate::Listener {
        return [0.0; 2];
    }
    let listener = &scene.listeners[0];
    let offset = (wave.position - listener.position).as_dvec3();
    let side = offset.normalize().dot(listener.right().as_dvec3());
    [0.5 - 0.5 * side, 0.5 + 0.5 * side]
}

/// Protects the numbers of sorted waves: wave n always has start direction n when it is read back, its contribution is
/// in texel n, and sums are in this order. The last rows for 1,001 and 4,099 waves are not full.
#[test]
fn sorted_waves_keep_their_numbers() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let scene = torus_in_room();
        for profile in [Profile::Hybrid, Profile::March] {
            for (waves, directions) in [(1001, Directions::Random), (4099, Directions::Fibonacci)] {
                let settings = Settings::new(profile)
                    .with_waves(waves)
                    .with_iterations(4)
                    .with_seed(waves)
                    .with_directions(directions);
                same_waves(&mut tracer, &scene, &settings);
            }
        }
    });
}

fn same_waves(tracer: &mut Tracer, scene: &Scene, settings: &Settings) {
    let what = format!("{}, {} waves", settings.profile(), settings.waves);
    // The directions are read and traced without sorting.
    let starts = tracer.start_directions(settings).unwrap();
    let pair = scene.only_pair().unwrap();
    let expected = tracer.trace_units(pair, settings, &starts).unwrap();
    assert!(tracer.paths(scene, settings).unwrap() == expected, "{what}");
    let ends = &expected[expected.len() - 1];
    let (frame, waves) = tracer.frame_with_waves(scene, settings).unwrap();
    assert!(waves == *ends, "{what}");
    let heard = waves.iter().filter(|wave| wave.fate() == Fate::Listener);
    assert!(heard.count() > 10, "{what}");
    for (as_one, settings) in [
        (true, settings.clone()),
        (false, settings.clone().with_iterations_per_pass(3)),
    ] {
        let again = tracer.frame(scene, &settings).unwrap();
        assert_eq!(
            (again.panning, again.counts),
            (frame.panning, frame.counts),
            "{what}"
        );
        let of_texels = contributions(tracer, settings.waves);
        for (wave, (found, end)) in of_texels.iter().zip(ends).enumerate() {
            let expected = contribution(scene, end);
            for (found, expected) in found.iter().zip(expected) {
                let off = (f64::from(*found) - expected).abs();
                assert!(off < 1e-5, "{what}: {as_one}, wave {wave}: {off}");
            }
        }
        let sums = of_texels.iter().fold([0.0; 2], |sums: [f64; 2], texel| {
            [0, 1].map(|ear| sums[ear] + f64::from(texel[ear]))
        });
        assert_eq!([frame.panning.left, frame.panning.right], sums, "{what}");
        let left_on_gpu = tracer.frame_to_texture(scene, &settings).unwrap();
        assert_eq!(left_on_gpu.waves, settings.waves);
        assert_eq!(contributions(tracer, settings.waves), of_texels, "{what}");
    }
}

/// Protects the purpose of sorting, and the copy of the hash on the CPU: the waves of a tile start within a few degrees
/// of each other, for both kinds of directions.
#[test]
fn waves_of_a_tile_start_in_neighbouring_directions() {
    const WAVES: u32 = 10_000;
    /// Four times the radius of the cap that holds 64 of 10,000 directions, √(4 · 64 / `WAVES`). The factor allows for
    /// the shape of a tile's part of the sphere, and for chance. Unsorted directions are 1.4 from their mean.
    const NEAR: f32 = 4.0 * 0.16;
    let mut tracer = Tracer::new(&context(crate::gl::Api::Gl)).unwrap();
    for (directions, seed) in [(Directions::Random, 7), (Directions::Fibonacci, 3)] {
        let settings = Settings::march()
            .with_waves(WAVES)
            .with_seed(seed)
            .with_directions(directions);
        let starts = tracer.start_directions(&settings).unwrap();
        let grid = Grid::new(WAVES);
        let order = Starts::new(directions, seed, WAVES, 0..WAVES).order(grid);
        let mut tiles = std::collections::BTreeMap::<_, Vec<Vec3>>::new();
        for (wave, start) in (0..).zip(&starts) {
            let texel = order.texel(wave);
            let tile = (texel % grid.width / 8, texel / grid.width / 8);
            tiles.entry(tile).or_default().push(*start);
        }
        for (tile, starts) in tiles {
            let mean = starts.iter().sum::<Vec3>() / starts.len() as f32;
            let off = starts.iter().map(|start| start.distance(mean));
            let off = off.fold(0.0, f32::max);
            assert!(off < NEAR, "{directions}, tile {tile:?}: {off}");
        }
    }
}

/// Protects texts in which sorting has no benefit: `hybrid` without marched fields, and `thesis`, start waves by
/// number.
#[test]
fn only_marched_waves_start_sorted() {
    let corner = builtin("corner");
    for (scene, profile, expected) in [
        (&corner, Profile::Hybrid, false),
        (&corner, Profile::March, true),
        (&corner, Profile::Thesis, false),
        (&torus_in_room(), Profile::Hybrid, true),
        (&torus_in_room(), Profile::Thesis, false),
    ] {
        let settings = Settings::new(profile);
        for pass in [Pass::Initialise, Pass::Pan] {
            let text = shader_text(scene, &settings, pass);
            let is_sorted = text.contains("uOrder");
            assert_eq!(is_sorted, expected, "{}, {profile}, {pass:?}", scene.name);
            assert!(!text.contains('@'), "{text}");
        }
    }
}
