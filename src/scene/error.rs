//! Errors of scenes, and warnings about unusual scenes that can still be traced.
//!
//! Each message is written next to its check. The syntax of a file is checked in `crate::ron_error` and
//! `scene/file/mod.rs`; the range of a number in `scene/shape/part.rs` and `scene/notation/numbers.rs`; a shape in
//! `scene/shape/mod.rs` and the shape's own file; names, materials and the scene as a whole in `scene/check/`; sizes
//! too large for a renderer in `shader/structure.rs`.

use super::material::WALL_NAMES;
use crate::file_input::{InputError, MalformedText};
use crate::text;
use std::fmt;
use std::path::{Path, PathBuf};

/// The reason why a scene cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The name is neither a built-in scene nor an existing file.
    #[error(
        "there is no scene {name:?}: neither a file nor one of the built-in scenes ({builtin}){}",
        nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean {name}?"))
    )]
    Unknown {
        /// The requested name.
        name: String,
        /// The names of the built-in scenes, separated by commas.
        builtin: String,
        /// The built-in scene with a similar name, or a file with this name and an extension, if any.
        nearest: Option<String>,
    },
    /// The file cannot be read.
    #[error("cannot read the scene file {}: {source}{}", path.display(), may_be_meant(source, path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: InputError,
    },
    /// The text is not a scene. Its origin is the path of the file, or `scene` for text that was not read from a file.
    #[error(transparent)]
    Malformed(MalformedText),
    /// A file in the folder cannot refer to the base: no path from the folder to the base can be written in a scene
    /// file.
    #[error("{} has no path that a scene file in the folder {} can name", base.display(), folder.display())]
    NoBase {
        /// The folder of the file that refers to the base.
        folder: PathBuf,
        /// The base.
        base: PathBuf,
    },
    /// A file that the scene names cannot be used.
    #[error("{origin}{}: {why}", line_and_column(*place))]
    Attached {
        /// The scene file, or the name used for the scene's text.
        origin: String,
        /// Line and column of the part that names the file, each counted from 1, if they are known.
        place: Option<(usize, usize)>,
        /// The file and the error.
        why: String,
    },
    /// The scene becomes invalid at some time between its first and its last key frame.
    #[error("at {seconds} s, {refused}")]
    At {
        /// The time, at a key or between two keys.
        seconds: f64,
        /// The error at that time.
        refused: Box<SceneError>,
    },
    /// The scene has no surfaces.
    #[error("scene {scene:?} has no surfaces: there is nothing for a wave to meet")]
    Empty {
        /// The scene's name.
        scene: String,
    },
    /// An invalid field.
    #[error("scene {scene:?}: {surface}: {why}")]
    BadField {
        /// The scene's name.
        scene: String,
        /// The surface.
        surface: String,
        /// The error, and how to correct it.
        why: String,
    },
    /// A driver for a number that does not exist.
    #[error("{}", text::which_it_has(
        &format!("scene {scene:?}: {surface} has no number {parameter:?} that could be driven"),
        parameter,
        known,
    ))]
    UnknownParameter {
        /// The scene's name.
        scene: String,
        /// The surface.
        surface: String,
        /// The requested name.
        parameter: String,
        /// The existing names.
        known: Vec<String>,
    },
    /// A named value that the scene does not use.
    #[error("{}", text::which_it_has(
        &format!("scene {scene:?} has no value named {name:?}"),
        name,
        known,
    ))]
    UnknownValue {
        /// The scene's name.
        scene: String,
        /// The requested name.
        name: String,
        /// The existing names.
        known: Vec<String>,
    },
    /// The scene has no source or listener with this index.
    #[error("scene {scene:?} has no {what} number {number}: it has {count}, counted from 0")]
    NoSuchNumber {
        /// The scene's name.
        scene: String,
        /// `source` or `listener`.
        what: &'static str,
        /// The requested number, from 0.
        number: usize,
        /// Number of existing sources or listeners.
        count: usize,
    },
    /// The operation needs exactly one source and one listener, but the scene has none or several.
    /// [`Scene::pair`](super::Scene::pair) selects among several.
    #[error(
        "scene {scene:?} has {} and {}: one of each must be chosen",
        counted(*sources, "source"),
        counted(*listeners, "listener")
    )]
    NotOnePair {
        /// The scene's name.
        scene: String,
        /// Number of its sources.
        sources: usize,
        /// Number of its listeners.
        listeners: usize,
    },
    /// A height image that cannot be used.
    #[error("{why}")]
    BadHeightImage {
        /// Name or file of the image, and the requirement.
        why: String,
    },
    /// A sampled field that cannot be used.
    #[error("{why}")]
    BadSampledField {
        /// Name or file of the field, and the requirement.
        why: String,
    },
    /// The orientation of a listener tilts the head to one side. A listener has only yaw and pitch.
    #[error(
        "a listener's head cannot be tilted to a side, and this orientation tilts it by {roll_deg}° to the right: give the direction of its gaze instead"
    )]
    RolledListener {
        /// Roll angle about the viewing direction in degrees, positive to the right.
        roll_deg: f32,
    },
    /// The orientation of a source or a listener is zero or not finite.
    #[error("a {of} must be finite and not 0, not {value}")]
    NoOrientation {
        /// `listener's quaternion`, `listener's direction` or `source's direction`.
        of: &'static str,
        /// The given components.
        value: String,
    },
    /// A room has no wall with this number.
    #[error(
        "a room has no wall number {wall}: they are counted from 0, {}",
        WALL_NAMES.join(", ")
    )]
    NoSuchWall {
        /// The requested number, from 0.
        wall: usize,
    },
    /// Two sources or two listeners have the same name.
    #[error("scene {scene:?}: two of the {what} are called {name:?}")]
    SameName {
        /// The scene's name.
        scene: String,
        /// `sources` or `listeners`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// The name of a source or listener equals the number of an unnamed source or listener.
    #[error(
        "scene {scene:?}: one of the {what} is called {name:?}, which is the number of another that has no name: name that one too"
    )]
    NameIsNumber {
        /// The scene's name.
        scene: String,
        /// `sources` or `listeners`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A number outside its valid range.
    #[error("scene {scene:?}: {what} must be {must}, not {value}")]
    BadNumber {
        /// The scene's name.
        scene: String,
        /// Name of the value, with its unit.
        what: String,
        /// Its valid range.
        must: &'static str,
        /// The given value.
        value: String,
    },
}

/// A clause that suggests the built-in scene with the name of a missing file.
fn may_be_meant(why: &InputError, path: &Path) -> String {
    match why {
        InputError::Io(error) if error.kind() == std::io::ErrorKind::NotFound => {
            super::built_in_of(path)
        }
        _ => String::new(),
    }
}

impl SceneError {
    /// Adds a time to the error, unless the error already has one.
    #[doc(hidden)]
    #[must_use]
    pub fn at(self, seconds: f64) -> SceneError {
        match self {
            SceneError::At { .. } => self,
            refused => SceneError::At {
                seconds,
                refused: Box::new(refused),
            },
        }
    }
}

/// Maximum number of surfaces that one message lists.
const MOST_LISTED: usize = 6;

/// A position as it stands after the name of a text.
fn line_and_column(place: Option<(usize, usize)>) -> String {
    place.map_or(String::new(), |(line, column)| format!(":{line}:{column}"))
}

/// Joins the first labels of a list, and states the number of the omitted labels.
fn listed(labels: &[String]) -> String {
    let (listed, more) = labels.split_at(labels.len().min(MOST_LISTED));
    match more.len() {
        0 => listed.join(", "),
        count => format!("{} and {count} more", listed.join(", ")),
    }
}

/// A problem of a scene that can still be traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The source is in a solid and cannot be heard.
    SourceInsideSurface {
        /// The source's name in messages, such as `the source` or `source 2 (flute)`.
        source: String,
        /// The surface, or the solid around a room.
        surface: String,
        /// Depth in metres.
        depth: f32,
    },
    /// The source is inside the listener's sphere: each wave of a frame ends at its start.
    SourceInsideListener {
        /// The source's name in messages.
        source: String,
        /// The listener's name in messages.
        listener: String,
        /// Distance of the source from the listener's centre, in metres.
        distance: f32,
        /// Radius of the listener, in metres.
        radius: f32,
    },
    /// The centre of the listener is in a solid.
    ListenerInsideSurface {
        /// The listener's name in messages.
        listener: String,
        /// The surface, or the solid around a room.
        surface: String,
        /// Depth in metres.
        depth: f32,
    },
    /// The scene has several rooms. The space outside a room is solid, so only the space inside all rooms is air.
    RoomsFillEachOther {
        /// Labels of the rooms: `1`, `surface 2 (Room)`.
        rooms: Vec<String>,
    },
    /// Boxes of air of [`Rooms`](super::shape::Rooms) that no other box joins to the first one.
    RoomsApart {
        /// The surface.
        surface: String,
        /// Names of the boxes.
        rooms: Vec<String>,
    },
    /// Surfaces and walls without a material, in a scene in which others have one. They reflect all sound, which
    /// lengthens decays.
    NoMaterial {
        /// Labels of the surfaces and walls: `room/floor`, `surface 2 (Sphere)`.
        surfaces: Vec<String>,
    },
    /// A user's field or a grid that is solid at all samples in its box, or air at all samples.
    OneSided {
        /// The surface.
        surface: String,
        /// The field's file.
        file: String,
        /// True if all samples are solid, false if all samples are air.
        solid: bool,
    },
    /// A room that is so large that its unit is probably not the metre.
    LargeRoom {
        /// The surface.
        surface: String,
        /// The longest edge of the box around its air, in metres.
        length: f64,
    },
    /// Air whose humidity is at most 1 %, and probably stated as a share.
    DryAir {
        /// Relative humidity in per cent.
        humidity: f64,
    },
    /// A material with a density below 8 kg/m³, which is probably stated in g/cm³.
    LightSolid {
        /// Name of the material.
        material: String,
        /// Density in kg/m³.
        density: f64,
    },
    /// All sources and listeners are in the solid of one surface: below a ground, or in a solid that is probably meant to
    /// be a room.
    AllInSolid {
        /// The surface.
        surface: String,
        /// Whether the surface is a plane or a half space.
        is_half_space: bool,
    },
    /// A surface that lies wholly in the solid of another one, such as that around a room, and has no effect.
    Buried {
        /// The surface.
        surface: String,
        /// The other surface, or the solid around a room.
        solid: String,
    },
    /// A surface a few centimetres or less above the floor of a room.
    Hovering {
        /// The surface.
        surface: String,
        /// The room.
        room: String,
        /// Height above the floor, in metres.
        gap: f64,
    },
    /// A listener whose radius exceeds the shortest edge of a room.
    LargeListener {
        /// The listener's name in messages.
        listener: String,
        /// Radius of the listener, in metres.
        radius: f32,
        /// The shortest edge of all rooms, in metres.
        edge: f64,
    },
    /// A source or a listener whose yaw is probably stated in radians.
    YawInRadians {
        /// Its name in messages.
        of: String,
        /// The first of its yaws that is not 0, in degrees as read.
        yaw: f32,
    },
    /// A path so slow that its times are probably stated in milliseconds.
    SlowPath {
        /// The name of the source or the listener in messages.
        of: String,
        /// Duration of the path, in seconds.
        seconds: f64,
    },
    /// A mesh with a defect that changes what is heard.
    OddMesh {
        /// The surface.
        surface: String,
        /// The number and the first place of the defect, and its effect.
        why: String,
    },
}

/// Formats a count with its noun: `1 source`, `2 sources`.
fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

/// Converts a length in metres to `f64`, rounded to millimetres.
fn to_millimetres(metres: f32) -> f64 {
    (1e3 * f64::from(metres)).round() / 1e3
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::AllInSolid {
                surface,
                is_half_space: true,
            } => write!(
                f,
                "all sources and listeners are in the solid of {surface}: move them to the side of its air, which is above it if it is a ground"
            ),
            Warning::AllInSolid {
                surface,
                is_half_space: false,
            } => write!(
                f,
                "all sources and listeners are in the solid of {surface}: if it is meant to be a room, hollow it out (Shell(of: …, thickness: …)), or exchange its air and its solid (a field is positive in the air; Complement(of: …) exchanges both)"
            ),
            Warning::Buried { surface, solid } => write!(
                f,
                "{surface} lies wholly in {solid}, and has no effect: move it into the air"
            ),
            Warning::Hovering { surface, room, gap } => {
                let gap = to_millimetres(*gap as f32);
                write!(
                    f,
                    "{surface} is {gap} m above the floor of {room}: if it should stand there, move it down by {gap} m"
                )
            }
            Warning::LargeListener {
                listener,
                radius,
                edge,
            } => write!(
                f,
                "the radius of {listener} is {radius} m, and the shortest edge of a room {} m: radii are in metres, and 0.3 is a good value for rooms",
                *edge as f32
            ),
            Warning::YawInRadians { of, yaw } => write!(
                f,
                "the yaw of {of} is {yaw}°: if it is in radians, state it in degrees ({})",
                yaw.to_degrees().round()
            ),
            Warning::SlowPath { of, seconds } => write!(
                f,
                "the path of {of} takes {seconds} s, and is slower than 1 cm/s: if its times are in milliseconds, state them in seconds"
            ),
            Warning::OddMesh { surface, why } => write!(f, "{surface}: {why}"),
            Warning::LargeRoom { surface, length } => write!(
                f,
                "{surface}: it is {length} m long: if its unit is not the metre, state its lengths in metres"
            ),
            Warning::DryAir { humidity } => write!(
                f,
                "the air's humidity is {humidity} %: if it is a share, state it in per cent ({})",
                (1e4 * humidity).round() / 100.0
            ),
            Warning::LightSolid { material, density } => write!(
                f,
                "the density of the material {material:?} is {density} kg/m³, less than that of most foams: if it is in g/cm³, multiply it by 1000"
            ),
            Warning::SourceInsideSurface {
                source,
                surface,
                depth,
            } => {
                write!(
                    f,
                    "{source} is {} m inside {surface}: nothing of it is heard",
                    to_millimetres(*depth)
                )
            }
            Warning::SourceInsideListener {
                source,
                listener,
                distance,
                radius,
            } => write!(
                f,
                "{source} is {distance} m from the centre of {listener}, inside its sphere of {radius} m: each wave of a frame ends at its start, so the frame has no left-right balance"
            ),
            Warning::ListenerInsideSurface {
                listener,
                surface,
                depth,
            } => {
                write!(
                    f,
                    "the centre of {listener} is {} m inside {surface}: few waves reach it, and no exact path",
                    to_millimetres(*depth)
                )
            }
            Warning::RoomsFillEachOther { rooms } => write!(
                f,
                "{} fill each other: the space outside a Room is solid; write connected rooms and their doorways as one surface, Rooms(of: [(from: (x, y, z), to: (x, y, z)), …])",
                listed(rooms)
            ),
            Warning::RoomsApart { surface, rooms } => {
                let verb = if rooms.len() == 1 { "has" } else { "have" };
                write!(
                    f,
                    "{surface}: {} {verb} no way to the first box: a doorway is a box that touches both sides",
                    listed(rooms)
                )
            }
            Warning::NoMaterial { surfaces } => {
                let verb = match surfaces.len() {
                    1 => "has no material and reflects",
                    _ => "have no material and reflect",
                };
                write!(
                    f,
                    "{} {verb} all sound, which makes decays too long: give each surface a material",
                    listed(surfaces)
                )
            }
            Warning::OneSided {
                surface,
                file,
                solid,
            } => {
                let (all, sign) = if *solid {
                    ("solid", "negative")
                } else {
                    ("air", "positive")
                };
                write!(
                    f,
                    "{surface}: {file} is all {all}: its value is {sign} at every sample in its box"
                )
            }
        }
    }
}
