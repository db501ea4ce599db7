//! CPU references for the true path of a wave. They share no code with the shaders, and so cannot share their mistakes.
//!
//! # Theory
//! Sound is modelled as rays (geometrical acoustics: Kuttruff, *Room Acoustics*, chapter 4). A wave
//! flies straight through the air, is mirrored at a surface, d′ = d − 2 (d·n) n, and stops at the
//! listener's sphere. One *iteration* is one flight to the next object, so a wave that is heard in
//! iteration n has been mirrored n − 1 times: its *order*.
//!
//! - [`ExactScene`] solves each flight in closed form in `f64`: a line against a plane, the slabs
//!   of a box (Kay & Kajiya 1986), a sphere or a cylinder (the discriminant from the line's
//!   distance to the centre, which does not cancel: Haines et al., *Ray Tracing Gems*, 2019,
//!   chapter 7). None of these is marched, so they need neither a minimum distance nor a start
//!   offset. A field is marched: by plain steps of its value divided by its Lipschitz constant,
//!   down to 10⁻¹² of its extent, and no farther than the nearest hit in closed form.
//! - `ShoeboxImages` supports only an empty rectangular room and mirrors the listener instead of
//!   the wave (Allen & Berkley, *Image method for efficiently simulating small-room acoustics*,
//!   JASA 65, 1979): in the unfolded room the wave is one straight line. It shares no code with
//!   [`ExactScene`], and a test compares the two for each wave.
//! - [`ShoeboxEnergies`] mirrors the source of such a room instead, and sums the energies of its
//!   images: the expected values of an echogram, and of the figures derived from it.
//! - The crate's own tests have a third reference, the thesis' algorithm itself in `f32` (`tests/march32.rs`): it tests
//!   whether a shader follows the algorithm, not whether the algorithm is right.
//!
//! # Deviations from the thesis
//! Sjöberg (2011) marches each flight in `f32` and stops up to 0.1 short of the surface; here every flight ends on the
//! surface. The thesis does not compare with a reference.
//!
//! # Accuracy and cost
//! Scene values are converted from `f32` exactly and rotations are normalised. A flight is accurate to about 10⁻¹⁵ of
//! the scene's extent. Flat surfaces keep that error; every reflection at a curved surface multiplies it by about 2 ×
//! flight ÷ radius, which [`ExactWave::curved_hits`] counts. A flight costs about fifty nanoseconds for each basic
//! shape, about ten evaluations for a field that it passes, and a hundred for a field that it hits; tracing does not
//! allocate memory for a wave.

mod closed_form;
mod exact;
mod hierarchy;
mod image_source;
mod marched;
mod shoebox_energies;
#[cfg(test)]
pub(crate) mod tests;

pub use exact::{ExactScene, ExactWave, Hit};
#[doc(hidden)]
pub use exact::{PathVertex, sequence_hash};
#[doc(hidden)]
pub use image_source::ShoeboxImages;
#[doc(hidden)]
pub use shoebox_energies::EnergiesByLength;
pub use shoebox_energies::{ImageSource, ShoeboxEnergies};
