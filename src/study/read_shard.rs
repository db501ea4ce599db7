//! Reading shards that are whole: first all of it is checked, then its rows are taken in order.

use super::lines::{Header, LONGEST_LINE, end_text, is_end, text_of};
use super::row_form::RowForm;
use super::{BLOCK, Shard, Study, VERSION};
use crate::file_input::InputFile;
use sha2::{Digest, Sha256};
use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Bytes of a shard at most.
const LARGEST_FILE: u64 = 1 << 44;

/// Rows that are taken from a shard at a time: some blocks, so that 10,000 shards fit into memory.
const ROWS_AT_A_TIME: u64 = 4 * BLOCK;

/// Checks every line of a whole shard, and every cell of one that is of this study; returns the
/// content of its first line, or why it is rejected. `progress` receives the number of points.
pub(super) fn verify(
    path: &Path,
    study: &Study,
    progress: &mut dyn FnMut(u64),
) -> Result<Header, String> {
    let file = InputFile::open(path, LARGEST_FILE).map_err(|error| error.to_string())?;
    let mut lines = Lines {
        reader: BufReader::new(file),
        number: 0,
        bytes: Vec::new(),
    };
    let mut hash = Sha256::new();
    let first = lines.next()?.ok_or("it is empty")?;
    let header = Header::parse(first).ok_or("it is no shard of a study")?;
    let shard = Shard::new(header.shard, header.of).map_err(|error| error.to_string())?;
    // The rows of another study or version have a form of their own; the shard is not taken.
    let is_ours = header.study == study.hash && header.version == VERSION;
    let form = is_ours.then(|| RowForm::of(study));
    hash.update(&lines.bytes);
    for place in 0..header.points {
        let cut_off = || format!("it is cut off after {place} of {} points", header.points);
        let text = lines.next()?.ok_or_else(cut_off)?;
        if is_end(text) {
            return Err(cut_off());
        }
        if let Some(form) = &form
            && let Err(why) = form.check(text, shard.point(place))
        {
            return Err(format!("line {}: {why}", lines.number));
        }
        hash.update(&lines.bytes);
        progress(place + 1);
    }
    let end = lines.next()?.ok_or("it is cut off before its last line")?;
    if end != end_text(hash) {
        return Err("it was changed: its last line is of other bytes".to_owned());
    }
    match lines.next()? {
        None => Ok(header),
        Some(_) => Err("something stands behind its last line".to_owned()),
    }
}

/// The lines of a shard, with their checksums checked.
struct Lines<R> {
    reader: R,
    /// From 1.
    number: u64,
    /// The line, with its end.
    bytes: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    fn next(&mut self) -> Result<Option<&str>, String> {
        self.bytes.clear();
        let read = (&mut self.reader)
            .take(LONGEST_LINE as u64)
            .read_until(b'\n', &mut self.bytes);
        match read {
            Ok(0) => return Ok(None),
            Ok(_) => self.number += 1,
            Err(error) => return Err(error.to_string()),
        }
        let Some(line) = self.bytes.strip_suffix(b"\n") else {
            return Err(format!("it is cut off in line {}", self.number));
        };
        let text = text_of(line);
        let number = self.number;
        text.map(Some)
            .ok_or_else(|| format!("line {number} is damaged"))
    }
}

/// The rows of a shard in order. The file is open only while some are read, for a process may have
/// fewer files open than there are shards.
pub(super) struct Rows {
    path: PathBuf,
    /// Where the next line begins.
    offset: u64,
    /// Rows that were read and not yet taken.
    ready: VecDeque<String>,
}

impl Rows {
    /// The rows of a shard that was verified.
    pub fn of(path: PathBuf) -> Rows {
        Rows {
            path,
            offset: 0,
            ready: VecDeque::new(),
        }
    }

    /// The next row, which is of this point.
    ///
    /// # Errors
    /// When the file is not any more as it was verified.
    pub fn next(&mut self, form: &RowForm, point: u64) -> io::Result<String> {
        if self.ready.is_empty() {
            self.read()?;
        }
        let row = self.ready.pop_front();
        row.filter(|row| form.check(row, point).is_ok())
            .ok_or_else(|| io::Error::other("it was changed while it was read"))
    }

    /// The file that they are of.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn read(&mut self) -> io::Result<()> {
        let mut file = InputFile::open(&self.path, LARGEST_FILE).map_err(io::Error::other)?;
        file.skip_to(self.offset)?;
        let mut lines = Lines {
            reader: BufReader::new(file),
            number: 0,
            bytes: Vec::new(),
        };
        let is_first = self.offset == 0;
        for at in 0..ROWS_AT_A_TIME {
            let text = match lines.next().map_err(io::Error::other)? {
                None => break,
                Some(text) => text.to_owned(),
            };
            self.offset += lines.bytes.len() as u64;
            let is_header = is_first && at == 0;
            if !is_header && !is_end(&text) {
                self.ready.push_back(text);
            }
        }
        Ok(())
    }
}
