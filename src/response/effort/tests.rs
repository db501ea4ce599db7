use super::*;
use crate::Scene;
use crate::gl::{Context, ContextOptions};
use crate::response::figures::Need;
use crate::response::{Echogram, Response};
use crate::tracer::Tracer;

const EFFORT: Effort = Effort {
    waves: 4096,
    onset_waves: 16_384,
    early_waves: 65_536,
    seconds: 1.0,
    onset: Some(OnsetTime {
        length_s: 0.17,
        share: 0.2,
    }),
    early_share: 0.0,
    begins_anew: false,
};

fn demand(noise: f64, onset_share: f64) -> Demand {
    Demand {
        noise: need(noise, [0.0, onset_share]),
        least: need(0.0, [0.0; 2]),
    }
}

fn need(factor: f64, [early_share, onset_share]: [f64; 2]) -> Need {
    Need {
        factor,
        early_share,
        onset_share,
    }
}

/// The time of a first round.
fn took(seconds: f64) -> Took {
    Took {
        last_s: seconds,
        extended_s: Some(seconds),
    }
}

/// An effort without an onset.
fn even(waves: u32, seconds: f64) -> Effort {
    Effort {
        waves,
        onset_waves: waves,
        early_waves: 65_536,
        seconds,
        onset: None,
        early_share: 0.0,
        begins_anew: false,
    }
}

/// Protects the time of a response: noise of the onset asks for waves of the onset, noise of the late decay for waves
/// that are followed to the end, noise of early arrivals for waves that find exact paths, and accurate figures for
/// none.
#[test]
fn waves_are_added_where_the_noise_is() {
    let grown = |demands: &[Demand]| EFFORT.grown(demands);
    assert_eq!(grown(&[demand(0.9, 0.5)]), EFFORT);
    let early = grown(&[demand(2.0, 1.0), demand(0.5, 0.0)]);
    assert_eq!((early.waves, early.onset_waves), (4096, 39_321));
    let late = grown(&[demand(2.0, 0.0)]);
    let further = late.waves - 4096;
    assert!(further >= 4096, "{late:?}");
    assert_eq!(late.onset_waves, 16_384 + further);
    let found = Demand {
        noise: need(2.0, [1.0, 0.0]),
        ..demand(0.0, 0.0)
    };
    let early = grown(&[found, demand(0.5, 0.0)]);
    assert!(early.early_waves >= 2 * 65_536, "{early:?}");
    assert_eq!((early.waves, early.onset_waves), (4096, 16_384));
    // Noise that takes more than the greatest growth takes about the greatest growth.
    let much = grown(&[demand(1e4, 0.5)]);
    assert!((12_288..=16_384).contains(&much.waves), "{much:?}");
    assert_eq!(much.onset_waves, 65_536);
    // Waves of the onset do not make up for other noise that takes more than the greatest growth.
    let many = need(9.0, [0.9, 0.1]);
    for found in [
        Demand {
            noise: many,
            ..demand(0.0, 0.0)
        },
        Demand {
            least: many,
            ..demand(0.0, 0.0)
        },
    ] {
        let early = grown(&[found]);
        assert!(early.early_waves > 3 * 65_536, "{early:?}");
        assert!(early.onset_waves < 2 * 16_384, "{early:?}");
        assert_eq!(early.waves, 4096);
    }
    assert_eq!(even(4096, 1.0).grown(&[demand(2.0, 1.0)]).waves, 9830);
}

/// Protects rounds from efforts that are known to be too small: if the growth suffices for a demand, the demand is
/// fulfilled.
#[test]
fn demands_are_fulfilled_at_once() {
    for noise in [1.5, 2.0, 2.5, 3.0] {
        for share in [0.0, 0.2, 0.3, 0.5, 0.8, 1.0] {
            let effort = EFFORT.grown(&[demand(noise, share)]);
            let onset = f64::from(effort.onset_waves) / 16_384.0;
            let followed = f64::from(effort.waves) / 4096.0;
            let left = noise * (share / onset + (1.0 - share) / followed);
            assert!(left <= 1.001, "{noise} {share}: {effort:?}, {left}");
        }
    }
}

/// Protects time limits: a round is made no longer than the time that is left, as the last round predicts it, and is
/// not begun if it would hardly improve the result.
#[test]
fn a_round_fits_the_time_that_is_left() {
    let fitted = |wanted: Effort, left_s: f64| {
        let fitting = wanted.fitting(left_s, even(1000, 1.0), took(2.0));
        fitting.map(|effort| (effort.waves, effort.seconds))
    };
    assert_eq!(fitted(even(4000, 1.0), 8.0), Some((4000, 1.0)));
    assert_eq!(fitted(even(4000, 1.0), 6.0), Some((3000, 1.0)));
    assert_eq!(fitted(even(4000, 1.0), 3.0), Some((1500, 1.0)));
    assert_eq!(fitted(even(4000, 1.0), 2.9), None);
    // A longer record takes more time for each wave.
    assert_eq!(fitted(even(4000, 1.5), 6.0), Some((2000, 1.5)));
    assert_eq!(fitted(even(1000, 1.5), 3.0), Some((1000, 1.5)));
    assert_eq!(fitted(even(1000, 1.5), 2.9), None);
    // A small rest of the waves is traced if it fits.
    assert_eq!(fitted(even(1100, 1.0), 2.5), Some((1100, 1.0)));
    for left_s in [0.0, -1.0, f64::NAN] {
        assert_eq!(fitted(even(4000, 1.0), left_s), None);
    }
}

/// Protects the late decay and the onset from rounds with fewer waves than the round before: only the growth is
/// reduced to the limits.
#[test]
fn limits_reduce_growth_only() {
    let wanted = Effort {
        onset_waves: 65_536,
        ..EFFORT
    };
    let half = wanted.fitting(1.5, EFFORT, took(2.0)).unwrap();
    assert_eq!(half.waves, 4096);
    assert!((24_576..50_000).contains(&half.onset_waves), "{half:?}");
    let large = Effort {
        waves: 100_000,
        onset_waves: 400_000,
        ..EFFORT
    };
    let wanted = Effort {
        waves: 400_000,
        onset_waves: 800_000,
        ..EFFORT
    };
    // 100 million waves times iterations.
    let within = wanted.within(large, 400, &Accuracy::default());
    assert!(
        within.waves >= 100_000 && within.onset_waves >= 400_000,
        "{within:?}"
    );
    assert!(within.flight_s() <= 250_000.0, "{within:?}");
    let few = Accuracy::default().with_most_waves(4500);
    let grown = Effort {
        onset_waves: 65_536,
        ..EFFORT
    };
    // The waves of the onset are at their limit, and further ones can only be followed to the end by a new trace.
    let most = Accuracy::default().with_most_waves(16_384);
    let late = Effort {
        waves: 16_384,
        onset_waves: 28_672,
        ..EFFORT
    };
    let anew = late.within(EFFORT, 400, &most);
    assert!(
        anew.waves > 12_000 && anew.onset_waves == 16_384,
        "{anew:?}"
    );
    assert!(anew.begins_anew && !anew.extends(EFFORT) && anew.exceeds(EFFORT));
    let asked = grown.within(even(4000, 1.0), 400, &few);
    assert!(
        asked.waves <= 4500 && asked.onset_waves <= 4500,
        "{asked:?}"
    );
}

/// Protects figures behind doorways: more waves of early arrivals are worth a round, although they fly little.
#[test]
fn a_round_may_have_more_early_waves_only() {
    let last = Effort {
        early_share: 0.05,
        ..EFFORT
    };
    let wanted = Effort {
        early_waves: 2 * last.early_waves,
        ..last
    };
    assert!(wanted.exceeds(last) && !last.exceeds(last));
    // The first round does not know the share.
    let fitting = wanted.fitting(1.0, EFFORT, took(2.0)).unwrap();
    assert_eq!(fitting, wanted);
}

/// A room whose walls scatter.
fn scattering_room() -> Scene {
    let text = "Scene(surfaces: [Surface(shape: Room(size: (6, 3, 5)), material: \"m\")],
        materials: {\"m\": Material(absorption: 0.3, scattering: 0.3)},
        source: Source(position: (-1.5, 0.3, -1)), listener: Listener(position: (1.7, -0.2, 0.9), radius: 0.3))";
    Scene::from_ron(text, "room").unwrap()
}

/// Protects the two parts of a record: the late bins are those of the followed waves alone, and the bins of the onset
/// have the energy of all waves, with less noise.
#[test]
fn only_the_onset_has_more_waves() {
    let mut tracer = Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
    let scene = scattering_room();
    let pair = scene.only_pair().unwrap();
    // Without exact paths the listener's own sphere counts all arrivals.
    let settings = ResponseSettings::default().with_order(0);
    let mut trace = |waves: u32, onset_waves: u32| {
        let effort = Effort {
            onset_waves,
            ..even(waves, 0.6)
        };
        // Without an onset all waves would be followed to the end.
        let effort = effort.of_pairs(&[pair], &settings);
        let settings = effort.settings(&settings);
        Response::trace(&mut tracer, pair, &settings).unwrap()
    };
    let (few, dense, many) = (
        trace(2048, 2048),
        trace(2048, 32_768),
        trace(32_768, 32_768),
    );
    let onset = even(1, 0.6).of_pairs(&[pair], &settings).onset.unwrap();
    let until = (few.echogram).bins_before(Medium::of(pair).direct_s + onset.length_s);
    assert!(until > 80 && few.echogram.bins() > 2 * until);
    for bin in until..few.echogram.bins() {
        assert_eq!(
            few.echogram.energy(bin),
            dense.echogram.energy(bin),
            "{bin}"
        );
    }
    let onset = |of: &Response| {
        (0..until)
            .map(|bin| of.echogram.energy(bin)[4])
            .sum::<f64>()
    };
    let off_by = |of: &Response| (onset(of) / onset(&many) - 1.0).abs();
    // Other waves of the same number would differ by 2 %.
    assert!(off_by(&dense) < 0.02, "{}", off_by(&dense));
    let noise = |of: &Response| of.figures.errors[4].c80_db.unwrap();
    assert!(
        noise(&dense) < 0.8 * noise(&few),
        "{} {}",
        noise(&dense),
        noise(&few)
    );
}

/// Protects the reader from a note that names another limit than the one that ended the rounds.
#[test]
fn the_note_names_the_limit_that_ended_the_rounds() {
    let mut tracer = Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
    let scene = scattering_room();
    let mut note = |accuracy: Accuracy| {
        let settings = ResponseSettings::default().with_accuracy(accuracy);
        let response = Response::trace(&mut tracer, &scene, &settings).unwrap();
        let notes = response.notes(scene.only_pair().unwrap());
        let mut texts = notes.iter().map(ToString::to_string);
        texts.find(|text| text.contains("is not reached")).unwrap()
    };
    let finest = Accuracy::new(0.001);
    let by_waves = note(finest.with_most_waves(4096));
    let because = "because the limit of 4096 waves ended the rounds: ";
    assert!(by_waves.contains(because), "{by_waves}");
    let by_time = note(finest.with_time_limit(1e-3));
    let because = "because the time limit ended the rounds: ";
    assert!(by_time.contains(because), "{by_time}");
    // Without a maximum, long flights end the rounds, and short ones the greatest number that a pass can have.
    assert_eq!(finest.limit_of_waves(1000), Ended::Flights);
    let most = Ended::Waves(crate::tracer::Settings::MAX_WAVES);
    assert_eq!(finest.limit_of_waves(1), most);
}

/// Protects T30 where rooms are coupled: a band whose decay is known gets a longer record until T30 is defined, which
/// needs −45 dB at the end. Bands with few arrivals and without sound do not decide.
#[test]
fn a_record_lasts_until_t30_is_defined() {
    let echogram = Echogram::new(1e-3, 1).unwrap();
    let mut figures = Figures::new(&[], &echogram, Some(0.0), 1.0);
    figures.cut_off = [Some(1e-6); BAND_COUNT];
    let mut energy = [1.0; BAND_COUNT];
    assert!(!is_cut_off(&figures, &energy));
    for (share, has_decay, is_longer) in [
        (1e-5, true, false),
        (1e-4, true, true),
        (1e-4, false, false),
        (2e-3, false, true),
    ] {
        figures.cut_off[2] = Some(share);
        figures.bands[2].edt_s = has_decay.then_some(1.0);
        assert_eq!(
            is_cut_off(&figures, &energy),
            is_longer,
            "{share} {has_decay}"
        );
    }
    figures.cut_off[2] = None;
    assert!(is_cut_off(&figures, &energy));
    energy[2] = 0.0;
    assert!(!is_cut_off(&figures, &energy));
}

/// Protects T30 from more and more waves in a record that is too short: if halves of the waves do not give T30, because
/// their decays end beyond the record, the record becomes longer.
#[test]
fn a_decay_that_ends_beyond_the_record_for_half_of_the_waves_is_cut_off() {
    let most = Figures::most_cut_off();
    let is_longer = |noise: Option<f64>, share: f64| {
        let mut figures = Figures::omitted();
        for band in 0..BAND_COUNT {
            figures.bands[band].edt_s = Some(2.0);
            figures.cut_off[band] = Some(share);
            let t30 = &mut figures.precision[band][2];
            (t30.value, t30.noise) = (Some(2.0), noise);
        }
        is_cut_off(&figures, &[1.0; BAND_COUNT])
    };
    assert!(!is_longer(Some(0.02), 0.7 * most) && is_longer(Some(0.02), 1.1 * most));
    assert!(!is_longer(None, 0.3 * most) && is_longer(None, 0.7 * most));
}
