//! Helpers for the program's tests, including those of the library's tests.
#![allow(dead_code, unused_imports)] // Each test file uses only some of these.

pub mod cli;
#[cfg(feature = "demo")]
pub mod drop;
#[path = "../../../../../tests/common/mod.rs"]
mod library;
#[path = "../../../../lab/tests/common/shard.rs"]
pub mod shard;
#[cfg(feature = "demo")]
pub mod window;

pub use library::*;
