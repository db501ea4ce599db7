//! Scenes: read from files, or put together from parts in the notation of scene files.

use crate::errors;
use echomarch::bands::Bands;
use echomarch::internals::text;
use echomarch::scene::mesh::{Inside, MeshOptions, TriangleMesh};
use echomarch::scene::shape::Mesh;
use echomarch::scene::{Material, Pair, SceneError, Warning};
use echomarch::{Listener, Source, Surface};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene of the library, with the axes and units of scene files.
#[pyclass(module = "echomarch._echomarch")]
#[derive(Clone)]
pub struct Scene {
    pub inner: echomarch::Scene,
}

/// The name, the absorption and the source of each built-in material.
pub fn builtin_materials() -> Vec<(&'static str, &'static str, &'static str, Bands)> {
    let all = Material::BUILTIN.iter();
    all.map(|known| {
        let absorption = known.material.absorption;
        (known.name, known.of, known.source, absorption)
    })
    .collect()
}

/// A source of a part that needs none: the notation of a scene requires one.
const ANY_SOURCE: &str = "source: Source(position: (0, 0, 0))";

/// A listener of a part that needs none.
const ANY_LISTENER: &str = "listener: Listener(position: (0, 0, 0), radius: 1)";

/// A surface of a part that needs none.
const ANY_SURFACE: &str = "surfaces: [Surface(shape: Plane)]";

/// A scene without surfaces, sources and listeners.
fn empty(name: &str) -> echomarch::Scene {
    let (source, listener) = (Source::at([0.0; 3]), Listener::at([0.0; 3], 1.0));
    let mut scene = echomarch::Scene::new(name, Vec::new(), source, listener);
    scene.sources.clear();
    scene.listeners.clear();
    scene
}

/// Reads the fields of a scene. `origin` is their name in errors.
fn parts(fields: &[&str], origin: &str, folder: &Path) -> PyResult<echomarch::Scene> {
    let text = format!("Scene({})", fields.join(", "));
    let scene = echomarch::Scene::from_ron_in(&text, origin, folder);
    scene.map_err(|error| errors::scene(without_place(&error.to_string(), origin)))
}

/// A message without the line and column after its origin: the text of a part is not the caller's text.
fn without_place(message: &str, origin: &str) -> String {
    let after = message
        .strip_prefix(origin)
        .and_then(|rest| rest.strip_prefix(":1:"));
    match after {
        Some(rest) => format!(
            "{origin}{}",
            rest.trim_start_matches(|c: char| c.is_ascii_digit())
        ),
        None => message.to_owned(),
    }
}

/// A message about an unknown name, with the existing names and the most similar one.
#[pyfunction]
pub fn which_it_has(refused: &str, typed: &str, names: Vec<String>) -> String {
    text::which_it_has(refused, typed, &names)
}

/// A message about an unknown name of a kind, with all existing names and the most similar one.
#[pyfunction]
pub fn there_is_no(what: &str, typed: &str, known: Vec<String>) -> String {
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    text::there_is_no(what, typed, &known)
}

/// The index of a source or listener given by its name, or by its number from 1.
fn placed(what: &str, label: &str, labels: &[String]) -> PyResult<usize> {
    let by_number = || label.parse::<usize>().ok()?.checked_sub(1);
    let named = labels.iter().position(|known| known == label);
    let found = named.or_else(by_number);
    found.filter(|index| *index < labels.len()).ok_or_else(|| {
        let refused = format!("the scene has no {what} {label:?}");
        errors::settings(text::which_it_has(&refused, label, labels))
    })
}

impl Scene {
    /// The index of a surface given by its label: a name, or a number from 1.
    fn surface(&self, label: &str) -> PyResult<usize> {
        let surfaces = &self.inner.surfaces;
        let named = |surface: &Surface| surface.name.as_deref() == Some(label);
        let by_number = || label.parse::<usize>().ok()?.checked_sub(1);
        let found = surfaces.iter().position(named).or_else(by_number);
        found
            .filter(|index| *index < surfaces.len())
            .ok_or_else(|| {
                let refused = format!("scene {:?} has no surface {label:?}", self.inner.name);
                errors::settings(text::which_it_has(&refused, label, &self.surfaces()))
            })
    }

    /// Refuses an added name that one of the sources or listeners already has, as the check of the whole scene does.
    fn refuse_same_name<'a>(
        &self,
        what: &'static str,
        known: impl Iterator<Item = &'a Option<String>>,
        added: impl Iterator<Item = &'a Option<String>>,
    ) -> PyResult<()> {
        let added: Vec<&String> = added.flatten().collect();
        match known.flatten().find(|name| added.contains(name)) {
            Some(name) => Err(errors::from(SceneError::SameName {
                scene: self.inner.name.clone(),
                what,
                name: name.clone(),
            })),
            None => Ok(()),
        }
    }

    /// The pair of a source and a listener, given by indices.
    pub fn pair(&self, source: usize, listener: usize) -> PyResult<Pair<'_>> {
        self.inner.pair(source, listener).map_err(errors::from)
    }
}

#[pymethods]
impl Scene {
    /// A scene without surfaces, sources and listeners.
    #[staticmethod]
    fn empty(name: &str) -> Scene {
        Scene { inner: empty(name) }
    }

    /// A copy.
    fn copy(&self) -> Scene {
        self.clone()
    }

    /// A built-in scene, or a scene file.
    #[staticmethod]
    fn load(name_or_file: &str) -> PyResult<Scene> {
        let inner = echomarch::Scene::load(name_or_file).map_err(errors::from)?;
        Ok(Scene { inner })
    }

    /// A scene from the text of a scene file.
    #[staticmethod]
    fn from_ron(text: &str, origin: &str, folder: PathBuf) -> PyResult<Scene> {
        let inner = echomarch::Scene::from_ron_in(text, origin, &folder);
        inner.map(|inner| Scene { inner }).map_err(errors::from)
    }

    /// Adds a surface, given by its fields.
    fn add_surface(&mut self, fields: &str, origin: &str, folder: PathBuf) -> PyResult<usize> {
        let surface = format!("surfaces: [Surface({fields})]");
        let part = parts(&[&surface, ANY_SOURCE, ANY_LISTENER], origin, &folder)?;
        self.inner.surfaces.extend(part.surfaces);
        Ok(self.inner.surfaces.len())
    }

    /// Removes a surface, given by its name or its number from 1.
    fn remove_surface(&mut self, label: &str) -> PyResult<()> {
        let index = self.surface(label)?;
        self.inner.surfaces.remove(index);
        Ok(())
    }

    /// Adds a mesh, and returns the names of its groups and its warnings.
    fn add_mesh(
        &mut self,
        name: &str,
        file: PathBuf,
        is_hollow: Option<bool>,
        scale: f32,
        quarter_turns_about_x: i32,
    ) -> PyResult<(Vec<String>, Vec<String>)> {
        let inside = is_hollow.map(|is_hollow| match is_hollow {
            true => Inside::Air,
            false => Inside::Solid,
        });
        let options = MeshOptions { inside, scale };
        let mesh = TriangleMesh::from_file(&file, options)
            .map_err(|error| errors::scene(format!("the mesh {}: {error}", file.display())))?;
        let groups = mesh.groups().to_vec();
        let warnings = mesh.report().warnings();
        let angle = quarter_turns_about_x as f32 * std::f32::consts::FRAC_PI_2;
        let mesh = Arc::new(mesh);
        let mut surface = Surface::new(Mesh { mesh }).named(name);
        if quarter_turns_about_x != 0 {
            surface = surface.turned(glam::Quat::from_rotation_x(angle));
        }
        self.inner.surfaces.push(surface);
        Ok((groups, warnings))
    }

    /// Adds or replaces a material, given by its fields.
    fn add_material(&mut self, name: &str, fields: &str, origin: &str) -> PyResult<()> {
        let materials = format!("materials: {{\"it\": Material({fields})}}");
        let all = [ANY_SURFACE, ANY_SOURCE, ANY_LISTENER, &materials];
        let part = parts(&all, origin, Path::new(""))?;
        let material = part.materials.into_values().next();
        let material = material.ok_or_else(|| errors::settings(format!("{origin} is empty")))?;
        self.inner.materials.insert(name.to_owned(), material);
        Ok(())
    }

    /// Refuses the name of a material that is neither added nor built in, with the message of the scene reader.
    /// `origin` is the user of the material in errors.
    fn check_material(&self, name: &str, origin: &str) -> PyResult<()> {
        if self.inner.material_named(name).is_some() {
            return Ok(());
        }
        let surface = format!("surfaces: [Surface(shape: Plane, material: {name:?})]");
        let all = [surface.as_str(), ANY_SOURCE, ANY_LISTENER];
        parts(&all, origin, Path::new("")).map(drop)
    }

    /// Gives a surface, or one of its walls or groups of faces, the material of this name.
    fn set_material(&mut self, surface: &str, part: Option<&str>, material: &str) -> PyResult<()> {
        let index = self.surface(surface)?;
        let label = self.inner.surfaces[index].label(index);
        let surface = &mut self.inner.surfaces[index];
        let Some(part) = part else {
            surface.material = Some(material.to_owned());
            return Ok(());
        };
        if surface.set_part_material(part, material) {
            return Ok(());
        }
        let refused = format!("{label} has no part {part:?}");
        let names = surface.part_names();
        Err(errors::settings(text::which_it_has(&refused, part, &names)))
    }

    /// A name for a material of a surface or of one of its parts. It is `wanted` unless another surface or part has a
    /// material of this name, for example after the removal of a surface has changed the numbers of others, or a material
    /// of this name exists that the part does not have.
    fn material_name(&self, surface: &str, part: Option<&str>, wanted: &str) -> PyResult<String> {
        let mut others = self.clone();
        others.set_material(surface, part, "")?;
        let has = |scene: &Scene, name: &str| {
            let mut names = scene
                .inner
                .surfaces
                .iter()
                .flat_map(Surface::material_names);
            names.any(|used| used == name)
        };
        let is_own = |name: &str| has(self, name) && !has(&others, name);
        let exists = |name: &str| self.inner.material_named(name).is_some();
        let is_used = |name: &str| has(&others, name) || (exists(name) && !is_own(name));
        let mut name = wanted.to_owned();
        let mut number = 2;
        while is_used(&name) {
            name = format!("{wanted} ({number})");
            number += 1;
        }
        Ok(name)
    }

    /// Sets the share of sound that built-in materials scatter, by band.
    fn set_scattering(&mut self, scattering: Bands) {
        self.inner.scattering = scattering;
    }

    /// Sets the air, given by its fields; `None` for no loss and 343 m/s.
    fn set_air(&mut self, fields: Option<&str>) -> PyResult<()> {
        let Some(fields) = fields else {
            self.inner.air = None;
            return Ok(());
        };
        let air = format!("air: Air({fields})");
        let all = [ANY_SURFACE, ANY_SOURCE, ANY_LISTENER, &air];
        self.inner.air = parts(&all, "the air", Path::new(""))?.air;
        Ok(())
    }

    /// Adds a source, given by its fields.
    fn add_source(&mut self, fields: &str, origin: &str, folder: PathBuf) -> PyResult<()> {
        let source = format!("source: Source({fields})");
        let part = parts(&[ANY_SURFACE, &source, ANY_LISTENER], origin, &folder)?;
        let known = self.inner.sources.iter().map(|source| &source.name);
        let added = part.sources.iter().map(|source| &source.name);
        self.refuse_same_name("sources", known, added)?;
        self.inner.sources.extend(part.sources);
        Ok(())
    }

    /// Adds a listener, given by its fields.
    fn add_listener(&mut self, fields: &str, origin: &str) -> PyResult<()> {
        let listener = format!("listener: Listener({fields})");
        let part = parts(&[ANY_SURFACE, ANY_SOURCE, &listener], origin, Path::new(""))?;
        let known = self.inner.listeners.iter().map(|listener| &listener.name);
        let added = part.listeners.iter().map(|listener| &listener.name);
        self.refuse_same_name("listeners", known, added)?;
        self.inner.listeners.extend(part.listeners);
        Ok(())
    }

    /// Returns the index of a source, given by its name or its number from 1.
    fn source_index(&self, label: &str) -> PyResult<usize> {
        placed("source", label, &self.inner.source_labels())
    }

    /// Returns the index of a listener, given by its name or its number from 1.
    fn listener_index(&self, label: &str) -> PyResult<usize> {
        placed("listener", label, &self.inner.listener_labels())
    }

    /// Removes a source, given by its name or its number from 1.
    fn remove_source(&mut self, label: &str) -> PyResult<()> {
        let index = self.source_index(label)?;
        self.inner.sources.remove(index);
        Ok(())
    }

    /// Removes a listener, given by its name or its number from 1.
    fn remove_listener(&mut self, label: &str) -> PyResult<()> {
        let index = self.listener_index(label)?;
        self.inner.listeners.remove(index);
        Ok(())
    }

    /// Removes all sources.
    fn clear_sources(&mut self) {
        self.inner.sources.clear();
    }

    /// Removes all listeners.
    fn clear_listeners(&mut self) {
        self.inner.listeners.clear();
    }

    /// Sets a named value in the unit of scene files.
    fn set_value(&mut self, name: &str, value: f32) -> PyResult<()> {
        self.inner.set_value(name, value).map_err(errors::from)
    }

    /// Returns the named values, in the units of scene files.
    fn values(&self) -> Vec<(String, f32)> {
        let values = self.inner.named_values().into_iter();
        values.map(|value| (value.name, value.value)).collect()
    }

    /// Moves everything to its place at a time in seconds.
    fn move_to(&mut self, seconds: f64) {
        self.inner = self.inner.at(seconds);
    }

    /// Checks all numbers and names.
    fn check(&self) -> PyResult<()> {
        self.inner.check().map_err(errors::from)
    }

    /// The warnings of the scene.
    fn warnings(&self) -> Vec<String> {
        let warnings = self.inner.warnings();
        warnings.iter().map(ToString::to_string).collect()
    }

    /// The warnings of the scene that concern responses of the source and the listeners with these indices.
    fn warnings_of_pairs(&self, source: usize, listeners: Vec<usize>) -> Vec<String> {
        let mut scene = self.inner.clone();
        let sources = self.inner.sources.get(source).cloned();
        scene.sources = sources.into_iter().collect();
        let of = |index: &usize| self.inner.listeners.get(*index).cloned();
        scene.listeners = listeners.iter().filter_map(of).collect();
        // Waves that start within a listener's sphere are lost to frames only.
        let is_of_frames =
            |warning: &Warning| matches!(warning, Warning::SourceInsideListener { .. });
        let warnings = scene.warnings().into_iter();
        let kept = warnings.filter(|warning| !is_of_frames(warning));
        kept.map(|warning| warning.to_string()).collect()
    }

    /// The text of a scene file.
    fn to_ron(&self) -> PyResult<String> {
        let notation = ron::ser::PrettyConfig::new().struct_names(true);
        let text = ron::ser::to_string_pretty(&self.inner, notation);
        text.map_err(|error| errors::scene(error.to_string()))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// The names of the surfaces; the number from 1 for a surface without a name.
    fn surfaces(&self) -> Vec<String> {
        let surfaces = self.inner.surfaces.iter().enumerate();
        let label = |(index, surface): (usize, &Surface)| {
            let number = || (index + 1).to_string();
            surface.name.clone().unwrap_or_else(number)
        };
        surfaces.map(label).collect()
    }

    /// The names of the materials of the scene itself.
    fn materials(&self) -> Vec<String> {
        self.inner.materials.keys().cloned().collect()
    }

    /// The labels and positions of the sources.
    fn sources(&self) -> Vec<(String, [f32; 3])> {
        let places = self
            .inner
            .sources
            .iter()
            .map(|source| source.position.to_array());
        self.inner.source_labels().into_iter().zip(places).collect()
    }

    /// The labels and positions of the listeners.
    fn listeners(&self) -> Vec<(String, [f32; 3])> {
        let places = self
            .inner
            .listeners
            .iter()
            .map(|listener| listener.position.to_array());
        self.inner
            .listener_labels()
            .into_iter()
            .zip(places)
            .collect()
    }

    /// The speed of sound in metres per second.
    fn speed_of_sound(&self) -> f64 {
        self.inner.speed_of_sound()
    }

    /// The signed distance in metres from a point to the nearest surface; negative within a solid.
    fn distance(&self, point: [f32; 3]) -> f32 {
        self.inner.surface_distance(point).distance
    }
}
