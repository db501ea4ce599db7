//! Sound behind walls in the late part of responses.

use super::of_wave;
use crate::bands::{BAND_COUNT, Bands};
use crate::geometry::ExactScene;
use crate::response::{Arrival, PathKind, Response, ResponseSettings};
use crate::scene::mesh::tests::box_faces;
use crate::scene::mesh::{MeshOptions, TriangleMesh};
use crate::scene::shape::{AirBox, Cuboid, Mesh, Prism, Room, Rooms};
use crate::scene::{Directivity, Material, Transmission};
use crate::test_common::tracer;
use crate::tracer::{ArrivalSettings, Detector, FarEnd, SolidHit, Transmitting, WavesToFollow};
use crate::{Listener, Scene, Settings, Source, Surface};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

/// Two rooms of 4.9 × 5 × 5 m with a wall of 0.2 m between them, and the source in the middle of the first.
const SIZE: Vec3 = Vec3::new(10.0, 5.0, 5.0);
const WALL_M: f32 = 0.2;

/// Absorption of a wall. It differs from those of other walls, because equal materials share a number in shaders that
/// do not transmit.
const WALL_ABSORPTION: f64 = 0.12;

/// Number of waves: the noise of an energy behind a wall is about 0.1 dB.
const WAVES: u32 = 1 << 15;

/// Area of the wall, and of all surfaces of one of the rooms, in m².
const WALL_M2: f64 = 25.0;
const ROOM_M2: f64 = 2.0 * 25.0 + 4.0 * 24.5;

/// A leaf `thickness` metres thick whose centre is at `x`. Its edges lie in the solid around the rooms.
fn leaf(x: f32, thickness: f32) -> Surface {
    let size = Vec3::new(thickness, SIZE.y + 1.0, SIZE.z + 1.0);
    Surface::new(Cuboid { size })
        .at(Vec3::new(x, 0.0, 0.0))
        .with_material("wall")
}

/// The two rooms with these leaves between them. The other walls absorb `absorption`.
fn rooms(leaves: Vec<Surface>, wall: Material, absorption: f64) -> Scene {
    let mut surfaces = vec![Surface::new(Room { size: SIZE }).with_material("plaster")];
    surfaces.extend(leaves);
    let source = Source::at(Vec3::new(-2.55, 0.1, -0.1));
    let listener = Listener::at(Vec3::new(2.6, 0.3, -0.2), 0.3);
    let mut scene = Scene::new("rooms", surfaces, source, listener);
    let plaster = Material::absorbing(absorption).scattering_by(0.5);
    scene.materials.insert("plaster".to_owned(), plaster);
    scene.materials.insert("wall".to_owned(), wall);
    scene
}

/// A wall of this sound reduction index in decibels.
fn reduced_by(index_db: f64) -> Material {
    let transmission = Transmission::reduced_by(index_db, f64::from(WALL_M));
    Material::absorbing(WALL_ABSORPTION)
        .scattering_by(0.5)
        .transmitting(transmission)
}

fn in_first_room(mut scene: Scene) -> Scene {
    scene.listeners[0].position = Vec3::new(-4.0, -1.1, 1.2);
    scene
}

fn respond(scene: &Scene, seconds: f64) -> Response {
    let settings = ResponseSettings::default()
        .with_seconds(seconds)
        .with_trace(Settings::default().with_waves(WAVES));
    Response::trace(&mut tracer(), scene, &settings).expect("a response")
}

fn db(ratio: f64) -> f64 {
    10.0 * ratio.log10()
}

/// Protects the stationary energies of two coupled rooms, which follow from the balance of powers: with the absorption
/// areas A₁ and A₂, of which Sτ each are the wall's transmission, c E₂ A₂ = c E₁ Sτ and c E₁ A₁ − c E₂ Sτ = 4 P.
#[test]
fn coupled_rooms_have_the_energies_of_the_balance_of_powers() {
    for (index_db, absorption) in [(10.0, 0.1), (20.0, 0.1), (35.0, 0.1), (35.0, 0.3)] {
        let wall = Material {
            absorption: [absorption; BAND_COUNT],
            ..reduced_by(index_db)
        };
        let scene = rooms(vec![leaf(0.0, WALL_M)], wall, absorption);
        let through = WALL_M2 * 10_f64.powf(-0.1 * index_db);
        let area = ROOM_M2 * absorption;
        let first = in_first_room(scene.clone());
        let apart = first.sources[0]
            .position
            .distance(first.listeners[0].position);
        let expected = 4.0 / (area - through * through / area);
        let direct = 1.0 / (4.0 * PI * f64::from(apart).powi(2));
        let found = [first, scene].map(|scene| respond(&scene, 2.0).energy()[4]);
        // The reverberation begins after the first reflection.
        let off_db = [
            db(found[0] / (expected * (1.0 - absorption) + direct)),
            db(found[1] / (expected * through / area)),
        ];
        let are_near = off_db.iter().all(|off| off.abs() < 0.5);
        assert!(are_near, "{index_db} dB, {absorption}: {off_db:?} dB");
    }
}

/// Protects silence behind walls that let less than −40 dB through: only the exact path passes them.
#[test]
fn only_the_direct_path_passes_a_wall_of_60_db() {
    let scene = rooms(vec![leaf(0.0, WALL_M)], reduced_by(60.0), 0.1);
    let response = respond(&scene, 0.5);
    assert_eq!(response.echogram.total(), [0.0; BAND_COUNT]);
    let kinds: Vec<PathKind> = response.paths.iter().map(|path| path.kind).collect();
    assert_eq!(kinds, [PathKind::Transmitted]);
}

/// Two rooms whose surfaces reflect nothing, with a wall of 10 dB.
fn rooms_without_reflections() -> Scene {
    let wall = Material {
        absorption: [1.0; BAND_COUNT],
        ..reduced_by(10.0)
    };
    rooms(vec![leaf(0.0, WALL_M)], wall, 1.0)
}

/// Protects the direct way through a wall from being counted twice: without any reflection, the exact path is all.
#[test]
fn sound_straight_through_a_wall_is_counted_once() {
    let response = respond(&rooms_without_reflections(), 0.5);
    assert_eq!(response.paths.len(), 1);
    assert_eq!(response.echogram.total(), [0.0; BAND_COUNT]);
}

/// Protects the energy of waves that pass a wall, and the directivity of their source: without any reflection the energy
/// is that of the exact path, here three times that of an omnidirectional source.
#[test]
fn waves_bring_the_energy_of_the_transmitted_path() {
    let mut scene = rooms_without_reflections();
    let source = scene.sources[0].clone();
    let source = source.with_directivity(Directivity::CARDIOID);
    scene.sources[0] = source.pointing_along(Vec3::X).unwrap();
    let expected = respond(&scene, 0.1).paths[0].energy[4];
    scene.listeners[0].radius = 1.0;
    let exact = ExactScene::new(&scene).unwrap();
    let through = |hit: &SolidHit| of_wave(&scene, &exact, hit);
    let (mut sum, mut crossings) = (0.0, 0.0_f64);
    let mut passed = |arrival: Arrival| {
        assert!(arrival.reflections == 0 && !arrival.is_early);
        sum += arrival.energy[4];
        crossings += 1.0;
    };
    let transmitting = Transmitting {
        through: &through,
        take: &mut passed,
    };
    let settings = Settings::default().with_waves(1 << 17);
    let waves = WavesToFollow::Numbers(0..settings.waves);
    let (pair, how) = (scene.only_pair().unwrap(), ArrivalSettings::new(0.1));
    let take = &mut |_| panic!("no wave from the source arrives");
    tracer()
        .arrivals_through(
            (pair, &[Detector::of(pair.listener)]),
            &settings,
            &how,
            &waves,
            take,
            Some(transmitting),
        )
        .unwrap();
    // Chords of a sphere vary by 35 %: five standard errors.
    let error = 5.0 * 1.06 / crossings.sqrt();
    assert!(error < 0.25, "{crossings}");
    assert!((sum / expected - 1.0).abs() < error, "{sum} for {expected}");
}

/// Protects split walls: solids in contact are one wall, and leaves with air between them multiply their shares. (The
/// leaves reflect nothing, because reflections between leaves add sound.)
#[test]
fn split_walls_pass_what_one_wall_passes() {
    let behind = |leaves: Vec<Surface>, index_db: f64, thickness: f32| {
        let transmission = Transmission::reduced_by(index_db, thickness.into());
        let wall = Material::absorbing(1.0).transmitting(transmission);
        let response = respond(&rooms(leaves, wall, 0.1), 0.7);
        response.echogram.total()[4]
    };
    let whole = behind(vec![leaf(0.0, 0.2)], 20.0, 0.2);
    let touching = behind(vec![leaf(-0.05, 0.1), leaf(0.05, 0.1)], 20.0, 0.2);
    let apart = behind(vec![leaf(-0.09, 0.02), leaf(0.09, 0.02)], 10.0, 0.02);
    let off_db = [db(touching / whole), db(apart / whole)];
    // The noise of waves that pass two leaves is 0.2 dB.
    assert!(off_db[0].abs() < 0.2 && off_db[1].abs() < 0.5, "{off_db:?}");
}

/// Protects meshes and `Rooms`: their solids pass what the same wall as a box passes, on the exact path and in the waves
/// of the late part.
#[test]
fn meshes_pass_what_boxes_pass() {
    let wall = reduced_by(10.0);
    let with_box = rooms(vec![leaf(0.0, WALL_M)], wall, 0.1);
    let size = Vec3::new(WALL_M, SIZE.y + 1.0, SIZE.z + 1.0).as_dvec3();
    let mesh = TriangleMesh::new("leaf", box_faces(size), MeshOptions::default());
    let mesh = Surface::new(Mesh {
        mesh: Arc::new(mesh.expect("a mesh")),
    });
    let with_mesh = rooms(vec![mesh.with_material("wall")], wall, 0.1);
    // All walls of `Rooms` have one material.
    let same = Material {
        absorption: [0.1; BAND_COUNT],
        ..wall
    };
    let mut one_material = rooms(vec![leaf(0.0, WALL_M)], same, 0.1);
    one_material.materials.insert("plaster".to_owned(), same);
    let half = 0.5 * SIZE;
    let air = |name: &str, from_x: f32, to_x: f32| AirBox {
        name: name.to_owned(),
        from: half.with_x(from_x) * Vec3::new(1.0, -1.0, -1.0),
        to: half.with_x(to_x),
    };
    let boxes = [
        air("first", -half.x, -0.5 * WALL_M),
        air("second", 0.5 * WALL_M, half.x),
    ];
    let mut as_rooms = one_material.clone();
    let both = Surface::new(Rooms::new(boxes).expect("rooms"));
    as_rooms.surfaces = vec![both.with_material("wall")];
    for (one, other) in [(&with_box, &with_mesh), (&one_material, &as_rooms)] {
        let [one, other] = [one, other].map(|scene| respond(scene, 1.5));
        let late_db = db(other.echogram.total()[4] / one.echogram.total()[4]);
        assert!(late_db.abs() < 0.3, "{late_db} dB");
        assert_eq!(one.paths[0].kind, PathKind::Transmitted);
        let path_db = db(other.paths[0].energy[4] / one.paths[0].energy[4]);
        assert!(path_db.abs() < 1e-3, "{path_db} dB");
    }
}

/// The far end of a hit at x = −0.1, at this angle.
fn far_end(leaves: Vec<Surface>, wall: Material, degrees: f64) -> Option<FarEnd> {
    let scene = rooms(leaves, wall, 0.1);
    let exact = ExactScene::new(&scene).unwrap();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let direction = DVec3::new(cos, 0.6 * sin, 0.8 * sin);
    let hit = SolidHit {
        surface: 2,
        point: DVec3::new(-0.1, 0.2, -0.3),
        direction,
    };
    of_wave(&scene, &exact, &hit)
}

/// Protects the way through a wall: it ends on the far side, at the surface of the last solid in contact, and the share
/// is that of the wall at any angle, at most the absorption.
#[test]
fn waves_leave_a_wall_on_its_far_side() {
    let near =
        |share: Bands, expected: f64| share.iter().all(|s| (s / expected - 1.0).abs() < 1e-3);
    for degrees in [0.0_f64, 30.0, 60.0, 80.0] {
        let contact = vec![leaf(-0.05, 0.1), leaf(0.05, 0.1)];
        for (leaves, surface) in [(vec![leaf(0.0, 0.2)], 2), (contact, 3)] {
            let end = far_end(leaves, reduced_by(20.0), degrees);
            let end = end.expect("a far side");
            assert_eq!(end.surface, surface);
            assert!((end.point.x - 0.1).abs() < 1e-6, "{degrees}: {end:?}");
            assert!((end.length_m - 0.2).abs() < 1e-6);
            assert!((end.point - DVec3::new(0.1, 0.2, -0.3)).length() < 1e-6);
            assert!(near(end.share, 0.01), "{degrees}: {end:?}");
        }
    }
    // Leaves apart are passed one by one.
    let end = far_end(
        vec![leaf(-0.09, 0.02), leaf(0.09, 0.02)],
        reduced_by(30.0),
        0.0,
    );
    let end = end.expect("a far side");
    assert!((end.point.x + 0.08).abs() < 1e-6 && near(end.share, 0.1));
    // The absorption contains the transmission.
    let end = far_end(vec![leaf(0.0, 0.2)], reduced_by(3.0), 0.0);
    assert!(near(end.expect("a far side").share, WALL_ABSORPTION));
    let none = far_end(vec![leaf(0.0, 0.2)], reduced_by(40.1), 0.0);
    assert_eq!(none, None);
}

/// Protects solids whose far side is not opposite: the wave leaves a wedge in its own direction, and a short way
/// through the wedge's corner is not used where there is an upright one.
#[test]
fn waves_pass_wedges_in_their_own_direction() {
    let corners = [
        Vec2::new(0.0, 0.0),
        Vec2::new(1.0, 0.0),
        Vec2::new(0.0, 1.0),
    ];
    let wedge = Surface::new(Prism {
        corners,
        depth: 4.0,
    });
    let mut wedge = wedge.with_material("wall");
    let scene_of = |wedge: Surface| {
        let wall = Transmission::reduced_by(20.0, 0.5);
        rooms(
            vec![wedge],
            Material::absorbing(0.1).transmitting(wall),
            0.1,
        )
    };
    wedge.position = Vec3::ZERO;
    let scene = scene_of(wedge);
    let exact = ExactScene::new(&scene).unwrap();
    let end = |point: DVec3, direction: DVec3| {
        let hit = SolidHit {
            surface: 2,
            point,
            direction: direction.normalize(),
        };
        of_wave(&scene, &exact, &hit).expect("a far side").point
    };
    // Opposite (0, 0.5), the wave points out of the slanted face.
    let found = end(DVec3::new(0.0, 0.5, 0.1), DVec3::new(1.0, 0.2, 0.0));
    assert!(
        (found - DVec3::new(0.5, 0.5, 0.1)).length() < 1e-6,
        "{found}"
    );
    // Here it points into this face, and leaves through the bottom.
    let found = end(DVec3::new(0.0, 0.5, 0.1), DVec3::new(1.0, -2.0, 0.0));
    assert!(
        (found - DVec3::new(0.25, 0.0, 0.1)).length() < 1e-6,
        "{found}"
    );
}

/// Protects waves from leaving the rooms: a solid that reaches into the solid around a room has no far side there.
#[test]
fn nothing_passes_where_there_is_no_far_side() {
    let thick = leaf(3.0, 6.2);
    let none = far_end(vec![thick], reduced_by(1.0), 0.0);
    assert_eq!(none, None);
}

/// Protects the shader's passages: they lie on the surface of the wall, half of the hits of the wall that the
/// trace in `f64` finds.
#[test]
fn the_shader_records_half_of_the_hits() {
    let mut wall = reduced_by(20.0);
    wall.scattering = [0.0; BAND_COUNT];
    let mut scene = in_first_room(rooms(vec![leaf(0.0, WALL_M)], wall, 0.1));
    let plaster = Material::absorbing(0.1);
    scene.materials.insert("plaster".to_owned(), plaster);
    let pair = scene.only_pair().unwrap();
    let mut tracer = tracer();
    for settings in [Settings::hybrid(), Settings::march()] {
        let settings = settings.with_waves(20_000);
        let how = ArrivalSettings::new(10.0).with_iterations(12);
        let hits = Mutex::new(Vec::new());
        let through = |hit: &SolidHit| {
            hits.lock().unwrap().push(*hit);
            None
        };
        let waves = WavesToFollow::Numbers(0..settings.waves);
        let transmitting = Transmitting {
            through: &through,
            take: &mut |_| panic!("nothing passes"),
        };
        let take = &mut |_| ();
        tracer
            .arrivals_through(
                (pair, &[Detector::of(pair.listener)]),
                &settings,
                &how,
                &waves,
                take,
                Some(transmitting),
            )
            .unwrap();
        let hits = hits.into_inner().unwrap();
        for hit in &hits {
            assert_eq!(hit.surface, 2);
            assert!(
                (hit.point.x + 0.1).abs() < 1e-5 && hit.direction.x > 0.0,
                "{hit:?}"
            );
        }
        let mut without = scene.clone();
        without.listeners[0].position = Vec3::new(0.0, 0.0, 100.0);
        let exact = ExactScene::new(&without).unwrap();
        let starts = tracer.start_directions(&settings).unwrap();
        let source = scene.sources[0].position.as_dvec3();
        let of_wall: usize = starts
            .iter()
            .map(|start| {
                let path = exact.trace_path(source, start.as_dvec3(), 12);
                path.iter().filter(|vertex| vertex.object == 2).count()
            })
            .sum();
        let expected = of_wall as f64 / 2.0;
        // Five standard deviations of a binomial number.
        let error = 5.0 * (expected * 0.5).sqrt();
        let off = hits.len() as f64 - expected;
        assert!(off.abs() < error, "{} of {of_wall} hits", hits.len());
        assert!(expected > 1000.0);
    }
}

/// Protects the first room: its waves are the same with and without transmission, and what returns from the second room
/// is small. Also protects repeated responses from differences.
#[test]
fn transmission_leaves_the_waves_of_the_first_room_as_they_are() {
    let scene = in_first_room(rooms(vec![leaf(0.0, WALL_M)], reduced_by(20.0), 0.1));
    let settings = ResponseSettings::default()
        .with_seconds(0.4)
        .with_trace(Settings::default().with_waves(1 << 12));
    let mut tracer = tracer();
    let mut traced = |transmits: bool| {
        let settings = settings.clone().with_transmission(transmits);
        Response::trace(&mut tracer, &scene, &settings).expect("a response")
    };
    let (with, again, without) = (traced(true), traced(true), traced(false));
    assert_eq!(with.echogram, again.echogram);
    assert_eq!(with.paths, without.paths);
    // The energies of resampled waves are equal up to rounding, because materials that transmit have other numbers.
    let [mut with_counts, without_counts] = [with.counts, without.counts];
    for (with, without) in with_counts
        .energy_under_way
        .iter_mut()
        .zip(without_counts.energy_under_way)
    {
        assert!((*with / without - 1.0).abs() < 1e-12, "{with} {without}");
        *with = without;
    }
    assert_eq!(with_counts, without_counts);
    let returned = with.echogram.total()[4] / without.echogram.total()[4] - 1.0;
    let coupling = WALL_M2 * 0.01 / (ROOM_M2 * 0.1);
    assert!(
        returned > 0.0 && returned < 3.0 * coupling * coupling,
        "{returned}"
    );
    assert_eq!(with.echogram.bins(), without.echogram.bins());
}
