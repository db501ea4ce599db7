//! The CPU truths.

pub mod march32;
