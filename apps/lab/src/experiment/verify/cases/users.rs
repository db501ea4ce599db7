//! Users' fields in small and in large boxes. The reference uses shapes of the library that describe the same surface
//! independently.

use super::super::Case;
use super::build::{lattice, room, scene};
use super::fields::slab_behind;
use echomarch::scene::shape::{Cuboid, HalfSpace, Sphere, Torus, User};
use echomarch::scene::{Listener, Node, Scene, Shape, Surface, UserField};
use glam::{EulerRot, Quat, Vec3};
use std::sync::Arc;

/// Number of flights: to the field, away from the field, and one more.
const ITERATIONS: u32 = 3;

/// The difficulty of a field without a gradient function.
const VALUES: &str = "the user's field returns only values, with the rounding errors of its GLSL";

/// The difficulty of a field with a gradient function.
const STATED: &str = "the normal comes from the user's GLSL, also at edges";

/// The exact answer, from the reference.
const TREE: &str = "the answer of library shapes that describe the same surface";

/// A surface in two descriptions: GLSL, and shapes of the library.
struct Statement {
    /// The GLSL text.
    text: &'static str,
    /// The maximum gradient of the field's value, in a cube of the given size.
    lipschitz: fn(f32) -> f32,
    /// A tree of library shapes that describes the same surface.
    tree: Shape,
}

fn ball() -> Statement {
    Statement {
        text: "float field(vec3 p) { return length(p) - 1.0; }",
        lipschitz: |_| 1.0,
        tree: Shape::from(Node::Sphere(Sphere { radius: 1.0 })),
    }
}

/// An offset to coordinates of ten times the radius, where the rounding error is ten times as large.
const AWAY: Vec3 = Vec3::new(10.0, -4.0, 8.0);

fn ball_away() -> Statement {
    Statement {
        text: "float field(vec3 p) { return distance(p, vec3(10.0, -4.0, 8.0)) - 1.0; }",
        lipschitz: |_| 1.0,
        tree: ball().tree.translate(AWAY),
    }
}

fn torus() -> Statement {
    Statement {
        text: "float field(vec3 p) { return length(vec2(length(p.xz) - 1.2, p.y)) - 0.4; }",
        lipschitz: |_| 1.0,
        tree: Shape::from(Node::Torus(Torus {
            ring: 1.2,
            tube: 0.4,
        })),
    }
}

/// The torus as a difference of squares. The value of this field is not a distance, and its gradient is much larger far
/// away.
fn torus_squared() -> Statement {
    Statement {
        text: "float field(vec3 p) {
            float beside = length(p.xz) - 1.2;
            return beside * beside + p.y * p.y - 0.4 * 0.4;
        }",
        // Twice the largest distance between a corner of the cube and the ring.
        lipschitz: |size| 3f32.sqrt() * size,
        ..torus()
    }
}

fn blend() -> Statement {
    let ball = |radius, x, y, z| {
        Shape::from(Node::Sphere(Sphere { radius })).translate(Vec3::new(x, y, z))
    };
    Statement {
        text: "float field(vec3 p) {
            float a = length(p - vec3(-0.5, 0.0, 0.0)) - 0.8;
            float b = length(p - vec3(0.7, 0.3, 0.2)) - 0.6;
            float share = clamp(0.5 + 0.5 * (b - a) / 0.4, 0.0, 1.0);
            return mix(b, a, share) - 0.4 * share * (1.0 - share);
        }",
        lipschitz: |_| 1.0,
        tree: Shape::smooth_union(0.4, [ball(0.8, -0.5, 0.0, 0.0), ball(0.6, 0.7, 0.3, 0.2)]),
    }
}

/// A plane slope that ends at its cube. Displaced waves do not spread at the slope, so the accepted error is the
/// smallest of all cases.
fn slope(size: f32) -> Statement {
    let normal = Vec3::new(0.36, 0.8, -0.48);
    let half_space = Shape::from(Node::HalfSpace(HalfSpace {
        normal,
        offset: 0.25,
    }));
    let size = Vec3::splat(size);
    Statement {
        text: "const vec3 NORMAL = vec3(0.36, 0.8, -0.48);
            float field(vec3 p) { return dot(p, NORMAL) - 0.25; }
            vec3 fieldGradient(vec3 p) { return NORMAL; }",
        lipschitz: |_| 1.0,
        tree: Shape::intersection([half_space, Shape::from(Node::Cuboid(Cuboid { size }))]),
    }
}

/// A solid box. Normals from finite differences would round its edges.
fn brick() -> Statement {
    Statement {
        text: "const vec3 HALF = vec3(1.0, 0.6, 0.8);
        float field(vec3 p) {
            vec3 q = abs(p) - HALF;
            return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
        }
        vec3 fieldGradient(vec3 p) {
            vec3 q = abs(p) - HALF;
            vec3 side = vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
            float most = max(q.x, max(q.y, q.z));
            if (most > 0.0) {
                return side * normalize(max(q, 0.0));
            }
            return side * (q.x == most ? vec3(1, 0, 0) : q.y == most ? vec3(0, 1, 0) : vec3(0, 0, 1));
        }",
        lipschitz: |_| 1.0,
        tree: Shape::from(Node::Cuboid(Cuboid {
            size: Vec3::new(2.0, 1.2, 1.6),
        })),
    }
}

/// The blend with a gradient function in its GLSL text.
fn blend_stated() -> Statement {
    Statement {
        text: "const vec3 A = vec3(-0.5, 0.0, 0.0), B = vec3(0.7, 0.3, 0.2);
        float a(vec3 p) { return length(p - A) - 0.8; }
        float b(vec3 p) { return length(p - B) - 0.6; }
        float share(vec3 p) { return clamp(0.5 + 0.5 * (b(p) - a(p)) / 0.4, 0.0, 1.0); }
        float field(vec3 p) {
            return mix(b(p), a(p), share(p)) - 0.4 * share(p) * (1.0 - share(p));
        }
        // The derivative of the blending share cancels out.
        vec3 fieldGradient(vec3 p) {
            return mix(normalize(p - B), normalize(p - A), share(p));
        }",
        ..blend()
    }
}

pub fn cases() -> Vec<Case> {
    vec![
        in_a_room("user-ball", VALUES, &ball(), 2.2, Vec3::ZERO),
        in_a_room("user-ball-large-box", VALUES, &ball(), 100.0, Vec3::ZERO),
        in_a_room("user-ball-away", VALUES, &ball_away(), 40.0, -AWAY),
        in_a_room("user-torus", VALUES, &torus(), 4.0, Vec3::ZERO),
        in_a_room("user-torus-large-box", VALUES, &torus(), 100.0, Vec3::ZERO),
        in_a_room("user-blend", VALUES, &blend(), 3.0, Vec3::ZERO),
        in_a_room("user-blend-large-box", VALUES, &blend(), 100.0, Vec3::ZERO),
        in_a_room("user-slope-stated", STATED, &slope(2.0), 2.0, Vec3::ZERO),
        in_a_room(
            "user-slope-stated-large-box",
            STATED,
            &slope(12.0),
            12.0,
            Vec3::ZERO,
        ),
        in_a_room("user-brick-stated", STATED, &brick(), 3.0, Vec3::ZERO),
        in_a_room(
            "user-brick-stated-large-box",
            STATED,
            &brick(),
            100.0,
            Vec3::ZERO,
        ),
        in_a_room(
            "user-blend-stated",
            STATED,
            &blend_stated(),
            3.0,
            Vec3::ZERO,
        ),
        before_a_slab("user-torus-slab", Vec3::new(0.0, 0.0, 30.0)),
        before_a_slab("user-torus-slab-far", Vec3::new(900.0, 0.0, 400.0)),
    ]
}

/// Puts the GLSL field and the tree into a cube of this size, which is rotated and away from the centre of a room.
/// `moved` is an offset in the axes of the field.
fn in_a_room(
    name: &str,
    hard: &'static str,
    statement: &Statement,
    box_size: f32,
    moved: Vec3,
) -> Case {
    let world = |field: Shape| world(name, field, moved);
    twice(name, hard, statement, box_size, ITERATIONS, world)
}

/// The torus in front of a wide slab, grazed by rays from the source. The case has only one flight, because paths are
/// chaotic after the torus.
fn before_a_slab(name: &str, listener: Vec3) -> Case {
    let world = |field: Shape| slab_behind(name, field, listener);
    twice(name, VALUES, &torus_squared(), 4.0, 1, world)
}

/// Creates the case of a user's field. The reference uses the tree.
fn twice(
    name: &str,
    hard: &'static str,
    statement: &Statement,
    box_size: f32,
    iterations: u32,
    world: impl Fn(Shape) -> Scene,
) -> Case {
    let user = UserField::new(
        format!("{name}.glsl"),
        statement.text.to_owned(),
        Vec3::splat(box_size),
        (statement.lipschitz)(box_size),
    );
    let own = Shape::from(Node::User(User {
        field: Arc::new(user),
    }));
    Case::spread(name, hard, TREE, world(own), lattice(4096), iterations)
        .judged_by(world(statement.tree.clone()))
}

fn world(name: &str, field: Shape, moved: Vec3) -> Scene {
    let turn = Quat::from_euler(EulerRot::XYZEx, 0.4, -0.7, 0.2);
    let place = Vec3::new(1.0, -0.5, -2.0) + turn * moved;
    let surfaces = vec![
        room(16.0, 9.0, 12.0),
        Surface::new(field).at(place).turned(turn),
    ];
    let listener = Listener::at(Vec3::new(-4.0, 1.0, 3.0), 1.2);
    scene(name, surfaces, Vec3::new(5.0, 1.5, 2.0), listener)
}
