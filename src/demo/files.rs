//! Scene files that can be chosen: a list of those seen and those beside them.

use crate::scene::BUILTIN_NAMES;
use std::path::Path;

/// Files that are listed at most.
const LISTED: usize = 100;
/// Entries of a folder that are looked at for scene files at most: a scene may lie in a
/// folder of anything.
const LOOKED_AT: usize = 4096;

/// Scene files that can be chosen: those seen in this run, and those that lie beside them.
#[derive(Debug, Default)]
pub struct Files {
    seen: Vec<String>,
    all: Vec<String>,
}

impl Files {
    /// A scene was opened or saved: a built-in one is no file.
    pub fn add(&mut self, name: &str) {
        if BUILTIN_NAMES.contains(&name) {
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

    /// All of them: those seen first, in the order in which they were.
    pub fn all(&self) -> &[String] {
        &self.all
    }

    /// Those seen in this run.
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

/// Whether a file's name ends so, in capitals or not.
pub fn is_of(file: &Path, ending: &str) -> bool {
    file.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects a scene given as a file from being lost once another was chosen: it stays in the list, first, and
    /// the scene files beside it follow.
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
