//! Compares figures with decays whose figures are known in closed form.

use super::uncertainty::student_975;
use super::*;
use crate::bands::Bands;
use crate::geometry::ShoeboxEnergies;
use crate::response::ResponseError;
use crate::response::tests::mean;
use crate::sampling::{hash, unit_interval};
use glam::DVec3;

const BIN_S: f64 = 1e-3;

/// 60 dB as a natural logarithm: the ratio of the decay time to the time in which the energy falls by a factor of e.
const SIXTY_DB: f64 = 13.815_510_557_964_274;

/// Share of the energy of the decay exp(−t/`time_s`) between two times.
fn between(begins_s: f64, ends_s: f64, time_s: f64) -> f64 {
    (-begins_s / time_s).exp() - (-ends_s / time_s).exp()
}

/// An exponential decay in all bands, from `begins_s` to `ends_s`.
fn exponential(time_s: f64, begins_s: f64, ends_s: f64) -> Echogram {
    let mut echogram = Echogram::with_edge_at(begins_s, BIN_S, 1).expect("a good bin");
    for bin in 0..((ends_s - begins_s) / BIN_S).round() as usize {
        let from_s = bin as f64 * BIN_S;
        let energy = between(from_s, from_s + BIN_S, time_s);
        let middle_s = begins_s + from_s + BIN_S / 2.0;
        echogram
            .add(0, middle_s, &[energy; BAND_COUNT], DVec3::X)
            .unwrap();
    }
    echogram
}

fn tap(seconds: f64, energy: f64) -> Tap {
    Tap {
        seconds,
        energy: [energy; BAND_COUNT],
        direction: DVec3::X,
    }
}

#[track_caller]
fn assert_near(found: Option<f64>, expected: f64, tolerance: f64) {
    let found = found.expect("a figure");
    assert!((found - expected).abs() <= tolerance, "{found} {expected}");
}

/// Protects each figure of a pure decay, and the tail of a record that ends at −46 dB: without the tail T30 would be
/// 0.5 % too short. A bin is a hundredth of the time in which the energy falls by a factor of e. Spreading its energy
/// evenly causes an error of the square of this ratio over 12: 10⁻⁵.
#[test]
fn a_pure_decay_has_its_figures() {
    let time_s = 0.1;
    let ends_s = 0.02 + 4.6 * time_s * 10_f64.ln();
    let echogram = exponential(time_s, 0.02, ends_s);
    let figures = Figures::new(&[], &echogram, Some(0.02), ends_s);
    let band = figures.bands[3];
    for decay_s in [band.t20_s, band.t30_s] {
        assert_near(decay_s, SIXTY_DB * time_s, 1e-4);
    }
    assert_near(band.c50_db, 10.0 * (0.5_f64.exp() - 1.0).log10(), 1e-4);
    assert_near(band.c80_db, 10.0 * (0.8_f64.exp() - 1.0).log10(), 1e-4);
    assert_near(band.d50, 1.0 - (-0.5_f64).exp(), 1e-5);
    assert_near(band.ts_s, time_s, 1e-5);
    assert_near(band.g_db, 10.0 * (400.0 * PI).log10(), 1e-4);
    assert_near(figures.cut_off[3], 10_f64.powf(-4.6), 1e-6);
    assert_eq!(figures.errors[3], BandFigures::default());
}

/// Protects from figures of a record that ends too early: figures that need its tail are missing.
#[test]
fn a_record_that_is_too_short_tells_less() {
    let time_s = 0.1;
    let until = |level_db: f64| {
        let ends_s = level_db / 10.0 * time_s * 10_f64.ln();
        Figures::new(&[], &exponential(time_s, 0.0, ends_s), None, ends_s).bands[0]
    };
    let (at_44, at_34, at_19, at_9) = (until(44.0), until(34.0), until(19.0), until(9.0));
    assert!(at_44.t30_s.is_none() && at_44.t20_s.is_some());
    assert!(at_34.t20_s.is_none());
    // EDT, six times the decay by 10 dB, is longer than twice a record that decays by less than 30 dB.
    let (at_31, at_29) = (until(31.0), until(29.0));
    assert_near(at_31.edt_s, SIXTY_DB * time_s, 1e-3);
    assert!(at_29.edt_s.is_none());
    assert!(at_34.g_db.is_some() && at_19.g_db.is_none());
    // The whole record decays by less than 10 dB: its tail cannot be estimated.
    assert_eq!(at_9, BandFigures::default());
}

/// Protects from decay times that come from exact paths alone or from a few waves. A row of taps decays by 60 dB; after
/// it come no waves, a few waves, or many waves that continue the decay.
#[test]
fn decay_times_need_waves_behind_the_decay() {
    let falls = |seconds: f64| 10_f64.powf(-6.0 * seconds);
    let taps: Vec<Tap> = (0..200)
        .map(|i| f64::from(i) * 5e-3)
        .map(|seconds| tap(seconds, falls(seconds)))
        .collect();
    let told = |waves: usize| {
        let mut echogram = Echogram::new(BIN_S, 16).expect("a good bin");
        for wave in 0..waves {
            let seconds = 1.2 * (wave as f64 + 0.5) / waves as f64;
            let energy = 20.0 * falls(seconds) / waves as f64;
            echogram
                .add(wave % 16, seconds, &[energy; BAND_COUNT], DVec3::X)
                .unwrap();
        }
        Figures::new(&taps, &echogram, Some(0.0), 1.2).bands[0]
    };
    for few in [told(0), told(10), told(1000)] {
        assert_eq!((few.edt_s, few.t20_s, few.t30_s), (None, None, None));
    }
    let many = told(20_000);
    assert!(many.edt_s.is_some() && many.t30_s.is_some(), "{many:?}");
}

/// Protects against figures of a room that does not absorb.
#[test]
fn what_does_not_decay_has_no_figures() {
    let mut echogram = Echogram::new(BIN_S, 1).expect("a good bin");
    for bin in 0..500 {
        echogram
            .add(
                0,
                (f64::from(bin) + 0.5) * BIN_S,
                &[1.0; BAND_COUNT],
                DVec3::X,
            )
            .unwrap();
    }
    let figures = Figures::new(&[], &echogram, None, 0.5);
    assert_eq!(figures.bands[0], BandFigures::default());
    assert_eq!(figures.cut_off[0], None);
}

/// Protects the free field: strength by distance, no decay and no late sound.
#[test]
fn the_direct_sound_alone_has_strength_and_no_decay() {
    let echogram = Echogram::new(BIN_S, 16).expect("a good bin");
    let direct = tap(0.01, 1.0 / (16.0 * PI));
    let band = Figures::new(&[direct], &echogram, Some(0.01), 1.0).bands[7];
    assert_near(band.g_db, 10.0 * 25_f64.log10(), 1e-12);
    assert_near(band.d50, 1.0, 0.0);
    assert_near(band.ts_s, 0.0, 0.0);
    assert_eq!((band.edt_s, band.t30_s, band.c80_db), (None, None, None));
    let nothing = Figures::new(&[], &echogram, None, 1.0);
    assert_eq!((nothing.begins_s, nothing.bands[0].g_db), (None, None));
}

/// Protects the time origin, and taps that split bins: echoes arrive 60 ms and 90 ms after the direct sound, one of
/// them in a filled bin.
#[test]
fn times_count_from_the_direct_sound() {
    let mut echogram = Echogram::new(BIN_S, 1).expect("a good bin");
    echogram
        .add(0, 0.1001, &[1.0; BAND_COUNT], DVec3::X)
        .unwrap();
    let taps = [tap(0.01, 4.0), tap(0.07, 2.0), tap(0.1005, 3.0)];
    let band = Figures::new(&taps, &echogram, Some(0.01), 2.0).bands[0];
    assert_near(band.c50_db, 10.0 * (4.0_f64 / 6.0).log10(), 1e-12);
    assert_near(band.c80_db, 10.0 * (6.0_f64 / 4.0).log10(), 1e-12);
    assert_near(band.ts_s, (2.0 * 0.06 + 4.0 * 0.0905) / 10.0, 1e-12);
    // Without the direct sound, times count from the first echo.
    let figures = Figures::new(&taps[1..], &echogram, None, 2.0);
    assert_eq!(figures.begins_s, Some(0.07));
}

/// Protects the factor of Student's t, which is compared with its table.
#[test]
fn student_s_t_is_that_of_the_table() {
    for (degrees, expected) in [(1, 12.7062), (2, 4.3027), (15, 2.1314), (63, 1.9983)] {
        assert!((student_975(degrees) - expected).abs() < 1e-4, "{degrees}");
    }
    assert!((student_975(3) / 3.1824 - 1.0).abs() < 0.01);
}

/// Random waves with two decays, half of the waves in each: in 16 batches, each wave heard 20 times at evenly
/// distributed random times over 2 s. `only` restricts the waves to one batch.
fn draw(seed: u64, waves: usize, only: Option<usize>) -> Echogram {
    let batches = if only.is_some() { 1 } else { 16 };
    let mut echogram = Echogram::new(BIN_S, batches).expect("a good bin");
    for wave in (0..waves).filter(|wave| only.is_none_or(|only| wave % 16 == only)) {
        for arrival in 0..ARRIVALS {
            let number = (wave * ARRIVALS + arrival) as u64;
            let seconds = 2.0 * unit_interval(hash(hash(seed).wrapping_add(number)));
            let energy = (-seconds / TWO_TIMES_S[wave / 16 % 2]).exp();
            echogram
                .add(wave % batches, seconds, &lowest(energy), DVec3::X)
                .unwrap();
        }
    }
    echogram
}

/// Energies that are 0 except in the lowest band. The other bands have no figures, which saves time.
fn lowest(energy: f64) -> Bands {
    std::array::from_fn(|band| if band == 0 { energy } else { 0.0 })
}

/// Number of arrivals of a wave.
const ARRIVALS: usize = 20;

/// Sufficient number of waves for a reverberation time.
const MANY: usize = 1600;

/// Times in seconds in which the energies fall by a factor of e: reverberation times of 1.1 s and 1.7 s.
const TWO_TIMES_S: [f64; 2] = [0.08, 0.12];

fn told(figures: &Figures) -> [(Option<f64>, Option<f64>); 3] {
    let (found, error) = (figures.bands[0], figures.errors[0]);
    [
        (found.t30_s, error.t30_s),
        (found.c80_db, error.c80_db),
        (found.g_db, error.g_db),
    ]
}

/// The figures of infinitely many waves of [`draw`]; the scale of their energy is arbitrary.
fn truth() -> [f64; 3] {
    let mut echogram = Echogram::new(BIN_S, 1).expect("a good bin");
    for bin in 0..2000 {
        let from_s = f64::from(bin) * BIN_S;
        let decays = TWO_TIMES_S.map(|time_s| time_s * between(from_s, from_s + BIN_S, time_s));
        let energy = (MANY * ARRIVALS) as f64 / 2.0 * (decays[0] + decays[1]) / 2.0;
        echogram
            .add(0, from_s + BIN_S / 2.0, &[energy; BAND_COUNT], DVec3::X)
            .unwrap();
    }
    told(&Figures::new(&[], &echogram, Some(0.0), 2.0)).map(|(found, _)| found.expect("a figure"))
}

/// Protects the size of errors: over 300 draws the truth is within two errors in 95 % of the draws, ± 3 × 1.26 % by the
/// binomial law.
#[test]
fn two_errors_hold_the_truth_in_95_of_100_draws() {
    const DRAWS: u64 = 300;
    let truth = truth();
    let mut held = [0; 3];
    for seed in 0..DRAWS {
        let figures = Figures::new(&[], &draw(seed, MANY, None), Some(0.0), 2.0);
        for (index, (found, error)) in told(&figures).into_iter().enumerate() {
            let (found, error) = (found.expect("a figure"), error.expect("an error"));
            held[index] += u64::from((found - truth[index]).abs() <= 2.0 * error);
        }
    }
    for held in held {
        let share = held as f64 / DRAWS as f64;
        assert!((share - 0.95).abs() < 3.0 * 0.0126, "{held} of {DRAWS}");
    }
}

/// Protects the use of halves: with few waves the mean of figures computed from single batches is biased, here by 0.2
/// dB, while the bias of the figure from all waves together is at most a sixteenth of that.
#[test]
fn figures_of_single_batches_are_biased() {
    const DRAWS: u64 = 200;
    const FEW: usize = 160;
    let [_, truth_db, _] = truth();
    let c80_db = |seed, only| {
        let figures = Figures::new(&[], &draw(seed, FEW, only), Some(0.0), 2.0);
        (figures.bands[0].c80_db, figures.errors[0].c80_db)
    };
    let (mut all_db, mut single_db, mut error_db) = (0.0, 0.0, 0.0);
    for seed in 0..DRAWS {
        let (found, error) = c80_db(seed, None);
        all_db += found.expect("a figure") - truth_db;
        error_db += error.expect("an error");
        let singles = (0..16).filter_map(|batch| c80_db(seed, Some(batch)).0);
        single_db += mean(singles) - truth_db;
    }
    let [all_db, single_db, error_db] = [all_db, single_db, error_db].map(|sum| sum / DRAWS as f64);
    // The mean over the draws itself has an error.
    let own_db = error_db / (DRAWS as f64).sqrt();
    assert!(single_db.abs() > 4.0 * own_db, "{single_db} {own_db}");
    assert!(all_db.abs() < 2.0 * own_db, "{all_db} {own_db}");
}

/// Protects taps from errors: they are exact, and reduce the relative error of the waves.
#[test]
fn taps_have_no_error() {
    let echogram = draw(1, MANY, None);
    let error = |taps: &[Tap]| {
        let figures = Figures::new(taps, &echogram, Some(0.0), 2.0);
        figures.errors[0].g_db.expect("an error")
    };
    let energy = echogram.total()[0];
    assert!((error(&[tap(0.0, 9.0 * energy)]) / error(&[]) - 0.1).abs() < 0.01);
}

/// Protects errors where few waves arrive: most batches are empty then, and fewer arrivals mean larger errors.
#[test]
fn few_arrivals_have_larger_errors() {
    const BATCHES_OF_WAVES: usize = 16;
    let direct = Tap {
        seconds: 0.01,
        energy: [1.0; BAND_COUNT],
        direction: DVec3::X,
    };
    let errors = |arrivals: usize| {
        let mut echogram = Echogram::new(0.001, BATCHES_OF_WAVES).unwrap();
        for arrival in 0..arrivals {
            let seconds = 0.05 + 0.001 * arrival as f64;
            let energy = [0.1 / arrivals as f64; BAND_COUNT];
            echogram
                .add(arrival % BATCHES_OF_WAVES, seconds, &energy, DVec3::X)
                .unwrap();
        }
        Figures::new(&[direct], &echogram, Some(0.01), 1.0).errors[0]
    };
    let [one, two, four, sixteen] = [1, 2, 4, 16].map(|arrivals| errors(arrivals).g_db.unwrap());
    // The factors are Student's t at 1, 3 and 15 degrees of freedom, and the spread of the arrivals themselves is 1/√n.
    assert!(
        one > two && two > 4.0 * four && four > 2.0 * sixteen,
        "{one} {two} {four} {sixteen}"
    );
}

/// Protects the decay times of long records, which need more cells than an echogram has bins: a longer record gives the
/// same times.
#[test]
fn long_records_are_whole() {
    let size = DVec3::new(30.0, 12.0, 24.0);
    let (source, listener) = (DVec3::new(-8.0, 1.0, 5.0), DVec3::new(9.0, -1.0, -6.0));
    let room = ShoeboxEnergies::new(size, source, listener, &[[0.08; BAND_COUNT]; 6]);
    let room = room.expect("source and listener are in the room");
    let [short, long] = [6.5, 7.0].map(|seconds| {
        let figures = Figures::of_image_sources(&room, 343.0, seconds).expect("of that length");
        figures.bands[0].t30_s.expect("a decay of 45 dB")
    });
    assert!((long / short - 1.0).abs() < 1e-3, "{short} {long}");
    let refused = Figures::of_image_sources(&room, 343.0, 61.0);
    assert_eq!(refused, Err(ResponseError::BadLength { seconds: 61.0 }));
}

/// A decay of 60 dB in 0.6 s with many arrivals. After 30 dB the energies of 16 batches differ by this share.
fn decay_with_spread(spread: f64) -> Echogram {
    const BATCHES: usize = 16;
    let mut echogram = Echogram::new(1e-3, BATCHES).expect("a good bin");
    for bin in 0..600 {
        let energy = 10_f64.powf(-0.01 * f64::from(bin));
        for batch in 0..BATCHES {
            let sign = if batch % 2 == 0 { 1.0 } else { -1.0 };
            let part = if bin > 300 { 1.0 + sign * spread } else { 1.0 };
            for arrival in 0..4 {
                let seconds = 1e-3 * (f64::from(bin) + 0.25 * f64::from(arrival) + 0.1);
                echogram
                    .add(batch, seconds, &[part * energy; BAND_COUNT], DVec3::X)
                    .unwrap();
            }
        }
    }
    echogram
}

/// The place of T30 in the list of figures.
const T30: usize = 2;

/// Protects accuracies from noise that is small by chance: a decay whose end rests on few independent waves asks for more
/// waves, although its arrivals are many and its noise is small.
#[test]
fn few_independent_waves_after_a_decay_ask_for_more() {
    let figures = |spread| Figures::new(&[], &decay_with_spread(spread), Some(0.0), 0.6);
    let (even, uneven) = (figures(0.05), figures(0.5));
    let of = uneven.precision[0][T30];
    let share = of.noise.unwrap() / of.value.unwrap();
    assert!(share < 0.04, "{share}");
    // 16 batches with a standard deviation of 0.516.
    assert_near(of.independent_waves, 60.0, 0.01);
    assert_eq!(even.is_accurate(0.05, 0, T30), Some(true));
    assert_eq!(uneven.is_accurate(0.05, 0, T30), Some(false));
    let growth = uneven.waves_for(0.05);
    assert!((3.2..3.5).contains(&growth), "{growth}");
}

/// Protects rounds from waves in vain: if waves of early arrivals that cannot grow cause all the spread after a decay, no
/// other waves are asked for.
#[test]
fn independent_waves_are_asked_of_the_waves_that_lack() {
    let uneven = decay_with_spread(0.5);
    let figures = Figures::new(&[], &uneven, Some(0.0), 0.6);
    let record = Record::new(&[], &uneven, 0.6);
    let most = |early: &Echogram| {
        let parts = Parts {
            early,
            early_can_grow: false,
            onset_s: 0.1,
        };
        let demands = figures.demands(0.05, &record, Some(0.0), Some(parts));
        demands.iter().map(Demand::factor).fold(0.0, f64::max)
    };
    let (of_early, of_others) = (most(&uneven), most(&uneven.without_arrivals()));
    assert!(of_early < 0.1 && of_others > 3.0, "{of_early}, {of_others}");
}

/// Protects rounds from panics, and from waves without end: a record that ends within its decay has no arrivals after it,
/// and no number of waves reports its decay times.
#[test]
fn a_decay_without_arrivals_after_its_end_asks_for_no_waves() {
    const BATCHES: usize = 16;
    let mut echogram = Echogram::new(1e-3, BATCHES).expect("a good bin");
    for bin in 0..60 {
        let energy = 10_f64.powf(-0.01 * f64::from(bin));
        for batch in 0..BATCHES {
            let seconds = 1e-3 * (f64::from(bin) + 0.5);
            let spread = 1.0 + 0.3 * (batch as f64 / BATCHES as f64 - 0.5);
            echogram
                .add(batch, seconds, &[spread * energy; BAND_COUNT], DVec3::X)
                .unwrap();
        }
    }
    let figures = Figures::new(&[], &echogram, Some(0.0), 0.5);
    let record = Record::new(&[], &echogram, 0.5);
    let early = echogram.without_arrivals();
    for early_can_grow in [true, false] {
        let parts = Parts {
            early: &early,
            early_can_grow,
            onset_s: 0.02,
        };
        let demands = figures.demands(0.02, &record, Some(0.0), Some(parts));
        let lacking: Vec<&Demand> = demands
            .iter()
            .filter(|demand| demand.least.factor > 0.0)
            .collect();
        let is_endless = |demand: &&&Demand| demand.least.factor.is_infinite();
        assert!(
            lacking.iter().any(|demand| is_endless(&demand)),
            "{demands:?}"
        );
        let mut endless = lacking.iter().filter(is_endless);
        assert!(endless.all(|demand| demand.factor() == 0.0 && !demand.is_open()));
    }
}
