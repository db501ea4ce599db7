//! The notation of scene files below surfaces and shapes: numbers with their units, words, motion
//! of numbers, and the files that a scene names.

mod attached_files;
mod form;
mod moving_numbers;
mod numbers;
mod variant;
mod words;
mod written;

pub(crate) use attached_files::Attached;
pub(crate) use form::Form;
pub(crate) use moving_numbers::{ReadNumbers, Reader};
pub(crate) use numbers::{
    Angle, Degrees, Factor, Finite, FixedRadius, Length, Lipschitz, Metres, Name, Number, Plain,
    Point, Radius, Share, Side, Size, Unit, Vector,
};
pub(crate) use variant::Variant;
pub(crate) use words::{Axis, Corners, MirrorAxes, Sheets};
pub(crate) use written::{Fields, ShapeName, Written};
