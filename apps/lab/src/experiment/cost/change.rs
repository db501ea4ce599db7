//! Compares the audible effect of a change with the effect of another seed.

use crate::stats::mean;
use echomarch::tracer::{Frame, Panning};
use serde::Serialize;

/// The size of a change, over several pairs of frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Size {
    /// The signed mean over the pairs.
    pub mean: f64,
    /// The root mean square over the pairs: the typical change of a single frame.
    pub rms: f64,
}

/// The audible change between frames with the same start directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Change of the share of heard waves, in percent of the share before the change.
    pub heard_percent: Size,
    /// Change of the panning value (−1 to 1).
    pub pan: Size,
    /// Change of the level in dB, at the ear with the larger change; every heard wave has the same energy. `None` if an
    /// ear becomes silent or is no longer silent.
    pub level_db: Option<Size>,
}

/// The effect of another seed on the complete scene: the root mean square difference between the frames of two seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// Number of seeds.
    pub seeds: u32,
    /// Share of a frame's waves that are heard (mean over the seeds).
    pub heard: f64,
    /// Noise of the share of heard waves, in percent of this share.
    pub heard_percent: f64,
    /// Noise of the panning value.
    pub pan: f64,
    /// Noise of the level in dB, at the ear with the larger noise. `None` if an ear hears nothing with some seed; every
    /// change of the level is then within the noise.
    pub level_db: Option<f64>,
}

impl Size {
    fn of(values: &[f64]) -> Size {
        let square = mean(values.iter().map(|v| v * v));
        Size {
            mean: mean(values.iter().copied()).unwrap_or(0.0),
            rms: square.unwrap_or(0.0).sqrt(),
        }
    }
}

impl Change {
    /// The change between pairs of frames with these numbers of waves; `None` if no wave is heard before the change.
    pub(super) fn of(base: (&[Frame], u32), changed: (&[Frame], u32)) -> Option<Change> {
        let shares = |(frames, waves): (&[Frame], u32)| -> Vec<f64> {
            frames.iter().map(|f| heard(f) / f64::from(waves)).collect()
        };
        let before = shares(base);
        let heard_before = mean(before.iter().copied()).filter(|mean| *mean > 0.0)?;
        let pairs = before.iter().zip(shares(changed));
        let heard: Vec<f64> = pairs.map(|(b, c)| 100.0 * (c - b) / heard_before).collect();
        let pairs = || base.0.iter().zip(changed.0);
        let pan: Vec<f64> = pairs()
            .map(|(b, c)| c.panning.pan() - b.panning.pan())
            .collect();
        let gain = f64::from(base.1) / f64::from(changed.1);
        let levels: Option<Vec<f64>> = pairs()
            .map(|(b, c)| level(&b.panning, &c.panning, gain))
            .collect();
        Some(Change {
            heard_percent: Size::of(&heard),
            pan: Size::of(&pan),
            level_db: levels.map(|levels| Size::of(&levels)),
        })
    }

    /// Whether the effect of another seed is at least as large in every measure.
    pub fn is_within(&self, noise: &Noise) -> bool {
        let level = match (self.level_db, noise.level_db) {
            (_, None) => true,
            (None, Some(_)) => false,
            (Some(change), Some(noise)) => change.rms <= noise,
        };
        level && self.heard_percent.rms <= noise.heard_percent && self.pan.rms <= noise.pan
    }
}

impl Noise {
    /// The noise of frames that differ only in the seed.
    pub(super) fn of(frames: &[Frame], waves: u32) -> Noise {
        let mean_heard = mean(frames.iter().map(heard)).unwrap_or(0.0);
        let percent = match mean_heard > 0.0 {
            true => 100.0 / mean_heard,
            false => 0.0,
        };
        let ear = |of: fn(&Panning) -> f64| -> Option<f64> {
            let level = |frame: &Frame| {
                let heard = of(&frame.panning) / f64::from(waves);
                (heard > 0.0).then(|| 10.0 * heard.log10())
            };
            let levels: Option<Vec<f64>> = frames.iter().map(level).collect();
            levels.map(|levels| of_two(levels.into_iter()))
        };
        let levels = ear(|p| p.left).zip(ear(|p| p.right));
        Noise {
            seeds: frames.len() as u32,
            heard: mean_heard,
            heard_percent: percent * of_two(frames.iter().map(heard)),
            pan: of_two(frames.iter().map(|f| f.panning.pan())),
            level_db: levels.map(|(left, right)| left.max(right)),
        }
    }
}

fn heard(frame: &Frame) -> f64 {
    frame.counts.listener_hits as f64
}

/// The change of the level in dB, at the ear with the larger change.
fn level(before: &Panning, after: &Panning, gain: f64) -> Option<f64> {
    let of = |before: f64, after: f64| match (before > 0.0, after > 0.0) {
        (true, true) => Some(10.0 * (gain * after / before).log10()),
        (false, false) => Some(0.0),
        _ => None,
    };
    let left = of(before.left, after.left)?;
    let right = of(before.right, after.right)?;
    Some(if left.abs() > right.abs() {
        left
    } else {
        right
    })
}

/// The root mean square difference between two independent values of this distribution, which is √2 standard
/// deviations.
fn of_two(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    if count < 2.0 {
        return 0.0;
    }
    let middle = mean(values.clone()).unwrap_or(0.0);
    let squares: f64 = values.map(|v| (v - middle) * (v - middle)).sum();
    (2.0 * squares / (count - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(left: f64, right: f64) -> Frame {
        let mut frame = Frame::default();
        (frame.panning.left, frame.panning.right) = (left, right);
        frame.counts.listener_hits = (left + right) as u64;
        frame
    }

    /// Protects the measures: their signs and units. Also checks that half the number of waves does not halve the
    /// sound.
    #[test]
    fn changes_are_taken_by_the_share_of_waves() {
        let base = [frame(50.0, 50.0)];
        let same = Change::of((&base, 1000), (&[frame(25.0, 25.0)], 500)).unwrap();
        assert_eq!(same.heard_percent.rms, 0.0);
        assert_eq!(same.level_db.unwrap().rms, 0.0);
        let less = Change::of((&base, 1000), (&[frame(5.0, 45.0)], 1000)).unwrap();
        assert_eq!(less.heard_percent.mean, -50.0);
        assert!((less.pan.mean - 0.8).abs() < 1e-12);
        assert!((less.level_db.unwrap().mean + 10.0).abs() < 1e-12);
    }

    /// Protects the limiting cases: a change to silence at one ear exceeds any noise, and a silent scene has no change.
    #[test]
    fn silence_is_no_number() {
        let (base, silent) = ([frame(5.0, 5.0)], [frame(0.0, 0.0)]);
        let noise = Noise::of(&[frame(4.0, 6.0), frame(6.0, 4.0)], 100);
        let gone = Change::of((&base, 100), (&silent, 100)).unwrap();
        assert_eq!(gone.level_db, None);
        assert!(!gone.is_within(&noise));
        assert_eq!(Change::of((&silent, 100), (&base, 100)), None);
        assert!((noise.pan - 0.4).abs() < 1e-12, "{}", noise.pan);
    }
}
