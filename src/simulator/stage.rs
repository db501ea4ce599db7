//! The state shared by the caller and both workers: the last snapshot, the last results, and the roles.
//!
//! Every lock is held for a swap or a look-up only. Whatever is built or freed, is built before and freed after.

use super::hall::Hall;
use super::messages::Subscriber;
use super::update::Published;
use super::world::Snapshot;
use super::{SourceId, Update};
use crate::error::Error;
use crate::platform::Instant;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// The state of a simulator's workers.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum SimulatorState {
    /// Updates are of the last commit's surfaces, or there was no commit yet.
    #[default]
    Ready,
    /// Programs for the last commit's surfaces are compiled. Until they are ready, updates are of the surfaces before.
    Compiling,
    /// The last commit's surfaces cannot be traced. Updates are of the surfaces before, if there are any.
    Failed(Arc<Error>),
}

/// A scene whose programs are compiled aside.
pub(super) struct Job {
    pub hall: Box<Hall>,
    pub key: u64,
}

/// A finished job.
pub(super) struct Done {
    pub hall: Box<Hall>,
    pub key: u64,
    pub result: Result<(), Error>,
}

/// What passes between the threads. `E` is the state of the tracing worker.
struct Stage<E> {
    snapshot: Option<Box<Snapshot>>,
    job: Option<Job>,
    done: Option<Done>,
    /// Whether the tracing worker decides about a finished job. Until then the other one begins no further job, as it
    /// may have to trace.
    is_deciding: bool,
    /// Ears that the engine does not know yet.
    subscribers: Vec<Subscriber>,
    /// The engine, while no worker has it.
    engine: Option<Box<E>>,
    /// The worker that traces; the other one compiles.
    turn: usize,
    /// Whether the tracing worker sleeps until something arrives. A worker that rests looks by itself.
    is_asleep: bool,
    stops: bool,
}

/// The state, and whether it is the last one.
#[derive(Default)]
struct Current {
    state: SimulatorState,
    has_ended: bool,
}

/// The shared part of a simulator.
pub(super) struct Shared<E> {
    stage: Mutex<Stage<E>>,
    wake: Condvar,
    published: Mutex<Arc<Published>>,
    state: Mutex<Current>,
    /// Keys of the structures whose programs exist.
    compiled: Mutex<Vec<u64>>,
}

/// The next work of a worker.
pub(super) enum Task<E> {
    Trace(Box<E>),
    Compile(Job),
    Stop,
}

/// The arrivals for the tracing worker.
#[derive(Default)]
pub(super) struct News {
    pub snapshot: Option<Box<Snapshot>>,
    pub done: Option<Done>,
    pub subscribers: Vec<Subscriber>,
    pub stops: bool,
}

/// A panic of another thread does not make the data invalid: they are only swapped.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<E> Default for Shared<E> {
    fn default() -> Shared<E> {
        let stage = Stage {
            snapshot: None,
            job: None,
            done: None,
            is_deciding: false,
            subscribers: Vec::new(),
            engine: None,
            turn: 0,
            is_asleep: false,
            stops: false,
        };
        Shared {
            stage: Mutex::new(stage),
            wake: Condvar::new(),
            published: Mutex::default(),
            state: Mutex::default(),
            compiled: Mutex::default(),
        }
    }
}

impl<E> Shared<E> {
    /// Hands a snapshot to the workers.
    pub fn commit(&self, snapshot: Box<Snapshot>) {
        let mut stage = locked(&self.stage);
        let before = stage.snapshot.replace(snapshot);
        let is_asleep = stage.is_asleep;
        drop(stage);
        // A worker that is woken may take the caller's processor.
        if is_asleep {
            self.wake.notify_all();
        }
        drop(before);
    }

    /// Adds ears, which receive the results from now on.
    pub fn subscribe(&self, subscriber: Subscriber) {
        locked(&self.stage).subscribers.push(subscriber);
        self.wake.notify_all();
    }

    pub fn stop(&self) {
        locked(&self.stage).stops = true;
        self.wake.notify_all();
    }

    /// Waits until the worker with this number has something to do.
    pub fn next_task(&self, worker: usize) -> Task<E> {
        let mut stage = locked(&self.stage);
        loop {
            if stage.stops {
                return Task::Stop;
            }
            let is_undecided = stage.done.is_some() || stage.is_deciding;
            let task = match stage.turn == worker {
                true => stage.engine.take().map(Task::Trace),
                false if is_undecided => None,
                false => stage.job.take().map(Task::Compile),
            };
            match task {
                Some(task) => return task,
                None => {
                    stage = self
                        .wake
                        .wait(stage)
                        .unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }

    /// Gives the engine to the worker with this number.
    pub fn hand_over(&self, engine: Box<E>, worker: usize) {
        let mut stage = locked(&self.stage);
        stage.engine = Some(engine);
        stage.turn = worker;
        stage.is_deciding = false;
        drop(stage);
        self.wake.notify_all();
    }

    /// Both workers keep their roles after a finished job.
    pub fn keep_roles(&self) {
        locked(&self.stage).is_deciding = false;
        self.wake.notify_all();
    }

    /// Gives a job to the worker that does not trace; an older job that was not begun is dropped.
    pub fn compile(&self, job: Job) {
        let before = locked(&self.stage).job.replace(job);
        self.wake.notify_all();
        drop(before);
    }

    pub fn finish(&self, done: Done) {
        let before = locked(&self.stage).done.replace(done);
        self.wake.notify_all();
        drop(before);
    }

    /// Rests until `until`, then takes what has arrived. Without a time, waits until something arrives.
    pub fn news(&self, until: Option<Instant>) -> News {
        let mut stage = locked(&self.stage);
        loop {
            let now = Instant::now();
            let is_due = until.is_some_and(|until| now >= until);
            let has_news =
                stage.snapshot.is_some() || stage.done.is_some() || !stage.subscribers.is_empty();
            if stage.stops || is_due || until.is_none() && has_news {
                stage.is_asleep = false;
                stage.is_deciding = stage.done.is_some();
                return News {
                    snapshot: stage.snapshot.take(),
                    done: stage.done.take(),
                    subscribers: std::mem::take(&mut stage.subscribers),
                    stops: stage.stops,
                };
            }
            stage.is_asleep = until.is_none();
            stage = match until {
                Some(until) => {
                    let waited = self.wake.wait_timeout(stage, until - now);
                    waited.unwrap_or_else(PoisonError::into_inner).0
                }
                None => {
                    let waited = self.wake.wait(stage);
                    waited.unwrap_or_else(PoisonError::into_inner)
                }
            };
        }
    }

    pub fn publish(&self, published: Arc<Published>) {
        let before = std::mem::replace(&mut *locked(&self.published), published);
        drop(before);
    }

    pub fn update(&self, id: SourceId) -> Option<Arc<Update>> {
        locked(&self.published).get(&id).map(Arc::clone)
    }

    /// Sets the state, unless the workers have ended.
    pub fn set_state(&self, state: SimulatorState) {
        let mut current = locked(&self.state);
        let before = match &mut *current {
            Current {
                has_ended: true, ..
            } => state,
            Current { state: known, .. } => std::mem::replace(known, state),
        };
        drop(current);
        drop(before);
    }

    /// Ends both workers with an error that stays.
    pub fn fail(&self, error: Error) {
        self.set_state(SimulatorState::Failed(Arc::new(error)));
        locked(&self.state).has_ended = true;
        self.stop();
    }

    pub fn state(&self) -> SimulatorState {
        locked(&self.state).state.clone()
    }

    pub fn set_compiled(&self, keys: Vec<u64>) {
        *locked(&self.compiled) = keys;
    }

    pub fn is_compiled(&self, key: u64) -> bool {
        locked(&self.compiled).contains(&key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A job for a world without surfaces.
    fn job(key: u64) -> Job {
        let snapshot = crate::simulator::world::World::new().snapshot();
        let hall = Box::new(Hall::of(&snapshot));
        Job { hall, key }
    }

    /// Protects the sound of a game that spawns objects while programs are compiled: the worker that has finished a job
    /// begins no further one until the tracing worker has decided about the roles, so that it can take over at once.
    #[test]
    fn a_worker_that_may_have_to_trace_compiles_nothing_else() {
        let shared = Shared::<&str>::default();
        shared.hand_over(Box::new("engine"), 0);
        let Task::Trace(engine) = shared.next_task(0) else {
            panic!("worker 0 traces");
        };
        shared.compile(job(1));
        let Task::Compile(Job { hall, key }) = shared.next_task(1) else {
            panic!("worker 1 compiles");
        };
        shared.compile(job(2));
        let result = Ok(());
        shared.finish(Done { hall, key, result });
        std::thread::scope(|scope| {
            let next = scope.spawn(|| shared.next_task(1));
            let done = shared.news(Some(Instant::now())).done;
            assert_eq!(done.expect("a finished job").key, 1);
            assert!(!next.is_finished(), "worker 1 has begun the next job");
            shared.hand_over(engine, 1);
            let next = next.join().expect("no panic");
            assert!(matches!(next, Task::Trace(engine) if *engine == "engine"));
        });
        // Worker 0 compiles now.
        assert!(matches!(
            shared.next_task(0),
            Task::Compile(Job { key: 2, .. })
        ));
    }

    /// Protects callers from a simulator that is silent without a reason: the failure of a worker stays the state.
    #[test]
    fn a_failure_of_a_worker_stays() {
        let shared = Shared::<()>::default();
        let reason = "it has panicked".to_owned();
        shared.fail(crate::simulator::SimulatorError::NoThread { reason }.into());
        shared.set_state(SimulatorState::Ready);
        assert!(matches!(shared.state(), SimulatorState::Failed(_)));
        assert!(matches!(shared.next_task(0), Task::Stop));
    }
}
