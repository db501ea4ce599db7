//! libFuzzer programs for the targets of `tests/fuzz`.

#[path = "../../tests/common/random.rs"]
mod random;
#[path = "../../tests/fuzz/scratch.rs"]
mod scratch;
#[path = "../../tests/common/sofa.rs"]
mod sofa_file;
#[path = "../../tests/fuzz/target.rs"]
mod target;

#[path = "../../tests/fuzz/base_scene.rs"]
pub mod base_scene;
#[path = "../../tests/fuzz/field_text.rs"]
pub mod field_text;
#[path = "../../tests/fuzz/height_image.rs"]
pub mod height_image;
#[path = "../../tests/fuzz/materials.rs"]
pub mod materials;
#[path = "../../tests/fuzz/scene.rs"]
pub mod scene;
#[path = "../../tests/fuzz/sofa.rs"]
pub mod sofa;
#[path = "../../tests/fuzz/wav.rs"]
pub mod wav;

pub use target::Target;

/// Defines the fuzz program of a target.
#[macro_export]
macro_rules! program {
    ($target:ident) => {
        // The target is created once: creating it builds its valid files.
        static ONE: std::sync::LazyLock<fn(&[u8])> =
            std::sync::LazyLock::new(|| $crate::$target::target().one);
        libfuzzer_sys::fuzz_target!(|data: &[u8]| ONE(data));
    };
}
