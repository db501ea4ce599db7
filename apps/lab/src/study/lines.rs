//! The lines of a shard file, each with a checksum, and the contents of its first and last lines.
//!
//! A line is a text without tabs, then a tab, then the first 8 hexadecimal digits of the text's SHA-256. A truncated or
//! changed line can therefore be detected without the other lines. The last line of a whole shard is `end` with the
//! SHA-256 of all preceding bytes.

use super::hash::hex;
use super::{Shard, Study, VERSION};
use crate::text::in_a_line;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Number of bytes in a line's checksum. The checksum misses 1 in 4·10⁹ damaged lines, but the hash in the last line
/// also detects these.
const CHECKED_BYTES: usize = 4;

/// The beginning of the first line of a shard.
const FORMAT: &str = "echomarch shard 1";

/// Maximum length of a renderer's name and version, in characters, and maximum length of a first line, in bytes. The
/// names of drivers have a few dozen characters, and appear in messages and tables.
const LONGEST_RENDERER: usize = 500;
const LONGEST_HEADER: usize = 4096;

/// The beginning of the last line of a whole shard.
const END: &str = "end ";

/// Maximum length of a line, in bytes. The limit is enough for a 60 s echogram with bins of 1 ms in all bands.
pub(super) const LONGEST_LINE: usize = 16 << 20;

/// The content of the first line of a shard, as JSON.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    format: String,
    /// The study's hash.
    pub study: String,
    /// The program's version.
    pub version: String,
    pub renderer: String,
    pub shard: u32,
    pub of: u32,
    /// Number of points in this shard.
    pub points: u64,
}

impl Header {
    /// Creates the header of a shard that is computed on the given renderer.
    pub fn new(study: &Study, shard: Shard, renderer: &str) -> Header {
        let renderer = in_a_line(renderer);
        Header {
            format: FORMAT.to_owned(),
            study: study.hash.clone(),
            version: VERSION.to_owned(),
            renderer: renderer.chars().take(LONGEST_RENDERER).collect(),
            shard: shard.number(),
            of: shard.of(),
            points: shard.points(study.points),
        }
    }

    /// Parses the text of a first line. Returns `None` unless it has exactly the form that the program writes.
    pub fn parse(text: &str) -> Option<Header> {
        if text.len() > LONGEST_HEADER {
            return None;
        }
        let header: Header = serde_json::from_str(text).ok()?;
        let is_ours = header.format == FORMAT
            && Shard::new(header.shard, header.of).is_ok()
            && header.renderer.chars().count() <= LONGEST_RENDERER
            && header.strings().all(|text| in_a_line(text) == text)
            && header.text() == text;
        is_ours.then_some(header)
    }

    fn strings(&self) -> impl Iterator<Item = &str> {
        [&self.study, &self.version, &self.renderer]
            .into_iter()
            .map(String::as_str)
    }

    /// The text of the first line.
    pub fn text(&self) -> String {
        // Text and numbers can always be serialised.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Describes the first difference between `self` and `expected`; `None` if there is none.
    pub fn differs(&self, expected: &Header) -> Option<String> {
        let differs = |what: &str, found: &str, wanted: &str| {
            (found != wanted).then(|| format!("it is of {what} {found:?}, not {wanted:?}"))
        };
        let number = |header: &Header| format!("{}/{}", header.shard, header.of);
        let another = differs("study", &self.study, &expected.study);
        another
            .map(|why| {
                format!(
                    "{why}: the text or the name of the study has changed, so use another folder"
                )
            })
            .or_else(|| differs("version", &self.version, &expected.version))
            .or_else(|| differs("renderer", &self.renderer, &expected.renderer))
            .or_else(|| differs("shard", &number(self), &number(expected)))
            .or_else(|| (self.points != expected.points).then(|| "it has other points".to_owned()))
    }
}

/// The line that stores `text` with its checksum. `text` must not contain tabs or line ends.
pub(super) fn line(text: &str) -> String {
    format!("{text}\t{}\n", checksum(text))
}

/// The text of a line without its line end; `None` if the checksum is wrong.
pub(super) fn text_of(line: &[u8]) -> Option<&str> {
    let line = std::str::from_utf8(line).ok()?;
    let (text, found) = line.rsplit_once('\t')?;
    (found == checksum(text)).then_some(text)
}

fn checksum(text: &str) -> String {
    hex(&Sha256::digest(text.as_bytes())[..CHECKED_BYTES])
}

/// The text of the last line. `before` is the hash of all preceding bytes.
pub(super) fn end_text(before: Sha256) -> String {
    format!("{END}{}", hex(&before.finalize()))
}

/// Whether a text is the text of a last line.
pub(super) fn is_end(text: &str) -> bool {
    text.starts_with(END)
}
