//! Shapes and operators in scene files, and the fields that are read from them.

use super::shape;
use echomarch::scene::shape::{
    Bend, CappedCylinder, Capsule, Complement, Cone, Cuboid, Cylinder, Ellipsoid, GeneralQuadric,
    HalfSpace, Hyperboloid, Paraboloid, Plane, Prism, Room, RoundedBox, Sphere, Torus, Twist,
    Union,
};
use echomarch::scene::{Node, Shape};
use glam::{Vec2, Vec3};

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

/// Protects the grammar: the text of each shape and operator gives the field that it describes.
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
        ("Union(of: [Plane])", Node::Union(Union)),
        ("Complement(of: Plane)", Node::Complement(Complement)),
    ];
    for (text, node) in shapes {
        let read = shape(text);
        assert_eq!(read.node, node, "{text}");
    }
    let operators = [
        (
            format!("Union(of: [{BALL}, {BLOCK}])"),
            Shape::union([ball(), block()]),
        ),
        (
            format!("Intersection(of: [{BALL}, {BLOCK}])"),
            Shape::intersection([ball(), block()]),
        ),
        (
            format!("Difference(from: {BALL}, cut: [{BLOCK}, Plane])"),
            ball().minus([block(), field(Node::Plane(Plane))]),
        ),
        (format!("Complement(of: {BLOCK})"), block().complement()),
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
                "Difference(from: Shell(of: {BALL}, thickness: 0.5), cut: [Translate(of: Union(of: [{BLOCK}]), by: (1, 2, 3))])"
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

/// Protects older scenes: the five basic shapes remain basic if they are not operands.
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

/// Protects cylinders with an inclined axis: along the axis they are infinite, or end at the right positions.
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
