//! Gains that change over a fixed time, whatever the length of the blocks.

use crate::audio::Gains;

/// Runs linearly from the current gains to the target gains.
#[derive(Debug)]
pub(super) struct Glide {
    current: Gains,
    target: Gains,
    /// Samples until the target is reached.
    left: usize,
    /// Samples that a whole change takes; at least 1.
    length: usize,
}

impl Glide {
    /// Starts in silence; a change takes `length` samples.
    pub(super) fn new(length: usize) -> Self {
        Self {
            current: Gains::SILENT,
            target: Gains::SILENT,
            left: 0,
            length: length.max(1),
        }
    }

    /// Starts to change from the current gains to other ones.
    pub(super) fn aim(&mut self, target: Gains) {
        if target != self.target {
            self.target = target;
            self.left = self.length;
        }
    }

    /// Whether the gains are zero and stay so.
    pub(super) fn is_silent(&self) -> bool {
        self.left == 0 && self.target == Gains::SILENT
    }

    /// Advances by up to `most` samples; returns their number and the gains of the last of them.
    pub(super) fn advance(&mut self, most: usize) -> (usize, Gains) {
        if self.left == 0 {
            return (most, self.target);
        }
        let count = self.left.min(most);
        let share = count as f32 / self.left as f32;
        self.left -= count;
        if self.left == 0 {
            self.current = self.target;
        } else {
            self.current.left += (self.target.left - self.current.left) * share;
            self.current.right += (self.target.right - self.current.right) * share;
        }
        (count, self.current)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the duration of a change: it does not depend on the length of the blocks.
    #[test]
    fn a_change_takes_its_time_in_blocks_of_any_length() {
        let target = Gains {
            left: 1.0,
            right: 0.25,
        };
        for block in [1, 7, 100, 1000] {
            let mut glide = Glide::new(100);
            glide.aim(target);
            let (mut samples, mut gains) = (0, Gains::SILENT);
            while gains != target {
                let (count, next) = glide.advance(block);
                samples += count;
                gains = next;
                let on_the_line = samples as f32 / 100.0;
                assert!((gains.left - on_the_line).abs() < 1e-5);
            }
            assert_eq!(samples, 100, "blocks of {block}");
            assert_eq!(glide.advance(block), (block, target));
        }
    }
}
