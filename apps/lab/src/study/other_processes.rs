//! Reports the progress that other processes have made on a study, from the files of the study in a folder.

use super::Study;
use super::lines::{Header, text_of};
use super::shard::{Shard, WORK, folder_of, is_whole};
use echomarch::internals::plain_file;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

/// Maximum length of a first line, in bytes.
const LONGEST_HEADER: u64 = 1 << 16;

/// Maximum number of bytes that are read from a working file at a time.
const READ_AT_A_TIME: u64 = 16 << 20;

/// The shard count with which the study was begun in a folder; `None` if the folder has no files of the study, or files
/// with different counts.
pub fn begun(study: &Study, folder: &Path) -> Option<u32> {
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

/// The header of a shard's file; `None` if the file does not begin with a header.
fn header_of(path: &Path) -> Option<Header> {
    let mut line = Vec::new();
    let file = plain_file::open(path, File::options().read(true)).ok()?;
    let mut file = BufReader::new(file.take(LONGEST_HEADER));
    file.read_until(b'\n', &mut line).ok()?;
    Header::parse(text_of(line.strip_suffix(b"\n")?)?)
}

/// Counts the rows of a shard that another process computes, continuing an earlier count. `seen` contains the number of
/// bytes read so far, and the number of lines in these bytes.
pub fn rows_in(shard: Shard, folder: &Path, points: u64, seen: &mut (u64, u64)) -> u64 {
    let work = shard.work_file(folder);
    let Ok(mut file) = plain_file::open(&work, File::options().read(true)) else {
        let is_whole = shard.file(folder).exists();
        return if is_whole { points } else { 0 };
    };
    let mut bytes = Vec::new();
    // Bytes beyond the limit are read by the next call.
    let read = file
        .seek(SeekFrom::Start(seen.0))
        .and_then(|_| file.take(READ_AT_A_TIME).read_to_end(&mut bytes));
    if read.is_ok() {
        seen.0 += bytes.len() as u64;
        seen.1 += bytes.iter().filter(|byte| **byte == b'\n').count() as u64;
    }
    // The first line is the header, which is not a row.
    seen.1.saturating_sub(1).min(points)
}
