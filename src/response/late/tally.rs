//! The tally of a listener: sums over the arrivals of all its waves. Further waves extend it.
//!
//! If waves start evenly, the waves of a round are further waves of the rounds before: the bins of the onset hold the
//! mean over all waves, the later bins the mean over the waves that are followed to the record's end. The waves of early
//! arrivals, which find exact paths, are extended in the same way.

use super::inner::{self, Difference};
use super::near::NearScattering;
use super::{Arrivals, Heard, LateSphere};
use crate::bands::BAND_COUNT;
use crate::response::source_sound::Medium;
use crate::response::{Arrival, Echogram, ResponseSettings};
use crate::tracer::{ArrivalCounts, Followed};
use std::ops::Range;

/// Numbers of waves for late arrivals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct WaveCounts {
    /// Number of waves that are followed to the record's end.
    followed: u32,
    /// Number of waves that are followed through the onset, including those.
    onset: u32,
}

/// The numbers of further waves.
pub(super) struct FurtherWaves {
    /// The waves of early arrivals.
    pub early: Range<u32>,
    /// The waves that are followed to the record's end.
    pub followed: Range<u32>,
    /// The waves that end after the onset.
    pub onset: Range<u32>,
}

impl WaveCounts {
    fn of(settings: &ResponseSettings) -> WaveCounts {
        WaveCounts {
            followed: settings.late_trace().waves,
            onset: settings.onset_waves(),
        }
    }

    /// The late waves beyond those of `before`. All of them pass through the onset, and at least as many as before are followed
    /// to the end.
    fn beyond(&self, before: WaveCounts) -> FurtherWaves {
        let ends = self.onset.max(before.onset);
        let followed = self.followed.saturating_sub(before.followed);
        let followed = followed.min(ends - before.onset);
        FurtherWaves {
            early: 0..0,
            followed: before.onset..before.onset + followed,
            onset: before.onset + followed..ends,
        }
    }

    /// The counts after further waves.
    fn and(self, further: &FurtherWaves) -> WaveCounts {
        WaveCounts {
            followed: self.followed + further.followed.len() as u32,
            onset: further.onset.end,
        }
    }
}

/// Kinds of arrivals that no exact path replaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// Arrivals that remain statistical.
    Late,
    /// Arrivals that have passed solids and were not reflected.
    Straight,
    /// Sound scattered after few reflections. It counts as late if the same waves trace early arrivals.
    Near,
}

/// Arrivals in one sphere.
#[derive(Clone)]
struct InSphere {
    late: Echogram,
    straight: Echogram,
    near: Option<Echogram>,
}

impl InSphere {
    fn add(&mut self, kind: Kind, medium: &Medium, arrival: &Arrival) {
        let to = match (kind, &mut self.near) {
            (Kind::Straight, _) => &mut self.straight,
            (Kind::Near, Some(near)) => near,
            _ => &mut self.late,
        };
        medium.add(to, arrival);
    }
}

/// Sums of arrivals that no exact path replaces.
#[derive(Clone)]
pub(super) struct Sums {
    wide: InSphere,
    /// Arrivals in the inner sphere, if the two spheres are compared.
    inner: Option<InSphere>,
}

impl Sums {
    /// No arrivals; `like` defines the bins.
    fn none(one: &Heard, like: &Echogram, has_near: bool) -> Sums {
        let wide = InSphere {
            late: like.without_arrivals(),
            straight: like.without_arrivals(),
            near: has_near.then(|| like.without_arrivals()),
        };
        Sums {
            inner: one.late.inner_m.map(|_| wide.clone()),
            wide,
        }
    }

    /// Adds an arrival.
    pub fn add(&mut self, kind: Kind, medium: &Medium, arrival: &Arrival) {
        self.wide.add(kind, medium, arrival);
        if let Some((inner, within)) = self.inner.as_mut().zip(inner::within(arrival)) {
            inner.add(kind, medium, &within);
        }
    }

    fn spheres(&self) -> impl Iterator<Item = &InSphere> {
        std::iter::once(&self.wide).chain(&self.inner)
    }

    fn spheres_mut(&mut self) -> impl Iterator<Item = &mut InSphere> {
        std::iter::once(&mut self.wide).chain(&mut self.inner)
    }

    fn echograms(&self) -> impl Iterator<Item = &Echogram> {
        self.spheres().flat_map(|sphere| {
            let always = [&sphere.late, &sphere.straight];
            always.into_iter().chain(&sphere.near)
        })
    }

    fn echograms_mut(&mut self) -> impl Iterator<Item = &mut Echogram> {
        self.spheres_mut().flat_map(|sphere| {
            let always = [&mut sphere.late, &mut sphere.straight];
            always.into_iter().chain(&mut sphere.near)
        })
    }

    /// Number of bins that end at this time in seconds, or earlier.
    pub fn bins_before(&self, seconds: f64) -> usize {
        self.wide.late.bins_before(seconds)
    }

    /// Scales the bins before `until` by `before`, and the later bins by `after`.
    fn scale_parts(&mut self, until: usize, before: f64, after: f64) {
        for echogram in self.echograms_mut() {
            echogram.scale_parts(until, before, after);
        }
    }

    /// Adds the arrivals of other waves at the same listener.
    fn add_sums(&mut self, others: &Sums) {
        for (own, other) in self.echograms_mut().zip(others.echograms()) {
            own.add_scaled(other, &[1.0; BAND_COUNT]);
        }
    }
}

/// The arrivals of the traced waves at one listener.
#[derive(Clone)]
pub(in crate::response) struct Tally {
    pub(super) sums: Sums,
    /// Sound scattered after few reflections, if other waves than those of late arrivals trace early arrivals.
    pub(super) near: Option<NearScattering>,
    /// Early arrivals, counted in the listener's own sphere.
    pub(in crate::response) early: Vec<Arrival>,
    /// The waves that are followed to the record's end, by band group.
    followed: Vec<Followed>,
    /// Whether waves continue after the maximum number of reflections of exact paths; `None` if unknown.
    pub(super) travel_on: Option<bool>,
    /// Mean crossings of the listener's own sphere per wave and iteration, from the waves of early arrivals.
    pub(super) crossings: f64,
    /// Number of the traced waves of early arrivals.
    early_waves: u32,
    /// Numbers of the traced late waves.
    waves: WaveCounts,
}

impl Tally {
    /// The tally of no waves; `echogram` defines the bins. `has_near` says whether other waves than those of late
    /// arrivals trace early arrivals.
    pub(super) fn none(one: &Heard, echogram: &Echogram, has_near: bool) -> Tally {
        Tally {
            sums: Sums::none(one, echogram, has_near),
            near: has_near.then(|| NearScattering::new(one.pair, echogram)),
            early: Vec::new(),
            followed: Vec::new(),
            travel_on: None,
            crossings: 0.0,
            early_waves: 0,
            waves: WaveCounts::default(),
        }
    }

    /// The waves of these settings that are not traced yet.
    pub(super) fn further(&self, settings: &ResponseSettings) -> FurtherWaves {
        let early = self.early_waves;
        FurtherWaves {
            early: early..settings.trace.waves.max(early),
            ..WaveCounts::of(settings).beyond(self.waves)
        }
    }

    /// Prepares the early arrivals for further waves: their energies become shares of the energy of all of them.
    pub(super) fn begin(&mut self, further: &FurtherWaves) {
        self.early_waves = further.early.end;
        if further.early.is_empty() {
            return;
        }
        let share = f64::from(further.early.start) / f64::from(further.early.end);
        for arrival in &mut self.early {
            arrival.energy = arrival.energy.map(|energy| energy * share);
        }
        if let Some(near) = &mut self.near {
            near.own.scale_parts(0, share, share);
        }
    }

    /// Sums without arrivals for further waves.
    pub(super) fn empty_sums(&self) -> Sums {
        let mut sums = self.sums.clone();
        let empty = |echogram: &mut Echogram| *echogram = echogram.without_arrivals();
        sums.echograms_mut().for_each(empty);
        sums
    }

    /// Adds the fates of further waves of a band group that are followed to the record's end.
    pub(super) fn add_counts(&mut self, group: usize, further: &Followed) {
        match self.followed.get_mut(group) {
            Some(followed) => *followed = std::mem::take(followed).and(further.clone()),
            None => self.followed.push(further.clone()),
        }
    }

    /// Adds the sums of further waves: of those that are followed to the record's end, and of those that end after the
    /// onset, the bins before `until`. Their energies are shares of the energy of all waves of the onset.
    pub(super) fn extend(
        &mut self,
        further: &FurtherWaves,
        until: usize,
        [mut followed, mut onset]: [Sums; 2],
    ) {
        let (before, after) = (self.waves, self.waves.and(further));
        let share = |part: u32, all: u32| f64::from(part) / f64::from(all);
        let of_onset = share(before.onset, after.onset);
        let of_followed = share(before.followed, after.followed);
        self.sums.scale_parts(until, of_onset, of_followed);
        followed.scale_parts(until, 1.0, share(after.onset, after.followed));
        onset.scale_parts(until, 1.0, 0.0);
        self.sums.add_sums(&followed);
        self.sums.add_sums(&onset);
        self.waves = after;
    }

    /// The late arrivals in this sphere, with the sound scattered after few reflections.
    pub fn arrivals(&self, late: &LateSphere) -> Arrivals {
        let Sums { wide, inner } = &self.sums;
        let (counted, other) = match inner {
            Some(inner) if late.is_narrowed => (inner, Some(wide)),
            other => (wide, other.as_ref()),
        };
        let mut echogram = counted.late.clone();
        let mut bias = echogram.without_arrivals();
        let mut in_own_sphere = echogram.without_arrivals();
        if let (Some(near), Some(of_sphere)) = (&self.near, &counted.near) {
            let sums = [&mut in_own_sphere, &mut echogram];
            near.add_to((of_sphere, late.counted_m()), sums, &mut bias);
        }
        let counts = self
            .followed
            .iter()
            .map(|followed| followed.clone().counts());
        Arrivals {
            echogram,
            in_own_sphere,
            straight: counted.straight.clone(),
            inner: other.map(|other| Difference {
                counted: counted.late.clone(),
                other: other.late.clone(),
            }),
            bias,
            counts: counts.fold(ArrivalCounts::of_none(), ArrivalCounts::and),
            travel_on: self.travel_on,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the rounds of an accuracy: the waves of all rounds have different numbers without gaps, and the
    /// waves that are followed to the end never outnumber those of the onset.
    #[test]
    fn further_waves_continue_the_numbers() {
        let counts = |followed, onset| WaveCounts { followed, onset };
        let first = counts(4, 16).beyond(WaveCounts::default());
        assert_eq!((first.followed, first.onset), (0..4, 4..16));
        let second = counts(8, 30).beyond(counts(4, 16));
        assert_eq!((second.followed, second.onset), (16..20, 20..30));
        let none = counts(4, 16).beyond(counts(4, 16));
        assert!(none.followed.is_empty() && none.onset.is_empty());
        let only_onset = counts(4, 20).beyond(counts(4, 16));
        assert_eq!((only_onset.followed, only_onset.onset), (16..16, 16..20));
        let limited = counts(12, 20).beyond(counts(4, 16));
        assert_eq!(
            (limited.followed.clone(), limited.onset.clone()),
            (16..20, 20..20)
        );
        assert_eq!(counts(4, 16).and(&limited), counts(8, 20));
    }
}
