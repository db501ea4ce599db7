//! Compares the distance functions of the shaders with those of the CPU, for the same surfaces at the same points, on
//! every API.

use super::{parts_of, world_values};
use crate::gl::{Context, Program, RenderTarget, Texture, full_screen_pass};
use crate::scene::shape::{Cuboid, Cylinder, Plane, Room, Sphere};
use crate::shader::text::{distance_parts, link};
use crate::shader::{Lists, Source as Text, Structure, StructureKey, join};
use crate::test_common::for_each_api;
use crate::{Listener, Node, Scene, Source, Surface};
use glam::{EulerRot, Quat, Vec3};
use std::rc::Rc;

/// Maximum difference between shader and CPU, in units in the last place of the largest number in an evaluation.
/// Without a rotation there are about five operations (the offset, squares, a sum, a root, the radius). Each operation
/// has an error of half a unit on the CPU, and perhaps a larger one in a shader, because OpenGL hardly limits the error
/// of a square root. (Measured with llvmpipe: at most 0.9.)
const PLAIN_ULPS: f32 = 4.0;

/// The same for surfaces with a rotation, which adds two cross products with about ten operations. (Measured with
/// llvmpipe: at most 3.3.)
const TURNED_ULPS: f32 = 12.0;

const KINDS: usize = 5;

/// The number of a shape's kind. A new variant of [`Node`] requires an addition here: give the variant a number, raise
/// [`KINDS`], and add the shape to [`shapes`].
fn kind(shape: &Node) -> usize {
    match shape {
        Node::Plane(Plane) => 0,
        Node::Cuboid(_) => 1,
        Node::Room(_) => 2,
        Node::Sphere(_) => 3,
        Node::Cylinder(_) => 4,
        _ => unreachable!("other shapes have a table of their own, scene/shape/tests/table.rs"),
    }
}

/// Every kind of shape, in sizes from a pebble to a hall.
fn shapes() -> Vec<Node> {
    let cube = |size| {
        Node::Cuboid(Cuboid {
            size: Vec3::splat(size),
        })
    };
    let beam = Vec3::new(0.2, 20.0, 1.5);
    let hall = Vec3::new(30.0, 20.0, 30.0);
    vec![
        Node::Plane(Plane),
        cube(0.01),
        cube(4.0),
        Node::Cuboid(Cuboid { size: beam }),
        Node::Room(Room { size: hall }),
        Node::Room(Room { size: beam }),
        Node::Sphere(Sphere { radius: 0.01 }),
        Node::Sphere(Sphere { radius: 3.0 }),
        Node::Cylinder(Cylinder { radius: 0.05 }),
        Node::Cylinder(Cylinder { radius: 6.0 }),
    ]
}

/// Every shape unchanged, displaced, rotated, and both displaced and rotated; and one shape whose rotation may be
/// driven.
fn surfaces() -> Vec<Surface> {
    let place = Vec3::new(3.5, -7.25, 11.125);
    let turn = Quat::from_euler(EulerRot::XYZEx, 0.4, -1.1, 2.3);
    let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let placed = |shape: Node| {
        let plain = Surface::new(shape);
        let mut to_be_turned = plain.clone().at(place);
        to_be_turned.dynamic_rotation = true;
        vec![
            plain.clone(),
            plain.clone().at(place),
            plain.clone().turned(turn),
            plain.clone().at(-place).turned(turn),
            plain.at(place).turned(quarter),
            to_be_turned,
        ]
    };
    shapes().into_iter().flat_map(placed).collect()
}

/// Points in world coordinates: the origin of the surface's own axes, points in many directions at distances from 1 mm
/// to 300 m (inside, near and far), and points on the surface.
fn points(surface: &Surface) -> Vec<Vec3> {
    let mut local = vec![Vec3::ZERO];
    for direction in directions() {
        for length in [0.001, 0.02, 0.3, 1.0, 2.5, 6.0, 15.0, 80.0, 300.0] {
            local.push(direction * length);
        }
        local.push(on_surface(&surface.shape.node, direction));
    }
    let to_world = |p: Vec3| surface.position + surface.rotation * p;
    local.into_iter().map(to_world).collect()
}

/// The axes, the diagonals, and asymmetric directions.
fn directions() -> Vec<Vec3> {
    let mut directions = Vec::new();
    for x in -1..=1 {
        for y in -1..=1 {
            for z in -1..=1 {
                let step = Vec3::new(x as f32, y as f32, z as f32);
                directions.extend(step.try_normalize());
                let skew = step + Vec3::new(0.37, -0.21, 0.13);
                directions.push(skew.normalize());
            }
        }
    }
    directions
}

fn on_surface(shape: &Node, direction: Vec3) -> Vec3 {
    match *shape {
        Node::Plane(Plane) => direction.with_y(0.0) * 10.0,
        Node::Cuboid(Cuboid { size }) | Node::Room(Room { size }) => {
            let half = size * 0.5;
            direction * (half / direction.abs()).min_element()
        }
        Node::Sphere(Sphere { radius }) => direction * radius,
        Node::Cylinder(Cylinder { radius }) => {
            let ring = direction.with_y(0.0).try_normalize().unwrap_or(Vec3::X);
            ring * radius + Vec3::Y * direction.y * 5.0
        }
        _ => unreachable!("other shapes have a table of their own, scene/shape/tests/table.rs"),
    }
}

fn scene_of(surface: Surface) -> Scene {
    Scene::new(
        "one surface",
        vec![surface],
        Source::at(Vec3::ZERO),
        Listener::at(Vec3::new(1.0, 2.0, -3.0), 0.75),
    )
}

/// The shaders' results at a point.
struct Answer {
    surface: f32,
    surface_object: f32,
    any: f32,
    any_object: f32,
}

const EVALUATE: &str = "
uniform highp sampler2D uPoints;
layout(location = 0) out vec4 outAnswer;
void main() {
    copyUniforms();
    vec3 p = texelFetch(uPoints, ivec2(gl_FragCoord.xy), 0).xyz;
    float surfaceObject;
    float anyObject;
    float surface = surfaceDistance(p, surfaceObject);
    float any = distanceFunction(p, anyObject);
    outAnswer = vec4(surface, surfaceObject, any, anyObject);
}
";

fn shader(context: &Context, scene: &Scene) -> Program {
    let roots = vec![Text::new("evaluate", EVALUATE)];
    let sources = link(
        roots,
        parts_of(scene, Lists::NearestCandidates, distance_parts),
    );
    Program::fragment(context, "evaluate", &join(&sources)).unwrap()
}

fn evaluate(context: &Context, program: &Program, scene: &Scene, points: &[Vec3]) -> Vec<Answer> {
    let width = 64;
    let height = (points.len() as u32).div_ceil(width);
    let mut texels: Vec<f32> = points.iter().flat_map(|p| [p.x, p.y, p.z, 0.0]).collect();
    texels.resize(4 * (width * height) as usize, 0.0);
    let input = Texture::new(context, width, height).unwrap();
    input.upload(&texels).unwrap();
    let output = Texture::new(context, width, height).unwrap();
    let target = RenderTarget::new(context, &[&output]).unwrap();
    program.set_texture("uPoints", 0, &input);
    let values = world_values(scene, Lists::NearestCandidates);
    program.set_vec4_array("uSurfaces", &values);
    let listener = scene.listeners[0]
        .position
        .extend(scene.listeners[0].radius);
    program.set_vec4("uListener", listener);
    full_screen_pass(context, program, &target, width, height).unwrap();
    let read = target.read(0).unwrap();
    let answer = |&[surface, surface_object, any, any_object]: &[f32; 4]| Answer {
        surface,
        surface_object,
        any,
        any_object,
    };
    let answers = read.as_chunks::<4>().0.iter().map(answer);
    answers.take(points.len()).collect()
}

/// One unit in the last place of the largest number in an evaluation at `point`.
fn unit(surface: &Surface, point: Vec3) -> f32 {
    let size = match surface.shape.node {
        Node::Cuboid(Cuboid { size }) | Node::Room(Room { size }) => 0.5 * size.length(),
        Node::Sphere(Sphere { radius }) | Node::Cylinder(Cylinder { radius }) => radius,
        _ => 0.0,
    };
    f32::EPSILON * (point.length() + surface.position.length() + size)
}

/// Protects the list of test surfaces: it contains each kind of shape unchanged, displaced and rotated. The test fails
/// for a shape that exists only in Rust, or whose two implementations are not compared.
#[test]
fn every_shape_is_in_the_list() {
    type Form = fn(&Surface) -> bool;
    let forms: [(&str, Form); 4] = [
        ("as it is", |s| {
            !s.has_rotation() && s.position == Vec3::ZERO
        }),
        ("displaced", |s| {
            !s.has_rotation() && s.position != Vec3::ZERO
        }),
        ("turned", |s| s.rotation != Quat::IDENTITY),
        ("to be turned", |s| {
            s.dynamic_rotation && s.rotation == Quat::IDENTITY
        }),
    ];
    for (name, form) in forms {
        let mut found = [false; KINDS];
        for surface in surfaces().iter().filter(|s| form(s)) {
            found[kind(&surface.shape.node)] = true;
        }
        assert_eq!(found, [true; KINDS], "{name}");
    }
}

/// Protects the shader of each shape: in the solid, on the surface and in the air it computes the same function as the
/// CPU, for every position and rotation.
#[test]
fn shaders_and_cpu_agree_on_every_shape() {
    for_each_api(|context| {
        let mut compiled: Vec<(Rc<StructureKey>, Program)> = Vec::new();
        for surface in surfaces() {
            let points = points(&surface);
            let scene = scene_of(surface);
            let surface = &scene.surfaces[0];
            let structure = Structure::of(&scene, Lists::NearestCandidates).key;
            if !compiled.iter().any(|(known, _)| *known == structure) {
                compiled.push((structure.clone(), shader(context, &scene)));
            }
            let (_, program) = compiled.iter().find(|(s, _)| *s == structure).unwrap();
            let answers = evaluate(context, program, &scene, &points);
            let ulps = if surface.has_rotation() {
                TURNED_ULPS
            } else {
                PLAIN_ULPS
            };
            let mut sides = [false; 2];
            for (&point, answer) in points.iter().zip(&answers) {
                let cpu = scene.surface_distance(point);
                let bound = ulps * unit(surface, point);
                let gap = (answer.surface - cpu.distance).abs();
                let shader = answer.surface;
                assert!(
                    gap <= bound,
                    "{surface:?} at {point}: {shader} in the shader, {} here; {gap} > {bound}",
                    cpu.distance
                );
                assert_eq!(answer.surface_object, 1.0);
                sides[usize::from(cpu.distance > 0.0)] = true;
            }
            // The points must cover both the air and the solid.
            assert_eq!(sides, [true; 2], "{surface:?}");
        }
    });
}

/// Protects the nearest object: shader and CPU return the same object, unless two objects are equally near within
/// rounding.
#[test]
fn shaders_and_cpu_name_the_same_nearest_object() {
    for_each_api(|context| {
        for name in crate::scene::Scene::BUILTIN_NAMES {
            let scene = Scene::builtin(name).unwrap();
            // Other shapes have a table of their own, scene/shape/tests/table.rs.
            if scene.surfaces.iter().any(|s| !s.shape.is_basic()) {
                continue;
            }
            let program = shader(context, &scene);
            let mut points: Vec<Vec3> = scene.surfaces.iter().flat_map(points).collect();
            let around = directions().into_iter();
            points.extend(
                around.map(|d| scene.listeners[0].position + 1.1 * scene.listeners[0].radius * d),
            );
            let answers = evaluate(context, &program, &scene, &points);
            let mut named = vec![false; scene.surfaces.len() + 1];
            for (&point, answer) in points.iter().zip(&answers) {
                let unit = scene.surfaces.iter().map(|s| unit(s, point));
                let bound = TURNED_ULPS * unit.fold(0.0, f32::max);
                let mut distances: Vec<f32> =
                    scene.surfaces.iter().map(|s| s.distance(point)).collect();
                distances.push(scene.listeners[0].distance(point));
                distances.sort_by(f32::total_cmp);
                let cpu = scene.only_pair().unwrap().distance(point);
                let gap = (answer.any - cpu.distance).abs();
                assert!(gap <= bound, "{name} at {point}: {gap} > {bound}");
                if distances[1] - distances[0] > 2.0 * bound {
                    assert_eq!(answer.any_object, cpu.object as f32, "{name} at {point}");
                    named[cpu.object as usize] = true;
                }
            }
            // Every object was the nearest at some point, so the test covers all of them.
            assert!(named.iter().all(|&n| n), "{name}: {named:?}");
        }
    });
}
