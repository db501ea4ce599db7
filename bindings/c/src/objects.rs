//! Surfaces, sources, materials and the listener.

use crate::call::{EchomarchStatus, Failure, text_of};
use crate::handle::{EchomarchSimulator, with};
use crate::values::{ECHOMARCH_BANDS, ECHOMARCH_NO_ID, EchomarchPose, read, write};
use echomarch::scene::Material;
use echomarch::simulator::{Pose, SourceId, SurfaceId};
use echomarch::{Scene, Source, Surface};
use std::ffi::c_char;
use std::fmt::Write;

/// Parts of a scene's text around the text of the caller. The caller's text comes first, so that the line and the column
/// of an error are nearly its own.
const BEFORE_SURFACE: &str = "(surfaces: [";
const BEFORE_SOURCE: &str = "(sources: [";
const SOURCE: &str = "source: (position: (0, 0, 0))";
const SURFACE: &str = "surfaces: [(shape: Plane, position: (0, -1e5, 0))]";
const LISTENER: &str = "listener: (position: (0, 1, 0), radius: 0.1)";

impl EchomarchSimulator {
    /// The one surface of a text in the scene format.
    fn surface(&self, text: &str) -> Result<Surface, Failure> {
        // The names of the simulator's materials count; their numbers are not needed.
        let mut materials = String::new();
        for name in self.medium.materials.keys() {
            let _ = write!(materials, "{name:?}: (absorption: 0), ");
        }
        let scene =
            format!("{BEFORE_SURFACE}{text}\n], {SOURCE}, {LISTENER}, materials: {{{materials}}})");
        let scene = Scene::from_ron(&scene, "surface").map_err(echomarch::Error::from)?;
        only(scene.surfaces, "surface")
    }

    fn set_material(&mut self, name: &str, material: Material) -> Result<(), Failure> {
        let mut medium = self.medium.clone();
        medium.materials.insert(name.to_owned(), material);
        self.simulator.set_medium(&medium)?;
        self.medium = medium;
        Ok(())
    }

    fn add_scene(&mut self, scene: Scene) -> Result<(), Failure> {
        // Also a scene that is refused halfway has set the materials.
        let added = self.simulator.add_scene(&scene);
        self.medium.materials = scene.materials;
        (self.medium.scattering, self.medium.air) = (scene.scattering, scene.air);
        added?;
        Ok(())
    }
}

/// The one source of a text in the scene format.
fn source(text: &str) -> Result<Source, Failure> {
    let scene = format!("{BEFORE_SOURCE}{text}\n], {SURFACE}, {LISTENER})");
    let scene = Scene::from_ron(&scene, "source").map_err(echomarch::Error::from)?;
    only(scene.sources, "source")
}

fn only<T>(mut all: Vec<T>, what: &'static str) -> Result<T, Failure> {
    let count = all.len();
    match (all.pop(), count) {
        (Some(one), 1) => Ok(one),
        _ => Err(Failure::NotOne { what, count }),
    }
}

/// Adds all objects of a scene file's text (docs/scene-format.md), and takes its materials, scattering and air. The
/// listener goes to the scene's first one. Objects before one at fault are added.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_add_scene(
    sim: *mut EchomarchSimulator,
    text: *const c_char,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's text.
        let text = unsafe { text_of(text, "the scene's text") }?;
        let scene = Scene::from_ron(text, "scene").map_err(echomarch::Error::from)?;
        sim.add_scene(scene)
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Sets a material by its name, by octave band (63 Hz to 8 kHz): the absorption coefficients and, unless `scattering`
/// is NULL, the scattering coefficients, 0 to 1. Built-in materials such as "brick" need no entry. A material that was
/// set before is replaced.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `name` is NULL or ends with 0; `absorption` and `scattering` are
/// NULL or point to eight numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_set_material(
    sim: *mut EchomarchSimulator,
    name: *const c_char,
    absorption: *const f64,
    scattering: *const f64,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        type Numbers = [f64; ECHOMARCH_BANDS];
        // SAFETY: the caller's text.
        let name = unsafe { text_of(name, "the material's name") }?;
        // SAFETY: eight numbers of the caller.
        let absorption = unsafe { read(absorption.cast::<Numbers>(), "the absorption") }?;
        let mut material = Material::absorbing(absorption);
        if !scattering.is_null() {
            // SAFETY: eight numbers, as above.
            material.scattering = unsafe { read(scattering.cast::<Numbers>(), "the scattering") }?;
        }
        sim.set_material(name, material)
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Adds a surface by a text in the scene format, for example
/// `Surface(shape: Box(size: (2, 3, 0.1)), position: (0, 1.5, -4), material: "door")`. Lengths are in metres, angles in
/// degrees. `turns` is 1 for a surface that will turn, so that its first turn compiles nothing, otherwise 0. Writes the
/// id to `id`, unless it is NULL.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0; `id` is NULL or memory for an id.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_add_surface(
    sim: *mut EchomarchSimulator,
    text: *const c_char,
    turns: u32,
    id: *mut u64,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's memory for an id, and a text.
        let text = unsafe {
            write_id(id, ECHOMARCH_NO_ID);
            text_of(text, "the surface's text")
        }?;
        let mut surface = sim.surface(text)?;
        if turns != 0 {
            surface = surface.turning();
        }
        let added = sim.simulator.add_surface(surface)?;
        // SAFETY: as above.
        unsafe { write_id(id, added.to_bits()) };
        Ok(())
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Writes an id, unless there is no place for it.
///
/// # Safety
/// `place` is null, or memory for an id.
unsafe fn write_id(place: *mut u64, id: u64) {
    // SAFETY: the caller's memory. A missing place is allowed.
    let _ = unsafe { write(place, id, "the id") };
}

/// Replaces the shape and the materials of a surface by those of a text in the scene format. Its pose stays. Other
/// numbers of the same shape compile nothing.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_set_surface(
    sim: *mut EchomarchSimulator,
    surface: u64,
    text: *const c_char,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's text.
        let text = unsafe { text_of(text, "the surface's text") }?;
        let parsed = sim.surface(text)?;
        sim.simulator
            .set_surface(SurfaceId::from_bits(surface), parsed)?;
        Ok(())
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Moves and turns a surface.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `pose` is NULL or points to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_place_surface(
    sim: *mut EchomarchSimulator,
    surface: u64,
    pose: *const EchomarchPose,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's pose.
        let pose = unsafe { read(pose, "the pose") }?;
        let id = SurfaceId::from_bits(surface);
        Ok(sim.simulator.place_surface(id, pose.into())?)
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Sets whether a surface is there: 0 or 1.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_enable_surface(
    sim: *mut EchomarchSimulator,
    surface: u64,
    is_enabled: u32,
) -> EchomarchStatus {
    let id = SurfaceId::from_bits(surface);
    let body =
        |sim: &mut EchomarchSimulator| Ok(sim.simulator.enable_surface(id, is_enabled != 0)?);
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Removes a surface. Its id is never that of another one.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_remove_surface(
    sim: *mut EchomarchSimulator,
    surface: u64,
) -> EchomarchStatus {
    let id = SurfaceId::from_bits(surface);
    let body = |sim: &mut EchomarchSimulator| Ok(sim.simulator.remove_surface(id)?);
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Adds a source. `text` is NULL for a source of 0 dB that sounds alike in all directions; otherwise a text in the scene
/// format such as `Source(position: (0, 1, 0), level_db: -6, directivity: Cardioid)`. `pose` is NULL for the position
/// and the directions of the text, or of the origin. Writes the id to `id`, unless it is NULL.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0; `pose` is NULL or points to a
/// pose; `id` is NULL or memory for an id.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_add_source(
    sim: *mut EchomarchSimulator,
    text: *const c_char,
    pose: *const EchomarchPose,
    id: *mut u64,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's memory for an id.
        unsafe { write_id(id, ECHOMARCH_NO_ID) };
        let parsed = match text.is_null() {
            true => Source::at([0.0; 3]),
            // SAFETY: the caller's text.
            false => source(unsafe { text_of(text, "the source's text") }?)?,
        };
        let added = sim.simulator.add_source(parsed)?;
        if !pose.is_null() {
            // SAFETY: it is not null, so it points to a pose.
            let pose = unsafe { read(pose, "the pose") }?;
            if let Err(error) = sim.simulator.place_source(added, pose.into()) {
                sim.simulator.remove_source(added)?;
                return Err(error.into());
            }
        }
        // SAFETY: as above.
        unsafe { write_id(id, added.to_bits()) };
        Ok(())
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Moves and turns a source, also about its axis.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `pose` is NULL or points to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_place_source(
    sim: *mut EchomarchSimulator,
    source: u64,
    pose: *const EchomarchPose,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's pose.
        let pose = unsafe { read(pose, "the pose") }?;
        let id = SourceId::from_bits(source);
        Ok(sim.simulator.place_source(id, pose.into())?)
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Sets the level of a source in decibels, -120 to 120 (0 at first), and its priority, above 0 and at most 1e6 (1 at
/// first): a source with twice the priority is traced about twice as often. If one of them is refused, both stay.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_set_source(
    sim: *mut EchomarchSimulator,
    source: u64,
    level_db: f32,
    priority: f32,
) -> EchomarchStatus {
    let id = SourceId::from_bits(source);
    let body = |sim: &mut EchomarchSimulator| {
        // A priority that set_priority refuses must not leave the level changed.
        if priority > 0.0 && priority <= 1e6 {
            sim.simulator.set_level(id, level_db)?;
        }
        Ok(sim.simulator.set_priority(id, priority)?)
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Sets whether a source sounds: 0 or 1. A source that does not sound takes no time and has no updates.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_enable_source(
    sim: *mut EchomarchSimulator,
    source: u64,
    is_enabled: u32,
) -> EchomarchStatus {
    let id = SourceId::from_bits(source);
    let body =
        |sim: &mut EchomarchSimulator| Ok(sim.simulator.enable_source(id, is_enabled != 0)?);
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Removes a source. Its id is never that of another one.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_remove_source(
    sim: *mut EchomarchSimulator,
    source: u64,
) -> EchomarchStatus {
    let id = SourceId::from_bits(source);
    let body = |sim: &mut EchomarchSimulator| Ok(sim.simulator.remove_source(id)?);
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Places the listener.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `pose` is NULL or points to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_place_listener(
    sim: *mut EchomarchSimulator,
    pose: *const EchomarchPose,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's pose.
        let pose: Pose = unsafe { read(pose, "the pose") }?.into();
        Ok(sim.simulator.place_listener(pose)?)
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}

/// Turns the head against the listener, for example by a head tracker: `rotation` has the four numbers of a quaternion
/// (x, y, z, w) of any length except 0, from the axes of the head to those of the listener. Heard in the next block of
/// each mix, without a commit.
///
/// # Safety
/// `sim` is NULL or a handle that no other thread uses; `rotation` is NULL or points to four numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn echomarch_turn_head(
    sim: *mut EchomarchSimulator,
    rotation: *const f32,
) -> EchomarchStatus {
    let body = |sim: &mut EchomarchSimulator| {
        // SAFETY: the caller's four numbers.
        let rotation: [f32; 4] = unsafe { read(rotation.cast(), "the rotation") }?;
        Ok(sim.simulator.head_tracker().turn(rotation)?)
    };
    // SAFETY: the caller's handle.
    unsafe { with(sim, body) }
}
