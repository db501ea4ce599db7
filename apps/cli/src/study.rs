//! `echomarch study`: computes sweeps and maps of many points.

mod jobs;
mod print_out;

use super::exit::BadInput;
use super::numbers::count;
use super::options::{Common, check_range};
use super::print;
use clap::Args;
use echomarch::internals::file_output::{check_inside, prepare_folder};
use echomarch_lab::study::{
    Joined, MOST_SHARDS, Shard, Study, StudyError, Worker, begun, check_map_files, check_maps,
    compute, draw_map, estimate, join,
};
use indicatif::ProgressBar;
use std::io::Read;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  echomarch study map.ron --count                  how many points, how long, how large
  echomarch study map.ron -o out                   all points; run again for missing ones
  echomarch study map.ron -o out --jobs 8          in eight processes
  echomarch study map.ron -o out --shard 3/16      one part, anywhere
  echomarch study map.ron -o out --join            the parts put together: CSV and Parquet
  echomarch study map.ron -o out --join --map pan  and a picture of a column

Study files, Slurm, GNU parallel: docs/clusters.md.";

/// Maximum number of processes in one run. The limit exceeds the number of processor cores of any common machine.
const MOST_JOBS: u32 = 1024;

/// Arguments of `study`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The study file (.ron)
    #[arg(value_name = "FILE")]
    study: PathBuf,
    /// The folder for shards and tables
    #[arg(short, long, value_name = "DIR", required_unless_present = "count")]
    output: Option<PathBuf>,
    /// Estimate the number of points, the run time (from a short sample) and the size of the table, and compute nothing
    /// else
    #[arg(long, conflicts_with_all = ["output", "shard", "join", "jobs", "map"])]
    count: bool,
    /// Compute shard K of N, without merging
    #[arg(long, value_name = "K/N", conflicts_with_all = ["join", "jobs", "map"])]
    shard: Option<Shard>,
    /// Merge the existing shards, without computing
    #[arg(long, conflicts_with = "jobs")]
    join: bool,
    /// Number of processes
    #[arg(long, allow_negative_numbers = true, default_value_t = 1, value_name = "N", value_parser = count::<u32>)]
    jobs: u32,
    /// Draw a map of this column of the table as map-COLUMN.png; repeatable
    #[arg(long, value_name = "COLUMN")]
    map: Vec<String>,
    /// Compute only on a renderer whose name and version contain this text
    #[arg(long, value_name = "TEXT", conflicts_with = "join")]
    require_renderer: Option<String>,
    /// Exit when standard input ends; used by the processes of --jobs
    #[arg(long, hide = true)]
    until_input_ends: bool,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    check_range(
        "--jobs",
        f64::from(arguments.jobs),
        1.0,
        f64::from(MOST_JOBS),
    )?;
    if arguments.until_input_ends {
        end_with_input()?;
    }
    let study = Study::from_file(&arguments.study)?;
    let Some(folder) = arguments.output.as_deref() else {
        let mut worker = worker(&study, arguments, common)?;
        let estimate = estimate(&mut worker)?;
        return print_out::estimate(common, &study, worker.renderer(), &estimate);
    };
    if let Some(shard) = arguments.shard {
        let mut worker = worker(&study, arguments, common)?;
        let points = shard.points(study.points());
        let bar = print::progress(common.quiet, points, "points");
        compute(&mut worker, shard, folder, &mut shown(&bar, 0))?;
        bar.finish_and_clear();
        return print_out::shard(common, &study, shard, folder);
    }
    check_maps(&study, &arguments.map)?;
    check_outputs(folder)?;
    check_map_files(&study, folder, &arguments.map)?;
    let mut worker = None;
    if !arguments.join {
        worker = compute_all(&study, folder, arguments, common)?;
    }
    let mut joined = joined(&study, folder, common)?;
    for column in &arguments.map {
        let worker = match &mut worker {
            Some(worker) => worker,
            none => none.insert(Worker::new(&study, common.tracer()?)),
        };
        joined.files.extend(draw_map(worker, folder, column)?);
    }
    print_out::joined(common, &study, &joined)
}

/// Creates a worker on the requested renderer. Returns an error if `--require-renderer` does not match the renderer.
fn worker<'a>(
    study: &'a Study,
    arguments: &Arguments,
    common: &Common,
) -> anyhow::Result<Worker<'a>> {
    let worker = Worker::new(study, common.tracer()?);
    match &arguments.require_renderer {
        Some(wanted) if !worker.renderer().contains(wanted) => Err(StudyError::OtherRenderer {
            renderer: worker.renderer().to_owned(),
            wanted: wanted.clone(),
        }
        .into()),
        _ => Ok(worker),
    }
}

/// Checks that the tables can be written and would not replace inputs. The check comes before hours of work.
fn check_outputs(folder: &Path) -> anyhow::Result<()> {
    prepare_folder(folder)?;
    for name in ["study.csv", "study.parquet", "study.json"] {
        check_inside(&folder.join(name))?;
    }
    Ok(())
}

/// Computes the missing points of all shards. The number of shards is the one with which the study was begun in this
/// folder. Returns the worker if it runs in this process.
fn compute_all<'a>(
    study: &'a Study,
    folder: &Path,
    arguments: &Arguments,
    common: &Common,
) -> anyhow::Result<Option<Worker<'a>>> {
    let of = begun(study, folder).unwrap_or(arguments.jobs.min(MOST_SHARDS));
    if of < arguments.jobs {
        common.note(&format!(
            "note: this study was begun in this folder with {of} shards, so at most {of} jobs run"
        ));
    }
    let bar = print::progress(common.quiet, study.points(), "points");
    if arguments.jobs > 1 && of > 1 {
        jobs::run(study, of, folder, arguments, common, &bar)?;
        bar.finish_and_clear();
        return Ok(None);
    }
    let mut worker = worker(study, arguments, common)?;
    let mut before = 0;
    for shard in Shard::all(of) {
        compute(&mut worker, shard, folder, &mut shown(&bar, before))?;
        before += shard.points(study.points());
    }
    bar.finish_and_clear();
    Ok(Some(worker))
}

/// Returns a function that updates a progress bar, starting after the `before` points of other shards. Points of
/// earlier runs do not count in the estimate of the remaining time.
fn shown(bar: &ProgressBar, before: u64) -> impl FnMut(u64) + '_ {
    let mut is_first = true;
    move |done| {
        bar.set_position(before + done);
        if std::mem::take(&mut is_first) {
            bar.reset_eta();
        }
    }
}

fn joined(study: &Study, folder: &Path, common: &Common) -> anyhow::Result<Joined> {
    let bar = print::progress(common.quiet, 2 * study.points(), "rows checked and written");
    let joined = join(study, folder, &mut |done, _| bar.set_position(done))?;
    bar.finish_and_clear();
    Ok(joined)
}

/// Ends this process when its parent process has ended for any reason.
fn end_with_input() -> anyhow::Result<()> {
    let watch = || {
        let mut byte = [0];
        while matches!(std::io::stdin().read(&mut byte), Ok(count) if count > 0) {}
        std::process::exit(1);
    };
    let thread = std::thread::Builder::new().spawn(watch);
    let told = |error| BadInput(format!("cannot watch standard input: {error}"));
    thread.map(drop).map_err(told)?;
    Ok(())
}
