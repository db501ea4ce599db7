//! `--jobs`: runs one process of this program for each shard, with a limited number of processes at a time.
//!
//! Jobs are processes instead of threads for three reasons: a crashing driver ends only one job, each job has its own
//! OpenGL context with the driver's own threads, and the same program runs on a cluster. Each job uses an equal share
//! of the processor cores, unless the environment sets the number of threads.

use super::Arguments;
use crate::exit::BadInput;
use crate::options::Common;
use anyhow::{Context, anyhow};
use echomarch_lab::study::{Shard, Study, rows_in};
use indicatif::ProgressBar;
use std::collections::VecDeque;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Duration;

/// Interval between two checks of the job processes.
const BETWEEN_LOOKS: Duration = Duration::from_millis(100);

/// The environment variables that set the number of threads of llvmpipe and of this program.
const THREADS: [&str; 2] = ["LP_NUM_THREADS", "RAYON_NUM_THREADS"];

/// Maximum number of bytes that are read from a process' error message.
const LONGEST_MESSAGE: u64 = 1 << 16;

/// A process that computes a shard. Dropping it kills the process.
struct Job {
    shard: Shard,
    child: Child,
    /// Number of bytes and of lines of the working file that have been read.
    seen: (u64, u64),
}

impl Drop for Job {
    fn drop(&mut self) {
        // The process may have ended already, and an error cannot be reported here.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Computes all `of` shards, each in its own process, and shows the number of completed points.
pub fn run(
    study: &Study,
    of: u32,
    folder: &Path,
    arguments: &Arguments,
    common: &Common,
    bar: &ProgressBar,
) -> anyhow::Result<()> {
    let mut waiting: VecDeque<Shard> = Shard::all(of).collect();
    let mut running: Vec<Job> = Vec::new();
    let points = |shard: Shard| shard.points(study.points());
    let (mut done, mut is_first) = (0, true);
    while !(waiting.is_empty() && running.is_empty()) {
        while running.len() < arguments.jobs as usize
            && let Some(shard) = waiting.pop_front()
        {
            running.push(start(shard, folder, arguments, common)?);
        }
        std::thread::sleep(BETWEEN_LOOKS);
        let mut going_on = Vec::new();
        let mut so_far = 0;
        for mut job in running {
            match job.child.try_wait().context("cannot watch a process")? {
                None => {
                    so_far += rows_in(job.shard, folder, points(job.shard), &mut job.seen);
                    going_on.push(job);
                }
                Some(status) if status.success() => done += points(job.shard),
                Some(status) => return Err(failed(&mut job, status)),
            }
        }
        running = going_on;
        bar.set_position(done + so_far);
        if std::mem::take(&mut is_first) {
            bar.reset_eta();
        }
    }
    Ok(())
}

fn start(
    shard: Shard,
    folder: &Path,
    arguments: &Arguments,
    common: &Common,
) -> anyhow::Result<Job> {
    let program = std::env::current_exe().context("cannot find this program")?;
    let mut command = Command::new(program);
    command
        .arg("study")
        .arg(&arguments.study)
        .arg("-o")
        .arg(folder);
    command.args([
        "--shard",
        &shard.to_string(),
        "--until-input-ends",
        "--quiet",
    ]);
    command.arg(format!("--gl={}", common.gl));
    if let Some(gpu) = common.gpu {
        command.arg(format!("--gpu={gpu}"));
    }
    if let Some(wanted) = &arguments.require_renderer {
        command.arg(format!("--require-renderer={wanted}"));
    }
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    let threads = (cores / arguments.jobs as usize).max(1);
    for name in THREADS {
        if std::env::var_os(name).is_none() {
            command.env(name, threads.to_string());
        }
    }
    command.stdin(Stdio::piped());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command
        .spawn()
        .context("cannot start a process of --jobs")?;
    Ok(Job {
        shard,
        child,
        seen: (0, 0),
    })
}

/// The error for a failed process, including the message of that process.
fn failed(job: &mut Job, status: ExitStatus) -> anyhow::Error {
    let mut message = String::new();
    if let Some(stderr) = job.child.stderr.take() {
        // If the message cannot be read, the failure is reported without it.
        let _ = stderr.take(LONGEST_MESSAGE).read_to_string(&mut message);
    }
    let last = message.lines().rfind(|line| !line.trim().is_empty());
    let said = last.map(|line| line.trim_start_matches("echomarch: "));
    let text = format!(
        "shard {}: {}",
        job.shard,
        said.unwrap_or("its process ended")
    );
    match status.code() {
        Some(2) => BadInput(text).into(),
        Some(_) => anyhow!(text),
        None => anyhow!("{text} ({status})"),
    }
}
