//! Which rows are worth having.

use super::report::{Recommendation, Row};

/// Iterations that rows are compared at: with more, or fewer, the panning to be found is
/// another one.
pub const ITERATIONS: u32 = 8;

/// The rows that recommendations and pictures are of.
pub fn comparable(rows: &[Row]) -> impl Iterator<Item = &Row> {
    rows.iter().filter(|row| row.case.iterations == ITERATIONS)
}

/// The fastest row whose panning error is at most `error`.
pub fn fastest(rows: &[Row], error: f64) -> Option<Recommendation> {
    let good = comparable(rows).filter(|row| row.panning.rms <= error);
    let best = good.min_by(|a, b| a.speed.total_ms.total_cmp(&b.speed.total_ms));
    best.map(recommended)
}

/// The row of the least panning error.
pub fn best(rows: &[Row]) -> Option<Recommendation> {
    let best = comparable(rows).min_by(|a, b| a.panning.rms.total_cmp(&b.panning.rms));
    best.map(recommended)
}

fn recommended(row: &Row) -> Recommendation {
    Recommendation {
        label: row.label.clone(),
        case: row.case.clone(),
        total_ms: row.speed.total_ms,
        rms: row.panning.rms,
    }
}

/// The points (time, error) that no other beats in both, by time: errors fall along it.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|last| point.1 < last.1) {
            front.push(point);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the front from points that another one beats, and from losing any.
    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [(2.0, 1.0), (1.0, 3.0), (3.0, 1.0), (2.0, 2.0), (4.0, 0.5)];
        assert_eq!(pareto_front(&points), [(1.0, 3.0), (2.0, 1.0), (4.0, 0.5)]);
        assert_eq!(pareto_front(&[]), []);
    }
}
