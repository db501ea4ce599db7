//! Contexts, textures and passes, without acoustics.

mod contexts;
pub mod foreign_program;
mod passes;
pub mod raw_egl;
