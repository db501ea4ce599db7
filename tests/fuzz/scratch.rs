//! Temporary files. Each thread has its own folder.

use std::path::Path;

thread_local! {
    static FOLDER: tempfile::TempDir = tempfile::tempdir().expect("a temporary folder");
}

/// Writes `data` to a temporary file with this name, and calls `read` with its path.
pub fn with_file(name: &str, data: &[u8], read: impl FnOnce(&Path)) {
    FOLDER.with(|folder| {
        let path = folder.path().join(name);
        std::fs::write(&path, data).expect("a file in a temporary folder");
        read(&path);
    });
}
