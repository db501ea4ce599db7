//! CPU references for the exact path of a wave. They share no code with the shaders, so they do not share errors of the
//! shaders.
//!
//! # Theory
//! Sound is modelled as rays (geometrical acoustics: Kuttruff, *Room Acoustics*, chapter 4). A wave travels in a
//! straight line through the air, is reflected by a surface, d′ = d − 2 (d·n) n, and stops at the listener's sphere.
//! One *iteration* is one flight to the next object. A wave that is heard in iteration n has been reflected n − 1
//! times; this number is its *order*.
//!
//! - [`ExactScene`] solves each flight in closed form in `f64`: the intersection of a line with a plane, with the slabs
//!   of a box (Kay & Kajiya 1986), with a sphere or with a cylinder. The discriminant of spheres and cylinders is
//!   computed from the line's distance to the centre, which avoids cancellation (Haines et al., *Ray Tracing Gems*,
//!   2019, chapter 7). These intersections need neither a minimum distance nor a start offset. A field is marched with
//!   steps of its value divided by its Lipschitz constant, until the value is 10⁻¹² of its extent. The march goes no
//!   farther than the nearest hit in closed form.
//! - `ShoeboxImages` supports only an empty rectangular room. It mirrors the listener instead of the wave (Allen &
//!   Berkley, *Image method for efficiently simulating small-room acoustics*, JASA 65, 1979), so that the wave is one
//!   straight line in the unfolded room. It shares no code with [`ExactScene`], and a test compares both for each wave.
//! - [`ShoeboxEnergies`] mirrors the source of such a room instead, and sums the energies of the images. The sums are
//!   the expected values of an echogram, and of the acoustic parameters derived from it.
//! - The crate's own tests have a third reference, the thesis' algorithm in `f32` (`tests/march32.rs`). It tests
//!   whether a shader implements the algorithm, not whether the algorithm is correct.
//!
//! # Deviations from the thesis
//! Sjöberg (2011) marches each flight in `f32` and stops up to 0.1 short of the surface. Here, every flight ends on the
//! surface. The thesis contains no comparison with a reference.
//!
//! # Accuracy and cost
//! Scene values are converted from `f32` exactly, and rotations are normalised. The error of a flight is about 10⁻¹⁵ of
//! the scene's extent. Reflections by flat surfaces preserve this error. Each reflection by a curved surface multiplies
//! it by about 2 × flight ÷ radius; [`ExactWave::curved_hits`] counts these reflections. A flight costs about fifty
//! nanoseconds for each basic shape, about ten evaluations for each field that it passes, and about a hundred
//! evaluations for a field that it hits. Tracing a wave allocates no memory.

mod chords;
mod closed_form;
mod distances;
#[cfg(any(test, feature = "reference"))]
mod ear;
mod exact;
mod false_position;
mod hierarchy;
mod hollow;
mod in_front;
mod intersection;
mod marched;
mod obstacles;
mod placed_mesh;
#[cfg(any(test, feature = "reference"))]
mod reference;
mod sight;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use chords::{Chord, SolidsAhead};
pub use exact::ExactScene;
#[cfg(any(test, feature = "reference"))]
pub use exact::Hit;
#[cfg(any(test, feature = "reference"))]
pub use reference::*;

/// Maximum length of the difference between unit normals of one plane face: rotations are rounded to `f32`, and several
/// of them add their errors of about 10⁻⁷.
pub(crate) const SAME_NORMAL: f64 = 1e-6;
