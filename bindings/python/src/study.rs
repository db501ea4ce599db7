//! Studies: sweeps and maps of many points.

use crate::errors;
use crate::worker::{self, Observer};
use echomarch::Tracer;
use echomarch_lab::study::{Shard, StudyError, Worker, begun, compute, join};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A study that has been read and checked.
#[pyclass(module = "echomarch._echomarch", frozen)]
pub struct Study {
    inner: Arc<echomarch_lab::study::Study>,
}

#[pymethods]
impl Study {
    /// Reads a study file and its scenes.
    #[new]
    fn new(file: PathBuf) -> PyResult<Study> {
        let study = echomarch_lab::study::Study::from_file(&file);
        let inner = Arc::new(study.map_err(|error| errors::of_study(&error))?);
        Ok(Study { inner })
    }

    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// Number of points.
    #[getter]
    fn points(&self) -> u64 {
        self.inner.points()
    }

    /// The number of shards with which the study was begun in a folder; `None` if it was not begun.
    fn begun(&self, folder: PathBuf) -> Option<u32> {
        begun(&self.inner, &folder)
    }

    /// Computes the missing points of a shard, numbered from 1, of a number of shards. `progress` receives the number
    /// of completed points.
    fn compute(
        &self,
        py: Python,
        shard: u32,
        of: u32,
        folder: PathBuf,
        progress: Option<Bound<PyAny>>,
    ) -> PyResult<()> {
        let shard = Shard::new(shard, of).map_err(|error| errors::settings(error.to_string()))?;
        let study = self.inner.clone();
        let job = move |tracer: &mut Tracer, observer: &Observer<u64>| {
            let own = Tracer::new(tracer.context())?;
            let mut worker = Worker::new(&study, own);
            Ok(compute(&mut worker, shard, &folder, &mut |done| {
                observer.report(done)
            }))
        };
        let done: Result<(), StudyError> = worker::run(py, job, |done| match &progress {
            Some(call) => call.call1((done,)).map(drop),
            None => Ok(()),
        })?;
        done.map_err(|error| errors::of_study(&error))
    }

    /// Joins the shards in a folder, and returns the paths of the tables.
    fn join(&self, py: Python, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
        let joined = py.detach(|| join(&self.inner, &folder, &mut |_, _| ()));
        Ok(joined.map_err(|error| errors::of_study(&error))?.files)
    }
}
