//! What `echomarch study` prints.

use crate::cli::options::Common;
use crate::cli::print;
use crate::study::{Estimate, Joined, Shard, Study};
use indicatif::{HumanBytes, HumanCount, HumanDuration};
use serde_json::json;
use std::path::Path;
use std::time::Duration;

/// What a study takes.
pub fn estimate(
    common: &Common,
    study: &Study,
    renderer: &str,
    estimate: &Estimate,
) -> anyhow::Result<()> {
    let seconds = estimate.seconds();
    let shards = estimate.shard_bytes_a_point * estimate.points as f64;
    let csv = estimate.csv_bytes_a_point * estimate.points as f64;
    if common.json {
        return print::json(&json!({
            "name": study.name(), "study": study.hash(), "renderer": renderer,
            "sample": estimate, "seconds": seconds,
            "points_a_core_hour": estimate.points_a_core_hour(),
            "shard_bytes": shards, "csv_bytes": csv,
        }));
    }
    let (mean, error) = (estimate.seconds_a_point, estimate.seconds_a_point_error);
    let mut lines = vec![
        format!(
            "{}: {} points; a sample of {} took {:.3} ms each, ± {:.3} ms",
            study.name(),
            HumanCount(estimate.points),
            estimate.sampled,
            1e3 * mean,
            1e3 * error
        ),
        format!(
            "  in one process here  {}",
            match seconds < 1.0 {
                true => "less than a second".to_owned(),
                false => {
                    let time = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
                    HumanDuration(time).to_string()
                }
            }
        ),
    ];
    if let Some(points) = estimate.points_a_core_hour() {
        let points = HumanCount(points as u64);
        lines.push(format!("  points a core hour   {points}"));
    }
    lines.push(format!(
        "  shards               {}",
        HumanBytes(shards as u64)
    ));
    lines.push(format!("  study.csv            {}", HumanBytes(csv as u64)));
    print::line(&lines.join("\n"))
}

/// A shard that is whole.
pub fn shard(common: &Common, study: &Study, shard: Shard, folder: &Path) -> anyhow::Result<()> {
    let file = shard.file(folder).display().to_string();
    let points = shard.points(study.points());
    if common.json {
        return print::json(&json!({
            "name": study.name(), "study": study.hash(), "shard": shard.number(),
            "of": shard.of(), "points": points, "file": file,
        }));
    }
    print::line(&format!("shard {shard}: {points} points in {file}"))
}

/// Tables and pictures.
pub fn joined(common: &Common, study: &Study, joined: &Joined) -> anyhow::Result<()> {
    let files: Vec<String> = joined
        .files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    if common.json {
        return print::json(&json!({
            "name": study.name(), "study": study.hash(), "renderer": joined.renderer,
            "points": joined.points, "shards": joined.shards, "files": files,
        }));
    }
    let (points, shards) = (joined.points, joined.shards);
    let s = if shards == 1 { "" } else { "s" };
    print::line(&format!(
        "{}: {points} points of {shards} shard{s}\nwritten: {}",
        study.name(),
        files.join(", ")
    ))
}
