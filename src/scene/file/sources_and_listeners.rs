//! Sources and listeners of a scene file.

use super::per_band::{OfBands, OmniShare};
use super::text::{Place, Refused};
use crate::scene::check::{LEVELS, MOST_PLACED};
use crate::scene::notation::{Attached, Degrees, Finite, FixedRadius, Name, Point, checked};
use crate::scene::{Directivity, Key, Listener, Path, SceneError, Source};
use glam::Vec3;
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use std::collections::HashSet;
use std::fmt;
use std::marker::PhantomData;

#[derive(Deserialize)]
#[serde(rename = "Source", deny_unknown_fields)]
pub(super) struct SourceFile {
    name: Option<Name>,
    level_db: Option<Level>,
    position: Option<Point>,
    yaw: Option<Degrees>,
    pitch: Option<Degrees>,
    directivity: Option<DirectivityFile>,
    path: Option<PathFile>,
}

/// A directivity. The order of the variants is that of [`DIRECTIVITIES`].
#[derive(Deserialize)]
#[serde(rename = "Directivity", deny_unknown_fields)]
enum DirectivityFile {
    Omnidirectional,
    Subcardioid,
    Cardioid,
    Supercardioid,
    Hypercardioid,
    Figure8,
    FirstOrder(OfBands<OmniShare>),
    Balloon { file: String },
}

/// The names of the directivities in a scene file.
pub(super) const DIRECTIVITIES: [&str; 8] = [
    "Omnidirectional",
    "Subcardioid",
    "Cardioid",
    "Supercardioid",
    "Hypercardioid",
    "Figure8",
    "FirstOrder",
    "Balloon",
];

impl DirectivityFile {
    /// Returns the directivity, and reads its file.
    fn read(&self, files: &Attached) -> Result<Directivity, SceneError> {
        Ok(match self {
            DirectivityFile::Omnidirectional => Directivity::Omnidirectional,
            DirectivityFile::Subcardioid => Directivity::SUBCARDIOID,
            DirectivityFile::Cardioid => Directivity::CARDIOID,
            DirectivityFile::Supercardioid => Directivity::SUPERCARDIOID,
            DirectivityFile::Hypercardioid => Directivity::HYPERCARDIOID,
            DirectivityFile::Figure8 => Directivity::FIGURE8,
            DirectivityFile::FirstOrder(share) => Directivity::FirstOrder(share.bands),
            DirectivityFile::Balloon { file } => Directivity::Balloon(files.balloon(file)?),
        })
    }
}

/// A listener whose radius has the type `R`. The radius is optional if the scene has a base.
#[derive(Deserialize)]
#[serde(
    rename = "Listener",
    deny_unknown_fields,
    bound = "R: Deserialize<'de>"
)]
pub(super) struct ListenerFile<R> {
    name: Option<Name>,
    position: Option<Point>,
    yaw: Option<Degrees>,
    pitch: Option<Degrees>,
    radius: R,
    path: Option<PathFile>,
}

#[derive(Deserialize)]
#[serde(rename = "Key", deny_unknown_fields)]
struct KeyFile {
    time: Finite,
    position: Point,
    #[serde(default)]
    yaw: Degrees,
    #[serde(default)]
    pitch: Degrees,
}

checked! {
    /// Level of a source in decibels.
    #[derive(Clone, Copy)]
    Level(f32) from f32: level;
    /// Keys with strictly increasing times.
    PathFile(Path) from Vec<KeyFile>: path;
}

fn level(decibels: f32) -> Result<f32, String> {
    if LEVELS.contains(&decibels) {
        return Ok(decibels);
    }
    let (least, most) = (LEVELS.start(), LEVELS.end());
    Err(format!(
        "a level in decibels must be {least} to {most}, not {decibels}"
    ))
}

fn path(keys: Vec<KeyFile>) -> Result<Path, String> {
    let keys = keys.into_iter().map(|key| Key {
        time: key.time.0,
        position: key.position.0,
        yaw: key.yaw.0,
        pitch: key.pitch.0,
    });
    let path = Path::new(keys.collect());
    path.ok_or_else(|| "the times of a path's keys must increase".to_owned())
}

/// The path in the file; without one, an empty path.
fn path_of(file: &Option<PathFile>) -> Path {
    file.as_ref().map(|file| file.0.clone()).unwrap_or_default()
}

impl SourceFile {
    /// Returns the source of the file.
    pub fn read(&self, files: &Attached) -> Result<Source, SceneError> {
        let mut source = Source::at(Vec3::ZERO);
        self.change(&mut source, files)?;
        Ok(source)
    }

    /// Applies the fields of the file to a source. A path without a position moves the source to the pose at the start
    /// of the path. A position or an angle without a path removes the path of the source.
    pub fn change(&self, source: &mut Source, files: &Attached) -> Result<(), SceneError> {
        if let Some(name) = &self.name {
            source.name = Some(name.0.clone());
        }
        if let Some(Level(decibels)) = self.level_db {
            source.level_db = decibels;
        }
        if let Some(directivity) = &self.directivity {
            source.directivity = directivity.read(files)?;
        }
        let pose = (&mut source.position, &mut source.yaw, &mut source.pitch);
        change_pose(
            (self.position, self.yaw, self.pitch, &self.path),
            pose,
            &mut source.path,
        );
        Ok(())
    }
}

/// Applies a position, a yaw, a pitch and a path of the file to those of a source or a listener.
fn change_pose(
    file: (
        Option<Point>,
        Option<Degrees>,
        Option<Degrees>,
        &Option<PathFile>,
    ),
    (position, yaw, pitch): (&mut Vec3, &mut f32, &mut f32),
    path: &mut Path,
) {
    let (to, turn, elevation, along) = file;
    if to.is_none() && turn.is_none() && elevation.is_none() && along.is_none() {
        return;
    }
    *path = path_of(along);
    match (to, path.at(0.0)) {
        (None, Some(key)) => {
            *position = key.position;
            (*yaw, *pitch) = (key.yaw, key.pitch);
        }
        (to, _) => {
            *position = to.map_or(*position, |point| point.0);
            *yaw = turn.map_or(*yaw, |angle| angle.0);
            *pitch = elevation.map_or(*pitch, |angle| angle.0);
        }
    }
}

impl ListenerFile<FixedRadius> {
    /// Returns the listener of the file.
    pub fn read(&self) -> Listener {
        let mut listener = Listener::at(Vec3::ZERO, self.radius.0);
        self.change(&mut listener);
        listener
    }
}

impl<R: Copy + Into<Option<FixedRadius>>> ListenerFile<R> {
    /// Applies the fields of the file to a listener. A path without a position moves the listener to the pose at the
    /// start of the path. A position without a path removes the path of the listener.
    pub fn change(&self, listener: &mut Listener) {
        if let Some(name) = &self.name {
            listener.name = Some(name.0.clone());
        }
        if let Some(radius) = self.radius.into() {
            listener.radius = radius.0;
        }
        let pose = (
            &mut listener.position,
            &mut listener.yaw,
            &mut listener.pitch,
        );
        change_pose(
            (self.position, self.yaw, self.pitch, &self.path),
            pose,
            &mut listener.path,
        );
    }
}

/// An element of a scene that occurs once or several times and can have a name.
pub(super) trait Placed {
    /// Name of the field for a single element.
    const ONE: &'static str;
    /// Name of the field for several elements.
    const SEVERAL: &'static str;
    /// The notation of one element.
    const NOTATION: &'static str;

    fn name(&self) -> Option<&Name>;
}

impl Placed for SourceFile {
    const ONE: &'static str = "source";
    const SEVERAL: &'static str = "sources";
    const NOTATION: &'static str = "Source(…)";

    fn name(&self) -> Option<&Name> {
        self.name.as_ref()
    }
}

impl<R> Placed for ListenerFile<R> {
    const ONE: &'static str = "listener";
    const SEVERAL: &'static str = "listeners";
    const NOTATION: &'static str = "Listener(…)";

    fn name(&self) -> Option<&Name> {
        self.name.as_ref()
    }
}

/// A list of one or more elements with distinct names.
pub(super) struct Several<T>(Vec<T>);

/// Rejects a scene that has both fields, `source: …` and `sources: […]`.
pub(super) fn one_form<T: Placed>(one: bool, several: bool) -> Result<(), Refused> {
    if one && several {
        let why = format!("a scene has {} or {}, not both", T::ONE, T::SEVERAL);
        return Err(Refused::At(Place::Field(T::SEVERAL), why));
    }
    Ok(())
}

impl<T: Placed> Several<T> {
    /// The elements of a scene, from the one of the two fields that it has.
    pub fn needed(one: Option<T>, several: Option<Several<T>>) -> Result<Several<T>, Refused> {
        one_form::<T>(one.is_some(), several.is_some())?;
        let alone = |only| Several(vec![only]);
        one.map(alone).or(several).ok_or_else(|| {
            let (one, several, notation) = (T::ONE, T::SEVERAL, T::NOTATION);
            let why = format!(
                "a scene needs {one}: {notation}, or several as {several}: [{notation}, …]"
            );
            Refused::At(Place::End, why)
        })
    }

    /// The elements, in order.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        self.0.iter()
    }
}

impl<'de, T: Placed + Deserialize<'de>> Deserialize<'de> for Several<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Several<T>, D::Error> {
        from.deserialize_seq(OneAtLeast(PhantomData))
    }
}

/// Visitor of a list with at least one element.
struct OneAtLeast<T>(PhantomData<T>);

impl<'de, T: Placed + Deserialize<'de>> Visitor<'de> for OneAtLeast<T> {
    type Value = Several<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, …]", T::NOTATION)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Several<T>, A::Error> {
        let (mut all, mut known) = (Vec::new(), HashSet::new());
        while let Some(next) = list.next_element::<T>()? {
            if let Some(Name(name)) = next.name()
                && !known.insert(name.clone())
            {
                let why = format!("two of the {} are called {name:?}", T::SEVERAL);
                return Err(A::Error::custom(why));
            }
            if all.len() == MOST_PLACED {
                let why = format!("a scene has at most {MOST_PLACED} {}", T::SEVERAL);
                return Err(A::Error::custom(why));
            }
            all.push(next);
        }
        if all.is_empty() {
            let why = format!("{} need at least one", T::SEVERAL);
            return Err(A::Error::custom(why));
        }
        Ok(Several(all))
    }
}
