//! Computes the points of a study.

use super::points::Point;
use super::{Study, StudyError, renderer_of};
use crate::experiment::accuracy::exact_pan;
use crate::report::Cell;
use echomarch::Error;
use echomarch::response::Response;
use echomarch::scene::Scene;
use echomarch::tracer::Tracer;

/// Computes points of a study on one renderer.
pub struct Worker<'a> {
    pub(super) study: &'a Study,
    tracer: Tracer,
    renderer: String,
    /// The scene of a variant at a given time, kept until a point needs another scene.
    posed: Option<((u64, u64), Scene)>,
}

impl<'a> Worker<'a> {
    /// Creates a worker that computes with `tracer`.
    pub fn new(study: &'a Study, tracer: Tracer) -> Worker<'a> {
        Worker {
            study,
            renderer: renderer_of(&tracer),
            tracer,
            posed: None,
        }
    }

    /// The name and version of the renderer, as written in shards.
    pub fn renderer(&self) -> &str {
        &self.renderer
    }

    /// The tracer, for drawing maps.
    pub fn tracer(&mut self) -> &mut Tracer {
        &mut self.tracer
    }

    /// Computes the result cells of a point.
    pub(super) fn found(&mut self, point: &Point) -> Result<Vec<Cell>, StudyError> {
        self.compute(point).map_err(|source| StudyError::Point {
            index: point.index,
            what: self.study.label(point),
            source: Box::new(source),
        })
    }

    fn compute(&mut self, point: &Point) -> Result<Vec<Cell>, Error> {
        let study = self.study;
        let key = (point.variant, point.time);
        let scene = match self.posed.take() {
            Some((known, scene)) if known == key => scene,
            _ => study.posed(point.variant, point.time)?,
        };
        let (_, scene) = self.posed.insert((key, scene));
        // The assignment replaces the position of the previous point. An axis sets its position either for all points
        // or for none.
        if let Some(position) = study.source_of(point) {
            scene.sources[0].position = position;
        }
        if let Some(position) = study.listener_of(point) {
            scene.listeners[0].position = position;
        }
        let scene = &*scene;
        let settings = &study.settings[point.case].settings;
        let settings = settings.clone().with_seed(point.seed);
        let keep = &study.keep;
        let mut cells = Vec::new();
        if keep.pan || keep.counts {
            let frame = self.tracer.frame(scene, &settings)?;
            if keep.pan {
                let panning = frame.panning;
                cells.extend([panning.left, panning.right, panning.pan()].map(Cell::from));
            }
            if keep.counts {
                let counts = frame.counts;
                cells.extend(
                    [
                        counts.listener_hits,
                        counts.dead,
                        counts.travelling,
                        counts.not_finite,
                        counts.zero_length_passes,
                        counts.step_limit_reached,
                    ]
                    .map(Cell::from),
                );
            }
        }
        if keep.exact {
            cells.push(exact_pan(&mut self.tracer, scene, &settings)?.into());
        }
        if let Some((how, columns)) = &keep.response {
            let how = how.clone().with_trace_of_frames(&settings);
            let response = Response::trace(&mut self.tracer, scene, &how)?;
            cells.extend(columns.cells(&response));
        }
        Ok(cells)
    }
}
