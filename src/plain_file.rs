//! Files in a folder that others can write to: only a plain file of exactly the given name is opened, never the target
//! of a link, a pipe or a device.
//!
//! The path is checked first, since opening alone makes some devices act. It may be another file a moment later, so the
//! file is opened without following links or waiting, and the opened file is checked again.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::Path;

/// The reason for rejecting a pipe or a device.
const NO_PLAIN_FILE: &str = "it exists already and is not a plain file";

/// Opens the file of exactly this name, if it is a plain file.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] for a link, a pipe, a device; [`ErrorKind::IsADirectory`]; other errors of the system,
/// such as [`ErrorKind::NotFound`].
pub fn open(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    match std::fs::symlink_metadata(path) {
        Ok(about) => check(path, &about)?,
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        // Opening may create it.
        Err(_) => {}
    }
    unfollowed(options);
    let file = options.open(path).map_err(|error| match is_link(&error) {
        true => link_refused(path),
        false => error,
    })?;
    check(path, &file.metadata()?)?;
    Ok(file)
}

/// Rejects anything except a plain file at `path`, by its metadata.
///
/// # Errors
/// As [`open`].
pub fn check(path: &Path, about: &Metadata) -> io::Result<()> {
    if about.is_symlink() {
        return Err(link_refused(path));
    }
    if about.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    match about.is_file() {
        true => Ok(()),
        false => Err(io::Error::new(ErrorKind::InvalidInput, NO_PLAIN_FILE)),
    }
}

/// The error for a symbolic link at `path`.
pub fn link_refused(path: &Path) -> io::Error {
    let leads = match path.exists() {
        true => "is not followed here",
        false => "leads nowhere",
    };
    let text = format!("it is a symbolic link, which {leads}: remove it, or write elsewhere");
    io::Error::new(ErrorKind::InvalidInput, text)
}

#[cfg(unix)]
fn unfollowed(options: &mut OpenOptions) {
    use std::os::unix::fs::OpenOptionsExt;
    options.custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK | libc::O_NOCTTY);
}

#[cfg(windows)]
fn unfollowed(options: &mut OpenOptions) {
    use std::os::windows::fs::OpenOptionsExt;
    /// Opens a link itself: `FILE_FLAG_OPEN_REPARSE_POINT` of `CreateFileW`.
    const OPEN_REPARSE_POINT: u32 = 0x0020_0000;
    options.custom_flags(OPEN_REPARSE_POINT);
}

#[cfg(not(any(unix, windows)))]
fn unfollowed(_: &mut OpenOptions) {}

/// Whether the system rejected a link that has appeared since the check.
#[cfg(unix)]
fn is_link(error: &io::Error) -> bool {
    error.raw_os_error() == Some(libc::ELOOP)
}

#[cfg(not(unix))]
fn is_link(_: &io::Error) -> bool {
    false
}

/// The number of names of a file: two or more with hard links; one if the system cannot count them.
#[cfg(unix)]
pub fn names(about: &Metadata) -> u64 {
    use std::os::unix::fs::MetadataExt;
    about.nlink()
}

#[cfg(not(unix))]
pub fn names(_: &Metadata) -> u64 {
    1
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    /// Protects the targets of links, and the program from pipes and devices: none of them is opened.
    #[test]
    fn only_a_plain_file_of_that_name_is_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("file"), b"x").unwrap();
        symlink(path("file"), path("link")).unwrap();
        symlink(path("absent"), path("dangling")).unwrap();
        symlink("/dev/zero", path("device")).unwrap();
        let made = std::process::Command::new("mkfifo")
            .arg(path("pipe"))
            .status();
        assert!(made.unwrap().success());
        let opened = |path: &Path| open(path, File::options().read(true).write(true));
        assert!(opened(&path("file")).is_ok());
        for name in ["link", "dangling", "device", "pipe", "."] {
            assert!(opened(&path(name)).is_err(), "{name}");
        }
        assert!(opened(Path::new("/dev/null")).is_err());
        // No file is created for a link that leads nowhere.
        let mut making = File::options();
        making.write(true).create(true);
        assert!(open(&path("dangling"), &mut making).is_err());
        assert!(!path("absent").exists());
        assert_eq!(names(&std::fs::metadata(path("file")).unwrap()), 1);
        std::fs::hard_link(path("file"), path("other")).unwrap();
        assert_eq!(names(&std::fs::metadata(path("file")).unwrap()), 2);
    }
}
