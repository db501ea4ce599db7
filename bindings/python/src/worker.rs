//! The thread that owns the OpenGL context.
//!
//! A context stays on the thread that made it, and Python code may call from any thread. One thread per process
//! therefore owns the context and the tracer. Calls are queued in the order of their arrival. The calling thread waits
//! without the GIL, handles signals, and calls progress functions.

use crate::errors;
use echomarch::gl::{Api, Context, ContextOptions};
use echomarch::tracer::{FieldTrial, TrialCommand};
use echomarch::{Error, Tracer};
use pyo3::prelude::*;
use std::any::Any;
use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Interval between two checks for signals while a call waits. An interrupt is handled within this time.
const BETWEEN_CHECKS: Duration = Duration::from_millis(50);

/// Work for the thread. It receives the place of the thread's tracer, which is empty before the first job.
type Job = Box<dyn FnOnce(&mut Option<Tracer>) + Send>;

/// A running thread with a context.
struct Worker {
    jobs: Sender<Job>,
    thread: JoinHandle<()>,
}

/// The threads of this process.
struct Workers {
    /// The process that started the threads. Threads do not survive a fork.
    process: Option<u32>,
    /// The options of contexts; `None` stands for the defaults.
    options: Option<ContextOptions>,
    current: Option<Worker>,
    /// Threads that finish an interrupted job.
    retired: Vec<JoinHandle<()>>,
}

static WORKERS: Mutex<Workers> = Mutex::new(Workers {
    process: None,
    options: None,
    current: None,
    retired: Vec::new(),
});

fn workers() -> MutexGuard<'static, Workers> {
    WORKERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The payload of the unwinding that ends an interrupted job.
struct Interrupted;

/// Reports the progress of a job to the calling thread.
pub struct Observer<P> {
    messages: Box<dyn Fn(P) + Send>,
    is_interrupted: Arc<AtomicBool>,
}

impl<P> Observer<P> {
    /// Sends the progress. If the caller was interrupted, ends the job by unwinding: the library has no other way to
    /// end a trace between two rounds.
    pub fn report(&self, progress: P) {
        if self.is_interrupted.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Interrupted));
        }
        (self.messages)(progress);
    }
}

/// A message from the job to the calling thread.
enum Message<T, P> {
    Progress(P),
    Done(T),
    Panicked(String),
}

/// Runs a job on the thread of the context and waits for its result without the GIL. `progress` receives the reports of
/// the job on the calling thread. If `progress` fails, or a signal handler raises an exception, the job is abandoned:
/// it ends at its next report, and this function returns the exception at once.
pub fn run<T: Send + 'static, P: Send + 'static>(
    py: Python,
    job: impl FnOnce(&mut Tracer, &Observer<P>) -> Result<T, Error> + Send + 'static,
    mut progress: impl FnMut(P) -> PyResult<()>,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    // The mutex lets the GIL be released while this thread, the only user of the receiver, waits.
    let receiver = Mutex::new(receiver);
    let is_interrupted = Arc::new(AtomicBool::new(false));
    let observer = Observer {
        messages: Box::new({
            let sender = sender.clone();
            // The caller no longer listens after an interruption.
            move |progress| drop(sender.send(Message::Progress(progress)))
        }),
        is_interrupted: is_interrupted.clone(),
    };
    let options = workers().options.unwrap_or_default();
    submit(Box::new(move |place| {
        let work = || job(opened(place, &options)?, &observer);
        let message = match catch_unwind(AssertUnwindSafe(work)) {
            Ok(done) => Message::Done(done),
            Err(payload) => Message::Panicked(told(&*payload)),
        };
        // The caller no longer listens after an interruption.
        let _ = sender.send(message);
    }))?;
    let waited = wait(py, &receiver, &mut progress);
    if waited.is_err() {
        is_interrupted.store(true, Ordering::Relaxed);
        retire();
    }
    match waited? {
        Message::Done(done) => done.map_err(|error| errors::of(&error)),
        Message::Panicked(message) => {
            retire();
            Err(errors::internal(message))
        }
        Message::Progress(_) => Err(errors::internal("the job has no result".to_owned())),
    }
}

/// Waits for the last message of a job.
fn wait<T: Send, P: Send>(
    py: Python,
    receiver: &Mutex<Receiver<Message<T, P>>>,
    progress: &mut impl FnMut(P) -> PyResult<()>,
) -> PyResult<Message<T, P>> {
    let next = || {
        let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
        receiver.recv_timeout(BETWEEN_CHECKS)
    };
    loop {
        match py.detach(next) {
            Ok(Message::Progress(report)) => progress(report)?,
            Ok(message) => return Ok(message),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                let ended = "the thread of the OpenGL context has ended".to_owned();
                return Err(errors::internal(ended));
            }
        }
    }
}

/// Sends a job to the thread of the context, which is started if there is none.
fn submit(job: Job) -> PyResult<()> {
    let mut workers = workers();
    let process = std::process::id();
    if workers.process.is_some_and(|used| used != process) {
        return Err(errors::forked(
            "this process was forked from a process in which Echomarch had opened OpenGL, and the driver does not \
             survive a fork: use multiprocessing.get_context(\"spawn\"), or echomarch.responses(scenes, workers=…)"
                .to_owned(),
        ));
    }
    workers.process = Some(process);
    if let Some(worker) = &workers.current {
        return worker.jobs.send(job).map_err(|_| {
            errors::internal("the thread of the OpenGL context has ended".to_owned())
        });
    }
    let (jobs, received) = channel::<Job>();
    let thread = std::thread::Builder::new()
        .name("echomarch".to_owned())
        .spawn(move || work(&received))
        .map_err(|error| errors::internal(format!("cannot start a thread: {error}")))?;
    // The thread has just started and waits for jobs.
    let _ = jobs.send(job);
    workers.current = Some(Worker { jobs, thread });
    Ok(())
}

/// Does the jobs until the sender is dropped.
fn work(jobs: &Receiver<Job>) {
    let mut tracer = None;
    while let Ok(job) = jobs.recv() {
        job(&mut tracer);
    }
}

/// The tracer of this thread. Opens a context if there is none.
fn opened<'a>(
    place: &'a mut Option<Tracer>,
    options: &ContextOptions,
) -> Result<&'a mut Tracer, Error> {
    match place {
        Some(tracer) => Ok(tracer),
        None => Ok(place.insert(Tracer::new(&Context::headless(options)?)?)),
    }
}

/// The message of a panic.
fn told(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| payload.downcast_ref::<&str>().copied());
    match text {
        Some(text) => format!("a fault of Echomarch, please report it: {text}"),
        None => "the job was interrupted".to_owned(),
    }
}

/// Lets the current thread end after its job. The next job starts a thread with a context of its own.
fn retire() {
    let mut workers = workers();
    if let Some(worker) = workers.current.take() {
        workers.retired.push(worker.thread);
    }
    workers.retired.retain(|thread| !thread.is_finished());
}

/// Chooses the OpenGL interface and the device of all later calls.
#[pyfunction]
pub fn choose_renderer(api: &str, gpu: Option<usize>) -> PyResult<()> {
    let api: Api = api.parse().map_err(errors::from)?;
    let mut options = ContextOptions::new(api);
    options.gpu = gpu;
    workers().options = Some(options);
    retire();
    Ok(())
}

/// Chooses the program and its arguments that try users' fields in a child process.
#[pyfunction]
pub fn choose_field_trial(program: PathBuf, arguments: Vec<OsString>) {
    FieldTrial::InChild(TrialCommand { program, arguments }).set();
}

/// Tries users' fields as the child process of another process. Returns whether it was able to answer.
#[pyfunction]
pub fn answer_field_trial(api: &str, gpu: Option<usize>) -> PyResult<bool> {
    let api: Api = api.parse().map_err(errors::from)?;
    let mut options = ContextOptions::new(api);
    options.gpu = gpu;
    Ok(FieldTrial::answer(&options) == ExitCode::SUCCESS)
}

/// The name of the renderer. Opens a context if there is none.
#[pyfunction]
pub fn renderer(py: Python) -> PyResult<String> {
    let name = |tracer: &mut Tracer, _: &Observer<()>| Ok(tracer.context().renderer().to_owned());
    run(py, name, |()| Ok(()))
}

/// Ends all threads, and waits for them. A driver may crash if the process ends while a thread draws.
#[pyfunction]
pub fn close(py: Python) -> PyResult<()> {
    retire();
    let threads = {
        let mut workers = workers();
        if workers.process != Some(std::process::id()) {
            return Ok(());
        }
        std::mem::take(&mut workers.retired)
    };
    for thread in threads {
        while !thread.is_finished() {
            py.detach(|| std::thread::sleep(BETWEEN_CHECKS));
            py.check_signals()?;
        }
    }
    Ok(())
}
