//! Reads a scene file again when it, or a file that it names, has changed.

use super::file::bases_of;
use super::{BUILTIN_NAMES, Scene, SceneError};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Time of a file's last write and its length in bytes; `None` while the file does not exist.
type Stamp = Option<(SystemTime, u64)>;

/// A scene file, its bases, and the files that they name, watched for changes.
///
/// Does not use OpenGL: see [`trace::Reloading`](crate::trace::Reloading) for scenes that are also
/// checked by the renderer. Polling takes a few microseconds a file.
pub struct SceneWatch {
    load: Box<dyn Fn() -> Result<Scene, SceneError>>,
    /// The scene file; `None` for a built-in scene.
    own: Option<PathBuf>,
    /// State of the files when last read.
    read: Vec<(PathBuf, Stamp)>,
    /// State found by the last poll, if it differs from `read`.
    found: Option<Vec<Stamp>>,
    /// Message of the last error, until a scene is read.
    refused: Option<String>,
}

impl SceneWatch {
    /// Reads a scene as [`Scene::load`] does, and watches it from now on.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn open(name_or_file: &str) -> Result<(SceneWatch, Scene), SceneError> {
        let name = name_or_file.to_owned();
        SceneWatch::open_with(name_or_file, move || Scene::load(&name))
    }

    /// Watches a scene file that is read by `load`, for scenes that are changed after reading.
    ///
    /// # Errors
    /// The errors of `load`.
    pub fn open_with(
        name_or_file: &str,
        load: impl Fn() -> Result<Scene, SceneError> + 'static,
    ) -> Result<(SceneWatch, Scene), SceneError> {
        let built_in = BUILTIN_NAMES.contains(&name_or_file);
        let own = (!built_in).then(|| PathBuf::from(name_or_file));
        let mut watch = SceneWatch {
            load: Box::new(load),
            read: own.iter().map(|path| (path.clone(), stamp(path))).collect(),
            own,
            found: None,
            refused: None,
        };
        let scene = (watch.load)()?;
        watch.keep(scene.files());
        Ok((watch, scene))
    }

    /// The watched files, the scene's own first; empty for a built-in scene.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.read.iter().map(|(path, _)| path.as_path())
    }

    /// Returns the scene, or the error of reading it, once after each change; otherwise `None`.
    ///
    /// A change counts when two polls in a row find the same state: an editor may still be writing.
    /// After an error the scene file's folder is watched too, in case a missing file appears.
    pub fn poll(&mut self) -> Option<Result<Scene, SceneError>> {
        let now: Vec<Stamp> = self.read.iter().map(|(path, _)| stamp(path)).collect();
        if self.read.iter().map(|(_, stamp)| stamp).eq(&now) {
            self.found = None;
            return None;
        }
        if self.found.as_ref() != Some(&now) {
            self.found = Some(now);
            return None;
        }
        self.found = None;
        for ((_, read), now) in self.read.iter_mut().zip(now) {
            *read = now;
        }
        match (self.load)() {
            Ok(scene) => {
                self.refused = None;
                self.keep(scene.files());
                Some(Ok(scene))
            }
            Err(error) => {
                let sentence = error.to_string();
                let folders: Vec<PathBuf> = self.own.iter().map(|own| folder(own)).collect();
                let known = self.files().map(Path::to_owned).collect::<Vec<_>>();
                self.keep([known, folders].concat());
                // Another file may have appeared or vanished in the folder.
                let is_news = self.refused.as_ref() != Some(&sentence);
                self.refused = Some(sentence);
                is_news.then_some(Err(error))
            }
        }
    }

    /// Watches the scene's own file, its bases and `files`; keeps the recorded state of files
    /// already watched.
    fn keep(&mut self, files: Vec<PathBuf>) {
        let Some(own) = self.own.clone() else {
            return;
        };
        let before = std::mem::take(&mut self.read);
        let bases = bases_of(&own);
        for path in std::iter::once(own).chain(bases).chain(files) {
            if self.read.iter().any(|(known, _)| *known == path) {
                continue;
            }
            let known = before.iter().find(|(known, _)| *known == path);
            let read = known.map_or_else(|| stamp(&path), |(_, stamp)| *stamp);
            self.read.push((path, read));
        }
    }
}

fn stamp(path: &Path) -> Stamp {
    let about = std::fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

fn folder(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "Scene(surfaces: [Surface(shape: Plane)],
        source: Source(position: (0, 1, 0)), listener: Listener(position: (0, 2, 5), radius: 1))";

    /// The result of the next polls.
    fn settled(watch: &mut SceneWatch) -> Option<Result<Scene, SceneError>> {
        (0..3).find_map(|_| watch.poll())
    }

    /// Protects a running program from half-written and broken files: each change is reported
    /// once, errors too.
    #[test]
    fn each_change_is_told_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("s.ron");
        std::fs::write(&file, SCENE).unwrap();
        let (mut watch, first) = SceneWatch::open(file.to_str().unwrap()).unwrap();
        assert!(settled(&mut watch).is_none());
        std::fs::write(&file, SCENE.replace("radius: 1", "radius: 1.5")).unwrap();
        assert!(watch.poll().is_none(), "it may still be written");
        let second = settled(&mut watch).unwrap().unwrap();
        assert!(second != first && settled(&mut watch).is_none());
        std::fs::write(&file, "Scene(").unwrap();
        assert!(settled(&mut watch).unwrap().is_err());
        std::fs::write(folder.path().join("other"), "").unwrap();
        assert!(settled(&mut watch).is_none());
        std::fs::remove_file(&file).unwrap();
        assert!(settled(&mut watch).unwrap().is_err());
        std::fs::write(&file, SCENE).unwrap();
        assert_eq!(settled(&mut watch).unwrap().unwrap(), first);
    }
}
