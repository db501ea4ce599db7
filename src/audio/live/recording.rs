//! What was heard, to a file: the thread behind a recording.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::Sender;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rtrb::{Consumer, RingBuffer};

use super::LiveError;
use super::command::Command;
use super::renderer::Tap;
use crate::audio::{AudioError, WavWriter};

/// What the ring holds, in seconds: longer than a disk commonly stalls.
const RING_S: usize = 4;

/// How often the ring is emptied.
const PERIOD: Duration = Duration::from_millis(20);

/// How often the file is made playable as far as it is: what an interrupted program loses.
const FLUSH: Duration = Duration::from_secs(1);

/// A recording in progress, or one that has ended and was not completed yet.
#[derive(Debug)]
pub(super) struct Recording {
    path: PathBuf,
    rate_hz: u32,
    is_over: Arc<AtomicBool>,
    dropped: Arc<AtomicU64>,
    /// The file, until something plays.
    waiting: Option<WavWriter>,
    /// The thread that has the file since then.
    writer: Option<Result<JoinHandle<Result<u64, AudioError>>, LiveError>>,
}

impl Recording {
    /// Starts a file. Until [`begin`](Self::begin) nothing is written.
    pub(super) fn new(path: &Path, rate_hz: u32) -> Result<Self, LiveError> {
        Ok(Self {
            path: path.to_owned(),
            rate_hz,
            is_over: Arc::new(AtomicBool::new(false)),
            dropped: Arc::new(AtomicU64::new(0)),
            waiting: Some(WavWriter::record_at(path, rate_hz)?),
            writer: None,
        })
    }

    /// Starts the thread that writes; the tap is for the callback. None if it was started before.
    /// Errors are reported to the supervisor.
    pub(super) fn begin(&mut self, commands: &Sender<Command>) -> Option<Tap> {
        let file = self.waiting.take()?;
        let (ring, from_ring) = RingBuffer::new(2 * RING_S * self.rate_hz as usize);
        let is_over = Arc::clone(&self.is_over);
        let there = commands.clone();
        let writer = thread::Builder::new()
            .name("echomarch-record".to_owned())
            .spawn(move || write_or_tell(file, from_ring, &is_over, &there))
            .map_err(|source| LiveError::Thread { source });
        if let Err(error) = &writer {
            self.end();
            tell(commands, error);
        }
        let tap = writer.is_ok().then(|| Tap {
            ring,
            is_over: Arc::clone(&self.is_over),
            dropped: Arc::clone(&self.dropped),
        });
        self.writer = Some(writer);
        tap
    }

    /// Begins a file at another rate in place of one that nothing was written to.
    ///
    /// # Errors
    /// [`LiveError::RecordingRate`] if something was: the recording then ends.
    pub(super) fn change_rate(&mut self, rate_hz: u32) -> Result<(), LiveError> {
        if self.rate_hz == rate_hz || self.is_over() {
            return Ok(());
        }
        if self.waiting.take().is_none() {
            self.end();
            return Err(LiveError::RecordingRate { rate_hz });
        }
        match WavWriter::record_at(&self.path, rate_hz) {
            Ok(file) => self.waiting = Some(file),
            Err(error) => {
                self.end();
                return Err(error.into());
            }
        }
        self.rate_hz = rate_hz;
        Ok(())
    }

    /// Whether a callback was given the tap.
    pub(super) fn has_begun(&self) -> bool {
        self.writer.is_some()
    }

    /// Frames that were heard but are not in the file, because the disk was too slow.
    pub(super) fn dropped(&self) -> u64 {
        self.dropped.load(Relaxed)
    }

    /// Whether the file takes no more.
    pub(super) fn is_over(&self) -> bool {
        self.is_over.load(Relaxed)
    }

    /// Takes no more; the file is completed behind the scenes.
    pub(super) fn end(&self) {
        self.is_over.store(true, Relaxed);
    }

    /// Completes the file; the frames in it.
    pub(super) fn finish(self) -> Result<u64, LiveError> {
        self.end();
        if let Some(file) = self.waiting {
            file.finish()?;
        }
        match self.writer.transpose()?.map(JoinHandle::join) {
            None => Ok(0),
            Some(Ok(frames)) => Ok(frames?),
            Some(Err(panic)) => std::panic::resume_unwind(panic),
        }
    }
}

fn tell(commands: &Sender<Command>, error: &dyn std::error::Error) {
    // Without a supervisor nobody plays, and whoever stops the recording gets its error.
    let _ = commands.send(Command::Notice(error.to_string()));
}

/// As [`write`]; an error that ends the recording before it is stopped is reported when it happens.
fn write_or_tell(
    file: WavWriter,
    ring: Consumer<f32>,
    is_over: &AtomicBool,
    commands: &Sender<Command>,
) -> Result<u64, AudioError> {
    let written = write(file, ring, is_over, |error| tell(commands, error));
    is_over.store(true, Relaxed);
    if let Err(error) = &written {
        tell(commands, error);
    }
    written
}

/// Writes what comes through the ring until the recording has ended, or the file is full.
fn write(
    mut file: WavWriter,
    mut ring: Consumer<f32>,
    is_over: &AtomicBool,
    is_full: impl FnOnce(&AudioError),
) -> Result<u64, AudioError> {
    let mut frames = 0;
    let mut flushed = Instant::now();
    loop {
        // Asked before the ring is emptied: what came until then is still written.
        let is_last = is_over.load(Relaxed);
        if is_last {
            // A block that is being written right now takes much less.
            thread::sleep(PERIOD);
        }
        match empty(&mut file, &mut ring) {
            Ok(count) => frames += count,
            // What a file can hold is in it: that is kept.
            Err(error @ AudioError::WavTooLong { .. }) => {
                is_full(&error);
                break;
            }
            Err(error) => return Err(error),
        }
        if is_last {
            break;
        }
        if flushed.elapsed() >= FLUSH {
            file.flush()?;
            flushed = Instant::now();
        }
        thread::sleep(PERIOD);
    }
    file.finish()?;
    Ok(frames)
}

/// Writes what the ring holds now; how many frames.
fn empty(file: &mut WavWriter, ring: &mut Consumer<f32>) -> Result<u64, AudioError> {
    // The callback writes whole frames, so the count is even.
    let count = ring.slots() / 2 * 2;
    let Ok(chunk) = ring.read_chunk(count) else {
        return Ok(0);
    };
    let (first, second) = chunk.as_slices();
    // The ring's length is even, so that no frame lies across its end.
    file.write(first)?;
    file.write(second)?;
    chunk.commit_all();
    Ok(count as u64 / 2)
}
