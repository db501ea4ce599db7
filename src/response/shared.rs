//! Listeners that share the waves of one source.

use super::early_sound::{EarlySound, StartDirections};
use super::from_arrivals::{Traced, response};
use super::late::{self, Heard, LateSphere, Tally};
use super::source_sound::Medium;
use super::{Response, ResponseSettings};
use crate::bands::BAND_COUNT;
use crate::error::Error;
use crate::platform::Instant;
use crate::scene::Pair;
use crate::tracer::{ArrivalSettings, Tracer};

/// Maximum bytes of the echograms of listeners that share waves. More listeners are traced one after another.
const MOST_BYTES: f64 = 512e6;

/// Number of long echograms of a listener: all arrivals, both spheres, the same of two kinds of further waves, and a copy
/// for the errors. Those of sound scattered after few reflections are short.
const ECHOGRAMS: f64 = 7.0;

/// Listeners of one source in one scene.
pub(super) struct Listeners<'a> {
    all: Vec<SharedListener<'a>>,
    /// Length in seconds of the record of the tallies.
    seconds: f64,
}

/// A listener of a source.
struct SharedListener<'a> {
    pair: Pair<'a>,
    /// The sphere in which late arrivals are counted.
    sphere: LateSphere,
    /// The waves of earlier rounds, if further waves can extend them.
    tally: Option<Tally>,
    /// The early sound of earlier rounds, or of waves that are traced again through another sphere.
    early: Option<EarlySound>,
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
        let listener = |pair: Pair<'a>| {
            let order = settings.order_in(pair.scene);
            SharedListener {
                pair,
                sphere: LateSphere::for_settings(pair, order, settings),
                tally: None,
                early: None,
            }
        };
        Listeners {
            all: pairs.map(listener).collect(),
            seconds: 0.0,
        }
    }

    pub fn pairs(&self) -> Vec<Pair<'a>> {
        self.all.iter().map(|one| one.pair).collect()
    }

    /// Keeps the listeners for which `is_kept` holds.
    pub fn keep(&mut self, is_kept: &[bool]) {
        let mut is_kept = is_kept.iter().copied();
        self.all.retain(|_| is_kept.next().unwrap_or(false));
    }

    /// The responses of the given number of waves.
    pub fn trace_once(
        mut self,
        tracer: &mut Tracer,
        settings: &ResponseSettings,
    ) -> Result<Vec<Response>, Error> {
        let began = Instant::now();
        let seconds = settings.seconds_of_pairs(tracer, &self.pairs())?;
        let traced = self.trace(tracer, settings, seconds)?;
        let milliseconds = began.elapsed().as_secs_f64() * 1e3 / traced.len().max(1) as f64;
        let timed = |traced: Traced| Response {
            milliseconds,
            ..traced.response
        };
        Ok(traced.into_iter().map(timed).collect())
    }

    /// Whether rounds of this length extend the waves of the rounds before. The tallies of many listeners are not kept.
    pub fn keeps_waves(&self, settings: &ResponseSettings, seconds: f64) -> bool {
        settings.onset.is_some() && self.all.len() <= most_together(settings, seconds)
    }

    /// Forgets the waves of earlier rounds.
    pub fn begin_anew(&mut self) {
        for one in &mut self.all {
            (one.tally, one.early) = (None, None);
        }
    }

    /// The responses of this length. The waves extend those of the call before if all waves start evenly and the length
    /// is the same. Where a sphere is rejected, a narrower one takes its place.
    pub fn trace(
        &mut self,
        tracer: &mut Tracer,
        settings: &ResponseSettings,
        seconds: f64,
    ) -> Result<Vec<Traced>, Error> {
        if seconds != self.seconds {
            self.begin_anew();
            self.seconds = seconds;
        }
        let mut responses = vec![None; self.all.len()];
        // A listener's own sphere is never rejected, so the loop ends.
        while responses.contains(&None) {
            for is_begun in [true, false] {
                let is_of_kind = |index: &usize| {
                    responses[*index].is_none() && self.all[*index].tally.is_some() == is_begun
                };
                let indices: Vec<usize> = (0..self.all.len()).filter(is_of_kind).collect();
                for indices in indices.chunks(most_together(settings, seconds)) {
                    let found = self.in_spheres(tracer, indices, settings)?;
                    for (index, response) in indices.iter().zip(found) {
                        responses[*index] = response;
                    }
                }
            }
        }
        Ok(responses.into_iter().flatten().collect())
    }

    /// The responses with late arrivals counted in the spheres; `None` for a listener whose figures are biased by the
    /// size of its sphere and of the inner one: its own sphere takes their place.
    fn in_spheres(
        &mut self,
        tracer: &mut Tracer,
        indices: &[usize],
        settings: &ResponseSettings,
    ) -> Result<Vec<Option<Traced>>, Error> {
        let medium = |index: &usize| Medium::of(self.all[*index].pair);
        let media: Vec<Medium> = indices.iter().map(medium).collect();
        let heard = |(index, medium): (&usize, _)| {
            let SharedListener { pair, sphere, .. } = self.all[*index];
            Heard {
                pair,
                medium,
                late: sphere,
            }
        };
        let heard: Vec<Heard> = indices.iter().zip(&media).map(heard).collect();
        let Some(first) = heard.first() else {
            return Ok(Vec::new());
        };
        let order = settings.order_in(first.pair.scene);
        let how = ArrivalSettings::new(self.seconds).with_early_order(order);
        let before = indices.iter().map(|index| self.all[*index].tally.take());
        let before = before.collect::<Option<Vec<Tally>>>();
        let tallies = late::tallies(tracer, &heard, settings, &how, before)?;
        let keeps_waves = self.keeps_waves(settings, self.seconds);
        let mut starts = StartDirections::default();
        let mut responses = Vec::new();
        for ((index, mut heard), tally) in indices.iter().zip(heard).zip(tallies) {
            let one = &mut self.all[*index];
            let known = one.early.take();
            let early = match known.filter(|early| early.waves == settings.trace.waves) {
                Some(early) => early,
                None => {
                    let starts = starts.of_waves(tracer, &settings.trace, &tally.early)?;
                    let early = (starts, tally.early.clone());
                    EarlySound::find(&heard, settings, self.seconds, early)?
                }
            };
            let found = loop {
                let found = (&early, tally.arrivals(&heard.late));
                let found = response(tracer, &heard, found, settings, &how)?;
                if found.is_some() {
                    break found;
                }
                heard.late = heard.late.narrower(one.pair);
                // Other waves are not counted in the listener's own sphere.
                if !heard.late.is_narrowed {
                    break None;
                }
            };
            one.sphere = heard.late;
            one.tally = (keeps_waves && found.is_some()).then_some(tally);
            one.early = (keeps_waves || found.is_none()).then_some(early);
            responses.push(found);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::gl::{Context, ContextOptions};
    use crate::response::Echogram;
    use crate::response::late::Onset;

    /// A room that scatters, with a board that hides the listener's centre from some images of the source.
    fn room() -> Scene {
        let text = "Scene(surfaces: [Surface(shape: Room(size: (6, 3, 5)), material: \"m\"),
                Surface(shape: Box(size: (0.1, 1.5, 1)), position: (0, -0.7, 0), material: \"m\")],
            materials: {\"m\": Material(absorption: 0.3, scattering: 0.3)},
            source: Source(position: (-1.5, 0.3, -1)), listener: Listener(position: (1.7, -0.2, 0.9), radius: 0.3))";
        Scene::from_ron(text, "room").unwrap()
    }

    /// The settings of a round with these numbers of waves.
    fn round(followed: u32, onset_waves: u32, early_waves: u32) -> ResponseSettings {
        let mut settings = ResponseSettings::default().with_order(3);
        settings.trace.waves = early_waves;
        settings.late_waves = Some(followed);
        settings.onset = Some(Onset {
            waves: onset_waves,
            seconds: 0.1,
        });
        settings
    }

    /// Protects the rounds of an accuracy: further waves of early arrivals give what all of them give at once, further
    /// late waves the mean over all of them, and a longer record begins anew.
    #[test]
    fn further_waves_extend_a_response() {
        let mut tracer =
            Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
        let scene = room();
        let listeners = || {
            let pair = scene.only_pair().unwrap();
            Listeners::new([pair].into_iter(), &round(1, 1, 1))
        };
        let mut trace = |listeners: &mut Listeners, settings: &ResponseSettings, seconds: f64| {
            let mut traced = listeners.trace(&mut tracer, settings, seconds).unwrap();
            traced.remove(0)
        };
        let few = round(2048, 8192, 8192);
        let only_early = round(2048, 8192, 16_384);
        let many = round(16_384, 32_768, 16_384);
        let mut extended = listeners();
        let first = trace(&mut extended, &few, 0.5);
        let second = trace(&mut extended, &only_early, 0.5);
        let third = trace(&mut extended, &many, 0.5);
        let longer = trace(&mut extended, &few, 0.6);
        let total = |of: &Echogram| of.total()[4];
        let ratio = |a: &Echogram, b: &Echogram| total(a) / total(b);

        let at_once = trace(&mut listeners(), &only_early, 0.5);
        let own = ratio(&second.in_own_sphere, &at_once.in_own_sphere);
        assert!((own - 1.0).abs() < 1e-9, "{own}");
        assert!(total(&first.in_own_sphere) != total(&second.in_own_sphere));

        let many_at_once = trace(&mut listeners(), &many, 0.5);
        let late = ratio(&third.response.echogram, &many_at_once.response.echogram);
        assert!((late - 1.0).abs() < 0.02, "{late}");
        let noise = |of: &Traced| of.response.figures.precision[4][2].noise.unwrap();
        // A third of the noise is expected of eight times the waves.
        assert!(
            noise(&third) < 0.6 * noise(&first),
            "{} {}",
            noise(&third),
            noise(&first)
        );
        assert_eq!(third.response.counts.waves, 16_384);

        assert_eq!(longer.response.counts.waves, 2048);
        assert_eq!(longer, trace(&mut listeners(), &few, 0.6));
    }
}
