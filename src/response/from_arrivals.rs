//! The response of a listener, from the arrivals of all waves: exact paths take the place of early arrivals, and the
//! figures are computed.

use super::early_part::{Caught, EarlyPart, Search};
use super::exact_paths::EarlyPaths;
use super::hidden::Hidden;
use super::late::{self, Arrivals, Heard};
use super::source_sound::Medium;
use super::{
    Arrival, Echogram, Figures, HeardPath, Record, Response, ResponseSettings, direct, energy,
    least_level, taps_of_energy,
};
use crate::bands::{self, BAND_COUNT};
use crate::error::Error;
use crate::tracer::{ArrivalSettings, Settings, Tracer};
use glam::Vec3;

/// A response of a round.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Traced {
    pub response: Response,
    /// The arrivals in the listener's own sphere that no exact path replaces, a part of the response's echogram: the noise
    /// of the waves of early arrivals.
    pub in_own_sphere: Echogram,
    /// Whether the paths of all early arrivals were searched for. Otherwise more waves of early arrivals add no paths.
    pub is_search_complete: bool,
}

/// The start directions of all waves, computed when they are first needed.
#[derive(Default)]
pub(super) struct StartDirections(Vec<Vec3>);

impl StartDirections {
    /// The waves that arrived early, each once, in order of number, with their start directions.
    pub fn of_waves(
        &mut self,
        tracer: &mut Tracer,
        settings: &Settings,
        early: &[Arrival],
    ) -> Result<Vec<(u32, Vec3)>, Error> {
        if self.0.is_empty() && !early.is_empty() {
            self.0 = tracer.start_directions(settings)?;
        }
        let mut waves: Vec<u32> = early.iter().map(|arrival| arrival.wave).collect();
        waves.dedup();
        let start = |wave: u32| (wave, self.0[wave as usize]);
        Ok(waves.into_iter().map(start).collect())
    }
}

/// The response of a listener from its arrivals and the start directions of the waves that arrived early. `None` if the
/// figures are biased by the size of the sphere of late arrivals.
pub(super) fn response(
    tracer: &mut Tracer,
    heard: &Heard,
    (arrivals, starts): (Arrivals, Vec<(u32, Vec3)>),
    settings: &ResponseSettings,
    how: &ArrivalSettings,
) -> Result<Option<Traced>, Error> {
    let Heard { pair, medium, late } = *heard;
    let Arrivals {
        mut echogram,
        mut in_own_sphere,
        straight,
        inner,
        bias,
        counts,
        early,
        travel_on,
    } = arrivals;
    let seconds = how.seconds;
    let early_paths = EarlyPaths::new(pair)?;
    let search = Search {
        pair,
        paths: &early_paths,
        waves: settings.trace.waves,
        order: how.early_order,
        diffracts: settings.diffracts(),
    };
    let part = EarlyPart::find(&search, &starts, early);
    let is_search_complete = part.waves() == settings.trace.waves;
    let all_paths = part.heard(pair, medium);
    let is_hidden = direct(&all_paths).is_none();
    let mut paths = all_paths.clone();
    let hidden = Hidden::find(
        (pair, medium, &early_paths),
        settings,
        part.hidden_reflections(),
        &mut paths,
    );
    // Diffracted paths replace the waves that pass an edge and reach a part of the listener's sphere.
    let is_replaced = |arrival: &Arrival| arrival.reflections == 0 && hidden.is_bent();
    part.left_over(|reflection| hidden.is_reflection_bent(reflection))
        .filter(|arrival| !is_replaced(arrival))
        .for_each(|arrival| medium.add(&mut in_own_sphere, arrival));
    echogram.add_scaled(&in_own_sphere, &bands::ALL);
    // An exact path replaces the waves that pass solids in a straight line.
    if is_hidden && !hidden.replaces_straight_waves() {
        echogram.add_scaled(&straight, &[1.0; BAND_COUNT]);
    }
    let diffraction_milliseconds = hidden.diffraction_milliseconds();
    let further_reflections = hidden.further_reflections();
    paths.extend(hidden.into_paths());
    paths.sort_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
    let is_heard = |path: &HeardPath| path.energy.iter().any(|energy| *energy > 0.0);
    paths.retain(|path| path.delay_s <= seconds && is_heard(path));
    // If waves were given up, only the remaining waves contribute to the later decay.
    let followed_s = Some(counts.followed_m / medium.speed).filter(|until| *until < seconds);
    let ends_s = followed_s.unwrap_or(seconds);
    if settings.omits_figures {
        let response = Response {
            missed: part.missed(),
            left_out: part.left_out().count() as u64,
            left_out_share: left_out_share(&part, medium, &paths, &echogram),
            search_left_out_share: part.search_left_out_share(),
            paths,
            echogram,
            figures: Figures::omitted(),
            seconds,
            followed_s,
            counts,
            waves: settings.late_trace().waves,
            onset_waves: settings.onset_waves(),
            accuracy: None,
            milliseconds: 0.0,
            diffraction_milliseconds,
        };
        return Ok(Some(Traced {
            response,
            in_own_sphere,
            is_search_complete,
        }));
    }
    let taps = taps_of_energy(&paths);
    let record = Record::new(&taps, &echogram, ends_s);
    let direct_s = direct(&paths).map(|path| path.delay_s);
    let mut figures = Figures::new(&taps, &echogram, direct_s, ends_s);
    if let Some(common) = late.errors {
        figures = figures.with_common_errors(&common);
    }
    if let Some(inner) = &inner {
        let differences = inner.of_figures(&record, direct_s);
        if late::are_biased(&differences, late.accepted_bias) {
            return Ok(None);
        }
        figures = figures.with_bias(&differences);
    }
    if !further_reflections.is_empty() {
        let all = [&taps[..], &further_reflections].concat();
        figures = figures.with_differences(Record::new(&all, &echogram, ends_s), &bands::ALL);
    }
    // The bias is empty without scattering.
    if bias.bins() > 0 {
        let mut biased = echogram.clone();
        biased.add_scaled(&bias, &bands::ALL);
        figures = figures.with_differences(Record::new(&taps, &biased, ends_s), &bands::ALL);
    }
    let caught = Caught {
        pair,
        medium,
        part: &part,
        paths: &all_paths,
    };
    let figures = caught.in_errors(figures, &echogram, ends_s);
    let heard_in = (pair, medium);
    let further = late::further_arrival(tracer, heard_in, settings, how, &echogram, travel_on)?;
    let figures = figures.with_further_arrival(record, &further);
    let mut response = Response {
        missed: part.missed(),
        left_out: part.left_out().count() as u64,
        left_out_share: left_out_share(&part, medium, &paths, &echogram),
        search_left_out_share: part.search_left_out_share(),
        paths,
        echogram,
        figures,
        seconds,
        followed_s,
        counts,
        waves: settings.late_trace().waves,
        onset_waves: settings.onset_waves(),
        accuracy: None,
        milliseconds: 0.0,
        diffraction_milliseconds,
    };
    if let Some(least_db) = settings.least_level_db {
        least_level::raise(&mut response, pair, medium, least_db);
    }
    Ok(Some(Traced {
        response,
        in_own_sphere,
        is_search_complete,
    }))
}

/// The energy share of arrivals whose paths were not searched for.
fn left_out_share(
    part: &EarlyPart,
    medium: &Medium,
    paths: &[HeardPath],
    echogram: &Echogram,
) -> f64 {
    let left_out: f64 = part.left_out().map(|a| bands::mean(&medium.heard(a))).sum();
    if left_out > 0.0 {
        left_out / bands::mean(&energy(echogram, paths))
    } else {
        0.0
    }
}
