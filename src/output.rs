//! Files that are there whole or not at all.
//!
//! Everything is written beside its target and renamed at the end, so that a run that
//! is broken off leaves an older file as it was.

use std::ffi::OsStr;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file or folder that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
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

/// Whether an error of writing says that the place cannot be written to at all.
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

/// Writes a file by way of `fill`, beside its place, and renames it there.
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
    let mut writer = BufWriter::new(beside.as_file());
    fill(&mut writer).map_err(error)?;
    writer.flush().map_err(error)?;
    drop(writer);
    beside.as_file().sync_all().map_err(error)?;
    beside.persist(target).map_err(|e| error(e.error))?;
    Ok(())
}

/// Where a path leads: a link keeps being one, and what it names is replaced.
pub(crate) fn followed(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A temporary file in the folder of `target`, to be renamed to it: readable by others
/// as any new file is. A target that is there but no plain file (a folder, a device) is
/// refused, since a rename would replace it.
pub(crate) fn temporary_beside(target: &Path) -> io::Result<NamedTempFile> {
    temporary_named(target, ".echomarch-".as_ref(), ".part")
}

/// The same under a name that is seen: what a program that is broken off leaves is to be found.
/// `heard.wav` becomes `heard-XXXXXX.part.wav`.
#[cfg(feature = "audio")]
pub(crate) fn visible_part_beside(target: &Path) -> io::Result<NamedTempFile> {
    let mut begin = target.file_stem().unwrap_or_default().to_owned();
    begin.push("-");
    temporary_named(target, &begin, ".part.wav")
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
        .map_err(|error| io::Error::from(error.kind()))
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

/// Proves that a file can be written: to be called before long work that ends in it.
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
            Err(io::Error::other("broken off"))
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
        assert!(check_file(&folder.path().join("absent/file.csv")).is_err());
        assert!(check_file(&folder.path().join("file.csv")).is_ok());
    }
}
