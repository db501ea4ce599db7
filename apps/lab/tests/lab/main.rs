//! The experiments, compared with closed forms and with the thesis' tables.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod accuracy;
mod hard_cases;
mod thesis_tables;
