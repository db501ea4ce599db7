//! Frames: the sound at the two ears.

use crate::errors;
use crate::scene::Scene;
use crate::worker::{self, Observer};
use echomarch::Tracer;
use echomarch::tracer::{Algorithm, Directions, Profile, Settings};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Traces a frame of a pair, given by the indices of source and listener. Returns the sums of the left and the right
/// ear, the balance, the counts of waves by their fate, and the time in milliseconds.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the package passes each setting")]
pub fn trace<'py>(
    py: Python<'py>,
    scene: &Scene,
    source: usize,
    listener: usize,
    waves: u32,
    iterations: u32,
    seed: u32,
    profile: &str,
    directions: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let profile: Profile = profile.parse().map_err(errors::from)?;
    let directions: Directions = directions.parse().map_err(errors::from)?;
    let settings = Settings::new(Algorithm::of(profile))
        .with_waves(waves)
        .with_iterations(iterations)
        .with_seed(seed)
        .with_directions(directions);
    settings.validate().map_err(errors::from)?;
    scene.pair(source, listener)?;
    let scene = scene.inner.clone();
    let job = move |tracer: &mut Tracer, _: &Observer<()>| {
        let frame = tracer.frame(scene.pair(source, listener)?, &settings)?;
        Ok((frame, tracer.context().renderer().to_owned()))
    };
    let (frame, renderer) = worker::run(py, job, |()| Ok(()))?;
    let about = PyDict::new(py);
    about.set_item("left", frame.panning.left)?;
    about.set_item("right", frame.panning.right)?;
    about.set_item("pan", frame.panning.pan())?;
    about.set_item("listener_hits", frame.counts.listener_hits)?;
    about.set_item("dead", frame.counts.dead)?;
    about.set_item("travelling", frame.counts.travelling)?;
    about.set_item("milliseconds", frame.milliseconds.total)?;
    about.set_item("renderer", renderer)?;
    Ok(about)
}
