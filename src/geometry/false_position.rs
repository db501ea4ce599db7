//! The root of a function along a line.

/// Maximum number of steps. False position needs about ten.
const MOST_STEPS: usize = 60;

/// The point between two samples (position in metres, value) of opposite signs at which a function is 0, by false
/// position with halved ends (the Illinois method). The value there is at most `touch`, or its sign changes within
/// `touch` metres.
pub(super) fn root(
    value: impl Fn(f64) -> f64,
    [mut before, mut after]: [(f64, f64); 2],
    touch: f64,
) -> f64 {
    let mut was_before = None;
    for _ in 0..MOST_STEPS {
        let share = before.1 / (before.1 - after.1);
        let t = before.0 + share * (after.0 - before.0);
        let middle = (t, value(t));
        if middle.1.abs() <= touch || after.0 - before.0 <= touch {
            return t;
        }
        let is_before = (middle.1 > 0.0) == (before.1 > 0.0);
        let (moved, other) = match is_before {
            true => (&mut before, &mut after),
            false => (&mut after, &mut before),
        };
        *moved = middle;
        if was_before == Some(is_before) {
            other.1 *= 0.5;
        }
        was_before = Some(is_before);
    }
    before.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// Protects the root, and the number of evaluations, for rising and falling functions, straight and bent ones, and
    /// one that is almost flat beside the root.
    #[test]
    fn roots_take_few_evaluations() {
        let functions: [(&dyn Fn(f64) -> f64, f64); 5] = [
            (&|t| 3.0 * (t - 0.3), 0.3),
            (&|t| 0.2 - t, 0.2),
            (&|t| (t + 1.0).powi(2) - 2.0, 2.0_f64.sqrt() - 1.0),
            (
                &|t| (3.0 - t).hypot(0.1) - 2.5,
                3.0 - (6.25_f64 - 0.01).sqrt(),
            ),
            (&|t| (t - 0.9_f64).powi(3), 0.9),
        ];
        for (index, (function, expected)) in functions.into_iter().enumerate() {
            let calls = Cell::new(0);
            let counted = |t| {
                calls.set(calls.get() + 1);
                function(t)
            };
            let ends = [0.0, 1.0].map(|t| (t, function(t)));
            let found = root(counted, ends, 1e-12);
            assert!(function(found).abs() <= 1e-12, "{index}: {found}");
            assert!((found - expected).abs() < 2e-4, "{index}: {found}");
            assert!(calls.get() <= MOST_STEPS / 2, "{index}: {}", calls.get());
        }
    }
}
