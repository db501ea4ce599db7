//! Rooms joined to one body of air.

use super::asset::Asset;
use super::part::{Notation, arguments, parameters, surface_kind};
use super::{Bounds3, LARGEST, Part, Properties, Room, Shape};
use crate::scene::mesh::{
    AirCells, AirCorners, Inside, MeshError, MeshOptions, TriangleMesh, bodies,
};
use crate::scene::notation::{Fields, Name, Point, Reader, Written};
use crate::scene::{ROUNDING, SceneError};
use glam::{DVec3, Vec3};
use serde::Deserialize;
use std::sync::Arc;

/// Maximum number of boxes. Each of the six walls of each box then has a number below 255, the limit of a mesh.
const MOST_BOXES: usize = 42;

/// Maximum number of triangles around the air of one surface. A floor with 42 rooms and doors has some thousands.
const MOST_TRIANGLES: usize = 20_000;

/// A box of air: a room, a corridor or a doorway.
#[derive(Clone, Debug, PartialEq)]
pub struct AirBox {
    /// Name in messages, and in the materials of a surface ([`Surface::faces`](crate::Surface::faces)); the box's
    /// number, counted from 1, if it is empty.
    pub name: String,
    /// The corner with the least coordinates, in metres.
    pub from: Vec3,
    /// The corner with the greatest coordinates, in metres.
    pub to: Vec3,
}

/// The union of boxes of air, such as rooms with doorways, in a solid without an end. The boxes have the axes of the
/// surface. Boxes that overlap, or share a part of a face, are one body of air.
///
/// Waves meet the walls exactly, in closed form. The distance is exact on both sides.
///
/// ```
/// use echomarch::Surface;
/// use echomarch::scene::shape::{AirBox, Rooms};
///
/// let air = |name: &str, from: [f32; 3], to: [f32; 3]| AirBox {
///     name: name.to_owned(),
///     from: from.into(),
///     to: to.into(),
/// };
/// let rooms = Rooms::new([
///     air("office", [0.0, 0.0, 0.0], [5.0, 2.7, 4.0]),
///     air("door", [5.0, 0.0, 1.0], [5.2, 2.1, 1.9]),
///     air("corridor", [5.2, 0.0, 0.0], [7.0, 2.7, 9.0]),
/// ])?;
/// assert!((rooms.volume_m3() - (54.0 + 0.378 + 43.74)).abs() < 1e-4);
/// let surface = Surface::new(rooms)
///     .with_material("plaster")
///     .with_face_material("corridor/floor", "marble");
/// # Ok::<(), echomarch::scene::mesh::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Rooms {
    boxes: Vec<AirBox>,
    /// The corners of the boxes. Faces in one plane have the same coordinate.
    corners: Vec<AirCorners>,
    /// The walls. The group of a face is the number of its wall, plus six times the index of its box.
    mesh: Arc<TriangleMesh>,
}

/// Rooms are equal if their boxes are.
impl PartialEq for Rooms {
    fn eq(&self, other: &Rooms) -> bool {
        self.boxes == other.boxes
    }
}

impl Rooms {
    /// The union of these boxes.
    ///
    /// # Errors
    /// [`MeshError`] with the box or the place, and the problem.
    pub fn new(boxes: impl IntoIterator<Item = AirBox>) -> Result<Rooms, MeshError> {
        let boxes: Vec<AirBox> = boxes.into_iter().collect();
        check(&boxes)?;
        let (corners, touch) = corners_of(&boxes);
        let cells = AirCells::of(&corners, touch);
        if let Some(place) = cells.pinched_corner() {
            return Err(MeshError::Pinched { place });
        }
        let mut faces = cells.faces();
        if faces.triangles.len() > MOST_TRIANGLES {
            let (what, most) = ("triangles", MOST_TRIANGLES);
            return Err(MeshError::TooMany { what, most });
        }
        let walls = |of| Room::WALL_NAMES.map(|wall| format!("{}/{wall}", name_of(&boxes, of)));
        faces.groups = (0..boxes.len()).flat_map(walls).collect();
        let options = MeshOptions {
            inside: Some(Inside::Air),
            ..MeshOptions::default()
        };
        let mesh = Arc::new(TriangleMesh::new("Rooms", faces, options)?);
        Ok(Rooms {
            corners: corners.iter().map(|of| cells.in_planes(of)).collect(),
            boxes,
            mesh,
        })
    }

    /// The boxes.
    pub fn boxes(&self) -> &[AirBox] {
        &self.boxes
    }

    /// Volume of the air in m³.
    pub fn volume_m3(&self) -> f64 {
        self.mesh.report().volume_m3
    }

    /// Area of all walls in m².
    pub fn area_m2(&self) -> f64 {
        self.mesh.report().area_m2
    }

    pub(crate) fn mesh(&self) -> &Arc<TriangleMesh> {
        &self.mesh
    }

    /// The name of the box, and the number of the wall in [`Room::WALL_NAMES`], of a group of the mesh.
    pub(crate) fn wall(&self, group: usize) -> Option<(String, usize)> {
        let (of, wall) = (group / Room::WALL_COUNT, group % Room::WALL_COUNT);
        (of < self.boxes.len()).then(|| (name_of(&self.boxes, of), wall))
    }

    /// Whether a group has faces: a wall that other boxes cover has none.
    pub(crate) fn has_faces(&self, group: usize) -> bool {
        self.mesh.has_group(group)
    }

    /// The least and the greatest coordinates of each box in metres, one after another.
    pub(crate) fn corners(&self) -> Vec<f64> {
        let boxes = self.corners.iter();
        boxes
            .flat_map(|of| [of.from.to_array(), of.to.to_array()].concat())
            .collect()
    }

    /// The names of all boxes.
    pub(crate) fn names(&self) -> impl Iterator<Item = String> {
        (0..self.boxes.len()).map(|index| name_of(&self.boxes, index))
    }

    /// The names of the boxes without a way to the first box.
    pub(crate) fn cut_off(&self) -> Vec<String> {
        let (corners, touch) = corners_of(&self.boxes);
        let bodies = bodies(&corners, touch);
        let names = self.names().zip(&bodies);
        names
            .filter(|(_, body)| **body != bodies[0])
            .map(|(name, _)| name)
            .collect()
    }
}

fn name_of(boxes: &[AirBox], index: usize) -> String {
    match boxes[index].name.is_empty() {
        true => (index + 1).to_string(),
        false => boxes[index].name.clone(),
    }
}

/// The corners in `f64`, and the difference of coordinates in metres up to which two faces lie in one plane: the
/// rounding of a coordinate that a program computes.
fn corners_of(boxes: &[AirBox]) -> (Vec<AirCorners>, f64) {
    let corners = boxes.iter().map(|of| AirCorners {
        from: of.from.as_dvec3(),
        to: of.to.as_dvec3(),
    });
    let sizes = boxes
        .iter()
        .map(|of| of.from.abs().max(of.to.abs()).max_element());
    let touch = ROUNDING * sizes.fold(0.0, f32::max);
    (corners.collect(), touch.into())
}

fn check(boxes: &[AirBox]) -> Result<(), MeshError> {
    let count = boxes.len();
    if !(1..=MOST_BOXES).contains(&count) {
        return Err(MeshError::BadBoxCount {
            count,
            most: MOST_BOXES,
        });
    }
    for (index, of) in boxes.iter().enumerate() {
        let name = name_of(boxes, index);
        check_corners(&name, of.from, of.to)?;
        let mut before = (0..index).map(|before| name_of(boxes, before));
        if name.contains('/') || before.any(|before| before == name) {
            return Err(MeshError::BadBoxName { name });
        }
    }
    let (corners, touch) = corners_of(boxes);
    for (index, of) in corners.iter().enumerate() {
        if (of.to - of.from).min_element() <= 2.0 * touch {
            let AirBox { from, to, .. } = boxes[index];
            let name = name_of(boxes, index);
            return Err(MeshError::BadBox { name, from, to });
        }
    }
    Ok(())
}

fn check_corners(name: &str, from: Vec3, to: Vec3) -> Result<(), MeshError> {
    let is_sound = |corner: Vec3| corner.abs().cmple(Vec3::splat(LARGEST)).all();
    match is_sound(from) && is_sound(to) && from.cmplt(to).all() {
        true => Ok(()),
        false => Err(MeshError::BadBox {
            name: name.to_owned(),
            from,
            to,
        }),
    }
}

/// The notation in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    of: Vec<BoxFile>,
}

/// A box whose corners are in order.
#[derive(Deserialize)]
#[serde(try_from = "Corners")]
struct BoxFile(AirBox);

#[derive(Deserialize)]
#[serde(rename = "AirBox", deny_unknown_fields)]
struct Corners {
    #[serde(default)]
    name: Name,
    from: Point,
    to: Point,
}

impl TryFrom<Corners> for BoxFile {
    type Error = MeshError;

    fn try_from(file: Corners) -> Result<BoxFile, MeshError> {
        let (Name(name), Point(from), Point(to)) = (file.name, file.from, file.to);
        check_corners(&name, from, to)?;
        Ok(BoxFile(AirBox { name, from, to }))
    }
}

impl Notation for Rooms {
    type File = File;

    fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
        let files = reader.files();
        files.take_room_cells(AirCells::most(file.of.len()))?;
        let boxes = file.of.into_iter().map(|BoxFile(of)| of);
        let rooms = Rooms::new(boxes).map_err(|why| files.refused(why.to_string()))?;
        Ok(Shape::from(rooms))
    }
}

parameters!(Rooms {});

impl Part for Rooms {
    surface_kind!(FLAT);

    fn asset(&self) -> Option<Asset<'_>> {
        Some(Asset::Mesh(&self.mesh))
    }

    fn words(&self) -> Fields {
        let boxes = self.boxes.iter().map(|of| {
            let corner = |of: Vec3| Written::Tuple(of.to_array().map(Written::Number).to_vec());
            let mut fields = Fields::new();
            if !of.name.is_empty() {
                fields.push(("name", Written::Text(of.name.clone())));
            }
            fields.extend([("from", corner(of.from)), ("to", corner(of.to))]);
            Written::Struct("AirBox", fields)
        });
        vec![("of", Written::List(boxes.collect()))]
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            convex: false,
            symmetric: [false; 3],
            bounds: Bounds3::EVERYWHERE,
            ..Properties::exact(DVec3::ZERO)
        }
    }

    fn own_length(&self) -> f64 {
        self.mesh.extent()
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        self.mesh.distance(p)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        self.corners()
    }

    arguments!();
}
