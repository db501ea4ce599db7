//! What the waves have missed, estimated from what they have found.
//!
//! A path is found if one of the waves that pass by the listener belongs to it, and each such
//! wave belongs to it with a probability p in proportion to the energy that it brings without
//! absorption. Good (*The population frequencies of species*, Biometrika 40, 1953, after Turing):
//! of n waves that found paths, f₁ found one that no other wave found; then the paths that none
//! found have together a probability of about f₁/n. Chao (*Nonparametric estimation of the
//! number of classes in a population*, 1984, in its form without bias): they are at least some
//! f₁ (f₁ − 1) / (2 (f₂ + 1)), f₂ those found by two. Where most paths are weak, as off balls and
//! pillars, they are many more; the first estimate, of their energy, does not suffer from that.
//!
//! A path that was looked for besides the waves is known whether waves find it or not: it counts
//! among the n waves, and is no path that one wave alone found.
//!
//! What no wave can find is not in it: paths at users' fields, and those beyond the order that
//! waves were followed to.

use super::paths::SpecularPath;

/// How much of the early part the waves, and the search besides, have missed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Missed {
    /// Waves that found a path.
    pub waves: u64,
    /// Paths that exactly one wave found, and no search besides.
    pub found_once: u64,
    /// Paths that exactly two waves found, and no search besides.
    pub found_twice: u64,
}

impl Missed {
    /// From what found each of these paths.
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

    /// The share, 0 to 1, that missed paths have of the energy of all paths without absorption;
    /// also the probability that the next wave to pass by finds a new path. `None` when no
    /// wave found any. Its standard deviation is about
    /// √(f₁ + 2 f₂) / n (Good 1953, with f₂ the paths that two waves found).
    pub fn energy_share(&self) -> Option<f64> {
        (self.waves > 0).then(|| self.found_once as f64 / self.waves as f64)
    }

    /// How many paths were missed at least.
    pub fn paths(&self) -> f64 {
        let once = self.found_once as f64;
        once * (once - 1.0).max(0.0) / (2.0 * (self.found_twice as f64 + 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the estimate: paths that one wave found speak of more, unless a search knows them anyway.
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
