//! Writes the valid files that `tests/fuzz` starts from to `fuzz/corpus/TARGET/`, for libFuzzer to start from.

use echomarch_fuzz::{Target, base_scene, field_text, height_image, materials, scene, sofa, wav};
use std::path::Path;

fn main() -> std::io::Result<()> {
    let targets: [Target; 7] = [
        base_scene::target(),
        field_text::target(),
        height_image::target(),
        materials::target(),
        scene::target(),
        sofa::target(),
        wav::target(),
    ];
    for target in targets {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("corpus")
            .join(target.name);
        std::fs::create_dir_all(&folder)?;
        for (number, file) in target.corpus.iter().enumerate() {
            std::fs::write(folder.join(number.to_string()), file)?;
        }
    }
    Ok(())
}
