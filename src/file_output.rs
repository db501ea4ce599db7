//! Atomic file writes.
//!
//! Everything is written beside its target and renamed at the end, so that a run that
//! is interrupted leaves an older file as it was. What was read as an input (a scene, a file
//! that it names, a sound, answers) is never replaced, whatever path or link leads to it.
#![cfg_attr(not(feature = "cli"), allow(dead_code))] // The library alone writes sounds alone.

use crate::file_input::is_input;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// A file or folder that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {}", path.display(), reason(source))]
#[non_exhaustive]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// Why.
    pub source: io::Error,
}

impl OutputError {
    /// Whether the place that was named is to blame, rather than the disk.
    pub fn is_bad_input(&self) -> bool {
        is_bad_place(&self.source)
    }
}

/// Why something cannot be written, in the same words for all callers.
fn reason(error: &io::Error) -> String {
    let is_of_system = error.raw_os_error().is_some();
    if !is_of_system && error.to_string() != error.kind().to_string() {
        // A sentence of ours.
        return error.to_string();
    }
    match error.kind() {
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            "a folder is needed here, and there is a file".to_owned()
        }
        io::ErrorKind::NotFound => "there is no such folder".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    }
}

/// Whether an error of writing means that the place cannot be written to at all.
pub(crate) fn is_bad_place(error: &io::Error) -> bool {
    use io::ErrorKind::{
        AlreadyExists, InvalidFilename, InvalidInput, IsADirectory, NotADirectory, NotFound,
        PermissionDenied, ReadOnlyFilesystem,
    };
    matches!(
        error.kind(),
        AlreadyExists
            | InvalidFilename
            | InvalidInput
            | IsADirectory
            | NotADirectory
            | NotFound
            | PermissionDenied
            | ReadOnlyFilesystem
    )
}

/// Writes a file through `fill`, beside its place, and renames it there.
///
/// # Errors
/// [`OutputError`] with the path when any step fails; nothing is left behind.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    let error = |source| OutputError {
        path: path.to_owned(),
        source,
    };
    let target = &followed(path);
    let beside = temporary_beside(target).map_err(error)?;
    let mut writer = BufWriter::new(beside.reopen().map_err(error)?);
    fill(&mut writer).map_err(error)?;
    writer.flush().map_err(error)?;
    drop(writer);
    beside.persist(target).map_err(error)?;
    crate::file_input::note_output(target);
    Ok(())
}

/// Where a path leads: a link keeps being one, and what it names is replaced.
pub(crate) fn followed(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// Every temporary file there is, for [`remove_parts`].
static PARTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn parts() -> MutexGuard<'static, Vec<PathBuf>> {
    PARTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes every temporary file, and prevents new ones: a thread that begins one blocks for
/// ever. For a program that is being interrupted, as its last act.
///
/// Recordings of what is heard stay: their temporary files are to be found.
#[cfg(unix)]
pub fn remove_parts() {
    let parts = parts();
    for path in parts.iter() {
        // It may have been renamed or removed by now; and there is nobody to tell.
        let _ = std::fs::remove_file(path);
    }
    std::mem::forget(parts);
}

/// A file on its way to its name: removed when dropped, and when the program is interrupted.
#[derive(Debug)]
pub(crate) struct PartFile {
    /// There until the file has its name.
    file: Option<NamedTempFile>,
    path: PathBuf,
}

impl PartFile {
    fn new(made: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<PartFile> {
        // Made and known at once, seen from who removes them.
        let mut parts = parts();
        let file = made()?;
        let path = file.path().to_owned();
        parts.push(path.clone());
        Ok(PartFile {
            file: Some(file),
            path,
        })
    }

    /// Another handle to the file.
    pub fn reopen(&self) -> io::Result<File> {
        File::options().read(true).write(true).open(&self.path)
    }

    /// Gives the file its name once it is on the disk, replacing an older file that is no
    /// input.
    pub fn persist(mut self, target: &Path) -> io::Result<()> {
        refuse_inputs(target)?;
        let Some(file) = self.file.take() else {
            return Ok(());
        };
        let done = file
            .as_file()
            .sync_all()
            .and_then(|()| file.persist(target).map_err(|error| error.error));
        done.map(|_| ())
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        let mut parts = parts();
        self.file = None;
        parts.retain(|path| *path != self.path);
    }
}

fn refuse_inputs(target: &Path) -> io::Result<()> {
    if is_input(target) {
        let text = "it is an input of this run, and inputs are never replaced";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    }
    Ok(())
}

/// A temporary file in the folder of `target`, to be renamed to it: readable by others
/// as any new file is. A target that is there but no plain file (a folder, a device), or is
/// an input, is rejected, since a rename would replace it.
pub(crate) fn temporary_beside(target: &Path) -> io::Result<PartFile> {
    PartFile::new(|| temporary_named(target, ".echomarch-".as_ref(), ".part"))
}

/// The same under a name that is seen: what an interrupted program leaves is to be found.
/// `heard.wav` becomes `heard-XXXXXX.part.wav`.
#[cfg(feature = "audio")]
pub(crate) fn visible_part_beside(target: &Path) -> io::Result<PartFile> {
    let mut begin = target.file_stem().unwrap_or_default().to_owned();
    begin.push("-");
    let file = temporary_named(target, &begin, ".part.wav")?;
    // Not among those that are removed.
    Ok(PartFile {
        path: file.path().to_owned(),
        file: Some(file),
    })
}

fn temporary_named(target: &Path, begin: &OsStr, end: &str) -> io::Result<NamedTempFile> {
    let ends_as_a_folder = target.as_os_str().as_encoded_bytes().ends_with(b"/");
    if ends_as_a_folder || target.file_name().is_none() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    match std::fs::metadata(target) {
        Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => {
            let text = "it is there already and no plain file";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
        }
        // A name that cannot even be asked for (too long, say) cannot be written either.
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        Ok(_) | Err(_) => {}
    }
    refuse_inputs(target)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(begin).suffix(end);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // The error of the call alone: tempfile's names the temporary file, which nobody asked for.
    builder
        .tempfile_in(folder_of(target))
        .map_err(|error| refused_in(folder_of(target), error.kind()))
}

/// Why no file can be made in a folder; where the folder is missing, that it is.
fn refused_in(folder: &Path, kind: io::ErrorKind) -> io::Error {
    if kind == io::ErrorKind::NotFound && !folder.exists() {
        let text = format!("there is no folder {}", folder.display());
        return io::Error::new(kind, text);
    }
    kind.into()
}

/// Makes a folder if need be and proves that files can be written in it: to be called
/// before long work whose results go there.
///
/// # Errors
/// [`OutputError`] with the folder.
pub fn prepare_folder(folder: &Path) -> Result<(), OutputError> {
    let error = |source| OutputError {
        path: folder.to_owned(),
        source,
    };
    std::fs::create_dir_all(folder).map_err(error)?;
    tempfile::tempfile_in(folder).map_err(error)?;
    Ok(())
}

/// Proves that a file can be written, and is no input that was read so far: to be called
/// once the inputs are read, before long work that ends in it.
///
/// # Errors
/// [`OutputError`] with the file.
pub fn check_file(path: &Path) -> Result<(), OutputError> {
    match temporary_beside(path) {
        Ok(_) => Ok(()),
        Err(source) => Err(OutputError {
            path: path.to_owned(),
            source,
        }),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects an older file from a run that fails half way.
    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        write_whole(&path, |out| out.write_all(b"old")).unwrap();
        let failed = write_whole(&path, |out| {
            out.write_all(b"new")?;
            Err(io::Error::other("interrupted"))
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Protects links: what they name is replaced, they stay.
    #[cfg(unix)]
    #[test]
    fn a_link_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        std::fs::write(&real, b"old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_whole(&link, |out| out.write_all(b"new")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&real).unwrap(), b"new");
    }

    /// Protects devices and folders from being renamed over.
    #[test]
    fn what_is_no_plain_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_file(folder.path()).is_err());
        assert!(check_file(Path::new("/dev/null")).is_err());
        let absent = folder.path().join("absent");
        let refused = check_file(&absent.join("file.csv"))
            .unwrap_err()
            .to_string();
        let told = format!("there is no folder {}", absent.display());
        assert!(refused.ends_with(&told), "{refused}");
        assert!(check_file(&folder.path().join("file.csv")).is_ok());
    }
}
