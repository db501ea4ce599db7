//! The hash of a study. The hash covers everything that determines the results, except the program and the renderer.

use super::Study;
use super::file::{StudyFile, scene_file};
use echomarch::internals::file_input::{InputError, read};
use echomarch::scene::{Scene, bases_of};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// The prefix of the hashed data. The prefix must change if points are numbered or computed differently.
const KIND: &str = "echomarch study 1";

/// Maximum size of a scene file, in bytes. The scene was loaded earlier with a lower limit.
const LARGEST_FILE: u64 = 64 << 20;

/// Returns the hash as hexadecimal digits. The hash covers, in this order, the study's canonical text (with all
/// defaults, without layout) and, for each scene, its file, its base scenes, and the contents of the files that they
/// name. Each part is preceded by its length, so that different parts cannot give the same data.
pub(super) fn of(
    file: &StudyFile,
    study: &Study,
    folder: &Path,
) -> Result<String, (PathBuf, InputError)> {
    let mut hash = Sha256::new();
    let mut add = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    add(KIND.as_bytes());
    add(&canonical(file));
    for (said, axis) in file.scenes.iter().zip(&study.variants) {
        match scene_file(&said.of, folder) {
            None => add(Scene::builtin_text(&said.of).unwrap_or("").as_bytes()),
            Some(own) => {
                for path in std::iter::once(own.clone()).chain(bases_of(&own)) {
                    match read(&path, LARGEST_FILE) {
                        Ok(bytes) => add(&bytes),
                        Err(error) => return Err((path, error)),
                    }
                }
            }
        }
        axis.scene.file_contents().iter().for_each(|it| add(it));
    }
    Ok(hex(&hash.finalize()))
}

/// The study as JSON. The fields are in the order of their types, and numbers have their shortest form. The folders of
/// the scenes are excluded. The names of the scenes are included, because the rows contain them.
fn canonical(file: &StudyFile) -> Vec<u8> {
    let mut file = file.clone();
    for scene in &mut file.scenes {
        let name = Path::new(&scene.of).file_name();
        scene.of = name.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    }
    // Plain fields, lists and maps can always be serialised.
    serde_json::to_vec(&file).unwrap_or_default()
}

/// The bytes as hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
