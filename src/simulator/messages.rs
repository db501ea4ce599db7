//! Messages from the tracing worker to the ears: taps of each source, and the decay of the network.

use super::fit::{Fit, Frame};
use super::network::{self, Absorption};
use super::taps::{Kind, Way};
use super::update::Published;
use super::{EarlyEcho, Pose, SourceId, Update};
use crate::bands::{BAND_COUNT, Bands};
use crate::platform::Instant;
use glam::{DVec3, Quat, Vec3};
use rtrb::{Consumer, Producer};
use std::collections::HashMap;
use std::sync::Arc;

/// Maximum number of messages under way for each source.
pub(super) const MESSAGES_PER_SOURCE: usize = 4;

/// Voices beside those of the sources, for sources that fade out.
pub(super) const SPARE_VOICES: usize = 4;

/// Time in seconds in which a source fades in after its first trace.
const FIRST_FADE_S: f64 = 0.05;

/// Limits in seconds of the time in which taps glide: as long as since the last message.
const SHORTEST_GLIDE_S: f64 = 0.015;
const LONGEST_GLIDE_S: f64 = 0.2;

/// Least relative change of a decay time that changes the filters of the network, and least time in seconds between
/// two changes.
const LEAST_CHANGE: f64 = 0.02;
const CHANGE_EVERY_S: f64 = 0.2;

/// How much more energy a source must have than the weakest one that is heard, to take its place: 3 dB.
const REPLACES: f64 = 2.0;

/// Maximum number of sources that are replaced at once: one half of the voices that are left for sources that fade out.
const MOST_REPLACED: usize = SPARE_VOICES / 2;

/// The key of the direct way and of the way to the network.
const OWN_KEY: u64 = 0;

/// A message. The ears return it to be freed.
#[derive(Debug)]
pub(super) struct Message {
    pub id: SourceId,
    pub ways: Vec<Way>,
    /// Rotation of the listener.
    pub rotation: Quat,
    /// Number of samples in which the taps glide.
    pub glide: u32,
    /// Whether the source is removed or disabled.
    pub is_gone: bool,
    /// Other filters of the network.
    pub absorption: Option<Box<Absorption>>,
}

/// The last message about a source.
struct Told {
    traces: u64,
    /// The gains of its echoes.
    echoes: Vec<Frame>,
    update: Arc<Update>,
    turn: Quat,
    when: Instant,
}

/// The worker's end of the ears.
pub(super) struct Subscriber {
    pub rate_hz: u32,
    /// The only source that is heard; all sources without one.
    pub only: Option<SourceId>,
    /// Maximum number of sources.
    pub sources: usize,
    pub inbox: Producer<Box<Message>>,
    pub outbox: Consumer<Box<Message>>,
    fit: Fit,
    told: HashMap<SourceId, Told>,
    decay_s: Bands,
    changed: Option<Instant>,
    under_way: usize,
    /// Filters that no message could take yet.
    unsent: Option<Box<Absorption>>,
    /// Whether a message did not fit, because the ears take none at the moment.
    is_behind: bool,
}

impl Subscriber {
    pub fn new(
        (rate_hz, sources, only): (u32, usize, Option<SourceId>),
        (inbox, outbox): (Producer<Box<Message>>, Consumer<Box<Message>>),
    ) -> Subscriber {
        Subscriber {
            rate_hz,
            only,
            sources,
            inbox,
            outbox,
            fit: Fit::new(rate_hz),
            told: HashMap::new(),
            decay_s: [1.0; BAND_COUNT],
            changed: None,
            under_way: 0,
            unsent: None,
            is_behind: false,
        }
    }

    /// Whether the ears still exist.
    pub fn is_heard(&self) -> bool {
        !self.inbox.is_abandoned()
    }

    /// Whether a message did not fit. It must be sent again, also if nothing changes.
    pub fn is_behind(&self) -> bool {
        self.is_behind
    }

    /// Sends the changes.
    pub fn tell(&mut self, listener: &Pose, published: &Published) {
        self.is_behind = false;
        while self.outbox.pop().is_ok() {
            self.under_way -= 1;
        }
        if let Some(absorption) = self.next_absorption(published) {
            self.unsent = Some(absorption);
        }
        let heard = self.heard(published);
        let told: Vec<SourceId> = self.told.keys().copied().collect();
        for id in told.into_iter().filter(|id| !heard.contains(id)) {
            self.tell_gone(id, listener);
        }
        for id in heard {
            if let Some(update) = published.get(&id) {
                self.tell_update(id, update, listener);
            }
        }
    }

    /// The sources to be heard. If they are too many, those that were heard before stay, unless others are much louder.
    fn heard(&self, published: &Published) -> Vec<SourceId> {
        let is_chosen = |id: &SourceId| self.only.is_none_or(|only| only == *id);
        // Before the first trace, echoes and reverberation are missing.
        let mut all: Vec<(SourceId, bool, f64)> = published
            .iter()
            .filter(|(id, update)| is_chosen(id) && update.traces > 0)
            .map(|(id, update)| (*id, self.told.contains_key(id), update.energy()))
            .collect();
        all.sort_by(|(a_id, a_told, a), (b_id, b_told, b)| {
            (b_told.cmp(a_told))
                .then(b.total_cmp(a))
                .then(a_id.cmp(b_id))
        });
        let places = self.sources.min(all.len());
        let (heard, others) = all.split_at_mut(places);
        others.sort_by(|(a_id, _, a), (b_id, _, b)| b.total_cmp(a).then(a_id.cmp(b_id)));
        let weakest = heard.iter_mut().rev().take(MOST_REPLACED);
        for (weakest, loudest) in weakest.zip(others) {
            if weakest.1 && loudest.2 > REPLACES * weakest.2 {
                *weakest = *loudest;
            }
        }
        heard.iter().map(|(id, ..)| *id).collect()
    }

    fn tell_gone(&mut self, id: SourceId, listener: &Pose) {
        let message = Message {
            id,
            ways: Vec::new(),
            rotation: listener.rotation,
            glide: self.samples(FIRST_FADE_S),
            is_gone: true,
            absorption: None,
        };
        if self.send(message) {
            self.told.remove(&id);
        }
    }

    /// Sends a message, with the filters that no other message could take.
    fn send(&mut self, mut message: Message) -> bool {
        let has_room = self.under_way < self.sources * MESSAGES_PER_SOURCE;
        self.is_behind |= !has_room;
        if !has_room {
            return false;
        }
        message.absorption = self.unsent.take();
        // The ring has the same capacity.
        let is_sent = self.inbox.push(Box::new(message)).is_ok();
        self.under_way += usize::from(is_sent);
        is_sent
    }

    fn samples(&self, seconds: f64) -> u32 {
        ((seconds * f64::from(self.rate_hz)) as u32).max(1)
    }

    fn tell_update(&mut self, id: SourceId, update: &Arc<Update>, listener: &Pose) {
        let told = self.told.get(&id);
        let is_known = told.is_some_and(|told| {
            told.turn == listener.rotation
                && told.traces == update.traces
                && told.update.direct == update.direct
        });
        if is_known && self.unsent.is_none() {
            return;
        }
        let echoes = match told.filter(|told| told.traces == update.traces) {
            Some(told) => told.echoes.clone(),
            None => update
                .echoes
                .iter()
                .map(|echo| self.fit.gains(&echo.gain))
                .collect(),
        };
        let glide_s = told.map_or(FIRST_FADE_S, |told| {
            let since = told.when.elapsed().as_secs_f64();
            since.clamp(SHORTEST_GLIDE_S, LONGEST_GLIDE_S)
        });
        let message = Message {
            id,
            ways: self.ways(update, &echoes),
            rotation: listener.rotation,
            glide: self.samples(glide_s),
            is_gone: false,
            absorption: None,
        };
        if self.send(message) {
            let told = Told {
                traces: update.traces,
                echoes,
                update: Arc::clone(update),
                turn: listener.rotation,
                when: Instant::now(),
            };
            self.told.insert(id, told);
        }
    }

    /// The ways of a source: the direct one, its echoes, and the way to the network.
    fn ways(&self, update: &Update, echoes: &[Frame]) -> Vec<Way> {
        let way = |key, kind, from: Vec3, delay_s: f64, gains| Way {
            key,
            kind,
            from: from.as_dvec3(),
            delay: delay_s * f64::from(self.rate_hz),
            gains,
        };
        let direct = &update.direct;
        let gains = self.fit.gains(&direct.gain);
        let direct = way(OWN_KEY, Kind::Direct, direct.from, direct.delay_s, gains);
        let of_echo = |(echo, gains): (&EarlyEcho, &Frame)| {
            way(echo.key, Kind::Echo, echo.from, echo.delay_s, *gains)
        };
        let mut ways = vec![direct];
        ways.extend(update.echoes.iter().zip(echoes).map(of_echo));
        ways.push(self.late_way(update));
        ways
    }

    /// The way to the network: with the gains that give the late part its energy.
    fn late_way(&self, update: &Update) -> Way {
        let reverb = &update.reverb;
        let energy = network::energy(&self.decay_s);
        let gains: Bands = std::array::from_fn(|band| reverb.late_gain[band] / energy[band].sqrt());
        let delay_s = (reverb.late_s - network::FIRST_S).max(0.0);
        Way {
            key: OWN_KEY,
            kind: Kind::Late,
            from: DVec3::ZERO,
            delay: delay_s * f64::from(self.rate_hz),
            gains: self.fit.gains(&gains),
        }
    }

    /// Other filters of the network, if the mean decay of the late energy of all sources has changed.
    fn next_absorption(&mut self, published: &Published) -> Option<Box<Absorption>> {
        let is_soon = |when: Instant| when.elapsed().as_secs_f64() < CHANGE_EVERY_S;
        if self.changed.is_some_and(is_soon) {
            return None;
        }
        let mut next = self.decay_s;
        for (band, next) in next.iter_mut().enumerate() {
            let (mut weighted, mut weights) = (0.0, 0.0);
            for (id, update) in published {
                let energy = update.reverb.late_gain[band].powi(2);
                if self.only.is_none_or(|only| only == *id) && energy > 0.0 {
                    weighted += energy * update.reverb.decay_s[band];
                    weights += energy;
                }
            }
            if weights > 0.0 {
                *next = weighted / weights;
            }
        }
        let changes = next.iter().zip(&self.decay_s);
        let most = changes.map(|(next, now)| (next / now - 1.0).abs());
        if most.fold(0.0, f64::max) < LEAST_CHANGE {
            return None;
        }
        self.decay_s = next;
        self.changed = Some(Instant::now());
        Some(Box::new(Absorption::new(&next, self.rate_hz)))
    }
}
