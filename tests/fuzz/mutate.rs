//! Corrupts valid files. The corruption depends only on the seed and the number of the input.

use super::random::Random;

/// Maximum length of a corrupted file in bytes.
const LONGEST: usize = 1 << 16;

/// Numbers that are difficult for file formats and shapes.
const NUMBERS: [&str; 22] = [
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "1e-45",
    "1e-30",
    "1e-7",
    "0.5",
    "0.999999",
    "1e6",
    "1e9",
    "1.1e9",
    "1e30",
    "3.4e38",
    "1e39",
    "1e400",
    "NaN",
    "inf",
    "-inf",
    "16777216",
    "18446744073709551616",
];

/// Draws numbers and corrupts files with them.
pub struct Mutator {
    random: Random,
}

impl Mutator {
    /// Creates the generator for the input with this seed and index.
    pub fn new(seed: u64, index: u64) -> Mutator {
        let mut random = Random(seed.wrapping_mul(0xd134_2543_de82_ef95) ^ index);
        random.bits();
        Mutator { random }
    }

    /// Draws an integer from 0 to `end` − 1; 0 if `end` is 0.
    fn below(&mut self, end: usize) -> usize {
        (self.random.bits() % end.max(1) as u64) as usize
    }

    fn one_of<'a, T: ?Sized>(&mut self, of: &'a [&'a T]) -> Option<&'a T> {
        of.get(self.below(of.len())).copied()
    }

    /// Draws a file of the corpus, and corrupts it one to eight times.
    pub fn spoilt(&mut self, corpus: &[Vec<u8>], tokens: &[&str]) -> Vec<u8> {
        let mut data = corpus[self.below(corpus.len())].clone();
        for _ in 0..1 + self.below(8) {
            self.spoil(&mut data, corpus, tokens);
            data.truncate(LONGEST);
        }
        data
    }

    fn spoil(&mut self, data: &mut Vec<u8>, corpus: &[Vec<u8>], tokens: &[&str]) {
        match self.below(12) {
            0 => self.flip(data),
            1 => self.overwrite(data),
            2 => self.insert_noise(data),
            3 => self.cut_out(data),
            4 => self.repeat(data),
            5 => data.truncate(self.below(data.len() + 1)),
            6 => self.splice(data, corpus),
            7 => self.extreme_integer(data),
            8 | 9 => self.replace_number(data),
            _ => self.replace_word(data, tokens),
        }
    }

    fn flip(&mut self, data: &mut [u8]) {
        let (at, bit) = (self.below(data.len()), self.below(8));
        if let Some(byte) = data.get_mut(at) {
            *byte ^= 1 << bit;
        }
    }

    fn overwrite(&mut self, data: &mut [u8]) {
        let at = self.below(data.len());
        let drawn = self.random.bits() as u8;
        if let Some(byte) = data.get_mut(at) {
            *byte = drawn;
        }
    }

    fn insert_noise(&mut self, data: &mut Vec<u8>) {
        let at = self.below(data.len() + 1);
        let count = 1 + self.below(8);
        let noise: Vec<u8> = (0..count).map(|_| self.random.bits() as u8).collect();
        data.splice(at..at, noise);
    }

    /// Draws a range of at most `longest` bytes.
    fn range(&mut self, data: &[u8], longest: usize) -> std::ops::Range<usize> {
        let from = self.below(data.len());
        let length = self.below(longest.min(data.len() - from) + 1);
        from..from + length
    }

    fn cut_out(&mut self, data: &mut Vec<u8>) {
        let range = self.range(data, 64);
        data.drain(range);
    }

    fn repeat(&mut self, data: &mut Vec<u8>) {
        let range = self.range(data, 64);
        let times = 1 + self.below(32);
        let copies = data[range.clone()].repeat(times);
        data.splice(range.end..range.end, copies);
    }

    fn splice(&mut self, data: &mut Vec<u8>, corpus: &[Vec<u8>]) {
        let other = &corpus[self.below(corpus.len())];
        let (from, into) = (self.range(other, 256), self.range(data, 256));
        data.splice(into, other[from].iter().copied());
    }

    /// Overwrites some bytes with an integer at the limit of its type.
    fn extreme_integer(&mut self, data: &mut [u8]) {
        const BORDERS: [u32; 8] = [0, 1, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, 0xffff_ffff];
        let value = BORDERS[self.below(BORDERS.len())];
        let bytes = match self.below(2) {
            0 => value.to_le_bytes(),
            _ => value.to_be_bytes(),
        };
        let (at, length) = (self.below(data.len()), 1 + self.below(4));
        for (byte, new) in data[at..].iter_mut().zip(&bytes[..length]) {
            *byte = *new;
        }
    }

    fn replace_number(&mut self, data: &mut Vec<u8>) {
        let is_number = |byte: u8| byte.is_ascii_digit() || byte == b'.' || byte == b'-';
        let Some(range) = self.run(data, is_number) else {
            return;
        };
        let new = NUMBERS[self.below(NUMBERS.len())];
        data.splice(range, new.bytes());
    }

    fn replace_word(&mut self, data: &mut Vec<u8>, tokens: &[&str]) {
        let Some(new) = self.one_of(tokens) else {
            return self.flip(data);
        };
        let is_word = |byte: u8| byte.is_ascii_alphabetic() || byte == b'_';
        if let Some(range) = self.run(data, is_word) {
            data.splice(range, new.bytes());
        }
    }

    /// Returns the first run of bytes that satisfy `is_in`, after a random position.
    fn run(&mut self, data: &[u8], is_in: fn(u8) -> bool) -> Option<std::ops::Range<usize>> {
        let from = self.below(data.len());
        let start = from + data[from..].iter().position(|byte| is_in(*byte))?;
        let length = data[start..].iter().position(|byte| !is_in(*byte));
        Some(start..length.map_or(data.len(), |length| start + length))
    }
}
