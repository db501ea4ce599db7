//! Invalid fields are rejected, with a message that names the node.

use super::table::{cuboid, sphere};
use crate::scene::shape::{
    Bend, CappedCylinder, Capsule, Complement, Cone, Cuboid, Cylinder, Difference, Ellipsoid,
    GeneralQuadric, HalfSpace, HeightField, Hyperboloid, Morph, Paraboloid, Plane, Prism, Room,
    RoundedBox, Sphere, Torus, Twist, User,
};
use crate::scene::{HeightImage, Node, Shape, UserField};
use glam::{UVec2, Vec2, Vec3};
use std::sync::Arc;

fn refusals() -> Vec<(Shape, &'static str)> {
    let f = Shape::from;
    let v = Vec3::new;
    let mut list = vec![
        (
            f(Node::HalfSpace(HalfSpace {
                normal: Vec3::ZERO,
                offset: 0.0,
            })),
            "normal must have a length",
        ),
        (
            f(Node::HalfSpace(HalfSpace {
                normal: Vec3::X,
                offset: f32::NAN,
            })),
            "offset",
        ),
        (
            f(Node::Cuboid(Cuboid {
                size: v(1.0, 0.0, 1.0),
            })),
            "size",
        ),
        (
            f(Node::Room(Room {
                size: v(1.0, 1.0, -1.0),
            })),
            "size",
        ),
        (
            f(Node::RoundedBox(RoundedBox {
                size: v(1.0, 2.0, 3.0),
                rounding: 0.6,
            })),
            "at most half",
        ),
        (
            f(Node::Sphere(Sphere {
                radius: f32::INFINITY,
            })),
            "radius",
        ),
        (f(Node::Cylinder(Cylinder { radius: -1.0 })), "radius"),
        (
            f(Node::CappedCylinder(CappedCylinder {
                radius: 1.0,
                height: 0.0,
            })),
            "height",
        ),
        (
            f(Node::Capsule(Capsule {
                radius: 0.0,
                height: 1.0,
            })),
            "radius",
        ),
        (
            f(Node::Torus(Torus {
                ring: 1.0,
                tube: -0.1,
            })),
            "tube",
        ),
        (
            f(Node::Cone(Cone {
                radius: 1.0,
                height: f32::NAN,
            })),
            "height",
        ),
        (
            f(Node::Prism(Prism {
                corners: [Vec2::ZERO, Vec2::X, Vec2::X * 2.0],
                depth: 1.0,
            })),
            "one line",
        ),
        (
            f(Node::Ellipsoid(Ellipsoid {
                radii: v(1.0, 1.0, 0.0),
            })),
            "radii",
        ),
        (
            f(Node::Paraboloid(Paraboloid { focal_length: 0.0 })),
            "focal length",
        ),
        (
            f(Node::Hyperboloid(Hyperboloid {
                waist: 1.0,
                rise: 0.0,
                two_sheets: true,
            })),
            "rise",
        ),
        (
            f(Node::GeneralQuadric(GeneralQuadric {
                coefficients: [0.0; 10],
            })),
            "first six",
        ),
        (
            f(Node::GeneralQuadric(GeneralQuadric {
                coefficients: [f32::NAN; 10],
            })),
            "coefficients.0",
        ),
        (sphere(1.0).shell(0.0), "thickness"),
        (
            Shape::smooth_union(0.0, [sphere(1.0), sphere(2.0)]),
            "radius",
        ),
        (sphere(1.0).offset(f32::NAN), "its by"),
        (sphere(1.0).scale(-1.0), "its by"),
        (
            sphere(1.0).translate(v(0.0, f32::INFINITY, 0.0)),
            "its by.y",
        ),
        (sphere(1.0).rotate(v(f32::NAN, 0.0, 0.0)), "its by.x"),
        (sphere(1.0).repeat(Vec3::ZERO, [1; 3]), "period"),
        (sphere(1.0).repeat(v(1.0, -1.0, 0.0), [1; 3]), "period"),
        (
            sphere(1.0).repeat(v(3.0, 0.0, 0.0), [1 << 24, 0, 0]),
            "counts",
        ),
        (sphere(1.0).elongate(v(-1.0, 0.0, 0.0)), "negative"),
        (sphere(1.0).morph(sphere(2.0), 1.5), "amount"),
        (cuboid(1.0, 1.0, 1.0).twist(f32::NAN), "rate"),
        // Repetitions and turns of unbounded children.
        (
            f(Node::Plane(Plane)).repeat(v(1.0, 0.0, 0.0), [0; 3]),
            "no end",
        ),
        (
            sphere(1.0).complement().repeat(v(9.0, 0.0, 0.0), [0; 3]),
            "no end",
        ),
        (sphere(5.0).repeat(v(0.5, 0.5, 0.5), [0; 3]), "more than 64"),
        (f(Node::Plane(Plane)).twist(1.0), "no end"),
        (
            f(Node::Cylinder(Cylinder { radius: 1.0 })).bend(1.0),
            "no end",
        ),
        (
            Shape::over(
                Node::Twist(Twist {
                    rate: 3.0,
                    lipschitz: 1.1,
                }),
                [cuboid(3.0, 1.0, 3.0)],
            ),
            "lipschitz",
        ),
        (
            Shape::over(
                Node::Bend(Bend {
                    rate: 2.0,
                    lipschitz: 1.05,
                }),
                [cuboid(3.0, 1.0, 1.0)],
            ),
            "lipschitz",
        ),
        (
            Shape::over(
                Node::Twist(Twist {
                    rate: 1.0,
                    lipschitz: 0.5,
                }),
                [cuboid(1.0, 1.0, 1.0)],
            ),
            "lipschitz",
        ),
        // Operands.
        (Shape::union([]), "at least 1"),
        (
            Shape::over(Node::Difference(Difference), [sphere(1.0)]),
            "at least 2",
        ),
        (
            Shape::over(Node::Morph(Morph { amount: 0.5 }), [sphere(1.0)]),
            "takes 2",
        ),
        (
            Shape::over(Node::Complement(Complement), [sphere(1.0), sphere(2.0)]),
            "takes 1",
        ),
        (
            Shape::over(Node::Sphere(Sphere { radius: 1.0 }), [sphere(1.0)]),
            "takes no fields",
        ),
    ];
    let image = HeightImage::new("flat", UVec2::splat(2), vec![0.5; 4]).unwrap();
    let (image, size) = (Arc::new(image), v(1.0, 0.0, 1.0));
    list.push((f(Node::HeightField(HeightField { image, size })), "size"));
    let user = |size, lipschitz| {
        let text = "float field(vec3 p) { return 1.0; }".to_owned();
        let field = Arc::new(UserField::new("own.glsl", text, size, lipschitz));
        f(Node::User(User { field }))
    };
    list.push((user(Vec3::ZERO, 1.0), "size"));
    list.push((user(Vec3::ONE, 0.0), "lipschitz"));
    list
}

/// Each invalid number of a field is reported with its node, alone and within a tree.
#[test]
fn bad_fields_are_refused_by_name() {
    for (field, says) in refusals() {
        let name = field.node.name();
        let within = Shape::union([sphere(1.0), field.clone()]).complement();
        for tree in [field, within] {
            let why = tree.check().expect_err(name);
            assert!(why.starts_with(name), "{why}: {name}");
            assert!(why.contains(says), "{why}: {says}");
        }
    }
}

/// Protects from trees that would compile for minutes.
#[test]
fn a_field_has_an_end() {
    let many = Shape::union((0..5000).map(|_| sphere(1.0)));
    assert!(many.validate().is_err_and(|why| why.contains("too large")));
}

/// Protects height images.
#[test]
fn height_images_are_checked() {
    let new = |size, count, height| HeightImage::new("x", size, vec![height; count]);
    assert!(new(UVec2::new(1, 2), 2, 0.5).is_err());
    assert!(new(UVec2::new(2, 2), 3, 0.5).is_err());
    assert!(new(UVec2::new(2, 2), 4, 1.5).is_err());
    assert!(new(UVec2::new(2, 2), 4, f32::NAN).is_err());
    assert!(new(UVec2::new(2, 2), 4, 0.5).is_ok());
}
