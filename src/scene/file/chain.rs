//! Scene files that are based on each other.

use std::path::{Path, PathBuf};

/// Maximum number of scenes in a chain of bases: a chain is written by hand, and each of its files
/// may have the full size.
pub(super) const MOST_BASES: usize = 8;

/// The files from the requested scene down to the one being read, by their real paths.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    files: Vec<PathBuf>,
    bases: usize,
}

impl Chain {
    /// A chain that begins at a file.
    pub fn at(path: &Path) -> Chain {
        Chain {
            files: std::fs::canonicalize(path).into_iter().collect(),
            bases: 0,
        }
    }

    /// The chain extended by this base, or why it cannot be.
    pub fn down_to(&self, base: &Path) -> Result<Chain, String> {
        let real = std::fs::canonicalize(base).ok();
        if real.as_ref().is_some_and(|real| self.files.contains(real)) {
            let base = base.display();
            return Err(format!("the base {base} is itself based on this scene"));
        }
        if self.bases == MOST_BASES {
            return Err(format!(
                "more than {MOST_BASES} scenes are based on each other"
            ));
        }
        let files = self.files.iter().cloned().chain(real);
        Ok(Chain {
            files: files.collect(),
            bases: self.bases + 1,
        })
    }
}
