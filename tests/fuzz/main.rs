//! Untrusted files: valid ones corrupted by a seeded generator.
//!
//! Each module is a target: `one(data)` reads the bytes as that kind of file. An invalid file must be refused within
//! the limits on time and memory, without a panic. The tests include a short run. To start a long one by hand:
//!
//! ```text
//! ECHOMARCH_FUZZ_RUNS=100000 ECHOMARCH_FUZZ_SEED=7 cargo test --release --test fuzz -- --nocapture
//! ```
//!
//! Input number i of a seed is the same in every run, so `ECHOMARCH_FUZZ_FIRST=i ECHOMARCH_FUZZ_RUNS=1` reproduces a
//! finding.

mod mutate;
#[path = "../common/random.rs"]
mod random;
mod scratch;

mod answers;
mod base_scene;
mod field_text;
mod height_image;
mod materials;
mod scene;
#[cfg(feature = "experiment")]
#[path = "../common/shard.rs"]
mod shard_file;
#[cfg(feature = "sofa")]
mod sofa;
#[cfg(feature = "sofa")]
#[path = "../common/sofa.rs"]
mod sofa_file;
#[cfg(feature = "experiment")]
mod study;
#[cfg(feature = "experiment")]
mod study_folder;
mod wav;

use mutate::Mutator;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Inputs of each kind in a run without `ECHOMARCH_FUZZ_RUNS`.
const SHORT_RUN: u64 = 400;

/// Longest time for an input of a few kilobytes, whatever else the machine does.
const LONGEST: Duration = Duration::from_secs(20);

/// Time between two lines of progress in a long run.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// One kind of file.
struct Target {
    name: &'static str,
    /// Valid files to start from.
    corpus: Vec<Vec<u8>>,
    /// Words and symbols with a meaning in such a file.
    tokens: &'static [&'static str],
    one: fn(&[u8]),
}

fn from_environment(name: &str, otherwise: u64) -> u64 {
    match std::env::var(name) {
        Ok(value) => value
            .parse()
            .unwrap_or_else(|_| panic!("{name} must be a whole number, not {value:?}")),
        Err(_) => otherwise,
    }
}

/// Reads corrupted files of a kind. A finding is written to the temporary folder.
fn fuzz(target: &Target) {
    let seed = from_environment("ECHOMARCH_FUZZ_SEED", 1);
    let first = from_environment("ECHOMARCH_FUZZ_FIRST", 0);
    let runs = from_environment("ECHOMARCH_FUZZ_RUNS", SHORT_RUN);
    for file in &target.corpus {
        (target.one)(file);
    }
    let mut told = Instant::now();
    for index in first..first + runs {
        let data = Mutator::new(seed, index).spoilt(&target.corpus, target.tokens);
        let began = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (target.one)(&data)));
        let (name, took) = (target.name, began.elapsed());
        // Time is judged only in long runs, started by hand on an otherwise idle machine.
        if outcome.is_err() || (runs > SHORT_RUN && took > LONGEST) {
            let path = std::env::temp_dir().join(format!("echomarch-fuzz-{name}-{seed}-{index}"));
            let kept = std::fs::write(&path, &data);
            panic!(
                "{name}: input {index} of seed {seed} ({} bytes, {took:?}); kept as {}: {kept:?}",
                data.len(),
                path.display()
            );
        }
        if told.elapsed() > BETWEEN_LINES {
            told = Instant::now();
            println!("{name}: {} of {runs}", index + 1 - first);
        }
    }
}

/// Protects from untrusted scene files: text, structure and numbers.
#[test]
fn scenes() {
    fuzz(&scene::target());
}

/// Protects from untrusted scenes with a base.
#[test]
fn base_scenes() {
    fuzz(&base_scene::target());
}

/// Protects from untrusted tables of materials.
#[test]
fn materials() {
    fuzz(&materials::target());
}

/// Protects from untrusted study files.
#[cfg(feature = "experiment")]
#[test]
fn studies() {
    fuzz(&study::target());
}

/// Protects tables from untrusted shards, whose checksums may be right.
#[cfg(feature = "experiment")]
#[test]
fn shards() {
    fuzz(&study_folder::shards());
}

/// Protects the files of a folder of results, and the targets of its links, when an interrupted shard is continued.
#[cfg(feature = "experiment")]
#[test]
fn work_files() {
    fuzz(&study_folder::work_files());
}

/// Protects from untrusted sounds.
#[test]
fn wavs() {
    fuzz(&wav::target());
}

/// Protects from untrusted SOFA files.
#[cfg(feature = "sofa")]
#[test]
fn sofa_files() {
    fuzz(&sofa::target());
}

/// Protects from untrusted height images.
#[test]
fn height_images() {
    fuzz(&height_image::target());
}

/// Protects from untrusted answers.
#[cfg(feature = "experiment")]
#[test]
fn answers() {
    fuzz(&answers::target());
}

/// Protects from untrusted texts of fields before any driver sees them.
#[test]
fn field_texts() {
    fuzz(&field_text::target());
}
