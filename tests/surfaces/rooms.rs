//! Rooms of boxes of air, beside their walls as triangles in `f64`, and beside the same rooms as other shapes.

use super::common::flights::{assert_no_wave_leaves, compare_paths};
use super::common::{Random, tracer};
use echomarch::geometry::ExactScene;
use echomarch::glam::{DVec3, Vec3};
use echomarch::scene::mesh::MeshError;
use echomarch::scene::shape::{AirBox, Cuboid, Room, Rooms};
use echomarch::{Listener, Profile, Scene, Settings, Shape, Source, Surface};

/// The profiles that intersect lines with the walls.
const EXACT: [Profile; 2] = [Profile::Hybrid, Profile::March];

fn air(name: &str, from: [f32; 3], to: [f32; 3]) -> AirBox {
    AirBox {
        name: name.to_owned(),
        from: from.into(),
        to: to.into(),
    }
}

fn surface(boxes: impl IntoIterator<Item = AirBox>) -> Surface {
    Surface::new(Rooms::new(boxes).expect("rooms"))
}

/// A room of an L, 3 m high: 6 m × 6 m without a quarter, as two boxes that share a face.
fn l_shaped() -> [AirBox; 2] {
    [
        air("wide", [-3.0, -1.5, 0.0], [3.0, 1.5, 3.0]),
        air("wing", [-3.0, -1.5, -3.0], [0.0, 1.5, 0.0]),
    ]
}

fn scene(name: &str, surfaces: Vec<Surface>) -> Scene {
    let source = Source::at(Vec3::new(-1.3, 0.21, 1.07));
    let listener = Listener::at(Vec3::new(-1.9, -0.4, -1.6), 0.3);
    Scene::new(name, surfaces, source, listener)
}

/// A row of rooms of random sizes with doorways of random places between them.
fn row_of_rooms(random: &mut Random, count: usize) -> Vec<AirBox> {
    let mut within = |low: f64, high: f64| (low + (high - low) * random.unit()) as f32;
    let mut boxes = Vec::new();
    let mut x = -2.5;
    let [mut low, mut high] = [-2.0, 2.2];
    for _ in 0..count {
        let end = x + within(2.5, 5.0);
        let [from, to] = [[x, -1.0, low], [end, within(1.3, 1.9), high]];
        boxes.push(air("", from, to));
        let next = [within(-2.5, -0.9), within(1.0, 2.7)];
        let (left, right) = (low.max(next[0]), high.min(next[1]));
        let begin = within(left.into(), f64::from(right) - 0.9);
        let wall = within(0.05, 0.4);
        boxes.push(air("", [end, -1.0, begin], [end + wall, 1.1, begin + 0.9]));
        [low, high] = next;
        x = end + wall;
    }
    boxes.push(air("", [x, -1.0, low], [x + 3.0, 1.6, high]));
    boxes
}

/// Protects joined rooms from their description: waves in the room of an L are those in a complement of overlapping
/// boxes, and those in a room with a solid block.
#[test]
fn waves_in_rooms_are_those_in_other_shapes() {
    let wing = |x: f32, z: f32, at: Vec3| {
        let size = Vec3::new(x, 3.0, z);
        Shape::from(Cuboid { size }).translate(at)
    };
    let wings = [
        wing(6.0, 3.0, Vec3::Z * 1.5),
        wing(3.0, 6.0, Vec3::X * -1.5),
    ];
    let block = Surface::new(Cuboid {
        size: Vec3::splat(3.0),
    });
    let others = [
        vec![Surface::new(Shape::union(wings).complement())],
        vec![
            Surface::new(Room {
                size: Vec3::new(6.0, 3.0, 6.0),
            }),
            block.at(Vec3::new(1.5, 0.0, -1.5)),
        ],
    ];
    let rooms = scene("rooms", vec![surface(l_shaped())]);
    let directions = Random(4).directions(20_000);
    let start = rooms.sources[0].position.as_dvec3();
    let mut tracer = tracer();
    for shapes in others {
        let exact = ExactScene::new(&scene("shapes", shapes)).expect("a valid scene");
        for profile in EXACT {
            let settings = Settings::new(profile).with_iterations(6);
            let states = tracer.trace_directions(&rooms, &settings, &directions);
            let mut differ = 0;
            for wave in &states.expect("a frame")[6] {
                let truth = exact.trace(start, wave.start_direction.as_dvec3(), 6);
                let is_heard = (wave.status == 0.0) == (truth.status == 0);
                let off = wave.position.as_dvec3().distance(truth.point);
                differ += u32::from(!is_heard || off > 3e-5);
                assert!(wave.status >= 0.0, "{profile}: {wave:?}");
            }
            // At an edge rounding decides which of two faces a wave meets.
            assert!(differ <= 12, "{profile}: {differ} of 20000 waves differ");
        }
    }
}

/// Protects the shaders from the reference and the reverse: waves through rows of rooms, which are moved and rotated, end
/// on the walls as triangles in `f64`.
#[test]
fn waves_in_rows_of_rooms_are_those_of_the_reference() {
    let mut random = Random(17);
    for count in [1, 2, 5] {
        let boxes = row_of_rooms(&mut random, count);
        let turn = echomarch::glam::Quat::from_rotation_y(0.4);
        let at = Vec3::new(0.31, -0.17, 0.23);
        for placed in [
            surface(boxes.clone()),
            surface(boxes.clone()).at(at).turned(turn),
        ] {
            let scene = scene("row", vec![placed]);
            let directions = random.directions(8_000);
            compare_paths(&scene, &directions, &EXACT, 1);
            compare_paths(&scene, &directions[..2_000], &EXACT, 3);
        }
    }
}

/// Protects rooms from leaks: no wave leaves, is lost at an open face, or reaches a limit of steps after many
/// reflections.
#[test]
fn no_wave_leaves_rooms() {
    let mut random = Random(5);
    let mut tracer = tracer();
    for boxes in [l_shaped().to_vec(), row_of_rooms(&mut random, 4)] {
        let scene = scene("rooms", vec![surface(boxes)]);
        assert_no_wave_leaves(&mut tracer, &scene, &EXACT, (60, 65_536));
    }
}

/// Protects distances: the sign is that of the boxes, also where they share a face, and no surface is nearer than the
/// value.
#[test]
fn the_distance_has_the_sign_of_the_boxes() {
    let mut random = Random(8);
    let boxes = row_of_rooms(&mut random, 3);
    let rooms = surface(boxes.clone()).shape;
    let is_air = |p: DVec3| {
        let within =
            |of: &AirBox| p.cmpge(of.from.as_dvec3()).all() && p.cmple(of.to.as_dvec3()).all();
        boxes.iter().any(within)
    };
    for _ in 0..20_000 {
        let p = DVec3::new(
            20.0 * random.unit() - 4.0,
            4.0 * random.signed(),
            5.0 * random.signed(),
        );
        let value = rooms.value(p);
        assert_eq!(value > 0.0, is_air(p), "{value} at {p}");
        let near = p + 0.999 * value.abs() * random.direction();
        assert_eq!(is_air(near), is_air(p), "{value} at {p}");
    }
    let [one, door, ..] = &boxes[..] else {
        panic!()
    };
    let open = 0.5 * (door.from + door.to).with_x(2.0 * one.to.x);
    assert!(rooms.value(open.as_dvec3()) > 0.4);
}

/// Protects volume and area, which follow from the union: overlaps count once.
#[test]
fn volume_and_area_are_those_of_the_union() {
    let overlapping = [
        air("", [0.0; 3], [4.0, 3.0, 5.0]),
        air("", [3.0, 0.0, 0.0], [8.0, 3.0, 2.0]),
    ];
    let rooms = Rooms::new(overlapping).expect("rooms");
    assert!((rooms.volume_m3() - 3.0 * (20.0 + 8.0)).abs() < 1e-4);
    let outline = 2.0 * (8.0 + 5.0);
    assert!((rooms.area_m2() - (2.0 * 28.0 + 3.0 * outline)).abs() < 1e-4);
}

/// Protects users from boxes without a sense: each is refused with its name or its place.
#[test]
fn impossible_rooms_are_refused() {
    let refused = |boxes: Vec<AirBox>| Rooms::new(boxes).expect_err("refused");
    let cube = |x: f32, y: f32| air("", [x, y, 0.0], [x + 1.0, y + 1.0, 1.0]);
    assert_eq!(
        refused(vec![]),
        MeshError::BadBoxCount { count: 0, most: 42 }
    );
    let row = (0..43).map(|index| cube(index as f32, 0.0));
    assert_eq!(
        refused(row.collect()),
        MeshError::BadBoxCount {
            count: 43,
            most: 42
        }
    );
    let flat = refused(vec![air("flat", [0.0; 3], [1.0, 0.0, 1.0])]);
    assert!(
        flat.to_string().contains("the box \"flat\" of Rooms"),
        "{flat}"
    );
    let endless = refused(vec![air("", [0.0; 3], [1.0, f32::INFINITY, 1.0])]);
    assert!(
        endless.to_string().contains("the box \"1\" of Rooms"),
        "{endless}"
    );
    let twice = refused(vec![
        air("hall", [0.0; 3], [1.0; 3]),
        air("hall", [1.0, 0.0, 0.0], [2.0, 1.0, 1.0]),
    ]);
    assert!(twice.to_string().contains("\"hall\""), "{twice}");
    let place = DVec3::new(1.0, 1.0, 0.0);
    let pinched = refused(vec![cube(0.0, 0.0), cube(1.0, 1.0)]);
    assert_eq!(pinched, MeshError::Pinched { place });
    assert!(Rooms::new([cube(0.0, 0.0), cube(1.0, 1.0), cube(1.0, 0.0)]).is_ok());
}
