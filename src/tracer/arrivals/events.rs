//! The events of a wave in a chunk, and the energy that remains after them.

use crate::bands::{BAND_COUNT, Bands};
use crate::shader::{Materials, WORD_BITS};

/// Maximum words of events of a wave: one in its tally, four in a texture.
const WORDS: usize = 5;

/// Bits of the events that are looked up at once. With this number the table takes 64 KiB, and an entry covers, for
/// example, five events of two bits each.
const GROUP_BITS: u32 = 10;

/// The share of the energy that remains after events, looked up for several events at once.
#[derive(Clone, Debug)]
pub struct EventTable {
    bits: u32,
    /// Events looked up at once.
    in_group: u32,
    /// The share of the energy after a group of events, by their bits.
    left: Vec<Bands>,
    /// Whether an event of the group scatters the wave.
    is_scattered: Vec<bool>,
    materials: Materials,
}

/// The events of one wave in a chunk. Some of them may already be applied.
#[derive(Debug)]
pub struct Events<'a> {
    table: &'a EventTable,
    words: [u32; WORDS],
    /// The current word, without the events already applied.
    word: u32,
    next_word: usize,
    in_word: u32,
    iteration: u32,
}

impl EventTable {
    /// The table of a scene's materials; `None` without materials.
    pub fn of(materials: Materials) -> Option<EventTable> {
        if materials.is_empty() {
            return None;
        }
        let bits = materials.bits();
        let in_group = (GROUP_BITS / bits).max(1);
        let mut left = vec![[1.0; BAND_COUNT]];
        let mut is_scattered = vec![false];
        let of_one = materials.left();
        for _ in 0..in_group {
            // Earlier events are in the lower bits.
            let (before, scattered) = (left.clone(), is_scattered.clone());
            left.clear();
            is_scattered.clear();
            for event in 0..1 << bits {
                // Shaders write no event beyond the known ones.
                let one = of_one.get(event).unwrap_or(&[0.0; BAND_COUNT]);
                left.extend(before.iter().map(|before| product(before, one)));
                let here = materials.is_scattered(event);
                is_scattered.extend(scattered.iter().map(|before| *before || here));
            }
        }
        Some(EventTable {
            bits,
            in_group,
            left,
            is_scattered,
            materials,
        })
    }

    /// The materials.
    pub fn materials(&self) -> &Materials {
        &self.materials
    }

    /// The events of a wave, from its first word and the remaining words.
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
    /// Applies the events before iteration `until` to a wave.
    pub fn suffer(&mut self, until: u32, energy: &mut Bands, is_mirrored: &mut bool) {
        let EventTable { bits, in_group, .. } = *self.table;
        while self.iteration < until {
            if self.in_word == 0 {
                // Words beyond the last one count as zeros.
                self.word = self.words.get(self.next_word).copied().unwrap_or_default();
                self.next_word += 1;
                self.in_word = WORD_BITS / bits;
            }
            let events = in_group.min(self.in_word).min(until - self.iteration);
            let group = (self.word & ((1 << (bits * events)) - 1)) as usize;
            self.word >>= bits * events;
            self.in_word -= events;
            self.iteration += events;
            if group != 0 {
                *energy = product(energy, &self.table.left[group]);
                *is_mirrored &= !self.table.is_scattered[group];
            }
        }
    }
}

fn product(a: &Bands, b: &Bands) -> Bands {
    std::array::from_fn(|band| a[band] * b[band])
}

/// The 30 bits of a word, from a float (`inFloat` in `glsl/arrivals/chunk.frag`).
fn word(float: f32) -> u32 {
    let bits = float.to_bits();
    (bits & 0x1FFF_FFFF) | ((bits >> 2) & 0x2000_0000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::scene::Material;

    fn materials(count: u32) -> Materials {
        let mut scene = Scene::builtin("shoebox").unwrap();
        let room = scene.surfaces[0].clone();
        scene.surfaces.clear();
        for number in 0..count {
            let share = f64::from(number + 1) / 64.0;
            let scattering = if number % 2 == 0 { 0.5 } else { 0.0 };
            let material = Material::absorbing(share).scattering_by(scattering);
            scene.materials.insert(format!("m{number}"), material);
            scene
                .surfaces
                .push(room.clone().with_material(format!("m{number}")));
        }
        Materials::of(&scene, 0..BAND_COUNT)
    }

    /// Protects events from being lost between groups and words: events that are looked up in groups of any size leave
    /// the same energy as events that are applied one by one.
    #[test]
    fn groups_leave_what_single_events_leave() {
        for count in [1, 2, 5, 9, 20, 40] {
            let materials = materials(count);
            let (bits, of_one) = (materials.bits(), materials.left());
            let table = EventTable::of(materials.clone()).unwrap();
            let in_word = (WORD_BITS / bits) as usize;
            let events: Vec<usize> = (0..WORDS * in_word)
                .map(|place| (7 * place + place / 3) % of_one.len())
                .collect();
            let mut floats = [0.0; WORDS];
            for (float, events) in floats.iter_mut().zip(events.chunks(in_word)) {
                let pack = |word, event: &usize| word << bits | *event as u32;
                let word = events.iter().rev().fold(0, pack);
                let sign = (word & 0x2000_0000) << 2;
                *float = f32::from_bits(0x2000_0000 | word & 0x1FFF_FFFF | sign);
            }
            for step in [1, 4, 64] {
                let mut found = table.events(floats[0], Some(&floats[1..]));
                let (mut energy, mut expected) = ([1.0; BAND_COUNT], [1.0; BAND_COUNT]);
                let (mut is_mirrored, mut should) = (true, true);
                let mut done = 0;
                while done < events.len() {
                    let until = (done + step).min(events.len());
                    found.suffer(until as u32, &mut energy, &mut is_mirrored);
                    for event in &events[done..until] {
                        expected = product(&expected, &of_one[*event]);
                        should &= !materials.is_scattered(*event);
                    }
                    assert_eq!(is_mirrored, should);
                    for (a, b) in energy.iter().zip(expected) {
                        assert!((a - b).abs() <= 1e-12 * b, "{count}, {step}: {a} {b}");
                    }
                    done = until;
                }
            }
        }
    }
}
