//! The choice of the scene from the built-in scenes and files, and the scene's named values.

use super::app::App;
use super::error::sentence;
use super::files::is_of;
use super::follower::{Before, Coming};
use echomarch::Error;
use echomarch::scene::Scene;
use std::path::Path;

impl App {
    /// Moves by `steps` in the list of built-in scenes and of files seen in this run.
    pub fn next_scene(&mut self, steps: i32) {
        let built_in = Scene::BUILTIN_NAMES.iter().map(|name| (*name).to_owned());
        let all: Vec<String> = built_in.chain(self.files.seen().iter().cloned()).collect();
        let from = self.coming.as_ref().map(|coming| &coming.world);
        let from = &from.unwrap_or(&self.world).name;
        let place = all.iter().position(|name| name == from);
        let place = place.map_or(0, |place| place as i32 + steps);
        // The list has at most a few dozen names.
        let next = place.rem_euclid(all.len() as i32) as usize;
        self.change_scene(&all[next]);
    }

    /// Opens a file that was dropped on the window. The file is either a scene or a sound.
    pub fn open_file(&mut self, file: &Path) {
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

    /// Opens another scene after its users' fields were tried. If the shaders of the scene do not compile, the window
    /// returns to the previous scene.
    pub fn change_scene(&mut self, name: &str) {
        let mut coming = match Coming::begin(name, &self.choices.settings) {
            Ok(coming) => coming,
            Err(Error::Scene(error)) => {
                self.tell(sentence(&error));
                return;
            }
            Err(error) => {
                self.files.add(name);
                self.tell(format!("{name}: {}", sentence(&error)));
                return;
            }
        };
        self.files.add(name);
        let world = &mut coming.world;
        for (value_name, value) in &self.options.values {
            if world.sliders.iter().any(|known| known.name == *value_name)
                && let Err(error) = world.set(value_name, *value)
            {
                coming.told = sentence(&error);
            }
        }
        self.coming = Some(coming);
        if let Some(trying) = self.trying() {
            self.tell(trying);
        }
    }

    /// Switches to the chosen scene.
    pub fn arrive(&mut self, coming: Coming) {
        let told = coming.told.clone();
        let (mut world, follower) = coming.arrive();
        world.paused = self.world.paused;
        let world = std::mem::replace(&mut self.world, world);
        let follower = std::mem::replace(&mut self.follower, follower);
        // A scene that has not been drawn yet may still fail, so the previous scene is kept.
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
        self.tell(told);
    }

    /// Clears all state that belongs to the previous scene.
    pub fn is_another_world(&mut self) {
        self.paths.forget();
        self.heard = None;
        self.begins_anew = true;
        self.scale_control.forget();
        self.measure_again();
    }

    /// Sets a named value. A value that the scene rejects has no effect.
    pub fn set(&mut self, name: &str, value: f32) {
        if let Err(error) = self.world.set(name, value) {
            self.say(sentence(&error));
        }
    }

    /// Shows a message in the window for a few seconds, and prints it on the terminal.
    pub fn tell(&mut self, text: String) {
        (self.options.announce)(&text);
        self.say(text);
    }
}
