//! For games: a world of sources, surfaces and a listener, whose sound is traced on threads of its own.
//!
//! A [`Simulator`] needs no window. A game adds and moves objects by their ids, and [commits](Simulator::commit) the
//! world once per picture. A worker thread traces the committed world, and the game reads what was
//! [heard](Simulator::updates) of each source: the direct way, echoes with stable keys, and the reverberation. No call
//! waits for the workers. `docs/games.md` describes the loop, the levels, the threads and the costs.
//!
//! # Threads
//! Two workers have a context each. One traces. If the surfaces of a commit need other programs, the other worker
//! compiles them, while the first continues with the surfaces that it has; then they change roles. Every lock between
//! the threads is held for a swap or a look-up.
//!
//! # Work
//! In each round the tracing worker finds the direct ways of all sources, and traces as many sources as fit the given
//! milliseconds: those first that have moved and waited longest, times their priority. If one trace does not fit, it
//! has fewer waves. Ways around obstacles (diffraction) take a quarter of a round's time at most, on average; until they
//! are found, a hidden source keeps the ways that were found last. A source that has not moved is traced a few times
//! more, and its late energies are averaged. If nothing changes, the workers sleep.
//!
//! ```
//! use echomarch::simulator::{Pose, Simulator, SimulatorSettings};
//! use echomarch::{Scene, Source};
//!
//! let mut simulator = Simulator::new(SimulatorSettings::default())?;
//! let room = Scene::builtin("shoebox")?;
//! for surface in &room.surfaces {
//!     simulator.add_surface(surface.clone().with_material("brick"))?;
//! }
//! let dog = simulator.add_source(Source::at([-3.5, 0.5, -5.0]))?;
//! simulator.place_listener(Pose::at([2.0, -0.5, 3.0]))?;
//! simulator.commit();
//! // A game goes on with its pictures, and asks again in each of them.
//! let heard = loop {
//!     match simulator.updates(dog) {
//!         Some(heard) if heard.traces > 0 => break heard,
//!         _ => std::thread::sleep(std::time::Duration::from_millis(1)),
//!     }
//! };
//! assert!(heard.direct.is_in_sight && !heard.echoes.is_empty());
//! # Ok::<(), echomarch::Error>(())
//! ```

mod ears;
mod encoder;
mod engine;
mod error;
mod fit;
mod hall;
mod head;
mod head_filter;
mod head_tracker;
mod heard;
mod messages;
mod network;
mod pose;
mod reverb;
mod settings;
mod slots;
mod stage;
mod taps;
#[cfg(test)]
mod tests;
mod update;
mod voice;
mod worker;
mod world;

pub use ears::{Ears, EarsSpec, Mix};
pub use encoder::EarsFormat;
pub use error::SimulatorError;
pub use head_tracker::HeadTracker;
pub use pose::Pose;
pub use reverb::Reverb;
pub use settings::SimulatorSettings;
pub use stage::SimulatorState;
pub use update::{DirectWay, EarlyEcho, Update};

use crate::error::Error;
use crate::scene::{Scene, Source, Surface};
use encoder::Encoder;
use engine::Shared;
use hall::Hall;
use head::Heads;
use messages::Subscriber;
use slots::Key;
use std::fmt;
use std::sync::Arc;
use worker::Workers;
use world::World;

/// Priorities above 0, up to this one.
const GREATEST_PRIORITY: f32 = 1e6;

/// Protects games that share a simulator between threads.
const _: () = {
    const fn may_be_shared<T: Send + Sync>() {}
    may_be_shared::<Simulator>();
};

/// The id of a source. An id of a removed source is never that of another one of the same simulator. Other simulators
/// may have the same ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SourceId(Key);

/// The id of a surface. An id of a removed surface is never that of another one of the same simulator. Other simulators
/// may have the same ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SurfaceId(Key);

/// The ids of the objects of a scene, in the order of the scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SceneIds {
    /// The surfaces.
    pub surfaces: Vec<SurfaceId>,
    /// The sources.
    pub sources: Vec<SourceId>,
}

/// A world of sources, surfaces and a listener, whose sound is traced on threads of its own. The [module](self) has an
/// example.
///
/// Edits change the world of the caller only; [`Simulator::commit`] hands it to the workers. A world may be empty. The
/// listener is at the origin until it is placed.
pub struct Simulator {
    world: World,
    settings: SimulatorSettings,
    shared: Arc<Shared>,
    workers: Workers,
    heads: Heads,
    head_tracker: HeadTracker,
}

impl Simulator {
    /// Starts the threads, and waits until the first one has a context.
    ///
    /// # Errors
    /// [`Error::Simulator`] for a setting out of its range, and if the system starts no thread; [`Error::Gpu`] without a
    /// renderer.
    pub fn new(settings: SimulatorSettings) -> Result<Simulator, Error> {
        settings.validate()?;
        let shared = Arc::new(Shared::default());
        Ok(Simulator {
            world: World::new(),
            workers: Workers::start(&settings, &shared)?,
            settings,
            shared,
            heads: Heads::default(),
            head_tracker: HeadTracker::new(),
        })
    }

    /// The name of the renderer.
    pub fn renderer(&self) -> &str {
        &self.workers.renderer
    }

    /// The settings.
    pub fn settings(&self) -> &SimulatorSettings {
        &self.settings
    }

    /// Adds the objects of a scene in its current state, and takes its materials, scattering and air. Key frames are not
    /// followed. The listener goes to the scene's first listener, if there is one.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`], and more than 256 sources. Objects before the one at fault are added.
    pub fn add_scene(&mut self, scene: &Scene) -> Result<SceneIds, Error> {
        self.world.set_medium(scene)?;
        let mut ids = SceneIds::default();
        for surface in &scene.surfaces {
            ids.surfaces.push(self.world.add_surface(surface.clone())?);
        }
        for source in &scene.sources {
            ids.sources.push(self.world.add_source(source.clone())?);
        }
        if let Some(listener) = scene.listeners.first() {
            let (right, up) = (listener.right(), listener.up());
            let turn = glam::Mat3::from_cols(right, up, -listener.forward());
            let pose = Pose {
                position: listener.position,
                rotation: glam::Quat::from_mat3(&turn),
            };
            self.world.set_listener(pose, Some(listener.radius))?;
        }
        Ok(ids)
    }

    /// Takes the materials, the scattering and the air of a scene, without its objects.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`], also if a surface of the world has a material that the scene lacks; then
    /// the world is unchanged.
    pub fn set_medium(&mut self, of: &Scene) -> Result<(), Error> {
        self.world.set_medium(of)
    }

    /// Adds a surface at its position and with its rotation. A surface that will turn should be
    /// [`turning`](Surface::turning), so that its first turn compiles nothing.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`]; then the world is unchanged.
    pub fn add_surface(&mut self, surface: Surface) -> Result<SurfaceId, Error> {
        self.world.add_surface(surface)
    }

    /// Replaces shape and materials of a surface. Its pose stays. Other numbers of the same shape compile nothing.
    ///
    /// # Errors
    /// [`SimulatorError::NoSurface`] and the errors of [`Scene::validate`]; then the world is unchanged.
    pub fn set_surface(&mut self, id: SurfaceId, surface: Surface) -> Result<(), Error> {
        self.world.set_surface(id, surface)
    }

    /// Moves and turns a surface.
    ///
    /// # Errors
    /// [`SimulatorError::NoSurface`] and [`SimulatorError::BadPose`]; then the world is unchanged.
    pub fn place_surface(&mut self, id: SurfaceId, pose: Pose) -> Result<(), SimulatorError> {
        let pose = SimulatorError::unless_possible(pose, "surface")?;
        let placed = self.world.surface(id)?;
        placed.turns |= pose.rotation != placed.pose.rotation;
        placed.pose = pose;
        Ok(())
    }

    /// Sets whether a surface is there.
    ///
    /// # Errors
    /// [`SimulatorError::NoSurface`].
    pub fn enable_surface(
        &mut self,
        id: SurfaceId,
        is_enabled: bool,
    ) -> Result<(), SimulatorError> {
        self.world.surface(id)?.is_enabled = is_enabled;
        Ok(())
    }

    /// Removes a surface.
    ///
    /// # Errors
    /// [`SimulatorError::NoSurface`].
    pub fn remove_surface(&mut self, id: SurfaceId) -> Result<(), SimulatorError> {
        self.world.remove_surface(id)
    }

    /// Adds a source at its position and with its orientation, level and directivity. Its name and its path are not
    /// used.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`], and more than 256 sources; then the world is unchanged.
    pub fn add_source(&mut self, source: Source) -> Result<SourceId, Error> {
        self.world.add_source(source)
    }

    /// Moves and turns a source, also about its axis.
    ///
    /// # Errors
    /// [`SimulatorError::NoSource`] and [`SimulatorError::BadPose`]; then the world is unchanged.
    pub fn place_source(&mut self, id: SourceId, pose: Pose) -> Result<(), SimulatorError> {
        let pose = SimulatorError::unless_possible(pose, "source")?;
        self.world.source(id)?.pose = pose;
        Ok(())
    }

    /// Sets whether a source sounds. A source that does not sound takes no time and has no updates.
    ///
    /// # Errors
    /// [`SimulatorError::NoSource`].
    pub fn enable_source(&mut self, id: SourceId, is_enabled: bool) -> Result<(), SimulatorError> {
        self.world.source(id)?.is_enabled = is_enabled;
        Ok(())
    }

    /// Sets the priority of a source, 1 at first: a source with twice the priority is traced about twice as often.
    ///
    /// # Errors
    /// [`SimulatorError::NoSource`]; [`SimulatorError::BadNumber`] unless the priority is above 0 and at most 10⁶.
    pub fn set_priority(&mut self, id: SourceId, priority: f32) -> Result<(), SimulatorError> {
        if !(priority > 0.0 && priority <= GREATEST_PRIORITY) {
            return Err(SimulatorError::BadNumber {
                what: "the priority of a source",
                must: "above 0 and at most 1e6",
                value: priority.into(),
            });
        }
        self.world.source(id)?.priority = priority;
        Ok(())
    }

    /// Sets the level of a source in decibels, −120 to 120.
    ///
    /// # Errors
    /// [`SimulatorError::NoSource`] and [`SimulatorError::BadNumber`]; then the world is unchanged.
    pub fn set_level(&mut self, id: SourceId, level_db: f32) -> Result<(), SimulatorError> {
        if !(-120.0..=120.0).contains(&level_db) {
            return Err(SimulatorError::BadNumber {
                what: "the level of a source in decibels",
                must: "-120 to 120",
                value: level_db.into(),
            });
        }
        self.world.source(id)?.level_db = level_db;
        Ok(())
    }

    /// Removes a source.
    ///
    /// # Errors
    /// [`SimulatorError::NoSource`].
    pub fn remove_source(&mut self, id: SourceId) -> Result<(), SimulatorError> {
        self.world.remove_source(id)
    }

    /// Places the listener. The radius of its sphere stays: 0.3 m at first.
    ///
    /// # Errors
    /// [`SimulatorError::BadPose`]; then the world is unchanged.
    pub fn place_listener(&mut self, pose: Pose) -> Result<(), SimulatorError> {
        self.world.set_listener(pose, None)
    }

    /// A handle that turns the head of the listener, from any thread and without a commit.
    pub fn head_tracker(&self) -> HeadTracker {
        self.head_tracker.clone()
    }

    /// Hands the world to the workers, and returns the number of this commit. Every object was checked when it was added
    /// or moved, so this copies ids and poses only. It does not wait; a commit that no worker has taken yet is replaced.
    pub fn commit(&mut self) -> u64 {
        let snapshot = self.world.commit();
        let number = snapshot.number;
        self.shared.commit(Box::new(snapshot));
        number
    }

    /// What was heard of a source last. `None` before its first round, and for a source that is removed or disabled.
    pub fn updates(&self, id: SourceId) -> Option<Arc<Update>> {
        self.shared.update(id)
    }

    /// The sound of one source, for an audio callback. It may be made before the source is traced, and is silent until
    /// then. `spec.sources` is not used.
    ///
    /// # Errors
    /// [`SimulatorError::NoSource`] and the errors of [`Simulator::mix`].
    pub fn ears(&mut self, id: SourceId, spec: &EarsSpec) -> Result<Ears, SimulatorError> {
        self.world.source(id)?;
        let spec = spec.clone().with_sources(1);
        let mix = self.heard_by(&spec, Some(id))?;
        Ok(Ears { mix })
    }

    /// The sound of all sources, for an audio callback. A head is analysed on a thread of its own, once for all mixes;
    /// until then, the mix is silent.
    ///
    /// # Errors
    /// [`SimulatorError::BadNumber`] for a number of the format out of its range; [`SimulatorError::Head`] for a head
    /// that cannot be converted to the rate; [`SimulatorError::NoThread`] if the system starts no thread for the head.
    pub fn mix(&self, spec: &EarsSpec) -> Result<Mix, SimulatorError> {
        self.heard_by(spec, None)
    }

    fn heard_by(&self, spec: &EarsSpec, only: Option<SourceId>) -> Result<Mix, SimulatorError> {
        spec.validate()?;
        let encoder = Encoder::of(&spec.format, spec.rate_hz, &self.heads)?;
        let (mix, ends) = Mix::new(spec, encoder, self.head_tracker());
        let settings = (spec.rate_hz, spec.sources, only);
        self.shared.subscribe(Subscriber::new(settings, ends));
        Ok(mix)
    }

    /// The state of the workers.
    pub fn state(&self) -> SimulatorState {
        self.shared.state()
    }

    /// Whether the world as it is now would have programs compiled aside if it were committed. The surfaces that are
    /// heard would stay as they are until the programs are ready.
    pub fn would_compile(&self) -> bool {
        let hall = Hall::of(&self.world.snapshot());
        !self
            .shared
            .is_compiled(engine::key_of(&hall, &self.settings))
    }
}

impl Drop for Simulator {
    /// Ends the threads after the trace that is under way.
    fn drop(&mut self) {
        self.workers.end(&self.shared);
    }
}

impl fmt::Debug for Simulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Simulator")
            .field("renderer", &self.workers.renderer)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}
