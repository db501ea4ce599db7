//! References on the CPU: what a wave truly does. They share no code with the shaders, so that
//! they cannot share their mistakes.
//!
//! # Theory
//! Sound is taken as rays (geometrical acoustics: Kuttruff, *Room Acoustics*,
//! chapter 4). A wave flies straight on through the air, is mirrored at a surface,
//! d′ = d − 2 (d·n) n, and stops at the listener's sphere. One *iteration* is one
//! flight to the next object, so a wave that is heard in iteration n has been
//! mirrored n − 1 times: its *order*.
//!
//! - [`ExactScene`] solves each flight in closed form in `f64`: a line against a
//!   plane, the slabs of a box (Kay & Kajiya 1986), a sphere or a cylinder (the
//!   discriminant from the line's distance to the centre, which does not cancel:
//!   Haines et al., *Ray Tracing Gems*, 2019, chapter 7). None of these is marched, so
//!   there is no minimum distance and no start offset. A field is: by plain steps of its
//!   value over its Lipschitz constant, down to 10⁻¹² of its extent, and no farther than
//!   the nearest thing in closed form.
//! - [`ShoeboxImages`] knows an empty rectangular room only and mirrors the
//!   listener instead of the wave (Allen & Berkley, *Image method for efficiently
//!   simulating small-room acoustics*, JASA 65, 1979): in the unfolded room the
//!   wave is one straight line. It shares no code with [`ExactScene`], and a test
//!   compares the two wave for wave.
//! - [`ShoeboxEnergies`] mirrors the source of such a room instead, and sums the energies of its
//!   images: what an echogram, and the figures read off it, ought to be.
//! - The crate's own tests have a third, the thesis' algorithm itself in `f32` (`march32.rs`): it
//!   tests whether a shader computes what it should, not whether that is right.
//!
//! # Deviations from the thesis
//! Sjöberg (2011) marches each flight in `f32` and stops up to 0.1 short of the
//! surface; here every wave ends on it. The thesis has no reference to compare with.
//!
//! # Accuracy and cost
//! Scene values are widened from `f32` exactly and rotations are made unit again.
//! A flight is right to about 10⁻¹⁵ of the scene's extent. Flat surfaces keep that
//! error; every reflection at a curved one multiplies it by some 2 × flight ÷ radius,
//! hence [`ExactWave::curved_hits`]. A flight costs some fifty nanoseconds for each
//! basic shape, and some ten evaluations for a field that it passes, a hundred for one
//! that it meets; tracing allocates nothing for a wave.

mod closed_form;
#[cfg(test)]
mod distance32;
mod exact;
mod hierarchy;
mod image_source;
#[cfg(test)]
pub(crate) mod march32;
mod marched;
mod shoebox_energies;
#[cfg(test)]
mod tests;
mod transparent;

pub use exact::{ExactScene, ExactWave, Hit};
#[cfg(feature = "experiment")]
pub(crate) use exact::{PathVertex, sequence_hash};
pub use image_source::ShoeboxImages;
pub use shoebox_energies::{EnergiesByLength, ImageSource, ShoeboxEnergies};
