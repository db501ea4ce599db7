//! The level of both channels, over windows of 50 ms.

use super::shared::Shared;

/// Windows per second.
const WINDOWS_HZ: u32 = 20;

/// Sums squares until a window is full, then returns its level (RMS).
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

    /// Takes interleaved samples.
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
