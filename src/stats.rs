//! Mean, median and quantiles: one definition for every report.
//!
//! A quantile is interpolated linearly between order statistics: of *n* sorted values, the quantile
//! of share *p* is at position (*n* − 1)*p*, counted from 0. This is type 7 of R. J. Hyndman and Y.
//! Fan, *Sample Quantiles in Statistical Packages*, The American Statistician 50 (4), 1996. The
//! median of an even number of values is therefore the mean of the two in the middle.

/// The quantiles of these shares, each 0 … 1; 0 without values.
pub fn quantiles<const N: usize>(
    values: impl IntoIterator<Item = f64>,
    shares: [f64; N],
) -> [f64; N] {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    shares.map(|share| at(&sorted, share))
}

/// The median; 0 without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let [median] = quantiles(values, [0.5]);
    median
}

/// The arithmetic mean; `None` without values.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let add = |(sum, count): (f64, usize), value| (sum + value, count + 1);
    let (sum, count) = values.into_iter().fold((0.0, 0), add);
    (count > 0).then(|| sum / count as f64)
}

fn at(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let (low, weight) = (place.floor() as usize, place.fract());
    let (below, above) = (sorted[low], sorted[(low + 1).min(last)]);
    // Interpolation between equal values would add rounding, and 0 times infinity is NaN.
    if weight == 0.0 || below == above {
        return below;
    }
    (1.0 - weight) * below + weight * above
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the median, which every time in a report is.
    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median([3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median([]), 0.0);
    }

    /// Protects the definition: the positions of type 7, where types 1 to 6 give other values.
    #[test]
    fn quantiles_are_interpolated_between_order_statistics() {
        let ten = || (1..=10).rev().map(f64::from);
        let found = quantiles(ten(), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(found, [1.0, 3.25, 5.5, 7.75, 10.0]);
        let [p99] = quantiles((1..=101).map(f64::from), [0.99]);
        assert_eq!(p99, 100.0);
    }

    /// Protects reports from NaN and rounding with infinite or equal values.
    #[test]
    fn equal_and_infinite_values_stay_what_they_are() {
        assert_eq!(quantiles([0.1; 4], [0.3, 0.99]), [0.1, 0.1]);
        assert_eq!(quantiles([7.0], [0.5, 0.99]), [7.0, 7.0]);
        assert_eq!(quantiles([], [0.5, 1.0]), [0.0, 0.0]);
        let some_infinite = [1.0, 2.0, f64::INFINITY];
        assert_eq!(quantiles(some_infinite, [0.5, 1.0]), [2.0, f64::INFINITY]);
    }

    /// Protects the mean of no values from being a number.
    #[test]
    fn the_mean_of_nothing_is_none() {
        assert_eq!(mean([]), None);
        assert_eq!(mean([1.0, 2.0, 6.0]), Some(3.0));
    }
}
