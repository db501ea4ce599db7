//! Compares the shader texts of scenes with golden files, and tests rules for their contents.
//!
//! `ECHOMARCH_UPDATE_GOLDEN=1` rewrites `tests/golden/shaders/`. The golden files contain the text that is generated
//! for the scene, but only the names of included files under `glsl/`.

use crate::scene::shape::{
    CappedCylinder, Capsule, Cone, Cuboid, Cylinder, Ellipsoid, GeneralQuadric, Grid, HalfSpace,
    HeightField, Hyperboloid, Offset, Paraboloid, Plane, Prism, Room, RoundedBox, SmoothUnion,
    Sphere, Torus, Translate, User,
};
use crate::scene::{Driver, HeightImage, Motion, Node, SampledField, Shape, UserField};
use crate::tracer::{Pass, shader_text};
use crate::{Listener, Profile, Scene, Settings, Source, Surface};
use glam::{UVec2, UVec3, Vec2, Vec3};
use std::path::PathBuf;
use std::sync::Arc;

fn scene(surfaces: Vec<Surface>) -> Scene {
    Scene::new(
        "text",
        surfaces,
        Source::at(Vec3::Y * 5.0),
        Listener::at(Vec3::Z * 9.0, 1.0),
    )
}

fn user() -> Node {
    let text = "const float R = 1.0;\nfloat field(vec3 p) { return length(p) - R; }\n";
    let field = UserField::new("my.glsl", text.to_owned(), Vec3::splat(3.0), 2.0);
    Node::User(User {
        field: Arc::new(field),
    })
}

fn over(node: Node, of: Vec<Shape>) -> Shape {
    Shape { node, children: of }
}

fn tree() -> Shape {
    let ball = Shape::from(Node::Sphere(Sphere { radius: 1.0 }));
    let moved = over(Node::Translate(Translate { by: Vec3::X }), vec![ball]);
    let block = Shape::from(Node::Cuboid(Cuboid {
        size: Vec3::splat(1.5),
    }));
    over(
        Node::SmoothUnion(SmoothUnion { radius: 0.25 }),
        vec![block, moved],
    )
}

fn moving() -> Surface {
    let mut surface = Surface::new(over(
        Node::Offset(Offset { by: 0.1 }),
        vec![Shape::from(Node::Torus(Torus {
            ring: 2.0,
            tube: 0.5,
        }))],
    ));
    surface.drivers.push(Driver {
        parameter: "0.tube".into(),
        motion: Motion::Keys(vec![(0.0, 0.5), (1.0, 1.0)]),
    });
    surface
}

/// Name, scene and profile of each golden file.
fn golden() -> Vec<(&'static str, Scene, Profile)> {
    let ball = || Surface::new(Node::Sphere(Sphere { radius: 1.0 }));
    let torus = Node::Torus(Torus {
        ring: 2.0,
        tube: 0.5,
    });
    vec![
        ("sphere-hybrid", scene(vec![ball()]), Profile::Hybrid),
        ("sphere-march", scene(vec![ball()]), Profile::March),
        ("sphere-thesis", scene(vec![ball()]), Profile::Thesis),
        (
            "torus-hybrid",
            scene(vec![Surface::new(torus)]),
            Profile::Hybrid,
        ),
        (
            "tree-march",
            scene(vec![Surface::new(tree())]),
            Profile::March,
        ),
        ("moving-thesis", scene(vec![moving()]), Profile::Thesis),
        (
            "user-hybrid",
            scene(vec![Surface::new(user())]),
            Profile::Hybrid,
        ),
    ]
}

/// The text, with included files under `glsl/` replaced by their names.
fn written(text: &str) -> String {
    let mut out = String::new();
    let mut is_file = false;
    for line in text.lines() {
        if let Some((number, name)) = line.strip_prefix("// ").and_then(|l| l.split_once(": "))
            && number.parse::<u32>().is_ok()
        {
            is_file = name.starts_with("glsl/");
            // The numbers are left out, because they change with every file that is added or removed before them.
            out += &format!("// {name}\n");
        } else if !is_file && !line.starts_with("#line") {
            out += line;
            out.push('\n');
        }
    }
    out
}

/// Protects generated text from unnoticed changes.
#[test]
fn texts_match_the_golden_ones() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden/shaders");
    let update = std::env::var_os("ECHOMARCH_UPDATE_GOLDEN").is_some();
    for (name, scene, profile) in golden() {
        scene.check().unwrap();
        let text = written(&shader_text(&scene, &Settings::new(profile), Pass::March));
        let file = folder.join(format!("{name}.glsl"));
        if update {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&file, &text).unwrap();
        }
        let golden = std::fs::read_to_string(&file).unwrap_or_default();
        let differs = text
            .lines()
            .zip(golden.lines())
            .find(|(new, old)| new != old);
        assert!(
            text == golden,
            "{name}: {differs:?}; if this is intended, ECHOMARCH_UPDATE_GOLDEN=1 writes it anew"
        );
    }
}

/// Protects the shader in the documents: it equals the shader of the scene `corner`.
#[test]
fn the_documented_shader_is_that_of_corner() {
    let page = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs/shader-of-corner.md");
    let settings = Settings::new(Profile::Hybrid);
    let text = shader_text(&Scene::builtin("corner").unwrap(), &settings, Pass::March);
    let stated = std::fs::read_to_string(&page).unwrap();
    let (before, _) = stated.split_once("```glsl\n").unwrap();
    let whole = format!("{before}```glsl\n{text}```\n");
    if std::env::var_os("ECHOMARCH_UPDATE_GOLDEN").is_some() {
        std::fs::write(&page, &whole).unwrap();
    } else {
        assert!(
            stated == whole,
            "docs/shader-of-corner.md is outdated; if this is intended, ECHOMARCH_UPDATE_GOLDEN=1 writes it anew"
        );
    }
}

/// Every shape, as a basic shape or a field.
fn shapes() -> Vec<Shape> {
    let size = Vec3::new(1.0, 2.0, 3.0);
    let heights = HeightImage::new("h", UVec2::splat(2), vec![0.0, 0.5, 0.5, 1.0]).unwrap();
    let values = vec![1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0, -1.0];
    let samples = SampledField::new("s", UVec3::splat(2), 1.0, values).unwrap();
    let (radius, height) = (1.0, 2.0);
    let nodes = [
        Node::Plane(Plane),
        Node::HalfSpace(HalfSpace {
            normal: size,
            offset: 1.0,
        }),
        Node::Cuboid(Cuboid { size }),
        Node::Room(Room { size }),
        Node::RoundedBox(RoundedBox {
            size,
            rounding: 0.25,
        }),
        Node::Sphere(Sphere { radius }),
        Node::Cylinder(Cylinder { radius }),
        Node::CappedCylinder(CappedCylinder { radius, height }),
        Node::Capsule(Capsule { radius, height }),
        Node::Torus(Torus {
            ring: 2.0,
            tube: 0.5,
        }),
        Node::Cone(Cone { radius, height }),
        Node::Prism(Prism {
            corners: [Vec2::ZERO, Vec2::X, Vec2::Y],
            depth: 1.0,
        }),
        Node::Ellipsoid(Ellipsoid { radii: size }),
        Node::Paraboloid(Paraboloid { focal_length: 1.0 }),
        Node::Hyperboloid(Hyperboloid {
            waist: 1.0,
            rise: 1.0,
            two_sheets: false,
        }),
        Node::GeneralQuadric(GeneralQuadric {
            coefficients: [1.0, 1.0, 1.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0],
        }),
        Node::HeightField(HeightField {
            image: Arc::new(heights),
            size,
        }),
        Node::Grid(Grid {
            field: Arc::new(samples),
        }),
        user(),
    ];
    let mut shapes: Vec<Shape> = nodes.into_iter().map(Shape::from).collect();
    let basic = [
        Node::Plane(Plane),
        Node::Cuboid(Cuboid { size }),
        Node::Room(Room { size }),
        Node::Sphere(Sphere { radius }),
        Node::Cylinder(Cylinder { radius }),
    ];
    shapes.extend(basic.map(Shape::from));
    shapes
}

/// The shapes that another shape uses.
fn building_blocks(name: &str) -> &'static [&'static str] {
    match name {
        // The bounds of these shapes are boxes.
        "RoundedBox" | "HeightField" | "Grid" | "Field" => &["Box"],
        // A capsule has balls as its ends.
        "Capsule" => &["Sphere"],
        "CappedCylinder" => &["Cylinder"],
        _ => &[],
    }
}

/// Protects specialisation: the shader of a scene contains only functions of the shapes in the scene.
#[test]
fn a_scene_of_one_shape_names_no_other() {
    let all = shapes();
    for shape in &all {
        let own = shape.name();
        let scene = scene(vec![Surface::new(shape.clone())]);
        scene.check().unwrap();
        for profile in Profile::ALL {
            let text = shader_text(&scene, &Settings::new(profile), Pass::March);
            let others = all.iter().map(Shape::name).filter(|other| *other != own);
            for other in others.filter(|other| !building_blocks(own).contains(other)) {
                let named = if other == "Field" { "User" } else { other };
                for prefix in ["sd", "gd", "hit", "gradient", "project"] {
                    let function = format!("{prefix}{named}(");
                    assert!(!text.contains(&function), "{own}, {profile}: {function}");
                }
            }
        }
    }
}

/// Protects the printed text from differing from the compiled text. Both contain only those numbers of the scene that
/// are literals of fields.
#[test]
fn the_text_needs_no_renderer_and_tells_its_files() {
    let scene = scene(vec![Surface::new(user())]);
    for profile in Profile::ALL {
        let text = shader_text(&scene, &Settings::new(profile), Pass::March);
        assert!(text.contains(": my.glsl\n#line 1 "), "{profile}");
        assert!(text.contains("#define R user0_R\n") && text.contains("#undef R\n"));
    }
}
