//! A scene file that changes while one walks in it.

use super::app::{App, Stage};
use super::error::sentence;
use super::report::Reread;
use super::scenes::Before;
use crate::scene::{BUILTIN_NAMES, Scene};
use crate::trace::{Pass, Profile, Reload, Reloading, Settings, Tracer, shader_text};
use std::time::{Duration, Instant};

/// From one look at the files to the next.
const BETWEEN_LOOKS: Duration = Duration::from_millis(100);

/// What a scene is drawn and heard by: the picture, and every profile that a key chooses.
const PROGRAMS: [fn(&Scene) -> String; 4] = [
    super::view::shader_text,
    |scene| march_text(scene, Profile::Hybrid),
    |scene| march_text(scene, Profile::March),
    |scene| march_text(scene, Profile::Thesis),
];

fn march_text(scene: &Scene, profile: Profile) -> String {
    shader_text(scene, &Settings::of(profile), Pass::March)
}

/// Follows the scene's file, and the files that it names.
pub struct Follower {
    reloading: Reloading,
    looked: Instant,
    /// Why the files as they are now cannot be taken.
    pub refused: Option<String>,
}

impl App {
    /// Checks a scene that has just come, and follows it if it is a file.
    pub fn follow(&mut self, tracer: &mut Tracer) -> Result<(), crate::Error> {
        let (name, settings) = (&self.world.name, &self.choices.settings);
        if self.question.is_some() || BUILTIN_NAMES.contains(&name.as_str()) {
            return tracer.check(&self.world.base, settings);
        }
        let reloading = Reloading::open(name, tracer, settings)?.trying_too(PROGRAMS)?;
        self.world.change(reloading.scene().clone());
        self.follower = Some(Follower {
            reloading,
            looked: Instant::now(),
            refused: None,
        });
        Ok(())
    }

    /// Takes what has changed in the files; what cannot be traced leaves the last good
    /// scene, and says why.
    pub fn reread(&mut self, stage: &mut Stage) {
        let Some(follower) = self.follower.as_mut() else {
            return;
        };
        if follower.looked.elapsed() < BETWEEN_LOOKS {
            return;
        }
        follower.looked = Instant::now();
        let settings = &self.choices.settings;
        match follower.reloading.poll(&mut stage.tracer, settings) {
            Reload::Unchanged => (),
            Reload::Taken => {
                follower.refused = None;
                // What the waves can be traced in, the picture may still refuse.
                self.previous = Some(Before {
                    world: self.world.clone(),
                    other: None,
                });
                self.world.change(follower.reloading.scene().clone());
                self.paths.forget();
                self.begins_anew = true;
                self.has_reread(None);
            }
            Reload::Kept(error) => self.refuse(sentence(&error)),
        }
    }

    /// The files as they are now cannot be taken.
    pub fn refuse(&mut self, why: String) {
        if let Some(follower) = &mut self.follower {
            follower.refused = Some(why.clone());
            self.has_reread(Some(why));
        }
    }

    fn has_reread(&mut self, error: Option<String>) {
        let told = match &error {
            Some(why) => format!("{why} (the last scene stays)"),
            None => format!("{} is read again", self.world.name),
        };
        self.recorder.reread(Reread {
            seconds: self.seconds(),
            frames: self.recorder.frames,
            error,
        });
        self.tell(told);
    }

    /// What stands in the window while the files cannot be taken.
    pub fn refusal(&self) -> Option<&str> {
        self.follower.as_ref()?.refused.as_deref()
    }
}
