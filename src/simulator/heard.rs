//! The state of one source in a worker.

use super::hall::{Hall, MOTION_BITS};
use super::reverb::{DecayRecord, Reverb, Trace};
use super::update::{DirectWay, Surroundings};
use super::{Pose, SimulatorSettings, Update};
use crate::error::Error;
use crate::platform::Instant;
use crate::response::{DirectWays, HeardPath, Response};
use crate::scene::Pair;

/// Distance in metres over which earlier traces lose the share 1 − 1/e of their weight, as source or listener moves.
const FORGETS_M: f64 = 0.5;

/// Maximum number of waves of earlier traces that still count, in multiples of those of a full trace. Without a limit
/// a door's slow motion would not be heard.
const MOST_TRACES: f64 = 8.0;

/// Number of traces in which a long one measures the decay, if the decay is longer than the others.
const LONG_EVERY: u64 = 3;

/// The share of the waves of a long trace.
const LONG_SHARE: f64 = 0.25;

/// A source that has not moved is traced again until this number of full traces counts.
const ENOUGH_TRACES: f64 = 4.0;

/// Maximum number of traces of a source that has not moved.
const MOST_AT_REST: u32 = 24;

/// Relative error of the decay times above which a source that has not moved is traced again.
const GOOD_ERROR: f64 = 0.05;

/// Time in seconds in which earlier traces lose the share 1 − 1/e of their weight while surfaces move.
const FORGETS_S: f64 = 1.0;

/// Priority of a source that has not moved, relative to one that has.
const REST_PRIORITY: f64 = 0.1;

/// The time in seconds that a source counts as waiting whose ways around obstacles were never found.
const NEVER_S: f64 = 1e6;

/// The place of a source, the listener and the surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    source: Pose,
    level_db: f32,
    listener: glam::Vec3,
    /// Counts the changes of surfaces and materials, and in its last [`MOTION_BITS`] their motions.
    pub geometry: u64,
}

impl Place {
    /// The place of the source with this index.
    pub fn of(hall: &Hall, index: usize) -> Place {
        let (_, placed) = &hall.sources[index];
        Place {
            source: placed.pose,
            level_db: placed.level_db,
            listener: hall.listener.position,
            geometry: hall.geometry,
        }
    }

    /// Whether the same surfaces are there, maybe in other poses.
    fn has_same_surfaces(&self, other: &Place) -> bool {
        self.geometry >> MOTION_BITS == other.geometry >> MOTION_BITS
    }

    /// The distance in metres that the source and the listener moved.
    pub fn moved_m(&self, other: &Place) -> f64 {
        let listener = Pose::at(self.listener).distance(&Pose::at(other.listener));
        self.source.distance(&other.source) + listener
    }
}

/// The state of a source.
#[derive(Debug, Default)]
pub(super) struct Heard {
    /// The direct way, and the delay of the direct sound in the open.
    direct: Option<(DirectWay, f64)>,
    /// The paths around and through what hides the source, and where they were found.
    hidden: Option<(Vec<HeardPath>, Place)>,
    found_around: Option<Instant>,
    surroundings: Surroundings,
    record: DecayRecord,
    reverb: Reverb,
    /// Place and time of the last trace.
    traced: Option<(Place, Instant)>,
    traces: u64,
    /// Number of traces at the same place.
    at_rest: u32,
    waves: u32,
}

/// The number of waves and the length in seconds of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effort {
    pub waves: u32,
    pub seconds: f64,
}

impl Heard {
    /// Finds the direct way. A source that has just been hidden, and one whose ways around obstacles are found late, keep
    /// the gains that were found last, until [`Heard::find_around`].
    pub fn find_direct(&mut self, ways: &DirectWays, pair: Pair) {
        let Some(open) = DirectWays::in_the_open(pair) else {
            // Source and listener are at the same place.
            self.direct = None;
            return;
        };
        let open_s = open.delay_s;
        let direct = match ways.is_in_sight(pair) {
            true => {
                self.hidden = None;
                DirectWay::new(&open, std::slice::from_ref(&open))
            }
            false => {
                let (paths, at) = self.hidden.get_or_insert_default();
                match self.direct {
                    // The ways are not found yet: a place has a geometry above 0.
                    Some((last, _)) if at.geometry == 0 => DirectWay {
                        is_in_sight: false,
                        ..last
                    },
                    _ => DirectWay::new(&open, paths),
                }
            }
        };
        self.direct = Some((direct, open_s));
    }

    /// Whether the source is hidden, and paths around and through what hides it are missing or of another place.
    fn lacks_ways_around(&self, place: &Place) -> bool {
        self.hidden.as_ref().is_some_and(|(_, at)| at != place)
    }

    /// The urgency of a search for ways around obstacles, which grows while the source waits; `None` if it needs none.
    pub fn urgency_around(&self, place: &Place, priority: f32) -> Option<f64> {
        let waited_s = match self.found_around {
            Some(when) => when.elapsed().as_secs_f64(),
            None => NEVER_S,
        };
        let urgency = f64::from(priority) * waited_s;
        self.lacks_ways_around(place).then_some(urgency)
    }

    /// Finds the paths around and through what hides the source.
    pub fn find_around(
        &mut self,
        ways: &DirectWays,
        pair: Pair,
        place: Place,
        settings: &SimulatorSettings,
    ) {
        let how = settings.response(settings.waves, 0, settings.seconds);
        let how = how.with_diffraction(settings.diffraction);
        self.hidden = Some((ways.around_and_through(pair, &how), place));
        self.found_around = Some(Instant::now());
        self.find_direct(ways, pair);
    }

    /// The urgency of a trace: 0 if it needs no trace.
    pub fn urgency(&self, place: &Place, priority: f32, settings: &SimulatorSettings) -> f64 {
        let priority = f64::from(priority);
        let Some((at, when)) = &self.traced else {
            return f64::MAX.sqrt() * priority;
        };
        let waited_s = when.elapsed().as_secs_f64().max(1e-6);
        if at != place {
            return priority * waited_s;
        }
        let is_rough = self.record.waves() < ENOUGH_TRACES * f64::from(settings.waves);
        let is_rough = is_rough || self.wants_long(settings) || self.has_uncertain_decay();
        match is_rough && self.at_rest < MOST_AT_REST {
            true => priority * waited_s * REST_PRIORITY,
            false => 0.0,
        }
    }

    /// Whether a decay time is more uncertain than one hears.
    fn has_uncertain_decay(&self) -> bool {
        let times = self.reverb.decay_s.iter().zip(&self.reverb.decay_error_s);
        let mut uncertain = times.map(|(time_s, error_s)| *error_s > GOOD_ERROR * time_s);
        uncertain.any(|is_uncertain| is_uncertain)
    }

    /// Whether the decay is longer than all traces, and a longer trace is allowed.
    fn wants_long(&self, settings: &SimulatorSettings) -> bool {
        let is_beyond = self.reverb.is_extrapolated.contains(&true);
        settings.longest_s > settings.seconds && is_beyond && !self.record.is_long()
    }

    /// The next trace, of at most `waves` waves of the usual length.
    pub fn next_effort(&self, waves: u32, settings: &SimulatorSettings) -> Effort {
        let is_turn = self.traces % LONG_EVERY == 1 && settings.longest_s > settings.seconds;
        let needs = self.record.is_long() || self.wants_long(settings);
        match is_turn && needs {
            true => Effort {
                waves: ((LONG_SHARE * f64::from(waves)) as u32).max(64),
                seconds: settings.longest_s,
            },
            false => Effort {
                waves,
                seconds: settings.seconds,
            },
        }
    }

    /// Takes the result of a trace.
    pub fn hear(
        &mut self,
        response: &Response,
        hall: &Hall,
        place: Place,
        settings: &SimulatorSettings,
    ) -> Result<(), Error> {
        let (direct, open_s) = match self.direct {
            Some((direct, open_s)) => (Some(direct), open_s),
            None => (None, 0.0),
        };
        let surroundings = Surroundings::new(response, hall, settings.echoes);
        let trace = Trace {
            echogram: &response.echogram,
            waves: response.waves,
            ends_s: response.followed_s.unwrap_or(response.seconds),
            short_s: settings.seconds,
            direct_s: open_s,
        };
        self.at_rest = match &self.traced {
            Some((at, _)) if *at == place => self.at_rest + 1,
            _ => 1,
        };
        let keep = match &self.traced {
            // A record of another level would change the loudness too slowly.
            Some((at, when)) if at.has_same_surfaces(&place) && at.level_db == place.level_db => {
                let waited_s = match at.geometry == place.geometry {
                    true => 0.0,
                    false => when.elapsed().as_secs_f64(),
                };
                (-at.moved_m(&place) / FORGETS_M - waited_s / FORGETS_S).exp()
            }
            _ => 0.0,
        };
        let most = MOST_TRACES * f64::from(settings.waves);
        let keep = keep * (most / self.record.waves().max(most));
        self.record.add(&trace, keep);
        if let Some(direct) = direct {
            self.reverb = surroundings.reverb(&self.record, &direct, open_s);
        }
        self.surroundings = surroundings;
        self.waves = response.waves;
        self.traces += 1;
        self.traced = Some((place, Instant::now()));
        Ok(())
    }

    /// The published state; `None` before the direct way is known.
    pub fn update(&self, commit: u64) -> Option<Update> {
        let (direct, _) = self.direct?;
        let mut update = self.surroundings.update(direct, self.reverb);
        (update.commit, update.waves, update.traces) = (commit, self.waves, self.traces);
        Some(update)
    }
}
