//! Frames: contexts, passes, read-back, panning, options, pictures, and accuracy.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod asynchronous_frames;
mod gpu_against_cpu;
mod gpu_contexts;
mod heard_paths;
mod loop_budget;
mod options;
mod panning;
mod pictures;
mod thesis_tables;
