//! Watches the scene's file, and keeps the previous scene and the next one until its users' fields
//! were tried.

use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Opening, Pass, Profile, Reloading, Settings, shader_text};
use echomarch_walk::World;
use std::time::Instant;

/// The programs that a scene needs: that of the picture, and one for every profile that a key
/// chooses.
pub const PROGRAMS: [fn(&Scene) -> String; 4] = [
    echomarch::picture::view_text,
    |scene| march_text(scene, Profile::Hybrid),
    |scene| march_text(scene, Profile::March),
    |scene| march_text(scene, Profile::Thesis),
];

fn march_text(scene: &Scene, profile: Profile) -> String {
    shader_text(scene, &Settings::new(profile), Pass::March)
}

/// Follows the scene's file, and the files that it names.
pub struct Follower {
    pub reloading: Reloading,
    pub looked: Instant,
    /// The reason why the present files cannot be used.
    pub refused: Option<String>,
}

impl Follower {
    /// Follows a scene that is walked in from now on.
    pub fn of(reloading: Reloading) -> Follower {
        Follower {
            reloading,
            looked: Instant::now(),
            refused: None,
        }
    }
}

/// The scene before the present one.
pub struct Before {
    /// Its state when it was left.
    pub world: World,
    /// Its follower, if it was another scene; none if the same file has changed.
    pub other: Option<Option<Follower>>,
}

/// A scene that was chosen, until its users' fields were tried. Dropping it ends the trial.
pub struct Coming {
    pub world: World,
    /// The message shown once the scene is open.
    pub told: String,
    /// None for a built-in scene.
    opening: Option<Opening>,
}

impl Coming {
    /// Reads a scene, and begins to try its users' fields.
    ///
    /// # Errors
    /// As [`Opening::begin`].
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

    /// Whether its fields are being tried.
    pub fn is_tried(&self) -> bool {
        self.opening.as_ref().is_some_and(Opening::is_tried)
    }

    /// Whether the fields can be used, once that is known.
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
