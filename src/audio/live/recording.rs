//! The thread that writes the output to a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::Sender;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rtrb::{Consumer, RingBuffer};

use super::LiveError;
use super::link::Command;
use super::renderer::Tap;
use crate::audio::{AudioError, WavWriter};

/// Capacity of the ring, in seconds: longer than typical disk stalls.
const RING_S: usize = 4;

/// Interval between two reads of the ring.
const PERIOD: Duration = Duration::from_millis(20);

/// Interval at which the file is made playable: the maximum loss if the program is interrupted.
const FLUSH: Duration = Duration::from_secs(1);

/// A recording in progress, or an ended recording that is not yet completed.
#[derive(Debug)]
pub(super) struct Recording {
    path: PathBuf,
    rate_hz: u32,
    is_over: Arc<AtomicBool>,
    dropped: Arc<AtomicU64>,
    /// The file before playback starts; `None` afterwards.
    waiting: Option<WavWriter>,
    /// The thread that owns the file after playback has started.
    writer: Option<Result<JoinHandle<Result<u64, AudioError>>, LiveError>>,
}

impl Recording {
    /// Starts a file; writing begins with [`begin`](Self::begin).
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

    /// Starts the thread that writes, and returns the tap for the callback; `None` if it was
    /// already started. Errors are reported to the supervisor.
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

    /// Starts a file at another rate in place of a file that is still empty.
    ///
    /// # Errors
    /// [`LiveError::RecordingRate`] if the file is not empty: the recording then ends.
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

    /// Whether a callback has received the tap.
    pub(super) fn has_begun(&self) -> bool {
        self.writer.is_some()
    }

    /// Number of frames played but missing in the file, because the disk was too slow.
    pub(super) fn dropped(&self) -> u64 {
        self.dropped.load(Relaxed)
    }

    /// Whether the file accepts no more frames.
    pub(super) fn is_over(&self) -> bool {
        self.is_over.load(Relaxed)
    }

    /// Stops accepting frames; the file is completed in the background.
    pub(super) fn end(&self) {
        self.is_over.store(true, Relaxed);
    }

    /// Completes the file and returns the number of frames in it.
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
    // Without a supervisor the output is silent, and the caller gets the error when it stops the recording.
    let _ = commands.send(Command::Notice(error.to_string()));
}

/// Like [`write`]. An error that ends the recording is reported when it occurs.
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

/// Writes the contents of the ring until the recording has ended or the file is full.
fn write(
    mut file: WavWriter,
    mut ring: Consumer<f32>,
    is_over: &AtomicBool,
    is_full: impl FnOnce(&AudioError),
) -> Result<u64, AudioError> {
    let mut frames = 0;
    let mut flushed = Instant::now();
    loop {
        // The flag is read before the ring is emptied, so that all frames queued until then are still written.
        let is_last = is_over.load(Relaxed);
        if is_last {
            // The callback finishes writing its current block within this time.
            thread::sleep(PERIOD);
        }
        match empty(&mut file, &mut ring) {
            Ok(count) => frames += count,
            // The file is full; its contents are kept.
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

/// Writes the contents of the ring and returns the number of frames.
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
