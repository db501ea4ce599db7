//! Fields: one table of shapes and operators, walked by tests of all that is promised of them.

mod bad;
mod promises;
mod shaders;
mod table;
mod turning;
mod waves;
