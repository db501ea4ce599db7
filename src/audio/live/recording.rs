//! What was heard, to a file: the thread behind a recording.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use rtrb::{Consumer, RingBuffer};

use super::LiveError;
use super::renderer::Tap;
use crate::audio::{AudioError, WavWriter};

/// What the ring holds, in seconds: longer than a disk commonly stalls.
const RING_S: usize = 4;

/// How often the ring is emptied.
const PERIOD: Duration = Duration::from_millis(20);

/// A recording under way.
#[derive(Debug)]
pub(super) struct Recording {
    rate_hz: u32,
    is_over: Arc<AtomicBool>,
    dropped: Arc<AtomicU64>,
    writer: JoinHandle<Result<u64, AudioError>>,
}

impl Recording {
    /// Starts a file, and a thread that writes it; the tap is for the callback.
    pub(super) fn start(path: &Path, rate_hz: u32) -> Result<(Self, Tap), LiveError> {
        let file = WavWriter::create_at(path, rate_hz)?;
        let (ring, from_ring) = RingBuffer::new(2 * RING_S * rate_hz as usize);
        let is_over = Arc::new(AtomicBool::new(false));
        let dropped = Arc::new(AtomicU64::new(0));
        let is_over_there = Arc::clone(&is_over);
        let writer = thread::Builder::new()
            .name("echomarch-record".to_owned())
            .spawn(move || write(file, from_ring, &is_over_there))
            .map_err(|source| LiveError::Thread { source })?;
        let tap = Tap {
            ring,
            is_over: Arc::clone(&is_over),
            dropped: Arc::clone(&dropped),
        };
        let recording = Self {
            rate_hz,
            is_over,
            dropped,
            writer,
        };
        Ok((recording, tap))
    }

    /// Samples a second of the file.
    pub(super) fn rate_hz(&self) -> u32 {
        self.rate_hz
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
    pub(super) fn finish(self) -> Result<u64, AudioError> {
        self.end();
        match self.writer.join() {
            Ok(frames) => frames,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// Writes what comes through the ring until the recording is over.
fn write(
    mut file: WavWriter,
    mut ring: Consumer<f32>,
    is_over: &AtomicBool,
) -> Result<u64, AudioError> {
    let mut frames = 0;
    loop {
        // Asked before the ring is emptied: what came until then is still written.
        let is_last = is_over.load(Relaxed);
        if is_last {
            // A block that is being written right now takes much less.
            thread::sleep(PERIOD);
        }
        let written = empty(&mut file, &mut ring);
        if written.is_err() {
            is_over.store(true, Relaxed);
        }
        match written {
            Ok(count) => frames += count,
            // What a file can hold is in it: that is kept.
            Err(AudioError::WavTooLong { .. }) => break,
            Err(error) => return Err(error),
        }
        if is_last {
            break;
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
