//! Frames and the text of passes, where a test needs what callers do not have.

mod arrivals;
mod arrivals_energy;
mod caller_contexts;
mod field_waves;
mod foreign_contexts;
mod gpu_against_cpu;
mod loop_budget;
mod shader_text;
