//! Values that the callback shares with other threads, as single atomics, so that no thread waits; also the level meter
//! of both channels, over windows of 50 ms.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use crate::audio::{Gains, PanningLaw};

/// Marks a latency that is not reported or not measured yet.
const NO_LATENCY: u64 = u64::MAX;

/// The weight of the newest waiting time in the smoothed waiting time.
const FRESH: f64 = 0.15;

/// Atomic values of one live output. They are independent of each other, so the order of their changes does not matter.
#[derive(Debug)]
pub(super) struct Shared {
    /// −1 to 1, as the bits of an `f32`.
    pan: AtomicU32,
    /// Origin of the times at which pans are set.
    epoch: Instant,
    /// Time in microseconds at which the oldest pan not yet applied by a callback was set; 0 if there is none.
    pan_set_us: AtomicU64,
    /// Microseconds until a callback applied a pan, smoothed.
    pan_waited_us: AtomicU64,
    /// 0 to 1, as the bits of an `f32`.
    volume: AtomicU32,
    law: AtomicU8,
    /// Whether a device is open. If no device is open, the levels are outdated.
    pub(super) is_open: AtomicBool,
    /// Whether the output fades to silence because a stream is about to be closed.
    pub(super) is_muted: AtomicBool,
    /// Whether that fade is complete, including the block in which it ends.
    pub(super) has_faded: AtomicBool,
    /// The stream whose callback may play; the callbacks of other streams output silence.
    pub(super) generation: AtomicU64,
    /// Total callbacks of all streams.
    pub(super) callbacks: AtomicU64,
    /// Number of frames requested in the last callback.
    pub(super) callback_frames: AtomicU32,
    /// Microseconds from a callback until its first sample is audible.
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
        // A new pan does not reset the time of an earlier pan that no callback has applied yet: the oldest time counts.
        let now = self.now_us();
        let _ = self.pan_set_us.compare_exchange(0, now, Relaxed, Relaxed);
    }

    /// Microseconds since the origin, never 0.
    fn now_us(&self) -> u64 {
        self.epoch.elapsed().as_micros() as u64 + 1
    }

    /// Measures the waiting time when a callback applies the pan.
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

    /// Discards a pan that no callback applied, so that it does not count for the next stream.
    pub(super) fn forget_pan(&self) {
        self.pan_set_us.store(0, Relaxed);
    }

    /// Milliseconds until a callback applied a pan, smoothed; `None` before the first pan.
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

    /// The gains for the current pan, law and volume.
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

    /// The current gain of both channels of a stereo sound.
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

/// Smooths a value by moving it part of the way towards another value.
fn glide(from: u64, to: u64) -> u64 {
    (from as f64 + FRESH * (to as f64 - from as f64)).round() as u64
}

/// Converts microseconds to milliseconds; `None` if the value was not reported.
fn told(microseconds: u64) -> Option<f64> {
    (microseconds != NO_LATENCY).then_some(microseconds as f64 / 1000.0)
}

/// Windows per second.
const WINDOWS_HZ: u32 = 20;

/// Sums squares until a window is full, then publishes its level (RMS).
#[derive(Debug)]
pub(super) struct Meter {
    squares: [f64; 2],
    frames: u32,
    /// Frames of a window; at least 1.
    window: u32,
}

impl Meter {
    pub(super) fn new(rate_hz: u32) -> Self {
        Self {
            squares: [0.0; 2],
            frames: 0,
            window: (rate_hz / WINDOWS_HZ).max(1),
        }
    }

    /// Adds interleaved samples.
    pub(super) fn take(&mut self, stereo: &[f32], shared: &Shared) {
        for pair in stereo.chunks_exact(2) {
            self.squares[0] += f64::from(pair[0]).powi(2);
            self.squares[1] += f64::from(pair[1]).powi(2);
            self.frames += 1;
            if self.frames == self.window {
                let level = |squares: f64| (squares / f64::from(self.window)).sqrt() as f32;
                shared.set_levels(self.squares.map(level));
                self.squares = [0.0; 2];
                self.frames = 0;
            }
        }
    }
}
