//! A device callback without a device, for the test that callbacks do not allocate.

use std::path::Path;
use std::sync::{Arc, mpsc};
use std::time::Duration;

use cpal::{FromSample, OutputCallbackInfo, OutputStreamTimestamp, Sample, StreamInstant};

use super::LiveError;
use super::link::{Link, Slot};
use super::recording::Recording;
use super::renderer::{Message, Remote, Renderer};

/// The callback of a stream with `channels` channels for this renderer.
pub fn player<T: Sample + FromSample<f32>>(
    renderer: Renderer,
    remote: &Remote,
    channels: usize,
) -> impl FnMut(&mut [T]) + use<T> {
    let rate_hz = renderer.rate_hz();
    let (commands, _) = mpsc::channel();
    let link = Link {
        slot: Arc::new(Slot::new(Some(Box::new(renderer)))),
        drop_queue: Arc::new(Slot::new(None)),
        shared: Arc::clone(&remote.shared),
        commands,
        generation: 0,
    };
    let mut play = link.player::<T>(channels, rate_hz);
    let callback = StreamInstant::ZERO;
    let playback = callback + Duration::from_millis(20);
    let info = OutputCallbackInfo::new(OutputStreamTimestamp { callback, playback });
    move |out| play(out, &info)
}

/// A recording of a renderer's output.
#[derive(Debug)]
pub struct Recorder(Recording);

impl Recorder {
    /// Starts a file at `rate_hz` samples per second; the file stays empty if the queue to the callback is full.
    ///
    /// # Errors
    /// The errors of [`Live::start_recording`](super::Live::start_recording).
    pub fn start(remote: &mut Remote, path: &Path, rate_hz: u32) -> Result<Self, LiveError> {
        let mut recording = Recording::new(path, rate_hz)?;
        let (commands, _) = mpsc::channel();
        if let Some(tap) = recording.begin(&commands)
            && remote.send(Message::Tap(tap)).is_err()
        {
            recording.end();
        }
        Ok(Self(recording))
    }

    /// Completes the file and returns the number of frames in it.
    ///
    /// # Errors
    /// The errors of [`Live::stop_recording`](super::Live::stop_recording).
    pub fn finish(self) -> Result<u64, LiveError> {
        self.0.finish()
    }
}
