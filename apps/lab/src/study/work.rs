//! Computes a shard in a working file, which can be continued after any interruption.
//!
//! Results are computed block by block. Each line is written at once, and the file is synchronised with the disk once per
//! second. A killed process loses the current block. If the machine fails, the points of the last second are lost.
//!
//! The first line identifies the shard. An incomplete last line is caused by an interruption, and is removed. Any other
//! defect is an error, and the file is left unchanged (`work_place.rs` decides which files are opened). When all points
//! are complete, the last line is added and the file is renamed within its folder.

use super::lines::{Header, LONGEST_LINE, end_text, is_end, line, text_of};
use super::read_shard::verify;
use super::row_form::RowForm;
use super::shard::folder_of;
use super::work_place::{is_of_this_user, is_there, locked};
use super::{BLOCK, Shard, Study, StudyError, Worker};
use crate::report::Cell;
use echomarch::internals::file_output::{prepare_folder, prepare_folder_inside};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Interval between two synchronisations of the file with the disk.
const BETWEEN_SYNCS: Duration = Duration::from_secs(1);

/// Computes the missing points of a shard in the results folder of the study. A complete shard is only checked.
/// `progress` receives the number of completed points of the shard, including those completed earlier.
///
/// # Errors
/// [`StudyError::Point`] if a point cannot be computed; [`StudyError::BadShard`] if the file is damaged, or of another
/// study, version or renderer; [`StudyError::Busy`]; [`StudyError::Output`].
pub fn compute(
    worker: &mut Worker,
    shard: Shard,
    folder: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<(), StudyError> {
    prepare_folder(folder)?;
    prepare_folder_inside(&folder_of(folder))?;
    let header = Header::new(worker.study, shard, worker.renderer());
    let whole = shard.file(folder);
    if !is_there(&whole) {
        let work = WorkFile::open(worker.study, shard, folder, &header)?;
        // The previous owner of the lock may have completed the shard in the meantime.
        if !is_there(&whole) {
            return fill(worker, shard, work, &whole, progress);
        }
    }
    check_whole(&whole, worker.study, &header)?;
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
    let points = shard.points(worker.study.points);
    for first in (0..points).step_by(BLOCK as usize) {
        if points.min(first + BLOCK) <= work.rows {
            continue;
        }
        let block = worker.study.block(shard.point(first) / BLOCK);
        // All points of a block are computed together. An interruption may have left some of them in the file.
        let found = worker.found(&block)?;
        for (place, (point, found)) in (first..).zip(block.iter().zip(&found)) {
            if place >= work.rows {
                work.append(&row(point.index, found))?;
                progress(place + 1);
            }
        }
    }
    work.finish(whole)
}

/// The text of a point's line: the index of the point and its results, as in CSV.
pub(super) fn row(index: u64, found: &[Cell]) -> String {
    let mut text = index.to_string();
    for cell in found {
        text.push(',');
        text += &cell.for_csv();
    }
    text
}

/// Checks that an existing whole shard is the expected one.
fn check_whole(path: &Path, study: &Study, expected: &Header) -> Result<(), StudyError> {
    let refused = |why: String| StudyError::BadShard {
        path: path.to_owned(),
        why: format!("{why}; remove it to compute it again"),
    };
    let found = verify(path, study, &mut |_| ()).map_err(refused)?;
    found
        .differs(expected)
        .map_or(Ok(()), |why| Err(refused(why)))
}

/// The file of a shard in progress. The write position is at the end of the file.
struct WorkFile {
    file: File,
    path: PathBuf,
    shard: Shard,
    form: RowForm,
    /// Hash of all bytes written so far.
    hash: Sha256,
    rows: u64,
    synced: Instant,
}

impl WorkFile {
    /// Opens or creates the working file of a shard, and reads the completed rows.
    fn open(
        study: &Study,
        shard: Shard,
        folder: &Path,
        header: &Header,
    ) -> Result<WorkFile, StudyError> {
        let path = shard.work_file(folder);
        let file = locked(shard, &path)?;
        let mut work = WorkFile {
            file,
            path,
            shard,
            form: RowForm::of(study),
            hash: Sha256::new(),
            rows: 0,
            synced: Instant::now(),
        };
        let kept = work.read_back(header)?;
        work.cut(kept).map_err(|source| work.failed(source))?;
        if kept == 0 {
            work.write(&line(&header.text()))?;
        }
        Ok(work)
    }

    /// Truncates the file to its first `kept` bytes, and moves to its end.
    fn cut(&mut self, kept: u64) -> io::Result<()> {
        if self.file.metadata()?.len() > kept {
            self.file.set_len(kept)?;
        }
        self.file.seek(SeekFrom::Start(kept)).map(drop)
    }

    /// Reads all complete lines, and returns their length in bytes. The file is not changed.
    fn read_back(&mut self, header: &Header) -> Result<u64, StudyError> {
        let file = self.file.try_clone();
        let mut reader = BufReader::new(file.map_err(|source| self.failed(source))?);
        let (mut kept, mut lines) = (0u64, 0u64);
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            let read = (&mut reader)
                .take(LONGEST_LINE as u64)
                .read_until(b'\n', &mut bytes);
            read.map_err(|source| self.failed(source))?;
            lines += 1;
            let Some(whole) = bytes.strip_suffix(b"\n") else {
                return match (self.is_begun(&bytes, lines, header), lines) {
                    (true, _) => Ok(kept),
                    (false, 1) => Err(self.refused("it is not a shard of a study")),
                    (false, _) => Err(self.refused(&format!("line {lines} is damaged"))),
                };
            };
            let Some(text) = text_of(whole) else {
                return Err(self.refused(&format!("line {lines} is damaged")));
            };
            if lines == 1 {
                let found = Header::parse(text);
                let found = found.ok_or_else(|| self.refused("it is not a shard of a study"))?;
                let differs = found.differs(header);
                differs.map_or(Ok(()), |why| Err(self.refused(&why)))?;
            } else if self.rows == header.points {
                return self.read_end(text, reader).map(|()| kept);
            } else {
                let point = self.shard.point(self.rows);
                let checked = self.form.check(text, point);
                checked.map_err(|why| self.refused(&format!("line {lines}: {why}")))?;
                self.rows += 1;
            }
            kept += bytes.len() as u64;
            self.hash.update(&bytes);
        }
    }

    /// Checks the last line of a complete shard that was not renamed, and checks that no data follows it. The last line
    /// is written again when the file gets its final name.
    fn read_end(&self, text: &str, mut reader: impl Read) -> Result<(), StudyError> {
        if !is_end(text) || text != end_text(self.hash.clone()) {
            return Err(self.refused("its last line does not match the rest"));
        }
        let behind = reader.read(&mut [0]);
        match behind.map_err(|source| self.failed(source))? {
            0 => Ok(()),
            _ => Err(self.refused("there is data after its last line")),
        }
    }

    /// Whether the bytes after all complete lines are the beginning of the next line, left by an interruption. After a
    /// failure of the machine, zeros may replace bytes that had not been written to the disk.
    fn is_begun(&self, bytes: &[u8], lines: u64, header: &Header) -> bool {
        let zeros = bytes.iter().rev().take_while(|byte| **byte == 0).count();
        let Ok(text) = std::str::from_utf8(&bytes[..bytes.len() - zeros]) else {
            return false;
        };
        if bytes.len() >= LONGEST_LINE {
            return false;
        }
        match lines {
            // A file with an incomplete first line is continued only if it belongs to this user. An empty file contains
            // no data that could be lost.
            1 => {
                let is_ours = text.is_empty() || is_of_this_user(&self.file);
                line(&header.text()).starts_with(text) && is_ours
            }
            _ if self.rows == header.points => line(&end_text(self.hash.clone())).starts_with(text),
            _ => self.is_begun_row(text),
        }
    }

    /// Whether a text is the beginning of the next point's line.
    fn is_begun_row(&self, text: &str) -> bool {
        let point = self.shard.point(self.rows);
        match text.split_once('\t') {
            None => self.form.is_begun(text, point),
            Some((row, _)) => self.form.check(row, point).is_ok() && line(row).starts_with(text),
        }
    }

    fn refused(&self, why: &str) -> StudyError {
        StudyError::BadShard {
            path: self.path.clone(),
            why: format!("{why}; remove it to begin the shard again"),
        }
    }

    fn append(&mut self, text: &str) -> Result<(), StudyError> {
        let point = self.shard.point(self.rows);
        let checked = self.form.check(text, point).map_err(io::Error::other);
        checked.map_err(|source| self.failed(source))?;
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

    /// Adds the last line, and gives the file its final name.
    fn finish(mut self, whole: &Path) -> Result<(), StudyError> {
        let end = line(&end_text(self.hash.clone()));
        self.write(&end)?;
        if is_there(whole) {
            let text = "a file with this name appeared while the shard was computed";
            let source = io::Error::new(ErrorKind::InvalidInput, text);
            return Err(StudyError::output(whole, source));
        }
        let renamed = self
            .file
            .sync_all()
            .and_then(|()| std::fs::rename(&self.path, whole));
        renamed.map_err(|source| StudyError::output(whole, source))?;
        // The rename is also synchronised with the disk, if the folder can be opened.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::read;

    /// Protects results from an interruption at any byte: the file can be continued, and ends with the same bytes. Any
    /// other defect is an error, and the file is left unchanged.
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
            let _ = std::fs::remove_file(&whole);
            let mut work = WorkFile::open(&study, shard, folder, &header)?;
            for place in work.rows..header.points {
                work.append(&format!("{},{:?},0.5,-0.5", shard.point(place), 0.25))?;
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
        let refused = WorkFile::open(&study, shard, folder, &other).err().unwrap();
        assert!(
            refused
                .to_string()
                .contains("renderer \"made up\", not \"another\"")
        );
        // While a process has the file open, all other processes are locked out.
        let working = WorkFile::open(&study, shard, folder, &header).unwrap();
        let refused = WorkFile::open(&study, shard, folder, &header)
            .err()
            .unwrap();
        assert!(matches!(refused, StudyError::Busy { .. }), "{refused}");
        drop(working);
    }
}
