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

mod driver;
mod mutate;
#[path = "../common/random.rs"]
mod random;
mod scratch;
mod target;

mod base_scene;
mod field_text;
mod height_image;
mod materials;
mod scene;
#[cfg(feature = "sofa")]
mod sofa;
#[cfg(feature = "sofa")]
#[path = "../common/sofa.rs"]
mod sofa_file;
mod wav;

use driver::fuzz;
use target::Target;

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

/// Protects from untrusted texts of fields before any driver compiles them.
#[test]
fn field_texts() {
    fuzz(&field_text::target());
}
