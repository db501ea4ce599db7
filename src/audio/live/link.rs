//! What threads share: the callbacks that drive the renderer, the values that they read and report, and the commands to
//! the supervising thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use cpal::{ErrorKind, FromSample, OutputCallbackInfo, Sample};
use crossbeam_utils::atomic::AtomicCell;

use super::renderer::Renderer;
use crate::audio::{Gains, PanningLaw, SoundSource, StereoSource};

/// A command to the supervising thread.
#[derive(Debug)]
pub(super) enum Command {
    /// Fade to another sound.
    Sound(SoundSource),
    /// Fade to a caller's own channels; `None` for the mono sound and its pan.
    Stereo(Option<StereoSource>),
    /// Play on another device.
    Device(Option<String>),
    /// Take the recording that waits in the state.
    Record,
    /// An event on another thread to report.
    Notice(String),
    /// A stream broke off.
    Lost { generation: u64, reason: String },
    /// End the thread.
    Stop,
}

/// Latency that was not reported, or not measured yet.
const NO_LATENCY: u64 = u64::MAX;

/// The weight of the newest waiting time in the reported value.
const FRESH: f64 = 0.15;

/// Atomic values of one live output. They are independent, so the order in which they are seen does not matter.
#[derive(Debug)]
pub(super) struct Shared {
    /// −1 to 1, as the bits of an `f32`.
    pan: AtomicU32,
    /// Origin of the times of pans.
    epoch: Instant,
    /// Time when the oldest pan was set that no callback has taken yet, in microseconds; 0 without one.
    pan_set_us: AtomicU64,
    /// Microseconds that pans waited for a callback to take them, smoothed.
    pan_waited_us: AtomicU64,
    /// 0 to 1, as the bits of an `f32`.
    volume: AtomicU32,
    law: AtomicU8,
    /// Whether a device is open: otherwise the levels are outdated.
    pub(super) is_open: AtomicBool,
    /// Whether the output fades to silence, before a stream is closed.
    pub(super) is_muted: AtomicBool,
    /// Whether that fade is complete: a block with its end was computed.
    pub(super) has_faded: AtomicBool,
    /// The stream whose callback may play; the callbacks of other streams output silence.
    pub(super) generation: AtomicU64,
    /// Total callbacks of all streams.
    pub(super) callbacks: AtomicU64,
    /// Frames requested from the last callback.
    pub(super) callback_frames: AtomicU32,
    /// Microseconds from a callback until its first sample is heard.
    latency_us: AtomicU64,
    /// Under-runs that the sound system reported.
    pub(super) under_runs: AtomicU64,
    /// Callbacks later than two buffers after the previous one.
    pub(super) late_callbacks: AtomicU64,
    /// Level of both channels, as the bits of an `f32`.
    levels: [AtomicU32; 2],
}

impl Shared {
    pub(super) fn new(law: PanningLaw) -> Self {
        let shared = Self {
            pan: AtomicU32::new(0f32.to_bits()),
            epoch: Instant::now(),
            pan_set_us: AtomicU64::new(0),
            pan_waited_us: AtomicU64::new(NO_LATENCY),
            volume: AtomicU32::new(1f32.to_bits()),
            law: AtomicU8::new(0),
            is_open: AtomicBool::new(false),
            is_muted: AtomicBool::new(false),
            has_faded: AtomicBool::new(false),
            generation: AtomicU64::new(0),
            callbacks: AtomicU64::new(0),
            callback_frames: AtomicU32::new(0),
            latency_us: AtomicU64::new(NO_LATENCY),
            under_runs: AtomicU64::new(0),
            late_callbacks: AtomicU64::new(0),
            levels: [AtomicU32::new(0), AtomicU32::new(0)],
        };
        shared.set_law(law);
        shared
    }

    pub(super) fn set_pan(&self, pan: f32) {
        self.pan.store(pan.to_bits(), Relaxed);
        // A pan set before the last one was taken is taken sooner: the oldest counts.
        let now = self.now_us();
        let _ = self.pan_set_us.compare_exchange(0, now, Relaxed, Relaxed);
    }

    /// Microseconds since the origin, never 0.
    fn now_us(&self) -> u64 {
        self.epoch.elapsed().as_micros() as u64 + 1
    }

    /// Measures the waiting time when the pan is taken.
    fn measure_wait(&self) {
        let set = self.pan_set_us.swap(0, Relaxed);
        if set != 0 {
            let waited = self.now_us().saturating_sub(set);
            let smooth = match self.pan_waited_us.load(Relaxed) {
                NO_LATENCY => waited,
                before => glide(before, waited),
            };
            self.pan_waited_us.store(smooth, Relaxed);
        }
    }

    /// Forgets a pan that no callback took, so that it does not count for the next stream.
    pub(super) fn forget_pan(&self) {
        self.pan_set_us.store(0, Relaxed);
    }

    /// Milliseconds that pans waited for a callback to take them, smoothed; `None` before the first.
    pub(super) fn pan_waited_ms(&self) -> Option<f64> {
        told(self.pan_waited_us.load(Relaxed))
    }

    pub(super) fn set_volume(&self, volume: f32) {
        let volume = if volume.is_nan() { 0.0 } else { volume };
        self.volume.store(volume.clamp(0.0, 1.0).to_bits(), Relaxed);
    }

    pub(super) fn set_law(&self, law: PanningLaw) {
        let code = match law {
            PanningLaw::Linear => 0,
            PanningLaw::ConstantPower => 1,
        };
        self.law.store(code, Relaxed);
    }

    fn law(&self) -> PanningLaw {
        match self.law.load(Relaxed) {
            0 => PanningLaw::Linear,
            _ => PanningLaw::ConstantPower,
        }
    }

    /// The requested gains.
    pub(super) fn target(&self) -> Gains {
        self.measure_wait();
        if self.is_muted.load(Relaxed) {
            return Gains::SILENT;
        }
        let gains = self.law().gains(f32::from_bits(self.pan.load(Relaxed)));
        let volume = f32::from_bits(self.volume.load(Relaxed));
        Gains {
            left: volume * gains.left,
            right: volume * gains.right,
        }
    }

    /// The requested factor on both channels of a stereo sound.
    pub(super) fn volume_target(&self) -> Gains {
        if self.is_muted.load(Relaxed) {
            return Gains::SILENT;
        }
        let volume = f32::from_bits(self.volume.load(Relaxed));
        Gains {
            left: volume,
            right: volume,
        }
    }

    pub(super) fn set_levels(&self, levels: [f32; 2]) {
        for (cell, level) in self.levels.iter().zip(levels) {
            cell.store(level.to_bits(), Relaxed);
        }
    }

    pub(super) fn levels(&self) -> [f32; 2] {
        [0, 1].map(|i| f32::from_bits(self.levels[i].load(Relaxed)))
    }

    pub(super) fn set_latency_us(&self, latency_us: Option<u64>) {
        self.latency_us
            .store(latency_us.unwrap_or(NO_LATENCY), Relaxed);
    }

    /// Latency in milliseconds.
    pub(super) fn latency_ms(&self) -> Option<f64> {
        told(self.latency_us.load(Relaxed))
    }
}

/// Smooths a value: moves it part of the way to another.
fn glide(from: u64, to: u64) -> u64 {
    (from as f64 + FRESH * (to as f64 - from as f64)).round() as u64
}

/// A time in milliseconds, if it was reported.
fn told(microseconds: u64) -> Option<f64> {
    (microseconds != NO_LATENCY).then_some(microseconds as f64 / 1000.0)
}

/// Holds the renderer while nothing plays: it outlives streams. Taking it and putting it back swap
/// one pointer.
pub(super) type Slot = AtomicCell<Option<Box<Renderer>>>;

/// Data for the callbacks of one stream.
#[derive(Clone)]
pub(super) struct Link {
    pub(super) slot: Arc<Slot>,
    /// Holds a replaced renderer, for the supervisor to free.
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

    /// Puts the renderer back. If a callback hung and the supervisor made another renderer in the
    /// meantime, the newer one stays in the slot.
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

    /// Leaves a renderer to the supervisor, without freeing anything here.
    fn retire(&self, renderer: Box<Renderer>) {
        if let Some(another) = self.drop_queue.swap(Some(renderer)) {
            // Two between two checks of the supervisor have never been observed: the second is leaked.
            std::mem::forget(another);
        }
    }

    /// Records a callback: the time of the call and the time when its samples will be heard.
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
        // Zero is reported as long as the latency is unknown.
        self.shared
            .set_latency_us(latency_us.filter(|&latency_us| latency_us > 0));
        self.shared.callback_frames.store(frames as u32, Relaxed);
        self.shared.callbacks.fetch_add(1, Relaxed);
    }

    /// The callback for errors: counts under-runs; of the errors that end the stream, reports only
    /// the first, because there may be hundreds.
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
                // If the supervisor is gone, the stream soon ends as well.
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
    use crate::audio::SAMPLE_RATE;

    fn numbered(number: u64) -> Box<Renderer> {
        let (mut renderer, _) = Renderer::new(None, SAMPLE_RATE, PanningLaw::Linear);
        renderer.number = number;
        Box::new(renderer)
    }

    /// Protects the renderer that belongs to the supervisor's remote: when a hung callback puts
    /// back its renderer, the newer one stays, whichever comes first, and the supervisor frees the
    /// other, not the callback.
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
