//! Contexts, textures and passes, without acoustics.

mod contexts;
pub mod foreign_program;
mod foreign_state;
mod passes;
pub mod raw_egl;
