//! Keeps loud sound within full scale.

/// The largest sample that is not reduced, relative to full scale 1.
const CEILING: f32 = 0.98;

/// Samples over which the gain falls: 0.7 ms at 48 kHz. Samples still too loud meanwhile are
/// clipped at full scale.
const ATTACK: usize = 32;

/// Seconds in which the gain rises again by a factor of e.
const RELEASE_S: f32 = 0.4;

/// A gain that falls immediately when a block is too loud, and rises slowly.
#[derive(Debug)]
pub(super) struct Limiter {
    gain: f32,
    /// Samples per second.
    rate_hz: f32,
}

impl Limiter {
    pub(super) fn new(rate_hz: u32) -> Limiter {
        Limiter {
            gain: 1.0,
            rate_hz: rate_hz as f32,
        }
    }

    /// Limits a block of interleaved samples.
    pub(super) fn apply(&mut self, stereo: &mut [f32]) {
        let frames = stereo.len() / 2;
        let peak = stereo.iter().fold(0.0_f32, |peak, s| peak.max(s.abs()));
        let released = (frames as f32 / (RELEASE_S * self.rate_hz)).min(1.0);
        let risen = self.gain + (1.0 - self.gain) * released;
        let target = risen.min(CEILING / peak.max(CEILING));
        if self.gain == 1.0 && target == 1.0 {
            return;
        }
        let ramp = match target < self.gain {
            true => ATTACK.min(frames),
            false => frames,
        };
        for (index, pair) in stereo.chunks_exact_mut(2).enumerate() {
            let share = (index + 1).min(ramp) as f32 / ramp as f32;
            let gain = self.gain + (target - self.gain) * share;
            pair[0] = (pair[0] * gain).clamp(-1.0, 1.0);
            pair[1] = (pair[1] * gain).clamp(-1.0, 1.0);
        }
        self.gain = target;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects full scale, and soft sounds, which must not change.
    #[test]
    fn loud_is_limited_and_soft_is_not_touched() {
        let mut limiter = Limiter::new(48_000);
        let soft: Vec<f32> = (0..512).map(|i| (i as f32 * 0.1).sin() * 0.9).collect();
        let mut block = soft.clone();
        limiter.apply(&mut block);
        assert_eq!(block, soft);
        let mut loud: Vec<f32> = soft.iter().map(|sample| sample * 20.0).collect();
        limiter.apply(&mut loud);
        assert!(loud.iter().all(|sample| sample.abs() <= 1.0));
        let cut = loud.iter().filter(|sample| sample.abs() == 1.0).count();
        assert!(cut < 2 * ATTACK, "{cut} samples were cut");
        for _ in 0..400 {
            block.clone_from(&soft);
            limiter.apply(&mut block);
        }
        assert!(block.iter().zip(&soft).all(|(a, b)| (a - b).abs() < 0.01));
    }
}
