//! Estimates what the waves have missed from what they have found.
//!
//! A path is found if one of the waves that pass the listener belongs to it, and each such wave
//! belongs to it with a probability p proportional to the energy that it brings without absorption.
//! Good (*The population frequencies of species*, Biometrika 40, 1953, after Turing): if of n waves
//! that found paths, f₁ found one that no other wave found, the paths that no wave found together
//! have a probability of about f₁/n. Chao (*Nonparametric estimation of the number of classes in a
//! population*, 1984, in its bias-corrected form): their number is at least about f₁ (f₁ − 1) / (2
//! (f₂ + 1)), where f₂ is the number of paths found by two waves. If most paths are weak, as at
//! balls and pillars, there are many more; the first estimate, of their energy, does not suffer
//! from that.
//!
//! A path that was also searched for is known whether waves find it or not: it counts among the n
//! waves, but not as a path that only one wave found.
//!
//! The estimate does not include paths that no wave can find: those at users' fields, and those
//! beyond the maximum order of the waves.

use super::paths::SpecularPath;

/// Estimate of the early part that the waves, and the additional search, have missed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Missed {
    /// Number of waves that found a path.
    pub waves: u64,
    /// Number of paths that exactly one wave found, and the search did not.
    pub found_once: u64,
    /// Number of paths that exactly two waves found, and the search did not.
    pub found_twice: u64,
}

impl Missed {
    /// Estimates from the waves and searches that found each of these paths.
    pub fn of(paths: &[SpecularPath]) -> Missed {
        let mut missed = Missed::default();
        for path in paths {
            let once_or_twice = |times: u32| !path.is_searched && path.found_by == times;
            missed.waves += u64::from(path.found_by);
            missed.found_once += u64::from(once_or_twice(1));
            missed.found_twice += u64::from(once_or_twice(2));
        }
        missed
    }

    /// The share, 0 to 1, of missed paths in the energy of all paths without absorption; also the
    /// probability that the next wave passing the listener finds a new path. `None` if no wave
    /// found any. Its standard deviation is about √(f₁ + 2 f₂) / n (Good 1953, with f₂ the number
    /// of paths that two waves found).
    pub fn energy_share(&self) -> Option<f64> {
        (self.waves > 0).then(|| self.found_once as f64 / self.waves as f64)
    }

    /// Estimated minimum number of missed paths.
    pub fn paths(&self) -> f64 {
        let once = self.found_once as f64;
        once * (once - 1.0).max(0.0) / (2.0 * (self.found_twice as f64 + 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the estimate: paths that only one wave found indicate more, unless a search finds them
    /// anyway.
    #[test]
    fn what_a_search_finds_is_not_missed() {
        let found = |by_waves: &[u32], is_searched: bool| {
            let path = |found_by: &u32| SpecularPath {
                found_by: *found_by,
                is_searched,
                ..SpecularPath::default()
            };
            Missed::of(&by_waves.iter().map(path).collect::<Vec<_>>())
        };
        let missed = found(&[1, 1, 2, 6], false);
        assert_eq!(missed.energy_share(), Some(0.2));
        assert_eq!(missed.paths(), 0.5);
        assert_eq!(found(&[1, 1, 2, 6], true).energy_share(), Some(0.0));
        assert_eq!(found(&[0], true).energy_share(), None);
    }
}
