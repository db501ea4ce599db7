//! Computing a shard: the working file, which is gone on with after any interruption.
//!
//! What is kept is one point: its line is written at once, and the disk is waited for once a second.
//! A process that is killed loses the point that it computes; a machine that fails, a second of
//! them. The first line identifies the shard. A last line without its end was being written; it is
//! dropped. Whatever else is wrong is rejected. When all points are there the last line is added, and
//! the file, which lies beside its place, is renamed.

use super::lines::{Header, LONGEST_LINE, end_text, index_of, is_end, line, text_of};
use super::read_shard::verify;
use super::shard::folder_of;
use super::{Shard, StudyError, Worker};
use crate::file_output::prepare_folder;
use crate::report::Cell;
use sha2::{Digest, Sha256};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time between two waits for the disk.
const BETWEEN_SYNCS: Duration = Duration::from_secs(1);

/// Computes what is missing of a shard, into the folder of the study's results. A shard that is there
/// already is checked, and nothing is computed. `progress` receives how many of the shard's points are
/// done, first of all how many were before.
///
/// # Errors
/// [`StudyError::Point`] for what cannot be computed; [`StudyError::BadShard`] for a file of another
/// study, version or renderer, or one that is damaged; [`StudyError::Busy`];
/// [`StudyError::Output`].
pub fn compute(
    worker: &mut Worker,
    shard: Shard,
    folder: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<(), StudyError> {
    prepare_folder(&folder_of(folder))?;
    let header = Header::new(worker.study, shard, worker.renderer());
    let whole = shard.file(folder);
    if !whole.exists() {
        let work = WorkFile::open(shard, folder, &header)?;
        // Whoever had the lock before may have finished.
        if !whole.exists() {
            return fill(worker, shard, work, &whole, progress);
        }
    }
    check_whole(&whole, &header)?;
    progress(header.points);
    Ok(())
}

fn fill(
    worker: &mut Worker,
    shard: Shard,
    mut work: WorkFile,
    whole: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<(), StudyError> {
    progress(work.rows);
    for place in work.rows..shard.points(worker.study.points) {
        let point = worker.study.point(shard.point(place));
        let found = worker.found(&point)?;
        work.append(&row(point.index, &found))?;
        progress(place + 1);
    }
    work.finish(whole)
}

/// The text of a point's line: its number, and what was found, as in CSV.
pub(super) fn row(index: u64, found: &[Cell]) -> String {
    let mut text = index.to_string();
    for cell in found {
        text.push(',');
        text += &cell.for_csv();
    }
    text
}

/// A shard that is there must be this one.
fn check_whole(path: &Path, expected: &Header) -> Result<(), StudyError> {
    let refused = |why: String| StudyError::BadShard {
        path: path.to_owned(),
        why: format!("{why}; remove it to compute it anew"),
    };
    let found = verify(path, &mut |_| ()).map_err(refused)?;
    found
        .differs(expected)
        .map_or(Ok(()), |why| Err(refused(why)))
}

/// The file of a shard that is worked on, at its end.
struct WorkFile {
    file: File,
    path: PathBuf,
    /// Of all bytes so far.
    hash: Sha256,
    rows: u64,
    synced: Instant,
}

impl WorkFile {
    /// Opens the working file of a shard, or makes it, and reads what is done.
    fn open(shard: Shard, folder: &Path, header: &Header) -> Result<WorkFile, StudyError> {
        let path = shard.work_file(folder);
        let file = locked(shard, &path)?;
        let mut work = WorkFile {
            file,
            path,
            hash: Sha256::new(),
            rows: 0,
            synced: Instant::now(),
        };
        let kept = work.read_back(shard, header)?;
        let cut = work
            .file
            .set_len(kept)
            .and_then(|()| work.file.seek(SeekFrom::Start(kept)));
        cut.map_err(|source| work.failed(source))?;
        if kept == 0 {
            work.write(&line(&header.text()))?;
        }
        Ok(work)
    }

    /// Reads all whole lines; returns how many bytes they are.
    fn read_back(&mut self, shard: Shard, header: &Header) -> Result<u64, StudyError> {
        let mut reader = BufReader::new(&self.file);
        let (mut kept, mut lines) = (0u64, 0u64);
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            let read = (&mut reader)
                .take(LONGEST_LINE as u64)
                .read_until(b'\n', &mut bytes);
            read.map_err(|source| StudyError::output(&self.path, source))?;
            // What was being written when the process ended has no end of a line.
            let Some(text) = bytes.strip_suffix(b"\n").map(text_of) else {
                return Ok(kept);
            };
            lines += 1;
            let refused = |why: &str| StudyError::BadShard {
                path: self.path.clone(),
                why: format!("{why}; remove it to begin the shard anew"),
            };
            let Some(text) = text else {
                return Err(refused(&format!("line {lines} is damaged")));
            };
            if lines == 1 {
                let found = Header::parse(text);
                let found = found.ok_or_else(|| refused("it is no shard of a study"))?;
                found
                    .differs(header)
                    .map_or(Ok(()), |why| Err(refused(&why)))?;
            } else if is_end(text) && self.rows == header.points {
                // It is written again, with the file's new name.
                return Ok(kept);
            } else {
                let is_next =
                    self.rows < header.points && index_of(text) == Some(shard.point(self.rows));
                if !is_next {
                    return Err(refused(&format!("line {lines} is of another point")));
                }
                self.rows += 1;
            }
            kept += bytes.len() as u64;
            self.hash.update(&bytes);
        }
    }

    fn append(&mut self, text: &str) -> Result<(), StudyError> {
        self.write(&line(text))?;
        self.rows += 1;
        if self.synced.elapsed() >= BETWEEN_SYNCS {
            let synced = self.file.sync_data();
            synced.map_err(|source| self.failed(source))?;
            self.synced = Instant::now();
        }
        Ok(())
    }

    fn write(&mut self, line: &str) -> Result<(), StudyError> {
        let written = self.file.write_all(line.as_bytes());
        written.map_err(|source| self.failed(source))?;
        self.hash.update(line.as_bytes());
        Ok(())
    }

    /// Adds the last line, and gives the file its name.
    fn finish(mut self, whole: &Path) -> Result<(), StudyError> {
        let end = line(&end_text(self.hash.clone()));
        self.write(&end)?;
        let renamed = self
            .file
            .sync_all()
            .and_then(|()| std::fs::rename(&self.path, whole));
        renamed.map_err(|source| StudyError::output(whole, source))?;
        // The name as well; where a folder cannot be opened there is nothing to wait for.
        if let Some(folder) = whole.parent().and_then(|folder| File::open(folder).ok()) {
            folder
                .sync_all()
                .map_err(|source| StudyError::output(whole, source))?;
        }
        Ok(())
    }

    fn failed(&self, source: io::Error) -> StudyError {
        StudyError::output(&self.path, source)
    }
}

/// Opens a working file, which no other process may have open. A file system without locks gives
/// no such protection.
fn locked(shard: Shard, path: &Path) -> Result<File, StudyError> {
    let about = std::fs::metadata(path);
    if about.is_ok_and(|about| !about.is_file()) {
        let text = "it is there already and no plain file";
        return Err(StudyError::output(
            path,
            io::Error::new(ErrorKind::InvalidInput, text),
        ));
    }
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    let file = options
        .open(path)
        .map_err(|source| StudyError::output(path, source))?;
    let busy = || StudyError::Busy {
        shard,
        path: path.to_owned(),
    };
    match file.try_lock() {
        Ok(()) => (),
        Err(TryLockError::WouldBlock) => return Err(busy()),
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => (),
        Err(TryLockError::Error(source)) => return Err(StudyError::output(path, source)),
    }
    // It may have been finished and renamed between the opening and the lock.
    let opened = file
        .try_clone()
        .and_then(same_file::Handle::from_file)
        .map_err(|source| StudyError::output(path, source))?;
    match same_file::Handle::from_path(path) {
        Ok(named) if named == opened => Ok(file),
        _ => Err(busy()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::read;

    /// Protects what was computed from an interruption at any byte of the file: it is gone on with, to
    /// the same bytes. Whatever else is wrong is rejected, and the file stays as it is.
    #[test]
    fn a_shard_is_gone_on_with_after_any_byte() {
        let study = read(
            "Study(scenes: [Scene(of: \"corner\")], seeds: Range(from: 1, count: 20), \
             keep: Keep(counts: false))",
        );
        let study = study.unwrap();
        let shard = Shard::new(1, 2).unwrap();
        let header = Header::new(&study, shard, "made up");
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        std::fs::create_dir(folder_of(folder)).unwrap();
        let (path, whole) = (shard.work_file(folder), shard.file(folder));
        let finish = || {
            let mut work = WorkFile::open(shard, folder, &header)?;
            for place in work.rows..header.points {
                work.append(&format!("{},{:?},,", shard.point(place), 0.25))?;
            }
            work.finish(&whole)
        };
        finish().unwrap();
        let expected = std::fs::read(&whole).unwrap();
        for cut in 0..=expected.len() {
            std::fs::write(&path, &expected[..cut]).unwrap();
            finish().unwrap();
            assert_eq!(std::fs::read(&whole).unwrap(), expected, "cut at {cut}");
        }
        let last = expected.len() - 1;
        for at in [0, 40, 100, last / 2, last - 90] {
            let mut changed = expected.clone();
            changed[at] ^= 4;
            std::fs::write(&path, &changed).unwrap();
            let refused = finish().expect_err("it was taken").to_string();
            assert!(refused.contains("damaged"), "{at}: {refused}");
            assert_eq!(std::fs::read(&path).unwrap(), changed);
        }
        let other = Header::new(&study, shard, "another");
        std::fs::write(&path, &expected).unwrap();
        let refused = WorkFile::open(shard, folder, &other).err().unwrap();
        assert!(
            refused
                .to_string()
                .contains("renderer \"made up\", not \"another\"")
        );
        // Who works on a shard keeps others away.
        let working = WorkFile::open(shard, folder, &header).unwrap();
        let refused = WorkFile::open(shard, folder, &header).err().unwrap();
        assert!(matches!(refused, StudyError::Busy { .. }), "{refused}");
        drop(working);
    }
}
