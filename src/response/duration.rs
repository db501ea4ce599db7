//! The default length of a response.

use super::late::{LEAST_ORDER, LateSphere};
use super::source_sound::Medium;
use super::{Arrival, ImpulseSettings, ResponseSettings, transmission};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::scene::{IntoPair, Pair};
use crate::shader::Materials;
use crate::tracer::{
    self, ArrivalCounts, ArrivalSettings, Detector, SolidHit, Tracer, Transmitting, WavesToFollow,
};
use std::cell::RefCell;

/// Number of waves for the estimate of the decay. Their energies determine the end of the decay, and a thousand waves
/// give its time to within some per cent.
const WAVES: u32 = 4096;

/// Numbers of waves in bands that no surface scatters, and in bands that surfaces scatter. The latter are resampled, and
/// their number stays the same along the decay: the level at its end, −60 dB after some 50 resamplings, has a standard
/// deviation of 2 dB.
const FEW_WAVES: [u32; 2] = [WAVES, WAVES / 16];

/// Numbers of waves if too few of these arrive late.
const MORE_WAVES: [u32; 2] = [WAVES, WAVES / 4];

/// Number of waves if most waves leave the scene and few arrive late, as outdoors. A wave that leaves the scene takes
/// almost no time.
const WAVES_OUTDOORS: u32 = 64 * WAVES;

/// Number of waves if few waves arrive late and most waves stay in the scene, as between two infinite walls.
const WAVES_BETWEEN: u32 = 8 * WAVES;

/// The shortest response in seconds: one block of a sound.
const SHORTEST_S: f64 = 0.1;

/// Share of the energy that may remain after the end: −60 dB, the definition of the reverberation time.
const LEFT: f64 = 1e-6;

/// Share of its energy down to which a wave is followed. The ignored energy is at most a thousandth of the share that
/// may remain, if the listener receives a proportional part of it.
const LEAST_ENERGY: f64 = 1e-3 * LEFT;

/// The end of a decay counts as known if at least [`LEAST_LATE`] waves arrive during the last part of the decay, which
/// holds this share of the energy (−40 dB). The time of the last 20 dB is then accurate to about 20 per cent.
const LATE: f64 = 1e-4;
const LEAST_LATE: usize = 16;

/// With fewer late arrivals, the record is extended until the time in which waves arrived is this share of it, because
/// these waves missed later sound. Figures need a record whose second half is weaker than the first.
const SEEN: f64 = 1.0 / 3.0;

/// The length in seconds after the direct sound for a scene that neither absorbs sound nor lets waves leave. The decay
/// of such a scene exceeds any length, and a longer record would repeat itself. The value equals the default longest
/// response in `auralisation`.
const WITHOUT_DECAY_S: f64 = 3.0;

/// Length of the time bins of the decay, in seconds.
const BIN_S: f64 = 0.01;

impl ResponseSettings {
    /// The length of the response of this pair: `seconds` if present. Otherwise it is the time until the energy of
    /// every band has fallen by 60 dB, as estimated with a few waves, but at most `longest_s`. The length is never less
    /// than the time of the direct sound.
    ///
    /// # Errors
    /// The errors of [`Response::trace`](super::Response::trace).
    pub fn seconds_needed<'a>(
        &self,
        tracer: &mut Tracer,
        pair: impl IntoPair<'a>,
    ) -> Result<f64, Error> {
        let pair = pair.chosen()?;
        self.validate()?;
        self.seconds_of_pairs(tracer, &[pair])
    }

    /// The greatest length of the responses of pairs with one source, at most [`Tracer::most_detectors`] of them.
    pub(super) fn seconds_of_pairs(
        &self,
        tracer: &mut Tracer,
        pairs: &[Pair],
    ) -> Result<f64, Error> {
        match self.seconds {
            Some(seconds) => Ok(seconds),
            None => needed(tracer, pairs, self),
        }
    }
}

/// Returns the time in seconds after which at most [`LEFT`] of all energy remains in every band, as estimated by waves:
/// the greatest of all pairs. It is at most the longest time of the settings, but at least the time of the direct sound.
fn needed(tracer: &mut Tracer, pairs: &[Pair], settings: &ResponseSettings) -> Result<f64, Error> {
    let (mut decays, mut counts) = Decay::trace(tracer, pairs, settings, FEW_WAVES)?;
    let never_ends = |pair: &Pair, counts: &ArrivalCounts| {
        counts.gone == 0 && pair.scene.air.is_none() && !pair.scene.has_materials()
    };
    let is_unknown =
        |decay: &Decay| !decay.is_end_known() && decay.end_s() + BIN_S < settings.longest_s;
    // If the record already has the maximum length, more waves change nothing.
    let is_open = |decays: &[Decay], counts: &ArrivalCounts| {
        let ends = |pair: &Pair| !never_ends(pair, counts);
        pairs.iter().all(ends) && decays.iter().any(is_unknown)
    };
    if pairs[0].scene.scatters() && !most_leave(&counts) && is_open(&decays, &counts) {
        (decays, counts) = Decay::trace(tracer, pairs, settings, MORE_WAVES)?;
    }
    if is_open(&decays, &counts) {
        let more = match most_leave(&counts) {
            true => WAVES_OUTDOORS,
            false => WAVES_BETWEEN,
        };
        (decays, _) = Decay::trace(tracer, pairs, settings, [more; 2])?;
    }
    let of_pair = |(pair, decay): (&Pair, &Decay)| {
        let direct_s = Medium::of(*pair).direct_s;
        let end_s = match (never_ends(pair, &counts), decay.is_end_known()) {
            (true, _) => direct_s + WITHOUT_DECAY_S,
            (false, true) => decay.end_s(),
            (false, false) => decay.end_s().max(decay.end_unseen_s(direct_s)),
        };
        // Waves may miss a small or distant listener.
        end_s.min(settings.longest_s).max(direct_s + SHORTEST_S)
    };
    let longest = pairs.iter().zip(&decays).map(of_pair).fold(0.0, f64::max);
    Ok(longest.min(ImpulseSettings::MAX_SECONDS))
}

/// Whether most waves leave the scene.
fn most_leave(counts: &ArrivalCounts) -> bool {
    2 * counts.gone > counts.waves
}

/// Energies and counts of arrivals over time.
#[derive(Default)]
struct Decay {
    /// Energies in bins of [`BIN_S`].
    bins: Vec<Bands>,
    /// Number of arrivals with energy in each bin, by band: bands that scatter differently have their own waves.
    arrivals: Vec<[usize; BAND_COUNT]>,
}

impl Decay {
    /// The decays at the listeners of these pairs, by the given numbers of waves in bands without and with scattering.
    fn trace(
        tracer: &mut Tracer,
        pairs: &[Pair],
        settings: &ResponseSettings,
        [waves, scattered]: [u32; 2],
    ) -> Result<(Vec<Decay>, ArrivalCounts), Error> {
        let pair = pairs[0];
        let medium = Medium::of(pair);
        // More of the few waves that carry the end of the decay cross the larger sphere.
        let wide = |pair: &Pair| {
            let sphere = LateSphere::for_settings(*pair, LEAST_ORDER, settings);
            sphere.detector(pair.listener)
        };
        let detectors: Vec<Detector> = pairs.iter().map(wide).collect();
        let solids = transmission::solids(pair, settings)?;
        let through = |hit: &SolidHit| transmission::of_wave(pair.scene, solids.as_ref()?, hit);
        let mut decays = Vec::new();
        decays.resize_with(pairs.len(), Decay::default);
        let decays = RefCell::new(decays);
        let add = |arrival: Arrival| {
            let energy = bands::through_air(&arrival.energy, &medium.air, arrival.length_m);
            let seconds = arrival.length_m / medium.speed;
            decays.borrow_mut()[arrival.detector as usize].add(seconds, &energy);
        };
        let how = ArrivalSettings::new(settings.longest_s).with_least_energy(LEAST_ENERGY);
        let mut counts = ArrivalCounts::of_none();
        for bands in tracer::resampled_band_groups(pair.scene) {
            let is_scattered = Materials::of(pair.scene, bands.clone()).scatter();
            let waves = if is_scattered { scattered } else { waves };
            let trace = settings.trace.clone().with_waves(waves);
            let all = WavesToFollow::Numbers(0..waves);
            let how = ArrivalSettings {
                resamples: true,
                ..how.clone().with_bands(bands)
            };
            let (mut take, mut passed) = (add, add);
            let passing = solids.is_some().then_some(Transmitting {
                through: &through,
                take: &mut passed,
            });
            let heard = (pair, &detectors[..]);
            let followed =
                tracer.arrivals_through(heard, &trace, &how, &all, &mut take, passing)?;
            counts = counts.and(followed.counts());
        }
        Ok((decays.into_inner(), counts))
    }

    fn add(&mut self, seconds: f64, energy: &Bands) {
        let bin = (seconds / BIN_S) as usize;
        if bin >= self.bins.len() {
            self.bins.resize(bin + 1, [0.0; BAND_COUNT]);
            self.arrivals.resize(bin + 1, [0; BAND_COUNT]);
        }
        bands::add(&mut self.bins[bin], energy);
        for (arrivals, energy) in self.arrivals[bin].iter_mut().zip(energy) {
            *arrivals += usize::from(*energy > 0.0);
        }
    }

    /// Number of bins after which at most `share` of the energy remains in every band, and the band that decays last.
    fn bins_until(&self, share: f64) -> (usize, usize) {
        let all = bands::sum(&self.bins);
        let mut to_come = [0.0; BAND_COUNT];
        for (index, bin) in self.bins.iter().enumerate().rev() {
            bands::add(&mut to_come, bin);
            let last = (0..BAND_COUNT).find(|band| to_come[*band] > share * all[*band]);
            if let Some(band) = last {
                return (index + 1, band);
            }
        }
        (0, 0)
    }

    /// Whether enough waves of the band that decays last arrive at the end of the decay.
    fn is_end_known(&self) -> bool {
        let (bins, band) = self.bins_until(LATE);
        let late = self.arrivals[bins..].iter().map(|of_bin| of_bin[band]);
        late.sum::<usize>() >= LEAST_LATE
    }

    /// The end in seconds of the last bin before at most [`LEFT`] of the energy remains in every band.
    fn end_s(&self) -> f64 {
        (self.bins_until(LEFT).0 as f64 * BIN_S).max(SHORTEST_S)
    }

    /// The end in seconds of a record with too few late arrivals: the time in which waves arrived after the direct
    /// sound is the share [`SEEN`] of the record.
    fn end_unseen_s(&self, direct_s: f64) -> f64 {
        let seen_s = (self.bins.len() as f64 * BIN_S - direct_s).max(0.0);
        direct_s + seen_s / SEEN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::gl::{Context, ContextOptions};
    use crate::response::{Response, ResponseSettings};

    /// Protects the length of a response: the slowest band decides, and silence has a short response.
    #[test]
    fn the_slowest_band_decides() {
        let energy =
            |seconds: f64| move |bin: usize| 10_f64.powf(-6.0 * bin as f64 * BIN_S / seconds);
        let (fast, slow) = (energy(0.5), energy(2.0));
        let mut decay = Decay::default();
        for bin in 0..1000 {
            let mut bands = [fast(bin); BAND_COUNT];
            bands[2] = slow(bin);
            decay.add((bin as f64 + 0.5) * BIN_S, &bands);
        }
        let end_s = decay.end_s();
        assert!((end_s - 2.0).abs() <= 2.0 * BIN_S, "{end_s}");
        assert!(decay.is_end_known());
        assert_eq!(Decay::default().end_s(), SHORTEST_S);
    }

    /// Protects decays carried by few waves: the decay does not end with the last observed wave.
    #[test]
    fn few_late_waves_do_not_end_a_decay() {
        let mut decay = Decay::default();
        for bin in 1..40 {
            decay.add(
                f64::from(bin) * BIN_S + 0.001,
                &[0.8_f64.powi(bin); BAND_COUNT],
            );
        }
        assert!(!decay.is_end_known());
        assert!((decay.end_unseen_s(0.1) - 1.0).abs() < 1e-9);
        assert!(!Decay::default().is_end_known());
        assert_eq!(Decay::default().end_unseen_s(0.1), 0.1);
    }

    /// Protects the computing time of a scene without a decay: its record is short. The record of a scene from which
    /// sound escapes is not shortened.
    #[test]
    fn what_never_decays_is_not_recorded_for_long() {
        let mut tracer =
            Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
        let mut needed = |scene: &Scene, longest_s: f64| {
            let settings = ResponseSettings::default().with_longest(longest_s);
            settings.seconds_needed(&mut tracer, scene).unwrap()
        };
        let closed = Scene::builtin("corner").unwrap();
        let direct_s = Medium::of(closed.only_pair().unwrap()).direct_s;
        assert!((needed(&closed, 10.0) - direct_s - WITHOUT_DECAY_S).abs() < 1e-9);
        assert_eq!(needed(&closed, 1.5), 1.5);
        let mut absorbing = closed.clone();
        absorbing.air = Some(crate::scene::Air::default());
        assert!(needed(&absorbing, 10.0) > 5.0);
    }

    /// A yard: ground and one wall, or two opposite walls.
    fn yard(walls: usize) -> Scene {
        let wall = |x: f32| {
            format!(
                "Surface(shape: Box(size: (0.3, 4, 20)), position: ({x}, 2, 0), material: \"wall\"),"
            )
        };
        let walls: String = [5.0, -5.0].into_iter().take(walls).map(wall).collect();
        let text = format!(
            "Scene(surfaces: [Surface(shape: HalfSpace(normal: (0, 1, 0), offset: 0), material: \"grass\"), {walls}],
            materials: {{\"grass\": Material(absorption: 0.3), \"wall\": Material(absorption: 0.05)}},
            source: Source(position: (-2, 1.5, 0)), listener: Listener(position: (2, 1.7, 1), radius: 0.2))"
        );
        Scene::from_ron(&text, "yard").unwrap()
    }

    /// Protects figures outdoors, beside one wall and between two walls, where most waves leave at once: the default
    /// record is long enough, and the energy figures are present.
    #[test]
    fn figures_outdoors_need_no_length_by_hand() {
        let mut tracer =
            Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
        for walls in [0, 1, 2] {
            let response =
                Response::trace(&mut tracer, &yard(walls), &ResponseSettings::default()).unwrap();
            let figures = &response.figures;
            assert!(
                figures.cut_off[4].is_some_and(|share| share < 1e-3),
                "{walls}: {figures:?}"
            );
            assert!(figures.bands[4].g_db.is_some(), "{walls} walls");
            let c80_db = figures.bands[4].c80_db;
            assert!(walls == 2 || c80_db.is_none(), "{walls} walls: {c80_db:?}");
            let last_s = response.paths.last().unwrap().delay_s;
            assert!(
                response.seconds > 2.0 * last_s - 0.1,
                "{walls}: {}",
                response.seconds
            );
        }
    }
}
