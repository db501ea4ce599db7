//! Reads whole shards. First the whole file is checked, then its rows are read in order.

use super::lines::{Header, LONGEST_LINE, end_text, is_end, text_of};
use super::row_form::RowForm;
use super::{BLOCK, Shard, Study, VERSION};
use echomarch::internals::file_input::InputFile;
use sha2::{Digest, Sha256};
use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Maximum size of a shard, in bytes.
const LARGEST_FILE: u64 = 1 << 44;

/// Number of rows that are read from a shard at a time. The number is only a few blocks, so that 10,000 shards fit into
/// memory.
const ROWS_AT_A_TIME: u64 = 4 * BLOCK;

/// Checks every line of a whole shard. If the shard belongs to this study, every cell is also checked. Returns the
/// header, or the reason why the shard is rejected. `progress` receives the number of checked points.
pub(super) fn verify(
    path: &Path,
    study: &Study,
    progress: &mut dyn FnMut(u64),
) -> Result<Header, String> {
    let file = InputFile::open(path, LARGEST_FILE).map_err(|error| error.to_string())?;
    let mut lines = Lines::of(file);
    let mut hash = Sha256::new();
    let first = lines.next()?.ok_or("it is empty")?;
    let header = Header::parse(first).ok_or("it is not a shard of a study")?;
    let shard = Shard::new(header.shard, header.of).map_err(|error| error.to_string())?;
    // Rows of another study or version have another form. A shard with such rows is not joined, so its rows are not
    // checked.
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
        return Err("it was changed: its last line does not match the rest".to_owned());
    }
    match lines.next()? {
        None => Ok(header),
        Some(_) => Err("there is data after its last line".to_owned()),
    }
}

/// The lines of a shard, with verified checksums.
struct Lines<R> {
    reader: R,
    /// The line's number, from 1.
    number: u64,
    /// The bytes of the line, including its line end.
    bytes: Vec<u8>,
}

impl Lines<BufReader<InputFile>> {
    fn of(file: InputFile) -> Self {
        Lines {
            reader: BufReader::new(file),
            number: 0,
            bytes: Vec::new(),
        }
    }
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

/// The rows of a shard, in order. The file is open only during a read, because the system may allow fewer open files
/// than there are shards.
pub(super) struct Rows {
    path: PathBuf,
    /// Offset of the next line, in bytes.
    offset: u64,
    /// Rows that have been read but not yet returned.
    ready: VecDeque<String>,
}

impl Rows {
    /// Creates a reader of the rows of a verified shard.
    pub fn of(path: PathBuf) -> Rows {
        Rows {
            path,
            offset: 0,
            ready: VecDeque::new(),
        }
    }

    /// Returns the next row, which must belong to this point.
    ///
    /// # Errors
    /// An error occurs if the file has changed since it was verified.
    pub fn next(&mut self, form: &RowForm, point: u64) -> io::Result<String> {
        if self.ready.is_empty() {
            self.read()?;
        }
        let row = self.ready.pop_front();
        row.filter(|row| form.check(row, point).is_ok())
            .ok_or_else(|| io::Error::other("it was changed while it was read"))
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn read(&mut self) -> io::Result<()> {
        let mut file = InputFile::open(&self.path, LARGEST_FILE).map_err(io::Error::other)?;
        file.skip_to(self.offset)?;
        let mut lines = Lines::of(file);
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
