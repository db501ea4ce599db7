//! The objects of a simulator by the ids of Godot's nodes, and their sound. Nothing here needs the engine.

use echomarch::glam::{Mat3, Quat, Vec3};
use echomarch::simulator::{
    EarsSpec, Mix, Pose, Simulator, SimulatorSettings, SimulatorState, SourceId, SurfaceId, Update,
};
use echomarch::{Error, Scene, Source, Surface};
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// Parts of a scene around the text of a node.
const SOURCE: &str = "source: (position: (0, 0, 0))";
const SURFACE: &str = "surfaces: [(shape: Plane, position: (0, -1e5, 0))]";
const LISTENER: &str = "listener: (position: (0, 1, 0), radius: 0.1)";

/// Longest sound of a source that waits, in seconds.
const LONGEST_S: u32 = 1;

/// The number of a node: its instance id.
pub type NodeId = i64;

/// The pose of a transform, given by the columns of its basis and its origin. Scales and reflections are left out.
/// Godot's axes are those of Echomarch: x to the right, y up, −z ahead, in metres. A basis without a volume gives a pose
/// that the simulator refuses.
pub fn pose(basis: [[f32; 3]; 3], origin: [f32; 3]) -> Pose {
    let [x, y, _] = basis.map(Vec3::from_array);
    let x = x.normalize_or_zero();
    let y = (y - x * x.dot(y)).normalize_or_zero();
    let z = x.cross(y);
    let rotation = match z == Vec3::ZERO {
        true => Quat::from_array([f32::NAN; 4]),
        false => Quat::from_mat3(&Mat3::from_cols(x, y, z)),
    };
    Pose::at(origin).turned(rotation)
}

/// The last state of a node.
#[derive(Debug)]
struct Known<Id> {
    /// `None` if the simulator refused it.
    id: Option<Id>,
    /// `None` before the first text.
    text: Option<String>,
    turns: bool,
    pose: Option<Pose>,
}

impl<Id> Default for Known<Id> {
    /// Returns a node that is not known.
    fn default() -> Known<Id> {
        Known {
            id: None,
            text: None,
            turns: false,
            pose: None,
        }
    }
}

/// A simulator, its objects by their nodes, and their sound.
#[derive(Debug)]
pub struct Acoustics {
    simulator: Simulator,
    materials: String,
    surfaces: HashMap<NodeId, Known<SurfaceId>>,
    sources: HashMap<NodeId, Known<SourceId>>,
    mix: Mix,
    /// The samples that wait, by source.
    sounds: HashMap<SourceId, VecDeque<f32>>,
    most_samples: usize,
}

impl Acoustics {
    /// Starts a simulator, whose sound has `rate_hz` samples per second. `materials` are materials in the notation of
    /// scene files, for example `"door": Material(absorption: 0.1)`.
    ///
    /// # Errors
    /// A fault in the materials, and [`Error::Gpu`] without OpenGL.
    pub fn start(
        settings: SimulatorSettings,
        materials: &str,
        rate_hz: u32,
    ) -> Result<Acoustics, Error> {
        let medium = scene(SURFACE, SOURCE, materials, "materials")?;
        let mut simulator = Simulator::new(settings)?;
        simulator.set_medium(&medium)?;
        Ok(Acoustics {
            materials: materials.to_owned(),
            surfaces: HashMap::new(),
            sources: HashMap::new(),
            mix: simulator.mix(&EarsSpec::new(rate_hz))?,
            simulator,
            sounds: HashMap::new(),
            most_samples: (LONGEST_S * rate_hz) as usize,
        })
    }

    /// Adds the surface of a node, or changes and moves it. The position and the angles of the text are not used. A text
    /// that is refused is not tried again, and the surface stays as it was.
    ///
    /// # Errors
    /// A fault in the text, once, or in the pose.
    pub fn surface(
        &mut self,
        node: NodeId,
        text: &str,
        turns: bool,
        pose: Pose,
    ) -> Result<(), Error> {
        let known = self.surfaces.entry(node).or_default();
        if known.text.as_deref() != Some(text) || known.turns != turns {
            (known.text, known.turns) = (Some(text.to_owned()), turns);
            let surface = surface(text, turns, &self.materials)?;
            match known.id {
                Some(id) => self.simulator.set_surface(id, surface)?,
                None => known.id = Some(self.simulator.add_surface(surface)?),
            }
        }
        if let (Some(id), true) = (known.id, known.pose != Some(pose)) {
            known.pose = Some(pose);
            self.simulator.place_surface(id, pose)?;
        }
        Ok(())
    }

    /// Adds the source of a node, or changes and moves it. The position and the angles of the text are not used. A text
    /// that is refused is not tried again.
    ///
    /// # Errors
    /// A fault in the text, once, or in the pose.
    pub fn source(&mut self, node: NodeId, text: &str, pose: Pose) -> Result<(), Error> {
        let known = self.sources.entry(node).or_default();
        if known.text.as_deref() != Some(text) {
            known.text = Some(text.to_owned());
            let id = self.simulator.add_source(source(text, &self.materials)?)?;
            let mut sound = VecDeque::with_capacity(self.most_samples);
            if let Some(old) = known.id.replace(id) {
                sound = self.sounds.remove(&old).unwrap_or(sound);
                self.simulator.remove_source(old)?;
            }
            self.sounds.insert(id, sound);
            known.pose = None;
        }
        if let (Some(id), true) = (known.id, known.pose != Some(pose)) {
            known.pose = Some(pose);
            self.simulator.place_source(id, pose)?;
        }
        Ok(())
    }

    /// Moves the listener.
    ///
    /// # Errors
    /// A fault in the pose.
    pub fn listener(&mut self, pose: Pose) -> Result<(), Error> {
        Ok(self.simulator.place_listener(pose)?)
    }

    /// Removes the surface or the source of a node.
    pub fn remove(&mut self, node: NodeId) {
        // An id of the own tables is known to the simulator.
        if let Some(id) = self.surfaces.remove(&node).and_then(|known| known.id) {
            let _ = self.simulator.remove_surface(id);
        }
        if let Some(id) = self.sources.remove(&node).and_then(|known| known.id) {
            let _ = self.simulator.remove_source(id);
            self.sounds.remove(&id);
        }
    }

    /// Hands the world to the simulator: see [`Simulator::commit`].
    pub fn commit(&mut self) {
        self.simulator.commit();
    }

    /// The last update of the source of a node; `None` before its first round.
    pub fn heard(&self, node: NodeId) -> Option<Arc<Update>> {
        self.simulator.updates(self.id(node)?)
    }

    /// The state of the simulator's threads.
    pub fn state(&self) -> SimulatorState {
        self.simulator.state()
    }

    /// Adds samples to those of a source that wait, at most a second of them, and returns how many were taken.
    pub fn push(&mut self, node: NodeId, samples: impl IntoIterator<Item = f32>) -> usize {
        let id = self.id(node);
        let Some(sound) = id.and_then(|id| self.sounds.get_mut(&id)) else {
            return 0;
        };
        let before = sound.len();
        sound.extend(samples.into_iter().take(self.most_samples - before));
        sound.len() - before
    }

    /// Number of samples of a source that wait. `None` without the source.
    pub fn waiting(&self, node: NodeId) -> Option<usize> {
        Some(self.sounds.get(&self.id(node)?)?.len())
    }

    /// Overwrites `stereo` with the next frames of all sources, left and right in turn. A source that has too few samples
    /// is silent for the rest.
    pub fn play(&mut self, stereo: &mut [f32]) {
        let sounds = &mut self.sounds;
        self.mix.process(stereo, |id, samples| {
            let Some(sound) = sounds.get_mut(&id) else {
                return;
            };
            let count = samples.len().min(sound.len());
            for (sample, next) in samples.iter_mut().zip(sound.drain(..count)) {
                *sample = next;
            }
        });
    }

    fn id(&self, node: NodeId) -> Option<SourceId> {
        self.sources.get(&node)?.id
    }
}

fn scene(surfaces: &str, sources: &str, materials: &str, origin: &str) -> Result<Scene, Error> {
    let text = format!("({surfaces}, {sources}, {LISTENER}, materials: {{{materials}\n}})");
    Ok(Scene::from_ron(&text, origin)?)
}

fn surface(text: &str, turns: bool, materials: &str) -> Result<Surface, Error> {
    let surfaces = format!("surfaces: [{text}\n]");
    let surface = scene(&surfaces, SOURCE, materials, "surface")?
        .surfaces
        .swap_remove(0);
    Ok(match turns {
        true => surface.turning(),
        false => surface,
    })
}

fn source(text: &str, materials: &str) -> Result<Source, Error> {
    let sources = format!("sources: [{text}\n]");
    Ok(scene(SURFACE, &sources, materials, "source")?
        .sources
        .swap_remove(0))
}
