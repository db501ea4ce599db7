//! What the text of each pass depends on.

use super::arrivals_shader::ArrivalsText;
use super::passes::{Directions, MarchText};
use super::structure::{Structure, structure};
use crate::scene::Scene;

/// What the text of a pass depends on: passes of the same key share their programs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Key {
    Initialise(Directions),
    March(Structure, MarchText),
    /// All of them in one.
    WholeFrame(Structure, MarchText, Directions),
    /// Waves through a chunk of iterations, past a transparent listener.
    Arrivals(Structure, ArrivalsText),
    Pan,
    /// The first pass of the sum on the GPU.
    FirstSum,
    /// Its further passes.
    FurtherSum,
}

impl Key {
    /// The key of a scene's march.
    pub fn march(scene: &Scene, text: MarchText) -> Key {
        Key::March(structure(scene, text.algorithm.lists()), text)
    }

    /// The key of a whole frame in one pass.
    pub fn whole_frame(scene: &Scene, text: MarchText, directions: Directions) -> Key {
        Key::WholeFrame(structure(scene, text.algorithm.lists()), text, directions)
    }

    /// The key of the pass that records arrivals.
    pub fn arrivals(scene: &Scene, text: ArrivalsText) -> Key {
        Key::Arrivals(structure(scene, text.algorithm.lists()), text)
    }
}
