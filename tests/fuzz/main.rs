//! Tests with untrusted files, which are valid files corrupted by a seeded generator.
//!
//! Each module is a target: `one(data)` reads the bytes as one kind of file. An invalid file must be rejected without a
//! panic, within the limits on time and memory. The tests include a short run. This command starts a long run:
//!
//! ```text
//! ECHOMARCH_FUZZ_RUNS=100000 ECHOMARCH_FUZZ_SEED=7 cargo test --release --test fuzz -- --nocapture
//! ```
//!
//! An input with the same seed and number is identical in every run. `ECHOMARCH_FUZZ_FIRST=i ECHOMARCH_FUZZ_RUNS=1`
//! therefore reproduces a failure at input i.

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

/// Protects from untrusted scene files.
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

/// Protects from untrusted texts of users' fields before a driver compiles them.
#[test]
fn field_texts() {
    fuzz(&field_text::target());
}
