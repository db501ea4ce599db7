//! The recommended setting: the fastest row whose error does not exceed the stated error.

use super::report::{Recommendation, Row};

/// The number of iterations at which rows are compared. The panning limit differs between numbers of iterations.
pub const ITERATIONS: u32 = 8;

/// The rows used for recommendations, plots and targets. Rows without hits are excluded: their panning is 0, which is
/// close to the truth only by chance.
pub fn comparable(rows: &[Row]) -> impl Iterator<Item = &Row> {
    rows.iter().filter(|row| {
        let hears = row.waves.hits.iter().any(|&hits| hits > 0);
        hears && row.case.iterations == ITERATIONS
    })
}

/// The fastest row whose panning error is at most `error`.
pub fn fastest(rows: &[Row], error: f64) -> Option<Recommendation> {
    let good = comparable(rows).filter(|row| row.panning.rms <= error);
    let best = good.min_by(|a, b| a.speed.total_ms.total_cmp(&b.speed.total_ms));
    best.map(recommended)
}

/// The row with the smallest panning error.
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

/// The points (time, error) that no other point beats in both coordinates. The points are sorted by increasing time,
/// and therefore by decreasing error.
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
    use crate::experiment::accuracy::{CaseReport, PanningError, Speed, WaveErrors};

    fn row(label: &str, hits: u64, total_ms: f64, rms: f64) -> Row {
        Row {
            label: label.to_owned(),
            case: CaseReport {
                iterations: ITERATIONS,
                ..CaseReport::default()
            },
            speed: Speed {
                total_ms,
                ..Speed::default()
            },
            waves: WaveErrors {
                hits: vec![0, hits],
                ..WaveErrors::default()
            },
            panning: PanningError {
                rms,
                ..PanningError::default()
            },
        }
    }

    /// Protects the recommendation: it is neither a row without hits nor an unnecessarily slow row.
    #[test]
    fn the_fastest_good_row_that_hears_is_recommended() {
        let deaf = row("deaf", 0, 1.0, 0.001);
        let slow = row("slow", 9, 20.0, 0.005);
        let good = row("good", 9, 10.0, 0.01);
        let rows = [deaf, slow, good];
        let label = |of: Option<Recommendation>| of.map(|of| of.label);
        assert_eq!(label(fastest(&rows, 0.02)).as_deref(), Some("good"));
        assert_eq!(label(fastest(&rows, 0.007)).as_deref(), Some("slow"));
        assert_eq!(label(fastest(&rows, 0.002)), None);
        assert_eq!(label(best(&rows)).as_deref(), Some("slow"));
        assert_eq!(label(best(&rows[..1])), None);
        let mut longer = rows[2].clone();
        longer.case.iterations = 2 * ITERATIONS;
        assert_eq!(label(fastest(&[longer], 0.02)), None);
    }

    /// Protects the Pareto front: it contains exactly the points that no other point beats.
    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [(2.0, 1.0), (1.0, 3.0), (3.0, 1.0), (2.0, 2.0), (4.0, 0.5)];
        assert_eq!(pareto_front(&points), [(1.0, 3.0), (2.0, 1.0), (4.0, 0.5)]);
        assert_eq!(pareto_front(&[]), []);
    }
}
