//! Which scene is walked in: the built-in ones, files, and their named values.

use super::app::App;
use super::error::sentence;
use super::reload::Follower;
use super::state::World;
use crate::scene::BUILTIN_NAMES;
use std::path::Path;

/// Files that are listed at the most.
const LISTED: usize = 100;
/// Entries of a folder that are looked at for scene files at the most: a scene may lie in a
/// folder of anything.
const LOOKED_AT: usize = 4096;

/// The scene before the one that has just come.
pub struct Before {
    /// As it stood.
    pub world: World,
    /// Its follower, where it was another scene; none where the same file has changed.
    pub other: Option<Option<Follower>>,
}

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

fn is_of(file: &Path, ending: &str) -> bool {
    file.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

impl App {
    /// Another of the built-in scenes and the files seen in this run, so many steps on.
    pub fn next_scene(&mut self, steps: i32) {
        let built_in = BUILTIN_NAMES.iter().map(|name| (*name).to_owned());
        let all: Vec<String> = built_in.chain(self.files.seen().iter().cloned()).collect();
        let place = all.iter().position(|name| *name == self.world.name);
        let place = place.map_or(0, |place| place as i32 + steps);
        // Some dozens of names.
        let next = place.rem_euclid(all.len() as i32) as usize;
        self.change_scene(&all[next]);
    }

    /// Opens a file that was dropped on the window: a scene, or a sound.
    pub fn open_file(&mut self, file: &Path) {
        if self.question.is_some() {
            return;
        }
        match file.to_str() {
            Some(name) if is_of(file, "ron") => self.change_scene(name),
            Some(name) if is_of(file, "wav") => {
                self.act(super::keys::Action::Sound(name.to_owned()));
            }
            _ => self.tell(format!(
                "{:?} is neither a scene (.ron) nor a sound (.wav)",
                file.file_name().unwrap_or_default()
            )),
        }
    }

    /// Goes to another scene. Should it not compile, the one before comes back.
    pub fn change_scene(&mut self, name: &str) {
        let mut world = match World::load(name) {
            Ok(world) => world,
            Err(error) => {
                self.tell(sentence(&error));
                return;
            }
        };
        self.files.add(name);
        world.paused = self.world.paused;
        let asked = self.options.values.clone();
        let mut refused = None;
        for (value_name, value) in &asked {
            if world.sliders.iter().any(|known| known.name == *value_name)
                && let Err(error) = world.set(value_name, *value)
            {
                refused = Some(sentence(&error));
            }
        }
        let world = std::mem::replace(&mut self.world, world);
        let follower = self.follower.take();
        // Of what has not been drawn yet nobody knows whether it can be.
        self.previous = Some(match self.previous.take() {
            None => Before {
                world,
                other: Some(follower),
            },
            Some(before) => Before {
                world: before.world,
                other: Some(before.other.unwrap_or(follower)),
            },
        });
        self.is_another_world();
        self.tell(refused.unwrap_or_else(|| format!("scene {name}")));
    }

    /// What was known of the scene before does not count any more.
    pub fn is_another_world(&mut self) {
        self.paths.forget();
        self.heard = None;
        self.begins_anew = true;
        self.scale_control.forget();
        self.wave_control.forget();
    }

    /// Sets a named value; what the scene does not take leaves it as it was.
    pub fn set(&mut self, name: &str, value: f32) {
        if let Err(error) = self.world.set(name, value) {
            self.say(sentence(&error));
        }
    }

    /// A line that stands in the window for a while, and on the terminal.
    pub fn tell(&mut self, text: String) {
        (self.options.announce)(&text);
        self.say(text);
    }
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
