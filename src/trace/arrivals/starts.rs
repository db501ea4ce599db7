//! Which waves are followed past the listener, and how they start.

use glam::Vec3;
use std::ops::Range;

/// The waves whose arrivals are wanted.
pub(crate) enum WavesToFollow<'a> {
    /// Those of these numbers, in the directions that the settings give them, each with 1/N of the energy, N the waves
    /// of the settings.
    Numbers(Range<u32>),
    /// So many, numbered from 0, whose starts are given: those of a range of numbers.
    Starts {
        /// How many.
        waves: u32,
        /// The starts of these numbers. The waves of the settings do not count.
        of: &'a dyn Fn(Range<u32>) -> Vec<Start>,
    },
}

/// How a wave starts from the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    /// Where it goes: a unit vector, world axes.
    pub direction: Vec3,
    /// Importance weight: the density of even directions divided by the density with which this one was drawn; 1 on
    /// average, or a factor that all have in common.
    pub weight: f32,
}

impl WavesToFollow<'_> {
    /// The numbers of the waves, so many at a time.
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
