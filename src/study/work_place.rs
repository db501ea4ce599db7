//! Which files are worked on: such as this program made, under the very name that it gave them.
//!
//! A folder of results may hold anything: links that lead to other files, other names of files (hard
//! links), pipes, files of other programs. None of them is written to. A file that is there is opened without
//! following links, and locked; what was opened is looked at, and its first line read, before a byte is written.

use super::{Shard, StudyError};
use crate::plain_file;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Tries to open a file that another process makes and removes again and again.
const MOST_TRIES: u32 = 10;

/// Opens a working file, or makes it; no other process may have it open. A file system without locks
/// gives no such protection.
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
    // It may have been finished and renamed between the opening and the lock.
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

/// Opens the file of this very name, or makes one that was not there.
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

/// Whether anything has this name, a link that leads nowhere as well.
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

/// Whether the user who runs this program owns a file: not known here, so that what the system lets
/// the program open is taken.
#[cfg(not(target_os = "linux"))]
pub(super) fn is_of_this_user(_: &File) -> bool {
    true
}
