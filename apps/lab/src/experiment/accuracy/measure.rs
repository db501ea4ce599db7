//! Compares each wave with the exact wave of the same start direction (its twin).

use super::report::{Chaos, Quantiles, WaveErrors};
use super::truth::Truth;
use echomarch::Error;
use echomarch::geometry::{ExactWave, sequence_hash};
use echomarch::internals::fields_cost::flights;
use echomarch::tracer::{Fate, Settings, Tracer, Wave};
use glam::Vec3;

/// Compares the waves of `settings` with exact waves that have the same start directions.
///
/// The end points come from an unchanged frame. The sequences of surfaces come from a second frame, which is read back
/// after each iteration.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn wave_errors(
    tracer: &mut Tracer,
    truth: &mut Truth,
    chaos: &Chaos,
    settings: &Settings,
) -> Result<WaveErrors, Error> {
    let (_, ends) = tracer.frame_with_waves(truth.scene, settings)?;
    let states = tracer.paths(truth.scene, settings)?;
    let met = objects_met(&states);
    let starts: Vec<Vec3> = ends.iter().map(|wave| wave.start_direction).collect();
    let exact = truth.twins(settings, &starts);
    let flights = flights(&states, settings.profile());
    let errors = compare(&ends, &met, &exact, chaos, settings.iterations);
    Ok(WaveErrors { flights, ..errors })
}

/// The objects that each wave hits before it dies, is heard or reaches its last iteration.
fn objects_met(states: &[Vec<Wave>]) -> Vec<Vec<u32>> {
    let waves = states.first().map_or(0, Vec::len);
    let mut met: Vec<Vec<u32>> = vec![Vec::new(); waves];
    let mut ended = vec![false; waves];
    for state in states.iter().skip(1) {
        for ((wave, met), ended) in state.iter().zip(&mut met).zip(&mut ended) {
            if *ended {
                continue;
            }
            let status = status(wave);
            *ended = status <= 0;
            if status >= 0 {
                met.push(status as u32);
            }
        }
    }
    met
}

/// The status rounded to a whole number. The result is 0 if the status is within the thesis' margin (figure 8) around
/// the listener's status.
fn status(wave: &Wave) -> i32 {
    match wave.fate() {
        Fate::Listener => 0,
        Fate::Dead => -1,
        // Waves that are not finite also have a count of their own.
        Fate::Travelling | Fate::NotFinite => wave.status.round() as i32,
    }
}

fn compare(
    ends: &[Wave],
    met: &[Vec<u32>],
    exact: &[ExactWave],
    chaos: &Chaos,
    iterations: u32,
) -> WaveErrors {
    let mut errors = WaveErrors {
        compared: ends.len() as u64,
        hits: vec![0; iterations as usize],
        exact_hits: vec![0; iterations as usize],
        ..WaveErrors::default()
    };
    let horizon = chaos.horizon.unwrap_or(f64::INFINITY);
    let (mut status_differs, mut sequence_differs, mut beyond) = (0, 0, 0);
    let (mut all, mut within) = (Vec::new(), Vec::new());
    for ((wave, met), exact) in ends.iter().zip(met).zip(exact) {
        let other_status = status(wave) != exact.status;
        let other_sequence = sequence_hash(met) != exact.sequence_hash;
        status_differs += u64::from(other_status);
        sequence_differs += u64::from(other_status || other_sequence);
        let is_beyond = f64::from(exact.curved_hits) > horizon;
        beyond += u64::from(is_beyond);
        if met.last() == Some(&0) {
            errors.hits[met.len() - 1] += 1;
        }
        if exact.status == 0 {
            errors.exact_hits[exact.order as usize] += 1;
        }
        let off = wave.position.as_dvec3().distance(exact.point);
        if !(off.is_finite() && wave.direction.is_finite()) {
            errors.not_finite += 1;
        } else if exact.status >= 0 {
            all.push(off);
            within.extend((!is_beyond).then_some(off));
        }
    }
    let share = |count: u64| count as f64 / ends.len().max(1) as f64;
    errors.status_differs = share(status_differs);
    errors.sequence_differs = share(sequence_differs);
    errors.beyond_horizon = share(beyond);
    errors.end = Quantiles::of(all);
    errors.end_within_horizon = Quantiles::of(within);
    errors
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(status: f32) -> Wave {
        let mut wave = Wave::default();
        (wave.start_direction, wave.direction) = (Vec3::X, Vec3::X);
        wave.status = status;
        wave
    }

    /// Protects the quantiles, including their values without data.
    #[test]
    fn quantiles_have_their_shares() {
        let of = Quantiles::of((0..=200).rev().map(f64::from).collect());
        assert_eq!((of.median, of.p99, of.max), (100.0, 198.0, 200.0));
        assert_eq!(Quantiles::of(Vec::new()), Quantiles::default());
    }

    /// Protects the sequences of surfaces from marches after a wave's end: the thesis' algorithm continues to march
    /// dead waves.
    #[test]
    fn nothing_is_met_after_the_end() {
        let states = [0.5, 2.0, -1.0, 1.0].map(|status| vec![wave(status)]);
        assert_eq!(objects_met(&states), [vec![2]]);
        let states = [0.5, 2.0, 0.0, 0.0].map(|status| vec![wave(status)]);
        assert_eq!(objects_met(&states), [vec![2, 0]]);
        let states = [0.5, 2.0, 1.0].map(|status| vec![wave(status)]);
        assert_eq!(objects_met(&states), [vec![2, 1]]);
    }
}
