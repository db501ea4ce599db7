//! Key frames and named values in scene files, and the drivers that are read from them.

use super::scene;
use echomarch::scene::shape::Sphere;
use echomarch::scene::{Driver, Motion, Node};

/// Protects key frames and named values. Every kind of number accepts them, has the same name in the API, and moves.
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
            "shape: Union(of: [Plane, Translate(of: Sphere(radius: 1), by: (0, Value(\"up\", 3), 0))])",
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

/// Protects a rotation with one moving angle: the other angles are constant, and the rotation is passed to the shader.
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
