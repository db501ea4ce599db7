//! Chooses which files are worked on: only those made by this program, under the exact names that it gave them.
//!
//! A folder of results may contain anything: symbolic links, other names of files (hard links), pipes, files of other
//! programs. The program never writes to them. An existing file is opened without following links, and locked; then it
//! is inspected, and its first line read, before a byte is written.

use super::{Shard, StudyError};
use echomarch::internals::plain_file;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Maximum number of attempts to open a file that another process makes and removes again and again.
const MOST_TRIES: u32 = 10;

/// Opens or creates a working file; no other process may have it open. A file system without locks gives no such
/// protection.
pub(super) fn locked(shard: Shard, path: &Path) -> Result<File, StudyError> {
    let failed = |source| StudyError::output(path, source);
    let file = opened(path).map_err(failed)?;
    let busy = || StudyError::Busy {
        shard,
        path: path.to_owned(),
    };
    match file.try_lock() {
        Ok(()) => (),
        Err(TryLockError::WouldBlock) => return Err(busy()),
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => (),
        Err(TryLockError::Error(source)) => return Err(failed(source)),
    }
    // It may have been completed and renamed between the opening and the lock.
    let copy = file.try_clone().and_then(same_file::Handle::from_file);
    let copy = copy.map_err(failed)?;
    match same_file::Handle::from_path(path) {
        Ok(named) if named == copy => (),
        _ => return Err(busy()),
    }
    let about = file.metadata().map_err(failed)?;
    if plain_file::names(&about) > 1 {
        return Err(StudyError::BadShard {
            path: path.to_owned(),
            why: "it has another name as well (a hard link), and is not written to; remove it to \
                  begin the shard anew"
                .to_owned(),
        });
    }
    Ok(file)
}

/// Opens the file with exactly this name, or creates it.
fn opened(path: &Path) -> io::Result<File> {
    let options = || {
        let mut options = File::options();
        options.read(true).write(true);
        options
    };
    let mut refused = ErrorKind::NotFound.into();
    for _ in 0..MOST_TRIES {
        match plain_file::open(path, &mut options()) {
            Err(error) if error.kind() == ErrorKind::NotFound => (),
            found => return found,
        }
        match plain_file::open(path, options().create_new(true)) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => refused = error,
            made => return made,
        }
    }
    Err(refused)
}

/// Whether the name exists, including as a dangling link.
pub(super) fn is_there(path: &Path) -> bool {
    std::fs::symlink_metadata(path).is_ok()
}

/// Whether the user who runs this program owns a file.
#[cfg(target_os = "linux")]
pub(super) fn is_of_this_user(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let user = rustix::process::geteuid().as_raw();
    file.metadata().is_ok_and(|about| about.uid() == user)
}

/// Whether the user who runs this program owns a file: unknown on this system, so every file that can be opened is
/// accepted.
#[cfg(not(target_os = "linux"))]
pub(super) fn is_of_this_user(_: &File) -> bool {
    true
}
