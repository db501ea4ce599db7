//! The world as the caller edits it, and the snapshots of it that a worker traces.

use super::slots::{Key, Slots};
use super::{Pose, SimulatorError, SourceId, SurfaceId};
use crate::error::Error;
use crate::scene::shape::Sphere;
use crate::scene::{Air, Listener, Material, Scene, Source, Surface};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum number of sources, and of listeners, in a scene.
const MOST_SOURCES: usize = 256;

/// Radius in metres of the listener of a world whose listener was never placed: a little more than that of a head.
const USUAL_RADIUS_M: f32 = 0.3;

/// Distance in metres of the ball that stands for an empty world. No sound returns from it within any record.
const NOTHING_M: f32 = 1e5;

/// A surface in the world.
#[derive(Clone, Debug)]
pub(super) struct PlacedSurface {
    /// The surface as it was added. Only its pose changes afterwards.
    pub surface: Arc<Surface>,
    pub pose: Pose,
    pub is_enabled: bool,
    /// Whether the surface was turned since it was added. Its programs then read a rotation.
    pub turns: bool,
}

/// A source in the world.
#[derive(Clone, Debug)]
pub(super) struct PlacedSource {
    /// The source as it was added.
    pub source: Arc<Source>,
    pub pose: Pose,
    pub level_db: f32,
    pub is_enabled: bool,
    /// The share of the work that the source gets relative to others, above 0.
    pub priority: f32,
}

/// Everything but surfaces, sources and the listener.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Medium {
    pub materials: BTreeMap<String, Material>,
    pub scattering: [f64; crate::bands::BAND_COUNT],
    pub air: Option<Air>,
}

/// The world at one commit. Shapes, directivities and materials are shared with the world.
#[derive(Clone, Debug)]
pub(super) struct Snapshot {
    /// Number of the commit, from 1.
    pub number: u64,
    pub medium: Arc<Medium>,
    pub surfaces: Vec<(SurfaceId, PlacedSurface)>,
    pub sources: Vec<(SourceId, PlacedSource)>,
    pub listener: Pose,
    pub radius_m: f32,
}

/// The caller's world.
#[derive(Debug)]
pub(super) struct World {
    surfaces: Slots<PlacedSurface>,
    sources: Slots<PlacedSource>,
    medium: Arc<Medium>,
    listener: Pose,
    radius_m: f32,
    commits: u64,
    /// A scene with the materials, in which single surfaces and sources are checked.
    bench: Scene,
}

impl World {
    pub fn new() -> World {
        let mut bench = Scene::new(
            "world",
            Vec::new(),
            Source::at([0.0; 3]),
            Listener::at([0.0; 3], USUAL_RADIUS_M),
        );
        bench.sources.clear();
        bench.listeners.clear();
        let medium = Medium {
            materials: BTreeMap::new(),
            scattering: bench.scattering,
            air: None,
        };
        World {
            surfaces: Slots::default(),
            sources: Slots::default(),
            medium: Arc::new(medium),
            listener: Pose::default(),
            radius_m: USUAL_RADIUS_M,
            commits: 0,
            bench,
        }
    }

    /// Sets materials, scattering and air to those of a scene, without its objects.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`]; then the world is unchanged.
    pub fn set_medium(&mut self, of: &Scene) -> Result<(), Error> {
        let mut bench = self.bench.clone();
        bench.materials.clone_from(&of.materials);
        (bench.scattering, bench.air) = (of.scattering, of.air);
        // Surfaces that are already there must find their materials.
        let placed = self.surfaces.iter();
        bench
            .surfaces
            .extend(placed.map(|(_, placed)| (*placed.surface).clone()));
        if bench.surfaces.is_empty() {
            bench.surfaces.push(nothing());
        }
        bench.validate()?;
        bench.surfaces.clear();
        self.medium = Arc::new(Medium {
            materials: bench.materials.clone(),
            scattering: bench.scattering,
            air: bench.air,
        });
        self.bench = bench;
        Ok(())
    }

    /// # Errors
    /// The errors of [`Scene::validate`] for this surface; then the world is unchanged.
    pub fn add_surface(&mut self, surface: Surface) -> Result<SurfaceId, Error> {
        let surface = self.checked_surface(surface)?;
        let pose = Pose {
            position: surface.position,
            rotation: surface.rotation,
        };
        let placed = PlacedSurface {
            surface: Arc::new(surface),
            pose,
            is_enabled: true,
            turns: false,
        };
        Ok(SurfaceId(self.surfaces.insert(placed)))
    }

    /// Replaces the shape and the materials of a surface. Its pose stays.
    ///
    /// # Errors
    /// [`SimulatorError::NoSurface`] and the errors of [`World::add_surface`]; then the world is unchanged.
    pub fn set_surface(&mut self, id: SurfaceId, surface: Surface) -> Result<(), Error> {
        self.surface(id)?;
        let surface = self.checked_surface(surface)?;
        self.surface(id)?.surface = Arc::new(surface);
        Ok(())
    }

    fn checked_surface(&mut self, mut surface: Surface) -> Result<Surface, Error> {
        // The simulator places its surfaces itself.
        surface.drivers.clear();
        self.bench.surfaces.push(surface.clone());
        let checked = self.bench.validate();
        self.bench.surfaces.clear();
        checked?;
        Ok(surface)
    }

    pub fn surface(&mut self, id: SurfaceId) -> Result<&mut PlacedSurface, SimulatorError> {
        let placed = self.surfaces.get_mut(id.0);
        placed.ok_or(SimulatorError::NoSurface(id))
    }

    pub fn remove_surface(&mut self, id: SurfaceId) -> Result<(), SimulatorError> {
        let removed = self.surfaces.remove(id.0);
        removed.map(drop).ok_or(SimulatorError::NoSurface(id))
    }

    /// # Errors
    /// The errors of [`Scene::validate`] for this source, and more than 256 sources; then the world is unchanged.
    pub fn add_source(&mut self, mut source: Source) -> Result<SourceId, Error> {
        if self.sources.count() >= MOST_SOURCES {
            return Err(SimulatorError::BadNumber {
                what: "the number of sources",
                must: "at most 256",
                value: (self.sources.count() + 1) as f64,
            }
            .into());
        }
        // Ids take the place of names, and poses that of paths.
        source.name = None;
        source.path = Default::default();
        self.bench.surfaces.push(nothing());
        self.bench.sources.push(source.clone());
        let checked = self.bench.validate();
        self.bench.surfaces.clear();
        self.bench.sources.clear();
        checked?;
        let turn = glam::Mat3::from_cols(source.right(), source.up(), -source.forward());
        let pose = Pose {
            position: source.position,
            rotation: glam::Quat::from_mat3(&turn),
        };
        let placed = PlacedSource {
            pose,
            level_db: source.level_db,
            source: Arc::new(source),
            is_enabled: true,
            priority: 1.0,
        };
        Ok(SourceId(self.sources.insert(placed)))
    }

    pub fn source(&mut self, id: SourceId) -> Result<&mut PlacedSource, SimulatorError> {
        let placed = self.sources.get_mut(id.0);
        placed.ok_or(SimulatorError::NoSource(id))
    }

    pub fn remove_source(&mut self, id: SourceId) -> Result<(), SimulatorError> {
        let removed = self.sources.remove(id.0);
        removed.map(drop).ok_or(SimulatorError::NoSource(id))
    }

    /// Places the listener; `radius_m` is the radius of the sphere that counts waves.
    pub fn set_listener(
        &mut self,
        pose: Pose,
        radius_m: Option<f32>,
    ) -> Result<(), SimulatorError> {
        let pose = SimulatorError::unless_possible(pose, "listener")?;
        if let Some(radius_m) = radius_m {
            if !(radius_m > 0.0 && radius_m <= 1e9) {
                return Err(SimulatorError::BadNumber {
                    what: "the listener's radius in metres",
                    must: "above 0 and at most 1e9",
                    value: radius_m.into(),
                });
            }
            self.radius_m = radius_m;
        }
        self.listener = pose;
        Ok(())
    }

    /// The world as it is now, for a worker. Copies only ids, poses and references.
    pub fn commit(&mut self) -> Snapshot {
        self.commits += 1;
        self.snapshot()
    }

    /// The world as it is now, without a commit.
    pub fn snapshot(&self) -> Snapshot {
        let enabled = |placed: &PlacedSurface| placed.is_enabled;
        let surfaces = self.surfaces.iter().filter(|(_, placed)| enabled(placed));
        let sources = self.sources.iter().filter(|(_, placed)| placed.is_enabled);
        Snapshot {
            number: self.commits,
            medium: Arc::clone(&self.medium),
            surfaces: surfaces
                .map(|(key, placed)| (SurfaceId(key), placed.clone()))
                .collect(),
            sources: sources
                .map(|(key, placed)| (SourceId(key), placed.clone()))
                .collect(),
            listener: self.listener,
            radius_m: self.radius_m,
        }
    }
}

/// The ball that stands for an empty world: scenes have at least one surface.
pub(super) fn nothing() -> Surface {
    Surface::new(Sphere { radius: 1.0 }).at(Vec3::new(0.0, -NOTHING_M, 0.0))
}

impl SourceId {
    /// The id as a number, for example for an engine's own components.
    pub fn to_bits(self) -> u64 {
        self.0.to_bits()
    }

    /// The id of a number from [`SourceId::to_bits`].
    pub fn from_bits(bits: u64) -> SourceId {
        SourceId(Key::from_bits(bits))
    }
}

impl SurfaceId {
    /// The id as a number, for example for an engine's own components.
    pub fn to_bits(self) -> u64 {
        self.0.to_bits()
    }

    /// The id of a number from [`SurfaceId::to_bits`].
    pub fn from_bits(bits: u64) -> SurfaceId {
        SurfaceId(Key::from_bits(bits))
    }
}
