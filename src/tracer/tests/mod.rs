//! Tests of frames, and of the texts of passes, that need more than the public interface.

mod arrivals;
mod arrivals_energy;
mod caller_contexts;
mod detectors;
mod field_waves;
mod foreign_contexts;
mod gpu_against_cpu;
mod loop_budget;
mod shader_text;
mod start_order;
