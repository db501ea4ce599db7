//! Decides which files the program writes to: only files that it created itself, under their original names.
//!
//! A results folder may contain anything: symbolic links, hard links, pipes, files of other programs. The program never
//! writes to any of these. The program opens an existing file without following links, and locks it. Before it writes a
//! byte, it inspects the file and reads the first line.

use super::{Shard, StudyError};
use echomarch::internals::plain_file;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Maximum number of attempts to open a file that another process repeatedly creates and removes.
const MOST_TRIES: u32 = 10;

/// Opens or creates a working file. Fails if another process has locked the file. On a file system without locks, the
/// file is not protected from other processes.
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
    // Another process may have completed and renamed the file after it was opened here and before it was locked.
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

/// Whether the name exists, even as a dangling symbolic link.
pub(super) fn is_there(path: &Path) -> bool {
    std::fs::symlink_metadata(path).is_ok()
}

/// Whether a file belongs to the user who runs this program.
#[cfg(target_os = "linux")]
pub(super) fn is_of_this_user(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let user = rustix::process::geteuid().as_raw();
    file.metadata().is_ok_and(|about| about.uid() == user)
}

/// Whether a file belongs to the user who runs this program. This system does not report the owner, so every file that
/// can be opened is accepted.
#[cfg(not(target_os = "linux"))]
pub(super) fn is_of_this_user(_: &File) -> bool {
    true
}
