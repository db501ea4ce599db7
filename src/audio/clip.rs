//! A recorded sound, held in memory.

/// Mono samples with a place to read from.
#[derive(Debug, Clone)]
pub(super) struct Clip {
    /// Never empty.
    samples: Vec<f32>,
    next: usize,
    looping: bool,
}

impl Clip {
    /// A looping clip at its start; `samples` must not be empty.
    pub(super) fn new(samples: Vec<f32>) -> Self {
        debug_assert!(!samples.is_empty());
        Self {
            samples,
            next: 0,
            looping: true,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.samples.len()
    }

    pub(super) fn set_looping(&mut self, looping: bool) {
        self.looping = looping;
    }

    pub(super) fn is_finished(&self) -> bool {
        !self.looping && self.next == self.samples.len()
    }

    /// Makes the sample with this number the next one; a looping clip's numbers go on past its end.
    pub(super) fn seek(&mut self, index: u64) {
        let length = self.samples.len() as u64;
        self.next = if self.looping {
            index % length
        } else {
            index.min(length)
        } as usize;
    }

    pub(super) fn fill(&mut self, mut out: &mut [f32]) {
        while !out.is_empty() {
            if self.next == self.samples.len() {
                if !self.looping {
                    out.fill(0.0);
                    return;
                }
                self.next = 0;
            }
            let left = &self.samples[self.next..];
            let count = left.len().min(out.len());
            let (now, later) = out.split_at_mut(count);
            now.copy_from_slice(&left[..count]);
            self.next += count;
            out = later;
        }
    }
}
