//! Reads a mesh file by the format that its extension names.

use super::{MeshError, MeshFaces};
#[cfg(not(feature = "meshes"))]
use crate::{file_input::InputError, platform};
use std::path::Path;

/// Maximum size of a mesh file in bytes. A text of two million triangles takes about 200 MB.
#[cfg(feature = "meshes")]
pub(super) const LARGEST_FILE: u64 = 512 << 20;

/// The faces in a file.
///
/// # Errors
/// [`MeshError`] for a file of another format, and for a file that cannot be read.
#[cfg(feature = "meshes")]
pub(super) fn faces(path: &Path) -> Result<MeshFaces, MeshError> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("obj") => super::read_obj::faces(&contents(path)?),
        Some("glb" | "gltf") => super::read_gltf::faces(&contents(path)?, path.parent()),
        _ => Err(MeshError::UnknownFormat),
    }
}

/// The bytes of a file.
#[cfg(feature = "meshes")]
pub(super) fn contents(path: &Path) -> Result<Vec<u8>, MeshError> {
    let read = crate::file_input::read(path, LARGEST_FILE);
    read.map_err(|error| MeshError::Unreadable {
        why: error.to_string(),
    })
}

/// Without the readers no file is read.
///
/// # Errors
/// [`MeshError::NoReaders`], or [`MeshError::Unreadable`] in a browser.
#[cfg(not(feature = "meshes"))]
pub(super) fn faces(_: &Path) -> Result<MeshFaces, MeshError> {
    Err(match platform::HAS_FILES {
        true => MeshError::NoReaders,
        false => MeshError::Unreadable {
            why: InputError::NoFiles.to_string(),
        },
    })
}
