//! The parent process: starts the child, and polls it or waits for it.

use super::protocol::{self, Answer, Request, RequestedField};
use super::{FieldTrial, LONGEST, LONGEST_BESIDE_OTHERS, MOST_MEMORY, TrialCommand};
use crate::error::Error;
use crate::scene::{Scene, UserField, UserSamples, WaveDomain};
use crate::tracer::TraceError;
use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::hash::{BuildHasher, Hash, RandomState};
use std::io::{Read, Seek, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Interval between two checks of the child while waiting for it.
const BETWEEN_LOOKS: Duration = Duration::from_millis(2);

/// Maximum number of remembered texts and refusals. If more would be remembered, all are forgotten.
const MOST_KNOWN: usize = 1024;

/// A child process that tries fields. Dropping this value ends the process.
pub(crate) struct Trial {
    child: Child,
    /// The child's output, an unnamed file. With a file neither process waits for the other.
    answer: File,
    began: Instant,
    fields: Vec<(Arc<UserField>, WaveDomain)>,
    keys: Vec<u64>,
    /// The names of the fields' files, for messages.
    files: String,
}

/// The results of the children of this process.
#[derive(Default)]
struct Known {
    passed: HashSet<u64>,
    refused: HashMap<Vec<u64>, TraceError>,
}

static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);

/// Random keys of the hashes. They differ between processes, so that no text can be prepared whose hash collides with
/// that of an accepted text.
static KEYS: LazyLock<RandomState> = LazyLock::new(RandomState::new);

fn known() -> MutexGuard<'static, Known> {
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

fn key_of(what: impl Hash) -> u64 {
    KEYS.hash_one(what)
}

fn key_of_field(field: &UserField, waves: WaveDomain) -> u64 {
    let numbers = [field.size.x, field.size.y, field.size.z, field.lipschitz];
    let numbers = (numbers.map(f32::to_bits), field.bend.map(f32::to_bits));
    key_of((&field.file, &field.text, numbers, waves))
}

/// Whether a child process has compiled and tried a field alone, so that this process need not repeat the trial.
pub(crate) fn has_passed(field: &UserField, waves: WaveDomain) -> bool {
    let is_in_child = matches!(FieldTrial::chosen(), FieldTrial::InChild(_));
    is_in_child && known().passed.contains(&key_of_field(field, waves))
}

impl Trial {
    /// Starts a trial of the fields of a scene, and of the programs that contain them. Returns `None` if all of them
    /// were tried before, or if fields are trusted.
    ///
    /// # Errors
    /// [`Error::Trace`] for a text that is rejected without compilation, for a text that was tried and rejected before,
    /// for any text if fields are refused, and if no child can be started.
    pub fn begin(scene: &Scene, programs: &[&str]) -> Result<Option<Trial>, Error> {
        let mut all = scene.user_domains();
        all.retain(|(field, _)| !field.is_own());
        let Some((first, _)) = all.first() else {
            return Ok(None);
        };
        let command = match FieldTrial::chosen() {
            FieldTrial::InChild(command) => command,
            FieldTrial::InThisProcess => return Ok(None),
            FieldTrial::Refused => {
                let file = first.file.display().to_string();
                return Err(TraceError::FieldRefused { file }.into());
            }
        };
        let mut keys = Vec::new();
        let mut is_new = |key: u64| {
            let is_new = !known().passed.contains(&key) && !keys.contains(&key);
            if is_new {
                keys.push(key);
            }
            is_new
        };
        let mut fields = Vec::new();
        for &(field, waves) in &all {
            TraceError::check_text(field)?;
            if is_new(key_of_field(field, waves)) {
                fields.push((Arc::clone(field), waves));
            }
        }
        let programs: Vec<String> = programs
            .iter()
            .filter(|program| is_new(key_of(program)))
            .map(|program| (*program).to_owned())
            .collect();
        if keys.is_empty() {
            return Ok(None);
        }
        if let Some(error) = known().refused.get(&keys) {
            return Err(error.clone().into());
        }
        let files = match fields.is_empty() {
            true => named(all.iter().map(|(field, _)| *field)),
            false => named(fields.iter().map(|(field, _)| field)),
        };
        let request = Request {
            fields: fields.iter().map(requested).collect(),
            programs,
        };
        let started = start(&command, &request);
        let (child, answer) = started.map_err(|error| TraceError::NoFieldTrial {
            why: format!("cannot be started: {error}"),
        })?;
        Ok(Some(Trial {
            child,
            answer,
            began: Instant::now(),
            fields,
            keys,
            files,
        }))
    }

    /// The result of the trial, or `None` while the trial runs. Does not block.
    pub fn poll(&mut self) -> Option<Result<(), Error>> {
        let longest = self.longest();
        let ended = match self.child.try_wait() {
            Ok(Some(status)) => self.judge(status),
            Ok(None) if self.began.elapsed() < longest => return None,
            // This result is not remembered, because on a busy machine an acceptable field may also take long.
            Ok(None) => {
                let how = format!("took longer than {} s", longest.as_secs());
                return Some(Err(self.dies(how).into()));
            }
            Err(error) => Err(TraceError::NoFieldTrial {
                why: format!("cannot be waited for: {error}"),
            }),
        };
        self.remember(&ended);
        Some(ended.map_err(Error::from))
    }

    /// Waits for the result.
    pub fn wait(mut self) -> Result<(), Error> {
        loop {
            match self.poll() {
                Some(ended) => return ended,
                None => std::thread::sleep(BETWEEN_LOOKS),
            }
        }
    }

    /// The time limit of the child, which is longer if other programs leave the child little processor time.
    fn longest(&self) -> Duration {
        let waited = self.began.elapsed();
        if waited < LONGEST {
            return LONGEST;
        }
        match processor_time(self.child.id()) {
            Some(used) if used < waited / 2 => LONGEST_BESIDE_OTHERS,
            _ => LONGEST,
        }
    }

    fn remember(&self, ended: &Result<(), TraceError>) {
        let mut known = known();
        if known.passed.len() + known.refused.len() > MOST_KNOWN {
            *known = Known::default();
        }
        match ended {
            Ok(()) => known.passed.extend(&self.keys),
            // This result is not remembered, because the next trial may have another result.
            Err(TraceError::NoFieldTrial { .. }) => (),
            Err(error) => {
                known.refused.insert(self.keys.clone(), error.clone());
            }
        }
    }

    fn dies(&self, how: String) -> TraceError {
        TraceError::FieldDies {
            file: self.files.clone(),
            how,
        }
    }

    /// Interprets the child's exit status and answer.
    fn judge(&mut self, status: ExitStatus) -> Result<(), TraceError> {
        if let Some(signal) = signal(status) {
            let memory = MOST_MEMORY >> 20;
            return Err(self.dies(format!(
                "ended by {signal}: the driver fails on it, or it takes more than {memory} MiB"
            )));
        }
        let failed = |why: String| TraceError::NoFieldTrial { why };
        let mut bytes = Vec::new();
        let read = self.answer.rewind();
        read.and_then(|()| self.answer.read_to_end(&mut bytes))
            .map_err(|error| failed(format!("gave an answer that cannot be read: {error}")))?;
        let Some((answer, values)) = protocol::read(&bytes).filter(|_| status.success()) else {
            return Err(failed(format!("gave no answer ({status})")));
        };
        match answer {
            Answer::Refused(error) => Err(error),
            Answer::Failed(why) => Err(failed(format!("has failed: {why}"))),
            Answer::Passed(tried) => {
                let mut values = values.as_slice();
                for ((field, waves), tried) in self.fields.iter().zip(tried) {
                    let count = tried.side.saturating_pow(3);
                    let Some((own, rest)) = values.split_at_checked(count) else {
                        return Err(failed("gave an incomplete answer".to_owned()));
                    };
                    let samples = UserSamples {
                        side: tried.side,
                        values: own.to_vec(),
                    };
                    field.set_passed(*waves, Arc::new(samples), tried.evaluation_seconds);
                    if let Some(agrees) = tried.derivative_agrees {
                        field.set_derivative_agrees(agrees);
                    }
                    values = rest;
                }
                Ok(())
            }
        }
    }
}

impl Drop for Trial {
    fn drop(&mut self) {
        // A child that has ended cannot be killed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn requested((field, waves): &(Arc<UserField>, WaveDomain)) -> RequestedField {
    RequestedField {
        file: field.file.display().to_string(),
        text: field.text.clone(),
        size: field.size.to_array(),
        lipschitz: field.lipschitz,
        bend: field.bend,
        waves: *waves,
    }
}

/// The processor time that a process has used; `None` if unknown.
#[cfg(target_os = "linux")]
fn processor_time(process: u32) -> Option<Duration> {
    // A clock tick. Linux reports 100 ticks per second to programs on every architecture.
    const TICK: Duration = Duration::from_millis(10);
    let status = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The name may contain any character. After it, fields 14 and 15 of proc(5) are the user time and the system time.
    let (_, fields) = status.rsplit_once(')')?;
    let mut ticks = fields.split_whitespace().skip(11).map(str::parse::<u32>);
    let [user, system] = [ticks.next()?.ok()?, ticks.next()?.ok()?];
    Some(TICK * user.checked_add(system)?)
}

#[cfg(not(target_os = "linux"))]
fn processor_time(_process: u32) -> Option<Duration> {
    None
}

/// The files of fields, without duplicates.
fn named<'a>(fields: impl Iterator<Item = &'a Arc<UserField>>) -> String {
    let mut names: Vec<String> = Vec::new();
    for field in fields {
        let name = field.file.display().to_string();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join(" or ")
}

fn start(command: &TrialCommand, request: &Request) -> std::io::Result<(Child, File)> {
    let asked = ron::to_string(request).map_err(std::io::Error::other)?;
    let mut question = tempfile::tempfile()?;
    question.write_all(asked.as_bytes())?;
    question.rewind()?;
    let answer = tempfile::tempfile()?;
    let child = Command::new(&command.program)
        .args(&command.arguments)
        .stdin(Stdio::from(question))
        .stdout(Stdio::from(answer.try_clone()?))
        // Driver crash output is discarded.
        .stderr(Stdio::null())
        .spawn()?;
    Ok((child, answer))
}

/// The name of the signal that has ended a process.
#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<String> {
    use std::os::unix::process::ExitStatusExt;
    // POSIX numbers; other signals differ from system to system.
    let name = match status.signal()? {
        4 => "SIGILL",
        6 => "SIGABRT",
        8 => "SIGFPE",
        9 => "SIGKILL",
        11 => "SIGSEGV",
        15 => "SIGTERM",
        other => return Some(format!("signal {other}")),
    };
    Some(name.to_owned())
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<String> {
    None
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Protects good fields on a busy machine: the processor time of the process counts, not the elapsed time.
    #[test]
    fn a_process_that_waits_uses_no_time() {
        let mut sleeper = Command::new("sleep").arg("60").spawn().unwrap();
        let used = processor_time(sleeper.id());
        sleeper.kill().unwrap();
        sleeper.wait().unwrap();
        assert!(used.unwrap() < Duration::from_millis(500), "{used:?}");
        let own = || processor_time(std::process::id()).unwrap();
        let before = own();
        while own() < before + Duration::from_millis(50) {}
        assert_eq!(processor_time(u32::MAX), None);
    }
}
