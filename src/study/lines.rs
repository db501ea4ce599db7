//! The lines of a shard's file, each with a checksum, and the content of its first and its last.
//!
//! A line is a text without tabs, a tab, and the first 8 hexadecimal digits of the text's SHA-256:
//! a line that was cut off, or changed, is known by itself. The last line of a whole shard is `end`
//! and the SHA-256 of all bytes before it.

use super::hash::hex;
use super::{Shard, Study, VERSION};
use crate::text::in_a_line;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Bytes of a line's checksum: one damage of 4·10⁹ passes for none, and none passes the last line.
const CHECKED_BYTES: usize = 4;

/// What the first line of a shard begins with.
const FORMAT: &str = "echomarch shard 1";

/// Characters of a renderer's name and version at most, and bytes of a first line that holds it: a driver's
/// names are some dozens long, and stand in messages and tables.
const LONGEST_RENDERER: usize = 500;
const LONGEST_HEADER: usize = 4096;

/// What the last line of a whole shard begins with.
const END: &str = "end ";

/// Bytes of a line at most: an echogram of 60 s in bins of 1 ms, in all bands.
pub(super) const LONGEST_LINE: usize = 16 << 20;

/// The content of a shard's first line, as JSON.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    format: String,
    /// The study's hash.
    pub study: String,
    /// The program's.
    pub version: String,
    pub renderer: String,
    pub shard: u32,
    pub of: u32,
    /// Points of this shard.
    pub points: u64,
}

impl Header {
    /// The header of a shard of a study on a renderer.
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

    /// The header of a line's text, if it is spelled as the program spells it.
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

    /// The text of its line.
    pub fn text(&self) -> String {
        // A type of plain text and numbers always has a form.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// What in `self` is not as in `expected`, where anything is.
    pub fn differs(&self, expected: &Header) -> Option<String> {
        let differs = |what: &str, found: &str, wanted: &str| {
            (found != wanted).then(|| format!("it is of {what} {found:?}, not {wanted:?}"))
        };
        let number = |header: &Header| format!("{}/{}", header.shard, header.of);
        let another = differs("study", &self.study, &expected.study);
        another
            .map(|why| {
                format!("{why}: the study has another text or name now, so use another folder")
            })
            .or_else(|| differs("version", &self.version, &expected.version))
            .or_else(|| differs("renderer", &self.renderer, &expected.renderer))
            .or_else(|| differs("shard", &number(self), &number(expected)))
            .or_else(|| (self.points != expected.points).then(|| "it has other points".to_owned()))
    }
}

/// A line of a text without tabs and ends of lines.
pub(super) fn line(text: &str) -> String {
    format!("{text}\t{}\n", checksum(text))
}

/// The text of a line without its end, if its checksum is right.
pub(super) fn text_of(line: &[u8]) -> Option<&str> {
    let line = std::str::from_utf8(line).ok()?;
    let (text, found) = line.rsplit_once('\t')?;
    (found == checksum(text)).then_some(text)
}

fn checksum(text: &str) -> String {
    hex(&Sha256::digest(text.as_bytes())[..CHECKED_BYTES])
}

/// The text of the last line, behind bytes of this hash.
pub(super) fn end_text(before: Sha256) -> String {
    format!("{END}{}", hex(&before.finalize()))
}

/// Whether a text is that of a last line.
pub(super) fn is_end(text: &str) -> bool {
    text.starts_with(END)
}
