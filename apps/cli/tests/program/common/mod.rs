//! Helpers of the program's tests, with those of the library's.
#![allow(dead_code, unused_imports)] // Every test file uses its own part of this.

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
