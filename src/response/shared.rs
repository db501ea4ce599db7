//! Listeners that share the waves of one source.

use super::from_arrivals::{StartDirections, response};
use super::late::{self, Heard, LateSphere};
use super::source_sound::Medium;
use super::{Echogram, Response, ResponseSettings};
use crate::bands::BAND_COUNT;
use crate::error::Error;
use crate::platform::Instant;
use crate::scene::Pair;
use crate::tracer::{ArrivalSettings, Tracer};

/// Maximum bytes of the echograms of listeners that share waves. More listeners are traced one after another.
const MOST_BYTES: f64 = 512e6;

/// Number of echograms of a listener: all arrivals, both spheres, and copies for the errors.
const ECHOGRAMS: f64 = 4.0;

/// Listeners of one source in one scene.
#[derive(Clone)]
pub(super) struct Listeners<'a> {
    pairs: Vec<Pair<'a>>,
    /// The spheres in which late arrivals are counted.
    spheres: Vec<LateSphere>,
}

/// The indices of the pairs in groups with the same scene and source, of at most `most` pairs.
pub(super) fn groups(pairs: &[Pair], most: usize) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, pair) in pairs.iter().enumerate() {
        let has_source = |group: &&mut Vec<usize>| {
            let first = &pairs[group[0]];
            let is_same = std::ptr::eq(first.scene, pair.scene) && first.source == pair.source;
            is_same && group.len() < most
        };
        match groups.iter_mut().find(has_source) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}

impl<'a> Listeners<'a> {
    /// The listeners of these pairs, which have one source.
    pub fn new(
        pairs: impl Iterator<Item = Pair<'a>>,
        settings: &ResponseSettings,
    ) -> Listeners<'a> {
        let pairs: Vec<Pair> = pairs.collect();
        let sphere = |pair: &Pair| {
            let order = settings.order_in(pair.scene);
            LateSphere::of(*pair, order, settings.accuracy.as_ref())
        };
        Listeners {
            spheres: pairs.iter().map(sphere).collect(),
            pairs,
        }
    }

    pub fn pairs(&self) -> &[Pair<'a>] {
        &self.pairs
    }

    /// The listeners with these indices.
    pub fn only(&self, indices: &[usize]) -> Listeners<'a> {
        Listeners {
            pairs: indices.iter().map(|index| self.pairs[*index]).collect(),
            spheres: indices.iter().map(|index| self.spheres[*index]).collect(),
        }
    }

    /// The responses of the given number of waves.
    pub fn trace_once(
        mut self,
        tracer: &mut Tracer,
        settings: &ResponseSettings,
    ) -> Result<Vec<Response>, Error> {
        let began = Instant::now();
        let seconds = settings.seconds_of_pairs(tracer, &self.pairs)?;
        let mut responses = self.trace(tracer, settings, seconds)?;
        for response in &mut responses {
            response.milliseconds = began.elapsed().as_secs_f64() * 1e3;
        }
        Ok(responses)
    }

    /// The responses of this length. Where a sphere is rejected, its inner sphere takes its place.
    pub fn trace(
        &mut self,
        tracer: &mut Tracer,
        settings: &ResponseSettings,
        seconds: f64,
    ) -> Result<Vec<Response>, Error> {
        let mut responses = Vec::new();
        let all: Vec<usize> = (0..self.pairs.len()).collect();
        for indices in all.chunks(most_together(settings, seconds)) {
            responses.extend(self.only(indices).in_spheres(tracer, settings, seconds)?);
        }
        // A listener's own sphere is never rejected, so the loop ends.
        loop {
            let is_missing = |index: &usize| responses[*index].is_none();
            let rejected: Vec<usize> = all.iter().copied().filter(is_missing).collect();
            if rejected.is_empty() {
                return Ok(responses.into_iter().flatten().collect());
            }
            for index in &rejected {
                self.spheres[*index] = self.spheres[*index].inner(self.pairs[*index]);
            }
            for indices in rejected.chunks(most_together(settings, seconds)) {
                let again = self.only(indices).in_spheres(tracer, settings, seconds)?;
                for (index, response) in indices.iter().zip(again) {
                    responses[*index] = response;
                }
            }
        }
    }

    /// The responses with late arrivals counted in the spheres; `None` for a listener whose figures are biased by the
    /// size of its sphere.
    fn in_spheres(
        &self,
        tracer: &mut Tracer,
        settings: &ResponseSettings,
        seconds: f64,
    ) -> Result<Vec<Option<Response>>, Error> {
        let media: Vec<Medium> = self.pairs.iter().map(|pair| Medium::of(*pair)).collect();
        let heard: Vec<Heard> = (self.pairs.iter().zip(&media).zip(&self.spheres))
            .map(|((pair, medium), late)| Heard {
                pair: *pair,
                medium,
                late: *late,
            })
            .collect();
        let Some(first) = self.pairs.first() else {
            return Ok(Vec::new());
        };
        let order = settings.order_in(first.scene);
        let how = ArrivalSettings::new(seconds).with_early_order(order);
        // Bins begin at the earliest possible arrival, so that the times 50 and 80 ms after this arrival lie on edges
        // of bins.
        let bins = |medium: &Medium| {
            Echogram::with_edge_at(medium.direct_s, settings.bin_s, settings.batches)
        };
        let echograms = media.iter().map(bins).collect::<Result<Vec<_>, _>>()?;
        let all = late::arrivals(tracer, &heard, settings, &how, echograms)?;
        let mut starts = StartDirections::default();
        let mut responses = Vec::new();
        for (heard, arrivals) in heard.iter().zip(all) {
            let starts = starts.of_waves(tracer, &settings.trace, &arrivals.early)?;
            responses.push(response(tracer, heard, (arrivals, starts), settings, &how)?);
        }
        Ok(responses)
    }
}

/// Number of listeners whose echograms of this length have at most [`MOST_BYTES`].
fn most_together(settings: &ResponseSettings, seconds: f64) -> usize {
    let bytes_of_bin = (settings.batches * BAND_COUNT * size_of::<f64>()) as f64;
    let bytes = ECHOGRAMS * bytes_of_bin * seconds / settings.bin_s;
    ((MOST_BYTES / bytes) as usize).max(1)
}
