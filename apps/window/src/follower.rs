//! Watches the scene's file. Keeps the previous scene and the next one while the users' fields of the next scene are
//! tried.

use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Opening, Pass, Profile, Reloading, Settings, shader_text};
use echomarch_walk::World;
use std::time::Instant;

/// The shader programs that a scene needs: one for the picture, and one for each profile that a key can choose.
pub const PROGRAMS: [fn(&Scene) -> String; 4] = [
    echomarch::picture::view_text,
    |scene| march_text(scene, Profile::Hybrid),
    |scene| march_text(scene, Profile::March),
    |scene| march_text(scene, Profile::Thesis),
];

fn march_text(scene: &Scene, profile: Profile) -> String {
    shader_text(scene, &Settings::new(profile), Pass::March)
}

/// Watches the scene's file and the files that it names.
pub struct Follower {
    pub reloading: Reloading,
    pub looked: Instant,
    /// The reason why the current contents of the files cannot be used.
    pub refused: Option<String>,
}

impl Follower {
    /// Starts to watch the file of a scene that was opened.
    pub fn of(reloading: Reloading) -> Follower {
        Follower {
            reloading,
            looked: Instant::now(),
            refused: None,
        }
    }
}

/// The previous scene.
pub struct Before {
    /// The state of the scene when another scene replaced it.
    pub world: World,
    /// The follower of the previous scene if that scene had another file; `None` if the same file was changed.
    pub other: Option<Option<Follower>>,
}

/// A chosen scene whose users' fields are being tried. Dropping it ends the trial.
pub struct Coming {
    pub world: World,
    /// The message to show when the scene opens.
    pub told: String,
    /// `None` for a built-in scene.
    opening: Option<Opening>,
}

impl Coming {
    /// Reads a scene, and starts the trial of its users' fields.
    ///
    /// # Errors
    /// The errors of [`Opening::begin`].
    pub fn begin(name: &str, settings: &Settings) -> Result<Coming, Error> {
        let (world, opening) = if Scene::BUILTIN_NAMES.contains(&name) {
            (World::load(name)?, None)
        } else {
            let opening = Opening::begin(name, settings, &PROGRAMS)?;
            (World::named(name, opening.scene().clone())?, Some(opening))
        };
        Ok(Coming {
            world,
            told: format!("scene {name}"),
            opening,
        })
    }

    /// Whether the trial of the scene's users' fields is in progress.
    pub fn is_tried(&self) -> bool {
        self.opening.as_ref().is_some_and(Opening::is_tried)
    }

    /// Whether the fields can be used; `None` until the trial has ended.
    pub fn poll(&mut self) -> Option<Result<(), Error>> {
        match &mut self.opening {
            Some(opening) => opening.poll(),
            None => Some(Ok(())),
        }
    }

    /// Returns the scene, and the follower of its file.
    pub fn arrive(self) -> (World, Option<Follower>) {
        let follower = self.opening.map(|opening| Follower::of(opening.follow()));
        (self.world, follower)
    }
}
