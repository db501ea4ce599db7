//! The number of waves of the next trace, from the time of the last one.

pub use echomarch::internals::wave_budget::{LEAST_WAVES, TraceTime};

/// Maximum number of waves of a response. More are not needed: the echoes are exact, and the late part is replaced
/// after a quarter of a second.
pub const MOST_WAVES: u32 = 16_384;

/// Usual minimum number of waves for late arrivals. With fewer waves, the energy of each 10 ms consists of only a few
/// arrivals, and the late part sounds rough.
pub const LEAST_LATE_WAVES: u32 = 1024;

/// Maximum duration, in seconds, of a trace with more than the minimum number of waves. If a trace would take longer, a
/// rough late part and missing echoes are preferable to the sound of a place that the listener has left.
pub const LONGEST_LOOK_S: f64 = 1.0;

/// Target duration of a trace, in seconds. After a longer trace, the echoes lag behind the listener.
pub const LOOK_S: f64 = 0.25;

/// The number of waves for the next late part, after a trace of `before` waves that took `took`.
pub fn late_waves(before: u32, took: TraceTime) -> u32 {
    let usual = fitting(before, took, LOOK_S);
    usual.max(fitting(before, took, LONGEST_LOOK_S).min(LEAST_LATE_WAVES))
}

/// The number of waves for the next early arrivals, after a trace of `before` waves that took `took`.
pub fn early_waves(before: u32, took: TraceTime) -> u32 {
    fitting(before, took, LONGEST_LOOK_S)
}

/// The number of waves, within the limits, of a trace of `seconds` with the same diffraction.
fn fitting(before: u32, took: TraceTime, seconds: f64) -> u32 {
    took.fitting(before, seconds, &(LEAST_WAVES..=MOST_WAVES))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn without_diffraction(seconds: f64) -> TraceTime {
        TraceTime::new(Duration::from_secs_f64(seconds), 0.0)
    }

    /// Protects the number of waves beside a long diffraction: it stays the same from trace to trace, and does not fall
    /// to the minimum.
    #[test]
    fn waves_share_the_time_that_diffraction_leaves() {
        // Seconds per wave, and of diffraction; the number of waves for late and for early arrivals.
        for (wave_s, diffraction_s, late, early) in [
            (1.0 / 8192.0, 0.125, 1024, 7168),
            (1.0 / 65536.0, 0.125, 8192, MOST_WAVES),
            (1.0 / 8192.0, 2.0, 1024, 2048),
            (1.0 / 1024.0, 2.0, 256, 256),
        ] {
            let took = |waves: u32| {
                let whole = f64::from(waves) * wave_s + diffraction_s;
                TraceTime::new(Duration::from_secs_f64(whole), 1e3 * diffraction_s)
            };
            let mut waves = [LEAST_WAVES; 2];
            for look in 0..4 {
                let [of_late, of_early] = waves;
                waves = [
                    late_waves(of_late, took(of_late)),
                    early_waves(of_early, took(of_early)),
                ];
                for (waves, expected) in waves.iter().zip([late, early]) {
                    assert!(
                        waves.abs_diff(expected) <= 1,
                        "trace {look}: {waves}, not {expected}"
                    );
                }
            }
        }
    }

    /// Protects the user from waiting seconds for echoes, and the late part from unnecessary roughness.
    #[test]
    fn late_waves_follow_the_time_of_looks() {
        let after = |before, seconds| late_waves(before, without_diffraction(seconds));
        assert_eq!(after(8192, LOOK_S), 8192);
        assert_eq!(after(8192, 2.0 * LOOK_S), 4096);
        assert_eq!(after(2048, 0.5 * LOOK_S), 4096);
        assert_eq!(after(2048, 0.0), MOST_WAVES);
        assert_eq!(after(MOST_WAVES, 4.0), LEAST_LATE_WAVES);
        assert_eq!(after(2048, 1.5), LEAST_LATE_WAVES);
        assert_eq!(after(1024, 4.0), 256);
        assert_eq!(after(1024, 600.0), LEAST_WAVES);
    }

    /// Protects the user of an expensive field from waiting for a minute, and checks that cheap scenes keep all echoes.
    #[test]
    fn early_waves_are_as_many_as_take_a_second() {
        let after = |before, seconds| early_waves(before, without_diffraction(seconds));
        assert_eq!(after(LEAST_WAVES, 0.001), MOST_WAVES);
        assert_eq!(after(MOST_WAVES, LONGEST_LOOK_S), MOST_WAVES);
        assert_eq!(after(8192, 2.0 * LONGEST_LOOK_S), 4096);
        assert_eq!(after(1024, 40.0), LEAST_WAVES);
    }
}
