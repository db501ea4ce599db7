//! Frames, where a test needs what callers do not have.

mod field_waves;
mod foreign_contexts;
