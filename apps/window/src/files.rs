//! Scene files that the user can choose: the files opened or saved in this run, and the other scene files in their
//! folders.

use echomarch::scene::Scene;
use std::path::Path;

/// Maximum number of files listed.
const LISTED: usize = 100;
/// Maximum number of folder entries that are searched for scene files: a folder may contain many other files.
const LOOKED_AT: usize = 4096;

/// Scene files that the user can choose: the files opened or saved in this run, and the other scene files in their
/// folders.
#[derive(Debug, Default)]
pub struct Files {
    seen: Vec<String>,
    all: Vec<String>,
}

impl Files {
    /// Adds a scene that was opened or saved. Built-in scenes are ignored, because they are not files.
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

    /// All files. The files of this run come first, in the order in which they were added.
    pub fn all(&self) -> &[String] {
        &self.all
    }

    /// The files opened or saved in this run.
    pub fn seen(&self) -> &[String] {
        &self.seen
    }
}

/// The scene files in a folder, sorted by name.
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

/// Whether the file name has the extension `ending`, in upper or lower case.
pub fn is_of(file: &Path, ending: &str) -> bool {
    file.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects access to an earlier scene file: after another scene was chosen, the file is still first in the list,
    /// before the other files of its folder.
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
