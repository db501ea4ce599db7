//! Late arrivals: waves followed to a sphere larger than the listener (`sphere.rs`), with more waves in important
//! directions (`importance.rs`).
//!
//! Sound scattered within the maximum number of reflections of exact paths is counted in both spheres
//! (`near.rs`).
//!
//! Late arrivals may come from fewer waves than the search for exact paths uses. Fewer waves only add noise to late
//! sound, while a path that no wave finds is missing. Further waves may follow (`tally.rs`), and some waves may end after
//! the onset (`onset.rs`).

mod early;
mod importance;
mod inner;
mod near;
mod onset;
mod pilot;
mod reach;
mod sphere;
mod tally;

pub(super) use onset::Onset;
pub(super) use sphere::{LEAST_ORDER, LateSphere, casts_shadows};
pub(super) use tally::Tally;

use super::source_sound::Medium;
use super::{ResponseSettings, transmission};
use crate::bands::{BAND_COUNT, Bands, greater};
use crate::error::Error;
use crate::geometry::ExactScene;
use crate::response::{Arrival, Echogram, uncertain_energy};
use crate::sampling::hash;
use crate::scene::{Pair, Scene};
use crate::shader::materials_met;
use crate::tracer::{
    self, ArrivalCounts, ArrivalSettings, Detector, Followed, Settings, SolidHit, Tracer,
    Transmitting, WavesToFollow,
};
use glam::Vec3;
use importance::Importance;
pub(super) use inner::{Difference, are_biased};
use pilot::Pilot;
use std::cell::RefCell;
use std::f64::consts::PI;
use std::ops::Range;
use tally::{FurtherWaves, Kind, Sums};

/// The share of the energy of all waves down to which waves are followed, −120 dB. A decay is audible over 60 dB, and
/// if the listener is in another room than the source, the decay may begin 60 dB lower. The limit saves time in bands
/// that decay fast and have their own waves.
const LEAST_ENERGY: f64 = 1e-12;

/// A pair whose listener shares the waves of the source with other listeners.
#[derive(Clone, Copy)]
pub(super) struct Heard<'a> {
    pub pair: Pair<'a>,
    pub medium: &'a Medium,
    /// The sphere in which late arrivals are counted.
    pub late: LateSphere,
}

/// The arrivals of all waves at one listener.
pub(super) struct Arrivals {
    /// Late arrivals.
    pub echogram: Echogram,
    /// Sound scattered after few reflections, in the listener's own sphere, by its weight.
    pub in_own_sphere: Echogram,
    /// Arrivals that have passed solids and were not reflected.
    pub straight: Echogram,
    /// The late arrivals in the sphere of late arrivals and in the inner sphere, if the two are compared.
    pub inner: Option<Difference>,
    /// The possible bias from the larger sphere alone: one standard deviation of the energy.
    pub bias: Echogram,
    pub counts: ArrivalCounts,
    /// Whether waves continue after the maximum number of reflections of exact paths; `None` if unknown.
    pub travel_on: Option<bool>,
}

/// Traces the waves past all listeners, which have one source, and adds their arrivals to the tallies `before`; without
/// these, all waves are traced. A tally can only be extended by settings with an onset, and the same other settings.
pub(super) fn tallies(
    tracer: &mut Tracer,
    heard: &[Heard],
    settings: &ResponseSettings,
    how: &ArrivalSettings,
    before: Option<Vec<Tally>>,
) -> Result<Vec<Tally>, Error> {
    let Some(first) = heard.first() else {
        return Ok(Vec::new());
    };
    let are_own = heard.iter().all(|one| !one.is_widened());
    let is_same = settings.late_trace() == settings.trace && settings.onset.is_none();
    let scene = first.pair.scene;
    let early_groups = tracer::early_band_groups(scene, how.early_order);
    let late_groups = tracer::resampled_band_groups(scene);
    let has_near = before.is_some() || !(are_own && is_same && early_groups == late_groups);
    let mut tallies = match before {
        Some(before) => before,
        None => empty(heard, settings, has_near)?,
    };
    // All listeners have the same waves.
    let further = tallies[0].further(settings);
    tallies.iter_mut().for_each(|tally| tally.begin(&further));
    let solids = transmission::solids(first.pair, settings)?;
    let mut added = Added::none(&tallies);
    let wide = |one: &Heard| one.late.detector(one.pair.listener);
    let detectors: Vec<Detector> = heard.iter().map(wide).collect();
    if has_near {
        let traced = (&early_groups[..], further.early.clone());
        early::trace(tracer, heard, traced, (settings, how), &mut tallies)?;
    }
    for (group, bands) in late_groups.into_iter().enumerate() {
        let how = how.clone().with_bands(bands);
        let mut how = ArrivalSettings {
            resamples: true,
            ..how.with_least_energy(LEAST_ENERGY)
        };
        if has_near {
            how.iterations_in_chunk = early::chunk(heard, &tallies, &how);
        }
        let mut early = vec![Vec::new(); heard.len()];
        let mut late = LateWaves {
            tracer,
            heard,
            detectors: &detectors,
            how: &how,
            solids: solids.as_ref(),
            sums: &mut added.followed,
            early: (!has_near).then_some(&mut early[..]),
        };
        let followed = late.trace(settings, &further, &mut added.ends_early)?;
        for (tally, early) in tallies.iter_mut().zip(early) {
            tally.add_counts(group, &followed);
            tally.early.extend(early);
        }
    }
    for tally in &mut tallies {
        early::sort(&mut tally.early);
    }
    let onset_s = settings.onset.map_or(0.0, |onset| onset.seconds);
    for ((tally, one), sums) in tallies.iter_mut().zip(heard).zip(added.of_listeners()) {
        let until = tally.sums.bins_before(one.medium.direct_s + onset_s);
        tally.extend(&further, until, sums);
    }
    Ok(tallies)
}

/// The sums of further waves.
struct Added {
    /// The waves that are followed to the record's end, by listener.
    followed: Vec<Sums>,
    /// The waves that end after the onset, by listener.
    ends_early: Vec<Sums>,
}

impl Added {
    fn none(tallies: &[Tally]) -> Added {
        let followed: Vec<Sums> = tallies.iter().map(Tally::empty_sums).collect();
        Added {
            ends_early: followed.clone(),
            followed,
        }
    }

    fn of_listeners(self) -> impl Iterator<Item = [Sums; 2]> {
        let pairs = self.followed.into_iter().zip(self.ends_early);
        pairs.map(|(followed, ends_early)| [followed, ends_early])
    }
}

/// The tallies of no waves.
fn empty(
    heard: &[Heard],
    settings: &ResponseSettings,
    has_near: bool,
) -> Result<Vec<Tally>, Error> {
    let tally = |one: &Heard| {
        // Bins begin at the earliest possible arrival, so that the times 50 and 80 ms after this arrival lie on edges
        // of bins.
        let begins_s = one.medium.direct_s;
        let bins = Echogram::with_edge_at(begins_s, settings.bin_s, settings.batches)?;
        Ok(Tally::none(one, &bins, has_near))
    };
    heard.iter().map(tally).collect()
}

/// Waves whose late arrivals are added to the echograms of the listeners.
struct LateWaves<'a> {
    tracer: &'a mut Tracer,
    heard: &'a [Heard<'a>],
    detectors: &'a [Detector],
    how: &'a ArrivalSettings,
    /// The solids that waves may pass; `None` without transmission.
    solids: Option<&'a ExactScene>,
    sums: &'a mut [Sums],
    /// Early arrivals, if these waves trace them too.
    early: Option<&'a mut [Vec<Arrival>]>,
}

impl LateWaves<'_> {
    /// Traces the waves with these settings. `further` are the numbers of waves that start evenly, if there is an onset;
    /// those that end after it are added to `ends_early`.
    fn trace(
        &mut self,
        settings: &ResponseSettings,
        further: &FurtherWaves,
        ends_early: &mut [Sums],
    ) -> Result<Followed, Error> {
        let trace = settings.late_trace();
        let Some(onset) = settings.onset else {
            return self.follow_all(&trace, settings.batches);
        };
        // The energies are shares of the energy of all waves of the onset.
        let trace = trace.with_waves(further.onset.end);
        let numbers = WavesToFollow::Numbers(further.followed.clone());
        let mut followed = self.follow(&trace, &numbers, None)?;
        let mut ending = LateWaves {
            tracer: &mut *self.tracer,
            heard: self.heard,
            detectors: self.detectors,
            how: &onset.settings(self.heard, self.how),
            solids: self.solids,
            sums: ends_early,
            early: None,
        };
        let numbers = WavesToFollow::Numbers(further.onset.clone());
        let ended = ending.follow(&trace, &numbers, None)?;
        followed.counts.step_limit_reached += ended.counts.step_limit_reached;
        Ok(followed)
    }

    /// Traces all waves. If these waves also trace early arrivals, the settings determine their directions.
    fn follow_all(&mut self, trace: &Settings, batches: usize) -> Result<Followed, Error> {
        if self.early.is_some() {
            return self.follow(trace, &WavesToFollow::Numbers(0..trace.waves), None);
        }
        // Surfaces that focus sound spread waves of one direction, so pilot waves predict little in such scenes.
        let pilot_waves = match self.heard.iter().any(Heard::is_widened) {
            true => importance::pilot_waves(self.heard[0].pair.scene, &self.how.bands, trace),
            false => 0,
        };
        self.follow_after_pilot(trace, pilot_waves, batches)
    }

    /// Traces all waves. The first waves, the pilot waves, decide whether the other waves start evenly.
    fn follow_after_pilot(
        &mut self,
        trace: &Settings,
        pilot_waves: u32,
        batches: usize,
    ) -> Result<Followed, Error> {
        if pilot_waves == 0 {
            return self.follow_without_pilot(trace, batches);
        }
        let before = self.sums.to_vec();
        let half = pilot_waves / 2;
        let mut pilot = Pilot::new(pilot_waves, self.how.seconds);
        pilot.begin(half);
        let first = self.follow(trace, &WavesToFollow::Numbers(0..half), Some(&mut pilot))?;
        let directions = self
            .tracer
            .start_directions(&trace.clone().with_waves(half))?;
        let Some(importance) = Importance::of(&pilot, &directions, trace.waves) else {
            let numbers = WavesToFollow::Numbers(half..trace.waves);
            return Ok(first.and(self.follow(trace, &numbers, None)?));
        };
        let importance = self.refined(trace, &importance, (pilot, directions), batches)?;
        self.sums.clone_from_slice(&before);
        let waves = trace.waves - pilot_waves;
        let trace = reseeded(trace, DRAWN);
        let of = |numbers| importance.starts(numbers, waves, batches, trace.seed);
        self.follow(&trace, &WavesToFollow::Starts { waves, of: &of }, None)
    }

    /// Traces all waves. Their starts are drawn by the directivity of the source if the source radiates in a narrow
    /// lobe. Otherwise they are even.
    fn follow_without_pilot(
        &mut self,
        trace: &Settings,
        batches: usize,
    ) -> Result<Followed, Error> {
        let waves = trace.waves;
        let source = self.heard[0].pair.source;
        let Some(importance) = Importance::of_source(source, &self.how.bands, trace) else {
            return self.follow(trace, &WavesToFollow::Numbers(0..waves), None);
        };
        let of = |numbers| importance.starts(numbers, waves, batches, trace.seed);
        self.follow(trace, &WavesToFollow::Starts { waves, of: &of }, None)
    }

    /// Follows the second half of the pilot waves. It has as many waves as the first half, which started in
    /// `directions`.
    fn refined(
        &mut self,
        trace: &Settings,
        importance: &Importance,
        (mut pilot, mut directions): (Pilot, Vec<Vec3>),
        batches: usize,
    ) -> Result<Importance, Error> {
        let half = directions.len() as u32;
        let trace = reseeded(trace, SECOND_HALF);
        let mut starts = importance.starts(0..half, half, batches, trace.seed);
        // The energies of the first half are shares of the energy of all waves. The second half uses the same scale.
        let share = half as f32 / trace.waves as f32;
        starts.iter_mut().for_each(|start| start.weight *= share);
        directions.extend(starts.iter().map(|start| start.direction));
        pilot.begin(half);
        let of =
            |numbers: Range<u32>| starts[numbers.start as usize..numbers.end as usize].to_vec();
        let drawn = WavesToFollow::Starts {
            waves: half,
            of: &of,
        };
        self.follow(&trace, &drawn, Some(&mut pilot))?;
        Ok(Importance::refined(&pilot, &directions))
    }

    fn follow(
        &mut self,
        trace: &Settings,
        waves: &WavesToFollow,
        pilot: Option<&mut Pilot>,
    ) -> Result<Followed, Error> {
        let (pair, heard, solids) = (self.heard[0].pair, self.heard, self.solids);
        let early_order = self.how.early_order;
        let late = RefCell::new((&mut *self.sums, pilot));
        let mut early = self.early.as_deref_mut();
        let add = |arrival: &Arrival, kind: Kind| {
            let (sums, pilot) = &mut *late.borrow_mut();
            let of = arrival.detector as usize;
            let medium = heard[of].medium;
            sums[of].add(kind, medium, arrival);
            if let Some(pilot) = pilot.as_mut().filter(|_| kind == Kind::Late) {
                let seconds = arrival.length_m / medium.speed;
                pilot.add(arrival.wave, seconds, &medium.heard(arrival));
            }
        };
        let mut take = |arrival: Arrival| {
            match (arrival.is_early, &mut early) {
                (true, Some(early)) => return early[arrival.detector as usize].push(arrival),
                (true, None) => return,
                _ => (),
            }
            match arrival.reflections <= early_order {
                true => add(&arrival, Kind::Near),
                false => add(&arrival, Kind::Late),
            }
        };
        let through = |hit: &SolidHit| transmission::of_wave(pair.scene, solids?, hit);
        let mut passed = |arrival: Arrival| match arrival.reflections {
            0 => add(&arrival, Kind::Straight),
            _ => add(&arrival, Kind::Late),
        };
        let passing = solids.is_some().then_some(Transmitting {
            through: &through,
            take: &mut passed,
        });
        let heard_in = (pair, self.detectors);
        self.tracer
            .arrivals_through(heard_in, trace, self.how, waves, &mut take, passing)
    }
}

/// The sets of waves whose starts are drawn by importance: the second half of the pilot waves, and the waves after them.
/// They and the first half of the pilot waves number their waves from 0.
const SECOND_HALF: u64 = 1;
const DRAWN: u64 = 2;

/// The settings with a seed for this set of waves, so that scattering in different sets is independent.
fn reseeded(trace: &Settings, set: u64) -> Settings {
    let seed = hash(set << u32::BITS | u64::from(trace.seed));
    trace.clone().with_seed(seed as u32)
}

impl Heard<'_> {
    /// Whether the sphere of late arrivals is larger than the listener.
    fn is_widened(&self) -> bool {
        self.late.radius_m > self.pair.listener.radius
    }
}

/// Number of waves below which the missed energy of a band is at least the energy of one reflected wave.
const FEW_WAVES: u32 = 64;

/// The energy that the waves may have missed, by band, in 1/m², estimated from the number of arrivals. In a band
/// without arrivals, or with fewer than [`FEW_WAVES`] waves, it is at least the energy of a wave with one reflection at
/// the surface that absorbs the least, if any wave could still arrive. `travel_on` is [`Arrivals::travel_on`]; if it is
/// `None`, waves are traced again.
pub(super) fn further_arrival(
    tracer: &mut Tracer,
    (pair, medium): (Pair, &Medium),
    settings: &ResponseSettings,
    how: &ArrivalSettings,
    echogram: &Echogram,
    travel_on: Option<bool>,
) -> Result<Bands, Error> {
    let (total, mut further) = (echogram.total(), [0.0; BAND_COUNT]);
    for band in 0..BAND_COUNT {
        let arrivals = echogram.effective_arrivals(band, 0.0);
        further[band] = uncertain_energy(total[band], arrivals);
    }
    let waves = settings.late_trace().waves;
    let are_few = waves < FEW_WAVES;
    if !(are_few || further.contains(&0.0)) {
        return Ok(further);
    }
    let may_arrive = match travel_on {
        Some(travel_on) => travel_on,
        None => may_arrive(tracer, pair, settings, how)?,
    };
    if !may_arrive {
        return Ok(further);
    }
    let cross_section_m2 = PI * f64::from(pair.listener.radius).powi(2);
    let whole = medium.level / (cross_section_m2 * f64::from(waves));
    let greatest = pair.source.directivity.greatest_factor();
    let reflected = greatest_reflectance(pair.scene);
    Ok(std::array::from_fn(|band| {
        match further[band] > 0.0 && !are_few {
            true => further[band],
            false => further[band].max(whole * greatest[band] * reflected[band]),
        }
    }))
}

/// The greatest share of the energy that a reflection in the scene keeps, by band.
fn greatest_reflectance(scene: &Scene) -> Bands {
    let all = materials_met(scene).map(|material| material.reflectance());
    all.fold([0.0; BAND_COUNT], greater)
}

/// Whether waves continue after the maximum number of reflections of exact paths, or after scattering before that.
fn may_arrive(
    tracer: &mut Tracer,
    pair: Pair,
    settings: &ResponseSettings,
    how: &ArrivalSettings,
) -> Result<bool, Error> {
    let reflections = match pair.scene.scatters() {
        true => 1,
        false => how.early_order + 1,
    };
    let few = how.clone().with_iterations(reflections);
    let all = WavesToFollow::Numbers(0..settings.trace.waves);
    let counts = tracer
        .arrivals_of(pair, &settings.trace, &few, &all, &mut |_| ())?
        .counts;
    // The other waves have left the scene, or have flown until the end of the record.
    Ok(counts.cut_off > 0)
}
