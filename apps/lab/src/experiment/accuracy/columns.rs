//! The columns of the table of settings and of the table of targets.

use super::report::{AccuracyReport, Row, SceneReport, Target, WaveErrors};
use crate::columns;
use crate::report::{self, Column, significant};

/// A row of the report, with its scene.
pub(super) struct Line<'a> {
    pub report: &'a AccuracyReport,
    pub scene: &'a SceneReport,
    pub row: &'a Row,
}

impl report::Row for Line<'_> {
    /// Times are in milliseconds and distances in metres. In CSV and JSON, shares are numbers from 0 to 1.
    fn columns() -> Vec<Column<Self>> {
        columns! { line: Line;
            ("scene") => &line.scene.scene;
            ("setting", "setting") => &line.row.label, text();
            ("profile") => &line.row.case.profile;
            ("min_distance") => line.row.case.min_distance;
            ("iterations", "it.") => line.row.case.iterations;
            ("waves", "waves") => line.row.case.waves;
            ("directions") => &line.row.case.directions;
            ("fused") => line.row.case.fused;
            ("sum_on_gpu") => line.row.case.sum_on_gpu;
            ("total_ms", "frame") => line.row.speed.total_ms, unit("ms").fixed(2);
            ("march_ms") => line.row.speed.march_ms;
            ("million_wave_iterations_per_second", "M/s") => line.row.speed.million_per_second, fixed(1);
            ("evaluations_per_flight", "eval/flight") => line.row.speed.evaluations_per_flight, fixed(1);
            ("frames") => line.row.speed.frames;
            ..waves();
            ..panning();
            ("renderer") => &line.report.renderer;
            ("clock") => &line.report.clock;
        }
    }
}

fn waves<'a>() -> Vec<Column<Line<'a>>> {
    columns! { line: Line;
        ("compared") => line.row.waves.compared;
        ("flights") => line.row.waves.flights;
        ("status_differs", "status") => line.row.waves.status_differs, percent(3);
        ("sequence_differs", "sequence") => line.row.waves.sequence_differs, percent(3);
        ("not_finite", "NaN") => line.row.waves.not_finite;
        ("end_median", "end: median") => line.row.waves.end.median, unit("m").significant(2);
        ("end_p99", "99 %") => line.row.waves.end.p99, unit("m").significant(2);
        ("end_max", "largest") => line.row.waves.end.max, unit("m").significant(2);
        ("within_horizon_median") => line.row.waves.end_within_horizon.median;
        ("within_horizon_p99", "within: 99 %") => line.row.waves.end_within_horizon.p99, unit("m").significant(2);
        ("within_horizon_max", "largest") => line.row.waves.end_within_horizon.max, unit("m").significant(2);
        ("beyond_horizon") => line.row.waves.beyond_horizon;
        ("hits_by_order") => by_order(&line.row.waves.hits);
        ("exact_hits_by_order") => by_order(&line.row.waves.exact_hits);
        (_, "exact hits") => line.row.waves.exact_hits.iter().sum::<u64>();
        (_, "hits, less exact by order") => hits_less_exact(&line.row.waves);
    }
}

fn by_order(hits: &[u64]) -> String {
    let hits: Vec<String> = hits.iter().map(u64::to_string).collect();
    hits.join(" ")
}

/// The number of waves heard minus the exact number, by order of reflection.
fn hits_less_exact(waves: &WaveErrors) -> String {
    let pairs = waves.hits.iter().zip(&waves.exact_hits);
    let off = pairs.map(|(&hits, &exact)| match hits as i128 - exact as i128 {
        0 => "0".to_owned(),
        off => format!("{off:+}"),
    });
    off.collect::<Vec<String>>().join(" ")
}

fn panning<'a>() -> Vec<Column<Line<'a>>> {
    let limit = |line: &Line| {
        let mut limits = line.scene.limits.iter();
        let limit = limits.find(|limit| limit.iterations == line.row.case.iterations);
        limit.map(|limit| limit.pan)
    };
    columns! { line: Line;
        ("pan_mean", "pan") => line.row.panning.mean, signed(4);
        ("pan_limit") => limit(line);
        ("pan_limit_bias", "limit bias") => line.row.panning.limit_bias, signed(4);
        ("pan_twin_bias", "twin bias") => line.row.panning.twin_bias, signed(4);
        ("pan_twin_bias_error", "± twin") => line.row.panning.twin_bias_error, fixed(4);
        ("pan_twin_seeds") => line.row.panning.twin_seeds;
        ("pan_spread", "spread") => line.row.panning.spread, fixed(4);
        ("pan_rms", "rms") => line.row.panning.rms, fixed(4);
        ("efficiency", "efficiency") => line.row.panning.efficiency, fixed(0);
        ("sum_error", "GPU sum off by") => line.row.panning.sum_error, significant(1);
    }
}

impl report::Row for &Target {
    fn columns() -> Vec<Column<Self>> {
        let bound = |target: &&Target| {
            let relation = if target.at_least { "≥" } else { "≤" };
            target
                .bound
                .map(|bound| format!("{relation} {}", significant(bound, 2)))
        };
        let verdict = |target: &&Target| match target.met {
            Some(true) => "met",
            Some(false) => "not met",
            None => "for information",
        };
        columns! { target: &Target;
            ("what", "target") => &target.what, text();
            ("measured", "measured") => target.measured, significant(2);
            (_, "bound") => bound(target);
            (_, "verdict") => verdict(target), text();
        }
    }
}
