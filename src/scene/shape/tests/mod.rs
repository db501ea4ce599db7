//! A table of shapes and operators, used by tests of all their properties: here on the CPU, in
//! `kernel/tests` as shaders, in `trace/tests` with waves.

mod bad;
mod edges;
pub mod promises;
pub mod table;
mod turning;
