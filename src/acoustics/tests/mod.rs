//! Compares the complete computation, from arrivals to figures, with exact energies.

mod shoebox;
mod waves;

/// The mean; NaN for no values.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}
