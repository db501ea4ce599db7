//! Users' GLSL fields: rejected texts and their messages, the results of the renderer's checks, stated gradients, and
//! scenes that are reloaded when their files change.

mod advice;
mod checks;
mod gradients;
mod names;
mod on_the_cpu;
mod reload;
mod shadertoy;
mod where_waves_are;

use crate::common::field_files::BALL;
use echomarch::gl::Context;
use echomarch::scene::shape::{Room, User};
use echomarch::scene::{Node, UserField};
use echomarch::{Listener, Profile, Scene, Settings, Source, Surface, Tracer};
use glam::Vec3;
use std::sync::Arc;

fn user(text: &str, lipschitz: f32) -> Arc<UserField> {
    let size = Vec3::new(3.0, 4.0, 5.0);
    Arc::new(UserField::new("my.glsl", text.to_owned(), size, lipschitz))
}

/// Returns a room with users' fields in a row along x.
fn scene(fields: &[Arc<UserField>]) -> Scene {
    let room = Node::Room(Room {
        size: Vec3::splat(20.0),
    });
    let mut surfaces = vec![Surface::new(room)];
    for (index, field) in fields.iter().enumerate() {
        let node = Node::User(User {
            field: Arc::clone(field),
        });
        let along = 5.0 * index as f32 - 2.5;
        surfaces.push(Surface::new(node).at(Vec3::new(along, 0.0, -5.0)));
    }
    Scene::new(
        "fields",
        surfaces,
        Source::at(Vec3::new(4.0, 2.0, 3.0)),
        Listener::at(Vec3::new(-4.0, -2.0, 4.0), 1.0),
    )
}

fn settings(profile: Profile) -> Settings {
    Settings::new(profile).with_waves(4096).with_iterations(6)
}

fn refusal(context: &Context, text: &str, lipschitz: f32) -> String {
    let scene = scene(&[user(text, lipschitz)]);
    let mut tracer = Tracer::new(context).unwrap();
    let error = tracer
        .frame(&scene, &settings(Profile::Hybrid))
        .unwrap_err();
    assert!(error.is_bad_input(), "{error}");
    let sentence = error.to_string();
    assert!(
        !sentence.contains('\n') && !sentence.contains("user0_"),
        "{sentence}"
    );
    sentence
}
