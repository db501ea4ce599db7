//! A field's function on the CPU: it is used for exact paths, and must be that of the text.

use super::{scene, settings};
use crate::common::field_files::BALL;
use echomarch::gl::{Context, ContextOptions};
use echomarch::scene::UserField;
use echomarch::{Profile, Tracer};
use glam::{DVec3, Vec3};
use std::sync::Arc;

fn ball(cpu: fn(DVec3) -> f64) -> Arc<UserField> {
    let size = Vec3::new(3.0, 4.0, 5.0);
    Arc::new(UserField::new("my.glsl", BALL.to_owned(), size, 1.0).with_cpu(cpu))
}

/// Protects exact paths from a function of another surface: the right one is accepted and gives its own values, a ball
/// of another radius is bad input, and the message names the file.
#[test]
fn the_function_is_compared_with_the_text() {
    let context = Context::headless(&ContextOptions::default()).unwrap();
    let mut tracer = Tracer::new(&context).unwrap();
    let right = ball(|p| p.length() - 1.0);
    assert_eq!(right.value(DVec3::new(0.0, 0.0, 2.0)), 1.0);
    let settings = settings(Profile::Hybrid);
    tracer.frame(&scene(&[right]), &settings).unwrap();
    let wrong = ball(|p| p.length() - 1.1);
    let error = tracer.frame(&scene(&[wrong]), &settings).unwrap_err();
    assert!(error.is_bad_input(), "{error}");
    let sentence = error.to_string();
    assert!(
        sentence.starts_with("my.glsl: the function on the CPU is "),
        "{sentence}"
    );
}

/// Protects callers who ask for distances before the renderer has sampled the field: it is not a surface everywhere.
#[test]
fn an_unknown_field_has_no_surface() {
    let size = Vec3::splat(2.0);
    let field = UserField::new("my.glsl", BALL.to_owned(), size, 1.0);
    assert_eq!(field.value(DVec3::ZERO), 2.0);
}
