//! The hard cases: what tracing gets wrong first, each with its exact answer.
//!
//! # Method
//! A [`Case`] is a scene and the directions in which waves leave its source: few of them,
//! aimed at what is hard, or a lattice of thousands. The GPU follows them by every profile
//! and every state of every wave is read back. The judge is [`ExactScene`](crate::reference::ExactScene), which solves
//! each flight in `f64`, in closed form where there is one, and shares no code with the shaders.
//! It cannot read a user's text: there it uses a second scene, in which a tree of the
//! library's own states the same surface. Some answers are
//! *planted* besides (head-on and grazing flights, edges and vertices of a room, sources in
//! a solid and in the listener): written down by hand, and the judge itself is compared with
//! them.
//!
//! # Which answers are right
//! Positions and directions are `f32`, so a start is only known to a rounding, and so is
//! every point on the way. A wave is right if it is where an exact wave ends that started a
//! few roundings ([`START_ROUNDING`]) off: the same objects in the same order, and the end
//! point within the spread of those waves, twice over, plus a share of the scene's extent
//! ([`END_ROUNDING`]) and a unit in the last place of a world coordinate, which reading back
//! as `f32` costs. A dead wave ends where it was last; only the thesis keeps no such place.
//! For a wave that comes down on a plain wall that is a narrow bound.
//! Near an edge, or after a few round pillars, it is as wide as the problem is ill-posed:
//! a ray into an edge may be mirrored by either face. Cases with a planted answer have a
//! fixed bound instead. Where chaos leaves no end to judge, no wave may be lost, and as many
//! must be heard as chance allows.
//!
//! Whatever the right answer, in every state no number may be a NaN or infinite, no wave may
//! be in a solid, no direction may lose its length of 1, and no march may reach the step
//! limit.
//!
//! Energies of arrivals are judged by what is known of them: that they are conserved, that bands do not
//! mix, that a source and a listener may change places. The profile `thesis` carries none and fails.
//!
//! # Cost
//! Some hundred cases by three profiles, mostly the compiling of shaders: a minute on llvmpipe.

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
