//! Wavefront OBJ: vertices (`v`), faces (`f`) and materials (`usemtl`). All other lines are ignored: points, lines,
//! curves, texture coordinates, normals, and the names of objects and files.
//!
//! Faces with more than three corners are divided by cutting ears. A face before the first `usemtl` belongs to the group
//! `default`.

use super::{MOST_TRIANGLES, MeshError, MeshFaces};
use earcut::Earcut;
use earcut::utils3d::project3d_to_2d;
use glam::DVec3;
use std::collections::HashMap;

/// The group of faces before the first `usemtl`.
const NO_GROUP: &str = "default";

/// Maximum number of corners of a face. Cutting the ears of a face takes at most the square of this number.
const MOST_CORNERS: usize = 10_000;

/// Maximum length of a group's name in characters; longer names are cut.
const LONGEST_NAME: usize = 200;

/// Reads the faces of a text.
///
/// # Errors
/// [`MeshError::BadLine`] with the number of the line.
pub(super) fn faces(bytes: &[u8]) -> Result<MeshFaces, MeshError> {
    let mut reader = Reader::default();
    for (index, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let read = reader.read(line);
        read.map_err(|why| MeshError::BadLine {
            line: index + 1,
            why,
        })?;
    }
    Ok(reader.faces)
}

#[derive(Default)]
struct Reader {
    faces: MeshFaces,
    groups: HashMap<String, u32>,
    group: Option<u32>,
    ears: Earcut<f64>,
    corners: Vec<u32>,
}

impl Reader {
    fn read(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.trim_ascii();
        if line.ends_with(b"\\") && (line.starts_with(b"f ") || line.starts_with(b"v ")) {
            return Err(
                "a vertex or a face continues in the next line, which is not supported".to_owned(),
            );
        }
        let Some((word, rest)) = first_word(line) else {
            return Ok(());
        };
        match word {
            b"v" => self.vertex(rest),
            b"f" => self.face(rest),
            b"usemtl" => {
                let name = String::from_utf8_lossy(rest.trim_ascii());
                self.use_group(&name);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn vertex(&mut self, mut rest: &[u8]) -> Result<(), String> {
        let mut place = DVec3::ZERO;
        for axis in 0..3 {
            let (word, behind) = first_word(rest).ok_or("a vertex has three coordinates")?;
            place[axis] = number(word)?;
            rest = behind;
        }
        if self.faces.vertices.len() >= 3 * MOST_TRIANGLES {
            return Err(format!(
                "there are more than {} vertices, the limit",
                3 * MOST_TRIANGLES
            ));
        }
        self.faces.vertices.push(place);
        Ok(())
    }

    fn use_group(&mut self, name: &str) {
        let name: String = name
            .chars()
            .filter(|c| !c.is_control())
            .take(LONGEST_NAME)
            .collect();
        let name = if name.is_empty() {
            NO_GROUP.to_owned()
        } else {
            name
        };
        let groups = &mut self.faces.groups;
        let number = self.groups.entry(name).or_insert_with_key(|name| {
            groups.push(name.clone());
            groups.len() as u32 - 1
        });
        self.group = Some(*number);
    }

    fn face(&mut self, mut rest: &[u8]) -> Result<(), String> {
        if self.group.is_none() {
            self.use_group(NO_GROUP);
        }
        self.corners.clear();
        while let Some((word, behind)) = first_word(rest) {
            let index = word.split(|byte| *byte == b'/').next().unwrap_or(word);
            self.corners.push(corner(index, self.faces.vertices.len())?);
            rest = behind;
        }
        let count = self.corners.len();
        match count {
            ..3 => return Err(format!("a face has at least 3 corners, not {count}")),
            3 => self.add([0, 1, 2]),
            4..=MOST_CORNERS => self.divide(),
            _ => {
                return Err(format!(
                    "a face has at most {MOST_CORNERS} corners, not {count}"
                ));
            }
        }
        match self.faces.triangles.len() > MOST_TRIANGLES {
            true => Err(format!(
                "there are more than {MOST_TRIANGLES} triangles, the limit"
            )),
            false => Ok(()),
        }
    }

    /// Adds a triangle of these corners of the face.
    fn add(&mut self, corners: [usize; 3]) {
        self.faces
            .triangles
            .push(corners.map(|at| self.corners[at]));
        self.faces.group_of.push(self.group.unwrap_or(0));
    }

    /// Divides a face with more than three corners.
    fn divide(&mut self) {
        let places: Vec<[f64; 3]> = self
            .corners
            .iter()
            .map(|corner| self.faces.vertices[*corner as usize].to_array())
            .collect();
        let mut flat = Vec::new();
        let mut triangles: Vec<usize> = Vec::new();
        if !project3d_to_2d(&places, places.len(), &mut flat) {
            self.faces.flat_polygons += 1;
            return;
        }
        self.ears.earcut(flat, &[], &mut triangles);
        self.faces.divided_polygons += 1;
        let normal = polygon_normal(&places);
        let (cut, _) = triangles.as_chunks::<3>();
        for &[a, b, c] in cut {
            let [p, q, r] = [a, b, c].map(|at| DVec3::from_array(places[at]));
            match (q - p).cross(r - p).dot(normal) < 0.0 {
                true => self.add([a, c, b]),
                false => self.add([a, b, c]),
            }
        }
    }
}

/// The sum of the cross products of consecutive corners: twice the area of the polygon along its normal (Newell).
fn polygon_normal(places: &[[f64; 3]]) -> DVec3 {
    let origin = places
        .first()
        .map_or(DVec3::ZERO, |place| DVec3::from_array(*place));
    let next = places.iter().cycle().skip(1);
    let pairs = places.iter().zip(next);
    pairs
        .map(|(a, b)| (DVec3::from_array(*a) - origin).cross(DVec3::from_array(*b) - origin))
        .sum()
}

/// The first word of a line, and the rest behind it.
fn first_word(line: &[u8]) -> Option<(&[u8], &[u8])> {
    let line = line.trim_ascii_start();
    let end = line.iter().position(u8::is_ascii_whitespace);
    let (word, rest) = line.split_at(end.unwrap_or(line.len()));
    (!word.is_empty() && word[0] != b'#').then_some((word, rest))
}

fn number(word: &[u8]) -> Result<f64, String> {
    let text = String::from_utf8_lossy(word);
    let parsed = text.parse();
    parsed.map_err(|_| format!("{:?} is not a number", shortened(&text)))
}

/// The index of a corner: counted from 1, or from the last vertex backwards if negative.
fn corner(word: &[u8], vertices: usize) -> Result<u32, String> {
    let text = String::from_utf8_lossy(word);
    let said: i64 = text
        .parse()
        .map_err(|_| format!("{:?} is not the number of a vertex", shortened(&text)))?;
    let index = if said < 0 {
        vertices as i64 + said
    } else {
        said - 1
    };
    match (0..vertices as i64).contains(&index) {
        true => Ok(index as u32),
        false => Err(format!(
            "the face refers to vertex {said}, but there are {vertices} before it"
        )),
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
