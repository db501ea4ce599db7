//! The work of the tracing worker: direct ways of all sources in each round, and traces of those that need one most.

use super::hall::{Hall, MOTION_BITS};
use super::heard::{Effort, Heard, Place};
use super::messages::Subscriber;
use super::stage::{Job, Shared as SharedBy, SimulatorState};
use super::update::Published;
use super::world::Snapshot;
use super::{SimulatorSettings, SourceId};
use crate::error::Error;
use crate::platform::Instant;
use crate::response::{DirectWays, Response};
use crate::tracer::{Tracer, arrivals_key};
use crate::wave_budget::{LEAST_WAVES, TraceTime};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// The state that the engine shares with the other threads.
pub(super) type Shared = SharedBy<Engine>;

/// The share of a round for ways around and through obstacles. One of them takes milliseconds, whatever the scene.
const SHARE_AROUND: f64 = 0.25;

/// Maximum rest in seconds after a round, also after one that compiled: moving sources must not stand still for longer.
const LONGEST_REST_S: f64 = 0.25;

/// Time until messages are sent again that ears had no room for, for example because their sound is paused: about two
/// blocks of sound.
const SEND_AGAIN: Duration = Duration::from_millis(20);

/// Number of structures whose programs a worker keeps. A structure has up to three programs, and twelve are kept.
const STRUCTURES_KEPT: usize = 4;

/// Number of waves of the trace that compiles programs.
const WAVES_OF_COMPILATION: u32 = 64;

/// Number of workers: one traces, one compiles.
pub(super) const WORKERS: usize = 2;

/// The state of all work. It passes from worker to worker.
pub(super) struct Engine {
    settings: SimulatorSettings,
    hall: Option<Box<Hall>>,
    /// The last snapshot, if its surfaces are not those of the hall.
    pending: Option<Box<Snapshot>>,
    /// The key of the programs that are compiled aside, or that were refused.
    asked: Option<u64>,
    /// Keys of the structures whose programs each worker has.
    compiled: [Vec<u64>; WORKERS],
    ways: Option<DirectWays>,
    /// The geometry of the direct ways.
    ways_of: u64,
    geometry: u64,
    heard: HashMap<SourceId, Heard>,
    /// Number of waves that fits a round.
    waves: u32,
    seed: u32,
    /// Milliseconds that ways around obstacles may take now; negative after a long one.
    around_ms: f64,
    /// The commit whose direct ways are known.
    direct_of: Option<u64>,
    next_round: Option<Instant>,
    /// The last published results.
    published: Arc<Published>,
    subscribers: Vec<Subscriber>,
}

impl Engine {
    pub fn new(settings: SimulatorSettings) -> Engine {
        Engine {
            waves: LEAST_WAVES.max(settings.waves / 4),
            settings,
            hall: None,
            pending: None,
            asked: None,
            compiled: Default::default(),
            ways: None,
            ways_of: 0,
            geometry: 0,
            heard: HashMap::new(),
            seed: 0,
            around_ms: 0.0,
            direct_of: None,
            next_round: None,
            published: Arc::default(),
            subscribers: Vec::new(),
        }
    }

    /// The time of the next round; `None` if no work is left before another commit.
    pub fn next_round(&self) -> Option<Instant> {
        let again = || self.subscribers.iter().any(Subscriber::is_behind);
        self.next_round
            .or_else(|| again().then(|| Instant::now() + SEND_AGAIN))
    }

    /// Adds ears, and sends them the present state.
    pub fn subscribe(&mut self, subscribers: Vec<Subscriber>) {
        if !subscribers.is_empty() {
            self.subscribers.extend(subscribers);
            self.tell();
        }
    }

    /// Sends the present state to all ears.
    fn tell(&mut self) {
        let Some(hall) = &self.hall else {
            return;
        };
        self.subscribers.retain(Subscriber::is_heard);
        for subscriber in &mut self.subscribers {
            subscriber.tell(&hall.listener, &self.published);
        }
    }

    /// Takes a snapshot. Surfaces whose programs this worker lacks are compiled aside.
    pub fn receive(&mut self, snapshot: Box<Snapshot>, worker: usize, shared: &Shared) {
        self.next_round = Some(Instant::now());
        match &mut self.hall {
            None => {
                self.enter(Box::new(Hall::of(&snapshot)));
                shared.set_state(SimulatorState::Compiling);
            }
            Some(hall) if hall.has_surfaces_of(&snapshot) => {
                hall.follow(&snapshot);
                if self.pending.take().is_some() {
                    self.asked = None;
                    shared.set_state(SimulatorState::Ready);
                }
            }
            Some(hall) => {
                let next = Hall::of(&snapshot);
                let key = key_of(&next, &self.settings);
                if self.compiled[worker].contains(&key) {
                    self.enter(Box::new(next));
                    (self.pending, self.asked) = (None, None);
                    shared.set_state(SimulatorState::Ready);
                } else {
                    hall.follow(&snapshot);
                    self.pending = Some(snapshot);
                    self.ask(Box::new(next), key, shared);
                }
            }
        }
        let hall = self.hall.as_deref();
        let is_there = |id: &SourceId| {
            hall.is_some_and(|hall| hall.sources.iter().any(|(other, _)| other == id))
        };
        self.heard.retain(|id, _| is_there(id));
    }

    fn key(&self, hall: &Hall) -> u64 {
        key_of(hall, &self.settings)
    }

    /// Has programs compiled aside, once.
    fn ask(&mut self, hall: Box<Hall>, key: u64, shared: &Shared) {
        if self.asked == Some(key) {
            return;
        }
        self.asked = Some(key);
        shared.set_state(SimulatorState::Compiling);
        shared.compile(Job { hall, key });
    }

    /// Traces this hall from now on.
    fn enter(&mut self, mut hall: Box<Hall>) {
        self.geometry += 1;
        hall.geometry = self.geometry << MOTION_BITS;
        self.hall = Some(hall);
        self.direct_of = None;
    }

    /// Takes the hall whose programs the other worker has compiled, with the poses of the last snapshot.
    pub fn adopt(&mut self, hall: Box<Hall>, key: u64, other: usize, shared: &Shared) {
        self.note_compiled(key, other, shared);
        self.enter(hall);
        self.next_round = Some(Instant::now());
        let Some(snapshot) = self.pending.take() else {
            return;
        };
        self.receive(snapshot, other, shared);
    }

    /// Whether a snapshot waits for its programs.
    pub fn is_waiting(&self) -> bool {
        self.pending.is_some()
    }

    /// The programs of a hall cannot be compiled. If a later commit does not need them, its state stays.
    pub fn refuse(&mut self, error: Error, key: u64, shared: &Shared) {
        if self.asked == Some(key) {
            shared.set_state(SimulatorState::Failed(Arc::new(error)));
        }
    }

    pub fn note_compiled(&mut self, key: u64, worker: usize, shared: &Shared) {
        let keys = &mut self.compiled[worker];
        keys.retain(|other| *other != key);
        keys.push(key);
        if keys.len() > STRUCTURES_KEPT {
            keys.remove(0);
        }
        shared.set_compiled(self.compiled.concat());
    }

    /// One round: direct ways, ways around obstacles, traces; then publishes what is known.
    pub fn round(&mut self, tracer: &mut Tracer, worker: usize, shared: &Shared) {
        let began = Instant::now();
        let Some(hall) = self.hall.take() else {
            self.next_round = None;
            return;
        };
        let worked = self.work(&hall, tracer, (worker, began), shared);
        self.hall = Some(hall);
        self.tell();
        match worked {
            Ok(has_more) => self.rest(began, has_more),
            Err(error) => {
                self.next_round = None;
                shared.set_state(SimulatorState::Failed(Arc::new(error)));
            }
        }
    }

    /// Whether more work is left.
    fn work(
        &mut self,
        hall: &Hall,
        tracer: &mut Tracer,
        (worker, began): (usize, Instant),
        shared: &Shared,
    ) -> Result<bool, Error> {
        let is_new = self.direct_of != Some(hall.commit);
        if is_new {
            self.find_direct_ways(hall)?;
            self.direct_of = Some(hall.commit);
            self.publish(hall, shared);
        }
        let mut has_more = self.find_way_around(hall)?;
        let limit = Duration::from_secs_f64(self.settings.milliseconds / 1e3);
        let mut is_first = true;
        while let Some(index) = self.most_urgent(hall) {
            has_more = true;
            let left = limit.saturating_sub(began.elapsed());
            // A round has one trace at least. A further one must be likely to fit.
            if !is_first && left < limit / 3 {
                break;
            }
            self.trace(hall, index, tracer, left.max(limit / 3))?;
            if is_first {
                self.note_traced(hall, worker, shared);
            }
            is_first = false;
        }
        if has_more {
            self.publish(hall, shared);
        }
        if hall.sources.is_empty() && self.pending.is_none() {
            shared.set_state(SimulatorState::Ready);
        }
        Ok(has_more)
    }

    /// Notes that the programs of the hall exist.
    fn note_traced(&mut self, hall: &Hall, worker: usize, shared: &Shared) {
        if self.compiled[worker].is_empty() {
            let key = self.key(hall);
            self.note_compiled(key, worker, shared);
        }
        if self.pending.is_none() {
            shared.set_state(SimulatorState::Ready);
        }
    }

    fn find_direct_ways(&mut self, hall: &Hall) -> Result<(), Error> {
        if hall.sources.is_empty() {
            return Ok(());
        }
        if self.ways.is_none() || self.ways_of != hall.geometry {
            self.ways = Some(DirectWays::new(hall.scene.pair(0, 0)?)?);
            self.ways_of = hall.geometry;
        }
        let Some(ways) = &self.ways else {
            return Ok(());
        };
        for (index, (id, _)) in hall.sources.iter().enumerate() {
            let pair = hall.scene.pair(index, 0)?;
            self.heard.entry(*id).or_default().find_direct(ways, pair);
        }
        Ok(())
    }

    /// Finds the ways around what hides one source, if their share of the time allows it. Whether further ones are
    /// missing.
    fn find_way_around(&mut self, hall: &Hall) -> Result<bool, Error> {
        let share_ms = SHARE_AROUND * self.settings.milliseconds;
        self.around_ms = (self.around_ms + share_ms).min(share_ms);
        let lacking = |(index, (id, placed)): (usize, &(SourceId, super::world::PlacedSource))| {
            let place = Place::of(hall, index);
            let urgency = self
                .heard
                .get(id)?
                .urgency_around(&place, placed.priority)?;
            Some((index, *id, urgency))
        };
        let all = hall.sources.iter().enumerate().filter_map(lacking);
        let Some((index, id, _)) = all.max_by(|a, b| a.2.total_cmp(&b.2)) else {
            return Ok(false);
        };
        if self.around_ms <= 0.0 {
            return Ok(true);
        }
        let began = Instant::now();
        if let (Some(heard), Some(ways)) = (self.heard.get_mut(&id), &self.ways) {
            let pair = hall.scene.pair(index, 0)?;
            heard.find_around(ways, pair, Place::of(hall, index), &self.settings);
        }
        self.around_ms -= 1e3 * began.elapsed().as_secs_f64();
        Ok(true)
    }

    /// The index of the source that needs a trace most.
    fn most_urgent(&self, hall: &Hall) -> Option<usize> {
        let urgency = |index: usize| {
            let (id, placed) = &hall.sources[index];
            let heard = self.heard.get(id)?;
            let urgency = heard.urgency(&Place::of(hall, index), placed.priority, &self.settings);
            (urgency > 0.0).then_some((index, urgency))
        };
        let all = (0..hall.sources.len()).filter_map(urgency);
        let most = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(most.0)
    }

    fn trace(
        &mut self,
        hall: &Hall,
        index: usize,
        tracer: &mut Tracer,
        time: Duration,
    ) -> Result<(), Error> {
        let (id, _) = &hall.sources[index];
        let Some(heard) = self.heard.get_mut(id) else {
            return Ok(());
        };
        let Effort { waves, seconds } = heard.next_effort(self.waves, &self.settings);
        self.seed = self.seed.wrapping_add(1);
        let how = self.settings.response(waves, self.seed, seconds);
        let began = Instant::now();
        let pair = hall.scene.pair(index, 0)?;
        let response = Response::trace(tracer, pair, &how)?;
        let took = TraceTime::new(began.elapsed(), 0.0);
        heard.hear(&response, hall, Place::of(hall, index), &self.settings)?;
        if seconds == self.settings.seconds {
            let limits = LEAST_WAVES..=self.settings.waves;
            let fitting = took.fitting(waves, time.as_secs_f64(), &limits);
            // One long trace beside other work does not take the waves from the next.
            self.waves = fitting.max(self.waves / 2);
        }
        Ok(())
    }

    fn publish(&mut self, hall: &Hall, shared: &Shared) {
        let mut published = Published::with_capacity(hall.sources.len());
        for (id, _) in &hall.sources {
            let update = self
                .heard
                .get(id)
                .and_then(|heard| heard.update(hall.commit));
            if let Some(update) = update {
                published.insert(*id, Arc::new(update));
            }
        }
        self.published = Arc::new(published);
        shared.publish(Arc::clone(&self.published));
    }

    /// Rests so that rounds take their share of the time, but at most [`LONGEST_REST_S`].
    fn rest(&mut self, began: Instant, has_more: bool) {
        if !has_more {
            self.next_round = None;
            return;
        }
        let interval_s = 1.0 / self.settings.rounds_hz;
        let share = (self.settings.milliseconds / 1e3 / interval_s).min(1.0);
        let took_s = began.elapsed().as_secs_f64();
        let until_s = interval_s.max((took_s / share).min(took_s + LONGEST_REST_S));
        self.next_round = Some(began + Duration::from_secs_f64(until_s));
    }
}

/// The key of the programs that trace a hall.
pub(super) fn key_of(hall: &Hall, settings: &SimulatorSettings) -> u64 {
    let how = settings.response(settings.waves, 0, settings.seconds);
    let order = how.order_in(&hall.scene);
    arrivals_key(&hall.scene, &how.trace, order, settings.transmission)
}

/// Compiles the programs of a hall by a trace of few waves.
pub(super) fn compile(
    hall: &Hall,
    tracer: &mut Tracer,
    settings: &SimulatorSettings,
) -> Result<(), Error> {
    let mut scene = hall.scene.clone();
    if scene.sources.is_empty() {
        let beside = scene.listeners[0].position + glam::Vec3::X;
        scene.sources.push(crate::scene::Source::at(beside));
    }
    let how = settings.response(WAVES_OF_COMPILATION, 0, settings.seconds);
    Response::trace(tracer, scene.pair(0, 0)?, &how)?;
    Ok(())
}
