//! Frames: contexts, panning, options, pictures, and accuracy.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod asynchronous_frames;
mod curved_responses;
mod gpu_contexts;
mod heard_paths;
mod options;
mod panning;
mod pictures;
mod responses;
mod rooms_that_scatter;
mod thesis_tables;
