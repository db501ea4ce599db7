//! Tests of the energies of arrivals: absorption by materials, scattering, and conservation.

use super::arrivals::{arrivals, start_directions, without_listener};
use crate::bands::{BAND_COUNT, Bands};
use crate::gl::{Api, Context};
use crate::response::Arrival;
use crate::scene::Material;
use crate::scene::shape::{Cuboid, Plane, Room, Sphere};
use crate::test_common::{builtin, for_each_api, tracer};
use crate::tracer::{ArrivalSettings, TraceError, WavesToFollow};
use crate::{Error, Listener, Node, Scene, Settings, Source, Surface};
use glam::{DVec3, Quat, Vec3};

/// Absorption that differs between bands and between numbers.
fn absorption(number: usize) -> Bands {
    std::array::from_fn(|band| ((7 * number + 3 * band) % 11) as f64 / 20.0)
}

fn with_materials(mut scene: Scene, count: usize) -> Scene {
    for number in 0..count {
        let material = Material {
            absorption: absorption(number),
            ..Material::MIRROR
        };
        scene.materials.insert(format!("m{number}"), material);
    }
    scene
}

/// A rotated room with different walls. It contains a box, and balls in cells. Each wall and each object has its own
/// material.
fn furnished() -> Scene {
    let size = Vec3::new(12.0, 6.0, 10.0);
    let turn = Quat::from_rotation_y(0.3) * Quat::from_rotation_x(0.1);
    let mut room = Surface::new(Node::Room(Room { size })).turned(turn);
    for wall in 0..Room::WALL_COUNT {
        room = room.with_wall_material(wall, format!("m{wall}")).unwrap();
    }
    let block = Surface::new(Node::Cuboid(Cuboid { size: Vec3::ONE })).at(Vec3::new(2.0, 0.0, 2.0));
    let balls = (0..12).map(|i| {
        let place = Vec3::new((i % 6) as f32 - 2.5, (i / 6) as f32 - 0.5, -2.0);
        let ball = Surface::new(Node::Sphere(Sphere { radius: 0.3 })).at(place);
        ball.with_material(format!("m{}", 7 + i % 3))
    });
    let mut surfaces = vec![room, block.with_material("m6")];
    surfaces.extend(balls);
    let source = Source::at(Vec3::new(-4.0, 0.5, 0.3));
    let listener = Listener::at(Vec3::new(3.0, 0.2, -1.0), 0.8);
    with_materials(Scene::new("furnished", surfaces, source, listener), 10)
}

/// Nested rooms, each rotated a little more, whose walls all have different materials. They have more material numbers
/// than fit in uniforms. Sound stays in the intersection of the rooms, so it hits walls of all of them.
fn rooms_in_rooms() -> Scene {
    let size = Vec3::new(12.0, 6.0, 10.0);
    let room = |number: usize| {
        let by = number as f32;
        let turn = Quat::from_rotation_y(0.2 * by) * Quat::from_rotation_x(0.1 * by);
        let room = Surface::new(Node::Room(Room { size })).turned(turn);
        (0..Room::WALL_COUNT).fold(room, |room, wall| {
            room.with_wall_material(wall, format!("m{}", (5 * number + wall) % 23))
                .expect("a wall")
        })
    };
    let mut surfaces: Vec<Surface> = (0..11).map(room).collect();
    let block = Surface::new(Node::Cuboid(Cuboid { size: Vec3::ONE })).at(Vec3::new(1.0, 0.0, 1.0));
    surfaces.push(block.with_material("m22"));
    let source = Source::at(Vec3::new(-1.0, 0.5, 0.3));
    let listener = Listener::at(Vec3::new(0.5, 0.2, -1.0), 0.8);
    with_materials(Scene::new("rooms", surfaces, source, listener), 23)
}

/// The number of the wall of a room that has this normal.
fn wall(room: &Surface, normal: DVec3) -> usize {
    let inward = room.rotation.as_dquat().inverse() * normal;
    let axis = inward.abs().max_position();
    2 * axis + usize::from(inward[axis] < 0.0)
}

/// Protects each method by which a shader finds a material: for a wall of a rotated room, for an unrolled surface, for
/// a surface in cells, and for surfaces whose numbers are in a table. Also protects bands from being exchanged.
/// Compared with the same waves without materials, each arrival has the energy that remains after the previous
/// reflections, within an error of 1e-4 m of chord.
#[test]
fn each_reflection_takes_what_its_material_takes() {
    for_each_api(|context| {
        for scene in [furnished(), rooms_in_rooms()] {
            reflections_take(context, &scene);
        }
    });
}

fn reflections_take(context: &Context, scene: &Scene) {
    let mut bare = scene.clone();
    bare.materials.clear();
    for surface in &mut bare.surfaces {
        (surface.material, surface.walls) = (None, Default::default());
    }
    let mut tracer = crate::Tracer::new(context).unwrap();
    for settings in [Settings::hybrid(), Settings::march()] {
        let settings = settings.with_waves(12_000);
        let starts = start_directions(&mut tracer, scene, &settings);
        let how = ArrivalSettings::new(1000.0).with_iterations(6);
        let (mirrored, counts) = arrivals(&mut tracer, &bare, &settings, &how);
        let unit = 1.0 / (counts.open_volume_m3 * f64::from(settings.waves));
        let (all, _) = arrivals(&mut tracer, scene, &settings, &how);
        assert_eq!(all.len(), mirrored.len());
        let exact = without_listener(scene, Vec3::new(0.0, 0.0, 100.0));
        let from = scene.sources[0].position.as_dvec3();
        let mut compared = 0;
        for (arrival, bare) in all.iter().zip(&mirrored) {
            assert!((arrival.length_m - bare.length_m).abs() < 1e-4);
            let path = exact.trace_path(from, starts[arrival.wave as usize], 6);
            let mut length = 0.0;
            let mut expected = [1.0; BAND_COUNT];
            let mut place = from;
            for vertex in &path {
                length += vertex.point.distance(place);
                place = vertex.point;
                // The middle of the chord is within a radius of either end of a flight in the sphere.
                if length > arrival.length_m {
                    break;
                }
                let index = vertex.object as usize - 1;
                let surface = &scene.surfaces[index];
                let is_room = matches!(surface.shape.node, Node::Room(_));
                let wall = is_room.then(|| wall(surface, vertex.normal));
                let material = scene.material(index, wall).unwrap();
                let reflectance = material.reflectance();
                expected = std::array::from_fn(|band| expected[band] * reflectance[band]);
            }
            // The two programs may round a chord differently.
            let off = (0..BAND_COUNT).map(|band| {
                (arrival.energy[band] - bare.energy[band] * expected[band]).abs() / unit
            });
            // Balls multiply errors, so a wave that hits a ball may deviate from the exact wave.
            let is_same = off.fold(0.0, f64::max) < 1e-4;
            let is_ball = |object: u32| {
                let surface = &scene.surfaces[object as usize - 1];
                matches!(surface.shape.node, Node::Sphere(_))
            };
            let balls = path.iter().filter(|vertex| is_ball(vertex.object)).count();
            assert!(is_same || balls > 1, "{arrival:?} {bare:?} {expected:?}");
            compared += usize::from(is_same);
        }
        assert!(
            compared > 500 && 100 * compared > 98 * all.len(),
            "{compared} of {}",
            all.len()
        );
    }
}

/// Protects drivers with four outputs, and the division into chunks: neither changes an energy, except for the rounding
/// of the chord.
#[test]
fn few_outputs_and_short_chunks_take_the_same() {
    let mut tracer = tracer();
    let scene = furnished();
    let settings = Settings::hybrid().with_waves(2000);
    let mut traced = |outputs, chunk| {
        let how = ArrivalSettings {
            outputs,
            iterations_in_chunk: chunk,
            ..ArrivalSettings::new(1000.0).with_iterations(40)
        };
        arrivals(&mut tracer, &scene, &settings, &how)
    };
    let (expected, counts) = traced(8, 64);
    let unit = 1.0 / (counts.open_volume_m3 * 2000.0);
    for (outputs, chunk) in [(4, 64), (8, 3), (4, 1)] {
        let (found, other) = traced(outputs, chunk);
        assert_eq!(found.len(), expected.len());
        let sums = counts.energy_under_way.iter().zip(other.energy_under_way);
        for (a, b) in sums {
            assert!((a - b).abs() <= 1e-12 * a, "{a} {b}");
        }
        for (a, b) in found.iter().zip(&expected) {
            assert_eq!(a.wave, b.wave);
            for band in 0..BAND_COUNT {
                let off = (a.energy[band] - b.energy[band]).abs() / unit;
                assert!(off < 1e-4, "{a:?} {b:?}");
            }
        }
    }
}

/// Protects silence: with full absorption only the direct sound arrives.
#[test]
fn what_takes_all_silences() {
    let mut scene = builtin("shoebox");
    let deaf = Material::absorbing(1.0);
    scene.materials.insert("deaf".into(), deaf);
    scene.surfaces[0].material = Some("deaf".into());
    let settings = Settings::hybrid().with_waves(20_000);
    let (all, counts) = arrivals(&mut tracer(), &scene, &settings, &ArrivalSettings::new(0.5));
    assert_eq!(counts.energy_under_way, [0.0; BAND_COUNT]);
    let apart = f64::from(
        scene.sources[0]
            .position
            .distance(scene.listeners[0].position),
    );
    let radius = f64::from(scene.listeners[0].radius);
    assert!(!all.is_empty());
    for arrival in &all {
        // The middle of the chord is on the sphere whose diameter is the line from source to listener.
        assert!(arrival.is_early && arrival.length_m <= apart);
    }
    // The mean of 1 / 4π r² over the sphere is 1 + r²/5d² times the value at its centre (the Laplacian of 1/r² is
    // 2/r⁴). Fewer than 1 in 200 waves are heard, so five standard errors are 5 · √(200 / 20,000).
    let sum: f64 = all.iter().map(|arrival| arrival.energy[0]).sum();
    let expected = (1.0 + radius * radius / (5.0 * apart * apart))
        / (4.0 * std::f64::consts::PI * apart * apart);
    let error = 5.0 / (all.len() as f64).sqrt();
    assert!((sum / expected - 1.0).abs() < error, "{sum} {expected}");
}

fn room(material: Material) -> Scene {
    let mut scene = builtin("shoebox");
    scene.materials.insert("walls".into(), material);
    scene.surfaces[0].material = Some("walls".into());
    scene
}

/// Protects energy: without absorption no energy is lost, whether waves are mirrored or scattered.
///
/// In a room without absorption energy is evenly distributed. Of the L metres that a wave flies, L V / V_room lie in
/// the listener's sphere of volume V, and each metre counts 1 / (V N). The sum over all waves is therefore L / V_room.
/// A wave crosses the sphere π r² L / V_room times, with chords of 4/3 r ± 35 %. If crossings are independent, five
/// standard errors of the sum are 5 · 1.06 / √crossings.
#[test]
fn a_room_that_takes_nothing_keeps_all() {
    // Bands with different scattering are traced with separate waves.
    let differently: Bands = std::array::from_fn(|band| [0.0, 0.4, 1.0][band / 3]);
    let evenly = [0.0, 0.4, 1.0].map(|share| ([share; BAND_COUNT], 1));
    for (scattering, groups) in evenly.into_iter().chain([(differently, 3)]) {
        let scene = room(Material {
            scattering,
            ..Material::MIRROR
        });
        let settings = Settings::hybrid().with_waves(16_384);
        let (all, counts) = arrivals(&mut tracer(), &scene, &settings, &ArrivalSettings::new(1.2));
        assert_eq!(counts.flown, groups * 16_384);
        // The shares of scattered waves are accurate to 1e-6, and the energy factors compensate for the rounding.
        assert!(
            counts
                .energy_under_way
                .iter()
                .all(|e| (e - 1.0).abs() < 1e-4)
        );
        let (from, to) = (50.0, 400.0);
        for band in [0, 4, 7] {
            let late = all.iter().filter(|a| (from..to).contains(&a.length_m));
            let (mut sum, mut crossings) = (0.0, 0.0f64);
            for arrival in late.filter(|arrival| arrival.energy[band] > 0.0) {
                sum += arrival.energy[band];
                crossings += 1.0;
            }
            let expected = (to - from) / (12.0 * 6.0 * 16.0);
            let error = 5.0 * 1.06 / crossings.sqrt();
            assert!(error < 0.05, "{crossings}");
            assert!(
                (sum / expected - 1.0).abs() < error,
                "{scattering:?}, {band}: {sum} {expected}"
            );
        }
    }
}

/// Length in metres between that of the direct path and those of all other paths in the shoebox. The direct path is
/// 9.76 m long. The shortest path into the sphere over the floor or the ceiling is 11.4 m − 1.2 m long.
const DIRECT_M: f64 = 10.0;

/// Protects the share of scattered energy, even if bands scatter differently. In each band, the mean of mirrored and
/// scattered energy is that of the material, and mirrored and scattered waves each carry their part.
#[test]
fn scattering_takes_its_share() {
    let scattering: Bands = std::array::from_fn(|band| band as f64 / 8.0);
    let material = Material {
        scattering,
        ..Material::absorbing(0.25)
    };
    let settings = Settings::hybrid().with_waves(16_384);
    let how = ArrivalSettings::new(1.0).with_iterations(2);
    let (all, counts) = arrivals(&mut tracer(), &room(material), &settings, &how);
    // The energy after two reflections. With 16,384 waves, and two choices between energies of at most 1 ± 1 each, five
    // standard errors are less than 5 · √(2 / 16,384).
    for left in counts.energy_under_way {
        assert!((left / 0.75f64.powi(2) - 1.0).abs() < 0.055, "{left}");
    }
    let early = all.iter().filter(|arrival| arrival.is_early).count();
    assert!(early > 0 && early < all.len());
    // If all bands have the same waves, each wave has either its mirrored or its scattered energy after one reflection.
    let together = WavesToFollow::Numbers(0..settings.waves);
    let (mut mirrored, mut scattered) = (0, 0);
    let mut is_part = |arrival: Arrival| {
        if arrival.length_m < DIRECT_M {
            return;
        }
        let (part, count): (Bands, _) = match arrival.is_early {
            true => (scattering.map(|share| 1.0 - share), &mut mirrored),
            false => (scattering, &mut scattered),
        };
        *count += 1;
        let whole: f64 = arrival.energy.iter().sum::<f64>() / part.iter().sum::<f64>();
        for (energy, part) in arrival.energy.iter().zip(part) {
            assert!((energy / whole - part).abs() < 1e-9, "{arrival:?}");
        }
    };
    let scene = room(material);
    tracer()
        .arrivals_of(
            scene.only_pair().unwrap(),
            &settings,
            &how,
            &together,
            &mut is_part,
        )
        .unwrap();
    assert!(mirrored > 20 && scattered > 20, "{mirrored} {scattered}");
    let (all, _) = arrivals(
        &mut tracer(),
        &room(Material::MIRROR.scattering_by(1.0)),
        &settings,
        &how,
    );
    // All reflected sound was scattered.
    assert!(all.iter().all(|a| a.is_early == (a.length_m < DIRECT_M)));
}

/// Protects Lambert's law, by comparison with the integral over a fully scattering floor. Each floor element receives
/// cos θ / 4π a² of the power, and sends cos θ' / π b² of this power to the listener.
#[test]
fn a_floor_scatters_by_lamberts_law() {
    let source = Vec3::new(0.0, 2.0, 0.0);
    let place = Vec3::new(3.0, 1.0, 0.0);
    let mut scene = Scene::new(
        "floor",
        vec![Surface::new(Node::Plane(Plane)).with_material("rough")],
        Source::at(source),
        Listener::at(place, 0.4),
    );
    let rough = Material::MIRROR.scattering_by(1.0);
    scene.materials.insert("rough".into(), rough);
    let settings = Settings::hybrid().with_waves(1_600_000);
    let how = ArrivalSettings::new(1.0).with_iterations(3);
    let (all, counts) = arrivals(&mut tracer(), &scene, &settings, &how);
    assert_eq!(counts.waves, 1_600_000);
    assert!(all.iter().any(|arrival| arrival.wave > 262_144));
    let scattered = all.iter().filter(|arrival| !arrival.is_early);
    let (mut sum, mut crossings) = (0.0, 0.0f64);
    for arrival in scattered {
        sum += arrival.energy[0];
        crossings += 1.0;
    }
    let (side, half) = (0.02, 40.0);
    let steps = (2.0 * half / side) as i32;
    let mut expected = 0.0;
    for i in 0..steps {
        for k in 0..steps {
            let (x, z) = (
                (i as f64 + 0.5) * side - half,
                (k as f64 + 0.5) * side - half,
            );
            let a = DVec3::new(x, -2.0, z);
            let b = place.as_dvec3() - DVec3::new(x, 0.0, z);
            let (a2, b2) = (a.length_squared(), b.length_squared());
            let density = 2.0 / a2.sqrt() / (4.0 * std::f64::consts::PI * a2);
            expected += side * side * density * (b.y / b2.sqrt()) / (std::f64::consts::PI * b2);
        }
    }
    // The mean over the sphere differs from the value at its centre by about r²/10 of the second derivatives: (0.4 /
    // 1)² / 10 · 2.
    let error = 5.0 * 1.06 / crossings.sqrt() + 0.032;
    assert!(error < 0.12, "{crossings}");
    assert!(
        (sum / expected - 1.0).abs() < error,
        "{sum} {expected} {crossings}"
    );
}

/// Protects from invalid requests of arrivals: they are refused.
#[test]
fn what_cannot_be_traced_is_refused() {
    let scene = builtin("shoebox");
    let mut tracer = tracer();
    assert_eq!(tracer.context().api(), Api::Gl);
    let mut refused = |settings: &Settings, how: &ArrivalSettings| {
        let error = tracer.arrivals(&scene, settings, how, &mut |_| ());
        match error.unwrap_err() {
            Error::Trace(error) => error,
            other => panic!("{other}"),
        }
    };
    let how = ArrivalSettings::new(1.0);
    let thesis = refused(&Settings::thesis(), &how);
    assert!(matches!(thesis, TraceError::NoArrivals { .. }), "{thesis}");
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let bad = refused(&Settings::hybrid(), &ArrivalSettings::new(seconds));
        assert!(matches!(bad, TraceError::BadSetting { .. }), "{bad}");
    }
    let bad = refused(&Settings::hybrid(), &how.with_iterations(0));
    assert!(matches!(bad, TraceError::BadSetting { .. }), "{bad}");
}
