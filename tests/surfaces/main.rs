//! Tests of scene files, shapes and operators, and of waves at hard surfaces.

#[path = "../common/mod.rs"]
mod common;

mod cells;
mod endless_repeats;
mod implicit_scenes;
mod marched_fields;
mod meshes;
mod points_on_surfaces;
mod properties;
mod rooms;
mod scene_format;
mod touching_boxes;
mod user_fields;
