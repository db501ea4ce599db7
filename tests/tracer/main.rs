//! Frames and responses: contexts, panning, options, pictures.

#[path = "../common/mod.rs"]
mod common;

mod asynchronous_frames;
mod curved_responses;
mod directivity;
mod gpu_contexts;
mod least_level;
mod options;
mod pairs;
mod panning;
mod pictures;
mod responses;
mod rooms_that_scatter;
mod serialised;
mod transmission;
