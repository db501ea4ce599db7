//! The two worker threads: one traces, the other compiles programs aside, and they change roles when it has.

use super::SimulatorError;
use super::SimulatorSettings;
use super::engine::{Engine, Shared, WORKERS, compile};
use super::stage::{Done, Job, Task};
use crate::error::Error;
use crate::gl::Context;
use crate::tracer::Tracer;
use std::sync::Arc;
use std::sync::mpsc::{self, SyncSender};
use std::thread::{self, JoinHandle};

/// The threads of a simulator. They end when this is dropped.
#[derive(Debug)]
pub(super) struct Workers {
    threads: Vec<JoinHandle<()>>,
    /// The name of the renderer.
    pub renderer: String,
}

impl Workers {
    /// Starts both threads, and waits until the first one has a context.
    ///
    /// # Errors
    /// [`Error::Gpu`] without a renderer; [`SimulatorError::NoThread`] if the system starts no thread.
    pub fn start(settings: &SimulatorSettings, shared: &Arc<Shared>) -> Result<Workers, Error> {
        let (tell, told) = mpsc::sync_channel(1);
        let mut workers = Workers {
            threads: Vec::new(),
            renderer: String::new(),
        };
        shared.hand_over(Box::new(Engine::new(settings.clone())), 0);
        for number in 0..WORKERS {
            let (settings, shared_by) = (settings.clone(), Arc::clone(shared));
            let tell = (number == 0).then(|| tell.clone());
            let name = format!("echomarch {number}");
            let started = thread::Builder::new()
                .name(name)
                .spawn(move || Worker::new(number, settings, shared_by).run(tell));
            let started = started.map_err(|error| SimulatorError::NoThread {
                reason: error.to_string(),
            });
            match started {
                Ok(thread) => workers.threads.push(thread),
                Err(error) => {
                    workers.end(shared);
                    return Err(error.into());
                }
            }
        }
        drop(tell);
        match told.recv() {
            Ok(Ok(renderer)) => {
                workers.renderer = renderer;
                Ok(workers)
            }
            Ok(Err(error)) => {
                workers.end(shared);
                Err(error)
            }
            Err(error) => {
                workers.end(shared);
                let reason = error.to_string();
                Err(SimulatorError::NoThread { reason }.into())
            }
        }
    }

    /// Ends both threads, and waits for the trace that is under way.
    pub fn end(&mut self, shared: &Shared) {
        shared.stop();
        for thread in self.threads.drain(..) {
            // A thread that has panicked has ended as well.
            let _ = thread.join();
        }
    }
}

/// Reports the panic of a worker as a failure of the simulator: a user's code may run in it, and a driver's.
struct ReportsPanic(Arc<Shared>);

impl Drop for ReportsPanic {
    fn drop(&mut self) {
        if thread::panicking() {
            let reason = "it has panicked".to_owned();
            self.0.fail(SimulatorError::NoThread { reason }.into());
        }
    }
}

/// One thread with its context.
struct Worker {
    number: usize,
    settings: SimulatorSettings,
    shared: Arc<Shared>,
    tracer: Option<Tracer>,
}

impl Worker {
    fn new(number: usize, settings: SimulatorSettings, shared: Arc<Shared>) -> Worker {
        Worker {
            number,
            settings,
            shared,
            tracer: None,
        }
    }

    fn run(&mut self, tell: Option<SyncSender<Result<String, Error>>>) {
        let _reports = ReportsPanic(Arc::clone(&self.shared));
        if let Some(tell) = tell {
            let made = self
                .tracer()
                .map(|tracer| tracer.context().renderer().to_owned());
            let has_failed = made.is_err();
            // The receiver waits for this message.
            let _ = tell.send(made);
            if has_failed {
                return;
            }
        }
        loop {
            match self.shared.next_task(self.number) {
                Task::Trace(engine) => self.trace(engine),
                Task::Compile(job) => self.compile(job),
                Task::Stop => return,
            }
        }
    }

    fn tracer(&mut self) -> Result<&mut Tracer, Error> {
        if self.tracer.is_none() {
            let context = Context::headless(&self.settings.context)?;
            self.tracer = Some(Tracer::new(&context)?);
        }
        // It was made above.
        self.tracer.as_mut().ok_or_else(|| {
            let reason = "it has no tracer".to_owned();
            SimulatorError::NoThread { reason }.into()
        })
    }

    /// Traces until the other worker has compiled the programs of another hall.
    fn trace(&mut self, mut engine: Box<Engine>) {
        let shared = Arc::clone(&self.shared);
        let number = self.number;
        let Ok(tracer) = self.tracer() else {
            return;
        };
        loop {
            let news = shared.news(engine.next_round());
            if news.stops {
                return;
            }
            engine.subscribe(news.subscribers);
            if let Some(snapshot) = news.snapshot {
                engine.receive(snapshot, number, &shared);
            }
            if let Some(Done { hall, key, result }) = news.done {
                let other = WORKERS - 1 - number;
                match result {
                    Ok(()) if engine.is_waiting() => {
                        engine.adopt(hall, key, other, &shared);
                        return shared.hand_over(engine, other);
                    }
                    // A later commit does not need the programs.
                    Ok(()) => engine.note_compiled(key, other, &shared),
                    Err(error) => engine.refuse(error, key, &shared),
                }
                shared.keep_roles();
            }
            engine.round(tracer, number, &shared);
        }
    }

    fn compile(&mut self, job: Job) {
        let Job { hall, key } = job;
        let settings = self.settings.clone();
        let result = self
            .tracer()
            .and_then(|tracer| compile(&hall, tracer, &settings));
        self.shared.finish(Done { hall, key, result });
    }
}
