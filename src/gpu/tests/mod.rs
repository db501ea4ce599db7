//! Contexts, textures and passes, without acoustics.

mod contexts;
mod passes;
pub mod raw_egl;
