//! Reloads the scene file when it changes.

use super::app::{App, Stage};
use super::error::sentence;
use super::follower::{Before, Follower, PROGRAMS};
use super::report::Reread;
use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Opening, Tracer};
use std::time::{Duration, Instant};

/// Interval between two checks of the files.
const BETWEEN_LOOKS: Duration = Duration::from_millis(100);

impl App {
    /// Checks the scene with which the window opens, and watches the scene's file if there is one. Waits for the trial
    /// of the scene's users' fields, because there is no other scene to show meanwhile.
    pub fn follow_first(&mut self, tracer: &mut Tracer) -> Result<(), Error> {
        let (name, settings) = (&self.world.name, &self.choices.settings);
        if !Scene::BUILTIN_NAMES.contains(&name.as_str()) {
            let mut opening = Opening::begin(name, settings, &PROGRAMS)?;
            opening.wait()?;
            self.world.change(opening.scene().clone())?;
            self.follower = Some(Follower::of(opening.follow()));
        }
        tracer.check(&self.world.base, settings)
    }

    /// The name of a chosen scene whose users' fields are being tried.
    pub fn tried_scene(&self) -> Option<&str> {
        let coming = self.coming.as_ref().filter(|coming| coming.is_tried())?;
        Some(&coming.world.name)
    }

    /// The message shown in the window during the trial.
    pub fn trying(&self) -> Option<String> {
        let (name, before) = (self.tried_scene()?, &self.world.name);
        Some(format!(
            "{name} is being tried; {before} is shown until then"
        ))
    }

    /// Applies changes of the scene's files. After an error, the last valid scene stays, and the reason is reported.
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
            Ok(false) => (),
            Ok(true) => {
                follower.refused = None;
                // Drawing the picture may fail even if tracing the waves succeeds.
                self.previous = Some(Before {
                    world: self.world.clone(),
                    other: None,
                });
                let scene = follower.reloading.scene().clone();
                if let Err(error) = self.world.change(scene) {
                    return self.refuse(sentence(&error));
                }
                self.paths.forget();
                self.begins_anew = true;
                self.measure_again();
                self.has_reread(None);
            }
            Err(error) => self.refuse(sentence(&error)),
        }
    }

    /// Records and reports the reason why the current contents of the files cannot be used.
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

    /// The message shown in the window while the files cannot be used.
    pub fn refusal(&self) -> Option<&str> {
        self.follower.as_ref()?.refused.as_deref()
    }
}
