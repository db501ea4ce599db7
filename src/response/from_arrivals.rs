//! The response of a listener, from the arrivals of all waves: exact paths take the place of early arrivals, and the
//! figures are computed.

use super::early_part::EarlyPart;
use super::early_sound::EarlySound;
use super::late::{self, Arrivals, Heard};
use super::source_sound::Medium;
use super::{
    Echogram, Figures, HeardPath, Record, Response, ResponseSettings, direct, energy, least_level,
    taps_of_energy,
};
use crate::bands;
use crate::error::Error;
use crate::tracer::{ArrivalSettings, Tracer};

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

/// The response of a listener from its early sound and the arrivals of all waves. `None` if the figures are biased by the
/// size of the sphere of late arrivals.
pub(super) fn response(
    tracer: &mut Tracer,
    heard: &Heard,
    (early, arrivals): (&EarlySound, Arrivals),
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
        travel_on,
    } = arrivals;
    let seconds = how.seconds;
    let is_search_complete = early.is_search_complete();
    early.add_left_over(medium, &mut in_own_sphere);
    echogram.add_scaled(&in_own_sphere, &bands::ALL);
    if early.counts_straight() {
        echogram.add_scaled(&straight, &bands::ALL);
    }
    let diffraction_milliseconds = early.hidden.diffraction_milliseconds();
    let (part, paths) = (&early.caught.part, early.paths.clone());
    // If waves were given up, only the remaining waves contribute to the later decay.
    let followed_s = Some(counts.followed_m / medium.speed).filter(|until| *until < seconds);
    let ends_s = followed_s.unwrap_or(seconds);
    let figures = if settings.omits_figures {
        Figures::omitted()
    } else {
        let taps = taps_of_energy(&paths);
        let record = Record::new(&taps, &echogram, ends_s);
        let direct_s = direct(&paths).map(|path| path.delay_s);
        let mut figures = Figures::new(&taps, &echogram, direct_s, ends_s);
        if let Some(common) = late.errors {
            figures = figures.with_common_errors(&common);
        }
        // Few arrivals leave out figures by their noise. The errors below have other causes.
        let heard_in = (pair, medium);
        let further = late::further_arrival(tracer, heard_in, settings, how, &echogram, travel_on)?;
        figures = figures.with_further_arrival(Record::new(&taps, &echogram, ends_s), &further);
        if let Some(inner) = &inner {
            let bias = inner.bias(&late, &record, direct_s);
            if late::are_biased(&bias, late.accepted_bias) {
                return Ok(None);
            }
            figures = figures.with_bias(&bias);
        }
        let further_reflections = early.hidden.further_reflections();
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
        (early.caught).in_errors((pair, medium), figures, (&echogram, ends_s))
    };
    let mut response = Response {
        missed: part.missed(),
        left_out: part.left_out().count() as u64,
        left_out_share: left_out_share(part, medium, &paths, &echogram),
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
        ended: None,
        diffraction: settings.diffracts(),
        milliseconds: 0.0,
        diffraction_milliseconds,
    };
    least_level::raise(&mut response, pair, medium, settings);
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
