//! The names of sources and listeners in the plan.

use echomarch::scene::Scene;

/// The names of the sources: those of the scene, otherwise `source`, or `source 2` beside others.
pub fn source_names(scene: &Scene) -> Vec<String> {
    let names = scene.sources.iter().map(|source| &source.name);
    named(names, "source", scene.sources.len())
}

/// The names of the listeners: those of the scene, otherwise `listener`, or `listener 2` beside others.
pub fn listener_names(scene: &Scene) -> Vec<String> {
    let names = scene.listeners.iter().map(|listener| &listener.name);
    named(names, "listener", scene.listeners.len())
}

fn named<'a>(
    names: impl Iterator<Item = &'a Option<String>>,
    what: &str,
    count: usize,
) -> Vec<String> {
    let name = |(index, name): (usize, &Option<String>)| match name {
        Some(name) => name.clone(),
        None if count == 1 => what.to_owned(),
        None => format!("{what} {}", index + 1),
    };
    names.enumerate().map(name).collect()
}
