//! A table of all shapes and operators, and of combinations of them, for tests.

use crate::scene::shape::{
    CappedCylinder, Capsule, Complement, Cone, Cuboid, Cylinder, Difference, Ellipsoid,
    GeneralQuadric, Grid, HalfSpace, HeightField, Hyperboloid, Intersection, Paraboloid, Plane,
    Prism, Room, RoundedBox, Sphere, Torus, Union, User,
};
use crate::scene::{HeightImage, Node, SampledField, Shape, UserField};
use crate::{Listener, Scene, Source, Surface};
use glam::{DVec3, EulerRot, Quat, UVec2, UVec3, Vec2, Vec3};
use std::sync::Arc;

/// An entry of the table.
#[derive(Clone, Debug)]
pub struct Entry {
    pub name: String,
    pub field: Shape,
    /// The function that a user's text computes. The CPU has only samples of the text.
    pub truth: Option<fn(DVec3) -> f64>,
}

impl Entry {
    /// The length of a step of a march.
    pub fn distance(&self, p: DVec3) -> f64 {
        match self.truth {
            Some(value) => value(p),
            None => self.field.value(p) / self.field.properties().lipschitz,
        }
    }

    /// Half the size, in metres, of the cube around the origin that contains the details of the field.
    pub fn reach(&self) -> f64 {
        let bounds = self.field.properties().bounds;
        if bounds.is_finite() && !bounds.is_empty() {
            bounds.min.abs().max(bounds.max.abs()).max_element()
        } else {
            4.0
        }
    }
}

const KINDS: usize = 35;

/// The index of a node's kind. A new variant of `Node` does not compile until it has an index here. It also needs an
/// increase of [`KINDS`] and an entry in [`shapes`] or [`operators`].
fn kind(node: &Node) -> usize {
    match node {
        Node::Plane(Plane) => 0,
        Node::HalfSpace(_) => 1,
        Node::Cuboid(_) => 2,
        Node::Room(_) => 3,
        Node::RoundedBox(_) => 4,
        Node::Sphere(_) => 5,
        Node::Cylinder(_) => 6,
        Node::CappedCylinder(_) => 7,
        Node::Capsule(_) => 8,
        Node::Torus(_) => 9,
        Node::Cone(_) => 10,
        Node::Prism(_) => 11,
        Node::Ellipsoid(_) => 12,
        Node::Paraboloid(_) => 13,
        Node::Hyperboloid(_) => 14,
        Node::GeneralQuadric(_) => 15,
        Node::HeightField(_) => 16,
        Node::User(_) => 17,
        Node::Union(Union) => 18,
        Node::Intersection(Intersection) => 19,
        Node::Difference(Difference) => 20,
        Node::Complement(Complement) => 21,
        Node::Shell(_) => 22,
        Node::SmoothUnion(_) => 23,
        Node::Offset(_) => 24,
        Node::Translate(_) => 25,
        Node::Rotate(_) => 26,
        Node::Scale(_) => 27,
        Node::Mirror(_) => 28,
        Node::Repeat(_) => 29,
        Node::Elongate(_) => 30,
        Node::Twist(_) => 31,
        Node::Bend(_) => 32,
        Node::Morph(_) => 33,
        Node::Grid(_) => 34,
        Node::Octahedron(_) => unreachable!("an example that has its own test"),
        Node::Mesh(_) | Node::Rooms(_) => unreachable!(
            "it is no operand, and tests/surfaces compares it with all of its triangles"
        ),
    }
}

pub fn sphere(radius: f32) -> Shape {
    Node::Sphere(Sphere { radius }).into()
}

pub fn cuboid(x: f32, y: f32, z: f32) -> Shape {
    let size = Vec3::new(x, y, z);
    Node::Cuboid(Cuboid { size }).into()
}

fn ellipsoid(x: f32, y: f32, z: f32) -> Shape {
    let radii = Vec3::new(x, y, z);
    Node::Ellipsoid(Ellipsoid { radii }).into()
}

fn prism() -> Shape {
    let corners = [
        Vec2::new(-0.5, -0.4),
        Vec2::new(1.2, -0.3),
        Vec2::new(0.1, 0.9),
    ];
    Node::Prism(Prism {
        corners,
        depth: 1.4,
    })
    .into()
}

fn cone() -> Shape {
    Node::Cone(Cone {
        radius: 0.8,
        height: 1.5,
    })
    .into()
}

fn hills() -> Shape {
    let heights = (0..30).map(|i| ((i * 7) % 11) as f32 / 10.0).collect();
    let image = HeightImage::new("hills", UVec2::new(6, 5), heights).unwrap();
    Node::HeightField(HeightField {
        image: Arc::new(image),
        size: Vec3::new(4.0, 0.7, 3.0),
    })
    .into()
}

/// A ball that another program sampled coarsely, off its centre.
fn sampled() -> Shape {
    let (side, cell) = (UVec3::new(9, 8, 7), 0.4);
    let at = |index: u32| {
        let (x, y, z) = (index / 56, index / 7 % 8, index % 7);
        let p = (UVec3::new(x, y, z).as_vec3() - 0.5 * (side - 1).as_vec3()) * cell;
        (p - Vec3::new(0.1, -0.05, 0.02)).length() - 0.8
    };
    let values = (0..side.element_product()).map(at).collect();
    let field = SampledField::new("ball", side, cell, values).unwrap();
    Node::Grid(Grid {
        field: Arc::new(field),
    })
    .into()
}

/// Shapes in several sizes, without users' fields.
pub fn shapes() -> Vec<Shape> {
    let node = Shape::from;
    let quadric = |coefficients| Shape::from(Node::GeneralQuadric(GeneralQuadric { coefficients }));
    let hyperboloid = |waist, rise, two_sheets| {
        Shape::from(Node::Hyperboloid(Hyperboloid {
            waist,
            rise,
            two_sheets,
        }))
    };
    vec![
        node(Node::Plane(Plane)),
        node(Node::HalfSpace(HalfSpace {
            normal: Vec3::new(1.0, -2.0, 0.5),
            offset: -0.7,
        })),
        cuboid(0.02, 0.03, 0.01),
        cuboid(4.0, 1.0, 2.0),
        node(Node::Room(Room {
            size: Vec3::new(6.0, 4.0, 5.0),
        })),
        node(Node::RoundedBox(RoundedBox {
            size: Vec3::new(2.0, 1.0, 3.0),
            rounding: 0.2,
        })),
        node(Node::RoundedBox(RoundedBox {
            size: Vec3::new(2.0, 1.0, 3.0),
            rounding: 0.5,
        })),
        sphere(0.01),
        sphere(3.0),
        node(Node::Cylinder(Cylinder { radius: 0.6 })),
        node(Node::CappedCylinder(CappedCylinder {
            radius: 1.1,
            height: 0.6,
        })),
        node(Node::CappedCylinder(CappedCylinder {
            radius: 0.2,
            height: 5.0,
        })),
        node(Node::Capsule(Capsule {
            radius: 0.5,
            height: 1.5,
        })),
        node(Node::Torus(Torus {
            ring: 1.5,
            tube: 0.4,
        })),
        node(Node::Torus(Torus {
            ring: 0.4,
            tube: 0.6,
        })),
        cone(),
        node(Node::Cone(Cone {
            radius: 2.0,
            height: 0.5,
        })),
        prism(),
        node(Node::Prism(Prism {
            corners: [Vec2::new(0.0, 2.0), Vec2::new(3.0, 0.0), Vec2::ZERO],
            depth: 0.2,
        })),
        ellipsoid(1.0, 1.0, 1.0),
        ellipsoid(2.0, 0.5, 1.0),
        node(Node::Paraboloid(Paraboloid { focal_length: 0.4 })),
        hyperboloid(0.7, 1.0, false),
        hyperboloid(0.7, 1.0, true),
        quadric([1.0, 0.5, -0.6, 0.3, -0.4, 0.2, 0.1, -0.3, 0.2, -0.8]),
        quadric([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
        hills(),
        sampled(),
    ]
}

/// Users' fields, with the functions that they compute.
pub fn users() -> Vec<Entry> {
    const BALL: &str = "#define SQUARE(x) ((x) * (x))\nconst float RADIUS = 0.75;\n\
        float lengthOf(vec3 p) { return sqrt(SQUARE(p.x) + SQUARE(p.y) + SQUARE(p.z)); }\n\
        float field(vec3 p) { return lengthOf(p) - RADIUS; }\n";
    const BLOCK: &str = "// A box.\nconst vec3 HALF = vec3(0.5, 0.25, 0.75);\n\
        float most(vec3 v) { return max(v.x, max(v.y, v.z)); }\n\
        float field(vec3 p) {\n    vec3 q = abs(p) - HALF;\n    \
        return 2.0 * (length(max(q, 0.0)) + min(most(q), 0.0));\n}\n";
    let entry = |name: &str, text: &str, lipschitz, truth: fn(DVec3) -> f64| {
        let user = UserField::new(name, text.to_owned(), Vec3::splat(2.0), lipschitz);
        let field = Arc::new(user);
        Entry {
            name: name.into(),
            field: Node::User(User { field }).into(),
            truth: Some(truth),
        }
    };
    fn cut(p: DVec3, value: fn(DVec3) -> f64) -> f64 {
        let beyond = p.abs() - DVec3::ONE;
        let outside = beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0);
        value(p.clamp(-DVec3::ONE, DVec3::ONE)).max(outside)
    }
    let ball = |p| cut(p, |q| q.length() - 0.75);
    let block = |p| {
        cut(p, |q| {
            let beyond = q.abs() - DVec3::new(0.5, 0.25, 0.75);
            beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
        })
    };
    vec![
        entry("ball.glsl", BALL, 1.0, ball),
        entry("block.glsl", BLOCK, 2.0, block),
    ]
}

/// Operators, single and nested.
pub fn operators() -> Vec<Shape> {
    let v = Vec3::new;
    let bar = || cuboid(2.0, 0.4, 0.3);
    let aside = || sphere(0.5).translate(v(0.3, 0.1, 0.0));
    let wedge = || prism().translate(v(0.2, 0.0, 0.1));
    vec![
        Shape::union([sphere(0.8), bar(), cone().translate(v(0.0, 1.0, 0.5))]),
        Shape::union([
            cuboid(1.0, 1.0, 1.0),
            cuboid(1.0, 1.0, 1.0).translate(Vec3::X),
        ]),
        Shape::intersection([sphere(1.0), cuboid(1.5, 1.5, 1.5), aside()]),
        cuboid(2.0, 2.0, 2.0).minus([sphere(1.2), bar()]),
        sphere(1.0).complement(),
        cuboid(3.0, 2.0, 4.0).complement(),
        ellipsoid(2.0, 1.5, 1.0)
            .rotate(v(0.3, 0.2, 0.1))
            .complement(),
        Shape::from(Node::Room(Room {
            size: Vec3::splat(3.0),
        }))
        .complement(),
        sphere(1.0).shell(0.2),
        sphere(1.0).complement().shell(0.3),
        ellipsoid(2.0, 0.5, 1.0).shell(0.4),
        Shape::smooth_union(0.6, [sphere(0.7), bar(), aside()]),
        Shape::smooth_union(1.0, [ellipsoid(2.0, 0.4, 0.6), ellipsoid(0.4, 1.0, 0.5)]),
        // The fields are far apart except near one point, and unchanged far from this point.
        Shape::smooth_union(
            0.15,
            [
                sphere(0.7),
                cuboid(2.0, 0.3, 0.4).translate(v(1.4, 0.1, 0.0)),
            ],
        ),
        cuboid(1.0, 2.0, 1.5).offset(0.3),
        cuboid(1.0, 2.0, 1.5).offset(-0.2),
        ellipsoid(2.0, 0.5, 1.0).offset(0.3),
        ellipsoid(2.0, 0.5, 1.0).offset(-0.2),
        Shape::intersection([sphere(1.0), aside()]).offset(0.2),
        wedge().rotate(v(0.5, -1.0, 2.0)),
        cone().scale(2.5),
        cuboid(40.0, 20.0, 30.0).scale(0.05),
        bar()
            .rotate(v(0.0, 0.0, 0.7))
            .translate(v(1.0, 0.2, 0.0))
            .mirror([true, false, false]),
        bar().rotate(v(0.0, 0.0, 0.7)).mirror([true, true, false]),
        cuboid(1.0, 1.0, 1.0)
            .translate(v(0.5, 0.0, 0.0))
            .mirror([true, false, false]),
        sphere(0.4).repeat(v(1.0, 0.0, 1.5), [3, 0, 2]),
        sphere(0.4).repeat(v(1.0, 0.0, 1.5), [0, 0, 0]),
        aside().repeat(v(1.8, 0.0, 0.0), [4, 0, 0]),
        aside().repeat(v(1.8, 1.4, 0.0), [0, 3, 0]),
        aside().repeat(v(1.1, 0.0, 0.0), [5, 0, 0]),
        wedge().repeat(v(1.5, 0.0, 3.0), [2, 0, 3]),
        aside()
            .repeat(v(1.1, 0.0, 0.0), [2, 0, 0])
            .repeat(v(0.0, 2.0, 0.0), [0, 3, 0]),
        aside()
            .repeat(v(1.1, 0.0, 0.0), [3, 0, 0])
            .repeat(v(3.6, 0.0, 0.0), [2, 0, 0]),
        ellipsoid(1.0, 0.15, 0.2)
            .rotate(v(0.0, 0.0, 0.7))
            .repeat(v(1.2, 0.0, 0.0), [0; 3]),
        ellipsoid(1.0, 0.15, 0.2)
            .rotate(v(0.0, 0.0, 0.7))
            .repeat(v(1.2, 1.9, 0.0), [3, 2, 0])
            .offset(0.05),
        sphere(0.5).elongate(v(1.0, 0.0, 0.5)),
        prism().elongate(v(0.6, 0.3, 0.0)),
        bar().twist(0.8),
        bar().rotate(v(0.0, 0.0, 1.2)).twist(-1.5),
        cuboid(3.0, 0.3, 0.5).bend(0.4),
        sphere(0.8).morph(cuboid(2.0, 0.8, 1.2), 0.4),
        sphere(0.8).morph(cone(), 1.0),
        // Three and four nested operators.
        Shape::union([
            bar().twist(1.0).translate(v(0.0, 0.8, 0.0)),
            Shape::smooth_union(0.3, [aside(), cone()]).shell(0.1),
            sphere(0.3).repeat(v(1.0, 0.0, 0.0), [3, 0, 0]).offset(0.05),
        ]),
        Shape::intersection([
            cuboid(4.0, 2.0, 4.0),
            sphere(0.6).repeat(v(1.5, 1.5, 1.5), [0; 3]).complement(),
            Shape::union([aside(), wedge()]).complement(),
        ]),
        Shape::union([
            cone().rotate(v(0.4, 0.0, 0.9)).scale(0.7),
            Shape::union([cuboid(1.0, 0.2, 1.0), aside().translate(v(0.0, 1.0, 0.0))])
                .rotate(v(0.0, 0.3, 0.0))
                .translate(v(-0.5, -0.5, 0.2)),
            ellipsoid(0.4, 0.8, 0.3).translate(v(1.2, 0.0, 0.0)),
            Shape::from(Node::Capsule(Capsule {
                radius: 0.3,
                height: 1.0,
            }))
            .translate(v(0.0, 0.0, 1.5)),
        ]),
        Shape::intersection([bar(), aside()])
            .elongate(v(0.3, 0.2, 0.0))
            .mirror([false, true, true]),
        cuboid(2.0, 1.0, 1.0)
            .minus([wedge().offset(0.1)])
            .morph(aside().shell(0.2), 0.3),
        Shape::smooth_union(0.4, [bar().bend(0.6), sphere(0.5).shell(0.1)]),
    ]
}

/// The whole table.
pub fn entries() -> Vec<Entry> {
    let plain = shapes().into_iter().chain(operators()).map(|field| Entry {
        name: String::new(),
        field,
        truth: None,
    });
    let mut all: Vec<Entry> = plain.chain(users()).collect();
    for (index, entry) in all.iter_mut().enumerate() {
        entry.name = format!("{index} {:?}", entry.field);
        entry.name.truncate(400);
    }
    all
}

/// The entries whose value can be computed on the CPU.
pub fn on_cpu() -> Vec<Entry> {
    let all = entries().into_iter();
    all.filter(|entry| entry.truth.is_none()).collect()
}

/// The field at the origin, and the moved field. A basic shape alone has no shader functions of its own, so it becomes
/// the only child of a union.
pub fn surfaces(entry: &Entry) -> [Surface; 2] {
    let field = entry.field.clone();
    let plain = Surface::new(match field.is_basic() {
        true => Shape::union([field]),
        false => field,
    });
    let turn = Quat::from_euler(EulerRot::XYZEx, 0.4, -1.1, 2.3);
    [
        plain.clone(),
        plain.at(Vec3::new(3.5, -7.25, 11.125)).turned(turn),
    ]
}

/// Converts a point in world axes to the surface's own axes.
pub fn to_local(surface: &Surface, p: Vec3) -> DVec3 {
    let turn = surface.rotation.as_dquat().normalize();
    turn.inverse() * (p.as_dvec3() - surface.position.as_dvec3())
}

pub fn to_world(surface: &Surface, p: DVec3) -> Vec3 {
    let turn = surface.rotation.as_dquat().normalize();
    (turn * p + surface.position.as_dvec3()).as_vec3()
}

pub fn scene_of(surfaces: Vec<Surface>) -> Scene {
    Scene::new(
        "fields",
        surfaces,
        Source::at(Vec3::ZERO),
        Listener::at(Vec3::splat(900.0), 1e-3),
    )
}

/// Protects the table: it contains every kind of node, and all entries are valid.
#[test]
fn every_node_is_in_the_table() {
    let mut found = [false; KINDS];
    for entry in entries() {
        for node in entry.field.nodes() {
            found[kind(&node.node)] = true;
        }
        assert_eq!(entry.field.check(), Ok(()), "{}", entry.name);
    }
    assert_eq!(found, [true; KINDS]);
}
