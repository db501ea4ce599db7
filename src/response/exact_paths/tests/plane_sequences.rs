//! Sequences of planes found without waves.

use super::{directions, scene};
use crate::response::exact_paths::{Candidates, EarlyPaths, Ends, SpecularPath};
use crate::scene::shape::{Cuboid, HalfSpace, Room};
use crate::{Scene, Shape, Surface};
use glam::{Quat, Vec3};
use std::f64::consts::PI;

/// The paths found from sequences of planes alone, and the number of reflections up to which all sequences are tried.
fn by_planes(scene: &Scene, order: u32) -> (Vec<SpecularPath>, u32) {
    let early = EarlyPaths::new(scene).expect("a valid scene");
    let ends = Ends::of(scene.only_pair().unwrap());
    let mut candidates = Candidates::new(0);
    let known = early.add_planes(&ends, order, &mut candidates);
    (early.find(&ends, &candidates).paths, known)
}

/// Protects the energy of narrow beams: in a long, low room each image source up to order 8 has its path, though
/// only one in about 100,000 directions leads to some of them.
#[test]
fn a_long_room_has_all_its_images() {
    let size = Vec3::new(23.5, 2.5, 3.6);
    let turn = Quat::from_rotation_y(0.4);
    let scene = scene(
        vec![Surface::new(Room { size }).turned(turn)],
        turn * Vec3::new(7.98, -0.3, 1.0),
        turn * Vec3::new(4.5, 0.2, -0.15),
    );
    let (paths, known) = by_planes(&scene, 8);
    assert_eq!(known, 8);
    // There are 4 n² + 2 image sources of order n.
    assert_eq!(paths.len(), 833);
    assert!(
        paths
            .iter()
            .all(|path| path.is_searched && path.found_by == 0)
    );
}

/// Protects paths among obstacles, and the order up to which all are known: a very large number of directions finds the
/// same paths as the images of the source.
#[test]
fn paths_among_boxes_are_all_known() {
    let size = Vec3::new(9.0, 4.0, 7.0);
    let block = |place: Vec3, turn: f32| {
        let size = Vec3::new(1.0, 1.5, 0.8);
        let turn = Quat::from_rotation_y(turn);
        Surface::new(Cuboid { size }).at(place).turned(turn)
    };
    let scene = scene(
        vec![
            Surface::new(Room { size }),
            block(Vec3::new(1.0, -1.2, 0.5), 0.3),
            block(Vec3::new(-2.0, 0.4, -1.5), 1.0),
        ],
        Vec3::new(-3.1, 0.2, 2.3),
        Vec3::new(2.9, -0.4, -1.1),
    );
    let (paths, known) = by_planes(&scene, 16);
    assert!((4..16).contains(&known), "{known}");
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    let ends = Ends::of(scene.only_pair().unwrap());
    let searched = early.candidates(&ends, &directions(1 << 17), 3, f64::INFINITY);
    let searched = early.find(&ends, &searched).paths;
    let of_three = |path: &&SpecularPath| path.surfaces.len() <= 3;
    let known: Vec<f64> = paths
        .iter()
        .filter(of_three)
        .map(|path| path.length_m)
        .collect();
    let found: Vec<f64> = searched.iter().map(|path| path.length_m).collect();
    assert!(found.len() > 30, "{}", found.len());
    assert_eq!(known, found);
}

/// Protects paths in fields of planes: a hollow box with a block in it, as one field with a material of its own, has
/// the paths of a room with a box, also for a source in its corner.
#[test]
fn fields_of_planes_have_the_paths_of_basic_shapes() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let angle = 0.5;
    let turn = Quat::from_rotation_y(angle);
    let (block, place) = (Vec3::new(1.0, 1.25, 0.75), Vec3::new(0.5, -0.25, 0.125));
    let hollow = Shape::from(Cuboid { size }).complement();
    let pillar = Shape::from(Cuboid { size: block / 2.0 }).scale(2.0);
    let field = Shape::union([hollow, pillar.rotate(Vec3::Y * angle).translate(place)]);
    let basic = [
        Surface::new(Room { size }),
        Surface::new(Cuboid { size: block }).at(place).turned(turn),
    ];
    for source in [Vec3::new(-3.0, 0.25, 1.0), size / -2.0] {
        let of = |surfaces: Vec<Surface>| {
            let (paths, known) = by_planes(&scene(surfaces, source, Vec3::new(3.0, -0.3, 1.2)), 5);
            assert_eq!(known, 5);
            let mut lengths: Vec<f64> = paths.iter().map(|path| path.length_m).collect();
            lengths.sort_by(f64::total_cmp);
            lengths
        };
        let (of_field, of_basic) = (of(vec![Surface::new(field.clone())]), of(basic.to_vec()));
        assert!(of_basic.len() > 60, "{source}: {}", of_basic.len());
        assert_eq!(of_field.len(), of_basic.len(), "{source}");
        let apart = of_field.iter().zip(&of_basic).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-5, "{source}");
    }
}

/// Protects the number of images tried: coplanar faces of a field's parts count as one plane.
#[test]
fn flush_parts_of_a_field_are_one_plane() {
    let size = Vec3::new(5.0, 3.0, 5.0);
    let hollow = |x: f32| Shape::from(Cuboid { size }).translate(Vec3::X * x);
    let field = Shape::union([hollow(-1.5), hollow(1.5)]).complement();
    let scene = scene(
        vec![Surface::new(field)],
        Vec3::new(-3.0, 0.2, 1.0),
        Vec3::new(3.0, -0.3, 1.2),
    );
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    assert_eq!(early.surfaces.planes().len(), 8);
    let (paths, known) = by_planes(&scene, 4);
    assert_eq!((known, paths.len()), (4, 129));
}

/// Protects the loudness of a source on a wall, in an edge and in a corner of the room, and on a box: its paths equal
/// the paths of a source next to it.
#[test]
fn a_source_on_a_wall_has_the_paths_of_one_next_to_it() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let block = Surface::new(Cuboid { size: Vec3::ONE }).at(Vec3::new(-1.0625, -1.0, 0.03125));
    let lengths = |source: Vec3| {
        let surfaces = vec![Surface::new(Room { size }), block.clone()];
        let (paths, known) = by_planes(&scene(surfaces, source, Vec3::new(3.0, -0.3, 1.2)), 4);
        assert_eq!(known, 4);
        assert!(paths.iter().all(|path| path.departure.is_normalized()));
        paths.iter().map(|p| p.length_m).collect::<Vec<f64>>()
    };
    let next_to_it = 1e-4;
    for (on, into_the_air) in [
        (Vec3::new(-4.0, 0.2, 0.3), Vec3::X),
        (Vec3::new(-4.0, 1.5, 0.3), Vec3::new(1.0, -1.0, 0.0)),
        (Vec3::new(-4.0, 1.5, 2.5), Vec3::new(1.0, -1.0, -1.0)),
        (Vec3::new(-0.5625, -0.8, 0.1), Vec3::X),
    ] {
        let (at, near) = (lengths(on), lengths(on + next_to_it * into_the_air));
        assert_eq!(at.len(), near.len(), "{on}");
        let far_off = at
            .iter()
            .zip(&near)
            .filter(|(a, b)| (*a - *b).abs() > 4.0 * f64::from(next_to_it));
        assert_eq!(far_off.count(), 0, "{on}");
    }
}

/// Protects a source in a corner from having fewer paths: all paths of up to eight reflections are also known from a
/// corner, in a room and in a hollow box.
#[test]
fn a_source_in_a_corner_has_all_its_images() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let hollow = Shape::from(Cuboid { size }).complement();
    for room in [Shape::from(Room { size }), hollow] {
        // Without rounding errors, the paths to the second listener pass through edges.
        for listener in [Vec3::new(3.0, -0.3, 1.2), Vec3::new(2.0, -0.3, 1.5)] {
            let scene = scene(vec![Surface::new(room.clone())], size / -2.0, listener);
            let (paths, known) = by_planes(&scene, 8);
            assert_eq!((known, paths.len()), (8, 833), "{listener}");
        }
    }
}

/// Protects the loudness of a source in an edge or a corner of a hollow box: each wall in turn mirrors its waves, and
/// the waves that pass the listener are the same as in a room.
#[test]
fn waves_leave_the_edges_of_a_hollow_box_as_those_of_a_room() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let hollow = Shape::from(Cuboid { size }).complement();
    for source in [Vec3::new(-4.0, -1.5, 0.3), size / -2.0] {
        let waves = |shape: Shape| {
            let scene = scene(vec![Surface::new(shape)], source, Vec3::new(3.0, -0.3, 1.2));
            let early = EarlyPaths::new(&scene).expect("a valid scene");
            let found = early.candidates(
                &Ends::of(scene.only_pair().unwrap()),
                &directions(4096),
                5,
                0.3,
            );
            let all = found.iter().map(|wave| (wave.wave, wave.vertices.len()));
            all.collect::<Vec<(u32, usize)>>()
        };
        let (of_room, of_hollow) = (waves(Room { size }.into()), waves(hollow.clone()));
        assert!(of_room.len() > 30, "{}", of_room.len());
        assert_eq!(of_room, of_hollow, "{source}");
    }
}

/// Protects the loudness of a source or a listener on an edge and at a corner of a box: no face mirrors waves that stay
/// in the air.
#[test]
fn edges_of_a_box_mirror_nothing_into_the_air_before_them() {
    let block = Surface::new(Cuboid { size: Vec3::ONE });
    let before = Vec3::new(3.0, 4.0, 5.0);
    for on in [Vec3::new(0.5, 0.5, 0.125), Vec3::splat(0.5)] {
        for (source, listener) in [(on, before), (before, on)] {
            let (paths, _) = by_planes(&scene(vec![block.clone()], source, listener), 3);
            assert_eq!(paths.len(), 1, "{paths:?}");
        }
    }
}

/// Protects the loudness of a source on an edge and at a corner of a box: one of its faces mirrors each wave into the
/// solid, and the wave does not have an image in each face. (Three quarters, or seven eighths, of the sound do not
/// enter the solid.)
#[test]
fn edges_of_a_box_mirror_no_sound_twice() {
    let block = Surface::new(Cuboid { size: Vec3::ONE });
    let far_m = 50.0;
    let listeners = directions(1000);
    for (source, share) in [
        (Vec3::new(0.5, 0.5, 0.125), 0.75),
        (Vec3::splat(0.5), 0.875),
    ] {
        let arriving = listeners.iter().map(|direction| {
            let scene = scene(vec![block.clone()], source, *direction * far_m);
            let (paths, _) = by_planes(&scene, 3);
            let spreading: f64 = paths.iter().map(|path| path.spreading).sum();
            spreading * 4.0 * PI * f64::from(far_m).powi(2)
        });
        let mean = arriving.sum::<f64>() / listeners.len() as f64;
        assert!((mean - share).abs() < 0.02, "{source}: {mean}");
    }
}

/// Protects the loudness of a source or a listener at the foot of a box on the floor: the floor mirrors it once, and
/// the faces that end there do not mirror beyond their edges. This is tested for box and floor as one field and as two
/// surfaces.
#[test]
fn the_foot_of_a_box_is_mirrored_by_the_floor_alone() {
    let floor = HalfSpace {
        normal: Vec3::Y,
        offset: -0.5,
    };
    let (block, floor) = (Shape::from(Cuboid { size: Vec3::ONE }), Shape::from(floor));
    let scenes = [
        vec![Surface::new(block.clone()), Surface::new(floor.clone())],
        vec![Surface::new(Shape::union([block.clone(), floor.clone()]))],
        vec![Surface::new(Shape::union([floor, block]))],
    ];
    let foot = Vec3::new(0.5, -0.5, 0.5);
    for surfaces in scenes {
        for other in [
            Vec3::new(3.0, 2.0, 2.5),
            Vec3::new(3.0, 2.0, -2.5),
            Vec3::new(-2.0, 3.0, 2.5),
        ] {
            for (source, listener) in [(foot, other), (other, foot)] {
                let (paths, _) = by_planes(&scene(surfaces.clone(), source, listener), 3);
                assert_eq!(paths.len(), 2, "{source} to {listener}: {paths:?}");
            }
        }
    }
}

/// Protects the loudness of a source and a listener on one wall: the wall mirrors waves along it, just as it mirrors
/// waves at a small angle to it.
#[test]
fn a_wall_mirrors_what_flies_along_it() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    // Both ends on the floor; one end also in an edge of the floor; both ends in an edge.
    for (source, listener) in [
        (Vec3::new(-2.0, -1.5, 0.5), Vec3::new(3.0, -1.5, 1.25)),
        (Vec3::new(-4.0, -1.5, 0.5), Vec3::new(3.0, -1.5, 1.25)),
        (Vec3::new(-4.0, -1.5, 0.5), Vec3::new(-4.0, -1.5, 1.25)),
    ] {
        let lengths = |off: f32| {
            let room = vec![Surface::new(Room { size })];
            let off = Vec3::new(1.0, 1.0, 0.0) * off;
            let (paths, known) = by_planes(&scene(room, source + off, listener + off), 4);
            assert_eq!(known, 4);
            paths.iter().map(|p| p.length_m).collect::<Vec<f64>>()
        };
        let near = lengths(1e-4);
        // There are 1, 6, 18, 38 and 66 images with none to four reflections.
        assert_eq!(near.len(), 129);
        for off in [0.0, 1e-6] {
            let at = lengths(off);
            let apart = at.iter().zip(&near).map(|(a, b)| (a - b).abs());
            assert_eq!(at.len(), near.len(), "{source}, {off}");
            assert!(apart.fold(0.0, f64::max) < 1e-3, "{source}, {off}");
        }
    }
}

/// Protects a source on a turned wall, which is inside its solid by rounding: the source counts as on the wall.
#[test]
fn a_source_within_rounding_of_a_wall_is_on_it() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let mut inside = 0;
    for degrees in 1..40 {
        let turn = Quat::from_rotation_y((degrees as f32).to_radians());
        let room = Surface::new(Room { size }).turned(turn);
        let source = turn * Vec3::new(-4.0, 0.2, 0.3);
        inside += u32::from(room.distance(source) < 0.0);
        let scene = scene(vec![room], source, turn * Vec3::new(3.0, -0.3, 1.2));
        let early = EarlyPaths::new(&scene).expect("a valid scene");
        let ends = early.ends(scene.only_pair().unwrap());
        let mut candidates = Candidates::new(0);
        early.add_planes(&ends, 2, &mut candidates);
        assert_eq!(early.find(&ends, &candidates).paths.len(), 25, "{degrees}");
    }
    assert!(inside > 5, "{inside}");
}
