//! Trees of fidget as surfaces of a scene.

use echomarch::gl::{Context, ContextOptions};
use echomarch::glam::{DVec3, Vec3};
use echomarch::scene::UserField;
use echomarch::scene::shape::User;
use echomarch::tracer::FieldTrial;
use echomarch::{Error, Listener, Scene, Settings, Source, Surface, Tracer};
use echomarch_fidget::{TreeError, user_field};
use fidget_core::context::Tree;
use fidget_core::var::Var;
use std::sync::Arc;

/// A ring with a wave along it, without a bite.
fn ring() -> Tree {
    let (x, y, z) = Tree::axes();
    let bite = (x.clone() - 1.0).square() + y.square() + z.square();
    let wave = (x.clone() * 4.0).sin() * 0.05;
    let along = (x.square() + z.square()).sqrt() - 1.0;
    let ring = (along.square() + y.square()).sqrt() - 0.4 + wave;
    ring.max(0.5 - bite.sqrt())
}

/// Protects exact paths and the march: the value on the CPU is that of fidget, and the text has the same value on the
/// GPU, where the tracer compares both before the first frame.
#[test]
fn a_tree_is_traced_with_its_own_values() -> Result<(), Error> {
    let field = user_field("ring", &ring(), Vec3::splat(3.2), 1.5).unwrap();
    assert_values(&field, &ring());
    let surface = Surface::new(User {
        field: Arc::new(field),
    });
    let (source, listener) = (
        Source::at([2.0, 0.5, 0.0]),
        Listener::at([-2.0, 0.5, 1.0], 0.5),
    );
    let scene = Scene::new("ring", vec![surface], source, listener);
    FieldTrial::InThisProcess.set();
    let context = Context::headless(&ContextOptions::default())?;
    let mut tracer = Tracer::new(&context)?;
    let frame = tracer.frame(&scene, &Settings::default().with_waves(4096))?;
    assert!(frame.counts.listener_hits > 0);
    Ok(())
}

/// Compares the value on the CPU with that of fidget, in `f32`, at points within 1.5 m.
fn assert_values(field: &UserField, tree: &Tree) {
    let mut context = fidget_core::Context::new();
    let root = context.import(tree);
    for k in 0..500 {
        let share = |by: f64| 3.0 * (f64::from(k) * by).fract() - 1.5;
        let p = DVec3::new(share(0.618), share(0.755), share(0.57));
        let of_fidget = context.eval_xyz(root, p.x as f32, p.y as f32, p.z as f32);
        let off = field.value(p) - f64::from(of_fidget.unwrap());
        assert!(off.abs() < 1e-4, "{p}: {off}");
    }
}

/// Protects the value of each operation on the CPU. The tracer compares it with the text on the GPU.
#[test]
fn every_operation_has_the_value_of_fidget() {
    let (x, y, z) = Tree::axes();
    let wide = x.square() + y.square() + z.square() + 1.0;
    let one = || x.clone() * 0.5;
    let trees = [
        one().neg(),
        one().abs(),
        wide.clone().recip(),
        wide.clone().sqrt(),
        one().floor(),
        one().ceil(),
        one().sin(),
        one().cos(),
        one().tan(),
        one().asin(),
        one().acos(),
        one().atan(),
        one().exp(),
        wide.clone().ln(),
        y.clone() - one(),
        y.clone() / wide.clone(),
        y.atan2(one()),
        y.min(one()),
        y.max(one()),
        y.modulo(wide),
    ];
    for tree in trees {
        let field = user_field("tree", &tree, Vec3::splat(3.0), 1.0).unwrap();
        assert_values(&field, &tree);
    }
}

/// Protects callers from fields that would be silently wrong: operations without a counterpart are named.
#[test]
fn unsupported_trees_are_refused() {
    let refused = |tree: Tree| user_field("tree", &tree, Vec3::ONE, 1.0).unwrap_err();
    let compared = refused(Tree::x().compare(Tree::y()));
    assert!(compared.to_string().contains("Compare"), "{compared}");
    assert_eq!(refused(Tree::from(Var::new()) + 1.0), TreeError::Variable);
    let endless = refused(Tree::x() + f32::INFINITY);
    assert!(matches!(endless, TreeError::Number { .. }), "{endless}");
}
