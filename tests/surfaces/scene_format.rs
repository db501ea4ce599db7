//! The grammar of scene files: every shape, operator and driver from text to data, and what is
//! refused, where.

use echomarch::Scene;
use echomarch::scene::shape::{
    Bend, CappedCylinder, Capsule, Complement, Cone, Cuboid, Cylinder, Ellipsoid, GeneralQuadric,
    HalfSpace, HeightField, Hyperboloid, Paraboloid, Plane, Prism, Room, RoundedBox, Sphere, Torus,
    Twist, Union, User,
};
use echomarch::scene::{Driver, HeightImage, Motion, Node, Shape, UserField};
use glam::{UVec2, Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

/// A scene with one surface, of which `surface` says everything.
fn text(surface: &str) -> String {
    format!(
        "Scene(\n    surfaces: [Surface({surface})],\n    source: Source(position: (0, 50, 0)),\n    listener: Listener(position: (0, 60, 0), radius: 1),\n)\n"
    )
}

fn scene(surface: &str) -> Scene {
    let text = text(surface);
    Scene::from_ron(&text, "text").unwrap_or_else(|error| panic!("{surface}: {error}"))
}

fn shape(shape: &str) -> Shape {
    scene(&format!("shape: {shape}")).surfaces.remove(0).shape
}

fn refusal(surface: &str) -> String {
    let error = Scene::from_ron(&text(surface), "text").expect_err(surface);
    let sentence = error.to_string();
    assert!(!sentence.contains('\n'), "{sentence}");
    sentence
}

fn field(node: Node) -> Shape {
    Shape::from(node)
}

fn ball() -> Shape {
    field(Node::Sphere(Sphere { radius: 1.0 }))
}

fn block() -> Shape {
    let size = Vec3::new(1.0, 2.0, 3.0);
    field(Node::Cuboid(Cuboid { size }))
}

/// Protects the grammar: each shape and operator, from its text to the field that it says.
#[test]
fn every_node_is_read_from_a_file() {
    const BALL: &str = "Sphere(radius: 1)";
    const BLOCK: &str = "Box(size: (1, 2, 3))";
    let xyz = Vec3::new(1.0, 2.0, 3.0);
    let quarter = 90f32.to_radians();
    let shapes: [(&str, Node); 16] = [
        (
            "HalfSpace(normal: (1, 2, 3))",
            Node::HalfSpace(HalfSpace {
                normal: xyz,
                offset: 0.0,
            }),
        ),
        (
            "HalfSpace(normal: (1, 2, 3), offset: -2.5)",
            Node::HalfSpace(HalfSpace {
                normal: xyz,
                offset: -2.5,
            }),
        ),
        (
            "RoundedBox(size: (1, 2, 3), rounding: 0.25)",
            Node::RoundedBox(RoundedBox {
                size: xyz,
                rounding: 0.25,
            }),
        ),
        (
            "Cylinder(radius: 1, height: 4)",
            Node::CappedCylinder(CappedCylinder {
                radius: 1.0,
                height: 4.0,
            }),
        ),
        (
            "Cylinder(radius: 1, height: 4, axis: Y)",
            Node::CappedCylinder(CappedCylinder {
                radius: 1.0,
                height: 4.0,
            }),
        ),
        (
            "Capsule(radius: 1, height: 4)",
            Node::Capsule(Capsule {
                radius: 1.0,
                height: 4.0,
            }),
        ),
        (
            "Torus(ring: 3, tube: 1)",
            Node::Torus(Torus {
                ring: 3.0,
                tube: 1.0,
            }),
        ),
        (
            "Cone(radius: 1, height: 4)",
            Node::Cone(Cone {
                radius: 1.0,
                height: 4.0,
            }),
        ),
        (
            "Prism(corners: [(0, 0), (2, 0), (0, 1.5)], depth: 3)",
            Node::Prism(Prism {
                corners: [Vec2::ZERO, Vec2::new(2.0, 0.0), Vec2::new(0.0, 1.5)],
                depth: 3.0,
            }),
        ),
        (
            "Ellipsoid(radii: (1, 2, 3))",
            Node::Ellipsoid(Ellipsoid { radii: xyz }),
        ),
        (
            "Paraboloid(focal_length: 2)",
            Node::Paraboloid(Paraboloid { focal_length: 2.0 }),
        ),
        (
            "Hyperboloid(waist: 1, rise: 2)",
            Node::Hyperboloid(Hyperboloid {
                waist: 1.0,
                rise: 2.0,
                two_sheets: false,
            }),
        ),
        (
            "Hyperboloid(waist: 1, rise: 2, sheets: 2)",
            Node::Hyperboloid(Hyperboloid {
                waist: 1.0,
                rise: 2.0,
                two_sheets: true,
            }),
        ),
        (
            "Quadric((1, 2, 3, 0, 0.5, 0, 0, 0, -1, -4))",
            Node::GeneralQuadric(GeneralQuadric {
                coefficients: [1.0, 2.0, 3.0, 0.0, 0.5, 0.0, 0.0, 0.0, -1.0, -4.0],
            }),
        ),
        ("Union([Plane])", Node::Union(Union)),
        ("Complement(Plane)", Node::Complement(Complement)),
    ];
    for (text, node) in shapes {
        let read = shape(text);
        assert_eq!(read.node, node, "{text}");
    }
    let operators = [
        (
            format!("Union([{BALL}, {BLOCK}])"),
            Shape::union([ball(), block()]),
        ),
        (
            format!("Intersection([{BALL}, {BLOCK}])"),
            Shape::intersection([ball(), block()]),
        ),
        (
            format!("Difference(from: {BALL}, cut: [{BLOCK}, Plane])"),
            ball().minus([block(), field(Node::Plane(Plane))]),
        ),
        (format!("Complement({BLOCK})"), block().complement()),
        (
            format!("Shell(of: {BALL}, thickness: 0.5)"),
            ball().shell(0.5),
        ),
        (
            format!("SmoothUnion(of: [{BALL}, {BLOCK}], radius: 0.5)"),
            Shape::smooth_union(0.5, [ball(), block()]),
        ),
        (format!("Offset(of: {BALL}, by: -0.5)"), ball().offset(-0.5)),
        (
            format!("Translate(of: {BALL}, by: (1, 2, 3))"),
            ball().translate(xyz),
        ),
        (
            format!("Rotate(of: {BLOCK}, by: (90, 0, -90))"),
            block().rotate(Vec3::new(quarter, 0.0, -quarter)),
        ),
        (format!("Scale(of: {BALL}, by: 2)"), ball().scale(2.0)),
        (
            format!("Mirror(of: {BALL}, axes: \"zx\")"),
            ball().mirror([true, false, true]),
        ),
        (
            format!("Repeat(of: {BALL}, period: (4, 0, 4), count: (100, 1, 3))"),
            ball().repeat(Vec3::new(4.0, 0.0, 4.0), [100, 1, 3]),
        ),
        (
            format!("Repeat(of: {BALL}, period: (4, 0, 0))"),
            ball().repeat(Vec3::new(4.0, 0.0, 0.0), [0; 3]),
        ),
        (
            format!("Elongate(of: {BALL}, by: (1, 2, 3))"),
            ball().elongate(xyz),
        ),
        (
            format!("Twist(of: {BLOCK}, rate: 90)"),
            block().twist(quarter),
        ),
        (
            format!("Bend(of: {BLOCK}, rate: 90)"),
            block().bend(quarter),
        ),
        (
            format!("Twist(of: {BLOCK}, rate: 90, lipschitz: 4)"),
            Shape::over(
                Node::Twist(Twist {
                    rate: quarter,
                    lipschitz: 4.0,
                }),
                [block()],
            ),
        ),
        (
            format!("Bend(of: {BLOCK}, rate: 90, lipschitz: 5)"),
            Shape::over(
                Node::Bend(Bend {
                    rate: quarter,
                    lipschitz: 5.0,
                }),
                [block()],
            ),
        ),
        (
            format!("Morph(from: {BALL}, to: {BLOCK}, amount: 0.25)"),
            ball().morph(block(), 0.25),
        ),
        (
            format!(
                "Difference(from: Shell(of: {BALL}, thickness: 0.5), cut: [Translate(of: Union([{BLOCK}]), by: (1, 2, 3))])"
            ),
            ball()
                .shell(0.5)
                .minus([Shape::union([block()]).translate(xyz)]),
        ),
    ];
    for (text, expected) in operators {
        assert_eq!(shape(&text), expected, "{text}");
    }
}

/// Protects older scenes: what stands alone and was always there is the same basic shape.
#[test]
fn basic_shapes_stay_basic() {
    let size = Vec3::new(1.0, 2.0, 3.0);
    let cases = [
        ("Plane", Node::Plane(Plane)),
        ("Box(size: (1, 2, 3))", Node::Cuboid(Cuboid { size })),
        ("Room(size: (1, 2, 3))", Node::Room(Room { size })),
        ("Sphere(radius: 2)", Node::Sphere(Sphere { radius: 2.0 })),
        (
            "Cylinder(radius: 2)",
            Node::Cylinder(Cylinder { radius: 2.0 }),
        ),
        (
            "Cylinder(radius: 2, axis: (0, 3, 0))",
            Node::Cylinder(Cylinder { radius: 2.0 }),
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(shape(text), expected.into());
    }
}

/// Protects cylinders that lie: along their axis nothing ends, or their ends are where they
/// belong.
#[test]
fn cylinders_lie_along_their_axis() {
    let slanted = Vec3::new(1.0, -2.0, 3.0);
    let axes = [
        ("X", Vec3::X),
        ("Z", Vec3::Z),
        ("(0, -1, 0)", Vec3::NEG_Y),
        ("(1, -2, 3)", slanted),
    ];
    for (said, axis) in axes {
        let axis = axis.normalize();
        let aside = axis.any_orthonormal_vector();
        let endless = shape(&format!("Cylinder(radius: 1, axis: {said})"));
        let capped = shape(&format!("Cylinder(radius: 1, height: 6, axis: {said})"));
        for along in [-50.0, 0.0, 20.0] {
            let distance = endless.distance(axis * along + aside * 3.0);
            assert!((distance - 2.0).abs() < 1e-4, "{said}: {distance}");
        }
        assert!((capped.distance(axis * 5.0) - 2.0).abs() < 1e-5, "{said}");
        assert!((capped.distance(aside * 4.0) - 3.0).abs() < 1e-5, "{said}");
    }
}

/// Protects key frames and named values: every kind of number takes them, under the name that
/// the API has for it, and moves.
#[test]
fn numbers_move() {
    let keys = |keys: &[(f64, f32)]| Motion::Keys(keys.to_vec());
    let radians = |degrees: f32| degrees.to_radians();
    let cases = [
        (
            "shape: Sphere(radius: Keys([(0, 1), (2, 3)]))",
            "radius",
            keys(&[(0.0, 1.0), (2.0, 3.0)]),
        ),
        (
            "shape: Box(size: (1, Value(\"door\", 2.5), 1))",
            "size.y",
            Motion::Named("door".into()),
        ),
        (
            "shape: Plane, position: (0, 0, Keys([(0.1, -1)]))",
            "position.z",
            keys(&[(0.1, -1.0)]),
        ),
        (
            "shape: Plane, rotation: (0, Keys([(0, 0), (1, 90)]), 0)",
            "rotation.y",
            keys(&[(0.0, 0.0), (1.0, radians(90.0))]),
        ),
        (
            "shape: Cylinder(radius: Value(\"r\", 1), axis: X)",
            "0.radius",
            Motion::Named("r".into()),
        ),
        (
            "shape: Union([Plane, Translate(of: Sphere(radius: 1), by: (0, Value(\"up\", 3), 0))])",
            "1.by.y",
            Motion::Named("up".into()),
        ),
        (
            "shape: Difference(from: Plane, cut: [Plane, Torus(ring: 3, tube: Value(\"t\", 1))])",
            "2.tube",
            Motion::Named("t".into()),
        ),
        (
            "shape: Twist(of: Box(size: (1, 1, 1)), rate: Keys([(0, 10), (1, 20)]))",
            "rate",
            keys(&[(0.0, radians(10.0)), (1.0, radians(20.0))]),
        ),
        (
            "shape: Morph(from: Plane, to: Sphere(radius: 1), amount: Keys([(0, 0), (1, 1)]))",
            "amount",
            keys(&[(0.0, 0.0), (1.0, 1.0)]),
        ),
        (
            "shape: Quadric((1, 1, 1, 0, 0, 0, 0, 0, 0, Value(\"j\", -1)))",
            "coefficients.9",
            Motion::Named("j".into()),
        ),
        (
            "shape: Prism(corners: [(0, 0), (1, 0), (0, Value(\"c\", 1))], depth: 1)",
            "corners.2.y",
            Motion::Named("c".into()),
        ),
    ];
    for (surface, parameter, motion) in cases {
        let read = scene(surface);
        let parameter = parameter.to_owned();
        let expected = [Driver { parameter, motion }];
        assert_eq!(read.surfaces[0].drivers, expected, "{surface}");
    }

    let read = scene("shape: Sphere(radius: Keys([(-1, 1), (1, 3)]))");
    assert_eq!(
        read.surfaces[0].shape.node,
        Node::Sphere(Sphere { radius: 2.0 })
    );
    assert_eq!(
        read.at(0.5).surfaces[0].shape.node,
        Node::Sphere(Sphere { radius: 2.5 })
    );
    assert_eq!(read.duration(), 1.0);

    let mut read = scene("shape: Sphere(radius: Value(\"size\", 2))");
    assert_eq!(
        read.surfaces[0].shape.node,
        Node::Sphere(Sphere { radius: 2.0 })
    );
    assert_eq!(read.value_names(), ["size"]);
    read.set_value("size", 5.0).unwrap();
    assert_eq!(
        read.at(9.0).surfaces[0].shape.node,
        Node::Sphere(Sphere { radius: 5.0 })
    );
}

/// Protects a rotation of which one angle moves: the others stay, and the shader has it.
#[test]
fn a_moving_rotation_keeps_its_other_angles() {
    let read = scene("shape: Plane, rotation: (30, Keys([(0, 0), (1, 40)]), 50)");
    let turned = scene("shape: Plane, rotation: (30, 20, 50)");
    assert!(read.surfaces[0].dynamic_rotation);
    let half_way = read.at(0.5).surfaces[0].rotation;
    assert!(half_way.angle_between(turned.surfaces[0].rotation) < 1e-3);
    let start = scene("shape: Plane, rotation: (30, 0, 50)");
    let first = read.surfaces[0].rotation;
    assert!(first.angle_between(start.surfaces[0].rotation) < 1e-3);
}

/// Protects the author of a scene: the line and the column, and what is wrong there.
#[test]
fn mistakes_are_refused_at_their_place() {
    let cases = [
        // Names.
        ("shape: Spere(radius: 1)", "`Spere`"),
        ("shape: Union([Plane, Spere(radius: 1)])", "`Spere`"),
        ("shape: Sphere(raduis: 1)", "`raduis`"),
        ("shape: Shell(of: Plane)", "`thickness`"),
        ("shape: Shell(thickness: 1)", "`of`"),
        (
            "shape: Cylinder(radius: 1, axis: W)",
            "an axis must be X, Y, Z",
        ),
        ("shape: Cylinder(radius: 1, axis: (0, 0, 0))", "length 0"),
        (
            "shape: Mirror(of: Plane, axes: \"w\")",
            "one or more of x, y and z, not \"w\"",
        ),
        ("shape: Mirror(of: Plane, axes: \"xx\")", "not \"xx\""),
        ("shape: Mirror(of: Plane, axes: \"\")", "not \"\""),
        // Numbers.
        (
            "shape: Sphere(radius: -1)",
            "a radius in metres must be finite and greater than 0, not -1",
        ),
        ("shape: Torus(ring: 3, tube: 0)", "greater than 0, not 0"),
        ("shape: Scale(of: Plane, by: 0)", "a factor must be"),
        (
            "shape: Rotate(of: Plane, by: (0, inf, 0))",
            "an angle in degrees must be finite",
        ),
        (
            "shape: Morph(from: Plane, to: Plane, amount: 1.5)",
            "0 to 1, not 1.5",
        ),
        (
            "shape: Hyperboloid(waist: 1, rise: 1, sheets: 3)",
            "1 or 2 sheets, not 3",
        ),
        (
            "shape: Prism(corners: [(0, 0), (1, 0)], depth: 1)",
            "3 corners (x, y), not 2",
        ),
        ("shape: Quadric((1, 2, 3))", "10"),
        (
            "shape: Repeat(of: Plane, period: (1, 0, 0), count: (-1, 0, 0))",
            "",
        ),
        (
            "shape: Twist(of: Plane, rate: 1, lipschitz: 0)",
            "a Lipschitz constant",
        ),
        // What moves.
        ("shape: Sphere(radius: Keys([]))", "at least one"),
        (
            "shape: Sphere(radius: Keys([(0, 1), (0, 2)]))",
            "must increase",
        ),
        (
            "shape: Sphere(radius: Keys([(0, 1), (1, -2)]))",
            "greater than 0, not -2",
        ),
        (
            "shape: Sphere(radius: Keys([(inf, 1)]))",
            "time must be finite",
        ),
        (
            "shape: Sphere(radius: Keys([(0, 1, 2)]))",
            "Keys([(seconds, number)",
        ),
        (
            "shape: Sphere(radius: Kyes([(0, 1)]))",
            "Keys([(seconds, number)",
        ),
        (
            "shape: Sphere(radius: Value(\"r\"))",
            "Value(\"name\", number)",
        ),
        ("shape: Sphere(radius: Value(\"\", 1))", "needs a name"),
        ("shape: Sphere(radius: \"1\")", "Expected a number"),
    ];
    for (surface, says) in cases {
        let sentence = refusal(surface);
        let mut parts = sentence.splitn(4, ':');
        assert_eq!(parts.next(), Some("text"), "{sentence}");
        assert_eq!(parts.next(), Some("2"), "{surface}: {sentence}");
        let column: usize = parts.next().unwrap().parse().unwrap();
        let shape_at = "    surfaces: [Surface(".len() + 1;
        assert!(
            (shape_at..=shape_at + surface.len()).contains(&column),
            "{surface}: {sentence}"
        );
        let reason = parts.next().unwrap();
        assert!(reason.contains(says), "{surface}: {sentence}");
    }
}

/// Protects the author where a number is fine and what it makes is not: surface and node are
/// named, and the time when it is only later.
#[test]
fn what_cannot_be_is_refused_by_name() {
    let cases = [
        (
            "name: \"bed\", shape: RoundedBox(size: (1, 1, 1), rounding: 0.6)",
            "surface 1 (bed): RoundedBox: ",
        ),
        ("shape: Union([])", "surface 1 (Union): Union: "),
        (
            "shape: Repeat(of: Plane, period: (1, 0, 0))",
            "surface 1 (Repeat): Repeat: ",
        ),
        (
            "shape: HalfSpace(normal: (0, 0, 0))",
            "surface 1 (HalfSpace): HalfSpace: ",
        ),
        (
            "shape: RoundedBox(size: (1, 1, 1), rounding: Keys([(0, 0.1), (2, 0.6)]))",
            "at 2 s, scene \"\": surface 1 (RoundedBox): RoundedBox: ",
        ),
        (
            "shape: Repeat(of: Sphere(radius: Keys([(0, 1), (3, 50)])), period: (2, 2, 2))",
            "at 3 s, scene \"\": surface 1 (Repeat): Repeat: ",
        ),
        (
            "shape: Plane, position: (0, Keys([(0, 0), (1, 1e10)]), 0)",
            "at 1 s, ",
        ),
    ];
    for (surface, says) in cases {
        let sentence = refusal(surface);
        assert!(sentence.contains(says), "{sentence}");
    }
}

/// Protects the stack: text nested without end is refused at its place, and what a person may
/// write is not.
#[test]
fn deep_nesting_is_refused_in_a_sentence() {
    let nested = |depth: usize| {
        let (open, close) = ("Complement(".repeat(depth), ")".repeat(depth));
        format!("shape: {open}Plane{close}")
    };
    assert_eq!(scene(&nested(64)).surfaces[0].shape.name(), "Complement");
    let operator = |depth: usize| {
        let (open, close) = (
            "Union([Translate(of: ".repeat(depth),
            ", by: (0, 0, 0))])".repeat(depth),
        );
        format!("shape: {open}Plane{close}")
    };
    assert_eq!(scene(&operator(32)).surfaces[0].shape.name(), "Union");
    for surface in [
        nested(10_000),
        operator(10_000),
        format!("shape: Sphere(radius: {})", "[".repeat(10_000)),
    ] {
        let sentence = refusal(&surface);
        assert!(
            sentence.starts_with("text:2:") && sentence.len() < 200,
            "{sentence}"
        );
        assert!(sentence.contains("nested too deeply"), "{sentence}");
    }
}

/// Protects scenes that name files: they are found beside the scene, wherever the program
/// runs, and one that is missing or spoilt is named.
#[test]
fn files_lie_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let read = |surface: &str| {
        write("scene.ron", text(surface).as_bytes());
        Scene::from_file(&folder.path().join("scene.ron"))
    };
    write(
        "ball.glsl",
        b"float field(vec3 p) { return length(p) - 1.0; }",
    );
    let image = image::GrayImage::from_fn(2, 3, |x, y| image::Luma([(100 * x + 20 * y) as u8]));
    image.save(folder.path().join("hills.png")).unwrap();

    const FIELD: &str = "Field(file: \"ball.glsl\", lipschitz: 1.5, size: (3, 3, 3))";
    let scene = read(&format!("shape: Union([{FIELD}, {FIELD}])")).unwrap();
    let field = &scene.surfaces[0].shape;
    let Node::User(User { field: user }) = &field.children[0].node else {
        panic!("{field:?}");
    };
    let text = "float field(vec3 p) { return length(p) - 1.0; }".to_owned();
    let path = folder.path().join("ball.glsl");
    assert_eq!(**user, UserField::new(path, text, Vec3::splat(3.0), 1.5));
    let Node::User(User { field: second }) = &field.children[1].node else {
        panic!("{field:?}");
    };
    assert!(Arc::ptr_eq(user, second), "the same file is read twice");

    let scene = read("shape: HeightField(image: \"hills.png\", size: (8, 2, 8))").unwrap();
    let Node::HeightField(HeightField { image, size }) = &scene.surfaces[0].shape.node else {
        panic!("{:?}", scene.surfaces[0]);
    };
    assert_eq!(*size, Vec3::new(8.0, 2.0, 8.0));
    let heights = [0u8, 100, 20, 120, 40, 140].map(|h| f32::from(h) / 255.0);
    let name = folder.path().join("hills.png").display().to_string();
    let expected = HeightImage::new(&name, UVec2::new(2, 3), heights.to_vec()).unwrap();
    assert_eq!(image.size(), expected.size());
    for (read, expected) in image.heights().iter().zip(expected.heights()) {
        assert!((read - expected).abs() < 1e-4);
    }

    write("hills.txt", b"no image");
    let refused = [
        (
            "Field(file: \"none.glsl\", lipschitz: 1, size: (1, 1, 1))",
            "none.glsl: No such file",
        ),
        (
            "HeightField(image: \"none.png\", size: (1, 1, 1))",
            "none.png: No such file",
        ),
        (
            "HeightField(image: \"hills.txt\", size: (1, 1, 1))",
            "hills.txt: ",
        ),
        (
            "Field(file: \".\", lipschitz: 1, size: (1, 1, 1))",
            "directory",
        ),
    ];
    for (shape, says) in refused {
        let sentence = read(&format!("shape: {shape}")).unwrap_err().to_string();
        let origin = folder.path().join("scene.ron").display().to_string();
        assert!(sentence.starts_with(&format!("{origin}: ")), "{sentence}");
        assert!(
            sentence.contains(says) && !sentence.contains('\n'),
            "{sentence}"
        );
    }
}

/// Protects whoever writes a scene in a program: files are then found from the current folder.
#[test]
fn text_finds_files_from_the_current_folder() {
    let error = Scene::from_ron(
        &text("shape: Field(file: \"none.glsl\", lipschitz: 1, size: (1, 1, 1))"),
        "text",
    );
    let sentence = error.unwrap_err().to_string();
    assert!(
        sentence.starts_with("text: cannot read the field none.glsl: "),
        "{sentence}"
    );
    assert!(!Path::new("none.glsl").exists());
}
