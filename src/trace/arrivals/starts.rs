//! Selection of the waves followed past the listener, and their starts.

use glam::Vec3;
use std::ops::Range;

/// The waves whose arrivals are requested.
pub(crate) enum WavesToFollow<'a> {
    /// Waves of these numbers, in their directions by the settings, each with 1/N of the energy, where N is the
    /// settings' number of waves.
    Numbers(Range<u32>),
    /// Waves numbered from 0, with given starts.
    Starts {
        /// Number of waves.
        waves: u32,
        /// Returns the starts of a range of numbers. The number of waves in the settings is ignored.
        of: &'a dyn Fn(Range<u32>) -> Vec<Start>,
    },
}

/// The start of a wave at the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    /// Direction: a unit vector in world axes.
    pub direction: Vec3,
    /// Importance weight: the density of even directions divided by the density with which this one was drawn; 1 on
    /// average, or multiplied by a factor common to all.
    pub weight: f32,
}

impl WavesToFollow<'_> {
    /// The numbers of the waves, in ranges of `waves` each.
    pub(in crate::trace) fn blocks(&self, waves: u32) -> impl Iterator<Item = Range<u32>> {
        let Range { start, end } = match self {
            WavesToFollow::Numbers(numbers) => numbers.clone(),
            WavesToFollow::Starts { waves, .. } => 0..*waves,
        };
        let first = (start..end).step_by(waves as usize);
        first.map(move |first| first..first.saturating_add(waves).min(end))
    }

    /// The starts of these waves, if they are given.
    pub(in crate::trace) fn starts(&self, numbers: &Range<u32>) -> Option<Vec<Start>> {
        match self {
            WavesToFollow::Numbers(_) => None,
            WavesToFollow::Starts { of, .. } => Some(of(numbers.clone())),
        }
    }
}
