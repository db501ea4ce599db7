//! Energy of late arrivals that the waves may have missed.

use super::ResponseSettings;
use super::medium::Medium;
use crate::acoustics::{Echogram, uncertain_energy};
use crate::bands::{BAND_COUNT, Bands};
use crate::error::Error;
use crate::scene::Scene;
use crate::trace::{ArrivalSettings, Tracer, WavesToFollow};
use std::f64::consts::PI;

/// Fewer waves give no estimate of what they have missed, however often each of them arrived.
const FEW_WAVES: u32 = 64;

/// The energy that the waves may have missed, by band, in 1/m², estimated from the number of arrivals. In a band
/// without arrivals, and with few waves, it is that of a wave without losses if any wave could still arrive, otherwise
/// 0.
pub(super) fn further_arrival(
    tracer: &mut Tracer,
    (scene, medium): (&Scene, &Medium),
    settings: &ResponseSettings,
    how: &ArrivalSettings,
    echogram: &Echogram,
) -> Result<Bands, Error> {
    let (total, mut further) = (echogram.total(), [0.0; BAND_COUNT]);
    for band in 0..BAND_COUNT {
        let arrivals = echogram.effective_arrivals(band, 0.0);
        further[band] = uncertain_energy(total[band], arrivals);
    }
    let waves = settings.late_trace().waves;
    let are_few = waves < FEW_WAVES;
    if !(are_few || further.contains(&0.0)) || !may_arrive(tracer, scene, settings, how)? {
        return Ok(further);
    }
    let cross_section_m2 = PI * f64::from(scene.listener.radius).powi(2);
    let whole = medium.level / (cross_section_m2 * f64::from(waves));
    Ok(further.map(|energy| match energy > 0.0 && !are_few {
        true => energy,
        false => energy.max(whole),
    }))
}

/// Whether waves travel on after the maximum number of reflections of exact paths, or after scattering before that.
fn may_arrive(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &ResponseSettings,
    how: &ArrivalSettings,
) -> Result<bool, Error> {
    let reflections = match scene.scatters() {
        true => 1,
        false => how.early_order + 1,
    };
    let few = how.clone().with_iterations(reflections);
    let all = WavesToFollow::Numbers(0..settings.trace.waves);
    let counts = tracer
        .arrivals_of(scene, &settings.trace, &few, &all, &mut |_| ())?
        .counts;
    // The other waves have left the scene, or have flown until the end of the record.
    Ok(counts.cut_off > 0)
}
