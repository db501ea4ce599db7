//! Estimates the size and cost of a study from a short sample: points, time, bytes.

use super::work::row;
use super::{BLOCK, StudyError, Worker, lines};
use echomarch::internals::sampling::GOLDEN_GAMMA;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Maximum number of blocks in a sample.
const MOST_SAMPLED: u64 = 64;

/// Minimum number of blocks in a sample, however long they take. A standard error needs at least two.
const LEAST_SAMPLED: u64 = 3;

/// Maximum time of a sample, including warm-up.
const LONGEST: Duration = Duration::from_secs(20);

/// The cost of a study, estimated from a sample of its points.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Estimate {
    /// Number of points of the study.
    pub points: u64,
    /// Number of points, spread over the study, that were computed for the estimate.
    pub sampled: u64,
    /// Wall-clock time per point in seconds: the mean of the sample.
    pub seconds_a_point: f64,
    /// Standard error of the time per point, including the differences between points.
    pub seconds_a_point_error: f64,
    /// Processor time per point in seconds, summed over the cores; `None` if the system does not report it.
    pub core_seconds_a_point: Option<f64>,
    /// Number of bytes per point in a shard.
    pub shard_bytes_a_point: f64,
    /// Number of bytes per point in the joined CSV.
    pub csv_bytes_a_point: f64,
}

impl Estimate {
    /// Wall-clock time of the whole study in seconds, in one process on this machine.
    pub fn seconds(&self) -> f64 {
        self.seconds_a_point * self.points as f64
    }

    /// Number of points per core and hour; `None` if the system does not report processor time.
    pub fn points_a_core_hour(&self) -> Option<f64> {
        let seconds = self.core_seconds_a_point.filter(|seconds| *seconds > 0.0)?;
        Some(3600.0 / seconds)
    }
}

/// Computes each block of a sample twice, and times the second computation. The first computation compiles the shaders
/// of the scene, which happens only once in a study. The results are discarded.
///
/// # Errors
/// [`StudyError::Point`] for a point that cannot be computed.
pub fn estimate(worker: &mut Worker) -> Result<Estimate, StudyError> {
    let study = worker.study;
    let began = Instant::now();
    let (mut seconds, mut core_seconds) = (Vec::new(), Some(0.0));
    let (mut shard_bytes, mut csv_bytes) = (0, 0);
    let blocks = study.points.div_ceil(BLOCK);
    let mut points = 0;
    for number in 0..MOST_SAMPLED.min(blocks) {
        if number >= LEAST_SAMPLED && began.elapsed() > LONGEST {
            break;
        }
        let block = study.block(sampled(blocks, number));
        worker.found(&block)?;
        let (clock, cores) = (Instant::now(), processor_seconds());
        let found = worker.found(&block)?;
        points += block.len() as u64;
        let a_point = 1.0 / block.len() as f64;
        seconds.push(clock.elapsed().as_secs_f64() * a_point);
        let taken = processor_seconds()
            .zip(cores)
            .map(|(end, begin)| (end - begin) * a_point);
        core_seconds = core_seconds.zip(taken).map(|(sum, more)| sum + more);
        for (point, found) in block.iter().zip(&found) {
            let row = row(point.index, found);
            shard_bytes += lines::line(&row).len();
            let scene = study.posed(point.variant, point.time);
            let before = scene.map_or(0, |scene| {
                let cells = study.point_cells(point, &scene).into_iter().skip(1);
                cells.map(|cell| cell.for_csv().len() + 1).sum()
            });
            csv_bytes += before + row.len() + 1;
        }
    }
    let sampled = seconds.len() as f64;
    let mean = crate::stats::mean(seconds.iter().copied()).unwrap_or(0.0);
    let squares: f64 = seconds.iter().map(|s| (s - mean).powi(2)).sum();
    let variance = squares / (sampled - 1.0).max(1.0);
    Ok(Estimate {
        points: study.points,
        sampled: points,
        seconds_a_point: mean,
        seconds_a_point_error: (variance / sampled.max(1.0)).sqrt(),
        core_seconds_a_point: core_seconds.map(|sum: f64| sum / sampled.max(1.0)),
        shard_bytes_a_point: shard_bytes as f64 / points.max(1) as f64,
        csv_bytes_a_point: csv_bytes as f64 / points.max(1) as f64,
    })
}

/// The index of a sample block. A small study is sampled at every block, a larger one at evenly spread blocks. The
/// multiples of 2⁶⁴ divided by the golden ratio, as shares of 2⁶⁴, are evenly spread for any number of multiples (D. E.
/// Knuth, *The Art of Computer Programming* 3, section 6.4).
fn sampled(blocks: u64, number: u64) -> u64 {
    if blocks <= MOST_SAMPLED {
        return number;
    }
    let share = u128::from((number + 1).wrapping_mul(GOLDEN_GAMMA));
    ((share * u128::from(blocks)) >> 64) as u64
}

/// Processor time used by this process, summed over its threads.
#[cfg(target_os = "linux")]
fn processor_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(target_os = "linux"))]
fn processor_seconds() -> Option<f64> {
    None
}
