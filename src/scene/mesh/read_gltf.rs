//! glTF 2.0: the triangles of all meshes of the default scene, moved by their nodes. The group of a triangle is the name
//! of its material.
//!
//! Buffers are the binary part of a `.glb` file, base64 in the text, or files in the folder of the `.gltf` file. Other
//! addresses are rejected. Accessors are read here and not by the crate `gltf`, so that each range is checked first.

use super::read::{LARGEST_FILE, contents};
use super::{MOST_TRIANGLES, MeshError, MeshFaces};
use glam::{DMat4, DVec3, Mat4};
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use gltf::{Accessor, Gltf, Node, Primitive, Semantic, buffer};
use std::collections::HashMap;
use std::path::{Component, Path};

/// Maximum depth of nodes. A file whose nodes are their own children has no end.
const DEEPEST: usize = 64;

/// Maximum number of visited nodes. A node can be the child of several nodes.
const MOST_NODES: usize = 100_000;

/// The group of triangles without a named material.
const NO_GROUP: &str = "default";

/// Maximum length of a group's name in characters; longer names are cut.
const LONGEST_NAME: usize = 200;

fn bad(why: impl Into<String>) -> MeshError {
    MeshError::BadContent { why: why.into() }
}

/// Reads the faces of a file in this folder.
///
/// # Errors
/// [`MeshError`] for a file that contradicts its format or exceeds a limit.
pub(super) fn faces(bytes: &[u8], folder: Option<&Path>) -> Result<MeshFaces, MeshError> {
    let Gltf { document, mut blob } =
        Gltf::from_slice(bytes).map_err(|error| bad(format!("it is not valid glTF: {error}")))?;
    let mut buffers = Vec::new();
    let mut left = LARGEST_FILE;
    for of in document.buffers() {
        let stated = of.length() as u64;
        if stated > left {
            return Err(bad(format!(
                "its buffers have more than {LARGEST_FILE} bytes, the limit"
            )));
        }
        left -= stated;
        let content = match of.source() {
            buffer::Source::Bin => blob
                .take()
                .ok_or_else(|| bad("its binary part is missing"))?,
            buffer::Source::Uri(uri) => content_of(uri, folder)?,
        };
        if (content.len() as u64) < stated {
            let found = content.len();
            return Err(bad(format!(
                "a buffer has {found} bytes instead of {stated}"
            )));
        }
        buffers.push(content);
    }
    let mut reader = Reader {
        buffers,
        faces: MeshFaces::default(),
        groups: HashMap::new(),
        visited: 0,
    };
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    let scene = scene.ok_or_else(|| bad("it has no scene"))?;
    for node in scene.nodes() {
        reader.node(&node, DMat4::IDENTITY, 0)?;
    }
    Ok(reader.faces)
}

/// The content of a buffer's address: base64, or the name of a file in the folder.
fn content_of(uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, MeshError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let base64 = data.split_once(";base64,").map(|(_, text)| text);
        let decoded = base64.and_then(from_base64);
        return decoded.ok_or_else(|| bad("a buffer's data are not base64"));
    }
    let path = Path::new(uri);
    let mut parts = path.components();
    let is_name = matches!(parts.next(), Some(Component::Normal(_))) && parts.next().is_none();
    if !is_name || uri.contains([':', '%', '\\']) {
        let uri: String = uri.chars().take(80).collect();
        return Err(bad(format!(
            "the buffer {uri:?} is not a file in the folder of the mesh"
        )));
    }
    contents(&folder.unwrap_or(Path::new("")).join(path))
}

/// The bytes of a base64 text (RFC 4648), which may end in `=`.
fn from_base64(text: &str) -> Option<Vec<u8>> {
    let digits = text.trim_end_matches('=').bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0_u32, 0);
    for digit in digits {
        let value = match digit {
            b'A'..=b'Z' => digit - b'A',
            b'a'..=b'z' => digit - b'a' + 26,
            b'0'..=b'9' => digit - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = (bits << 6) | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    Some(bytes)
}

struct Reader {
    buffers: Vec<Vec<u8>>,
    faces: MeshFaces,
    groups: HashMap<String, u32>,
    visited: usize,
}

impl Reader {
    fn node(&mut self, node: &Node, outer: DMat4, depth: usize) -> Result<(), MeshError> {
        self.visited += 1;
        if depth > DEEPEST {
            return Err(bad(format!(
                "its nodes are nested more than {DEEPEST} deep"
            )));
        }
        if self.visited > MOST_NODES {
            return Err(bad(format!(
                "it has more than {MOST_NODES} nodes, the limit"
            )));
        }
        let own = Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        let to_world = outer * own;
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.primitive(&primitive, to_world)?;
            }
        }
        for child in node.children() {
            self.node(&child, to_world, depth + 1)?;
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive, to_world: DMat4) -> Result<(), MeshError> {
        let mode = primitive.mode();
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            return Ok(());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            return Ok(());
        };
        if positions.data_type() != DataType::F32 || positions.dimensions() != Dimensions::Vec3 {
            return Err(bad("positions must be vectors of three floats"));
        }
        let first = self.faces.vertices.len();
        let count = positions.count();
        if first + count > 3 * MOST_TRIANGLES {
            let most = 3 * MOST_TRIANGLES;
            return Err(MeshError::TooMany {
                what: "vertices",
                most,
            });
        }
        let mut places = Vec::with_capacity(count);
        self.each_item(&positions, |bytes| {
            let number = |at: usize| {
                f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
            };
            let place = DVec3::new(number(0).into(), number(4).into(), number(8).into());
            places.push(to_world.transform_point3(place));
        })?;
        let mut corners: Vec<u32> = Vec::new();
        match primitive.indices() {
            None => corners.extend(0..count as u32),
            Some(indices) => {
                let kind = indices.data_type();
                if !matches!(kind, DataType::U8 | DataType::U16 | DataType::U32) {
                    return Err(bad("indices must be whole numbers"));
                }
                if indices.count() > 3 * MOST_TRIANGLES {
                    let most = MOST_TRIANGLES;
                    return Err(MeshError::TooMany {
                        what: "triangles",
                        most,
                    });
                }
                self.each_item(&indices, |bytes| {
                    let mut whole = [0; 4];
                    whole[..bytes.len()].copy_from_slice(bytes);
                    corners.push(u32::from_le_bytes(whole));
                })?;
            }
        }
        if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
            return Err(bad(format!(
                "a triangle refers to vertex {corner}, but there are {count}"
            )));
        }
        self.faces.vertices.extend(places);
        let group = self.group_of(primitive);
        // A mirrored node reverses the order of the corners.
        let is_mirrored = to_world.determinant() < 0.0;
        for [a, b, c] in triangles(&corners, mode) {
            let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
            self.faces
                .triangles
                .push(corners.map(|corner| first as u32 + corner));
            self.faces.group_of.push(group);
        }
        match self.faces.triangles.len() > MOST_TRIANGLES {
            true => Err(MeshError::TooMany {
                what: "triangles",
                most: MOST_TRIANGLES,
            }),
            false => Ok(()),
        }
    }

    fn group_of(&mut self, primitive: &Primitive) -> u32 {
        let material = primitive.material();
        let name = material.name().unwrap_or(NO_GROUP);
        let name: String = name
            .chars()
            .filter(|c| !c.is_control())
            .take(LONGEST_NAME)
            .collect();
        let groups = &mut self.faces.groups;
        *self.groups.entry(name).or_insert_with_key(|name| {
            groups.push(name.clone());
            groups.len() as u32 - 1
        })
    }

    /// Calls `visit` with the bytes of each item of an accessor.
    fn each_item(&self, of: &Accessor, mut visit: impl FnMut(&[u8])) -> Result<(), MeshError> {
        if of.sparse().is_some() {
            return Err(bad("sparse accessors are not supported"));
        }
        let view = of.view().ok_or_else(|| bad("an accessor has no data"))?;
        let buffer = self.buffers.get(view.buffer().index());
        let end = view.offset().checked_add(view.length());
        let bytes = buffer
            .zip(end)
            .and_then(|(buffer, end)| buffer.get(view.offset()..end))
            .ok_or_else(|| bad("a view of a buffer exceeds the buffer"))?;
        let size = of.size();
        let stride = view.stride().unwrap_or(size);
        for item in 0..of.count() {
            let start = item
                .checked_mul(stride)
                .and_then(|at| at.checked_add(of.offset()));
            let range = start.and_then(|start| Some(start..start.checked_add(size)?));
            let item = range.and_then(|range| bytes.get(range));
            visit(item.ok_or_else(|| bad("an accessor exceeds its view of a buffer"))?);
        }
        Ok(())
    }
}

/// The triangles of a list, a strip or a fan of corners.
fn triangles(corners: &[u32], mode: Mode) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let windows = corners.windows(3).enumerate();
            let triangle = |(index, of): (usize, &[u32])| match index % 2 {
                0 => [of[0], of[1], of[2]],
                _ => [of[0], of[2], of[1]],
            };
            windows.map(triangle).collect()
        }
        Mode::TriangleFan => match corners {
            [first, rest @ ..] => rest.windows(2).map(|of| [*first, of[0], of[1]]).collect(),
            [] => Vec::new(),
        },
        _ => corners.as_chunks().0.to_vec(),
    }
}
