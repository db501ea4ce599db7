//! Scene files to choose from: those opened or saved in this run, and those in the same folders.

use echomarch::scene::Scene;
use std::path::Path;

/// Maximum number of files listed.
const LISTED: usize = 100;
/// Maximum number of a folder's entries that are searched for scene files: the folder may contain many other files.
const LOOKED_AT: usize = 4096;

/// Scene files to choose from: those opened or saved in this run, and those in the same folders.
#[derive(Debug, Default)]
pub struct Files {
    seen: Vec<String>,
    all: Vec<String>,
}

impl Files {
    /// Adds a scene that was opened or saved; a built-in one is not a file.
    pub fn add(&mut self, name: &str) {
        if Scene::BUILTIN_NAMES.contains(&name) {
            return;
        }
        if !self.seen.iter().any(|known| known == name) {
            self.seen.push(name.to_owned());
        }
        self.all = self.seen.clone();
        for folder in self.seen.iter().filter_map(|file| Path::new(file).parent()) {
            for file in scene_files(folder) {
                if self.all.len() < LISTED && !self.all.contains(&file) {
                    self.all.push(file);
                }
            }
        }
    }

    /// All files, beginning with those of this run in the order in which they were added.
    pub fn all(&self) -> &[String] {
        &self.all
    }

    /// The files opened or saved in this run.
    pub fn seen(&self) -> &[String] {
        &self.seen
    }
}

/// The scene files in a folder, by name.
fn scene_files(folder: &Path) -> Vec<String> {
    let shown = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let Ok(entries) = std::fs::read_dir(shown) else {
        return Vec::new();
    };
    let names = entries.take(LOOKED_AT).flatten();
    let mut files: Vec<String> = names
        .map(|entry| folder.join(entry.file_name()))
        .filter(|path| is_of(path, "ron") && path.is_file())
        .filter_map(|path| path.to_str().map(str::to_owned))
        .collect();
    files.sort();
    files
}

/// Whether a file's name has this ending, in upper or lower case.
pub fn is_of(file: &Path, ending: &str) -> bool {
    file.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects a scene file from being lost after another scene was chosen: it stays first in the list, before the
    /// scene files beside it.
    #[test]
    fn files_seen_stay_in_the_list() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        for name in ["b.ron", "a.ron", "notes.txt", "c.RON"] {
            std::fs::write(path(name), "").unwrap();
        }
        std::fs::create_dir(path("folder.ron")).unwrap();
        let mut files = Files::default();
        files.add("corner");
        assert!(files.all().is_empty());
        files.add(&path("b.ron"));
        files.add("cave");
        files.add(&path("b.ron"));
        assert_eq!(files.all(), [path("b.ron"), path("a.ron"), path("c.RON")]);
        assert_eq!(files.seen(), [path("b.ron")]);
        files.add("/nowhere/x.ron");
        assert_eq!(files.all()[..2], [path("b.ron"), "/nowhere/x.ron".into()]);
    }
}
