//! The events of a wave in a chunk, and what they leave of its energy.

use crate::bands::{BAND_COUNT, Bands};
use crate::kernel::{Materials, WORD_BITS};

/// Words of events that a wave has at the most: one in its tally, four in a texture.
const WORDS: usize = 5;

/// What each event does.
#[derive(Clone, Debug)]
pub struct EventTable {
    bits: u32,
    /// What is left of the energy, by the event's number.
    left: Vec<Bands>,
    materials: Materials,
}

/// The events of one wave in a chunk, of which those before an iteration are over.
#[derive(Debug)]
pub struct Events<'a> {
    table: &'a EventTable,
    words: [u32; WORDS],
    /// The word under way, without the events that are over.
    word: u32,
    next_word: usize,
    in_word: u32,
    iteration: u32,
}

impl EventTable {
    /// That of a scene's materials; none where there are none.
    pub fn of(materials: Materials) -> Option<EventTable> {
        (!materials.is_empty()).then(|| EventTable {
            bits: materials.bits(),
            left: materials.left(),
            materials,
        })
    }

    /// The materials.
    pub fn materials(&self) -> &Materials {
        &self.materials
    }

    /// The events of a wave, from its first word and the others.
    pub fn events(&self, first: f32, others: Option<&[f32]>) -> Events<'_> {
        let mut words = [0; WORDS];
        words[0] = word(first);
        for (word_of, float) in words[1..].iter_mut().zip(others.unwrap_or_default()) {
            *word_of = word(*float);
        }
        Events {
            table: self,
            words,
            word: 0,
            next_word: 0,
            in_word: 0,
            iteration: 0,
        }
    }
}

impl Events<'_> {
    /// Takes a wave through its events before an iteration.
    pub fn suffer(&mut self, until: u32, energy: &mut Bands, is_mirrored: &mut bool) {
        let bits = self.table.bits;
        while self.iteration < until {
            if self.in_word == 0 {
                // Beyond the last word nothing happens.
                self.word = self.words.get(self.next_word).copied().unwrap_or_default();
                self.next_word += 1;
                self.in_word = WORD_BITS / bits;
            }
            let event = (self.word & ((1 << bits) - 1)) as usize;
            self.word >>= bits;
            self.in_word -= 1;
            self.iteration += 1;
            if event == 0 {
                continue;
            }
            // What no table holds no shader writes.
            let left = self.table.left.get(event).unwrap_or(&[0.0; BAND_COUNT]);
            energy.iter_mut().zip(left).for_each(|(e, left)| *e *= left);
            *is_mirrored &= !self.table.materials.is_scattered(event);
        }
    }
}

/// The 30 bits of a word in a float (`inFloat` in `glsl/arrivals/chunk.frag`).
fn word(float: f32) -> u32 {
    let bits = float.to_bits();
    (bits & 0x1FFF_FFFF) | ((bits >> 2) & 0x2000_0000)
}
