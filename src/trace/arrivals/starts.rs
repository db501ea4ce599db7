//! Which waves are followed past the listener, and how they start.

use glam::Vec3;
use std::ops::Range;

/// The waves whose arrivals are wanted.
pub(crate) enum WavesToFollow<'a> {
    /// Those of these numbers, in the directions that the settings give them.
    Numbers(Range<u32>),
    /// One for each start, numbered from 0.
    Starts(&'a [Start]),
}

/// How a wave starts from the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    /// Where it goes: a unit vector, world axes.
    pub direction: Vec3,
    /// Its energy, where the waves have 1 on average: the density of directions when they are even, against that
    /// with which this one was drawn.
    pub weight: f64,
}

impl WavesToFollow<'_> {
    fn numbers(&self) -> Range<u32> {
        match self {
            WavesToFollow::Numbers(numbers) => numbers.clone(),
            WavesToFollow::Starts(starts) => 0..starts.len() as u32,
        }
    }

    /// The numbers of the waves, so many at a time.
    pub(in crate::trace) fn blocks(&self, waves: u32) -> impl Iterator<Item = Range<u32>> {
        let Range { start, end } = self.numbers();
        let first = (start..end).step_by(waves as usize);
        first.map(move |first| first..first.saturating_add(waves).min(end))
    }

    /// The starts of these waves, if they are given.
    pub(in crate::trace) fn starts(&self, numbers: &Range<u32>) -> Option<&[Start]> {
        match self {
            WavesToFollow::Numbers(_) => None,
            WavesToFollow::Starts(starts) => {
                Some(&starts[numbers.start as usize..numbers.end as usize])
            }
        }
    }
}
