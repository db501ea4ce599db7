//! A [Bevy](https://docs.rs/bevy) plugin for [`echomarch::simulator`]: the sound of entities, traced through the surfaces
//! of other entities.
//!
//! Entities with [`SoundSource`], [`SoundSurface`] or [`SoundListener`] and a `Transform` are added to the simulator,
//! follow their `GlobalTransform` without its scale, and are removed with their component or entity. [`Heard`] has what
//! is heard of each source. Audio comes from [`Acoustics::mix`]. Bevy's axes are those of Echomarch: x to the right, y
//! up, −z ahead, in metres.

use bevy_app::{App, Plugin, PostUpdate};
use bevy_ecs::prelude::*;
use bevy_transform::TransformSystems;
use bevy_transform::components::{GlobalTransform, Transform};
use echomarch::simulator::{
    EarsSpec, Mix, Pose, Simulator, SimulatorError, SimulatorSettings, SimulatorState, SourceId,
    SurfaceId, Update,
};
use echomarch::{Error, Source, Surface};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// A source of sound. The position and the directions of the given source are not used; a changed component replaces the
/// source, under another id.
#[derive(Component, Clone, Debug)]
#[require(Transform)]
pub struct SoundSource(pub Source);

impl Default for SoundSource {
    /// Returns a source of 0 dB that sounds alike in all directions.
    fn default() -> SoundSource {
        SoundSource(Source::at([0.0; 3]))
    }
}

/// A surface that reflects sound. The pose of the given surface is not used. Add surfaces that will turn as
/// [`Surface::turning`].
#[derive(Component, Clone, Debug)]
#[require(Transform)]
pub struct SoundSurface(pub Surface);

/// The listener. If there are several, one of them hears.
#[derive(Component, Clone, Copy, Debug, Default)]
#[require(Transform)]
pub struct SoundListener;

/// What is heard of each source, by its entity. Sources that were not traced yet have no entry.
#[derive(Resource, Clone, Debug, Default)]
pub struct Heard(pub HashMap<Entity, Arc<Update>>);

/// The simulator, and its objects by their entities.
#[derive(Resource, Debug)]
pub struct Acoustics {
    simulator: Simulator,
    sources: HashMap<Entity, SourceId>,
    surfaces: HashMap<Entity, SurfaceId>,
    refused: HashMap<Entity, Arc<Error>>,
}

impl Acoustics {
    /// The sound of all sources, for an audio callback: see [`Mix::process`].
    ///
    /// # Errors
    /// [`SimulatorError::BadNumber`] for a number of the format out of its range.
    pub fn mix(&self, spec: &EarsSpec) -> Result<Mix, SimulatorError> {
        self.simulator.mix(spec)
    }

    /// The simulator's id of a source, which the function of [`Mix::process`] is given.
    pub fn source(&self, entity: Entity) -> Option<SourceId> {
        self.sources.get(&entity).copied()
    }

    /// Entities whose source, surface or pose the simulator refused, and the last reason of each.
    pub fn refused(&self) -> &HashMap<Entity, Arc<Error>> {
        &self.refused
    }

    /// The state of the simulator's threads.
    pub fn state(&self) -> SimulatorState {
        self.simulator.state()
    }

    /// The simulator, for materials and settings that have no component.
    pub fn simulator(&mut self) -> &mut Simulator {
        &mut self.simulator
    }

    /// Keeps the reason of a refusal. `None` if there is one.
    fn note<T>(&mut self, entity: Entity, result: Result<T, Error>) -> Option<T> {
        result
            .map_err(|error| self.refused.insert(entity, Arc::new(error)))
            .ok()
    }
}

/// Adds [`Acoustics`], [`Heard`], and the systems that follow the entities after Bevy's propagation of transforms.
pub struct EchomarchPlugin {
    simulator: Mutex<Option<Simulator>>,
}

impl EchomarchPlugin {
    /// Starts a simulator.
    ///
    /// # Errors
    /// The errors of [`Simulator::new`]: the game then plays without it.
    pub fn start(settings: SimulatorSettings) -> Result<EchomarchPlugin, Error> {
        let simulator = Mutex::new(Some(Simulator::new(settings)?));
        Ok(EchomarchPlugin { simulator })
    }
}

impl Plugin for EchomarchPlugin {
    fn build(&self, app: &mut App) {
        let mut place = self
            .simulator
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // An application builds a plugin once.
        let Some(simulator) = place.take() else {
            return;
        };
        app.insert_resource(Acoustics {
            simulator,
            sources: HashMap::new(),
            surfaces: HashMap::new(),
            refused: HashMap::new(),
        });
        app.init_resource::<Heard>();
        let systems = (remove, add_sources, add_surfaces, place_listener, commit).chain();
        app.add_systems(PostUpdate, systems.after(TransformSystems::Propagate));
    }
}

fn pose(transform: &GlobalTransform) -> Pose {
    let (_, rotation, position) = transform.to_scale_rotation_translation();
    Pose::at(position.to_array()).turned(rotation.to_array())
}

/// Takes the entry of an entity whose component is gone.
fn taken<Id, T: Component>(
    ids: &mut HashMap<Entity, Id>,
    removed: &mut RemovedComponents<T>,
    present: &Query<(), With<T>>,
) -> Vec<Id> {
    // A component may have been removed and inserted again.
    let gone = removed.read().filter(|entity| !present.contains(*entity));
    gone.filter_map(|entity| ids.remove(&entity)).collect()
}

fn remove(
    mut acoustics: ResMut<Acoustics>,
    mut gone_sources: RemovedComponents<SoundSource>,
    mut gone_surfaces: RemovedComponents<SoundSurface>,
    sources: Query<(), With<SoundSource>>,
    surfaces: Query<(), With<SoundSurface>>,
) {
    let acoustics = &mut *acoustics;
    // An id of the own table is known to the simulator.
    for id in taken(&mut acoustics.sources, &mut gone_sources, &sources) {
        let _ = acoustics.simulator.remove_source(id);
    }
    for id in taken(&mut acoustics.surfaces, &mut gone_surfaces, &surfaces) {
        let _ = acoustics.simulator.remove_surface(id);
    }
    let is_there = |entity: &Entity| sources.contains(*entity) || surfaces.contains(*entity);
    acoustics.refused.retain(|entity, _| is_there(entity));
}

type Moved<T> = Or<(Changed<T>, Changed<GlobalTransform>)>;

fn add_sources(
    mut acoustics: ResMut<Acoustics>,
    changed: Query<(Entity, Ref<SoundSource>, &GlobalTransform), Moved<SoundSource>>,
) {
    for (entity, source, transform) in &changed {
        if source.is_changed() {
            if let Some(old) = acoustics.sources.remove(&entity) {
                let _ = acoustics.simulator.remove_source(old);
            }
            let added = acoustics.simulator.add_source(source.0.clone());
            if let Some(id) = acoustics.note(entity, added) {
                acoustics.sources.insert(entity, id);
            }
        }
        if let Some(id) = acoustics.source(entity) {
            let placed = acoustics.simulator.place_source(id, pose(transform));
            acoustics.note(entity, placed.map_err(Error::from));
        }
    }
}

fn add_surfaces(
    mut acoustics: ResMut<Acoustics>,
    changed: Query<(Entity, Ref<SoundSurface>, &GlobalTransform), Moved<SoundSurface>>,
) {
    for (entity, surface, transform) in &changed {
        let known = acoustics.surfaces.get(&entity).copied();
        if surface.is_changed() {
            let surface = surface.0.clone();
            let set = match known {
                Some(id) => acoustics.simulator.set_surface(id, surface).map(|()| id),
                None => acoustics.simulator.add_surface(surface),
            };
            if let Some(id) = acoustics.note(entity, set) {
                acoustics.surfaces.insert(entity, id);
            }
        }
        if let Some(id) = acoustics.surfaces.get(&entity).copied() {
            let placed = acoustics.simulator.place_surface(id, pose(transform));
            acoustics.note(entity, placed.map_err(Error::from));
        }
    }
}

fn place_listener(
    mut acoustics: ResMut<Acoustics>,
    listeners: Query<(Entity, &GlobalTransform), With<SoundListener>>,
) {
    if let Some((entity, transform)) = listeners.iter().next() {
        let placed = acoustics.simulator.place_listener(pose(transform));
        acoustics.note(entity, placed.map_err(Error::from));
    }
}

fn commit(mut acoustics: ResMut<Acoustics>, mut heard: ResMut<Heard>) {
    acoustics.simulator.commit();
    let update =
        |(entity, id): (&Entity, &SourceId)| Some((*entity, acoustics.simulator.updates(*id)?));
    let updates: HashMap<_, _> = acoustics.sources.iter().filter_map(update).collect();
    heard.0 = updates;
}
