//! The default length of a response.

use super::late_sphere::{LEAST_ORDER, LateSphere};
use super::medium::Medium;
use crate::acoustics::MAX_SECONDS;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::scene::Scene;
use crate::trace::{ArrivalSettings, Settings, Tracer};

/// Waves that estimate the decay: their energies, not their number, decide, and a thousand of
/// them give the time within some per cent.
const WAVES: u32 = 4096;

/// The shortest, in seconds: one block of a sound.
const SHORTEST_S: f64 = 0.1;

/// The share of the energy that may be left: 60 dB, the definition of the reverberation time.
const LEFT: f64 = 1e-6;

/// The share of their energy until which the waves are followed. What comes after it is at most a thousandth of
/// what may be left, where the listener hears its share of it.
const LEAST_ENERGY: f64 = 1e-3 * LEFT;

/// Bins of time in which the decay is looked at, in seconds.
const BIN_S: f64 = 0.01;

/// Seconds after which the energy still to come is at most [`LEFT`] of all, in every band; `longest_s` at most, but
/// no less than the direct sound takes.
pub(super) fn needed(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    longest_s: f64,
) -> Result<f64, Error> {
    let medium = Medium::of(scene);
    let mut bins: Vec<Bands> = Vec::new();
    let few = settings.clone().with_waves(WAVES);
    // More of the few waves that carry the end of the decay cross the larger sphere.
    let wide = LateSphere::of(scene, LEAST_ORDER).widened(scene);
    tracer.arrivals(
        &wide,
        &few,
        &ArrivalSettings::new(longest_s).with_least_energy(LEAST_ENERGY),
        &mut |arrival| {
            let bin = (arrival.length_m / medium.speed / BIN_S) as usize;
            if bin >= bins.len() {
                bins.resize(bin + 1, [0.0; BAND_COUNT]);
            }
            let energy = bands::through_air(&arrival.energy, &medium.air, arrival.length_m);
            bands::add(&mut bins[bin], &energy);
        },
    )?;
    // Few waves may miss a small or distant listener.
    Ok(end(&bins)
        .min(longest_s)
        .max(medium.direct_s + SHORTEST_S)
        .min(MAX_SECONDS))
}

/// The end of the last bin before which some band has more than [`LEFT`] to come.
fn end(bins: &[Bands]) -> f64 {
    let mut all = [0.0; BAND_COUNT];
    for bin in bins {
        bands::add(&mut all, bin);
    }
    let mut to_come = [0.0; BAND_COUNT];
    for (index, bin) in bins.iter().enumerate().rev() {
        bands::add(&mut to_come, bin);
        if (0..BAND_COUNT).any(|band| to_come[band] > LEFT * all[band]) {
            return ((index + 1) as f64 * BIN_S).max(SHORTEST_S);
        }
    }
    SHORTEST_S
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the length of a response: the slowest band decides, and silence is short.
    #[test]
    fn the_slowest_band_decides() {
        let decay =
            |seconds: f64| move |bin: usize| 10_f64.powf(-6.0 * bin as f64 * BIN_S / seconds);
        let (fast, slow) = (decay(0.5), decay(2.0));
        let bins: Vec<Bands> = (0..1000)
            .map(|bin| {
                let mut bands = [fast(bin); BAND_COUNT];
                bands[2] = slow(bin);
                bands
            })
            .collect();
        assert!((end(&bins) - 2.0).abs() <= 2.0 * BIN_S, "{}", end(&bins));
        assert_eq!(end(&[]), SHORTEST_S);
    }
}
