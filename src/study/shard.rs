//! Shards: which points are whose, and where their files lie.

use super::lines::{Header, text_of};
use super::{BLOCK, Study, StudyError};
use std::fmt;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Shards that a study is cut into at the most: more files than that burden a cluster's disks.
pub const MOST_SHARDS: u32 = 10_000;

/// The folder of the shards, within that of the study's results.
const FOLDER: &str = "shards";

/// How the file of a whole shard ends, and that of one that is worked on.
const WHOLE: &str = "shard";
const WORK: &str = "work";

/// Bytes of a first line at the most.
const LONGEST_HEADER: u64 = 1 << 16;

/// A part of a study: one of so many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    number: u32,
    of: u32,
}

impl Shard {
    /// All of the study.
    pub const WHOLE: Shard = Shard { number: 1, of: 1 };

    /// The shard of a number, from 1, of so many.
    ///
    /// # Errors
    /// [`StudyError::NoShard`] unless 1 ≤ `number` ≤ `of` ≤ [`MOST_SHARDS`].
    pub fn new(number: u32, of: u32) -> Result<Shard, StudyError> {
        if (1..=of).contains(&number) && of <= MOST_SHARDS {
            return Ok(Shard { number, of });
        }
        Err(StudyError::NoShard {
            said: format!("{number}/{of}"),
            most: MOST_SHARDS,
        })
    }

    /// Its number, from 1.
    pub fn number(self) -> u32 {
        self.number
    }

    /// How many shards there are.
    pub fn of(self) -> u32 {
        self.of
    }

    /// All shards of so many, in order.
    pub fn all(of: u32) -> impl Iterator<Item = Shard> {
        (1..=of).map(move |number| Shard { number, of })
    }

    /// How many of a study's points are in this shard.
    pub fn points(self, all: u64) -> u64 {
        let (number, of) = (u64::from(self.number), u64::from(self.of));
        let (whole, rest) = (all / BLOCK, all % BLOCK);
        let blocks = whole / of + u64::from(whole % of >= number);
        let has_rest = whole % of == number - 1;
        blocks * BLOCK + if has_rest { rest } else { 0 }
    }

    /// The number in the study of a point of this shard.
    pub(super) fn point(self, place: u64) -> u64 {
        let block = place / BLOCK * u64::from(self.of) + u64::from(self.number - 1);
        block * BLOCK + place % BLOCK
    }

    /// The file of the whole shard.
    pub fn file(self, folder: &Path) -> PathBuf {
        self.named(folder, WHOLE)
    }

    /// The file of the shard while it is worked on.
    pub(super) fn work_file(self, folder: &Path) -> PathBuf {
        self.named(folder, WORK)
    }

    fn named(self, folder: &Path, ending: &str) -> PathBuf {
        let name = format!("{:05}-of-{:05}.{ending}", self.number, self.of);
        folder_of(folder).join(name)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        write!(to, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = StudyError;

    fn from_str(said: &str) -> Result<Shard, StudyError> {
        let numbers = said.split_once('/').and_then(|(number, of)| {
            let number = number.trim().parse().ok()?;
            Some((number, of.trim().parse().ok()?))
        });
        let refused = || StudyError::NoShard {
            said: said.to_owned(),
            most: MOST_SHARDS,
        };
        let (number, of) = numbers.ok_or_else(refused)?;
        Shard::new(number, of).map_err(|_| refused())
    }
}

/// Where the shards of a study lie.
pub(super) fn folder_of(folder: &Path) -> PathBuf {
    folder.join(FOLDER)
}

/// Whether a file is called as a whole shard is, whatever its number.
pub(super) fn is_whole(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == WHOLE)
}

/// The number of shards that the files of a study in a folder were begun with; none without such
/// files, or where they do not agree.
#[cfg(feature = "cli")]
pub(crate) fn begun(study: &Study, folder: &Path) -> Option<u32> {
    let files = std::fs::read_dir(folder_of(folder)).ok()?;
    let mut found = None;
    for file in files.flatten() {
        let path = file.path();
        let is_shard = is_whole(&path) || path.extension().is_some_and(|ending| ending == WORK);
        let Some(header) = is_shard.then(|| header_of(&path)).flatten() else {
            continue;
        };
        if header.study != study.hash {
            continue;
        }
        match found {
            Some(of) if of != header.of => return None,
            _ => found = Some(header.of),
        }
    }
    found
}

/// What the first line of a file says, if it is that of a shard.
#[cfg(feature = "cli")]
fn header_of(path: &Path) -> Option<Header> {
    let about = std::fs::metadata(path).ok()?;
    if !about.is_file() {
        return None;
    }
    let mut line = Vec::new();
    let mut file = BufReader::new(File::open(path).ok()?.take(LONGEST_HEADER));
    file.read_until(b'\n', &mut line).ok()?;
    Header::parse(text_of(line.strip_suffix(b"\n")?)?)
}

/// Counts the rows of a shard that another process computes, from where it left off: `seen` holds the
/// bytes that were looked at, and the lines in them.
#[cfg(feature = "cli")]
pub(crate) fn rows_in(shard: Shard, folder: &Path, points: u64, seen: &mut (u64, u64)) -> u64 {
    let Ok(mut file) = File::open(shard.work_file(folder)) else {
        let is_whole = shard.file(folder).exists();
        return if is_whole { points } else { 0 };
    };
    let mut bytes = Vec::new();
    let read = file
        .seek(SeekFrom::Start(seen.0))
        .and_then(|_| file.read_to_end(&mut bytes));
    if read.is_ok() {
        seen.0 += bytes.len() as u64;
        seen.1 += bytes.iter().filter(|byte| **byte == b'\n').count() as u64;
    }
    // The first line is the header.
    seen.1.saturating_sub(1).min(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects every point from being computed twice or not at all, and the names of shards.
    #[test]
    fn points_are_dealt_out_once() {
        for all in [0, 1, 15, 16, 17, 100, 2000] {
            for of in [1, 2, 3, 7, 16, 200] {
                let mut dealt: Vec<u64> = Shard::all(of)
                    .flat_map(|shard| (0..shard.points(all)).map(move |place| shard.point(place)))
                    .collect();
                dealt.sort_unstable();
                assert!(dealt.into_iter().eq(0..all), "{all} points, {of} shards");
            }
        }
        assert_eq!("3/16".parse::<Shard>().unwrap(), Shard::new(3, 16).unwrap());
        for said in ["", "3", "0/4", "5/4", "1/10001", "1/x", "-1/4"] {
            let refused = said.parse::<Shard>().unwrap_err().to_string();
            assert!(refused.contains("K/N"), "{refused}");
        }
    }
}
