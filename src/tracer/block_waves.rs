//! The waves of a block: those from the source, or those that continue passages through solids.

use super::arrivals::{Passage, Start};
use crate::bands::Bands;
use std::ops::Range;

/// The waves of a block.
pub(super) enum Waves<'a> {
    /// Waves with these numbers, their starts, unless the settings determine them, and their initial energies.
    FromSource(Range<u32>, Option<&'a [Start]>, Vec<Bands>),
    /// Waves that continue passages of a generation, from 1, and the number of the first of them.
    Passages(&'a [Passage], u32, u32),
}

impl Waves<'_> {
    pub fn count(&self) -> u32 {
        match self {
            Waves::FromSource(numbers, ..) => numbers.len() as u32,
            Waves::Passages(passages, ..) => passages.len() as u32,
        }
    }

    /// Number of the first wave.
    pub fn first(&self) -> u32 {
        match self {
            Waves::FromSource(numbers, ..) => numbers.start,
            Waves::Passages(.., first) => *first,
        }
    }

    /// Whether textures contain the starts.
    pub fn are_uploaded(&self) -> bool {
        matches!(self, Waves::FromSource(_, Some(_), _) | Waves::Passages(..))
    }

    /// Numbers of the waves from the source, and the starts of all waves that the settings do not determine.
    pub fn starts(&self) -> (Range<u32>, Option<Vec<Start>>) {
        match self {
            Waves::FromSource(numbers, starts, _) => {
                (numbers.clone(), starts.map(<[Start]>::to_vec))
            }
            Waves::Passages(passages, ..) => {
                let start = |passage: &Passage| Start {
                    direction: passage.direction,
                    weight: 1.0,
                };
                (0..0, Some(passages.iter().map(start).collect()))
            }
        }
    }

    /// The generation; 0 for waves from the source.
    pub fn generation(&self) -> u32 {
        match self {
            Waves::FromSource(..) => 0,
            Waves::Passages(_, generation, _) => *generation,
        }
    }
}
