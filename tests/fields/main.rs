//! Fields: one table of shapes and operators, walked by tests of all that is promised of them.

#[path = "../common/mod.rs"]
mod common;

mod bad;
mod promises;
mod shaders;
mod table;
mod turning;
mod waves;
