//! Reads regular files up to a size limit for each kind, and records each as an input so that no output replaces it.
//!
//! A scene may be untrusted, and it names other files. Reading a pipe would block, reading a device may never end, and
//! a file may be larger than the memory. All three are rejected before a byte is read. In a folder that others can
//! write to, only a plain file with exactly the given name is opened.

use crate::platform;
use std::collections::BTreeSet;
use std::fs::{File, FileType, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// An error at a position in a text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{origin}:{line}:{column}: {message}")]
#[non_exhaustive]
pub struct MalformedText {
    /// File path, or another name of the text's origin.
    pub origin: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// Description of the error.
    pub message: String,
}

impl MalformedText {
    /// Creates the error for a line and column of a text.
    #[doc(hidden)]
    pub fn new(origin: &str, (line, column): (usize, usize), message: String) -> MalformedText {
        MalformedText {
            origin: origin.to_owned(),
            line,
            column,
            message,
        }
    }
}

/// Error when a file is not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// The program runs in a browser, which has no files.
    #[error("there are no files in a browser")]
    NoFiles,
    /// An error of the system, or a text file that is not UTF-8.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The path does not lead to a regular file.
    #[error("it is {found}, not a regular file")]
    NotRegular {
        /// The kind of file, with an indefinite article.
        found: &'static str,
    },
    /// The file exceeds the size limit of its kind.
    #[error("it is larger than {limit_bytes} bytes, the size limit")]
    TooLarge {
        /// The limit in bytes.
        limit_bytes: u64,
    },
}

/// An open regular file that is read only up to its limit.
#[derive(Debug)]
pub struct InputFile {
    file: File,
    length: u64,
    limit_bytes: u64,
    /// Number of bytes that may still be read.
    left: u64,
}

impl InputFile {
    /// Opens a file of at most `limit_bytes` and records it as an input.
    ///
    /// # Errors
    /// [`InputError`].
    pub fn open(path: &Path, limit_bytes: u64) -> Result<InputFile, InputError> {
        if !platform::HAS_FILES {
            return Err(InputError::NoFiles);
        }
        let check = |about: &Metadata| check_regular(about.file_type());
        let found = std::fs::metadata(path)?;
        let mut options = OpenOptions::new();
        set_flags(options.read(true), true);
        let (file, about) = open_checked(path, &options, Some(&found), check)?;
        if about.len() > limit_bytes {
            return Err(InputError::TooLarge { limit_bytes });
        }
        note(path);
        Ok(InputFile {
            file,
            length: about.len(),
            limit_bytes,
            left: limit_bytes,
        })
    }

    /// Length in bytes when the file was opened.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Moves to a byte offset from the beginning.
    pub fn skip_to(&mut self, byte: u64) -> io::Result<()> {
        self.left = self.limit_bytes.saturating_sub(byte);
        self.file.seek(io::SeekFrom::Start(byte)).map(drop)
    }

    fn bytes(mut self) -> Result<Vec<u8>, InputError> {
        let mut bytes = Vec::with_capacity(self.length as usize);
        match self.read_to_end(&mut bytes) {
            Ok(_) => Ok(bytes),
            Err(error) => Err(InputError::from_reading(error)),
        }
    }

    fn text(self) -> Result<String, InputError> {
        String::from_utf8(self.bytes()?).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            let text = format!("it is not UTF-8 text from byte {at} on");
            io::Error::new(ErrorKind::InvalidData, text).into()
        })
    }
}

impl Read for InputFile {
    /// Fails with [`InputError::TooLarge`] inside the I/O error if the file has grown beyond its limit since it was
    /// opened.
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 && !into.is_empty() {
            return match self.file.read(&mut [0])? {
                0 => Ok(0),
                _ => Err(io::Error::other(InputError::TooLarge {
                    limit_bytes: self.limit_bytes,
                })),
            };
        }
        let most = into
            .len()
            .min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let count = self.file.read(&mut into[..most])?;
        self.left -= count as u64;
        Ok(count)
    }
}

impl InputError {
    /// The error of [`InputFile`] inside an I/O error, or the I/O error itself.
    pub(crate) fn from_reading(error: io::Error) -> InputError {
        match error.downcast::<InputError>() {
            Ok(ours) => ours,
            Err(error) => InputError::Io(error),
        }
    }
}

/// Reads the bytes of a file of at most `limit_bytes` and records it as an input.
///
/// # Errors
/// [`InputError`].
pub fn read(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, InputError> {
    InputFile::open(path, limit_bytes)?.bytes()
}

/// Reads the text of a file of at most `limit_bytes` and records it as an input.
///
/// # Errors
/// [`InputError`]; [`InputError::Io`] for text that is not UTF-8.
pub fn read_text(path: &Path, limit_bytes: u64) -> Result<String, InputError> {
    InputFile::open(path, limit_bytes)?.text()
}

/// Opens a file whose metadata pass a check. The check runs before opening, because opening some devices triggers an
/// action. It runs again after opening, because the path may lead to a different file by then.
fn open_checked<E: From<io::Error>>(
    path: &Path,
    options: &OpenOptions,
    found: Option<&Metadata>,
    check: impl Fn(&Metadata) -> Result<(), E>,
) -> Result<(File, Metadata), E> {
    found.map_or(Ok(()), &check)?;
    let file = options.open(path)?;
    let about = file.metadata()?;
    check(&about)?;
    Ok((file, about))
}

/// Sets flags so that opening does not wait for a pipe, and follows a link only if `follows` is true.
#[cfg(unix)]
fn set_flags(options: &mut OpenOptions, follows: bool) {
    use std::os::unix::fs::OpenOptionsExt;
    let links = if follows { 0 } else { libc::O_NOFOLLOW };
    options.custom_flags(links | libc::O_NONBLOCK | libc::O_NOCTTY);
}

#[cfg(windows)]
fn set_flags(options: &mut OpenOptions, follows: bool) {
    use std::os::windows::fs::OpenOptionsExt;
    /// Opens the link itself instead of its target: `FILE_FLAG_OPEN_REPARSE_POINT` of `CreateFileW`.
    const OPEN_REPARSE_POINT: u32 = 0x0020_0000;
    if !follows {
        options.custom_flags(OPEN_REPARSE_POINT);
    }
}

#[cfg(not(any(unix, windows)))]
fn set_flags(_: &mut OpenOptions, _: bool) {}

fn check_regular(kind: FileType) -> Result<(), InputError> {
    if kind.is_file() {
        return Ok(());
    }
    let found = if kind.is_dir() {
        "a directory"
    } else {
        special(kind)
    };
    Err(InputError::NotRegular { found })
}

#[cfg(unix)]
fn special(kind: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    if kind.is_fifo() {
        "a pipe"
    } else if kind.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn special(_: FileType) -> &'static str {
    "a device"
}

/// The reason for rejecting a pipe or a device.
const NO_PLAIN_FILE: &str = "it exists already and is not a plain file";

/// Opens the file with exactly this name in a folder that others can write to, if it is a plain file: never the target
/// of a link, a pipe or a device.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] for a link, a pipe, a device; [`ErrorKind::IsADirectory`]; other errors of the system,
/// such as [`ErrorKind::NotFound`].
pub fn open_plain(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    let found = match std::fs::symlink_metadata(path) {
        // Opening may create the file.
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        found => Some(found?),
    };
    set_flags(options, false);
    match open_checked(path, options, found.as_ref(), |about| {
        check_plain(path, about)
    }) {
        Err(error) if is_link(&error) => Err(link_refused(path)),
        opened => opened.map(|(file, _)| file),
    }
}

/// Rejects anything except a plain file at `path`, by its metadata.
///
/// # Errors
/// The errors of [`open_plain`].
pub fn check_plain(path: &Path, about: &Metadata) -> io::Result<()> {
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

/// Whether the system rejected a link that was created after the check.
#[cfg(unix)]
fn is_link(error: &io::Error) -> bool {
    error.raw_os_error() == Some(libc::ELOOP)
}

#[cfg(not(unix))]
fn is_link(_: &io::Error) -> bool {
    false
}

/// The number of names of a file: more than one if it has hard links; one if the system cannot count them.
#[cfg(unix)]
pub fn count_names(about: &Metadata) -> u64 {
    use std::os::unix::fs::MetadataExt;
    about.nlink()
}

#[cfg(not(unix))]
pub fn count_names(_: &Metadata) -> u64 {
    1
}

/// Real paths of all files read as inputs.
static INPUTS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Real paths of all files written by this run: reading such a file again does not make it an input.
static OUTPUTS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn note(path: &Path) {
    let Ok(real) = std::fs::canonicalize(path) else {
        return;
    };
    let outputs = OUTPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    if !outputs.contains(&real) {
        let mut inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
        inputs.insert(real);
    }
}

/// Records a file as written by this run.
pub fn note_output(path: &Path) {
    if let Ok(real) = std::fs::canonicalize(path) {
        let mut outputs = OUTPUTS.lock().unwrap_or_else(PoisonError::into_inner);
        outputs.insert(real);
    }
}

/// Whether `path` leads to a file that was read as an input, possibly through another path or a symbolic or hard link.
pub fn is_input(path: &Path) -> bool {
    let is_regular = std::fs::metadata(path).is_ok_and(|about| about.is_file());
    if !is_regular {
        return false;
    }
    let real = std::fs::canonicalize(path).ok();
    let file = identity(path);
    let inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    inputs
        .iter()
        .any(|input| real.as_ref() == Some(input) || (file.is_some() && identity(input) == file))
}

/// The identity of a file, which is equal for all paths to the file: its device and its number on that device.
#[cfg(unix)]
fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    let about = std::fs::metadata(path).ok()?;
    Some((about.dev(), about.ino()))
}

#[cfg(windows)]
fn identity(path: &Path) -> Option<same_file::Handle> {
    // The path of an input may lead to a different file by now, and opening a pipe would block.
    let is_regular = std::fs::metadata(path).is_ok_and(|about| about.is_file());
    is_regular.then(|| same_file::Handle::from_path(path).ok())?
}

#[cfg(not(any(unix, windows)))]
fn identity(_: &Path) -> Option<()> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects memory: exceeding the limit is an error, both for the file's size and for the bytes read.
    #[test]
    fn no_more_than_the_limit_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, b"12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        let refused = read(&path, 4).unwrap_err().to_string();
        assert!(refused.contains("larger than 4 bytes"), "{refused}");
        // The file grows after it is opened.
        let open = InputFile::open(&path, 5).unwrap();
        std::fs::write(&path, b"123456").unwrap();
        assert!(matches!(
            open.bytes(),
            Err(InputError::TooLarge { limit_bytes: 5 })
        ));
    }

    /// Protects from blocking on a pipe, and from endless devices.
    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for (path, found) in [
            (pipe.as_path(), "a pipe"),
            (Path::new("/dev/zero"), "a device"),
            (link.as_path(), "a device"),
            (folder.path(), "a directory"),
        ] {
            let refused = read_text(path, 9).unwrap_err().to_string();
            assert_eq!(refused, format!("it is {found}, not a regular file"));
        }
    }

    /// Protects inputs from outputs that reach them by another path.
    #[cfg(unix)]
    #[test]
    fn links_lead_to_the_same_input() {
        let folder = tempfile::tempdir().unwrap();
        let [file, soft, hard, other] =
            ["file", "soft", "hard", "other"].map(|name| folder.path().join(name));
        std::fs::write(&file, b"x").unwrap();
        std::fs::write(&other, b"x").unwrap();
        std::os::unix::fs::symlink(&file, &soft).unwrap();
        std::fs::hard_link(&file, &hard).unwrap();
        assert!(!is_input(&file));
        read(&soft, 9).unwrap();
        for path in [&file, &soft, &hard, &folder.path().join("./file")] {
            assert!(is_input(path), "{}", path.display());
        }
        assert!(!is_input(&other) && !is_input(&folder.path().join("absent")));
    }

    /// Protects files that a run has written from counting as inputs after they are read again.
    #[test]
    fn a_run_replaces_what_it_wrote() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        for text in [b"1", b"2"] {
            crate::file_output::write_whole(&file, |out| out.write_all(text)).unwrap();
            assert_eq!(read(&file, 9).unwrap(), text);
        }
    }

    /// Protects the targets of links, and the program from pipes and devices: none of them is opened.
    #[cfg(unix)]
    #[test]
    fn only_a_plain_file_of_that_name_is_opened() {
        use std::os::unix::fs::symlink;
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
        let opened = |path: &Path| open_plain(path, File::options().read(true).write(true));
        assert!(opened(&path("file")).is_ok());
        for name in ["link", "dangling", "device", "pipe", "."] {
            assert!(opened(&path(name)).is_err(), "{name}");
        }
        assert!(opened(Path::new("/dev/null")).is_err());
        // No file is created through a dangling link.
        let mut making = File::options();
        making.write(true).create(true);
        assert!(open_plain(&path("dangling"), &mut making).is_err());
        assert!(!path("absent").exists());
        assert_eq!(count_names(&std::fs::metadata(path("file")).unwrap()), 1);
        std::fs::hard_link(path("file"), path("other")).unwrap();
        assert_eq!(count_names(&std::fs::metadata(path("file")).unwrap()), 2);
    }
}
