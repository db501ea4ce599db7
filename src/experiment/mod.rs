//! The thesis' experiments, run for real and set beside its own figures.
//!
//! An experiment takes a [`Tracer`](crate::Tracer), does its work in an order that is
//! fair to what it compares, and returns plain data. The files beside it turn that data
//! into CSV and SVG; the program prints it.

pub mod accuracy;
pub mod cost;
pub mod figures;
mod figures_csv;
mod figures_plot;
pub mod localise;
mod log_plot;
mod thesis_tables;
pub mod verify;

pub use thesis_tables::{THESIS_TABLES, ThesisRow, ThesisTable, WAVE_COUNTS};

/// The middle of some values; the mean of the two middle ones for an even number.
/// 0 for none.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => 0.0,
        n if n % 2 == 1 => sorted[middle],
        _ => 0.5 * (sorted[middle - 1] + sorted[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::median;

    /// Protects the figure that every time in a report is.
    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median([3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median([]), 0.0);
    }
}
