//! The experiments, held against closed forms and the thesis' tables.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod accuracy;
mod hard_cases;
mod thesis_tables;
