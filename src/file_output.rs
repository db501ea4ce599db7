//! Atomic file writes.
//!
//! Everything is written to a temporary file in the target's folder and renamed at the end, so that an interrupted run
//! leaves an older file unchanged. Inputs (a scene, a file that it names, a sound, answers) are never replaced, even
//! through another path or a link.
//!
//! # Links
//! For a path that the user typed, a symbolic link is followed and its target is replaced ([`write_whole`],
//! [`check_file`]). Files that the program itself names, in a folder that the user typed, must lie in that folder: a
//! symbolic link with such a name is rejected ([`write_inside`], [`check_inside`], [`prepare_folder_inside`]). Existing
//! files are never written in place, so the other names of a file (hard links) keep the older bytes.

use crate::file_input::{check_plain, is_input, link_refused};
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Error when a file or folder cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {}", path.display(), reason(source))]
#[non_exhaustive]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// The reason.
    pub source: io::Error,
}

impl OutputError {
    /// Creates the error for a path.
    #[doc(hidden)]
    pub fn new(path: &Path, source: io::Error) -> OutputError {
        let path = path.to_owned();
        OutputError { path, source }
    }

    /// Whether the given path is at fault rather than the disk.
    pub fn is_bad_input(&self) -> bool {
        is_bad_place(&self.source)
    }
}

/// The reason for a failed write. The wording is the same for all callers.
fn reason(error: &io::Error) -> String {
    let is_of_system = error.raw_os_error().is_some();
    if !is_of_system && error.to_string() != error.kind().to_string() {
        // The error already has a message of this crate.
        return error.to_string();
    }
    match error.kind() {
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            "a folder is needed here, but this is a file".to_owned()
        }
        io::ErrorKind::NotFound => "there is no such folder".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    }
}

/// Whether an error means that this path can never be written to.
pub fn is_bad_place(error: &io::Error) -> bool {
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

/// Writes a file that the user named: `fill` writes to a temporary file in its folder, which is then renamed.
///
/// # Errors
/// [`OutputError`] with the path if any step fails; no temporary file remains.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    write_at(&followed(path), path, fill)
}

/// Like [`write_whole`], for a file that the program itself named, in a folder that the user named: a link is rejected.
///
/// # Errors
/// The errors of [`write_whole`].
pub fn write_inside(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    write_at(path, path, fill)
}

/// Writes to `target`; messages name `path`.
fn write_at(
    target: &Path,
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    let error = |source| OutputError {
        path: path.to_owned(),
        source,
    };
    let beside = temporary_beside(target).map_err(error)?;
    let mut writer = BufWriter::new(beside.writer().map_err(error)?);
    fill(&mut writer).map_err(error)?;
    writer.flush().map_err(error)?;
    drop(writer);
    beside.persist(target).map_err(error)?;
    crate::file_input::note_output(target);
    Ok(())
}

/// The file that a user's path leads to. A link is kept, and its target is replaced.
pub fn followed(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// All existing temporary files, for [`remove_parts`].
static PARTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn parts() -> MutexGuard<'static, Vec<PathBuf>> {
    PARTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes every temporary file, and prevents new temporary files: a thread that creates one blocks forever. This must
/// be the last action of a program that is being interrupted.
///
/// Recordings of live sound stay: users must be able to find their temporary files.
#[cfg(unix)]
pub fn remove_parts() {
    let parts = parts();
    for path in parts.iter() {
        // The file may have been renamed or removed by now, and errors can no longer be reported.
        let _ = std::fs::remove_file(path);
    }
    std::mem::forget(parts);
}

/// A temporary file to be renamed. It is removed when dropped, and when the program is interrupted.
#[derive(Debug)]
pub struct PartFile {
    /// `Some` until the file is renamed.
    file: Option<NamedTempFile>,
    path: PathBuf,
}

impl PartFile {
    fn new(made: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<PartFile> {
        // Under this lock, [`remove_parts`] sees the file as soon as it exists.
        let mut parts = parts();
        let file = made()?;
        let path = file.path().to_owned();
        parts.push(path.clone());
        Ok(PartFile {
            file: Some(file),
            path,
        })
    }

    /// A second handle to the created file, even if the path leads to a different file by now.
    pub fn writer(&self) -> io::Result<File> {
        let file = self.file.as_ref().ok_or(io::ErrorKind::NotFound)?;
        file.as_file().try_clone()
    }

    /// Renames the file once its data are on the disk. An older file is replaced unless it is an input.
    pub fn persist(mut self, target: &Path) -> io::Result<()> {
        check_place(target)?;
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

/// Creates a temporary file in the folder of `target`, which is later renamed to `target`. Others can read it like any
/// new file. An existing target that is an input or not a plain file (a link, a folder, a device) is rejected, because
/// renaming would replace it.
pub fn temporary_beside(target: &Path) -> io::Result<PartFile> {
    PartFile::new(|| temporary_named(target, ".echomarch-".as_ref(), ".part"))
}

/// Like [`temporary_beside`], with a visible name, so that users find the file of an interrupted program. `heard.wav`
/// becomes `heard-XXXXXX.part.wav`.
#[cfg(feature = "live")]
pub fn visible_part_beside(target: &Path) -> io::Result<PartFile> {
    let mut begin = target.file_stem().unwrap_or_default().to_owned();
    begin.push("-");
    let file = temporary_named(target, &begin, ".part.wav")?;
    // Not listed in `PARTS`, so it is not removed.
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
    check_place(target)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(begin).suffix(end);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // Keeps only the system's error, because tempfile's error names the temporary file, which the user does not know.
    builder
        .tempfile_in(folder_of(target))
        .map_err(|error| refused_in(folder_of(target), error.kind()))
}

/// Rejects a path whose content must not be replaced: anything except a plain file, and inputs.
fn check_place(target: &Path) -> io::Result<()> {
    // Inputs are checked first, also behind links, because this error matters most to the user.
    refuse_inputs(target)?;
    match std::fs::symlink_metadata(target) {
        Ok(found) => check_plain(target, &found)?,
        // A path whose metadata cannot be read (too long, for example) cannot be written either.
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        Err(_) => {}
    }
    Ok(())
}

/// The error if no file can be created in a folder. It names a missing folder.
fn refused_in(folder: &Path, kind: io::ErrorKind) -> io::Error {
    if kind == io::ErrorKind::NotFound && !folder.exists() {
        let text = format!("there is no folder {}", folder.display());
        return io::Error::new(kind, text);
    }
    kind.into()
}

/// Creates a folder if necessary and verifies that files can be written in it: call it before long work whose results
/// go to the folder.
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

/// Like [`prepare_folder`], for a subfolder that the program itself named: a link is rejected, because its contents
/// would lie elsewhere.
///
/// # Errors
/// [`OutputError`] with the folder.
pub fn prepare_folder_inside(folder: &Path) -> Result<(), OutputError> {
    if folder.is_symlink() {
        return Err(OutputError {
            path: folder.to_owned(),
            source: link_refused(folder),
        });
    }
    prepare_folder(folder)
}

/// Verifies that a file that the user named can be written and is not an input of this run: call it after reading the
/// inputs and before long work.
///
/// # Errors
/// [`OutputError`] with the file.
pub fn check_file(path: &Path) -> Result<(), OutputError> {
    check_at(&followed(path), path)
}

/// Like [`check_file`], for a file that the program itself named, in a folder that the user named: a link is rejected.
///
/// # Errors
/// [`OutputError`] with the file.
pub fn check_inside(path: &Path) -> Result<(), OutputError> {
    check_at(path, path)
}

fn check_at(target: &Path, path: &Path) -> Result<(), OutputError> {
    match temporary_beside(target) {
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

    /// Protects an older file from a run that fails halfway.
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

    /// Protects links: their targets are replaced, the links stay.
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

    /// Protects files outside a folder from names that the program chooses in the folder: links with such names are
    /// neither followed nor replaced, even if they are dangling.
    #[cfg(unix)]
    #[test]
    fn links_inside_a_folder_are_refused() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let [real, link, dangling] =
            ["real", "link", "dangling"].map(|name| folder.path().join(name));
        std::fs::write(&real, b"old").unwrap();
        symlink(&real, &link).unwrap();
        symlink(folder.path().join("absent"), &dangling).unwrap();
        let write = |path: &Path| write_inside(path, |out| out.write_all(b"new"));
        for path in [&link, &dangling] {
            assert!(check_inside(path).is_err());
            let refused = write(path).unwrap_err();
            assert!(refused.is_bad_input() && refused.to_string().contains("symbolic link"));
            assert!(path.is_symlink());
        }
        assert!(check_file(&link).is_ok() && check_file(&dangling).is_err());
        assert!(write_whole(&dangling, |out| out.write_all(b"new")).is_err());
        assert_eq!(std::fs::read(&real).unwrap(), b"old");
        // A link is created while the file is written.
        let (late, place) = (folder.path().join("late"), folder.path().join("place"));
        let part = temporary_beside(&place).unwrap();
        symlink(&real, &place).unwrap();
        assert!(part.persist(&place).is_err() && place.is_symlink());
        // A link in place of the temporary file is not written to.
        let part = temporary_beside(&late).unwrap();
        std::fs::remove_file(&part.path).unwrap();
        symlink(&real, &part.path).unwrap();
        part.writer().unwrap().write_all(b"new").unwrap();
        drop(part);
        assert_eq!(std::fs::read(&real).unwrap(), b"old");
        // A hard link to the replaced file keeps the older bytes.
        let other = folder.path().join("other");
        std::fs::hard_link(&real, &other).unwrap();
        write(&other).unwrap();
        assert_eq!(std::fs::read(&real).unwrap(), b"old");
        // A folder that is a link leads out of the parent folder.
        let out = folder.path().join("out");
        symlink(std::env::temp_dir(), &out).unwrap();
        assert!(prepare_folder_inside(&out).is_err());
        assert!(prepare_folder(&out).is_ok());
    }

    /// Protects devices and folders from being replaced by a rename.
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
