//! Measures the latency from a key press to the ear, part by part.

use serde::Serialize;
use std::time::{Duration, Instant};

/// The weight of the newest measurement in the exponentially smoothed value.
const FRESH: f64 = 0.15;

/// A smoothed measurement.
#[derive(Clone, Copy, Debug, Default)]
struct Gliding(Option<f64>);

impl Gliding {
    fn add(&mut self, duration: Duration) {
        let value = duration.as_secs_f64() * 1e3;
        self.0 = Some(self.0.map_or(value, |old| old + FRESH * (value - old)));
    }
}

/// The measured parts, in milliseconds; `None` for a part without a measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Parts {
    /// Maximum time from a key or mouse event to the start of the frame that traces its effect. The event may have
    /// occurred at any time since events were last processed.
    pub input_to_trace: Option<f64>,
    /// Time from the start of the frame until its result was read back.
    pub trace_to_read_back: Option<f64>,
    /// Time from the read-back until the sound thread used the gains for its next buffer.
    pub gains_to_buffer: Option<f64>,
    /// Time from that buffer to the ear, as reported by the sound device.
    pub buffer_to_device: Option<f64>,
}

impl Parts {
    /// Whether every part is known.
    pub fn is_whole(&self) -> bool {
        let sound = self.gains_to_buffer.and(self.buffer_to_device);
        self.input_to_trace
            .and(self.trace_to_read_back)
            .and(sound)
            .is_some()
    }

    /// The sum of all measured parts.
    pub fn total(&self) -> f64 {
        [
            self.input_to_trace,
            self.trace_to_read_back,
            self.gains_to_buffer,
            self.buffer_to_device,
        ]
        .iter()
        .flatten()
        .fold(0.0, |sum, part| sum + part)
    }
}

/// Measures the latency.
#[derive(Clone, Copy, Debug, Default)]
pub struct Latency {
    /// The time of the earliest input that has not been traced.
    input: Option<Instant>,
    begun: Option<Instant>,
    input_to_trace: Gliding,
    trace_to_read_back: Gliding,
    gains_to_buffer: Option<f64>,
    buffer_to_device: Option<f64>,
}

impl Latency {
    /// Records an input at time `at` that changes the sound. If an earlier input has not been traced yet, only the
    /// earlier one is kept.
    pub fn input(&mut self, at: Instant) {
        self.input.get_or_insert(at);
    }

    /// Records the start of a frame, which traces all earlier inputs.
    pub fn trace_begins(&mut self, at: Instant) {
        if let Some(input) = self.input.take() {
            self.input_to_trace.add(at.duration_since(input));
        }
        self.begun = Some(at);
    }

    /// Records that the frame was read back and passed to the sound.
    pub fn read_back(&mut self, at: Instant) {
        if let Some(begun) = self.begun.take() {
            self.trace_to_read_back.add(at.duration_since(begun));
        }
    }

    /// Sets the two latencies of the sound output, in milliseconds.
    pub fn sound(&mut self, gains_to_buffer: Option<f64>, buffer_to_device: Option<f64>) {
        self.gains_to_buffer = gains_to_buffer;
        self.buffer_to_device = buffer_to_device;
    }

    /// The parts measured so far.
    pub fn parts(&self) -> Parts {
        Parts {
            input_to_trace: self.input_to_trace.0,
            trace_to_read_back: self.trace_to_read_back.0,
            gains_to_buffer: self.gains_to_buffer,
            buffer_to_device: self.buffer_to_device,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the latency chain: of several inputs only the first counts, each input is counted once, and the parts
    /// add up to the total.
    #[test]
    fn parts_follow_one_another() {
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let mut latency = Latency::default();
        assert_eq!(latency.parts().total(), 0.0);
        latency.input(start);
        latency.input(after(9));
        latency.trace_begins(after(10));
        latency.read_back(after(25));
        // A frame without input does not change the first part.
        latency.trace_begins(after(40));
        latency.read_back(after(55));
        latency.sound(Some(5.0), None);
        let parts = latency.parts();
        assert_eq!(parts.input_to_trace, Some(10.0));
        assert_eq!(parts.trace_to_read_back, Some(15.0));
        assert_eq!(parts.buffer_to_device, None);
        assert_eq!((parts.total(), parts.is_whole()), (30.0, false));
        latency.sound(Some(5.0), Some(20.0));
        assert!(latency.parts().is_whole());
    }
}
