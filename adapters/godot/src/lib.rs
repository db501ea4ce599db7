//! A [Godot 4](https://godotengine.org) extension for [`echomarch::simulator`]: nodes whose sound is traced through the
//! surfaces of other nodes.
//!
//! [`nodes`] has the classes that Godot sees. [`Acoustics`] has all that needs no engine.

mod acoustics;
pub mod nodes;

pub use acoustics::{Acoustics, NodeId, pose};

use godot::init::{ExtensionLibrary, gdextension};

struct Echomarch;

// SAFETY: the crate has no other entry, and no requirements beyond those of the godot crate.
#[gdextension]
unsafe impl ExtensionLibrary for Echomarch {}
