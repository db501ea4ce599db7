//! Triangle meshes beside the same rooms as shapes, and beside a search over all triangles in `f64`.

use super::common::flights::{assert_no_wave_leaves, compare_paths};
use super::common::{Random, tracer};
use echomarch::geometry::ExactScene;
use echomarch::glam::{DVec3, EulerRot, Quat, Vec3};
use echomarch::scene::mesh::{Inside, MeshFaces, MeshOptions, TriangleMesh};
use echomarch::scene::shape::{Cuboid, Mesh, Room, Sphere};
use echomarch::{Listener, Profile, Scene, Settings, Shape, Source, Surface};
use std::sync::Arc;

/// The profiles that intersect lines with the triangles.
const EXACT: [Profile; 2] = [Profile::Hybrid, Profile::March];

/// A mesh of an outline in the x-z plane, counterclockwise seen from above, between two heights. The caps are divided
/// into these triangles of the outline.
fn extruded(outline: &[(f64, f64)], caps: &[[u32; 3]], (low, high): (f64, f64)) -> MeshFaces {
    let count = outline.len() as u32;
    let at = |height: f64| outline.iter().map(move |(x, z)| DVec3::new(*x, height, *z));
    let mut triangles = Vec::new();
    for corner in 0..count {
        let next = (corner + 1) % count;
        triangles.push([corner, next, count + next]);
        triangles.push([corner, count + next, count + corner]);
    }
    for [a, b, c] in caps {
        triangles.push([*a, *c, *b]);
        triangles.push([count + a, count + b, count + c]);
    }
    MeshFaces {
        vertices: at(low).chain(at(high)).collect(),
        group_of: vec![0; triangles.len()],
        triangles,
        groups: vec!["wall".to_owned()],
        ..MeshFaces::default()
    }
}

/// A box about the origin.
fn cuboid(size: DVec3) -> MeshFaces {
    let (x, z) = (0.5 * size.x, 0.5 * size.z);
    let outline = [(-x, z), (x, z), (x, -z), (-x, -z)];
    extruded(
        &outline,
        &[[0, 1, 2], [0, 2, 3]],
        (-0.5 * size.y, 0.5 * size.y),
    )
}

/// A room of an L: 6 m × 6 m without a quarter of 3 m × 3 m, 3 m high.
fn l_room() -> MeshFaces {
    let outline = [
        (-3.0, 3.0),
        (3.0, 3.0),
        (3.0, 0.0),
        (0.0, 0.0),
        (0.0, -3.0),
        (-3.0, -3.0),
    ];
    let caps = [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]];
    extruded(&outline, &caps, (-1.5, 1.5))
}

/// The room of an L with a table top and a partition, each drawn as two faces in one place, whose quadrangles are
/// divided differently. The partition stands on the floor and ends at a wall.
fn l_room_with_sheets() -> MeshFaces {
    let mut faces = l_room();
    let table = [(-2.5, 0.5), (-0.75, 0.5), (-0.75, 2.0), (-2.5, 2.0)];
    let table = table.map(|(x, z)| DVec3::new(x, -0.75, z));
    let partition = [(-1.5, -3.0), (-1.5, -1.0), (1.5, -1.0), (1.5, -3.0)];
    let partition = partition.map(|(y, z)| DVec3::new(-1.0, y, z));
    for corners in [table, partition] {
        let first = faces.vertices.len() as u32;
        faces.vertices.extend(corners);
        let both = [[0, 1, 2], [0, 2, 3], [3, 1, 0], [3, 2, 1]];
        let placed = both.map(|triangle| triangle.map(|corner| first + corner));
        faces.triangles.extend(placed);
        faces.group_of.extend([0; 4]);
    }
    faces
}

/// A ball of triangles.
fn ball(radius: f64, rings: u32) -> MeshFaces {
    let around = 2 * rings;
    let mut faces = MeshFaces {
        groups: vec!["ball".to_owned()],
        ..MeshFaces::default()
    };
    for ring in 0..=rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for step in 0..around {
            let turn = std::f64::consts::TAU * f64::from(step) / f64::from(around);
            let is_pole = ring == 0 || ring == rings;
            let flat = if is_pole { 0.0 } else { polar.sin() * radius };
            faces.vertices.push(DVec3::new(
                flat * turn.cos(),
                radius * polar.cos(),
                flat * turn.sin(),
            ));
        }
    }
    for ring in 0..rings {
        for step in 0..around {
            let next = (step + 1) % around;
            let [a, b] = [step, next].map(|step| ring * around + step);
            let [c, d] = [step, next].map(|step| (ring + 1) * around + step);
            faces.triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    faces.group_of = vec![0; faces.triangles.len()];
    faces
}

fn surface(faces: MeshFaces, inside: Inside) -> Surface {
    let options = MeshOptions {
        inside: Some(inside),
        ..MeshOptions::default()
    };
    let mesh = TriangleMesh::new("test", faces, options).expect("a mesh");
    assert!(mesh.report().is_closed);
    Surface::new(Mesh {
        mesh: Arc::new(mesh),
    })
}

fn scene(name: &str, surfaces: Vec<Surface>) -> Scene {
    let source = Source::at(Vec3::new(-1.3, 0.21, 1.07));
    let listener = Listener::at(Vec3::new(-1.9, -0.4, -1.6), 0.3);
    Scene::new(name, surfaces, source, listener)
}

/// Protects rooms from their description: waves in a box, in a room of an L and in a room with a solid box are the same
/// in triangles as in shapes, in every profile that traces triangles exactly.
#[test]
fn waves_in_triangles_are_those_in_shapes() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let wing = |x: f32, z: f32, at: Vec3| {
        let size = Vec3::new(x, 3.0, z);
        Shape::from(Cuboid { size }).translate(at)
    };
    let wings = [
        wing(6.0, 3.0, Vec3::Z * 1.5),
        wing(3.0, 6.0, Vec3::X * -1.5),
    ];
    let l_shape = Shape::union(wings).complement();
    let pillar = Vec3::new(0.7, 1.0, 0.4);
    let place = Vec3::new(1.2, -0.3, 0.4);
    let room = || Surface::new(Room { size });
    let of_triangles = || surface(cuboid(size.as_dvec3()), Inside::Air);
    let block = surface(cuboid(pillar.as_dvec3()), Inside::Solid).at(place);
    let cases = [
        ("box", vec![of_triangles()], vec![room()]),
        (
            "L",
            vec![surface(l_room(), Inside::Air)],
            vec![Surface::new(l_shape)],
        ),
        (
            "block in a room",
            vec![room(), block.clone()],
            vec![room(), Surface::new(Cuboid { size: pillar }).at(place)],
        ),
        (
            "block and ball in a box",
            vec![of_triangles(), block, Surface::new(Sphere { radius: 0.6 })],
            vec![
                room(),
                Surface::new(Cuboid { size: pillar }).at(place),
                Surface::new(Sphere { radius: 0.6 }),
            ],
        ),
    ];
    let directions = Random(4).directions(20_000);
    let mut tracer = tracer();
    for (name, triangles, shapes) in cases {
        let exact = ExactScene::new(&scene(name, shapes.clone())).expect("a valid scene");
        let start = scene(name, shapes).sources[0].position.as_dvec3();
        for profile in EXACT {
            let settings = Settings::new(profile).with_iterations(6);
            let scene = scene(name, triangles.clone());
            let states = tracer
                .trace_directions(&scene, &settings, &directions)
                .expect("a frame");
            let mut differ = 0;
            for wave in &states[6] {
                let truth = exact.trace(start, wave.start_direction.as_dvec3(), 6);
                let off = wave.position.as_dvec3().distance(truth.point);
                // Each reflection by the ball multiplies the error of a direction.
                let most = 3e-5 * 20_f64.powi(truth.curved_hits.min(5) as i32);
                differ += u32::from(wave.status as i32 != truth.status || off > most);
                assert!(wave.status >= 0.0, "{name}, {profile}: {wave:?}");
            }
            // At an edge rounding decides which of two faces a wave meets.
            assert!(
                differ <= 12,
                "{name}, {profile}: {differ} of 20000 waves differ"
            );
        }
    }
}

/// Protects the shaders from the reference and the reverse: waves over edges and corners of a coarse ball, which is moved
/// and rotated, end on the exact surface or between the ends of neighbouring exact waves.
#[test]
fn waves_on_the_gpu_are_those_of_the_reference() {
    let turn = Quat::from_euler(EulerRot::XYZEx, 0.4, -1.1, 2.3);
    for (name, surfaces) in [
        (
            "hollow ball",
            vec![
                surface(ball(4.0, 9), Inside::Air)
                    .at(Vec3::new(-1.0, 0.5, 0.3))
                    .turned(turn),
            ],
        ),
        (
            "solid balls",
            vec![
                surface(ball(0.7, 12), Inside::Solid).at(Vec3::new(0.4, 0.5, 0.3)),
                surface(ball(0.5, 5), Inside::Solid)
                    .at(Vec3::new(-1.4, 0.1, -0.4))
                    .turned(turn),
            ],
        ),
    ] {
        let scene = scene(name, surfaces);
        let directions = Random(9).directions(6_000);
        compare_paths(&scene, &directions, &EXACT, 1);
    }
}

/// A triangle in `f64`, for a search over all triangles.
struct Triangle {
    corners: [DVec3; 3],
    normal: DVec3,
}

impl Triangle {
    /// Distance in metres of a line from the nearest line through an edge.
    fn edge_distance(&self, origin: DVec3, direction: DVec3) -> f64 {
        let [a, b, c] = self.corners;
        let distance = |(from, to): (DVec3, DVec3)| {
            let across = direction.cross(to - from).normalize_or_zero();
            across.dot(from - origin).abs()
        };
        let distances = [(a, b), (b, c), (c, a)].map(distance);
        distances.into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// The triangles of a room, with normals into the air.
fn triangles(faces: &MeshFaces) -> Vec<Triangle> {
    let of = |indices: &[u32; 3]| {
        let [a, b, c] = indices.map(|corner| faces.vertices[corner as usize]);
        Triangle {
            corners: [a, b, c],
            normal: -(b - a).cross(c - a).normalize(),
        }
    };
    faces.triangles.iter().map(of).collect()
}

/// The end of a wave after some reflections, by testing every triangle at every flight (Möller and Trumbore 1997), and
/// the least distance in metres of its line from an edge.
fn brute_force(all: &[Triangle], start: DVec3, direction: DVec3, flights: u32) -> (DVec3, f64) {
    /// Least length of a flight in metres, which skips the face that is left and the back of a sheet.
    const LEAST: f64 = 1e-9;
    let (mut o, mut d) = (start, direction.normalize());
    let mut margin = f64::INFINITY;
    for _ in 0..flights {
        let mut nearest: Option<(f64, &Triangle)> = None;
        let mut passed = Vec::new();
        for triangle in all.iter().filter(|triangle| triangle.normal.dot(d) < 0.0) {
            let [a, b, c] = triangle.corners;
            let (u, v) = (b - a, c - a);
            let p = d.cross(v);
            let s = (o - a) / u.dot(p);
            let q = s.cross(u);
            let (x, y, t) = (s.dot(p), d.dot(q), v.dot(q));
            let inside = x.min(y).min(1.0 - x - y);
            if t > LEAST {
                passed.push((t, triangle.edge_distance(o, d)));
            }
            if inside >= -1e-12 && t > LEAST && nearest.is_none_or(|known| t < known.0) {
                nearest = Some((t, triangle));
            }
        }
        let (t, triangle) = nearest.expect("no wave leaves a closed room");
        let edges = passed.iter().filter(|(at, _)| *at <= t);
        margin = edges.map(|(_, edge)| *edge).fold(margin, f64::min);
        o += t * d;
        d -= 2.0 * d.dot(triangle.normal) * triangle.normal;
    }
    (o, margin)
}

/// Protects the exact end of flights: every wave in a room of an L, empty or with sheets without thickness, ends where a
/// search over all triangles in `f64` ends, on the GPU and in the reference.
#[test]
fn waves_end_where_a_search_over_all_triangles_ends() {
    assert_ends_of_search("L", l_room());
    assert_ends_of_search("L with sheets", l_room_with_sheets());
}

fn assert_ends_of_search(name: &str, faces: MeshFaces) {
    const FLIGHTS: u32 = 10;
    /// Greatest error in metres of an end, by rounding.
    const OFF: f64 = 1e-4;
    let all = triangles(&faces);
    let mut scene = scene(name, vec![surface(faces, Inside::Air)]);
    scene.listeners[0].radius = 1e-3;
    let exact = ExactScene::new(&scene).expect("a valid scene");
    let start = scene.sources[0].position.as_dvec3();
    let directions = Random(2).directions(40_000);
    let mut tracer = tracer();
    for profile in EXACT {
        let settings = Settings::new(profile).with_iterations(FLIGHTS);
        let states = tracer
            .trace_directions(&scene, &settings, &directions)
            .expect("a frame");
        let mut near_edges = 0;
        for wave in &states[FLIGHTS as usize] {
            let d = wave.start_direction.as_dvec3();
            let (end, margin) = brute_force(&all, start, d, FLIGHTS);
            assert!(wave.status >= 0.0, "{name}, {profile}: {wave:?}");
            if wave.status < 0.5 {
                continue;
            }
            let truth = exact.trace(start, d, FLIGHTS);
            // At edges rounding decides: there the wave may be on the other side.
            if margin < OFF {
                near_edges += 1;
                continue;
            }
            assert!(truth.point.distance(end) < 1e-9, "{truth:?} {end}");
            let off = wave.position.as_dvec3().distance(end);
            assert!(
                off < OFF,
                "{name}, {profile}: {wave:?} is {off} m from {end}"
            );
        }
        assert!(near_edges < 400, "{name}: {near_edges}");
    }
}

/// Protects closed rooms from leaks: no wave leaves after many reflections, also among narrow triangles.
#[test]
fn no_wave_leaves_a_closed_mesh() {
    let mut tracer = tracer();
    for (name, faces) in [
        ("L", l_room()),
        ("L with sheets", l_room_with_sheets()),
        ("ball", ball(3.9, 17)),
        ("needles", ball(3.5, 90)),
    ] {
        let scene = scene(name, vec![surface(faces, Inside::Air)]);
        assert_no_wave_leaves(&mut tracer, &scene, &EXACT, (40, 32_768));
    }
}

/// Protects moving meshes from compilation: a mesh moves as a whole, with the text and the grid that it has.
#[test]
fn a_moved_mesh_compiles_nothing() {
    let block = surface(cuboid(DVec3::new(0.7, 1.0, 0.4)), Inside::Solid).turning();
    let room = Surface::new(Room {
        size: Vec3::new(8.0, 3.0, 5.0),
    });
    let mut scene = scene("moving", vec![room, block]);
    let mut tracer = tracer();
    let settings = Settings::hybrid().with_waves(4096).with_iterations(5);
    let mut frame = |scene: &Scene| {
        let (_, waves) = tracer.frame_with_waves(scene, &settings).expect("a frame");
        (waves, tracer.programs_compiled())
    };
    let (_, compiled) = frame(&scene);
    scene.surfaces[1].position = Vec3::new(1.5, 0.3, -0.2);
    scene.surfaces[1].rotation = Quat::from_rotation_y(0.6);
    let (moved, after) = frame(&scene);
    assert_eq!(after, compiled);
    let exact = ExactScene::new(&scene).expect("a valid scene");
    let start = scene.sources[0].position.as_dvec3();
    let same = moved.iter().filter(|wave| {
        let truth = exact.trace(start, wave.start_direction.as_dvec3(), 5);
        wave.status as i32 == truth.status && wave.position.as_dvec3().distance(truth.point) < 1e-4
    });
    assert!(same.count() > 4080);
}

/// Protects scenes from operators that would need a distance behind the faces: a mesh is a whole surface.
#[test]
fn a_mesh_is_no_operand() {
    let mesh = surface(cuboid(DVec3::ONE), Inside::Solid).shape;
    let scene = scene("shell", vec![Surface::new(mesh.shell(0.1))]);
    let refused = scene
        .validate()
        .expect_err("an operator over a mesh")
        .to_string();
    assert!(
        refused.contains("a Mesh is a whole surface, and no operand"),
        "{refused}"
    );
}
