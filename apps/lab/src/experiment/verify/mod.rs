//! The hard cases: scenes that tracing gets wrong first, each with its exact answer.
//!
//! # Method
//! A [`Case`] is a scene and the directions in which waves leave its source: few of them, aimed at the difficulty, or a
//! lattice of thousands. The GPU follows them with every profile and every state of every wave is read back. The judge
//! is [`ExactScene`](crate::geometry::ExactScene), which solves each flight in `f64`, in closed form where possible,
//! and shares no code with the shaders. It cannot read a user's text: for such a case it uses a second scene, in which
//! a tree of the library describes the same surface. Some answers are also *planted* (normal and grazing incidence,
//! edges and vertices of a room, sources in a solid and in the listener): written by hand, and the judge itself is
//! compared with them.
//!
//! # Which answers are right
//! Positions and directions are `f32`, so a start is only known up to a rounding error, and so is every point of the
//! path. A wave is right if its end is that of an exact wave that started a few rounding errors ([`START_ROUNDING`])
//! off: the same objects in the same order, and the end point within twice the spread of those waves, plus a share of
//! the scene's extent ([`END_ROUNDING`]) and a unit in the last place of a world coordinate, the error of reading back
//! as `f32`. A dead wave ends at its last position; only the thesis does not keep it. For a wave that hits a plane wall
//! this is a narrow bound. Near an edge, or after a few round pillars, it is as wide as the problem is ill-posed: a ray
//! into an edge may be mirrored by either face. Cases with a planted answer have a fixed bound instead. If chaos makes
//! the ends meaningless, no wave may be lost, and the number heard must be within chance.
//!
//! Whatever the right answer, no number in any state may be NaN or infinite, no wave may be in a solid, every direction
//! must keep its length of 1, and no march may reach the step limit.
//!
//! Energies of arrivals are compared with known properties: they are conserved, bands do not mix, and a source and a
//! listener may be exchanged. The profile `thesis` carries no energy and fails.
//!
//! # Cost
//! Some hundred cases with three profiles, most of it compilation of shaders: a minute on llvmpipe.

mod case;
mod cases;
mod judge;
mod report;
mod rounding;
mod run;

pub use case::{Bound, Case, Check, EnergyCheck, Planted, WaveCheck};
pub use cases::all;
pub use report::{CaseReport, ProfileResult, VerifyReport};
pub use rounding::{END_ROUNDING, LENGTH_ROUNDING, START_ROUNDING};
pub use run::{run, run_case};
