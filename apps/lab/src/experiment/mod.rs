//! The thesis' experiments, repeated and compared with the thesis' own figures.
//!
//! An experiment uses a [`Tracer`](crate::Tracer), runs its cases in an order that gives them equal conditions, and
//! returns plain data. The other files of an experiment convert this data to a [`Report`](crate::report::Report) and to
//! SVG.

pub mod accuracy;
pub mod cost;
pub mod decay_plot;
pub mod figures;
pub mod localise;
mod plot;
mod thesis_tables;
pub mod verify;

pub use crate::stats::median;
pub use thesis_tables::{THESIS_TABLES, ThesisRow, ThesisTable, WAVE_COUNTS};
