//! What the callback and the other threads share: single atomic values, so that none waits.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};

use crate::audio::{Gains, PanningLaw};

/// Latency that was not told.
const NO_LATENCY: u64 = u64::MAX;

/// Each value stands for itself, so the order in which they are seen does not matter.
#[derive(Debug)]
pub(super) struct Shared {
    /// −1 to 1, as the bits of an `f32`.
    pan: AtomicU32,
    /// 0 to 1, as the bits of an `f32`.
    volume: AtomicU32,
    law: AtomicU8,
    /// Whether all fades to silence, before a stream is closed.
    pub(super) is_muted: AtomicBool,
    /// The stream whose callback may play; the callbacks of others keep silent.
    pub(super) generation: AtomicU64,
    /// Callbacks so far, over all streams.
    pub(super) callbacks: AtomicU64,
    /// Frames that the last callback was asked for.
    pub(super) callback_frames: AtomicU32,
    /// Microseconds from a callback to when its first sample is heard.
    latency_us: AtomicU64,
    /// Under-runs that the sound system told of.
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
            volume: AtomicU32::new(1f32.to_bits()),
            law: AtomicU8::new(0),
            is_muted: AtomicBool::new(false),
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
        let latency_us = self.latency_us.load(Relaxed);
        (latency_us != NO_LATENCY).then_some(latency_us as f64 / 1000.0)
    }
}
