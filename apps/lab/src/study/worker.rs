//! Computes the points of a study.

use super::points::Point;
use super::{Study, StudyError, renderer_of};
use crate::experiment::accuracy::exact_pan;
use crate::report::Cell;
use echomarch::Error;
use echomarch::Settings;
use echomarch::response::{Response, ResponseSettings};
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

    /// Computes the result cells of the points of a block, in order. The listeners of a block share the waves of their
    /// source. The results do not depend on the shard of the block.
    pub(super) fn found(&mut self, block: &[Point]) -> Result<Vec<Vec<Cell>>, StudyError> {
        let mut cells = Vec::with_capacity(block.len());
        for point in block {
            let of_frames = self.of_frames(point);
            cells.push(of_frames.map_err(|source| self.failed(point, source))?);
        }
        for group in groups(block) {
            let responses = self.of_response(block, &group);
            let responses = responses.map_err(|source| self.failed(&block[group[0]], source))?;
            for (index, response) in group.into_iter().zip(responses) {
                cells[index].extend(response);
            }
        }
        Ok(cells)
    }

    fn failed(&self, point: &Point, source: Error) -> StudyError {
        StudyError::Point {
            index: point.index,
            what: self.study.label(point),
            source: Box::new(source),
        }
    }

    /// The scene at a point, and the tracer.
    fn scene(&mut self, point: &Point) -> Result<(&Scene, &mut Tracer), Error> {
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
        Ok((scene, &mut self.tracer))
    }

    fn settings(&self, point: &Point) -> Settings {
        let settings = &self.study.settings[point.case].settings;
        settings.clone().with_seed(point.seed)
    }

    /// The cells of frames at a point.
    fn of_frames(&mut self, point: &Point) -> Result<Vec<Cell>, Error> {
        let (keep, settings) = (&self.study.keep, self.settings(point));
        let mut cells = Vec::new();
        if !keep.traces_frames() {
            return Ok(cells);
        }
        let (scene, tracer) = self.scene(point)?;
        if keep.pan || keep.counts {
            let frame = tracer.frame(scene, &settings)?;
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
            cells.push(exact_pan(tracer, scene, &settings)?.into());
        }
        Ok(cells)
    }

    /// The cells of the responses at points of a group; empty if the study has no response.
    fn of_response(&mut self, block: &[Point], group: &[usize]) -> Result<Vec<Vec<Cell>>, Error> {
        let Some((how, columns)) = &self.study.keep.response else {
            return Ok(Vec::new());
        };
        let first = &block[group[0]];
        let mut frames = self.settings(first);
        if how.accuracy.is_some() {
            // The accuracy determines the waves of a response.
            frames.waves = ResponseSettings::default().trace.waves;
        }
        let how = how.clone().with_trace_of_frames(&frames);
        let mut scene = self.scene(first)?.0.clone();
        let listener = scene.listeners[0].clone();
        let at_point = |index: &usize| {
            let mut listener = listener.clone();
            // Listeners of one scene must have different names.
            listener.name = None;
            if let Some(position) = self.study.listener_of(&block[*index]) {
                listener.position = position;
            }
            listener
        };
        scene.listeners = group.iter().map(at_point).collect();
        let pairs = (0..group.len()).map(|listener| scene.pair(0, listener));
        let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
        let responses = Response::trace_pairs(&mut self.tracer, &pairs, &how)?;
        let states_waves = self.study.keep.states_waves();
        let responses = responses.iter().zip(pairs);
        let cells = responses.map(|(one, pair)| {
            let waves = states_waves.then(|| Cell::from(one.waves));
            let of_response = columns.cells(one, pair);
            waves.into_iter().chain(of_response).collect()
        });
        Ok(cells.collect())
    }
}

/// The indices of the points of a block, grouped by everything except the position of the listener.
fn groups(block: &[Point]) -> Vec<Vec<usize>> {
    let key = |point: &Point| {
        let Point {
            variant,
            time,
            case,
            source,
            seed,
            ..
        } = *point;
        (variant, time, case, source, seed)
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, point) in block.iter().enumerate() {
        match groups
            .iter_mut()
            .find(|group| key(&block[group[0]]) == key(point))
        {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}
