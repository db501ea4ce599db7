//! Draws the pictures of `docs/scene-format.md`: one for each shape and operator, from its notation in a scene file,
//! and one for each built-in scene that contains them.
//!
//! `cargo run --release --features picture --example shape_pictures` writes `docs/images/shapes/*.png`. With names after
//! `--` it writes only the pictures with these names.

use echomarch::gl::{Context, ContextOptions};
use echomarch::picture::{ViewOptions, first_person, save_png};
use echomarch::scene::shape::{Grid, HeightField};
use echomarch::scene::{HeightImage, Node, SampledField, SceneError, Shape, Surface};
use echomarch::{Error, Scene};
use glam::{UVec2, UVec3, Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

/// File name, the text of `shape:`, and the position of the camera.
type Picture = (&'static str, &'static str, Eye);

/// Camera position of a picture.
#[derive(Clone, Copy)]
enum Eye {
    /// In front of a shape that stands on a floor.
    Outside,
    /// In front of a shape that stands on a floor, at a greater distance.
    Far,
    /// In the air inside a shape.
    Inside,
}

use Eye::{Far, Inside, Outside};

const SHAPES: &[Picture] = &[
    ("plane", "Plane", Outside),
    (
        "half-space",
        "HalfSpace(normal: (1, 2, 0), offset: -1.2)",
        Outside,
    ),
    ("box", "Box(size: (2.4, 1.6, 1.6))", Outside),
    ("room", "Room(size: (7, 4, 7))", Inside),
    (
        "rooms",
        "Rooms(of: [(from: (-3.5, -2, -2), to: (3.5, 2, 3.5)), (from: (-1, -2, -2.3), to: (0.2, 0.6, -2)), (from: (-3, -2, -6), to: (4, 1.5, -2.3))])",
        Inside,
    ),
    (
        "rounded-box",
        "RoundedBox(size: (2.4, 1.6, 1.6), rounding: 0.4)",
        Outside,
    ),
    ("sphere", "Sphere(radius: 1.2)", Outside),
    ("cylinder", "Cylinder(radius: 0.7)", Outside),
    (
        "cylinder-capped",
        "Cylinder(radius: 0.7, height: 3, axis: (1, 0.4, 0))",
        Outside,
    ),
    ("capsule", "Capsule(radius: 0.7, height: 1.4)", Outside),
    ("torus", "Torus(ring: 1.3, tube: 0.4)", Outside),
    ("cone", "Cone(radius: 1.2, height: 2.6)", Outside),
    (
        "prism",
        "Prism(corners: [(-1.3, -1), (1.3, -1), (0.4, 1.1)], depth: 1.6)",
        Outside,
    ),
    ("ellipsoid", "Ellipsoid(radii: (1.6, 0.8, 1))", Outside),
    (
        "paraboloid",
        "Intersection(of: [Translate(of: Paraboloid(focal_length: 0.25), by: (0, -1.2, 0)), Box(size: (9, 2.4, 9))])",
        Outside,
    ),
    (
        "hyperboloid",
        "Intersection(of: [Hyperboloid(waist: 0.6, rise: 0.7), Box(size: (9, 2.6, 9))])",
        Outside,
    ),
    (
        "hyperboloid-two-sheets",
        "Intersection(of: [Hyperboloid(waist: 0.6, rise: 0.35, sheets: 2), Box(size: (9, 2.6, 9))])",
        Outside,
    ),
    (
        "quadric",
        "Intersection(of: [Quadric((1, 0, -1, 0, 0, 0, 0, 1, 0, 0)), Cylinder(radius: 1.3, height: 2.6)])",
        Outside,
    ),
    (
        "union",
        "Union(of: [Sphere(radius: 1), Translate(of: Box(size: (1.2, 1.2, 1.2)), by: (1.1, 0.2, 0.3))])",
        Outside,
    ),
    (
        "intersection",
        "Intersection(of: [Sphere(radius: 1.3), Box(size: (2, 2, 2))])",
        Outside,
    ),
    (
        "difference",
        "Difference(from: Box(size: (2, 2, 2)), cut: [Sphere(radius: 1.3)])",
        Outside,
    ),
    (
        "complement",
        "Complement(of: Union(of: [Sphere(radius: 3.6), Cylinder(radius: 1.2, axis: Z)]))",
        Inside,
    ),
    (
        "shell",
        "Difference(from: Shell(of: Sphere(radius: 1.2), thickness: 0.25), cut: [Translate(of: Box(size: (3, 3, 3)), by: (1.5, 1.5, 1.5))])",
        Outside,
    ),
    (
        "smooth-union",
        "SmoothUnion(of: [Sphere(radius: 0.9), Translate(of: Sphere(radius: 0.7), by: (1.4, 0.3, 0)), Translate(of: Sphere(radius: 0.5), by: (-1.3, -0.2, 0.4))], radius: 0.9)",
        Outside,
    ),
    (
        "offset",
        "Offset(of: Prism(corners: [(-1, -0.7), (1, -0.7), (0, 0.8)], depth: 0.8), by: 0.3)",
        Outside,
    ),
    (
        "translate",
        "Union(of: [Sphere(radius: 0.4), Translate(of: Box(size: (1, 1, 1)), by: (1.2, 0.7, 0))])",
        Outside,
    ),
    (
        "rotate",
        "Rotate(of: Box(size: (2.4, 1, 1)), by: (0, 20, 35))",
        Outside,
    ),
    (
        "scale",
        "Union(of: [Translate(of: Torus(ring: 0.5, tube: 0.2), by: (-1, -0.8, 0)), Translate(of: Scale(of: Torus(ring: 0.5, tube: 0.2), by: 2), by: (0.7, 0.2, 0))])",
        Outside,
    ),
    (
        "mirror",
        "Mirror(of: Translate(of: Rotate(of: Cone(radius: 0.5, height: 2), by: (0, 0, -35)), by: (1.1, 0, 0.7)), axes: \"xz\")",
        Outside,
    ),
    (
        "repeat",
        "Repeat(of: Cylinder(radius: 0.3, height: 2.6), period: (1.5, 0, 1.5), count: (9, 1, 9))",
        Far,
    ),
    (
        "elongate",
        "Elongate(of: Torus(ring: 0.6, tube: 0.3), by: (0.9, 0, 0))",
        Outside,
    ),
    (
        "twist",
        "Twist(of: Box(size: (1.4, 2.6, 1.4)), rate: 40)",
        Outside,
    ),
    (
        "bend",
        "Bend(of: Box(size: (3.2, 0.7, 0.9)), rate: 30)",
        Outside,
    ),
    (
        "morph",
        "Morph(from: Box(size: (2, 2, 2)), to: Sphere(radius: 1.2), amount: 0.5)",
        Outside,
    ),
    (
        "field",
        "Scale(of: Field(file: \"examples/scenes/menger.glsl\", lipschitz: 1, size: (4.2, 4.2, 4.2)), by: 0.6)",
        Outside,
    ),
];

/// Position (metres), yaw and pitch (degrees) of the camera.
type Gaze = (Vec3, f32, f32);

/// Built-in scenes, and the camera if it differs from the listener.
const SCENES: &[(&str, Option<Gaze>)] = &[
    (
        "whispering-gallery",
        Some((Vec3::new(9.0, 1.0, 0.0), -90.0, -5.0)),
    ),
    (
        "parabolic-mirrors",
        Some((Vec3::new(2.0, 6.0, 22.0), -3.0, -15.0)),
    ),
    ("colonnade", Some((Vec3::new(0.5, 1.0, 8.0), -18.0, -6.0))),
    ("cave", Some((Vec3::new(-10.8, 0.8, 2.6), 65.0, -6.0))),
    ("morphing-room", None),
    ("menger", Some((Vec3::new(5.5, 2.2, 5.0), -46.0, -15.0))),
    ("glasshouse", Some((Vec3::new(9.0, 0.3, 0.3), -90.0, -3.0))),
];

fn main() -> Result<(), Error> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    let context = Context::headless(&ContextOptions::default())?;
    let images = Path::new("docs/images");
    let save = |scene: &Scene, name: &str, size: (u32, u32)| {
        let options = ViewOptions {
            width: size.0,
            height: size.1,
            field_of_view: 50f32.to_radians(),
        };
        let picture = first_person(&context, scene, &options)?;
        let path = images.join(name).with_extension("png");
        println!("{}", path.display());
        Ok::<(), Error>(save_png(&path, &picture)?)
    };
    for (name, shape, eye) in SHAPES.iter().filter(|(name, ..)| is_wanted(name)) {
        save(&stage(shape, *eye)?, &format!("shapes/{name}"), (200, 150))?;
    }
    if is_wanted("height-field") {
        let mut scene = stage("Plane", Far)?;
        let size = Vec3::new(7.0, 1.6, 7.0);
        let image = Arc::new(hills());
        scene.surfaces[0] =
            Surface::new(Shape::from(Node::HeightField(HeightField { image, size })));
        save(&scene, "shapes/height-field", (200, 150))?;
    }
    if is_wanted("grid") {
        let mut scene = stage("Plane", Outside)?;
        let field = Arc::new(knot());
        scene.surfaces[0] = Surface::new(Shape::from(Node::Grid(Grid { field })));
        save(&scene, "shapes/grid", (200, 150))?;
    }
    for (name, eye) in SCENES.iter().filter(|(name, ..)| is_wanted(name)) {
        let mut scene = Scene::builtin(name)?.at(2.0);
        if let Some((position, yaw, pitch)) = eye {
            scene.listeners[0].position = *position;
            scene.listeners[0].yaw = yaw.to_radians();
            scene.listeners[0].pitch = pitch.to_radians();
        }
        save(&scene, name, (400, 225))?;
    }
    Ok(())
}

/// A scene with a shape, a light, and a floor for a shape that is seen from outside.
fn stage(shape: &str, eye: Eye) -> Result<Scene, SceneError> {
    let (eye, gaze, light, floor) = match eye {
        Outside => (
            Vec3::new(2.6, 1.9, 4.2),
            Vec3::ZERO,
            Vec3::new(4.0, 7.0, 3.0),
            true,
        ),
        Far => (
            Vec3::new(4.5, 4.0, 7.5),
            Vec3::new(0.0, -0.7, 0.0),
            Vec3::new(5.0, 9.0, 4.0),
            true,
        ),
        Inside => (
            Vec3::new(0.9, 0.4, 3.0),
            Vec3::new(-0.8, -0.2, -3.0),
            Vec3::new(0.9, 1.2, -0.4),
            false,
        ),
    };
    // The floor is another plane, which would hide a plane.
    let floor = match floor && shape != "Plane" {
        true => ", Surface(shape: Plane, position: (0, -1.3, 0))",
        false => "",
    };
    let ahead = (gaze - eye).normalize();
    let text = format!(
        "Scene(surfaces: [Surface(shape: {shape}){floor}], source: Source(position: ({}, {}, {})), listener: Listener(position: ({}, {}, {}), radius: 0.5, yaw: {}, pitch: {}))",
        light.x,
        light.y,
        light.z,
        eye.x,
        eye.y,
        eye.z,
        ahead.x.atan2(-ahead.z).to_degrees(),
        ahead.y.asin().to_degrees(),
    );
    Scene::from_ron(&text, shape)
}

/// Hills as the sum of a few sine waves, with 65 x 65 heights.
fn hills() -> HeightImage {
    const SIDE: u32 = 65;
    let heights = (0..SIDE * SIDE).map(|index| {
        let x = (index % SIDE) as f32 / (SIDE - 1) as f32;
        let z = (index / SIDE) as f32 / (SIDE - 1) as f32;
        let wave = (7.0 * x + 2.0 * z).sin() + (9.0 * z - 3.0 * x).cos();
        (0.5 + 0.2 * wave).clamp(0.0, 1.0)
    });
    let image = HeightImage::new("hills", UVec2::splat(SIDE), heights.collect());
    image.unwrap_or_else(|error| panic!("{error}"))
}

/// Two rings through each other, sampled every 10 cm.
fn knot() -> SampledField {
    const SIDE: u32 = 33;
    const CELL_M: f32 = 0.1;
    let ring = |along: Vec2, across: f32| Vec2::new(along.length() - 0.8, across).length() - 0.25;
    let value = |index: u32| {
        let place = UVec3::new(index / (SIDE * SIDE), index / SIDE % SIDE, index % SIDE);
        let p = (place.as_vec3() - 0.5 * (SIDE - 1) as f32) * CELL_M;
        let (one, other) = (p + Vec3::X * 0.4, p - Vec3::X * 0.4);
        ring(Vec2::new(one.x, one.z), one.y).min(ring(Vec2::new(other.x, other.y), other.z))
    };
    let values = (0..SIDE * SIDE * SIDE).map(value).collect();
    let field = SampledField::new("knot", UVec3::splat(SIDE), CELL_M, values);
    field.unwrap_or_else(|error| panic!("{error}"))
}
