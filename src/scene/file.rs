//! Scene files in RON.
//!
//! The types here are what the text says (degrees, full sizes); they turn into
//! the plain [`Scene`] at once. Every number is checked while it is read, so that
//! an error points at its line and column. See `docs/scene-format.md`.

use super::{Key, Listener, Path, Scene, SceneError, Shape, Source, Surface};
use glam::{EulerRot, Quat, Vec3};
use serde::Deserialize;

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`], [`SceneError::Malformed`] with line and column,
    /// or [`SceneError::Empty`].
    pub fn from_file(path: &std::path::Path) -> Result<Scene, SceneError> {
        let text = std::fs::read_to_string(path).map_err(|source| SceneError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        let mut scene = parse(&text, &path.display().to_string())?;
        if scene.name.is_empty()
            && let Some(stem) = path.file_stem()
        {
            scene.name = stem.to_string_lossy().into_owned();
        }
        scene.check()?;
        Ok(scene)
    }

    /// Reads a scene from RON text; `origin` is what errors call it.
    ///
    /// ```
    /// let text = "Scene(
    ///     surfaces: [Surface(shape: Plane, position: (0, -2, 0))],
    ///     source: Source(position: (0, 0, -5)),
    ///     listener: Listener(position: (0, 0, 0), radius: 1),
    /// )";
    /// let scene = echomarch::Scene::from_ron(text, "doc")?;
    /// assert_eq!(scene.surfaces.len(), 1);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Malformed`] with line and column, or [`SceneError::Empty`].
    pub fn from_ron(text: &str, origin: &str) -> Result<Scene, SceneError> {
        let scene = parse(text, origin)?;
        scene.check()?;
        Ok(scene)
    }
}

/// The scene that the text says, not yet checked as a whole.
fn parse(text: &str, origin: &str) -> Result<Scene, SceneError> {
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    // Some editors put a byte-order mark before the text.
    let text = text.trim_start_matches('\u{feff}');
    let file: SceneFile = options.from_str(text).map_err(|error| {
        let start = error.span.start;
        SceneError::Malformed {
            origin: origin.to_owned(),
            line: start.line,
            column: start.col,
            message: error.code.to_string(),
        }
    })?;
    Ok(Scene::from(file))
}

#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
struct SceneFile {
    #[serde(default)]
    name: String,
    surfaces: Vec<SurfaceFile>,
    source: SourceFile,
    listener: ListenerFile,
}

#[derive(Deserialize)]
#[serde(rename = "Surface", deny_unknown_fields)]
struct SurfaceFile {
    #[serde(default)]
    name: Option<String>,
    shape: ShapeFile,
    #[serde(default)]
    position: Point,
    #[serde(default)]
    rotation: Rotation,
    #[serde(default)]
    turns: bool,
}

#[derive(Deserialize)]
#[serde(rename = "Shape", deny_unknown_fields)]
enum ShapeFile {
    Plane,
    Box { size: Size },
    Room { size: Size },
    Sphere { radius: Length },
    Cylinder { radius: Length },
}

#[derive(Deserialize)]
#[serde(rename = "Source", deny_unknown_fields)]
struct SourceFile {
    #[serde(default)]
    position: Option<Point>,
    #[serde(default)]
    path: PathFile,
}

#[derive(Deserialize)]
#[serde(rename = "Listener", deny_unknown_fields)]
struct ListenerFile {
    #[serde(default)]
    position: Option<Point>,
    #[serde(default)]
    yaw: Degrees,
    #[serde(default)]
    pitch: Degrees,
    radius: Length,
    #[serde(default)]
    path: PathFile,
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

/// Any finite number.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "f64")]
struct Finite(f64);

/// An angle in degrees, kept in radians.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "f32")]
struct Degrees(f32);

/// A length in metres, finite and greater than 0.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
struct Length(f32);

/// A position in metres.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "(f32, f32, f32)")]
struct Point(Vec3);

/// Full width, height and depth in metres, each finite and greater than 0.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "(f32, f32, f32)")]
struct Size(Vec3);

/// Right-handed turns about x, then y, then z, of the world's axes, in degrees.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "(f32, f32, f32)")]
struct Rotation(Quat);

/// Keys whose times strictly increase.
#[derive(Default, Deserialize)]
#[serde(try_from = "Vec<KeyFile>")]
struct PathFile(Path);

impl TryFrom<f64> for Finite {
    type Error = String;
    fn try_from(value: f64) -> Result<Finite, String> {
        if value.is_finite() {
            return Ok(Finite(value));
        }
        Err(format!("a number must be finite, not {value}"))
    }
}

impl TryFrom<f32> for Degrees {
    type Error = String;
    fn try_from(degrees: f32) -> Result<Degrees, String> {
        if degrees.is_finite() {
            return Ok(Degrees(degrees.to_radians()));
        }
        Err(format!("an angle in degrees must be finite, not {degrees}"))
    }
}

impl TryFrom<f32> for Length {
    type Error = String;
    fn try_from(metres: f32) -> Result<Length, String> {
        if metres.is_finite() && metres > 0.0 {
            return Ok(Length(metres));
        }
        Err(format!(
            "a radius in metres must be finite and greater than 0, not {metres}"
        ))
    }
}

impl TryFrom<(f32, f32, f32)> for Point {
    type Error = String;
    fn try_from(metres: (f32, f32, f32)) -> Result<Point, String> {
        let point = Vec3::from(metres);
        if point.is_finite() {
            return Ok(Point(point));
        }
        Err(format!("a position in metres must be finite, not {point}"))
    }
}

impl TryFrom<(f32, f32, f32)> for Size {
    type Error = String;
    fn try_from(metres: (f32, f32, f32)) -> Result<Size, String> {
        let size = Vec3::from(metres);
        if size.is_finite() && size.min_element() > 0.0 {
            return Ok(Size(size));
        }
        Err(format!(
            "a size in metres must be finite and greater than 0 in all three axes, not {size}"
        ))
    }
}

impl TryFrom<(f32, f32, f32)> for Rotation {
    type Error = String;
    fn try_from(degrees: (f32, f32, f32)) -> Result<Rotation, String> {
        let turns = Vec3::from(degrees);
        if !turns.is_finite() {
            return Err(format!("a rotation in degrees must be finite, not {turns}"));
        }
        let radians = turns.map(f32::to_radians);
        Ok(Rotation(Quat::from_euler(
            EulerRot::XYZEx,
            radians.x,
            radians.y,
            radians.z,
        )))
    }
}

impl TryFrom<Vec<KeyFile>> for PathFile {
    type Error = String;
    fn try_from(keys: Vec<KeyFile>) -> Result<PathFile, String> {
        let keys = keys.iter().map(Key::from).collect();
        match Path::new(keys) {
            Some(path) => Ok(PathFile(path)),
            None => Err("the times of a path's keys must increase".to_owned()),
        }
    }
}

impl From<&KeyFile> for Key {
    fn from(key: &KeyFile) -> Key {
        Key {
            time: key.time.0,
            position: key.position.0,
            yaw: key.yaw.0,
            pitch: key.pitch.0,
        }
    }
}

impl From<SceneFile> for Scene {
    fn from(file: SceneFile) -> Scene {
        Scene {
            name: file.name,
            surfaces: file.surfaces.into_iter().map(Surface::from).collect(),
            source: Source::from(file.source),
            listener: Listener::from(file.listener),
        }
    }
}

impl From<SurfaceFile> for Surface {
    fn from(file: SurfaceFile) -> Surface {
        Surface {
            name: file.name,
            shape: Shape::from(file.shape),
            position: file.position.0,
            rotation: file.rotation.0,
            turns: file.turns,
            angles: Vec3::ZERO,
            drivers: Vec::new(),
        }
    }
}

impl From<ShapeFile> for Shape {
    fn from(file: ShapeFile) -> Shape {
        match file {
            ShapeFile::Plane => Shape::Plane,
            ShapeFile::Box { size } => Shape::Box { size: size.0 },
            ShapeFile::Room { size } => Shape::Room { size: size.0 },
            ShapeFile::Sphere { radius } => Shape::Sphere { radius: radius.0 },
            ShapeFile::Cylinder { radius } => Shape::Cylinder { radius: radius.0 },
        }
    }
}

impl From<SourceFile> for Source {
    fn from(file: SourceFile) -> Source {
        let start = file.path.0.at(0.0).map(|key| key.position);
        Source {
            position: file.position.map(|p| p.0).or(start).unwrap_or_default(),
            path: file.path.0,
        }
    }
}

impl From<ListenerFile> for Listener {
    fn from(file: ListenerFile) -> Listener {
        let start = file.path.0.at(0.0);
        let standing = Listener {
            position: file.position.unwrap_or_default().0,
            yaw: file.yaw.0,
            pitch: file.pitch.0,
            radius: file.radius.0,
            path: file.path.0,
        };
        match start {
            Some(key) if file.position.is_none() => Listener {
                position: key.position,
                yaw: key.yaw,
                pitch: key.pitch,
                ..standing
            },
            _ => standing,
        }
    }
}
