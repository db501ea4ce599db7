//! Shards: their points and the paths of their files.

use super::BLOCK;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Maximum number of shards in a study. More files would overload the file system of a cluster.
pub const MOST_SHARDS: u32 = 10_000;

/// The folder of the shards, within the results folder of the study.
const FOLDER: &str = "shards";

/// File name extensions of a whole shard and of a shard in progress.
const WHOLE: &str = "shard";
pub(super) const WORK: &str = "work";

/// A part of a study: shard `number` of `of`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    number: u32,
    of: u32,
}

/// A text, or two numbers, that do not identify a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a shard must be K/N with K from 1 to N and N at most {most}, not {said:?}")]
#[non_exhaustive]
pub struct NoShard {
    /// The given text.
    pub said: String,
    /// The maximum number of shards of a study.
    pub most: u32,
}

impl Shard {
    /// The whole study as one shard.
    pub const WHOLE: Shard = Shard { number: 1, of: 1 };

    /// Returns the shard `number`, from 1, of `of` shards.
    ///
    /// # Errors
    /// [`NoShard`] unless 1 ≤ `number` ≤ `of` ≤ [`MOST_SHARDS`].
    pub fn new(number: u32, of: u32) -> Result<Shard, NoShard> {
        if (1..=of).contains(&number) && of <= MOST_SHARDS {
            return Ok(Shard { number, of });
        }
        Err(NoShard {
            said: format!("{number}/{of}"),
            most: MOST_SHARDS,
        })
    }

    /// The shard's number, from 1.
    pub fn number(self) -> u32 {
        self.number
    }

    /// The number of shards of the study.
    pub fn of(self) -> u32 {
        self.of
    }

    /// All `of` shards of a study, in order.
    pub fn all(of: u32) -> impl Iterator<Item = Shard> {
        (1..=of).map(move |number| Shard { number, of })
    }

    /// The number of points in this shard, if the study has `all` points.
    pub fn points(self, all: u64) -> u64 {
        let (number, of) = (u64::from(self.number), u64::from(self.of));
        let (whole, rest) = (all / BLOCK, all % BLOCK);
        let blocks = whole / of + u64::from(whole % of >= number);
        let has_rest = whole % of == number - 1;
        blocks * BLOCK + if has_rest { rest } else { 0 }
    }

    /// Converts the index of a point in this shard to its index in the study.
    pub(super) fn point(self, place: u64) -> u64 {
        let block = place / BLOCK * u64::from(self.of) + u64::from(self.number - 1);
        block * BLOCK + place % BLOCK
    }

    /// The path of the whole shard.
    pub fn file(self, folder: &Path) -> PathBuf {
        self.named(folder, WHOLE)
    }

    /// The path of the shard while it is being computed.
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
    type Err = NoShard;

    fn from_str(said: &str) -> Result<Shard, NoShard> {
        let numbers = said.split_once('/').and_then(|(number, of)| {
            let number = number.trim().parse().ok()?;
            Some((number, of.trim().parse().ok()?))
        });
        let refused = || NoShard {
            said: said.to_owned(),
            most: MOST_SHARDS,
        };
        let (number, of) = numbers.ok_or_else(refused)?;
        Shard::new(number, of).map_err(|_| refused())
    }
}

/// The folder of a study's shards.
pub(super) fn folder_of(folder: &Path) -> PathBuf {
    folder.join(FOLDER)
}

/// Whether a file has the name of a whole shard, with any number.
pub(super) fn is_whole(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == WHOLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the assignment of points: every point is in exactly one shard. Also checks the file names of shards.
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
