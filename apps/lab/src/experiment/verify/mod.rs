//! The hard cases: scenes in which a faulty tracer most likely fails, each with its exact answer.
//!
//! # Method
//! A [`Case`] is a scene, and the directions in which waves leave its source: either a few directions aimed at the
//! difficulty, or a lattice of thousands. The GPU traces the waves with every profile, and every state of every wave is
//! read back. The judge compares them with the reference [`ExactScene`](crate::geometry::ExactScene), which solves each
//! flight in `f64`, in closed form where possible, and shares no code with the shaders. The reference cannot evaluate
//! users' GLSL. For such a case it uses a second scene, in which a tree of library shapes describes the same surface.
//! Some answers are *planted*, that is, written by hand: normal and grazing incidence, edges and vertices of a room,
//! sources in a solid and in the listener. The reference is also compared with these answers.
//!
//! # Which answers are right
//! Positions and directions are `f32`, so a start is only known to within a rounding error, and so is every point of
//! the path. A wave is right if an exact wave whose start is displaced by a few rounding errors ([`START_ROUNDING`])
//! hits the same objects in the same order and ends at the same point. The tolerance of the end point is twice the
//! spread of the displaced waves, plus a share of the scene's extent ([`END_ROUNDING`]), plus one unit in the last
//! place of a world coordinate, which is the error of the read-back as `f32`. A dead wave ends at its last position;
//! only the thesis' algorithm does not keep this position.
//!
//! For a wave that hits a plane wall, the tolerance is narrow. Near an edge, or after a few round pillars, it is as
//! wide as the problem is ill-posed. For example, either face may reflect a ray into an edge. Cases with a planted
//! answer have a fixed bound instead. In cases where chaos makes the end points meaningless, no wave may be lost, and
//! the number of heard waves must agree within random variation.
//!
//! In every case, all numbers in all states must be finite, no wave may be inside a solid, every direction must keep
//! its length of 1, and no march may reach the step limit.
//!
//! Energies of arrivals are compared with known properties: energy is conserved, bands do not mix, and source and
//! listener can be exchanged. The profile `thesis` carries no energy, so it fails these cases.
//!
//! # Cost
//! About a hundred cases with three profiles take one minute on llvmpipe, mostly for shader compilation.

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
