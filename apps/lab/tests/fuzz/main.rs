//! Untrusted studies, shards and answers: a seeded generator corrupts valid files, as in the library's `tests/fuzz`.

#[path = "../../../../tests/fuzz/driver.rs"]
mod driver;
#[path = "../../../../tests/fuzz/mutate.rs"]
mod mutate;
#[path = "../../../../tests/common/random.rs"]
mod random;
#[path = "../../../../tests/fuzz/scratch.rs"]
mod scratch;
#[path = "../common/shard.rs"]
mod shard_file;
#[path = "../../../../tests/fuzz/target.rs"]
mod target;

mod answers;
mod study;
mod study_folder;

use driver::fuzz;
use target::Target;

/// Protects the program from untrusted study files.
#[test]
fn studies() {
    fuzz(&study::target());
}

/// Protects tables from untrusted shards, whose checksums may be correct.
#[test]
fn shards() {
    fuzz(&study_folder::shards());
}

/// Protects the other files of a results folder, and the targets of links in it, when an interrupted shard is
/// continued.
#[test]
fn work_files() {
    fuzz(&study_folder::work_files());
}

/// Protects the program from untrusted answer files.
#[test]
fn answers() {
    fuzz(&answers::target());
}
