//! The shader programs of a frame, compiled once for each structure of scene.

use super::Profile;
use crate::error::Error;
use crate::gpu::{Context, Program};
use crate::scene::Scene;
use crate::scene::glsl::{self, Structure, source};
use std::collections::HashMap;
use std::rc::Rc;

/// Programs by what their text depends on.
pub(super) struct Programs {
    pub initialise: Program,
    pub pan: Program,
    march: HashMap<(Structure, Profile), Rc<Program>>,
    compiled: usize,
}

impl Programs {
    pub fn new(context: &Context) -> Result<Programs, Error> {
        let initialise = glsl::join(&[
            source!("wave.glsl"),
            source!("direction/random.glsl"),
            source!("initialise.frag"),
        ]);
        let pan = glsl::join(&[source!("wave.glsl"), source!("pan.frag")]);
        Ok(Programs {
            initialise: Program::fragment(context, "initialise", &initialise)?,
            pan: Program::fragment(context, "pan", &pan)?,
            march: HashMap::new(),
            compiled: 2,
        })
    }

    /// Programs compiled so far.
    pub fn compiled(&self) -> usize {
        self.compiled
    }

    /// The march pass of a scene's structure, compiled the first time.
    pub fn march(
        &mut self,
        context: &Context,
        scene: &Scene,
        profile: Profile,
    ) -> Result<Rc<Program>, Error> {
        let key = (glsl::structure(scene), profile);
        if let Some(program) = self.march.get(&key) {
            return Ok(program.clone());
        }
        let label = format!("march ({profile}) of {}", scene.name);
        let program = Program::fragment(context, &label, &march_text(scene, profile))?;
        self.compiled += 1;
        let program = Rc::new(program);
        self.march.insert(key, program.clone());
        Ok(program)
    }
}

/// The fragment shader of one iteration, `#version` apart.
fn march_text(scene: &Scene, profile: Profile) -> String {
    let mut sources = vec![source!("wave.glsl")];
    sources.extend(glsl::distance_sources(scene));
    sources.push(match profile {
        Profile::Thesis => source!("march_thesis.frag"),
    });
    glsl::join(&sources)
}
