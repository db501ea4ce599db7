//! Values that the callback shares with other threads: single atomics, so that none waits.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};

use std::time::Instant;

use crate::audio::{Gains, PanningLaw};

/// Latency that was not reported, or not measured yet.
const NO_LATENCY: u64 = u64::MAX;

/// The share of the newest waiting time in the reported value.
const FRESH: f64 = 0.15;

/// The values are independent, so the order in which they are seen does not matter.
#[derive(Debug)]
pub(super) struct Shared {
    /// −1 to 1, as the bits of an `f32`.
    pan: AtomicU32,
    /// What the times of pans are counted from.
    epoch: Instant,
    /// Microseconds when the oldest pan was set that no callback has taken yet; 0 without one.
    pan_set_us: AtomicU64,
    /// Microseconds that pans waited for a callback to take them: glides after the last one.
    pan_waited_us: AtomicU64,
    /// 0 to 1, as the bits of an `f32`.
    volume: AtomicU32,
    law: AtomicU8,
    /// Whether a device is open: otherwise the levels are outdated.
    pub(super) is_open: AtomicBool,
    /// Whether all fades to silence, before a stream is closed.
    pub(super) is_muted: AtomicBool,
    /// Whether it has: a block was made with the end of that fade.
    pub(super) has_faded: AtomicBool,
    /// The stream whose callback may play; the callbacks of others keep silent.
    pub(super) generation: AtomicU64,
    /// Callbacks so far, over all streams.
    pub(super) callbacks: AtomicU64,
    /// Frames requested from the last callback.
    pub(super) callback_frames: AtomicU32,
    /// Microseconds from a callback to when its first sample is heard.
    latency_us: AtomicU64,
    /// Under-runs that the sound system reported.
    pub(super) under_runs: AtomicU64,
    /// Callbacks that came later than two buffers after the one before.
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
        // One that is set before the last was taken is taken sooner: the oldest counts.
        let now = self.now_us();
        let _ = self.pan_set_us.compare_exchange(0, now, Relaxed, Relaxed);
    }

    /// Microseconds, never 0.
    fn now_us(&self) -> u64 {
        self.epoch.elapsed().as_micros() as u64 + 1
    }

    /// Called when the pan is taken.
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

    /// Forgets a pan that no callback took: the next stream's is not to be blamed for it.
    pub(super) fn forget_pan(&self) {
        self.pan_set_us.store(0, Relaxed);
    }

    /// Milliseconds that pans waited for a callback to take them, smoothed; none before the first.
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

    /// The gains that are wanted now.
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

    /// The factor on both channels of a sound of two channels.
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

    /// In milliseconds.
    pub(super) fn latency_ms(&self) -> Option<f64> {
        told(self.latency_us.load(Relaxed))
    }
}

/// A value that glides towards another.
fn glide(from: u64, to: u64) -> u64 {
    (from as f64 + FRESH * (to as f64 - from as f64)).round() as u64
}

/// In milliseconds, if it was reported at all.
fn told(microseconds: u64) -> Option<f64> {
    (microseconds != NO_LATENCY).then_some(microseconds as f64 / 1000.0)
}
