//! The rows as CSV, a line a scene and setting.

use super::report::{AccuracyReport, Row, SceneReport};
use crate::text::csv_cell;
use std::io::{self, Write};

/// The first line: times in milliseconds, distances in metres, shares from 0 to 1.
pub const COLUMNS: [&str; 41] = [
    "scene",
    "setting",
    "profile",
    "min_distance",
    "iterations",
    "waves",
    "directions",
    "exact_normals",
    "landing",
    "fused",
    "sum_on_gpu",
    "total_ms",
    "march_ms",
    "million_wave_iterations_per_second",
    "evaluations_per_segment",
    "frames",
    "compared",
    "status_differs",
    "sequence_differs",
    "not_finite",
    "end_median",
    "end_p99",
    "end_max",
    "within_horizon_median",
    "within_horizon_p99",
    "within_horizon_max",
    "beyond_horizon",
    "hits_by_order",
    "exact_hits_by_order",
    "pan_mean",
    "pan_limit",
    "pan_limit_bias",
    "pan_twin_bias",
    "pan_twin_bias_error",
    "pan_twin_seeds",
    "pan_spread",
    "pan_rms",
    "efficiency",
    "sum_error",
    "renderer",
    "clock",
];

/// Writes the report's rows; columns as in [`COLUMNS`].
///
/// # Errors
/// Those of `out`.
pub fn write_csv(report: &AccuracyReport, out: &mut dyn Write) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    for scene in &report.scenes {
        for row in &scene.rows {
            let mut record = settings(scene, row);
            record.extend(waves(row));
            record.extend(panning(scene, row));
            record.push(report.renderer.clone());
            record.push(report.clock.clone());
            writer.write_record(record)?;
        }
    }
    writer.flush()
}

fn settings(scene: &SceneReport, row: &Row) -> Vec<String> {
    let (case, speed) = (&row.case, &row.speed);
    let metres = case.min_distance.map(|metres| metres.to_string());
    vec![
        csv_cell(&scene.scene),
        csv_cell(&row.label),
        case.profile.clone(),
        metres.unwrap_or_default(),
        case.iterations.to_string(),
        case.waves.to_string(),
        case.directions.clone(),
        case.exact_normals.to_string(),
        case.landing.to_string(),
        case.fused.to_string(),
        case.sum_on_gpu.to_string(),
        format!("{:.4}", speed.total_ms),
        format!("{:.4}", speed.march_ms),
        format!("{:.4}", speed.million_per_second),
        format!("{:.4}", speed.evaluations_per_segment),
        speed.frames.to_string(),
    ]
}

fn waves(row: &Row) -> Vec<String> {
    let waves = &row.waves;
    let by_order = |hits: &[u64]| {
        let hits: Vec<String> = hits.iter().map(u64::to_string).collect();
        hits.join(" ")
    };
    let (end, within) = (&waves.end, &waves.end_within_horizon);
    vec![
        waves.compared.to_string(),
        format!("{:.7}", waves.status_differs),
        format!("{:.7}", waves.sequence_differs),
        waves.not_finite.to_string(),
        format!("{:.4e}", end.median),
        format!("{:.4e}", end.p99),
        format!("{:.4e}", end.max),
        format!("{:.4e}", within.median),
        format!("{:.4e}", within.p99),
        format!("{:.4e}", within.max),
        format!("{:.7}", waves.beyond_horizon),
        by_order(&waves.hits),
        by_order(&waves.exact_hits),
    ]
}

fn panning(scene: &SceneReport, row: &Row) -> Vec<String> {
    let panning = &row.panning;
    let limit = scene
        .limits
        .iter()
        .find(|limit| limit.iterations == row.case.iterations);
    let sum_error = panning.sum_error.map(|error| format!("{error:.3e}"));
    vec![
        format!("{:.7}", panning.mean),
        limit
            .map(|limit| format!("{:.7}", limit.pan))
            .unwrap_or_default(),
        format!("{:.4e}", panning.limit_bias),
        format!("{:.4e}", panning.twin_bias),
        format!("{:.4e}", panning.twin_bias_error),
        panning.twin_seeds.to_string(),
        format!("{:.4e}", panning.spread),
        format!("{:.4e}", panning.rms),
        format!("{:.5e}", panning.efficiency),
        sum_error.unwrap_or_default(),
    ]
}
