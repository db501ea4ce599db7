//! One table of shapes and operators, walked by tests of all that is promised of them: here on the
//! CPU, in `kernel/tests` as shaders, in `trace/tests` as waves.

mod bad;
mod edges;
pub mod promises;
pub mod table;
mod turning;
