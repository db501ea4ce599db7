//! The stream callbacks of the sound system, which drive the renderer, and the commands to the supervising thread.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use cpal::{ErrorKind, FromSample, OutputCallbackInfo, Sample};
use crossbeam_utils::atomic::AtomicCell;

use super::renderer::Renderer;
use super::shared::Shared;
use super::sources::{SoundSource, StereoSource};

/// A command to the supervising thread.
#[derive(Debug)]
pub(super) enum Command {
    /// Fade to another sound.
    Sound(SoundSource),
    /// Fade to a caller's own channels; `None` for the mono sound and its pan.
    Stereo(Option<StereoSource>),
    /// Play on another device.
    Device(Option<String>),
    /// Start the recording stored in the supervisor's state.
    Record,
    /// Report an event on another thread.
    Notice(String),
    /// A stream was lost.
    Lost { generation: u64, reason: String },
    /// End the thread.
    Stop,
}

/// Holds the renderer while nothing plays. The slot outlives streams. Taking the renderer and putting it back each swap
/// one pointer.
pub(super) type Slot = AtomicCell<Option<Box<Renderer>>>;

/// Data for the callbacks of one stream.
#[derive(Clone)]
pub(super) struct Link {
    pub(super) slot: Arc<Slot>,
    /// Holds a replaced renderer until the supervisor frees it.
    pub(super) drop_queue: Arc<Slot>,
    pub(super) shared: Arc<Shared>,
    pub(super) commands: Sender<Command>,
    /// The stream's number.
    pub(super) generation: u64,
}

impl Link {
    /// The callback that fills a device's buffer.
    pub(super) fn player<T: Sample + FromSample<f32>>(
        &self,
        channels: usize,
        rate_hz: u32,
    ) -> impl FnMut(&mut [T], &OutputCallbackInfo) + Send + 'static + use<T> {
        let link = self.clone();
        let mut last = None;
        move |out, info| {
            let frames = out.len() / channels.max(1);
            link.play(out, channels);
            if link.is_current() {
                link.note(info, frames, rate_hz, &mut last);
            }
        }
    }

    fn is_current(&self) -> bool {
        self.shared.generation.load(Relaxed) == self.generation
    }

    fn play<T: Sample + FromSample<f32>>(&self, out: &mut [T], channels: usize) {
        let renderer = self.is_current().then(|| self.slot.take()).flatten();
        let Some(mut renderer) = renderer else {
            out.fill(T::EQUILIBRIUM);
            return;
        };
        renderer.fill_device(out, channels);
        self.put_back(renderer);
    }

    /// Puts the renderer back. If a callback hung and the supervisor made a new renderer in the meantime, the slot
    /// keeps the new renderer.
    fn put_back(&self, renderer: Box<Renderer>) {
        let mut mine = renderer;
        loop {
            let number = mine.number;
            match self.slot.swap(Some(mine)) {
                None => return,
                Some(other) if other.number < number => return self.retire(other),
                Some(newer) => mine = newer,
            }
        }
    }

    /// Hands a renderer to the supervisor, which frees it. This function frees nothing.
    fn retire(&self, renderer: Box<Renderer>) {
        if let Some(another) = self.drop_queue.swap(Some(renderer)) {
            // Two retired renderers between two checks of the supervisor have never been observed. The second renderer
            // is leaked.
            std::mem::forget(another);
        }
    }

    /// Measures a callback: whether it is late, and the latency until its samples are played.
    fn note(
        &self,
        info: &OutputCallbackInfo,
        frames: usize,
        rate_hz: u32,
        last: &mut Option<(Instant, Duration)>,
    ) {
        let now = Instant::now();
        let length = Duration::from_secs_f64(frames as f64 / f64::from(rate_hz));
        if let Some((before, buffer)) = last.replace((now, length))
            && now.saturating_duration_since(before) > 2 * buffer
        {
            self.shared.late_callbacks.fetch_add(1, Relaxed);
        }
        let time = info.timestamp();
        let latency = time.playback.saturating_duration_since(time.callback);
        let latency_us = u64::try_from(latency.as_micros()).ok();
        // A latency of zero means that the sound system does not know the latency yet.
        self.shared
            .set_latency_us(latency_us.filter(|&latency_us| latency_us > 0));
        self.shared.callback_frames.store(frames as u32, Relaxed);
        self.shared.callbacks.fetch_add(1, Relaxed);
    }

    /// The callback for errors. It counts under-runs, and reports only the first error that ends the stream, because
    /// hundreds may follow.
    pub(super) fn error_callback(&self) -> impl FnMut(cpal::Error) + Send + 'static {
        let link = self.clone();
        let mut is_told = false;
        move |error| match error.kind() {
            ErrorKind::Xrun => {
                link.shared.under_runs.fetch_add(1, Relaxed);
            }
            ErrorKind::DeviceChanged | ErrorKind::RealtimeDenied => {}
            _ if is_told => {}
            _ => {
                is_told = true;
                // If the supervisor no longer runs, the stream soon ends as well.
                let _ = link.commands.send(Command::Lost {
                    generation: link.generation,
                    reason: error.to_string(),
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audio::{PanningLaw, Sound};

    fn numbered(number: u64) -> Box<Renderer> {
        let (mut renderer, _) = Renderer::new(None, Sound::SAMPLE_RATE, PanningLaw::Linear);
        renderer.number = number;
        Box::new(renderer)
    }

    /// Protects the renderer that the supervisor controls: when a hung callback puts back its renderer, the newer
    /// renderer stays in the slot, in either order, and the supervisor, not the callback, frees the older renderer.
    #[test]
    fn the_newer_renderer_stays_and_the_older_is_retired() {
        for (there, back) in [(2, 1), (1, 2)] {
            let (commands, _receiver) = std::sync::mpsc::channel();
            let link = Link {
                slot: Arc::new(Slot::new(Some(numbered(there)))),
                drop_queue: Arc::new(Slot::new(None)),
                shared: Arc::new(Shared::new(PanningLaw::Linear)),
                commands,
                generation: 0,
            };
            link.put_back(numbered(back));
            assert_eq!(link.slot.take().unwrap().number, 2);
            assert_eq!(link.drop_queue.take().unwrap().number, 1);
        }
    }
}
